//! Records that kernels and host share: mirrors of `shaders/shared/records.wgsl`.

use crate::curves::Table;
use bytemuck::{Pod, Zeroable};
use surfine_points::{GridShape, RefineParams};

/// A point in device memory: 32 bytes, fit for a vertex buffer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Point {
    /// Position, in the units of the input and relative to its origin.
    pub position: [f32; 3],
    /// Radius, in the same units.
    pub radius: f32,
    /// Unit normal.
    pub normal: [f32; 3],
    /// Low byte: the refinement step that inserted the point; 0 for input points. Above it one more than the point's
    /// record if it lies on a crease or boundary.
    pub level: u32,
}

/// Bits of a point's level; above them is its record.
pub const LEVEL_BITS: u32 = 8;

/// Words of a block of the arena: points take whole blocks, so that the number of these cannot pass 32 bits.
pub const ARENA_BLOCK: u32 = 32;

/// What belongs to a point of the level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the fields are documented in records.wgsl")]
pub struct Fan {
    pub slots: [u32; 2],
    pub near: f32,
    pub left_over: u32,
    pub around: [u32; 2],
    pub conflicts: [u32; 2],
}

/// A possible new point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the fields are documented in records.wgsl")]
pub struct Candidate {
    pub place: [f32; 4],
    pub normal: [f32; 3],
    pub state: u32,
    pub corners: [u32; 3],
    pub size: f32,
}

/// What stays the same for all dispatches of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the fields are documented in records.wgsl")]
pub struct Params {
    pub origin: [f32; 3],
    pub inverse_cell: f32,
    pub bits: [u32; 3],
    pub cell: f32,
    pub sin_theta_f: f32,
    pub theta_c: f32,
    pub lambda1: f32,
    pub lambda2: f32,
    pub points: u32,
    pub slots: u32,
    pub triangles: u32,
    pub candidates: u32,
    pub level: u32,
    pub records: u32,
    pub arena_words: u32,
    pub ring_entries: u32,
    pub around_entries: u32,
    pub mirror_links: u32,
    pub longest_half: f32,
    pub softest_crease: f32,
    pub segment_origin: [f32; 3],
    pub segment_inverse_cell: f32,
    pub segment_bits: [u32; 3],
    pub segment_cell: f32,
    pub segments_begin: u32,
    pub segment_cells_begin: u32,
    pub segment_entries_begin: u32,
    pub unused: u32,
}

impl Params {
    /// The parameters of a refinement, before anything is known of the level.
    pub fn new(params: &RefineParams) -> Self {
        Self {
            sin_theta_f: params.sin_theta_f(),
            theta_c: params.theta_c,
            lambda1: params.lambda1,
            lambda2: params.lambda2,
            ..Self::default()
        }
    }

    /// The same with a grid.
    #[must_use]
    pub fn with_grid(self, shape: &GridShape) -> Self {
        Self {
            origin: shape.origin.to_array(),
            inverse_cell: 1.0 / shape.cell,
            bits: shape.bits,
            cell: shape.cell,
            ..self
        }
    }

    /// The same with the crease segments of a step.
    #[must_use]
    pub fn with_curves(self, table: &Table) -> Self {
        let [segments_begin, segment_cells_begin, segment_entries_begin] = table.begins;
        Self {
            longest_half: table.longest_half,
            softest_crease: table.softest_crease,
            segment_origin: table.shape.origin.to_array(),
            segment_inverse_cell: 1.0 / table.shape.cell,
            segment_bits: table.shape.bits,
            segment_cell: table.shape.cell,
            segments_begin,
            segment_cells_begin,
            segment_entries_begin,
            ..self
        }
    }
}

/// What changes from dispatch to dispatch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the fields are documented in records.wgsl")]
pub struct Dispatch {
    pub x: u32,
    pub y: u32,
    pub z: u32,
    pub w: u32,
    pub first: u32,
}

/// Counters that the host reads between stages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
#[expect(missing_docs, reason = "the fields are documented in records.wgsl")]
pub struct Counters {
    pub arena: u32,
    pub arena_peak: u32,
    pub slots: u32,
    pub around: u32,
    pub around_high: u32,
    pub mirrored: u32,
    pub mirrored_high: u32,
    pub classes: u32,
    pub isolated: u32,
    pub ball_low: u32,
    pub ball_high: u32,
    pub left_over: u32,
    pub longest_row: u32,
    pub cut_loops: u32,
    pub widest: u32,
}
