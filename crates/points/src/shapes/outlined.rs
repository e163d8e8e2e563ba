//! Surfaces with creases, corners or rims that have points of their own (section 6 of the paper).

use std::f64::consts::{PI, TAU};
use std::fmt;

use fastrand::Rng;
use glam::{DVec2, DVec3, Vec3};

use super::surface::{Shape, in_disc, in_square};
use super::{CANDIDATES, Sampling, UnknownName, blue_noise, find, natural_radii};
use crate::{Attribute, PointSet, Values};

/// Points on curves are this share of the mean spacing apart.
const ALONG: f64 = 0.9;
/// Radius of the cylinder, and half of its height.
const HALF: f64 = 0.5;
/// Radius of the hole.
const HOLE: f64 = 0.4;

/// A surface with curves: creases between faces, or rims where it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Outlined {
    /// `|x|, |y|, |z| <= 0.5`: six faces, twelve edges, eight corners.
    Cube,
    /// `x² + y² <= 0.25, |z| <= 0.5`: a mantle and two flat ends.
    Cylinder,
    /// `x² + y² + z² = 1, z >= 0`; it ends at a circle.
    Hemisphere,
    /// `z = 0.4 (x² - y²)` over the square `|x|, |y| <= 1`; it ends over the square's sides.
    SaddleRim,
    /// `z = 0` over the square `|x|, |y| <= 1` less the disc of radius 0.4 in its middle; its normals are +z.
    Hole,
}

/// A point with its normals: one, or one for each face that meets there.
type Oriented = (DVec3, Vec<DVec3>);

impl Outlined {
    /// Every surface.
    pub const ALL: [Self; 5] =
        [Self::Cube, Self::Cylinder, Self::Hemisphere, Self::SaddleRim, Self::Hole];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cube => "cube",
            Self::Cylinder => "cylinder",
            Self::Hemisphere => "hemisphere",
            Self::SaddleRim => "saddle-rim",
            Self::Hole => "hole",
        }
    }

    /// Whether its curves are creases; else they are rims.
    pub fn is_creased(self) -> bool {
        matches!(self, Self::Cube | Self::Cylinder)
    }

    fn area(self) -> f64 {
        match self {
            Self::Cube => 6.0,
            Self::Cylinder => 1.5 * PI,
            Self::Hemisphere => TAU,
            Self::SaddleRim => Shape::Saddle.area(),
            Self::Hole => 4.0 - PI * HOLE * HOLE,
        }
    }

    /// A random point, area-uniform, with its normal.
    fn draw(self, random: &mut Rng) -> (DVec3, DVec3) {
        match self {
            Self::Cube => {
                let (face, DVec2 { x, y }) = (random.usize(0..6), HALF * in_square(random));
                let side = if face < 3 { HALF } else { -HALF };
                let at = |first: f64, [u, v]: [f64; 2]| match face % 3 {
                    0 => DVec3::new(first, u, v),
                    1 => DVec3::new(u, first, v),
                    _ => DVec3::new(u, v, first),
                };
                (at(side, [x, y]), at(side.signum(), [0.0; 2]))
            }
            Self::Cylinder => {
                // The ends have a third of the area.
                let (part, across) = (random.u8(0..6), in_disc(random));
                if part < 2 {
                    let normal = if part == 0 { DVec3::Z } else { DVec3::NEG_Z };
                    ((HALF * across).extend(HALF * normal.z), normal)
                } else {
                    let normal = across.normalize().extend(0.0);
                    (HALF * normal + DVec3::Z * (random.f64() - HALF), normal)
                }
            }
            Self::Hemisphere => {
                let x = Shape::Sphere.draw(random);
                let x = x.with_z(x.z.abs());
                (x, x)
            }
            Self::SaddleRim => {
                let x = Shape::Saddle.draw(random);
                (x, Shape::Saddle.unit_normal(x))
            }
            Self::Hole => loop {
                let foot = in_square(random);
                if foot.length() >= HOLE {
                    return (foot.extend(0.0), DVec3::Z);
                }
            },
        }
    }

    /// Points on the curves, evenly spaced and no farther apart than this, corners among them.
    fn curve_points(self, spacing: f64) -> Vec<Oriented> {
        match self {
            Self::Cube => cube_edges(spacing),
            Self::Cylinder => {
                let ends = [DVec3::Z, DVec3::NEG_Z].into_iter();
                ends.flat_map(|end| {
                    let on_end = move |around: DVec2| {
                        let normal = around.extend(0.0);
                        (HALF * (normal + end), vec![normal, end])
                    };
                    circle(HALF, spacing).into_iter().map(on_end)
                })
                .collect()
            }
            Self::Hemisphere => {
                let on_rim = |around: DVec2| (around.extend(0.0), vec![around.extend(0.0)]);
                circle(1.0, spacing).into_iter().map(on_rim).collect()
            }
            Self::SaddleRim => {
                let on_rim = |foot: DVec2| {
                    let x = super::surface::on_saddle(foot);
                    (x, vec![Shape::Saddle.unit_normal(x)])
                };
                // A side is 1.1 times as long as what it lies over.
                square(spacing / 1.1).into_iter().map(on_rim).collect()
            }
            Self::Hole => {
                let inner = circle(HOLE, spacing).into_iter().map(|around| HOLE * around);
                let rims = square(spacing).into_iter().chain(inner);
                rims.map(|foot| (foot.extend(0.0), vec![DVec3::Z])).collect()
            }
        }
    }
}

impl fmt::Display for Outlined {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl std::str::FromStr for Outlined {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        find("shape", &Self::ALL, name)
    }
}

/// Directions on a circle, evenly spaced: no sine of the system's is asked.
fn circle(radius: f64, spacing: f64) -> Vec<DVec2> {
    let count = (TAU * radius / spacing).ceil().max(3.0);
    let step = TAU / count;
    // Taylor's series of the half angle, which is below 1.05.
    let (mut sine, mut cosine, mut term) = (0.0, 0.0, 1.0);
    for power in 0..30 {
        match power % 4 {
            0 => cosine += term,
            1 => sine += term,
            2 => cosine -= term,
            _ => sine -= term,
        }
        term *= 0.5 * step / f64::from(power + 1);
    }
    let half = DVec2::new(cosine, sine).normalize();
    let turn = half.rotate(half);
    let first = DVec2::X;
    std::iter::successors(Some(first), |at| Some(turn.rotate(*at).normalize()))
        .take(count as usize)
        .collect()
}

/// Points on the outline of the square `|x|, |y| <= 1`.
fn square(spacing: f64) -> Vec<DVec2> {
    let count = (2.0 / spacing).ceil() as u32;
    let corners =
        [DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0), DVec2::ONE, DVec2::new(-1.0, 1.0)];
    let side = |i: usize| {
        let (from, to) = (corners[i], corners[(i + 1) % 4]);
        (0..count).map(move |k| from + (to - from) * (f64::from(k) / f64::from(count)))
    };
    (0..4).flat_map(side).collect()
}

fn cube_edges(spacing: f64) -> Vec<Oriented> {
    let count = (1.0 / spacing).ceil() as u32;
    let sides = [-1.0, 1.0];
    let mut points = Vec::new();
    for a in sides {
        for b in sides {
            for c in sides {
                let normals = vec![DVec3::X * a, DVec3::Y * b, DVec3::Z * c];
                points.push((HALF * DVec3::new(a, b, c), normals));
            }
        }
    }
    for axis in 0..3 {
        let [along, u, v] = [0, 1, 2].map(|i| DVec3::AXES[(axis + i) % 3]);
        for (a, b) in sides.into_iter().flat_map(|a| sides.map(|b| (a, b))) {
            for k in 1..count {
                let t = f64::from(k) / f64::from(count) - HALF;
                points.push((along * t + HALF * (u * a + v * b), vec![u * a, v * b]));
            }
        }
    }
    points
}

/// `n` points: those on the curves come first and have 0.9 of the mean spacing, the others are even or random.
/// There are more than `n` if the curves have as many.
///
/// Points on creases have their further normals in `nx2 ny2 nz2` and, at corners, `nx3 ny3 nz3`, and say in `kind` what
/// they are: 0 smooth, 1 crease, 2 corner. Those on rims have a 1 in `rim`. Radii are natural; a crease point has the
/// largest of its sides.
pub fn sample_outlined(shape: Outlined, sampling: Sampling, n: usize, seed: u64) -> PointSet {
    let mut random = Rng::with_seed(seed);
    let area = shape.area();
    // The side of the triangles of an even cloud.
    let spacing = (2.0 * area / (3f64.sqrt() * n.max(1) as f64)).sqrt();
    let mut points = shape.curve_points(ALONG * spacing);
    let fixed = points.len();
    let others = n.saturating_sub(fixed);
    let drawn = match sampling {
        Sampling::Random => others,
        Sampling::BlueNoise => CANDIDATES * others,
    };
    points.extend((0..drawn).map(|_| shape.draw(&mut random)).map(|(x, n)| (x, vec![n])));
    if sampling == Sampling::BlueNoise {
        let positions: Vec<Vec3> = points.iter().map(|p| p.0.as_vec3()).collect();
        let kept = blue_noise::thin_around(&positions, fixed, fixed + others, area);
        points = kept.into_iter().map(|i| points[i].clone()).collect();
    }
    assemble(shape, &points, fixed)
}

/// Columns of the points, of which the first `fixed` lie on curves.
fn assemble(shape: Outlined, points: &[Oriented], fixed: usize) -> PointSet {
    let positions: Vec<Vec3> = points.iter().map(|p| p.0.as_vec3()).collect();
    let normal = |p: &Oriented, side: usize| p.1.get(side).map_or(Vec3::ZERO, |n| n.as_vec3());
    let normals: Vec<Vec3> = points.iter().map(|p| normal(p, 0)).collect();
    // Each side of a crease has neighbours of its own.
    let mut all = (positions.clone(), normals.clone());
    let mut owners: Vec<usize> = (0..points.len()).collect();
    for (i, (x, sides)) in points.iter().enumerate() {
        for side in &sides[1..] {
            all.0.push(x.as_vec3());
            all.1.push(side.as_vec3());
            owners.push(i);
        }
    }
    let mut radii = vec![0f32; points.len()];
    for (radius, owner) in natural_radii(&all.0, &all.1).into_iter().zip(owners) {
        radii[owner] = radii[owner].max(radius);
    }
    let mut cloud = PointSet::new(positions, normals, radii);
    if shape.is_creased() {
        for (name, side) in [("2", 1), ("3", 2)] {
            for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                let values = points.iter().map(|p| normal(p, side)[axis]).collect();
                let name = format!("n{letter}{name}");
                cloud.attributes.push(Attribute::new(name, Values::F32(values)));
            }
        }
        let kinds = points.iter().map(|p| p.1.len() as u8 - 1).collect();
        cloud.attributes.push(Attribute::new("kind", Values::U8(kinds)));
    } else {
        let marks = (0..points.len()).map(|i| u8::from(i < fixed)).collect();
        cloud.attributes.push(Attribute::new("rim", Values::U8(marks)));
    }
    cloud
}

/// The same points with one record for each normal: those of one point follow each other, and the properties of further
/// normals are gone. The other way in which files say what a crease is.
pub fn one_record_a_normal(points: &PointSet) -> PointSet {
    let is_further = |name: &str| ["nx", "ny", "nz"].iter().any(|n| name.starts_with(n));
    let column = |name: &str| match points.attribute(name).map(|a| &a.values) {
        Some(Values::F32(values)) => Some(values),
        _ => None,
    };
    let mut result = PointSet::default();
    let mut kept = Vec::new();
    for i in 0..points.len() {
        let component = |name: &str| column(name).map_or(0.0, |values| values[i]);
        let further = ["2", "3"].map(|rank| {
            Vec3::from_array(["nx", "ny", "nz"].map(|n| component(&format!("{n}{rank}"))))
        });
        let further = further.into_iter().filter(|n| *n != Vec3::ZERO);
        for normal in std::iter::once(points.normals[i]).chain(further) {
            result.positions.push(points.positions[i]);
            result.normals.push(normal);
            result.radii.push(points.radii[i]);
            kept.push(i);
        }
    }
    for attribute in points.attributes.iter().filter(|a| !is_further(&a.name)) {
        let Values::U8(column) = &attribute.values else { continue };
        let values = Values::U8(kept.iter().map(|&i| column[i]).collect());
        result.attributes.push(Attribute { values, ..attribute.clone() });
    }
    result
}
