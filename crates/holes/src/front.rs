//! The front: the points of one loop and of its fill, and the fans over them (rules 1 and 2, ours).
//!
//! Nothing else is seen, no other sheet and no other hole, so that balls may be as large as the loop.

use crate::loops::Loop;
use crate::relax::height;
use glam::Vec3;
use surfine_points::{Grid, RefineParams, Rules};
use surfine_reference::math::{TAU, direction_angle, tangent_frame, unit};
use surfine_reference::neighborhood::{Rings, neighborhood};
use surfine_reference::{Level, point_grid};

/// The ball of a rim point reaches across the loop: this many spans.
const RIM_BALL: f32 = 1.02;
/// The ball of a fill point, in ρ of its candidate.
const FILL_BALL: f32 = 1.6;
/// A fan with a wider gap misses a neighbour, radians (109°).
const OPEN_FAN: f32 = 1.902_408_8;
/// A gap that is wider at the end is a place that was not filled, radians (150°).
const OPEN_PLACE: f32 = 2.617_993_9;
/// What an open fan's ball grows by, and how often.
const GROWTH: f32 = 1.4;
const TRIES: u32 = 3;
/// A ball shrinks to this many times the distance to the farthest member of the fan.
const SHRUNK: f32 = 1.1;
/// What the bound on the balls shrinks to in a round, and in spacings at the end. A round divides the distances in the fill
/// by about √3.
const TIGHTER: f32 = 0.85;
const LEAST_BALL: f32 = 8.0;
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
    /// No ball is larger; at first it reaches across the loop.
    largest: f32,
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
        let largest = RIM_BALL * hole.span;
        let mut front = Self { level, spacings, parents, rim, sectors, largest, params };
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
            front.push(position, normal, largest, hole.spacings[i]);
        }
        front
    }

    fn push(&mut self, position: Vec3, normal: Vec3, ball: f32, spacing: f32) {
        self.level.positions.push(position);
        self.level.normals.push(normal);
        self.level.radii.push(ball);
        self.spacings.push(spacing);
    }

    /// Adds a fill point in the middle of the loop, where the tangent planes of all its points want it on average (see
    /// [`crate::relax`]): the start for the end of a tube, whose points see nothing of the other side on their
    /// tangent planes.
    pub(crate) fn add_apex(&mut self) {
        let rim = self.level.positions.clone();
        let share = 1.0 / rim.len() as f32;
        let middle = rim.iter().fold(Vec3::ZERO, |sum, &x| sum + (x - rim[0])) * share + rim[0];
        // The open side is to the right of the loop, so its vector area points inward.
        let next = rim.iter().cycle().skip(1);
        let area = rim.iter().zip(next).fold(Vec3::ZERO, |sum, (&a, &b)| {
            let [a, b] = [a, b].map(|x| (x - middle) * (1.0 / self.level.radii[0]));
            sum + b.cross(a)
        });
        if area.dot(area) < 1e-12 {
            return;
        }
        let normal = unit(area);
        let height = rim
            .iter()
            .zip(&self.level.normals)
            .fold(0.0, |sum, (&x, &n)| sum + height(x - middle, normal, n));
        let apex = middle + normal * (height * share);
        let rho = rim.iter().map(|&x| (x - apex).length()).fold(0.0, f32::max);
        let spacing = self.spacings.iter().sum::<f32>() * share;
        self.push(apex, normal, FILL_BALL * rho, spacing);
        let third = rim.len() as u32 / 3;
        self.parents.push([0, third, 2 * third]);
    }

    /// Whether a fan leaves a place open, of a rim point within its sectors only.
    fn is_open(&self, rings: &Rings, p: usize) -> bool {
        let Some(sectors) = self.sectors.get(p) else {
            return widest_gap(rings, p) > OPEN_PLACE;
        };
        let angles: Vec<f32> = rings.ring(p).iter().map(|e| e.angle).collect();
        sectors.iter().any(|sector| sector.widest_gap(&angles) > OPEN_PLACE)
    }

    /// Lowers the bound on the balls: the fill grows finer from round to round, and balls that see all of it take long.
    pub(crate) fn tighten(&mut self) {
        let coarsest = self.spacings.iter().copied().fold(0.0, f32::max);
        self.largest = (TIGHTER * self.largest).max(LEAST_BALL * coarsest).min(self.largest);
        self.level.radii.iter_mut().for_each(|ball| *ball = ball.min(self.largest));
    }

    /// How many fans leave a place open.
    pub(crate) fn open_fans(&self, rings: &Rings) -> usize {
        (0..self.len()).filter(|&p| self.is_open(rings, p)).count()
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

    /// The fans of all points, with balls that are large enough and no larger: those of open fans grow, then those
    /// of closed ones shrink.
    pub(crate) fn fit_fans(&mut self) -> Rings {
        let mut rings = self.fans();
        for _ in 0..TRIES {
            let open: Vec<usize> =
                self.fill().filter(|&p| widest_gap(&rings, p) > OPEN_FAN).collect();
            if open.is_empty() {
                break;
            }
            for p in open {
                self.level.radii[p] = (self.level.radii[p] * GROWTH).min(self.largest);
            }
            rings = self.fans();
        }
        for p in 0..self.len() {
            if self.is_open(&rings, p) {
                continue;
            }
            let farthest = rings.ring(p).iter().map(|e| self.offset(p, e.id as usize).length());
            let farthest = farthest.fold(0.0, f32::max);
            if farthest > 0.0 {
                self.level.radii[p] = self.level.radii[p].min(SHRUNK * farthest);
            }
        }
        rings
    }

    /// The fans of all points.
    pub(crate) fn fans(&self) -> Rings {
        neighborhood(&self.level, &self.grid(), &self.params)
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
    /// Angle from the beginning of the sector.
    fn turn_to(self, angle: f32) -> f32 {
        let turn = angle - self.start;
        let turn = if turn < 0.0 { turn + TAU } else { turn };
        if turn > TAU - END { 0.0 } else { turn }
    }

    /// Whether two directions lie in the sector, the first before the last.
    fn holds(self, first: f32, last: f32) -> bool {
        let (first, last) = (self.turn_to(first), self.turn_to(last));
        first < last && last <= self.width + END
    }

    /// The widest angle in the sector without any of these directions.
    fn widest_gap(self, angles: &[f32]) -> f32 {
        let mut inside: Vec<f32> = angles.iter().map(|&a| self.turn_to(a)).collect();
        inside.retain(|&a| a < self.width);
        inside.extend([0.0, self.width]);
        inside.sort_by(f32::total_cmp);
        inside.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f32::max)
    }
}

/// Angle of an offset on the tangent plane of a normal, radians.
fn direction(normal: Vec3, offset: Vec3) -> f32 {
    let (e1, e2) = tangent_frame(normal);
    direction_angle(offset.dot(e2), offset.dot(e1))
}

/// The widest gap of a fan, radians; a full turn for fewer than three members.
fn widest_gap(rings: &Rings, p: usize) -> f32 {
    let ring = rings.ring(p);
    if ring.len() < 3 {
        return TAU;
    }
    let next = ring.iter().skip(1).map(|e| e.angle).chain([ring[0].angle + TAU]);
    ring.iter().zip(next).map(|(e, next)| next - e.angle).fold(0.0, f32::max)
}
