//! The new points of many triangles at once. See [`crate::columns`].

use crate::Level;
use crate::columns::{BLOCK, Column, Vectors, vectorized};
use crate::pn_triangle::{self, Corner};
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
    fn set(&mut self, i: usize, (position, normal, rho): pn_triangle::NewPoint) {
        self.positions.set(i, position);
        self.normals.set(i, normal);
        self.rho[i] = rho;
    }
}

vectorized! {
    pub(crate) fn new_points(triangles: &Triangles, rules: Rules, new: &mut NewPoints) {
        for i in 0..BLOCK {
            new.set(i, pn_triangle::new_point(triangles.get(i), rules));
        }
    }

    pub(crate) fn literal_points(triangles: &Triangles, rules: Rules, new: &mut NewPoints) {
        for i in 0..BLOCK {
            new.set(i, pn_triangle::literal_point(triangles.get(i), rules));
        }
    }
}
