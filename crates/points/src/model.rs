//! What a file shows: a cloud or a mesh, as it came.

use crate::{Attribute, PointSet, Values};
use glam::{DVec3, Vec3};

/// A cloud or a triangle mesh with whatever a file says of it, in the file's own coordinates.
///
/// A [`PointSet`] is fit for refinement; a model need not be: normals and radii may be missing, of any length, or not
/// finite. Positions are finite and corners exist in models that [`ply::read_model`](crate::ply::read_model) returns.
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

impl Model {
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
        Some(self.positions.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p))))
    }

    /// The unit normal of each vertex of a mesh: the triangles' normals weighted with the angle at the vertex. Zero where
    /// there is no triangle of any area.
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
