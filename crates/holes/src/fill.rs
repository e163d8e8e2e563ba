//! The rounds (rule 6, ours) and the filled cloud.

use crate::candidates::{candidates, independent};
use crate::front::Front;
use crate::loops::Loop;
use crate::relax::{refit_normals, relax};
use rayon::prelude::*;
use std::time::{Duration, Instant};
use surfine_points::shapes::natural_radii_of;
use surfine_points::{Attribute, Interpolation, PointSet, Values};
use surfine_reference::Level;

/// More rounds than any hole takes: about 2 log3(span / spacing) + 1.
const MOST_ROUNDS: u32 = 40;
/// The radius of a rim point is no more than this many spacings.
const RIM_RADIUS: f32 = 3.0;

/// What happened at one loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Fill {
    /// The loop.
    pub id: u32,
    /// Number of different points on it.
    pub rim: usize,
    /// Number of fill points.
    pub points: usize,
    /// Rounds until there was no candidate.
    pub rounds: u32,
    /// Points, of the rim and of the fill, at which the fill leaves a place open: 0 where it closes.
    pub open: usize,
    /// Time of the rounds.
    pub duration: Duration,
}

/// A cloud whose holes were filled.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Filled {
    /// The points of the input, then the fill points loop by loop.
    pub points: PointSet,
    /// One entry a loop, in the order of the loops given.
    pub fills: Vec<Fill>,
}

/// Fills loops.
pub fn fill(points: &PointSet, loops: &[Loop]) -> Filled {
    let cloud = Level::new(points);
    let fronts: Vec<(Front, Fill)> =
        loops.par_iter().map(|hole| fill_one(&cloud, hole)).collect();
    let mut filled = points.clone();
    let mut tags = vec![0i32; points.len()];
    let mut parents = Vec::new();
    let mut touched = Vec::new();
    for (front, report) in &fronts {
        let first = filled.len();
        let global = |i: u32| match front.rim.get(i as usize) {
            Some(&p) => p,
            None => (first + i as usize - front.rim.len()) as u32,
        };
        filled.positions.extend_from_slice(&front.level.positions[front.fill()]);
        filled.normals.extend_from_slice(&front.level.normals[front.fill()]);
        parents.extend(front.parents.iter().map(|corners| corners.map(global)));
        tags.resize(filled.len(), report.id as i32);
        touched.extend((0..front.len() as u32).map(global));
    }
    filled.extend_attributes(&parents);
    filled.attributes.push(Attribute { name: "hole".into(), values: Values::I32(tags), interpolation: Interpolation::Vote });
    let natural = natural_radii_of(&touched, &filled.positions, &filled.unit_normals());
    filled.radii.resize(filled.len(), 0.0);
    let spacings = fronts.iter().flat_map(|(front, _)| &front.spacings);
    for ((&p, natural), &spacing) in touched.iter().zip(natural).zip(spacings) {
        let radius = &mut filled.radii[p as usize];
        let natural = natural.min(RIM_RADIUS * spacing);
        *radius = if (p as usize) < points.len() { radius.max(natural) } else { natural };
    }
    Filled { points: filled, fills: fronts.into_iter().map(|(_, report)| report).collect() }
}

/// The front of a filled loop. Where the triangles over the rim alone leave it open, as at the end of a tube, the fill
/// starts from an apex instead, if that leaves less open.
fn fill_one(cloud: &Level, hole: &Loop) -> (Front, Fill) {
    let begin = Instant::now();
    let mut front = Front::new(cloud, hole);
    let (mut rounds, mut open) = grow(&mut front);
    if open > 0 {
        let mut other = Front::new(cloud, hole);
        other.add_apex();
        let (more, still_open) = grow(&mut other);
        rounds += more;
        if still_open < open {
            (front, open) = (other, still_open);
        }
    }
    refit_normals(&mut front);
    let (rim, points) = (front.rim.len(), front.fill().len());
    let report = Fill { id: hole.id, rim, points, rounds, open, duration: begin.elapsed() };
    (front, report)
}

/// Adds points in rounds until there is no candidate. The number of rounds and of fans that stay open.
fn grow(front: &mut Front) -> (u32, usize) {
    let mut rounds = 0;
    loop {
        let rings = front.fit_fans();
        let new = independent(&candidates(front, &rings));
        if std::env::var("DBG").is_ok() { eprintln!("round {rounds} new {} of {} mean ball {} open {}", new.len(), front.len(), front.level.radii.iter().sum::<f32>() / front.len() as f32 , front.open_fans(&rings)); }
        if new.is_empty() || rounds == MOST_ROUNDS {
            return (rounds, front.open_fans(&rings));
        }
        for c in new {
            front.add(c.position, c.normal, c.rho, c.corners);
        }
        relax(front);
        rounds += 1;
    }
}
