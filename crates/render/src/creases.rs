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

/// Normals of one position are sides of a crease if they differ by more than this cosine says. Opposite ones are no
/// crease: a sheet with two sides goes on beyond the point.
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
    let mut sides = further_normals(points, splats);
    sides.extend(shared_positions(points));
    sides.retain(|sides| sides.iter().all(|side| side.1 != Vec3::ZERO));
    if sides.is_empty() {
        return;
    }
    splats.extras.resize(splats.points.len(), Extra::default());
    sides.iter().for_each(|sides| hide_backs(sides, splats));
    sides.retain(|sides| is_crease(sides));
    let creases: Vec<Crease> = sides.into_iter().map(|sides| Crease::new(splats, sides)).collect();
    if creases.is_empty() {
        return;
    }
    let positions: Vec<Vec3> = splats.points.iter().map(|p| p.position.into()).collect();
    let radii: Vec<f32> = splats.points.iter().map(|p| p.radius).collect();
    let grid = Grid::build(GridShape::fit(&positions, &radii), (0u32..).zip(positions));
    let mut is_smooth = vec![true; splats.len()];
    for &(disc, _) in creases.iter().flat_map(|crease| &crease.sides) {
        is_smooth[disc] = false;
    }
    // Sides have fixed places: other ends must find them there.
    for crease in &creases {
        let near = crease.neighbors(&grid, splats);
        crease.end_sides(&near, &is_smooth, splats);
    }
    for crease in &creases {
        let near = crease.neighbors(&grid, splats);
        crease.end_neighbors(&near, splats);
    }
}

/// Whether no two normals are alike or opposite.
fn is_crease(sides: &[(usize, Vec3)]) -> bool {
    let differ = |i: usize, j: usize| sides[i].1.dot(sides[j].1).abs() < ONE_SIDE;
    (1..sides.len()).all(|i| (0..i).all(|j| differ(i, j)))
}

/// Of two opposite discs in one place only that which shows its front is drawn.
fn hide_backs(sides: &[(usize, Vec3)], splats: &mut Splats) {
    for &(disc, normal) in sides {
        let opposite = sides.iter().find(|other| other.1.dot(normal) <= -ONE_SIDE);
        if let Some(&(_, other)) = opposite {
            splats.extras[disc].hide_behind(other);
        }
    }
}

/// A disc near a crease point.
struct Neighbor {
    disc: usize,
    /// From the crease point.
    offset: Vec3,
    /// The side of the crease that it belongs to.
    side: usize,
}

impl Crease {
    fn new(splats: &Splats, sides: Vec<(usize, Vec3)>) -> Self {
        let point = splats.points[sides[0].0];
        Self { position: point.position.into(), radius: point.radius, sides }
    }

    /// Ends each side's disc at the others.
    fn end_sides(&self, near: &[Neighbor], is_smooth: &[bool], splats: &mut Splats) {
        for (k, &(disc, _)) in self.sides.iter().enumerate() {
            for (i, other) in self.others(k).enumerate() {
                // The smooth neighbours tell.
                let smooth = near.iter().filter(|neighbor| is_smooth[neighbor.disc]);
                let is_concave = self.is_concave(smooth, k, other);
                splats.extras[disc].end_at_side(i, self.sides[other].1, is_concave);
            }
        }
    }

    /// Ends the discs around where those of their side end.
    fn end_neighbors(&self, near: &[Neighbor], splats: &mut Splats) {
        for neighbor in near {
            let side = splats.extras[self.sides[neighbor.side].0];
            for end in side.ends[..self.sides.len() - 1].iter().map(|end| Vec3::from_slice(end)) {
                let place = -end.dot(neighbor.offset);
                // A neighbour beyond the plane tells that the surface turns: a flat cut would be wrong.
                if (0.0..SOFT * splats.points[neighbor.disc].radius).contains(&place) {
                    let distance = neighbor.offset.length();
                    splats.extras[neighbor.disc].end_at_plane(end, place, distance);
                }
            }
        }
    }

    /// The discs within the radius, but those of the point itself.
    fn neighbors(&self, grid: &Grid, splats: &Splats) -> Vec<Neighbor> {
        let mut near = Vec::new();
        grid.visit_ball(self.position, self.radius, |j, _| {
            let disc = j as usize;
            let point = &splats.points[disc];
            let offset = Vec3::from(point.position) - self.position;
            if offset != Vec3::ZERO && offset.length() <= self.radius {
                let side = self.side_of(point.normal.into());
                near.push(Neighbor { disc, offset, side });
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

    /// Whether those of the discs that belong to a side lie above the plane of another.
    fn is_concave<'a>(
        &self,
        discs: impl Iterator<Item = &'a Neighbor>,
        k: usize,
        other: usize,
    ) -> bool {
        let of_side = discs.filter(|neighbor| neighbor.side == k);
        let above = |n: &Neighbor| n.offset.normalize_or_zero().dot(self.sides[other].1);
        of_side.map(above).sum::<f32>() > 0.0
    }
}

/// Points with further normals; each gets a disc at the end.
fn further_normals(points: &PointSet, splats: &mut Splats) -> Vec<Vec<(usize, Vec3)>> {
    let columns = [["nx2", "ny2", "nz2"], ["nx3", "ny3", "nz3"]];
    let columns: Vec<[&[f32]; 3]> =
        columns.iter().filter_map(|names| vector_column(points, names)).collect();
    let mut all = Vec::new();
    for i in 0..points.len() {
        let normal = |c: &[&[f32]; 3]| Vec3::new(c[0][i], c[1][i], c[2][i]).normalize_or_zero();
        let further = columns.iter().map(normal).filter(|n| *n != Vec3::ZERO);
        let mut sides = vec![(i, points.normals[i])];
        for normal in further {
            sides.push((splats.points.len(), normal));
            splats.push_copy(i, normal);
        }
        if sides.len() > 1 {
            all.push(sides);
        }
    }
    all
}

fn vector_column<'a>(points: &'a PointSet, names: &[&str; 3]) -> Option<[&'a [f32]; 3]> {
    let column = |name| match points.attribute(name).map(|a| &a.values) {
        Some(Values::F32(values)) => Some(&values[..]),
        _ => None,
    };
    Some([column(names[0])?, column(names[1])?, column(names[2])?])
}

/// Two or three records of one position.
fn shared_positions(points: &PointSet) -> Vec<Vec<(usize, Vec3)>> {
    // Adding zero makes one zero of the two.
    let key = |i: usize| (points.positions[i] + 0.0).to_array().map(f32::to_bits);
    let mut groups: HashMap<_, Vec<usize>> = HashMap::new();
    (0..points.len()).for_each(|i| groups.entry(key(i)).or_default().push(i));
    let mut groups: Vec<Vec<usize>> =
        groups.into_values().filter(|group| (2..=3).contains(&group.len())).collect();
    groups.sort_unstable();
    let sides = |group: Vec<usize>| group.into_iter().map(|i| (i, points.normals[i])).collect();
    groups.into_iter().map(sides).collect()
}
