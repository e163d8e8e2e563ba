//! Inputs that several tests share.

use std::path::Path;

use surfine_points::shapes::{Sampling, Shape, natural_radii, sample, square_grid};
use surfine_points::{Boundary, PointSet, RefineParams, Refined, Rules, Vec3, ply};

/// Default parameters at a number of levels.
pub(crate) fn levels(levels: u32) -> RefineParams {
    RefineParams { levels, ..RefineParams::default() }
}

/// The same for a surface that is taken to be closed, so that nothing is put on its rim.
pub(crate) fn closed(levels: u32) -> RefineParams {
    RefineParams { levels, boundary: Boundary::None, ..RefineParams::default() }
}

/// That many levels by the paper's text alone.
pub(crate) fn literal(levels: u32) -> RefineParams {
    RefineParams { levels, rules: Rules::LITERAL, ..RefineParams::default() }
}

/// That many levels by all rules but `largest_first`: by the paper's loop, around one point after the other.
pub(crate) fn paper_loop(levels: u32) -> RefineParams {
    let rules = Rules { largest_first: false, ..Rules::ALL };
    RefineParams { levels, rules, ..RefineParams::default() }
}

/// Refines points that are fit for it.
pub(crate) fn refine(points: &PointSet, params: &RefineParams) -> Refined {
    surfine_reference::refine(points, params).expect("the points and parameters are fit")
}

/// An even sample of a closed shape.
pub(crate) fn blue_noise(shape: Shape, n: usize, seed: u64) -> PointSet {
    sample(shape, Sampling::BlueNoise, n, seed)
}

/// An irregular sample of a shape.
pub(crate) fn random(shape: Shape, n: usize, seed: u64) -> PointSet {
    sample(shape, Sampling::Random, n, seed)
}

/// A cloud from the shared data beside the checkout, by folder and file, or `None` in a checkout without that folder.
pub(crate) fn shared(folder: &str, file: &str) -> Option<PointSet> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(folder);
    if !folder.is_dir() {
        eprintln!("no shared data beside this checkout: {file} is left out");
        return None;
    }
    let (points, _) = ply::read(&folder.join(file)).expect("a shared cloud can be read");
    Some(points)
}

/// The same cloud with radii that are this many times as large.
pub(crate) fn with_radii_times(mut points: PointSet, factor: f32) -> PointSet {
    points.radii.iter_mut().for_each(|r| *r *= factor);
    points
}

/// The same cloud with each radius multiplied by its own random factor of 1 to 3.
pub(crate) fn with_uneven_radii(mut points: PointSet, seed: u64) -> PointSet {
    let mut random = fastrand::Rng::with_seed(seed);
    points.radii.iter_mut().for_each(|r| *r *= 1.0 + 2.0 * random.f32());
    points
}

/// The square grid with each point moved by up to a quarter of the spacing, in its plane and off it.
pub(crate) fn jittered_grid(side: usize, seed: u64) -> PointSet {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut offset = || 0.5 * (random.f32() - 0.5);
    let mut points = square_grid(side);
    points.positions.iter_mut().for_each(|p| *p += Vec3::new(offset(), offset(), 0.2 * offset()));
    points.radii = natural_radii(&points.positions, &points.normals);
    points
}

/// The points of a cloud in another order, with their attributes left out.
pub(crate) fn shuffled(points: &PointSet, seed: u64) -> PointSet {
    let mut order: Vec<usize> = (0..points.len()).collect();
    fastrand::Rng::with_seed(seed).shuffle(&mut order);
    let pick = |column: &[Vec3]| order.iter().map(|&i| column[i]).collect();
    let radii = order.iter().map(|&i| points.radii[i]).collect();
    PointSet::new(pick(&points.positions), pick(&points.normals), radii)
}

/// Both clouds in one, the second after the first.
pub(crate) fn joined(mut first: PointSet, second: &PointSet) -> PointSet {
    first.positions.extend(&second.positions);
    first.normals.extend(&second.normals);
    first.radii.extend(&second.radii);
    first
}
