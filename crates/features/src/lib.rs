//! Feature curves of a cloud: creases, corners and boundaries (section 6 of the paper).
//!
//! A point on a crease has a normal for each of its sides. Here it is as many [`Record`]s, which never see each other: the
//! stages of a refinement step run for each record by itself. A boundary point is one record with one side. Records that
//! follow each other along a curve are joined by [`Segment`]s, which are split at every second step.
//!
//! There are few of them (about the root of the number of points), and once they are found nothing off the curves bears on
//! them: so all of this runs on the host, for the CPU reference and the GPU engine alike. What they do to the stages is in
//! `crates/reference/src/visible.rs` and its kernels.

mod boundary;
mod conormals;
mod curve;
mod fold;
mod records;
mod segments;
mod topology;

pub use boundary::{Gap, STRAIGHT, check_marks, may_be_boundary};
pub use curve::CurvePoint;
pub use fold::{Folded, Refinement, clear_sides, fold};
pub use records::Records;

use glam::Vec3;
use surfine_points::{CurveCounts, Grid, GridShape, Rules};

/// No record, no point: the largest index.
pub const NONE: u32 = u32::MAX;

/// One side of a crease or corner point, or a boundary point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// Its index among the points of the level.
    pub point: u32,
    /// Position.
    pub position: Vec3,
    /// Unit normal of the side.
    pub normal: Vec3,
    /// Unit vector in the tangent plane that points into the side's own sheet.
    pub conormal: Vec3,
    /// The records next to it along the curves that bound its side, or [`NONE`]: first that where the sheet begins, counter-
    /// clockwise seen from outside, then that where it ends.
    pub partners: [u32; 2],
    /// First record of its point.
    pub first: u32,
    /// Number of records of its point: 1 for a boundary point.
    pub sides: u32,
    /// Angles in the frame of [`Record::frame`] between which its fan lies, radians.
    pub wedge: [f32; 2],
    /// The segment of the level on which this step puts the record; [`NONE`] for records of the level itself.
    pub segment: u32,
}

impl Record {
    /// Tangent vectors at the record, right-handed with the normal. The first one points away from the sheet, so that the
    /// angles of a fan never wrap around.
    pub fn frame(&self) -> (Vec3, Vec3) {
        let e1 = -self.conormal;
        (e1, self.normal.cross(e1))
    }

    /// Whether it is a boundary point.
    pub fn is_boundary(&self) -> bool {
        self.sides == 1
    }
}

/// A piece of a curve between two points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// For each of its sides the records at its two ends; a boundary has one side, and [`NONE`]s.
    pub sides: [[u32; 2]; 2],
}

impl Segment {
    /// Whether it is a piece of a boundary.
    pub fn is_boundary(&self) -> bool {
        self.sides[1][0] == NONE
    }
}

/// The feature curves of one level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features {
    /// Records, those of one point next to each other.
    pub records: Vec<Record>,
    /// The pieces of the curves.
    pub segments: Vec<Segment>,
    /// Number of records before this step put new ones on the curves.
    pub old: usize,
}

/// Positions, unit normals and radii of the records of a level.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "the fields are named as everywhere")]
pub struct Cloud<'a> {
    pub positions: &'a [Vec3],
    pub normals: &'a [Vec3],
    pub radii: &'a [f32],
}

impl Features {
    /// The creases and corners of the input: groups of records that share a point, joined to segments. Groups that no
    /// segment reaches are no features.
    pub fn creases(cloud: Cloud<'_>, groups: &[Vec<u32>]) -> Self {
        let mut features = Self::default();
        if groups.is_empty() {
            return features;
        }
        let segments = segments::crease_segments(cloud, groups);
        features.add_creases(cloud, groups, &segments);
        features.old = features.records.len();
        conormals::set_conormals(&mut features, cloud);
        features.set_fans(0..features.old);
        features
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// The records of the point to which a record belongs.
    pub fn sides_of(&self, record: u32) -> std::ops::Range<usize> {
        let Record { first, sides, .. } = self.records[record as usize];
        first as usize..(first + sides) as usize
    }

    /// Whether a step, from 1, splits the segments: every second one does, as Kobbelt's √3 subdivision does at boundaries
    /// (section 6). The first one would make the curves denser than the surface beside them.
    pub fn splits_at(step: u32, rules: Rules) -> bool {
        step.is_multiple_of(2) == rules.even_steps
    }

    /// How many there are on the level.
    pub fn counts(&self) -> CurveCounts {
        let records = &self.records[..self.old];
        // Each point once: by the first of its records.
        let points = |fits: fn(u32) -> bool| {
            let first = |(i, r): &(usize, &Record)| *i == r.first as usize && fits(r.sides);
            records.iter().enumerate().filter(first).count()
        };
        let boundary_segments = self.segments.iter().filter(|s| s.is_boundary()).count();
        CurveCounts {
            crease_points: points(|sides| sides == 2),
            corners: points(|sides| sides > 2),
            crease_segments: self.segments.len() - boundary_segments,
            boundary_points: points(|sides| sides == 1),
            boundary_segments,
        }
    }

    /// The record of each point of the level, [`NONE`] for smooth points.
    pub fn by_point(&self, points: usize) -> Vec<u32> {
        let mut by_point = vec![NONE; points];
        for (i, record) in (0u32..).zip(&self.records[..self.old]) {
            by_point[record.point as usize] = i;
        }
        by_point
    }

    /// Cosine of half the angle between the two sides where a crease is softest: points whose normals are nearer to each other
    /// lie on one side.
    pub fn softest(&self) -> f32 {
        let creases = self.segments.iter().filter(|s| !s.is_boundary());
        let normal = |r: u32| self.records[r as usize].normal;
        let cosines = creases.flat_map(|s| [0, 1].map(|end| [s.sides[0][end], s.sides[1][end]]));
        let largest = cosines.map(|[a, b]| normal(a).dot(normal(b))).fold(-1.0, f32::max);
        (0.5 * (1.0 + largest)).max(0.0).sqrt()
    }

    /// The crease segments of the level by the cell of their middle; and half the length of the longest. Nothing lies
    /// beyond a boundary that its segments could hide.
    pub fn segment_grid(&self) -> (Grid, f32) {
        let creases = (0u32..).zip(&self.segments).filter(|(_, s)| !s.is_boundary());
        let ends = |s: &Segment| s.sides[0].map(|r| self.records[r as usize].position);
        let (mut ids, mut middles, mut longest) = (Vec::new(), Vec::new(), 0.0f32);
        for (id, [a, b]) in creases.map(|(id, s)| (id, ends(s))) {
            ids.push(id);
            middles.push((a + b) * 0.5);
            longest = longest.max((b - a).length());
        }
        // Queries reach half of the longest segment farther than anything else: in larger cells they visit few of them.
        let low = middles.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let shape = GridShape::with_cell(low, 2.0 * longest.max(1e-30), middles.len());
        (Grid::build(shape, ids.into_iter().zip(middles)), 0.5 * longest)
    }
}
