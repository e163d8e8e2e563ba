//! The front: the points of one loop and of its fill, and the fans over them (rules 1 and 2, ours).
//!
//! Nothing else is seen, no other sheet and no other hole, so that balls may be as large as the loop.

use crate::loops::Loop;
use glam::Vec3;
use surfine_points::{Grid, RefineParams, Rules};
use surfine_reference::math::{PI, TAU, direction_angle, tangent_frame};
use surfine_reference::neighborhood::{Rings, neighborhood};
use surfine_reference::{Level, point_grid};

/// The ball of a rim point reaches across the loop: this many spans.
const RIM_BALL: f32 = 1.02;
/// The ball of a fill point, in ρ of its candidate.
const FILL_BALL: f32 = 1.6;
/// A fan with a wider gap misses a neighbour, radians (109°).
const OPEN_FAN: f32 = 1.902_408_9;
/// What an open fan's ball grows by, and how often.
const GROWTH: f32 = 1.4;
const TRIES: u32 = 3;
/// A ball shrinks to this many times the distance to the farthest member of the fan.
const SHRUNK: f32 = 1.1;
/// Directions this near to the end of a sector are at its end, radians: angles are rounded.
const END: f32 = 1e-4;

/// Part of the tangent plane of a rim point that the loop leaves open.
#[derive(Clone, Copy, Debug)]
struct Sector {
    /// Angle where it begins, radians, counter-clockwise.
    start: f32,
    /// Its width, radians.
    width: f32,
}

/// The points of a loop, then its fill points.
#[derive(Debug)]
pub(crate) struct Front {
    /// Positions, normals, and the radii of the balls.
    pub(crate) level: Level,
    /// Mean distance of neighbours that the fill is to have at each point.
    pub(crate) spacings: Vec<f32>,
    /// The corners of each fill point's candidate, indices into the front.
    pub(crate) parents: Vec<[u32; 3]>,
    /// Index in the cloud of each rim point.
    pub(crate) rim: Vec<u32>,
    /// The open sectors of each rim point: one, or several where the loop touches itself.
    sectors: Vec<Vec<Sector>>,
    params: RefineParams,
}

impl Front {
    /// The front of a loop without fill.
    pub(crate) fn new(cloud: &Level, hole: &Loop) -> Self {
        let rules = Rules { opposite_pairs: false, narrow_cones: false, ..Rules::ALL };
        // No other sheet is in the front, so normals across the hole may differ as they like.
        let params = RefineParams { rules, ..RefineParams::default() };
        let (level, spacings, rim) = (Level::default(), Vec::new(), Vec::new());
        let (parents, sectors) = (Vec::new(), Vec::new());
        let mut front = Self { level, spacings, parents, rim, sectors, params };
        let corners = hole.points.len();
        for (i, &p) in hole.points.iter().enumerate() {
            let (position, normal) = (cloud.positions[p as usize], cloud.normals[p as usize]);
            let before = hole.points[(i + corners - 1) % corners];
            let to = cloud.positions[before as usize] - position;
            let sector = Sector { start: direction(normal, to), width: hole.gaps[i] };
            if let Some(known) = front.rim.iter().position(|&q| q == p) {
                front.sectors[known].push(sector);
                continue;
            }
            front.rim.push(p);
            front.sectors.push(vec![sector]);
            front.push(position, normal, RIM_BALL * hole.span, hole.spacings[i]);
        }
        front
    }

    fn push(&mut self, position: Vec3, normal: Vec3, ball: f32, spacing: f32) {
        self.level.positions.push(position);
        self.level.normals.push(normal);
        self.level.radii.push(ball);
        self.spacings.push(spacing);
    }

    /// Adds a fill point in the middle of three points of the front.
    pub(crate) fn add(&mut self, position: Vec3, normal: Vec3, rho: f32, corners: [u32; 3]) {
        let spacing = self.mean_spacing(corners);
        self.push(position, normal, FILL_BALL * rho, spacing);
        self.parents.push(corners);
    }

    /// Number of points.
    pub(crate) fn len(&self) -> usize {
        self.level.len()
    }

    /// The indices of the fill points.
    pub(crate) fn fill(&self) -> std::ops::Range<usize> {
        self.rim.len()..self.len()
    }

    /// The points by cell.
    pub(crate) fn grid(&self) -> Grid {
        point_grid(&self.level)
    }

    /// Mean of the spacings at three points.
    pub(crate) fn mean_spacing(&self, corners: [u32; 3]) -> f32 {
        corners.map(|c| self.spacings[c as usize]).iter().sum::<f32>() / 3.0
    }

    /// The fans of all points. Balls of open fans grow first, then all shrink to their fans.
    pub(crate) fn fans(&mut self) -> Rings {
        let mut rings = neighborhood(&self.level, &self.grid(), &self.params);
        for _ in 0..TRIES {
            let open: Vec<usize> = self.fill().filter(|&p| is_open(&rings, p)).collect();
            if open.is_empty() {
                break;
            }
            open.into_iter().for_each(|p| self.level.radii[p] *= GROWTH);
            rings = neighborhood(&self.level, &self.grid(), &self.params);
        }
        for p in 0..self.len() {
            let farthest = rings.ring(p).iter().map(|e| self.offset(p, e.id as usize).length());
            let farthest = farthest.fold(0.0, f32::max);
            if farthest > 0.0 {
                self.level.radii[p] = self.level.radii[p].min(SHRUNK * farthest);
            }
        }
        rings
    }

    /// From one point to another.
    pub(crate) fn offset(&self, from: usize, to: usize) -> Vec3 {
        self.level.positions[to] - self.level.positions[from]
    }

    /// Whether a triangle, counter-clockwise seen from outside, lies in the open sectors of those corners that are on
    /// the rim.
    pub(crate) fn is_inside(&self, [a, b, c]: [u32; 3]) -> bool {
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().all(|corners| {
            let [p, q, r] = corners.map(|c| c as usize);
            let normal = self.level.normals[p];
            let angle = |other| direction(normal, self.offset(p, other));
            self.sectors.get(p).is_none_or(|sectors| {
                let (first, last) = (angle(q), angle(r));
                sectors.iter().any(|sector| sector.holds(first, last))
            })
        })
    }
}

impl Sector {
    /// Whether two directions lie in the sector, the first before the last.
    fn holds(self, first: f32, last: f32) -> bool {
        let from_start = |angle: f32| {
            let turn = angle - self.start;
            let turn = if turn < 0.0 { turn + TAU } else { turn };
            if turn > TAU - END { 0.0 } else { turn }
        };
        let (first, last) = (from_start(first), from_start(last));
        first < last && last <= self.width + END
    }
}

/// Angle of an offset on the tangent plane of a normal, radians.
fn direction(normal: Vec3, offset: Vec3) -> f32 {
    let (e1, e2) = tangent_frame(normal);
    direction_angle(offset.dot(e2), offset.dot(e1))
}

/// Whether a fan has a gap that misses a neighbour.
fn is_open(rings: &Rings, p: usize) -> bool {
    let ring = rings.ring(p);
    let next = ring.iter().skip(1).map(|e| e.angle).chain(ring.first().map(|e| e.angle + TAU));
    ring.len() < 3 || ring.iter().zip(next).any(|(e, next)| next - e.angle > OPEN_FAN.min(PI))
}
