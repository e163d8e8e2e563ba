//! The true surface: a mesh or a cloud.

mod corners;
mod mesh;
mod points;

use serde::Serialize;
use surfine_points::{DVec3, Model};

use crate::error::{Unfit, check, check_length};
use mesh::Mesh;
use points::Points;

/// The surface that an output should show, ready for questions about its closest points.
pub struct Truth {
    surface: Surface,
    summary: TruthSummary,
}

enum Surface {
    Mesh(Box<Mesh>),
    Points(Box<Points>),
}

/// What distances are measured to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TruthKind {
    /// The triangles of a mesh.
    Mesh,
    /// The tangent plane of the nearest point; the point itself where it has no normal.
    TangentPlanes,
    /// The nearest point.
    Points,
}

/// What is known of the truth itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TruthSummary {
    /// What distances are measured to.
    pub kind: TruthKind,
    /// Points, or vertices of the mesh.
    pub points: usize,
    /// Triangles of the mesh that have an area.
    pub triangles: usize,
    /// Triangles without area, which were left out: two corners in one place, or all in a line.
    pub degenerate_triangles: usize,
    /// Edges where two triangles meet at more than the crease angle.
    pub sharp_edges: usize,
    /// Edges that their two triangles run through in the same direction: one of the two shows its back.
    pub inconsistent_edges: usize,
    /// Points whose normal is zero or not finite.
    pub bad_normals: usize,
    /// Area of the mesh in squared units of the file.
    pub area: Option<f64>,
    /// Diagonal of the bounding box of the points, or of the triangles, in units of the file.
    pub diagonal: f64,
}

/// The point of the truth that belongs to a point in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The closest point of the mesh, the foot on the tangent plane, or the nearest point; units of the file.
    pub position: DVec3,
    /// Unit normal there, if one is known.
    pub normal: Option<DVec3>,
    /// Red, green and blue there, 0 to 255, if known.
    pub color: Option<[f64; 3]>,
    /// Distance from the asked point to `position`, units of the file.
    pub distance: f64,
}

/// A point taken from the truth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) position: DVec3,
    pub(crate) normal: Option<DVec3>,
}

impl Truth {
    /// Angle between the normals of two triangles from which their common edge is a crease, degrees.
    pub const CREASE_ANGLE: f64 = 40.0;

    /// A truth with the usual crease angle, [`Truth::CREASE_ANGLE`].
    ///
    /// A model with triangles is a mesh, whatever normals its vertices have: those of the mesh come from its triangles.
    /// Vertices in the same place are one. Other models are clouds.
    ///
    /// # Errors
    /// The first thing in the model that makes it unfit, see [`Unfit`].
    pub fn new(model: &Model) -> Result<Self, Unfit> {
        Self::with_crease_angle(model, Self::CREASE_ANGLE)
    }

    /// A truth with a crease angle in degrees, 0 to 180. It has no meaning for a cloud.
    ///
    /// The normal of a mesh at a triangle's corner is the mean, weighted with their angles there, of those triangles
    /// around the vertex whose normals are within the crease angle of the triangle's own. Inside the triangle the
    /// three are interpolated. That is the usual vertex normal where a mesh is smooth, and one normal a side at a crease.
    ///
    /// # Errors
    /// The first thing in the model that makes it unfit, see [`Unfit`].
    pub fn with_crease_angle(model: &Model, degrees: f64) -> Result<Self, Unfit> {
        check(model, "truth")?;
        let truth = if model.is_mesh() {
            let (mesh, summary) = Mesh::new(model, degrees)?;
            Self { surface: Surface::Mesh(Box::new(mesh)), summary }
        } else {
            let (points, summary) = Points::new(model)?;
            Self { surface: Surface::Points(Box::new(points)), summary }
        };
        check_length(truth.summary.diagonal, "diagonal", "truth")?;
        Ok(truth)
    }

    /// What is known of the truth itself.
    pub fn summary(&self) -> &TruthSummary {
        &self.summary
    }

    /// The point of the truth that belongs to `position`.
    ///
    /// At a crease there is a normal for each side, and a cloud may have several points in one place. The one that
    /// agrees best with `normal` counts, if there is one. A position is at a crease of a mesh if its closest point is no
    /// farther from it than a millionth of the diagonal or of the largest coordinate: some steps of a 32-bit number.
    pub fn nearest(&self, position: DVec3, normal: Option<DVec3>) -> Closest {
        match &self.surface {
            Surface::Mesh(mesh) => mesh.nearest(position, normal),
            Surface::Points(points) => points.nearest(position, normal),
        }
    }

    /// Whether `position` is closer than `reach` to a sharp edge. Clouds have none.
    pub fn crease_within(&self, position: DVec3, reach: f64) -> bool {
        match &self.surface {
            Surface::Mesh(mesh) => mesh.crease_within(position, reach),
            Surface::Points(_) => false,
        }
    }

    /// About `count` points spread evenly over a mesh, or all points of a cloud.
    pub(crate) fn samples(&self, count: usize, seed: u64) -> Vec<Sample> {
        match &self.surface {
            Surface::Mesh(mesh) => mesh.samples(count, seed),
            Surface::Points(points) => points.samples(),
        }
    }
}

/// Length of the diagonal of the bounding box; 0 without points.
fn diagonal(positions: impl Iterator<Item = DVec3> + Clone) -> f64 {
    let low = positions.clone().reduce(DVec3::min).unwrap_or(DVec3::ZERO);
    let high = positions.reduce(DVec3::max).unwrap_or(DVec3::ZERO);
    low.distance(high)
}
