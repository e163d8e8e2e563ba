//! Interpolatory refinement of point-based geometry (Guennebaud, Barthe and Paulin 2005), on the CPU.
//!
//! This crate is the definition of the result: the GPU engine's kernels mirror it stage by stage and are held to its
//! bytes. So it computes in f32, in the order of operations of the kernels, even where Rust would rather do otherwise.
//! `docs/algorithm.md` gives the reading of the paper and what was measured for each stage.

pub mod candidates;
pub mod coloring;
pub mod commit;
pub mod conflicts;
pub mod insertion;
pub mod math;
pub mod neighborhood;
pub mod next_ring;
pub mod pn_triangle;
mod refine;

pub use refine::{Error, LevelState, candidate_grid, point_grid, refine, refine_with, run_level};

use glam::Vec3;
use pn_triangle::Corner;
use surfine_points::PointSet;

/// No point: the largest index.
pub const NO_POINT: u32 = u32::MAX;

/// The points of one level, `P^l`: what a refinement step reads and appends to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Level {
    /// Positions.
    pub positions: Vec<Vec3>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Radii.
    pub radii: Vec<f32>,
    /// Refinement steps that led here: 0 for the input.
    pub step: u32,
}

impl Level {
    /// The input level of a point set.
    pub fn new(points: &PointSet) -> Self {
        Self {
            positions: points.positions.clone(),
            normals: points.unit_normals(),
            radii: points.radii.clone(),
            step: 0,
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// A point as a corner of a triangle.
    pub fn corner(&self, id: u32) -> Corner {
        Corner { position: self.positions[id as usize], normal: self.normals[id as usize] }
    }
}
