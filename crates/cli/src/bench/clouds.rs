//! The clouds that are refined.

use crate::Failure;
use crate::args::BenchArgs;
use crate::summary::name;
use crate::watch::Watch;
use std::path::Path;
use surfine::{PointSet, RefineParams};
use surfine_points::ply;
use surfine_points::shapes::{Sampling, Shape, sample};

/// The most points that are made as blue noise: it takes two seconds for these, and minutes for millions.
const MOST_BLUE_NOISE: usize = 50_000;

/// Fewer points make no sphere that tells of larger ones.
const FEWEST: usize = 100;

/// A cloud to refine.
pub(super) struct Cloud {
    pub(super) points: PointSet,
    /// Where it comes from, for people.
    pub(super) origin: String,
}

/// How many points become about `size` when they are refined, if that are enough to begin with.
pub(super) fn points_in(size: usize, levels: u32) -> Option<usize> {
    let points = (size as f64 / 3f64.powi(levels as i32)).round() as usize;
    (points >= FEWEST).then_some(points)
}

/// An even but irregular sphere of about `count` points.
pub(super) fn sphere(count: usize) -> Result<Cloud, Failure> {
    let mut levels = 0;
    let mut first = count;
    while first > MOST_BLUE_NOISE {
        first = first.div_ceil(3);
        levels += 1;
    }
    let mut points = sample(Shape::Sphere, Sampling::BlueNoise, first, 1);
    let mut origin = "blue noise on a sphere".to_owned();
    if levels > 0 {
        let params = RefineParams { levels, ..RefineParams::default() };
        points = surfine_reference::refine(&points, &params)?.points;
        origin = format!("{origin}, made from {first} points by {levels} levels of refinement");
    }
    Ok(Cloud { points, origin })
}

/// The user's own cloud.
pub(super) fn read(path: &Path, args: &BenchArgs, watch: &Watch) -> Result<Cloud, Failure> {
    watch.step(format!("reading {}", path.display()));
    let (points, source) = ply::read(path)?;
    if !args.quiet {
        source.notes.iter().for_each(|note| watch.warn(&format!("{}: {note}", path.display())));
    }
    Ok(Cloud { points, origin: name(path) })
}
