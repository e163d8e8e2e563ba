//! Interpolatory refinement of point-based geometry (Guennebaud, Barthe and Paulin 2005), on the CPU.
//!
//! This crate is the definition of the result: the GPU engine's kernels mirror it stage by stage and are held to its
//! bytes. So it computes in f32, in the order of operations of the kernels, even where Rust would rather do otherwise.
//! `docs/algorithm.md` gives the reading of the paper and what was measured for each stage.

mod angles;
mod ball;
pub mod boundary;
pub mod candidates;
pub mod coloring;
mod columns;
pub mod commit;
pub mod conflicts;
mod contested;
mod fan_triangle;
mod fuzzy_planes;
pub mod insertion;
pub mod lists;
mod natural;
mod nearby;
pub mod neighborhood;
mod new_normal;
mod new_ring;
pub mod next_ring;
mod pairs;
pub mod pn_triangle;
mod pool;
mod refine;
pub mod selection;
mod sort_ring;
mod triangle_homes;
mod triangles;
pub mod visible;

pub use surfine_points::math;

pub use refine::{Error, LevelState, candidate_grid, point_grid, refine, refine_with, run_level};

use glam::Vec3;
use pn_triangle::Corner;
use surfine_features::{Cloud, CurvePoint, Features, Record, Records};
use surfine_points::Rules;
use visible::{Curves, Seen};

/// No point: the largest index.
pub const NO_POINT: u32 = u32::MAX;

/// The points of one level, `P^l`: what a refinement step reads and appends to. A point on a crease is one
/// record for each of its sides.
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
    /// Creases and boundaries; `None` where there are none.
    pub curves: Option<Curves>,
    /// The new points that the step puts on them.
    pub curve_points: Vec<CurvePoint>,
}

impl Level {
    /// The input level: its points taken apart to records, with creases but without boundaries.
    pub fn new(records: &Records) -> Self {
        let mut level = Self {
            positions: records.positions.clone(),
            normals: records.normals.clone(),
            radii: records.radii.clone(),
            step: 0,
            curves: None,
            curve_points: Vec::new(),
        };
        level.set_features(Features::creases(level.cloud(), &records.groups));
        level
    }

    /// What the host's search for curves reads.
    pub fn cloud(&self) -> Cloud<'_> {
        Cloud { positions: &self.positions, normals: &self.normals, radii: &self.radii }
    }

    /// Replaces the creases and boundaries.
    pub fn set_features(&mut self, features: Features) {
        self.curves = (!features.is_empty()).then(|| Curves::new(features, self.len()));
    }

    /// Begins a step: puts new points on the curves if it is one that splits them.
    pub fn begin_step(&mut self, rules: Rules) {
        if let Some(curves) = &mut self.curves
            && Features::splits_at(self.step + 1, rules)
        {
            self.curve_points = curves.features.split();
        }
    }

    /// Ends a step: the new points on the curves, the last of the level, become part of these.
    pub fn end_step(&mut self) {
        self.step += 1;
        if let Some(Curves { mut features, .. }) = self.curves.take() {
            let first = self.len() - std::mem::take(&mut self.curve_points).len();
            features.commit(first);
            self.set_features(features);
        }
    }

    /// Whether this step leaves the curves as they are.
    pub fn keeps_curves(&self) -> bool {
        self.curve_points.is_empty()
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

    /// The record of a point on a crease or boundary.
    pub fn record(&self, p: usize) -> Option<&Record> {
        let curves = self.curves.as_ref()?;
        curves.features.records.get(curves.record_of[p] as usize)
    }

    /// A point as others see it.
    pub fn seen(&self, p: usize) -> Seen {
        let record = self.curves.as_ref().map_or(NO_POINT, |curves| curves.record_of[p]);
        Seen { position: self.positions[p], normal: self.normals[p], record }
    }

    /// Two unit vectors that span the tangent plane of a point: those of its record, if it
    /// lies on a crease or boundary.
    pub fn frame(&self, p: usize) -> (Vec3, Vec3) {
        self.record(p).map_or_else(|| math::tangent_frame(self.normals[p]), Record::frame)
    }
}
