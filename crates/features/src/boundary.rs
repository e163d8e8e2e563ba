//! Boundaries: points whose ring leaves a wide gap, in chains (section 6).

use crate::{Cloud, Features, NONE, Record, Segment};
use glam::Vec3;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::f32::consts::TAU;
use surfine_points::math::{tangent_frame, unit};
use surfine_points::{Boundary, Invalid, PointSet, RefineParams};

/// Chains of fewer segments are no boundary: closed irregular clouds have single wide gaps.
const SHORTEST_CHAIN: usize = 4;

/// Gaps of triangles are narrower: π less what rounding may take.
pub const STRAIGHT: f32 = 3.141_278_5;

/// The widest gap of a ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// The point whose ring it is.
    pub point: u32,
    /// The member where the gap begins, counter-clockwise seen from outside.
    pub begin: u32,
    /// The member where it ends.
    pub end: u32,
    /// Radians.
    pub angle: f32,
}

impl Gap {
    /// The widest gap of a ring that is sorted by angle, the first of equals. None where no two members have the gap of a
    /// triangle: a line of points has no boundary.
    pub fn widest(
        point: u32,
        ring: impl ExactSizeIterator<Item = (u32, f32)> + Clone,
    ) -> Option<Self> {
        if ring.len() < 2 {
            return None;
        }
        let (first, first_angle) = ring.clone().next()?;
        let nexts = ring.clone().skip(1).chain([(first, first_angle + TAU)]);
        let mut widest: Option<Self> = None;
        let mut narrowest = TAU;
        for ((begin, from), (end, to)) in ring.zip(nexts) {
            let angle = to - from;
            narrowest = narrowest.min(angle);
            if widest.is_none_or(|w| angle > w.angle) {
                widest = Some(Self { point, begin, end, angle });
            }
        }
        widest.filter(|_| narrowest < STRAIGHT)
    }
}

/// Checks that the property is there which is to mark the boundary.
///
/// # Errors
/// It is missing.
pub fn check_marks(points: &PointSet, params: &RefineParams) -> Result<(), Invalid> {
    match params.boundary.property() {
        Some(name) if points.attribute(name).is_none() => {
            Err(Invalid::NoMarks { name: name.into() })
        }
        _ => Ok(()),
    }
}

/// Whether a point with this gap may lie on a boundary: if it is wider than `θ_b`, or if the input marks the point.
pub fn may_be_boundary(points: &PointSet, params: &RefineParams, gap: &Gap) -> bool {
    let point = gap.point as usize;
    match &params.boundary {
        Boundary::None => false,
        Boundary::Angle(theta_b) => gap.angle > *theta_b,
        // Further normals have records after the points.
        Boundary::Marked(name) => points
            .attribute(name)
            .is_some_and(|a| point < points.len() && a.values.is_nonzero(point)),
    }
}

impl Features {
    /// Finds the chains of points with gaps and makes them boundaries. `gaps` has one gap a point, by index: those that may
    /// be boundary points. Points of creases are none.
    pub fn add_boundary(&mut self, cloud: Cloud<'_>, gaps: &[Gap]) {
        let creased: HashSet<u32> = self.records.iter().map(|r| r.point).collect();
        let gaps: BTreeMap<u32, Gap> =
            gaps.iter().filter(|g| !creased.contains(&g.point)).map(|g| (g.point, *g)).collect();
        let links = long_chains(&choose(cloud, &gaps));
        let nexts: HashMap<u32, u32> = links.iter().map(|&[a, b]| (a, b)).collect();
        let previous: HashMap<u32, u32> = links.iter().map(|&[a, b]| (b, a)).collect();
        let mut record_of: HashMap<u32, u32> = HashMap::new();
        let before = self.records.len();
        let mut points: Vec<u32> = links.iter().flatten().copied().collect();
        points.sort_unstable();
        points.dedup();
        for point in points {
            let (at, first) = (point as usize, self.records.len() as u32);
            let record = Record::new(point, cloud.positions[at], cloud.normals[at]);
            let gap = gaps[&point];
            let next = nexts.get(&point).copied().unwrap_or(gap.begin);
            let last = previous.get(&point).copied().unwrap_or(gap.end);
            let conormal = inward(cloud, point, next, last);
            self.records.push(Record { conormal, first, ..record });
            record_of.insert(point, first);
        }
        for link in links {
            let segment = Segment { sides: [link.map(|p| record_of[&p]), [NONE; 2]] };
            self.join(segment);
            self.segments.push(segment);
        }
        self.set_fans(before..self.records.len());
        self.old = self.records.len();
    }
}

/// Pairs of points that follow each other along the boundary: both may be boundary points, and one is where the gap of the
/// other begins or ends. A point has one before and one after it: pairs that both see come first, then the shortest.
fn choose(cloud: Cloud<'_>, gaps: &BTreeMap<u32, Gap>) -> Vec<[u32; 2]> {
    // Where the gap of p begins lies the next point, whose own gap ends at p.
    let mut pairs: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for gap in gaps.values() {
        for pair in [[gap.point, gap.begin], [gap.end, gap.point]] {
            if pair.iter().all(|p| gaps.contains_key(p)) {
                *pairs.entry(pair).or_default() += 1;
            }
        }
    }
    let length = |[a, b]: [u32; 2]| {
        let d = cloud.positions[b as usize] - cloud.positions[a as usize];
        d.dot(d)
    };
    let mut pairs: Vec<([u32; 2], u32, f32)> =
        pairs.into_iter().map(|(pair, seen)| (pair, seen, length(pair))).collect();
    pairs.sort_by(|a, b| b.1.cmp(&a.1).then(a.2.total_cmp(&b.2)).then(a.0.cmp(&b.0)));
    let (mut nexts, mut previous) = (HashMap::new(), HashMap::new());
    for ([a, b], ..) in pairs {
        let back = nexts.get(&b) == Some(&a);
        if !back && !nexts.contains_key(&a) && !previous.contains_key(&b) {
            nexts.insert(a, b);
            previous.insert(b, a);
        }
    }
    let mut chosen: Vec<[u32; 2]> = nexts.into_iter().map(|(a, b)| [a, b]).collect();
    chosen.sort_unstable();
    chosen
}

/// The pairs of chains that are long enough.
fn long_chains(pairs: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let nexts: HashMap<u32, u32> = pairs.iter().map(|&[a, b]| (a, b)).collect();
    let previous: HashMap<u32, u32> = pairs.iter().map(|&[a, b]| (b, a)).collect();
    let steps = |from: u32, along: &HashMap<u32, u32>| {
        let mut at = from;
        (0..SHORTEST_CHAIN)
            .take_while(|_| along.get(&at).inspect(|&&next| at = next).is_some())
            .count()
    };
    // A short loop goes round and round.
    let comes_back = |from: u32| {
        let mut at = from;
        (1..SHORTEST_CHAIN)
            .any(|_| nexts.get(&at).inspect(|&&next| at = next).is_some() && at == from)
    };
    let is_long = |&&[a, _]: &&[u32; 2]| {
        steps(a, &nexts) + steps(a, &previous) >= SHORTEST_CHAIN && !comes_back(a)
    };
    pairs.iter().filter(is_long).copied().collect()
}

/// Conormal of a boundary point: at right angles to the chord between those before and after it.
fn inward(cloud: Cloud<'_>, point: u32, next: u32, last: u32) -> Vec3 {
    let (center, n) = (cloud.positions[point as usize], cloud.normals[point as usize]);
    let direction = |to: u32| {
        let d = cloud.positions[to as usize] - center;
        let flat = d - n * d.dot(n);
        if flat.dot(flat) > 0.0 { unit(flat) } else { Vec3::ZERO }
    };
    // Counter-clockwise seen from outside the rim runs with the sheet on the other side: see `Gap`.
    let inward = (direction(next) - direction(last)).cross(n);
    if inward.dot(inward) > 1e-12 { unit(inward) } else { tangent_frame(n).0 }
}
