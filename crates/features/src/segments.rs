//! Crease segments: which crease points follow each other (ours; section 6 takes them as known).

use crate::records::CREASED;
use crate::{Cloud, Segment};
use glam::Vec3;
use surfine_points::math::unit;
use surfine_points::{Grid, GridShape};

/// Partners are sought within this many radii.
const REACH: f32 = 1.5;
/// A crease runs along the chord at both ends with at least this cosine.
const ALONG: f32 = 0.3;
/// The normals of a side differ by no more than this cosine says between two points of a crease.
const LIKE: f32 = -0.6;

/// One of the two directions in which a crease leaves a point between two of its sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct End {
    group: u32,
    /// The two sides, ascending, as ranks in the group.
    sides: [u32; 2],
    /// Whether it leaves against the cross product of their normals.
    backward: bool,
}

/// A way to go on from an end.
#[derive(Clone, Copy)]
struct Link {
    to: End,
    /// Whether the first side here is the second there.
    swapped: bool,
    score: f32,
}

/// The segments between crease points: each end takes the nearest and straightest partner, and both must agree.
pub(crate) fn crease_segments(cloud: Cloud<'_>, groups: &[Vec<u32>]) -> Vec<Segment> {
    let creases = Creases::new(cloud, groups);
    let ends: Vec<End> = (0..groups.len() as u32).flat_map(|g| creases.ends(g)).collect();
    let links: Vec<Option<Link>> = ends.iter().map(|&end| creases.best_link(end)).collect();
    let mut found: Vec<(f32, End, Link)> = Vec::new();
    for (&end, link) in ends.iter().zip(&links) {
        let Some(link) = *link else { continue };
        let back = ends.binary_search(&link.to).ok().and_then(|i| links[i]);
        if end < link.to && back.is_some_and(|back| back.to == end) {
            found.push((link.score, end, link));
        }
    }
    // Sides have room for two segments: the best ones come first.
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut partners = vec![0u32; cloud.positions.len()];
    let mut segments = Vec::new();
    for (_, from, link) in found {
        let segment = creases.segment(from, link);
        let ends = segment.sides.as_flattened();
        if ends.iter().all(|&record| partners[record as usize] < 2) {
            ends.iter().for_each(|&record| partners[record as usize] += 1);
            segments.push(segment);
        }
    }
    segments.sort_unstable_by_key(|segment| segment.sides);
    segments
}

struct Creases<'a> {
    cloud: Cloud<'a>,
    groups: &'a [Vec<u32>],
    grid: Grid,
}

impl<'a> Creases<'a> {
    fn new(cloud: Cloud<'a>, groups: &'a [Vec<u32>]) -> Self {
        let position = |group: &Vec<u32>| cloud.positions[group[0] as usize];
        let positions: Vec<Vec3> = groups.iter().map(position).collect();
        let radii: Vec<f32> = groups.iter().map(|group| cloud.radii[group[0] as usize]).collect();
        let grid = Grid::build(GridShape::fit(&positions, &radii), (0u32..).zip(positions));
        Self { cloud, groups, grid }
    }

    fn ends(&self, group: u32) -> Vec<End> {
        let sides = self.groups[group as usize].len() as u32;
        let mut ends = Vec::new();
        for i in 0..sides {
            for j in i + 1..sides {
                let sides = [i, j];
                if self.direction(End { group, sides, backward: false }).is_some() {
                    ends.extend([false, true].map(|backward| End { group, sides, backward }));
                }
            }
        }
        ends
    }

    fn record(&self, end: End, side: usize) -> u32 {
        self.groups[end.group as usize][end.sides[side] as usize]
    }

    fn normals(&self, end: End) -> [Vec3; 2] {
        [0, 1].map(|side| self.cloud.normals[self.record(end, side) as usize])
    }

    fn position(&self, group: u32) -> Vec3 {
        self.cloud.positions[self.groups[group as usize][0] as usize]
    }

    /// Unit vector in which the crease leaves.
    fn direction(&self, end: End) -> Option<Vec3> {
        let [a, b] = self.normals(end);
        let t = a.cross(b);
        (t.dot(t) >= CREASED * CREASED).then(|| if end.backward { -unit(t) } else { unit(t) })
    }

    fn best_link(&self, end: End) -> Option<Link> {
        let center = self.position(end.group);
        let radius = REACH * self.cloud.radii[self.groups[end.group as usize][0] as usize];
        let mut best: Option<Link> = None;
        self.grid.visit_ball(center, radius, |other, _| {
            let d = self.position(other) - center;
            if other == end.group || d.dot(d) > radius * radius {
                return;
            }
            for link in self.ends(other).into_iter().filter_map(|to| self.link(end, to, d)) {
                let better = |best: &Link| {
                    link.score.total_cmp(&best.score).then(link.to.cmp(&best.to)).is_lt()
                };
                if best.as_ref().is_none_or(better) {
                    best = Some(link);
                }
            }
        });
        best
    }

    /// The way from one end to another over the chord `d`, if the crease runs along it at both.
    fn link(&self, from: End, to: End, d: Vec3) -> Option<Link> {
        let length = d.dot(d).sqrt();
        let chord = d * (1.0 / length);
        let ([a, b], [c, e]) = (self.normals(from), self.normals(to));
        let (straight, crossed) = ([a.dot(c), b.dot(e)], [a.dot(e), b.dot(c)]);
        let swapped = crossed[0] + crossed[1] > straight[0] + straight[1];
        let likeness = if swapped { crossed } else { straight };
        // The other end leaves towards this one; with its sides swapped its cross product is turned around.
        if likeness[0] < LIKE || likeness[1] < LIKE || (from.backward == to.backward) != swapped {
            return None;
        }
        let here = self.direction(from)?.dot(chord);
        let there = -self.direction(to)?.dot(chord);
        (here >= ALONG && there >= ALONG).then_some(Link {
            to,
            swapped,
            score: length * (3.0 - here - there),
        })
    }

    fn segment(&self, from: End, link: Link) -> Segment {
        let order = if link.swapped { [1, 0] } else { [0, 1] };
        Segment { sides: [0, 1].map(|k| [self.record(from, k), self.record(link.to, order[k])]) }
    }
}
