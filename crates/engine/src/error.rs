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
         lower generous radii, use fewer levels, split the cloud, or use the CPU"
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
    /// A point has more neighbors than the driver can walk through: software drivers end long loops.
    #[error(
        "{} has too many neighbors in step {level}: {adapter} ends long loops early; lower the radii to about 1.25 times the \
         distance to the farthest natural neighbor, or use the CPU",
        vertex.map_or("a new point".into(), |vertex| format!("vertex {vertex}"))
    )]
    Crowded {
        /// Index of such a point in the input; none for a point that an earlier step inserted.
        vertex: Option<usize>,
        /// The refinement step that failed, from 1.
        level: u32,
        /// Name of the adapter.
        adapter: String,
    },
    /// Creases and boundaries have more records than the device's points can name.
    #[error(
        "step {level}: creases and boundaries have {records} points, each normal counted, more than the {most} that the GPU \
         backend can number: use fewer levels, or use the CPU"
    )]
    Curves {
        /// The refinement step, from 1.
        level: u32,
        /// Records on creases and boundaries after the step.
        records: usize,
        /// The most there can be.
        most: usize,
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

impl Error {
    /// The error with the index of the input in place of that of the device, which has its points in `order`; the
    /// records of further normals follow them and belong to `owners`.
    pub(crate) fn of_input(self, order: &[u32], owners: &[u32]) -> Self {
        let Self::Crowded { vertex: Some(record), level, adapter } = self else { return self };
        let point = if record < order.len() {
            Some(record)
        } else {
            owners.get(record - order.len()).map(|owner| *owner as usize)
        };
        Self::Crowded { vertex: point.map(|point| order[point] as usize), level, adapter }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowded_points_are_named_as_in_the_input() {
        let found = |record| {
            let error = Error::Crowded { vertex: Some(record), level: 1, adapter: "any".into() };
            match error.of_input(&[2, 0, 1], &[1, 2]) {
                Error::Crowded { vertex, .. } => vertex,
                other => panic!("{other}"),
            }
        };
        assert_eq!([0, 1, 2].map(found), [Some(2), Some(0), Some(1)]);
        // Records of further normals, then a new point.
        assert_eq!([3, 4, 5].map(found), [Some(0), Some(1), None]);
    }
}
