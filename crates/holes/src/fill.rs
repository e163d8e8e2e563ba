//! The rounds (rule 6, ours) and the filled cloud.

use crate::candidates::{candidates, independent};
use crate::front::Front;
use crate::loops::{Kind, Loop};
use crate::relax::{refit_normals, relax};
use crate::{Error, HOLE};
use rayon::prelude::*;
use std::time::{Duration, Instant};
use surfine_features::clear_sides;
use surfine_points::shapes::natural_radii_of;
use surfine_points::{Attribute, Interpolation, PointSet, Values};
use surfine_reference::Level;

/// More rounds than any hole takes: about 2 log3(span / spacing) + 1.
const MOST_ROUNDS: u32 = 40;
/// New radii are no more than this many spacings.
const MOST_RADIUS: f32 = 3.0;
/// A fill that leaves one in so many points open, or more, is none.
const OPEN_SHARE: usize = 10;
/// A fill has no more points than the squared number of spacings in the loop's perimeter, and these: a disc has a tenth of
/// it, and a dome a fifth.
const MORE_POINTS: f32 = 100.0;
/// Rounds end when they add no more than one in so many fill points.
const LAST_SHARE: usize = 200;

/// What happened at one loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Fill {
    /// The loop.
    pub id: u32,
    /// Number of different points on it.
    pub rim: usize,
    /// Number of fill points; 0 if the loop could not be closed.
    pub points: usize,
    /// Rounds until there was no candidate.
    pub rounds: u32,
    /// Points, of the rim and of the fill, at which the fill leaves a corner of more than 150° open: few where it closes.
    pub open: usize,
    /// Time of the rounds.
    pub duration: Duration,
}

/// Adds points that fill loops. The points of the input stay as they are and come first, but for radii along the loops,
/// which grow where the new neighbours ask for it. Fill points follow loop by loop; their attributes come from the
/// corners of their triangle. The attribute [`HOLE`] tags them with the id of their loop.
///
/// A loop whose fill leaves a tenth of its points open is left as it was. Without any fill point the cloud comes
/// back as it is.
///
/// # Errors
/// [`Error::Tag`] if there is an attribute of that name that can't hold the ids.
pub(crate) fn fill(points: &PointSet, loops: &[Loop]) -> Result<(PointSet, Vec<Fill>), Error> {
    let cloud = Level {
        positions: points.positions.clone(),
        normals: points.unit_normals(),
        radii: points.radii.clone(),
        ..Level::default()
    };
    let (fronts, fills): (Vec<Front>, Vec<Fill>) =
        loops.par_iter().map(|hole| fill_one(&cloud, hole)).unzip();
    let mut filled = points.clone();
    if fills.iter().all(|fill| fill.points == 0) {
        return Ok((filled, fills));
    }
    let taken = add_tags(&mut filled)?;
    let (mut parents, mut touched, mut spacings) = (Vec::new(), Vec::new(), Vec::new());
    let mut tags = Vec::new();
    for (front, fill) in fronts.iter().zip(&fills).filter(|(_, fill)| fill.points > 0) {
        let first = filled.len();
        let global = |i: u32| match front.rim.get(i as usize) {
            Some(&p) => p,
            None => (first + i as usize - front.rim.len()) as u32,
        };
        filled.positions.extend_from_slice(&front.level.positions[front.fill()]);
        filled.normals.extend_from_slice(&front.level.normals[front.fill()]);
        parents.extend(front.parents.iter().map(|corners| corners.map(global)));
        tags.extend(front.fill().map(|_| taken + fill.id as i32));
        touched.extend((0..front.len() as u32).map(global));
        spacings.extend_from_slice(&front.spacings);
    }
    filled.extend_attributes(&parents);
    // Corners on creases have several normals, fill points have one.
    clear_sides(&mut filled, points.len());
    set_radii(&mut filled, points.len(), &touched, &spacings);
    let hole = filled.attributes.iter_mut().find(|a| a.name == HOLE);
    if let Some(Attribute { values: Values::I32(column), .. }) = hole {
        column[points.len()..].copy_from_slice(&tags);
    }
    Ok((filled, fills))
}

/// Makes sure that there is a column for the tags. The largest tag that it holds: those of this fill go on from there.
fn add_tags(points: &mut PointSet) -> Result<i32, Error> {
    match points.attributes.iter().find(|a| a.name == HOLE).map(|a| &a.values) {
        Some(Values::I32(tags)) => Ok(tags.iter().copied().max().unwrap_or(0).max(0)),
        Some(_) => Err(Error::Tag),
        None => {
            let values = Values::I32(vec![0; points.len()]);
            let interpolation = Interpolation::Vote;
            points.attributes.push(Attribute { name: HOLE.into(), values, interpolation });
            Ok(0)
        }
    }
}

/// Natural radii of the points of the fronts; those of the input are only ever raised.
fn set_radii(filled: &mut PointSet, input: usize, touched: &[u32], spacings: &[f32]) {
    let natural = natural_radii_of(touched, &filled.positions, &filled.unit_normals());
    filled.radii.resize(filled.positions.len(), 0.0);
    for ((&p, natural), spacing) in touched.iter().zip(natural).zip(spacings) {
        let radius = &mut filled.radii[p as usize];
        let natural = natural.min(MOST_RADIUS * spacing);
        *radius = if (p as usize) < input { radius.max(natural) } else { natural };
    }
}

/// The front of a filled loop. At the end of a tube the points see nothing of the other side on their tangent planes: there
/// the fill starts from an apex.
fn fill_one(cloud: &Level, hole: &Loop) -> (Front, Fill) {
    let begin = Instant::now();
    let mut front = Front::new(cloud, hole);
    if hole.kind() != Kind::Hole {
        front.add_apex();
    }
    let around = hole.perimeter / hole.spacing();
    let (rounds, open) = grow(&mut front, (around * around + MORE_POINTS) as usize);
    refit_normals(&mut front);
    let closes = OPEN_SHARE * open < front.len();
    let (rim, points) = (front.rim.len(), if closes { front.fill().len() } else { 0 });
    let report = Fill { id: hole.id, rim, points, rounds, open, duration: begin.elapsed() };
    (front, report)
}

/// Adds points in rounds until there is no candidate. The number of rounds and of fans that stay open.
fn grow(front: &mut Front, most: usize) -> (u32, usize) {
    let mut rounds = 0;
    loop {
        let rings = front.fit_fans();
        let new = independent(&candidates(front, &rings));
        let fill = front.fill().len();
        let settled = LAST_SHARE * new.len() <= fill;
        if settled || rounds == MOST_ROUNDS || fill > most {
            return (rounds, front.open_fans(&rings));
        }
        for c in new {
            front.add(c.position, c.normal, c.rho, c.corners);
        }
        relax(front);
        front.tighten();
        rounds += 1;
    }
}
