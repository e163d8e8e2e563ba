//! Refines clouds of oriented points on the GPU: interpolatory refinement of point-based geometry (Guennebaud, Barthe
//! and Paulin 2005) as compute kernels.
//!
//! [`Refiner`] holds a device with compiled kernels and buffers, and refines one cloud after the other, in one go or in
//! [`Slices`]. Input points stay as they are, new points lie on the smooth surface through them. All else here is what
//! it takes and gives: [`Gpu`] and [`choose_adapter`] to choose a device, [`PointSet`] and [`RefineParams`] for what is
//! refined and how, [`Refined`] on the host and [`GpuRefined`] on the device, and [`Forecast`] of what a run will need.
//!
//! ```no_run
//! use surfine::{PointSet, RefineParams, Refiner};
//! # fn main() -> Result<(), surfine::Error> {
//! # let points = PointSet::default();
//! let mut refiner = Refiner::new(None)?;
//! let params = RefineParams { levels: 2, ..RefineParams::default() };
//! let refined = refiner.refine(&points, &params)?;
//! println!("{} points on {}", refined.points.len(), refiner.gpu().name);
//! # Ok(())
//! # }
//! ```

mod buffers;
mod clock;
mod commands;
mod curves;
mod error;
mod forecast;
mod gpu;
mod kernel;
mod pace;
mod profile;
mod read_back;
mod records;
mod refiner;
mod run;
mod scan;
mod shaders;
mod sizing;
mod slices;
mod stages;
mod step;
mod uniforms;
mod windows;

pub use error::Error;
pub use forecast::{Forecast, points_by_level};
pub use gpu::{Gpu, LOST, Mode, adapters, choose_adapter};
pub use profile::KernelTime;
pub use records::Point;
pub use refiner::{GpuRefined, Refiner};
pub use slices::Slices;
pub use surfine_points::{
    Attribute, Boundary, CurveCounts, LevelReport, Neighborhood, PointSet, Progress, RefineParams,
    Refined, Rules, Vec3,
};
pub use wgpu;

/// The README's example, compiled.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// The parts of the engine that tests run one at a time; not part of the stable interface.
pub mod testing {
    pub use crate::buffers::Buffer;
    pub use crate::commands::Commands;
    pub use crate::kernel::{Kernel, WORKGROUP_SIZE, exact_spirv};
    pub use crate::sizing::Sizing;
    pub use crate::step::{Constants, constants};
    pub use crate::uniforms::Uniforms;

    /// Creases and boundaries as the kernels see them.
    pub mod curves {
        pub use crate::curves::*;
    }
    /// Records that kernels and host share.
    pub mod records {
        pub use crate::records::*;
    }
    /// The kernels' texts.
    pub mod shaders {
        pub use crate::shaders::*;
    }

    /// Reads the first `count` values of a buffer.
    ///
    /// # Errors
    /// The device was lost.
    pub fn read<T: bytemuck::Pod>(
        gpu: &crate::Gpu,
        buffer: &wgpu::Buffer,
        count: usize,
    ) -> Result<Vec<T>, crate::Error> {
        crate::buffers::read(gpu, buffer, count, <[T]>::to_vec)
    }
}
