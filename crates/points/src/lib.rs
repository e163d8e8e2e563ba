//! Clouds of oriented points: the data that the reference and the GPU engine share.
//!
//! This crate knows files, attributes, the uniform grid and the parameters of the refinement. It knows neither the
//! algorithm nor a GPU.

mod convergence;
pub mod files;
mod grid;
pub mod math;
mod model;
mod order;
mod params;
pub mod ply;
mod point_set;
mod refined;
pub mod shapes;

pub use convergence::{Convergence, Spread};
pub use glam::Vec3;
pub use glam::{DVec3, UVec3};
pub use grid::{Grid, GridShape};
pub use model::{Completed, Model};
pub use order::Ordered;
pub use params::{Boundary, Neighborhood, ParamError, RefineParams, Rules};
pub use point_set::{Attribute, Interpolation, Invalid, PointSet, Values, unit_normal};
pub use refined::{CurveCounts, LevelReport, Progress, Refined, add_stage_time};
