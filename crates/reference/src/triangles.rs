//! The new points of triangles (section 5, eq. 12), many at once: see [`crate::columns`]. Twin: `add_candidate` in
//! `shaders/candidates.wgsl`.

use crate::Level;
use crate::columns::{BLOCK, Column, Vectors, vectorized};
use crate::new_normal::{is_steep, safe_normal};
use crate::pn_triangle::{Corner, displaced_center, exact_normal, is_none, reach};
use glam::Vec3;
use surfine_points::Rules;

/// Triangles side by side.
#[derive(Clone, Copy)]
pub(crate) struct Triangles {
    positions: [Vectors; 3],
    normals: [Vectors; 3],
}

impl Triangles {
    pub(crate) const EMPTY: Self =
        Self { positions: [Vectors::ZERO; 3], normals: [Vectors::ZERO; 3] };

    /// Takes the corners of as many triangles as there are, [`BLOCK`] at most.
    pub(crate) fn gather(&mut self, level: &Level, corners: &[[u32; 3]]) {
        for (i, corners) in corners.iter().enumerate() {
            for (k, &corner) in corners.iter().enumerate() {
                self.positions[k].set(i, level.positions[corner as usize]);
                self.normals[k].set(i, level.normals[corner as usize]);
            }
        }
    }

    #[inline(always)]
    fn get(&self, i: usize) -> [Corner; 3] {
        let corner = |k: usize| Corner {
            position: self.positions[k].get(i),
            normal: self.normals[k].get(i),
        };
        [corner(0), corner(1), corner(2)]
    }
}

/// Their new points.
pub(crate) struct NewPoints {
    pub(crate) positions: Vectors,
    pub(crate) normals: Vectors,
    pub(crate) rho: Column,
}

impl NewPoints {
    pub(crate) const EMPTY: Self =
        Self { positions: Vectors::ZERO, normals: Vectors::ZERO, rho: [0.0; BLOCK] };

    #[inline(always)]
    fn set(&mut self, i: usize, (position, normal, rho): NewPoint) {
        self.positions.set(i, position);
        self.normals.set(i, normal);
        self.rho[i] = rho;
    }
}

vectorized! {
    pub(crate) fn new_points(triangles: &Triangles, rules: Rules, new: &mut NewPoints) {
        for i in 0..BLOCK {
            new.set(i, new_point(triangles.get(i), rules));
        }
    }

    pub(crate) fn literal_points(triangles: &Triangles, rules: Rules, new: &mut NewPoints) {
        for i in 0..BLOCK {
            new.set(i, literal_point(triangles.get(i), rules));
        }
    }
}

/// Position, normal and ρ of a new point (section 5). The third is -1 where a triangle has none: if it
/// has no area, or is steep.
type NewPoint = (Vec3, Vec3, f32);

/// The new point of a triangle.
#[inline(always)]
fn new_point(corners: [Corner; 3], rules: Rules) -> NewPoint {
    let position = displaced_center(corners);
    let rho = reach(corners, position);
    let normal = safe_normal(corners, rho, rules);
    let is_steep = rules.steep_faces & is_steep(corners, rho);
    checked(position, normal, rho, is_steep)
}

/// [`new_point`] without the rule for slivers.
#[inline(always)]
fn literal_point(corners: [Corner; 3], rules: Rules) -> NewPoint {
    let position = displaced_center(corners);
    let rho = reach(corners, position);
    let is_steep = rules.steep_faces & is_steep(corners, rho);
    checked(position, exact_normal(corners, rho), rho, is_steep)
}

#[inline(always)]
fn checked(position: Vec3, normal: Vec3, rho: f32, is_steep: bool) -> NewPoint {
    let fails = (rho == 0.0) | is_none(normal) | is_steep;
    if fails { (Vec3::ZERO, Vec3::ZERO, -1.0) } else { (position, normal, rho) }
}
