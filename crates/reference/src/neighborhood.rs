//! One-ring neighbourhoods (section 4). Twins: `shaders/neighborhood_*.wgsl`.

use crate::Level;
use crate::lists::Lists;
use crate::math::{TAU, direction_angle, is_apart};
use crate::pn_triangle::geodesic_distance;
use crate::visible::View;
use glam::Vec3;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use surfine_points::{Grid, Neighborhood, RefineParams, Rules};

/// Largest badness of a neighbour: 1, and a margin because regular grids give exactly that.
pub const WORST_BADNESS: f32 = 1.001;

/// Cosine of 150°: points whose normals differ more are no neighbours, though eq. 6 lets exactly opposite ones pass.
pub const OPPOSITE: f32 = -0.866_025_4;
/// Share of the bound of eq. 6 from which pairs are rejected.
pub const NARROW: f32 = 0.7;
/// Share of the bound of eq. 6 from which pairs are doubtful.
pub const DOUBTFUL: f32 = 0.5;
/// A ring gap from 100° on may miss a natural neighbour, radians.
pub const OPEN_GAP: f32 = 1.745_329_3;

/// A corner of a triangle fan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RingEntry {
    /// Index of the neighbour.
    pub id: u32,
    /// Its angle on the tangent plane of the centre, in the frame of [`Level::frame`], radians in [0, 2π].
    pub angle: f32,
}

/// The sorted one-rings of all points: entries by angle, ties by index.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rings {
    /// The rings. The place of an entry among all is its slot: slot `i` of a point stands for the triangle of its ring
    /// entries `i` and `i + 1`.
    pub lists: Lists<RingEntry>,
    /// Sum of the sizes of the Euclidean neighbourhoods (eq. 7).
    pub ball_neighbors: u64,
}

impl Rings {
    /// The ring of a point.
    pub fn ring(&self, p: usize) -> &[RingEntry] {
        self.lists.of(p)
    }

    /// The slots of a point.
    pub fn slots(&self, p: usize) -> std::ops::Range<usize> {
        self.lists.range(p)
    }

    /// Number of slots.
    pub fn len(&self) -> usize {
        self.lists.items.len()
    }

    /// Whether no point has a ring.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A member of `N^E` seen from the centre, lengths in units of the centre's radius.
pub(crate) struct Neighbor {
    pub(crate) id: u32,
    /// Whether it may lie on another sheet: then it is no neighbour unless a gap stays open.
    is_doubtful: bool,
    /// The vector whose fuzzy plane is tested: `q'_i - p` (eq. 9) in the tangent frame for the accurate neighbourhood,
    /// `p_i - p` for the fuzzy one.
    offset: Vec3,
    /// Orthogonal projection `q_i`, up to a positive factor: only its direction counts.
    pub(crate) x: f32,
    pub(crate) y: f32,
}

impl Neighbor {
    /// A neighbour at offset `d` on the tangent plane of the first normal's point; `None` where it has no direction there.
    pub(crate) fn new(
        id: u32,
        d: Vec3,
        (e1, e2): (Vec3, Vec3),
        inverse: f32,
        [normal, other]: [Vec3; 2],
        params: &RefineParams,
    ) -> Option<Self> {
        let (x, y) = (d.dot(e1), d.dot(e2));
        let q2 = x * x + y * y;
        if q2 <= 1e-12 * d.dot(d) {
            return None;
        }
        if params.effective_neighborhood() == Neighborhood::Fuzzy {
            let (x, y) = (x * inverse, y * inverse);
            return Some(Self { id, is_doubtful: false, offset: d * inverse, x, y });
        }
        let s = (geodesic_distance(d, normal, other) * inverse) / q2.sqrt();
        let (x, y) = (x * s, y * s);
        Some(Self { id, is_doubtful: false, offset: Vec3::new(x, y, 0.0), x, y })
    }
}

/// Computes the one-ring of every point.
pub fn neighborhood(level: &Level, grid: &Grid, params: &RefineParams) -> Rings {
    let ball_neighbors = AtomicU64::new(0);
    let lists = Lists::make(level.len(), Scratch::default, |scratch, p, ring| {
        let size = consistent_ball(level, grid, params, p, &mut scratch.ball);
        ball_neighbors.fetch_add(size, Relaxed);
        one_ring(scratch, params);
        ring.extend(&scratch.ring);
    });
    Rings { lists, ball_neighbors: ball_neighbors.into_inner() }
}

/// What a thread uses again for the next point.
#[derive(Default)]
struct Scratch {
    ball: Vec<Neighbor>,
    kept: Vec<bool>,
    back: Vec<usize>,
    ring: Vec<RingEntry>,
}

/// Finds `N^E` (eq. 7) without the pairs that eq. 6 rejects; returns its size before that.
fn consistent_ball(
    level: &Level,
    grid: &Grid,
    params: &RefineParams,
    p: usize,
    ball: &mut Vec<Neighbor>,
) -> u64 {
    let (center, normal, radius) = (level.positions[p], level.normals[p], level.radii[p]);
    let frame = level.frame(p);
    let inverse = 1.0 / radius;
    let view = View::new(level, p, radius, params.rules);
    let mut size = 0;
    ball.clear();
    grid.visit_ball(center, radius, |id, position| {
        let d = position - center;
        let d2 = d.dot(d);
        // Coincident points have no direction to each other: they are no neighbours.
        if id as usize == p || d2 > radius * radius || !is_apart(d2, radius) {
            return;
        }
        size += 1;
        let other = level.normals[id as usize];
        let u = d * (1.0 / d2.sqrt());
        if consistent(u, normal, other, params.rules) && view.sees(level.seen(id as usize)) {
            let is_doubtful = is_doubtful(u, normal, other, params.rules);
            let neighbor = Neighbor::new(id, d, frame, inverse, [normal, other], params);
            ball.extend(neighbor.map(|n| Neighbor { is_doubtful, ..n }));
        }
    });
    size
}

/// Eq. 6, printed inverted: whether neither point lies in the cone of apex the other and axis `n0 + n1`. `u` is the unit
/// vector between them.
fn consistent(u: Vec3, n0: Vec3, n1: Vec3, rules: Rules) -> bool {
    let cosine = n0.dot(n1);
    if rules.opposite_pairs && cosine < OPPOSITE {
        return false;
    }
    let along = (n0 + n1).dot(u).abs();
    // The margin is for flat surfaces, where both sides are rounding.
    if rules.narrow_cones { along <= NARROW * (1.0 + cosine) + 1e-6 } else { along <= 1.0 + cosine }
}

/// Whether a pair that passes is doubtful: a step between two sheets rather than a slope of one.
fn is_doubtful(u: Vec3, n0: Vec3, n1: Vec3, rules: Rules) -> bool {
    let along = (n0 + n1).dot(u).abs();
    let beyond = along > DOUBTFUL * (1.0 + n0.dot(n1)) + 1e-6;
    rules.sure_neighbors && rules.natural_neighbors && beyond
}

/// Removes the members that lie behind others (eq. 8) and sorts the rest around the centre.
fn one_ring(Scratch { ball, kept, back, ring }: &mut Scratch, params: &RefineParams) {
    let stays = |i: usize| !ball[i].is_doubtful && !is_behind(ball, i, params.sin_theta_f());
    kept.clear();
    kept.extend((0..ball.len()).map(stays));
    if params.rules.natural_neighbors {
        let natural =
            |i: &usize| !kept[*i] && is_in_open_gap(ball, kept, *i) && is_natural(ball, *i);
        back.clear();
        back.extend((0..ball.len()).filter(natural));
        back.iter().for_each(|&i| kept[i] = true);
    }
    let entry = |i: usize| {
        let Neighbor { id, x, y, .. } = ball[i];
        RingEntry { id, angle: direction_angle(y, x) }
    };
    ring.clear();
    ring.extend((0..ball.len()).filter(|&i| kept[i]).map(entry));
    ring.sort_unstable_by(|a, b| a.angle.total_cmp(&b.angle).then(a.id.cmp(&b.id)));
}

/// Whether the kept members next to member `i` on both sides leave a gap that may miss a neighbour.
fn is_in_open_gap(ball: &[Neighbor], kept: &[bool], i: usize) -> bool {
    let (mut after, mut before) = (TAU, TAU);
    for (other, _) in ball.iter().zip(kept).filter(|(_, kept)| **kept) {
        let along = ball[i].x * other.x + ball[i].y * other.y;
        let across = ball[i].x * other.y - ball[i].y * other.x;
        after = after.min(direction_angle(across, along));
        before = before.min(direction_angle(-across, along));
    }
    after + before >= OPEN_GAP
}

/// Whether member `i` is a natural neighbour of the centre on its tangent plane: whether a piece of their bisector, no
/// farther from its middle than the radius, is nearer to both than to every other member.
fn is_natural(ball: &[Neighbor], i: usize) -> bool {
    let (x, y) = (ball[i].x, ball[i].y);
    // Places on the bisector are q/2 + t (-y, x).
    let mut high = 1.0 / (x * x + y * y).sqrt();
    let mut low = -high;
    for (j, other) in ball.iter().enumerate() {
        let along = x * other.x + y * other.y;
        let across = x * other.y - y * other.x;
        let room = 0.5 * ((other.x * other.x + other.y * other.y) - along);
        if j == i {
            continue;
        }
        if across > 0.0 {
            high = high.min(room / across);
        } else if across < 0.0 {
            low = low.max(room / across);
        } else if room < 0.0 {
            return false;
        }
    }
    low < high
}

/// Whether the badness `w_i` (eq. 8) of member `i` is above 1: it lies behind its successors and predecessors.
///
/// The maximum is taken over signed squares of `sin α_ij`, which order the same and need no root per pair. It only
/// rises, so the first values that are too large decide.
pub(crate) fn is_behind(ball: &[Neighbor], i: usize, sin_theta_f: f32) -> bool {
    let (mut successor, mut predecessor) = (-2.0f32, -2.0f32);
    for (j, other) in ball.iter().enumerate() {
        let c = ball[i].offset - other.offset;
        let product = other.offset.dot(other.offset) * c.dot(c);
        if i == j || other.is_doubtful || product == 0.0 {
            continue;
        }
        let along = other.offset.dot(c);
        let sin_squared = along * along.abs() / product;
        // An exactly collinear point counts as successor.
        let succeeds = ball[i].x * other.y - ball[i].y * other.x >= 0.0;
        let side = if succeeds { &mut successor } else { &mut predecessor };
        if sin_squared > *side {
            *side = sin_squared;
            let badness =
                plane_badness(successor, sin_theta_f) + plane_badness(predecessor, sin_theta_f);
            if badness > WORST_BADNESS {
                return true;
            }
        }
    }
    false
}

/// `w_ij` from the signed square of `sin α_ij`; 0 for an empty set, which passes -2.
fn plane_badness(sin_squared: f32, sin_theta_f: f32) -> f32 {
    let sine = if sin_squared < 0.0 { -(-sin_squared).sqrt() } else { sin_squared.sqrt() };
    if sine < -sin_theta_f { 0.0 } else { 0.5 * (sine / sin_theta_f + 1.0) }
}
