//! One-ring neighbourhoods (section 4). Twin: `shaders/neighborhood.wgsl`.

use crate::Level;
use crate::ball::{Around, Ball, Block, Center, DOUBT, Members, OUT, SURE, Verdict};
use crate::columns::{BLOCK, vectorized};
use crate::lists::Lists;
use crate::math::{TAU, direction_angle, is_apart};
use crate::nearby::{Marks, Nearby};
use crate::visible::View;
use glam::Vec3;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use surfine_points::{Grid, Neighborhood, RefineParams, Rules};

/// Cosine of 150°: points whose normals differ more are no neighbours, though eq. 6 lets exactly opposite ones pass.
pub const OPPOSITE: f32 = -0.866_025_4;
/// Share of the bound of eq. 6 from which pairs are rejected.
pub const NARROW: f32 = 0.7;
/// Share of the bound of eq. 6 from which pairs are doubtful.
pub const DOUBTFUL: f32 = 0.5;
/// Largest badness (eq. 8) of a neighbour: 1, and a margin because regular grids give exactly that.
pub const WORST_BADNESS: f32 = 1.001;
/// A ring gap from 100° on may miss a natural neighbour, radians.
pub const OPEN_GAP: f32 = 1.745_329_3;

/// By less do the angles between members, and the differences of their angles, differ.
const ROUNDINGS: f32 = 1e-4;

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
    pub fn slots(&self, p: usize) -> Range<usize> {
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

/// Points whose neighbourhoods are found together.
const BATCH: usize = 32;

/// Computes the one-ring of every point.
pub fn neighborhood(level: &Level, grid: &Grid, params: &RefineParams) -> Rings {
    let ball_neighbors = AtomicU64::new(0);
    let filter = Filter::new(params);
    let [lists] = Lists::in_chunks(level.len(), Scratch::default, |scratch, points, [rings]| {
        let mut size = 0;
        for first in points.clone().step_by(BATCH) {
            let batch = first..(first + BATCH).min(points.end);
            size += find_balls(level, grid, batch.clone(), scratch);
            scratch.members.project(filter.fuzzy);
            scratch.members.judge(|pairs, verdicts| judge(pairs, filter.rules, verdicts));
            for (rank, p) in batch.enumerate() {
                one_ring(level, p, scratch.members.own(rank), scratch, &filter);
                rings.items.extend(&scratch.ring);
                rings.end();
            }
        }
        ball_neighbors.fetch_add(size, Relaxed);
    });
    Rings { lists, ball_neighbors: ball_neighbors.into_inner() }
}

/// What decides on the members of a neighbourhood.
struct Filter {
    rules: Rules,
    fuzzy: bool,
    sin_theta_f: f32,
}

impl Filter {
    fn new(params: &RefineParams) -> Self {
        Self {
            rules: params.effective_rules(),
            fuzzy: params.effective_neighborhood() == Neighborhood::Fuzzy,
            sin_theta_f: params.sin_theta_f(),
        }
    }
}

/// What a thread uses again for the next points.
#[derive(Default)]
struct Scratch {
    nearby: Nearby,
    marks: Marks,
    /// `N^E` of each point of the batch, one after the other.
    members: Members,
    kept: Around,
    back: Vec<usize>,
    ring: Vec<RingEntry>,
}

/// Finds `N^E` (eq. 7) of each point of a batch, and returns the sum of their sizes.
fn find_balls(level: &Level, grid: &Grid, batch: Range<usize>, scratch: &mut Scratch) -> u64 {
    let Scratch { nearby, marks, members, .. } = scratch;
    members.clear();
    let end = batch.end;
    for p in batch {
        let center = Center::of(level, p);
        let Center { position, radius, .. } = center;
        nearby.look(grid, p..end, |p| (level.positions[p], level.radii[p]));
        let found = nearby.in_ball(position, radius, marks);
        members.prepare(found.len());
        for &i in found {
            let (item, offset) = (nearby.items[i as usize], nearby.place(i) - position);
            // Coincident points have no direction to each other, nor has a point to itself: they are no neighbours.
            let is_wanted = is_apart(offset.dot(offset), radius);
            members.offer(item, offset, level.normals[item as usize], is_wanted);
        }
        members.end(&center);
    }
    members.len() as u64
}

vectorized! {
    /// Applies eq. 6.
    fn judge(pairs: Block<'_>, rules: Rules, verdicts: &mut [Verdict; BLOCK]) {
        for (i, verdict) in verdicts.iter_mut().enumerate() {
            let (d, normal, other) = pairs.get(i);
            let u = d * (1.0 / d.dot(d).sqrt());
            let sure = if is_doubtful(u, normal, other, rules) { DOUBT } else { SURE };
            let is_out = (*verdict == OUT) | !consistent(u, normal, other, rules);
            *verdict = if is_out { OUT } else { sure };
        }
    }
}

/// Eq. 6, printed inverted: whether neither point lies in the cone of apex the other and axis `n0 + n1`. `u` is the unit
/// vector between them.
#[inline(always)]
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
#[inline(always)]
fn is_doubtful(u: Vec3, n0: Vec3, n1: Vec3, rules: Rules) -> bool {
    let along = (n0 + n1).dot(u).abs();
    let beyond = along > DOUBTFUL * (1.0 + n0.dot(n1)) + 1e-6;
    rules.sure_neighbors && rules.natural_neighbors && beyond
}

/// Removes the members that lie behind others (eq. 8) and sorts the rest around the centre.
fn one_ring(level: &Level, p: usize, own: Range<usize>, scratch: &mut Scratch, filter: &Filter) {
    let Scratch { members, kept, back, ring, .. } = scratch;
    if let Some(view) = View::new(level, level.seen(p), level.radii[p], filter.rules) {
        for i in own.clone() {
            let verdict = &mut members.verdicts[i];
            if *verdict != OUT && !view.sees(level.seen(members.ids[i] as usize)) {
                *verdict = OUT;
            }
        }
    }
    let ball = members.ball(own, filter.fuzzy, filter.sin_theta_f);
    kept.clear();
    ball.neighbors(kept);
    sort_ring(ball, kept, ring);
    if filter.rules.natural_neighbors && has_open_gap(ring) {
        let comes_back = |i: &usize| {
            let may = ball.verdicts[*i] != OUT && !ball.is_neighbor(*i);
            may && may_be_in_open_gap(ball, kept.members(), *i)
                && is_in_open_gap(ball, kept.members(), *i)
                && is_natural(ball, *i)
        };
        back.clear();
        back.extend((0..ball.len()).filter(comes_back));
        kept.prepare(back.len());
        back.iter().for_each(|&i| kept.offer(i as u32, ball.angle[i], ball.ids[i], true));
        sort_ring(ball, kept, ring);
    }
}

/// The kept members by angle, ties by index.
fn sort_ring(ball: Ball<'_>, kept: &mut Around, ring: &mut Vec<RingEntry>) {
    let sorted = kept.sorted();
    ring.resize(sorted.len(), RingEntry::default());
    for (i, rank) in sorted {
        ring[rank] = RingEntry { id: ball.ids[i], angle: ball.angle[i] };
    }
}

/// Whether two entries that follow each other may leave an open gap: whether anything may come back.
fn has_open_gap(ring: &[RingEntry]) -> bool {
    let open = OPEN_GAP - ROUNDINGS;
    let angle = |i: usize| ring[i].angle;
    let wraps = ring.is_empty() || angle(0) + TAU - angle(ring.len() - 1) >= open;
    wraps || (1..ring.len()).any(|i| angle(i) - angle(i - 1) >= open)
}

/// Whether [`is_in_open_gap`] has to be asked: most members are far from open gaps, which their angles tell at less cost.
fn may_be_in_open_gap(ball: Ball<'_>, kept: &[u32], i: usize) -> bool {
    let (mut after, mut before) = (TAU, TAU);
    for &j in kept {
        let turn = ball.angle[j as usize] - ball.angle[i];
        let turn = if turn < 0.0 { turn + TAU } else { turn };
        after = after.min(turn);
        before = before.min(TAU - turn);
    }
    // Where one is at the member's own angle, roundings decide on which side it is.
    after.min(before) < ROUNDINGS || after + before >= OPEN_GAP - ROUNDINGS
}

/// Whether the kept members next to member `i` on both sides leave a gap that may miss a neighbour.
fn is_in_open_gap(ball: Ball<'_>, kept: &[u32], i: usize) -> bool {
    let (mut after, mut before) = (TAU, TAU);
    for j in kept.iter().map(|&j| j as usize) {
        let along = ball.x[i] * ball.x[j] + ball.y[i] * ball.y[j];
        let across = ball.x[i] * ball.y[j] - ball.y[i] * ball.x[j];
        after = after.min(direction_angle(across, along));
        before = before.min(direction_angle(-across, along));
    }
    after + before >= OPEN_GAP
}

/// Whether member `i` is a natural neighbour of the centre on its tangent plane: whether a piece of their bisector, no
/// farther from its middle than the radius, is nearer to both than to every other member.
fn is_natural(ball: Ball<'_>, i: usize) -> bool {
    let (x, y) = (ball.x[i], ball.y[i]);
    // Places on the bisector are q/2 + t (-y, x).
    let mut high = 1.0 / (x * x + y * y).sqrt();
    let mut low = -high;
    for j in (0..ball.len()).filter(|&j| j != i && ball.verdicts[j] != OUT) {
        let (xj, yj) = (ball.x[j], ball.y[j]);
        let along = x * xj + y * yj;
        let across = x * yj - y * xj;
        let room = 0.5 * ((xj * xj + yj * yj) - along);
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
