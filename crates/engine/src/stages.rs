//! The stages of a refinement step, as dispatches of their kernels: one file a stage, in which
//! [`Step`](crate::step::Step) gets a method of that name.

mod boundary;
mod candidates;
mod coloring;
mod commit;
mod conflicts;
mod grid;
mod insertion;
mod neighborhood;
mod next_ring;
mod selection;
