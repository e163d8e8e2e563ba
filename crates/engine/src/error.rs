//! What can go wrong on the way to a refined cloud.

use surfine_points::{Invalid, ParamError};

/// Why a refinement did not succeed.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The points are unfit.
    #[error(transparent)]
    Points(#[from] Invalid),
    /// A parameter is out of its range.
    #[error(transparent)]
    Params(#[from] ParamError),
    /// There is no adapter at all.
    #[error(
        "no GPU adapter found: install a Vulkan driver (on Debian `mesa-vulkan-drivers`, a software one), or use the CPU"
    )]
    NoAdapter,
    /// No adapter has the wanted name.
    #[error("no GPU adapter is named like \"{wanted}\"; there are: {present}")]
    NoSuchAdapter {
        /// The name that was asked for.
        wanted: String,
        /// The names of all adapters.
        present: String,
    },
    /// The device can't hold what the refinement needs.
    #[error(
        "{what} need {need} bytes, more than the {have} that {adapter} allows in one buffer: \
         use fewer levels, split the cloud, or use the CPU"
    )]
    Limit {
        /// What needs the memory.
        what: &'static str,
        /// Bytes needed.
        need: u64,
        /// Bytes allowed.
        have: u64,
        /// Name of the adapter.
        adapter: String,
    },
    /// The buffers of a kernel are so long that they need more bindings than it may have.
    #[error(
        "the buffers of the kernel {kernel} need {need} bindings, more than the {have} that {adapter} allows: \
         use fewer levels, split the cloud, or use the CPU"
    )]
    Bindings {
        /// Name of the kernel.
        kernel: &'static str,
        /// Bindings needed.
        need: u32,
        /// Bindings allowed.
        have: u32,
        /// Name of the adapter.
        adapter: String,
    },
    /// A step has more points than the device can hold, whatever it finds.
    #[error(
        "step {level} of {levels} has {points} points to refine: its buffer of {what} alone needs {need} bytes, more than the \
         {have} that {adapter} allows in one buffer (about {total} in all): use fewer levels, split the cloud, or use the CPU"
    )]
    TooLarge {
        /// The refinement step, from 1.
        level: u32,
        /// How many steps there are.
        levels: u32,
        /// Points before the step, each normal of a point on a crease counted.
        points: usize,
        /// The largest buffer that the step surely needs.
        what: &'static str,
        /// Its bytes.
        need: u64,
        /// Bytes allowed.
        have: u64,
        /// Bytes of all buffers at the end of the run, about.
        total: u64,
        /// Name of the adapter.
        adapter: String,
    },
    /// A point has more neighbours than the driver can walk through: software drivers end long loops.
    #[error(
        "vertex {point} has too many neighbours at level {level} ({neighbors} within its radius): {adapter} ends loops \
         early; lower the radii to about 1.25 times the distance to the farthest natural neighbour, or use the CPU"
    )]
    Crowded {
        /// Index of such a point.
        point: usize,
        /// How many it has.
        neighbors: u32,
        /// The refinement step that failed, from 1.
        level: u32,
        /// Name of the adapter.
        adapter: String,
    },
    /// A kernel could not be built.
    #[error("kernel {name}: {message}")]
    Kernel {
        /// Name of the kernel.
        name: &'static str,
        /// What the compiler said.
        message: String,
    },
    /// The device refused a request, ran out of memory or was lost.
    #[error("{adapter}: {message}")]
    Device {
        /// Name of the adapter.
        adapter: String,
        /// What the driver said.
        message: String,
    },
}
