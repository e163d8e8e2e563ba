//! Conformance of the GPU engine to the CPU reference: each kernel alone, fed the reference's inputs, then whole runs.
//!
//! In exact mode on a driver that rounds division and square root correctly (lavapipe, `SwiftShader`) everything must
//! be equal bit for bit. On other adapters the table in `tolerance.rs` holds. Without an adapter the suite fails:
//! install one (on Debian `mesa-vulkan-drivers`); `tests/run.sh` does.

mod boundary;
mod candidates;
mod clouds;
mod coloring;
mod commit;
mod comparator;
mod conflicts;
mod grid;
mod harness;
mod insertion;
mod neighborhood;
mod next_ring;
mod refine;
mod selection;
mod slices;
mod tolerance;
mod windows;
