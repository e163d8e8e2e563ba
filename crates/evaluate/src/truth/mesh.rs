//! A triangle mesh as the truth.

use fastrand::Rng;
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQueryWithLocation;
use parry3d_f64::shape::{Polyline, TriMesh};
use rayon::prelude::*;
use surfine_points::{DVec3, Model};

use super::corners::{Fans, face_normal};
use super::{Closest, Sample, TruthKind, TruthSummary, diagonal};
use crate::error::Unfit;
use crate::places::Places;

/// A mesh with a tree of its triangles and a normal for each of their corners.
pub(super) struct Mesh {
    shape: TriMesh,
    fans: Fans,
    corner_normals: Vec<[DVec3; 3]>,
    colors: Option<Vec<[u8; 3]>>,
    /// The sharp edges, if there are any.
    creases: Option<Polyline>,
    /// Whether each triangle has a corner on a sharp edge.
    at_crease: Vec<bool>,
    /// A point this close to an edge is on it.
    tolerance: f64,
    /// Area of all triangles up to each, itself included.
    areas: Vec<f64>,
}

impl Mesh {
    pub(super) fn new(model: &Model, crease_angle: f64) -> Result<(Self, TruthSummary), Unfit> {
        let places = Places::new(&model.positions);
        let triangles: Vec<[u32; 3]> =
            model.triangles.iter().copied().filter(|t| has_area(corners(model, *t))).collect();
        if triangles.is_empty() {
            return Err(Unfit::NoArea { triangles: model.triangles.len() });
        }
        let welded = triangles.iter().map(|t| t.map(|c| places.of_point[c as usize])).collect();
        let fans = Fans::new(welded, &places.positions, crease_angle);
        let edges = fans.edges();
        let mut on_crease = vec![false; places.len()];
        edges.sharp.iter().flatten().for_each(|&place| on_crease[place as usize] = true);
        let touches = |f: usize| fans.face(f).iter().any(|&place| on_crease[place as usize]);
        let used = triangles.iter().flatten().map(|&c| model.positions[c as usize]);
        let farthest = used.clone().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let areas = running_sum(triangles.iter().map(|&t| area(corners(model, t))));
        let summary = TruthSummary {
            kind: TruthKind::Mesh,
            points: model.len(),
            triangles: triangles.len(),
            degenerate_triangles: model.triangles.len() - triangles.len(),
            sharp_edges: edges.sharp.len(),
            inconsistent_edges: edges.inconsistent,
            bad_normals: 0,
            area: areas.last().copied(),
            diagonal: diagonal(used),
        };
        let mesh = Self {
            corner_normals: fans.corner_normals(),
            colors: model.colors(),
            at_crease: (0..triangles.len()).map(touches).collect(),
            creases: (!edges.sharp.is_empty()).then(|| polyline(&places.positions, edges.sharp)),
            tolerance: 1e-6 * summary.diagonal.max(farthest),
            areas,
            fans,
            shape: tri_mesh(&model.positions, triangles),
        };
        Ok((mesh, summary))
    }

    pub(super) fn nearest(&self, x: DVec3, normal: Option<DVec3>) -> Closest {
        let (projection, (face, location)) =
            self.shape.project_local_point_and_get_location(to_parry(x), false);
        let face = face as usize;
        let weights = location.barycentric_coordinates().unwrap_or([1.0, 0.0, 0.0]);
        let position = DVec3::from_array(projection.point.to_array());
        Closest {
            position,
            normal: Some(self.normal(face, weights, normal)),
            color: self.color(face, weights),
            distance: x.distance(position),
        }
    }

    pub(super) fn crease_within(&self, x: DVec3, reach: f64) -> bool {
        let Some(creases) = &self.creases else { return false };
        let found =
            creases.project_local_point_and_get_location_with_max_dist(to_parry(x), false, reach);
        found.is_some()
    }

    /// The normal at a point of a triangle; of the sides that meet there, the one that agrees best with `wanted`.
    fn normal(&self, face: usize, weights: [f64; 3], wanted: Option<DVec3>) -> DVec3 {
        let own = self.blend(face, weights);
        let Some(wanted) = wanted.filter(|_| self.at_crease[face]) else { return own };
        let mut best = own;
        self.visit_sides(face, weights, |normal| {
            if normal.dot(wanted) > best.dot(wanted) {
                best = normal;
            }
        });
        best
    }

    /// Calls `visit` with the normal that each triangle has at a point of this one, if the point is on an edge or a
    /// vertex that they share.
    fn visit_sides(&self, face: usize, weights: [f64; 3], mut visit: impl FnMut(DVec3)) {
        let places = self.fans.face(face);
        let on_side = self.sides_near(face, weights);
        let heaviest = (0..3).fold(0, |h, i| if weights[i] > weights[h] { i } else { h });
        match on_side.iter().filter(|&&on| on).count() {
            0 => {}
            1 => {
                let opposite = on_side.iter().position(|&on| on).unwrap_or(0);
                let (a, b) = ((opposite + 1) % 3, (opposite + 2) % 3);
                for (other, corner) in self.fans.around(places[a]) {
                    let end = self.fans.face(other).iter().position(|&p| p == places[b]);
                    if let Some(end) = end {
                        let normals = self.corner_normals[other];
                        let sum = normals[corner] * weights[a] + normals[end] * weights[b];
                        visit(sum.normalize_or(normals[corner]));
                    }
                }
            }
            _ => {
                for (other, corner) in self.fans.around(places[heaviest]) {
                    visit(self.corner_normals[other][corner]);
                }
            }
        }
    }

    /// Whether a point of a triangle is on the side opposite to each corner.
    fn sides_near(&self, face: usize, weights: [f64; 3]) -> [bool; 3] {
        let p = self.corners(face);
        let double_area = face_normal(p).length();
        [0, 1, 2].map(|i| {
            let side = p[(i + 1) % 3].distance(p[(i + 2) % 3]);
            weights[i] * double_area <= self.tolerance * side
        })
    }

    /// A triangle's own normal at a point of it.
    fn blend(&self, face: usize, weights: [f64; 3]) -> DVec3 {
        let normals = self.corner_normals[face];
        let sum = normals[0] * weights[0] + normals[1] * weights[1] + normals[2] * weights[2];
        sum.normalize_or(normals[0])
    }

    fn color(&self, face: usize, weights: [f64; 3]) -> Option<[f64; 3]> {
        let colors = self.colors.as_ref()?;
        let at = self.shape.indices()[face].map(|c| colors[c as usize].map(f64::from));
        Some([0, 1, 2].map(|channel| (0..3).map(|i| weights[i] * at[i][channel]).sum()))
    }

    fn corners(&self, face: usize) -> [DVec3; 3] {
        let vertices = self.shape.vertices();
        self.shape.indices()[face].map(|c| DVec3::from_array(vertices[c as usize].to_array()))
    }

    /// `count` points, each from its own share of the area in the order of the triangles.
    ///
    /// Within triangles they follow the additive recurrence with the plastic number (M. Roberts, "The Unreasonable
    /// Effectiveness of Quasirandom Sequences", 2018), any run of which is even too; the seed shifts it.
    pub(super) fn samples(&self, count: usize, seed: u64) -> Vec<Sample> {
        const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_2];
        let mut random = Rng::with_seed(seed);
        let shift = [random.f64(), random.f64()];
        let shares: Vec<f64> = (0..count).map(|i| i as f64 + random.f64()).collect();
        let total = self.areas.last().copied().unwrap_or(0.0);
        let sample = |(i, share): (usize, f64)| {
            let target = share / count as f64 * total;
            let face = self.areas.partition_point(|&a| a <= target).min(self.areas.len() - 1);
            let [u, v] = [0, 1].map(|k| (shift[k] + i as f64 * STEPS[k]).fract());
            // The square's upper half, turned, covers the triangle as its lower half does.
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let (p, weights) = (self.corners(face), [1.0 - u - v, u, v]);
            let position = p[0] + (p[1] - p[0]) * u + (p[2] - p[0]) * v;
            Sample { position, normal: Some(self.blend(face, weights)) }
        };
        shares.into_par_iter().enumerate().map(sample).collect()
    }
}

fn corners(model: &Model, triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|c| model.positions[c as usize])
}

fn area(p: [DVec3; 3]) -> f64 {
    0.5 * face_normal(p).length()
}

/// Whether a triangle has a normal that is more than rounding.
fn has_area(p: [DVec3; 3]) -> bool {
    let longest = (0..3).map(|i| p[i].distance_squared(p[(i + 1) % 3])).fold(0.0, f64::max);
    // Positions are rounded too, at their own scale.
    let rounding = f64::EPSILON * p.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
    let double_area = face_normal(p).length();
    double_area > 1e-14 * longest && double_area > rounding * longest.sqrt()
}

fn running_sum(values: impl Iterator<Item = f64>) -> Vec<f64> {
    values
        .scan(0.0, |sum, v| {
            *sum += v;
            Some(*sum)
        })
        .collect()
}

fn tri_mesh(positions: &[DVec3], triangles: Vec<[u32; 3]>) -> TriMesh {
    let vertices = positions.iter().map(|&p| to_parry(p)).collect();
    TriMesh::new(vertices, triangles).expect("there is a triangle")
}

fn polyline(positions: &[DVec3], edges: Vec<[u32; 2]>) -> Polyline {
    Polyline::new(positions.iter().map(|&p| to_parry(p)).collect(), Some(edges))
}

/// The same vector for parry, which may use another version of glam.
fn to_parry(v: DVec3) -> Vector {
    Vector::from_array(v.to_array())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The square from 0 to 10, cut into triangles of very different size; it faces up.
    fn square() -> Mesh {
        let corners = [(0, 0), (10, 0), (10, 10), (0, 10), (3, 1)];
        let positions = corners.map(|(x, y)| DVec3::new(x.into(), y.into(), 0.0)).to_vec();
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let model = Model { positions, triangles, ..Model::default() };
        Mesh::new(&model, 40.0).expect("the mesh is fit").0
    }

    #[test]
    fn samples_lie_on_the_mesh_more_evenly_than_random_points() {
        let mesh = square();
        for seed in 0..5 {
            let samples = mesh.samples(10_000, seed);
            let mut cells = [0.0f64; 100];
            for Sample { position: p, normal } in &samples {
                assert_eq!((p.z, *normal), (0.0, Some(DVec3::Z)));
                cells[p.y as usize * 10 + p.x as usize] += 1.0;
            }
            // About 1 for random points; 0.02 to 0.04 here.
            let variance = cells.iter().map(|c| (c - 100.0).powi(2)).sum::<f64>() / 100.0;
            assert!(variance / 100.0 < 0.15, "{}", variance / 100.0);
        }
    }

    #[test]
    fn each_triangle_gets_its_share_to_a_point() {
        let mesh = square();
        let mut counts = [0.0f64; 4];
        for sample in mesh.samples(997, 3) {
            let Vector { x, y, .. } = to_parry(sample.position);
            let at = mesh.shape.project_local_point_and_get_location(Vector::new(x, y, 0.0), false);
            counts[at.1.0 as usize] += 1.0;
        }
        for (count, area) in counts.into_iter().zip([5.0, 35.0, 45.0, 15.0]) {
            assert!((count - 9.97 * area).abs() <= 1.0, "{counts:?}");
        }
    }
}
