//! What a file shows: a cloud or a mesh, as it came.

use crate::shapes::{RADIUS_FACTOR, natural_radii};
use crate::{Attribute, PointSet, Values};
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// A cloud or a triangle mesh with whatever a file says of it, in the file's own coordinates.
///
/// A [`PointSet`] is fit for refinement; a model need not be: normals and radii may be missing, of any length, or not
/// finite. Every column has one entry a point. Positions are finite and corners exist in models that
/// [`ply::read_model`](crate::ply::read_model) returns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// Coordinates of the points, or of the vertices of the mesh.
    pub positions: Vec<DVec3>,
    /// Normals as the file gives them.
    pub normals: Option<Vec<Vec3>>,
    /// Radii as the file gives them.
    pub radii: Option<Vec<f32>>,
    /// Every further scalar property, in the order of the file.
    pub attributes: Vec<Attribute>,
    /// The corners of each triangle, anticlockwise seen from outside; empty for a cloud.
    pub triangles: Vec<[u32; 3]>,
}

/// What [`Model::to_points`] made up or mended: how many points each concerns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Completed {
    /// Normals made of the triangles at the vertex.
    pub made_normals: usize,
    /// Normals of the file that were brought to unit length.
    pub scaled_normals: usize,
    /// Normals of the file that are zero or not finite, and zero now.
    pub unusable_normals: usize,
    /// Radii made of the edges at the vertex, or of the natural neighbours of the point.
    pub made_radii: usize,
    /// Radii of the file that are negative or not finite, and 0 now.
    pub unusable_radii: usize,
}

impl Model {
    /// A mesh without further properties. The triangles hold indices of positions, anticlockwise seen from outside.
    pub fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self { positions, triangles, ..Self::default() }
    }

    /// Number of points or vertices.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Whether there are triangles.
    pub fn is_mesh(&self) -> bool {
        !self.triangles.is_empty()
    }

    /// The attribute of that name.
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name == name)
    }

    /// Colours, if there are properties `red`, `green` and `blue` of type `uchar`.
    pub fn colors(&self) -> Option<Vec<[u8; 3]>> {
        let channel = |name| match self.attribute(name).map(|a| &a.values) {
            Some(Values::U8(values)) => Some(values),
            _ => None,
        };
        let (red, green, blue) = (channel("red")?, channel("green")?, channel("blue")?);
        Some(red.iter().zip(green).zip(blue).map(|((&r, &g), &b)| [r, g, b]).collect())
    }

    /// Corners of the bounding box; `None` without points.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let first = *self.positions.first()?;
        Some(
            self.positions.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p))),
        )
    }

    /// The unit normal of each vertex of a mesh: the triangles' normals weighted with the angle at the vertex. Zero where
    /// there is no triangle of any area.
    ///
    /// # Panics
    /// If a triangle has a corner that does not exist.
    pub fn vertex_normals(&self) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; self.len()];
        for corners in &self.triangles {
            let p = corners.map(|c| self.positions[c as usize]);
            let normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
            for i in 0..3 {
                let (a, b) = (p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]);
                sums[corners[i] as usize] += normal * a.cross(b).length().atan2(a.dot(b));
            }
        }
        sums.into_iter().map(DVec3::normalize_or_zero).collect()
    }

    /// The length of the longest edge at each vertex of a mesh, 0 where there is no triangle.
    ///
    /// # Panics
    /// If a triangle has a corner that does not exist.
    pub fn longest_edges(&self) -> Vec<f64> {
        let mut longest = vec![0.0f64; self.len()];
        for &[a, b, c] in &self.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (from, to) = (from as usize, to as usize);
                let length = self.positions[from].distance(self.positions[to]);
                longest[from] = longest[from].max(length);
                longest[to] = longest[to].max(length);
            }
        }
        longest
    }

    /// A point set for drawing, and how many of its normals and radii are not the file's own.
    ///
    /// * Positions are relative to a round point near the centre. An axis whose coordinates are all exact in 32-bit
    ///   floats keeps them, with origin 0.
    /// * Normals have unit length, or are zero: where the file's is zero or not finite, and where there is none and no
    ///   triangle to make one of.
    /// * Radii that the file does not give are 1.25 times the longest edge at the vertex of a mesh,
    ///   [`natural_radii`] of a cloud with normals, and 0 otherwise. Those that are negative or not finite are 0.
    /// * Attributes are the model's.
    ///
    /// # Panics
    /// If a triangle has a corner that does not exist.
    pub fn to_points(&self) -> (PointSet, Completed) {
        let mut made = Completed::default();
        let origin = self.origin();
        let positions: Vec<Vec3> = self.positions.iter().map(|&p| (p - origin).as_vec3()).collect();
        let normals = self.unit_normals(&mut made);
        let radii = self.drawn_radii(&positions, &normals, &mut made);
        let attributes = self.attributes.clone();
        (PointSet { positions, normals, radii, attributes, origin }, made)
    }

    /// An origin for the axes with coordinates that are not exact in 32-bit floats; 0 on the others.
    fn origin(&self) -> DVec3 {
        let exact = |c: f64| f64::from(c as f32) == c;
        let wide = [0, 1, 2].map(|axis| self.positions.iter().any(|p| !exact(p[axis])));
        match self.bounds() {
            Some((low, high)) => round_center([0, 1, 2].map(|a| (low[a], high[a])), wide),
            None => DVec3::ZERO,
        }
    }

    fn unit_normals(&self, made: &mut Completed) -> Vec<Vec3> {
        let Some(normals) = &self.normals else {
            let normals: Vec<Vec3> = self.vertex_normals().iter().map(|n| n.as_vec3()).collect();
            made.made_normals = normals.iter().filter(|n| **n != Vec3::ZERO).count();
            return normals;
        };
        let unit = |&n: &Vec3| {
            if !n.is_finite() || n == Vec3::ZERO {
                made.unusable_normals += 1;
                Vec3::ZERO
            } else if (n.length_squared() - 1.0).abs() > 1e-6 {
                made.scaled_normals += 1;
                n.as_dvec3().normalize().as_vec3()
            } else {
                n
            }
        };
        normals.iter().map(unit).collect()
    }

    fn drawn_radii(&self, positions: &[Vec3], normals: &[Vec3], made: &mut Completed) -> Vec<f32> {
        let radii: Vec<f32> = match &self.radii {
            Some(radii) => {
                let usable = |r: &f32| r.is_finite() && *r >= 0.0;
                made.unusable_radii = radii.iter().filter(|r| !usable(r)).count();
                return radii.iter().map(|&r| if usable(&r) { r } else { 0.0 }).collect();
            }
            None if self.is_mesh() => {
                self.longest_edges().iter().map(|edge| (RADIUS_FACTOR * edge) as f32).collect()
            }
            None if self.normals.is_some() => natural_radii_once(positions, normals),
            None => vec![0.0; self.len()],
        };
        made.made_radii = radii.iter().filter(|&&r| r > 0.0).count();
        radii
    }
}

impl From<&PointSet> for Model {
    /// The points with their origin added.
    fn from(points: &PointSet) -> Self {
        Self {
            positions: points.positions.iter().map(|p| points.origin + p.as_dvec3()).collect(),
            normals: Some(points.normals.clone()),
            radii: Some(points.radii.clone()),
            attributes: points.attributes.clone(),
            triangles: Vec::new(),
        }
    }
}

/// The radii of [`natural_radii`], which sees points with the same position and normal once: scanners put all that they
/// missed into one place, where each point would look at all the others.
fn natural_radii_once(positions: &[Vec3], normals: &[Vec3]) -> Vec<f32> {
    let bits = |v: &Vec3| v.to_array().map(f32::to_bits);
    let mut seen = HashMap::with_capacity(positions.len());
    let (mut places, mut directions) = (Vec::new(), Vec::new());
    let mut place = |(p, n): (&Vec3, &Vec3)| {
        *seen.entry((bits(p), bits(n))).or_insert_with(|| {
            places.push(*p);
            directions.push(*n);
            places.len() - 1
        })
    };
    let indices: Vec<usize> = positions.iter().zip(normals).map(&mut place).collect();
    // A power of two brings the cloud to a size of about 1: products of its coordinates stay floats, no digit is lost.
    let scale = places.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
    let scale = if scale > 0.0 { (-f64::from(scale).log2().floor()).exp2() } else { 1.0 };
    places.iter_mut().for_each(|p| *p = (p.as_dvec3() * scale).as_vec3());
    let radii = natural_radii(&places, &directions);
    indices.into_iter().map(|index| (f64::from(radii[index]) / scale) as f32).collect()
}

/// The centre of a bounding box, rounded to about the size of the box, on the axes that `wanted` names; 0 on the others
/// and where the bounds are not finite.
pub(crate) fn round_center(bounds: [(f64, f64); 3], wanted: [bool; 3]) -> DVec3 {
    let size = bounds.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    // The largest power of two in the size: all bits but those of the exponent go.
    let step = f64::from_bits(size.to_bits() & f64::INFINITY.to_bits());
    let axis = |axis: usize| {
        let (low, high) = bounds[axis];
        let middle = low + (high - low) / 2.0;
        let round = if step > 0.0 { (middle / step).round() * step } else { middle };
        // Adding 0 makes a zero positive. Values that are not finite are for the validation to find.
        if wanted[axis] && round.is_finite() { round + 0.0 } else { 0.0 }
    };
    DVec3::new(axis(0), axis(1), axis(2))
}
