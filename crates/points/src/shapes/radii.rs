//! Natural radii: how far the natural neighbours of each point are.
//!
//! Natural neighbours are those whose Voronoi cells touch, on the tangent plane of the point (Guennebaud, Barthe,
//! Paulin 2004, section 2 asks for radii that reach beyond them). Neighbours are laid into that plane in the direction
//! of their orthogonal projection with their distance kept, so that a curved surface doesn't bring them closer.

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use super::RADIUS_FACTOR;
use crate::{Grid, GridShape};

/// The local spacing is the distance to the point of this rank, whatever its normal.
const SPACING_RANK: usize = 6;
/// A cell that is still open with all neighbours within this many spacings lies at a border. Larger values bring
/// false neighbours across creases, where the points beyond have opposing normals; smaller ones lose true neighbours
/// of random points.
const BORDER_REACH: f64 = 4.0;
/// The cell of a border point ends this many spacings from it: bisectors of points along the border that meet farther
/// out make no neighbours.
const BORDER_CELL: f64 = 1.0;
/// Share of the distance by which a bisector may miss the cell and still count: lattices tie but for rounding.
const TIE: f64 = 1e-6;
/// How many points tell the spacing of the whole cloud.
const PROBES: usize = 64;

/// For each point 1.25 times the distance to the farthest natural neighbour, in the units of the positions.
///
/// Points whose normals oppose, and points at the very same place, are no neighbours. A point without a neighbour gets
/// 1.25 times the distance to the nearest other place, and 1 if there is none. Every result is finite and above zero
/// if the positions are finite. Holes more than about four spacings wide are borders, and the cells of border points are
/// cut off outside; the spacing is the distance to the sixth nearest point.
///
/// # Panics
/// If there are more positions than normals.
pub fn natural_radii(positions: &[Vec3], normals: &[Vec3]) -> Vec<f32> {
    let all: Vec<u32> = (0..positions.len() as u32).collect();
    natural_radii_of(&all, positions, normals)
}

/// The [`natural_radii`] of some points, by index, among all.
///
/// # Panics
/// If there are more positions than normals, or an index is not below their number.
pub fn natural_radii_of(points: &[u32], positions: &[Vec3], normals: &[Vec3]) -> Vec<f32> {
    assert!(positions.len() <= normals.len(), "give one normal a position");
    let cloud = Cloud::new(positions, normals);
    points
        .par_iter()
        .map(|&i| {
            let i = i as usize;
            let reach = cloud.farthest_natural(i).or_else(|| cloud.nearest_place(i));
            let radius = reach.map_or(1.0, |distance| RADIUS_FACTOR * distance);
            radius.min(f64::from(f32::MAX)) as f32
        })
        .collect()
}

/// Positions and normals with a grid.
struct Cloud<'a> {
    positions: &'a [Vec3],
    normals: &'a [Vec3],
    grid: Grid,
    /// A ball of this radius around any point holds all of them.
    extent: f64,
}

/// A neighbour laid into the tangent plane: its distance, and its direction there.
type Neighbor = (f64, DVec2);

impl<'a> Cloud<'a> {
    fn new(positions: &'a [Vec3], normals: &'a [Vec3]) -> Self {
        let low = positions.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let high = positions.iter().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
        let extent = 1.001 * (high.as_dvec3() - low.as_dvec3()).length();
        let smallest = (extent / 1_048_576.0).max(1e-30);
        let cell = typical_spacing(positions).max(smallest) as f32;
        let shape = GridShape::with_cell(low, cell, positions.len());
        let grid = Grid::build(shape, (0u32..).zip(positions.iter().copied()));
        Self { positions, normals, grid, extent }
    }

    /// Distance to the farthest natural neighbour of a point; none if it has no neighbour as far as a border's points
    /// look.
    fn farthest_natural(&self, i: usize) -> Option<f64> {
        let mut ball = 1.5 * f64::from(self.grid.shape.cell);
        let mut places = self.places(i, ball);
        while places.len() < SPACING_RANK && ball < self.extent {
            ball = (2.0 * ball).min(self.extent);
            places = self.places(i, ball);
        }
        let spacing = places.get(SPACING_RANK - 1).or(places.last())?.0;
        let border = BORDER_REACH * spacing;
        ball = ball.min(border);
        places.retain(|place| place.0 <= ball);
        loop {
            let near = self.neighbors(i, &places);
            let mut cell = Cell::clip(&near, 0.5 * ball);
            let needed = 2.0 * cell.farthest();
            let at_border = cell.is_open() && ball >= border;
            if at_border {
                cell = Cell::clip(&near, BORDER_CELL * spacing);
            }
            if at_border || needed <= ball || ball >= self.extent {
                return near.iter().rev().find(|n| cell.touches(**n)).map(|n| n.0);
            }
            // A closed cell only shrinks: the ball that it needs now is the last one.
            ball = if cell.is_open() { (2.0 * ball).min(border) } else { needed };
            places = self.places(i, ball);
        }
    }

    /// The points within a ball around a point, nearest first, with their distances.
    fn places(&self, i: usize, ball: f64) -> Vec<(f64, usize)> {
        let mut found = Vec::new();
        self.visit_places(i, ball, |j, distance| found.push((distance, j)));
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    }

    /// Lays those points into the tangent plane whose normals don't oppose.
    fn neighbors(&self, i: usize, places: &[(f64, usize)]) -> Vec<Neighbor> {
        let center = self.positions[i].as_dvec3();
        let normal = self.normals[i].as_dvec3().normalize_or(DVec3::Z);
        let (u, v) = normal.any_orthonormal_pair();
        let lay = |&(distance, j): &(f64, usize)| {
            if self.normals[j].as_dvec3().dot(normal) < 0.0 {
                return None;
            }
            let offset = self.positions[j].as_dvec3() - center;
            // Straight above or below there is no direction.
            let direction = DVec2::new(offset.dot(u), offset.dot(v)).try_normalize()?;
            Some((distance, direction))
        };
        places.iter().filter_map(lay).collect()
    }

    /// Distance to the nearest point that is somewhere else, whatever its normal.
    fn nearest_place(&self, i: usize) -> Option<f64> {
        let mut ball = f64::from(self.grid.shape.cell);
        loop {
            let mut nearest = None;
            self.visit_places(i, ball, |_, distance| {
                nearest = Some(nearest.map_or(distance, |best: f64| best.min(distance)));
            });
            if nearest.is_some() || ball >= self.extent {
                return nearest;
            }
            ball = (2.0 * ball).min(self.extent);
        }
    }

    /// Calls `visit` with each point within a ball around point `i` that isn't at its very place, and the distance.
    fn visit_places(&self, i: usize, ball: f64, mut visit: impl FnMut(usize, f64)) {
        let center = self.positions[i];
        self.grid.visit_ball(center, ball as f32, |j, _| {
            let offset = self.positions[j as usize].as_dvec3() - center.as_dvec3();
            let distance = offset.length();
            if distance > 0.0 && distance <= ball {
                visit(j as usize, distance);
            }
        });
    }
}

/// Median over some points of the distance to the sixth nearest: a cell size that suits most of the cloud.
fn typical_spacing(positions: &[Vec3]) -> f64 {
    let stride = positions.len().div_ceil(PROBES).max(1);
    let mut spacings: Vec<f64> = positions
        .iter()
        .step_by(stride)
        .filter_map(|&center| {
            let distance = |x: &Vec3| (x.as_dvec3() - center.as_dvec3()).length();
            let mut distances: Vec<f64> =
                positions.iter().map(distance).filter(|&d| d > 0.0).collect();
            let rank = SPACING_RANK.min(distances.len()).checked_sub(1)?;
            Some(*distances.select_nth_unstable_by(rank, f64::total_cmp).1)
        })
        .collect();
    spacings.sort_by(f64::total_cmp);
    spacings.get(spacings.len() / 2).copied().unwrap_or(1.0)
}

/// A convex polygon around the origin: the Voronoi cell of the point, inside a square.
struct Cell {
    vertices: Vec<DVec2>,
    /// Half the side of the square.
    half: f64,
}

impl Cell {
    /// The part of the square that is closer to the origin than to any neighbour; those are sorted by distance.
    fn clip(neighbors: &[Neighbor], half: f64) -> Self {
        let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
        let mut cell = Self { vertices: corners.map(DVec2::from).to_vec(), half };
        let mut farthest = cell.farthest();
        for &(distance, direction) in neighbors {
            if distance > 2.0 * farthest {
                break;
            }
            cell.cut(direction, 0.5 * distance);
            farthest = cell.farthest();
        }
        cell
    }

    /// Takes away what lies beyond a line across `direction` at this distance from the origin.
    fn cut(&mut self, direction: DVec2, distance: f64) {
        let beyond = |v: DVec2| v.dot(direction) - distance;
        if self.vertices.iter().all(|&v| beyond(v) <= 0.0) {
            return;
        }
        let mut kept = Vec::with_capacity(self.vertices.len() + 1);
        for (k, &v) in self.vertices.iter().enumerate() {
            let next = self.vertices[(k + 1) % self.vertices.len()];
            let (here, there) = (beyond(v), beyond(next));
            if here <= 0.0 {
                kept.push(v);
            }
            if (here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0) {
                kept.push(v + (next - v) * (here / (here - there)));
            }
        }
        self.vertices = kept;
    }

    /// Distance from the origin to the farthest vertex.
    fn farthest(&self) -> f64 {
        self.vertices.iter().map(|v| v.length_squared()).fold(0.0, f64::max).sqrt()
    }

    /// Whether a side of the square is still part of the outline.
    fn is_open(&self) -> bool {
        self.vertices.iter().any(|v| v.abs().max_element() >= self.half * (1.0 - TIE))
    }

    /// Whether the bisector with a neighbour bounds the cell, or touches it.
    fn touches(&self, (distance, direction): Neighbor) -> bool {
        self.vertices.iter().any(|v| v.dot(direction) >= distance * (0.5 - TIE))
    }
}
