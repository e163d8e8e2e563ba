//! One-ring neighbourhoods (section 4). Twin: `shaders/neighborhood.wgsl`.

use crate::Level;
use crate::ball::{Ball, Members};
use crate::lists::Lists;
use crate::math::is_apart;
use crate::natural::{has_open_gap, take_back};
use crate::nearby::{Marks, Nearby};
use crate::pairs::{Center, OUT, judge};
use crate::sort_ring::RingOrder;
use crate::visible::View;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use surfine_points::{Grid, Neighborhood, RefineParams, Rules};

pub use crate::fuzzy_planes::WORST_BADNESS;
pub use crate::natural::OPEN_GAP;
pub use crate::pairs::{DOUBTFUL, NARROW, OPPOSITE};

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
    })
    .expect("rings have fewer than seven members in the mean");
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
    kept: RingOrder,
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
        take_back(ball, kept, back);
        sort_ring(ball, kept, ring);
    }
}

/// The kept members by angle, ties by index.
fn sort_ring(ball: Ball<'_>, kept: &mut RingOrder, ring: &mut Vec<RingEntry>) {
    let sorted = kept.sorted();
    ring.resize(sorted.len(), RingEntry::default());
    for (i, rank) in sorted {
        ring[rank] = RingEntry { id: ball.ids[i], angle: ball.angle[i] };
    }
}
