//! Generated clouds: points on surfaces with a formula, regular lattices, and natural radii for any cloud.
//!
//! The same call gives the same bytes on every platform: coordinates come from additions, multiplications, divisions
//! and square roots alone, which IEEE 754 rounds in one way, never from a system library's sine or power.

mod blue_noise;
mod outlined;
mod radii;
mod surface;

pub use outlined::{Outlined, one_record_a_normal, sample_outlined};
pub use radii::{natural_radii, natural_radii_of};
pub use surface::Shape;

use std::collections::HashMap;
use std::fmt;
use std::str::FromStr;

use fastrand::Rng;
use glam::{DVec3, Vec3};

use crate::{Model, PointSet};

/// Radii exceed the distance to the farthest natural neighbour by this factor.
pub(crate) const RADIUS_FACTOR: f64 = 1.25;

/// Blue noise is chosen from this many times as many random points; Yuksel (2015) advises 5, more are more even.
const CANDIDATES: usize = 8;

/// How points are spread over a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sampling {
    /// Even but irregular: weighted sample elimination (Yuksel 2015) from eight times as many random points.
    BlueNoise,
    /// Each point anywhere on the surface, every piece of equal area equally likely: clusters and gaps are meant.
    Random,
}

/// A name that stands for no shape or no sampling.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} {name:?}: use one of {known}")]
pub struct UnknownName {
    /// What was to be named: `shape` or `sampling`.
    pub what: &'static str,
    /// The name that was given.
    pub name: String,
    /// The names there are, separated by commas.
    pub known: String,
}

/// The item of that name.
fn find<T: Copy + fmt::Display>(
    what: &'static str,
    all: &[T],
    name: &str,
) -> Result<T, UnknownName> {
    all.iter().copied().find(|item| item.to_string() == name).ok_or_else(|| {
        let known = all.iter().map(T::to_string).collect::<Vec<_>>().join(", ");
        UnknownName { what, name: name.into(), known }
    })
}

impl Shape {
    /// Every shape.
    pub const ALL: [Self; 5] =
        [Self::Sphere, Self::Torus, Self::Ellipsoid, Self::Saddle, Self::Plane];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Torus => "torus",
            Self::Ellipsoid => "ellipsoid",
            Self::Saddle => "saddle",
            Self::Plane => "plane",
        }
    }
}

impl Sampling {
    /// Every sampling.
    pub const ALL: [Self; 2] = [Self::BlueNoise, Self::Random];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::BlueNoise => "blue-noise",
            Self::Random => "random",
        }
    }
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl fmt::Display for Sampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Shape {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        find("shape", &Self::ALL, name)
    }
}

impl FromStr for Sampling {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        find("sampling", &Self::ALL, name)
    }
}

/// `n` points on a shape, with exact normals and natural radii ([`natural_radii`]).
///
/// The same arguments give the same bytes on every platform.
pub fn sample(shape: Shape, sampling: Sampling, n: usize, seed: u64) -> PointSet {
    let mut random = Rng::with_seed(seed);
    let mut points: Vec<DVec3> = match sampling {
        Sampling::Random => (0..n).map(|_| shape.draw(&mut random)).collect(),
        Sampling::BlueNoise => (0..CANDIDATES * n).map(|_| shape.draw(&mut random)).collect(),
    };
    if sampling == Sampling::BlueNoise {
        let positions: Vec<Vec3> = points.iter().map(|p| p.as_vec3()).collect();
        let kept = blue_noise::thin(&positions, n, shape.area());
        points = kept.into_iter().map(|i| points[i]).collect();
    }
    let positions: Vec<Vec3> = points.iter().map(|p| p.as_vec3()).collect();
    let normals: Vec<Vec3> = points.iter().map(|&p| shape.unit_normal(p).as_vec3()).collect();
    let radii = natural_radii(&positions, &normals);
    PointSet::new(positions, normals, radii)
}

/// The vertices of an icosahedron on the unit sphere, its faces split in four `subdivisions` times with the new
/// vertices pushed to the sphere: `10 * 4^subdivisions + 2` points, so 12, 42, 162, 642, ...
///
/// Radii are 1.25 times the longest edge at the vertex. Beyond 13 subdivisions the indices overflow.
pub fn icosphere(subdivisions: u32) -> PointSet {
    let (mut vertices, mut faces) = icosahedron();
    for _ in 0..subdivisions {
        faces = split_faces(&mut vertices, &faces);
    }
    let positions: Vec<Vec3> = vertices.iter().map(|v| v.as_vec3()).collect();
    let longest = Model::mesh(vertices, faces).longest_edges();
    let radii = longest.iter().map(|length| (RADIUS_FACTOR * length) as f32).collect();
    PointSet::new(positions.clone(), positions, radii)
}

/// Vertices and faces of the regular icosahedron on the unit sphere.
fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let signs = [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)];
    let in_xy = signs.map(|(s, g)| DVec3::new(s, g, 0.0));
    let in_yz = signs.map(|(s, g)| DVec3::new(0.0, s, g));
    let in_zx = signs.map(|(s, g)| DVec3::new(g, 0.0, s));
    let vertices = [in_xy, in_yz, in_zx].concat().into_iter().map(DVec3::normalize).collect();
    let faces = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    (vertices, faces.to_vec())
}

/// Splits every face in four at the midpoints of its edges, which are added to the vertices once an edge.
fn split_faces(vertices: &mut Vec<DVec3>, faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut midpoints = HashMap::new();
    let mut midpoint = |a: u32, b: u32| {
        *midpoints.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let sum = vertices[a as usize] + vertices[b as usize];
            vertices.push(sum.normalize());
            vertices.len() as u32 - 1
        })
    };
    let mut split = Vec::with_capacity(4 * faces.len());
    for &[a, b, c] in faces {
        let (ab, bc, ca) = (midpoint(a, b), midpoint(b, c), midpoint(c, a));
        split.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    split
}

/// `side * side` points of spacing 1 in the plane z = 0, x running fastest from the origin, normals +z.
///
/// Radii are 1.25 times the diagonal: the Voronoi cells of diagonal neighbours touch in a corner, a tie that is meant.
pub fn square_grid(side: usize) -> PointSet {
    let rows = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
    let positions = rows.map(|(x, y)| Vec3::new(x as f32, y as f32, 0.0)).collect();
    flat(positions, RADIUS_FACTOR * 2f64.sqrt())
}

/// The triangular lattice of spacing 1 in the plane z = 0, `rings` rings around the origin: `3 rings (rings + 1) + 1`
/// points in rows along x, normals +z, radii 1.25. The regular case of sqrt(3) refinement.
pub fn hexagonal_grid(rings: usize) -> PointSet {
    let rings = rings as i64;
    let row_height = 0.75f64.sqrt();
    let mut positions = Vec::new();
    for row in -rings..=rings {
        let (first, last) = ((-rings).max(-rings - row), rings.min(rings - row));
        for column in first..=last {
            let x = column as f64 + 0.5 * row as f64;
            positions.push(Vec3::new(x as f32, (row_height * row as f64) as f32, 0.0));
        }
    }
    flat(positions, RADIUS_FACTOR)
}

/// A cloud in the plane z = 0 with one radius for all.
fn flat(positions: Vec<Vec3>, radius: f64) -> PointSet {
    let n = positions.len();
    PointSet::new(positions, vec![Vec3::Z; n], vec![radius as f32; n])
}
