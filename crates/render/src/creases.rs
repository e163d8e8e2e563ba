//! Discs that end at a crease.
//!
//! A crease point has one normal for each of its sides: as further properties `nx2 ny2 nz2` and `nx3 ny3 nz3`, or as
//! records that share the position. Each side gets a disc, cut off where the planes of the others pass through it
//! (clipped splats, Zwicker et al. 2004).

use crate::splats::{Extra, Splats};
use crate::style::SOFT;
use glam::Vec3;
use std::collections::HashMap;
use surfine_points::{Grid, GridShape, PointSet, Values};

/// Records of one position are sides of a crease if their normals differ by more than this cosine says.
const ONE_SIDE: f32 = 0.98;

/// The sides of one crease point.
struct Crease {
    position: Vec3,
    radius: f32,
    /// The disc of each side and its normal.
    sides: Vec<(usize, Vec3)>,
}

/// Adds the discs of further normals, and gives discs at creases their ends.
pub(crate) fn cut(points: &PointSet, splats: &mut Splats) {
    let mut creases = further_normals(points, splats);
    creases.extend(shared_positions(points, splats));
    if creases.is_empty() {
        return;
    }
    splats.extras.resize(splats.points.len(), Extra::default());
    let positions: Vec<Vec3> = splats.points.iter().map(|p| p.position.into()).collect();
    let radii: Vec<f32> = splats.points.iter().map(|p| p.radius).collect();
    let grid = Grid::build(GridShape::fit(&positions, &radii), (0u32..).zip(positions));
    let mut is_smooth = vec![true; splats.len()];
    for &(disc, _) in creases.iter().flat_map(|crease| &crease.sides) {
        is_smooth[disc] = false;
    }
    // Sides have fixed places: other ends must find them there.
    let mut planes = Vec::new();
    for crease in &creases {
        let near = crease.neighbors(&grid, splats, &is_smooth);
        for (k, &(disc, _)) in crease.sides.iter().enumerate() {
            for (i, other) in crease.others(k).enumerate() {
                let (normal, is_concave) =
                    (crease.sides[other].1, crease.is_concave(&near, k, other));
                splats.extras[disc].end_at_side(i, normal, is_concave);
                let end = if is_concave { -normal } else { normal };
                for neighbor in near.iter().filter(|neighbor| neighbor.side == k) {
                    let place = -end.dot(neighbor.offset);
                    // A neighbour beyond the plane tells that the surface turns: a flat cut would be wrong.
                    if (0.0..SOFT * splats.points[neighbor.disc].radius).contains(&place) {
                        let distance = neighbor.offset.length();
                        planes.push((neighbor.disc, end, place, distance));
                    }
                }
            }
        }
    }
    planes.into_iter().for_each(|(i, end, at, far)| splats.extras[i].end_at_plane(end, at, far));
}

/// A disc near a crease point.
struct Neighbor {
    disc: usize,
    /// From the crease point.
    offset: Vec3,
    /// The side of the crease that it belongs to.
    side: usize,
    /// Whether it belongs to no crease itself.
    is_smooth: bool,
}

impl Crease {
    fn new(splats: &Splats, sides: Vec<(usize, Vec3)>) -> Self {
        let point = splats.points[sides[0].0];
        Self { position: point.position.into(), radius: point.radius, sides }
    }

    /// The discs within the radius, but those of the point itself.
    fn neighbors(&self, grid: &Grid, splats: &Splats, is_smooth: &[bool]) -> Vec<Neighbor> {
        let mut near = Vec::new();
        grid.visit_ball(self.position, self.radius, |j| {
            let disc = j as usize;
            let point = &splats.points[disc];
            let offset = Vec3::from(point.position) - self.position;
            if offset != Vec3::ZERO && offset.length() <= self.radius {
                let side = self.side_of(point.normal.into());
                near.push(Neighbor { disc, offset, side, is_smooth: is_smooth[disc] });
            }
        });
        near
    }

    /// The side whose normal is most like this one.
    fn side_of(&self, normal: Vec3) -> usize {
        let likeness = |k: &usize| self.sides[*k].1.dot(normal);
        let nearest = (0..self.sides.len()).max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        nearest.expect("a crease has sides")
    }

    fn others(&self, k: usize) -> impl Iterator<Item = usize> {
        (0..self.sides.len()).filter(move |&other| other != k)
    }

    /// Whether the smooth neighbours of a side lie above the plane of another.
    fn is_concave(&self, near: &[Neighbor], k: usize, other: usize) -> bool {
        let of_side = near.iter().filter(|neighbor| neighbor.is_smooth && neighbor.side == k);
        let above = |n: &Neighbor| n.offset.normalize_or_zero().dot(self.sides[other].1);
        of_side.map(above).sum::<f32>() > 0.0
    }
}

/// Points with further normals; each gets a disc at the end.
fn further_normals(points: &PointSet, splats: &mut Splats) -> Vec<Crease> {
    let columns = [["nx2", "ny2", "nz2"], ["nx3", "ny3", "nz3"]];
    let columns: Vec<[&[f32]; 3]> =
        columns.iter().filter_map(|names| vector_column(points, names)).collect();
    let mut creases = Vec::new();
    for i in 0..points.len() {
        let normal = |c: &[&[f32]; 3]| Vec3::new(c[0][i], c[1][i], c[2][i]).normalize_or_zero();
        let further = columns.iter().map(normal).filter(|n| *n != Vec3::ZERO);
        let mut sides = vec![(i, points.normals[i])];
        for normal in further {
            sides.push((splats.points.len(), normal));
            splats.push_copy(i, normal);
        }
        if sides.len() > 1 {
            creases.push(Crease::new(splats, sides));
        }
    }
    creases
}

fn vector_column<'a>(points: &'a PointSet, names: &[&str; 3]) -> Option<[&'a [f32]; 3]> {
    let column = |name| match points.attribute(name).map(|a| &a.values) {
        Some(Values::F32(values)) => Some(&values[..]),
        _ => None,
    };
    Some([column(names[0])?, column(names[1])?, column(names[2])?])
}

/// Two or three records of one position with different normals.
fn shared_positions(points: &PointSet, splats: &Splats) -> Vec<Crease> {
    let key = |i: usize| points.positions[i].to_array().map(f32::to_bits);
    let mut groups: HashMap<_, Vec<usize>> = HashMap::new();
    (0..points.len()).for_each(|i| groups.entry(key(i)).or_default().push(i));
    let mut groups: Vec<Vec<usize>> =
        groups.into_values().filter(|group| (2..=3).contains(&group.len())).collect();
    groups.sort_unstable();
    let differ = |group: &[usize]| {
        let normal = |i: usize| points.normals[group[i]];
        (1..group.len()).all(|i| (0..i).all(|j| normal(i).dot(normal(j)) < ONE_SIDE))
    };
    let crease = |group: Vec<usize>| {
        Crease::new(splats, group.into_iter().map(|i| (i, points.normals[i])).collect())
    };
    groups.into_iter().filter(|group| differ(group)).map(crease).collect()
}
