//! The angles of the insertion, many at once. See [`crate::columns`].

use crate::columns::{BLOCK, Column, LANES, Vectors, vectorized};
use crate::math::{angle_between, direction_angle};
use crate::pn_triangle::{Corner, curved_angle};
use glam::Vec3;

/// Angles of directions on tangent planes.
#[derive(Default)]
pub(crate) struct Directions {
    x: Vec<f32>,
    y: Vec<f32>,
    pub(crate) angles: Vec<f32>,
}

impl Directions {
    pub(crate) fn clear(&mut self) {
        self.x.clear();
        self.y.clear();
    }

    pub(crate) fn ask(&mut self, x: f32, y: f32) {
        self.x.push(x);
        self.y.push(y);
    }

    pub(crate) fn find(&mut self) {
        self.angles.resize(self.x.len(), 0.0);
        direction_angles(&self.y, &self.x, &mut self.angles);
    }
}

vectorized! {
    pub(crate) fn direction_angles(y: &[f32], x: &[f32], angles: &mut [f32]) {
        for ((&y, &x), angle) in y.iter().zip(x).zip(angles) {
            *angle = direction_angle(y, x);
        }
    }
}

/// Positions and normals of pairs of points, and the angles between them.
#[derive(Clone, Copy)]
struct Block {
    columns: [Vectors; 4],
    angles: Column,
}

/// Angles seen from a point.
#[derive(Default)]
pub(crate) struct Angles {
    blocks: Vec<Block>,
    len: usize,
}

impl Angles {
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn get(&self, i: usize) -> f32 {
        self.blocks[i / BLOCK].angles[i % BLOCK]
    }

    fn ask(&mut self, vectors: [Vec3; 4]) {
        const EMPTY: Block = Block { columns: [Vectors::ZERO; 4], angles: [0.0; BLOCK] };
        let (block, i) = (self.len / BLOCK, self.len % BLOCK);
        if block == self.blocks.len() {
            self.blocks.push(EMPTY);
        }
        for (column, v) in self.blocks[block].columns.iter_mut().zip(vectors) {
            column.set(i, v);
        }
        self.len += 1;
    }

    /// Asks for the angle between two points, with [`Angles::find_gaps`].
    pub(crate) fn ask_gap(&mut self, a: Corner, b: Corner) {
        self.ask([a.position, b.position, a.normal, b.normal]);
    }

    /// Curved angles (eq. 5), or plain ones.
    pub(crate) fn find_gaps(&mut self, plain: bool) {
        self.find(if plain { plain_gaps } else { curved_gaps });
    }

    fn find(&mut self, kernel: fn(&[Vectors; 4], usize, &mut Column)) {
        let mut rest = self.len;
        for block in &mut self.blocks[..self.len.div_ceil(BLOCK)] {
            kernel(&block.columns, rest.min(BLOCK).next_multiple_of(LANES), &mut block.angles);
            rest = rest.saturating_sub(BLOCK);
        }
    }
}

vectorized! {
    fn curved_gaps(columns: &[Vectors; 4], count: usize, angles: &mut Column) {
        let [a, b, normal_a, normal_b] = columns;
        for (i, angle) in angles.iter_mut().enumerate().take(count) {
            let a = Corner { position: a.get(i), normal: normal_a.get(i) };
            let b = Corner { position: b.get(i), normal: normal_b.get(i) };
            *angle = curved_angle(a, b);
        }
    }

    fn plain_gaps(columns: &[Vectors; 4], count: usize, angles: &mut Column) {
        let [a, b, ..] = columns;
        for (i, angle) in angles.iter_mut().enumerate().take(count) {
            *angle = angle_between(a.get(i), b.get(i));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_angles_at_once_have_the_bytes_of_single_ones() {
        let mut seed = 1u32;
        let mut vector = || {
            Vec3::from_array([0; 3].map(|_| {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
            }))
        };
        let mut corner = || Corner { position: vector(), normal: vector().normalize() };
        let pairs: Vec<[Corner; 2]> = (0..1001).map(|_| [corner(), corner()]).collect();
        let mut angles = Angles::default();
        pairs.iter().for_each(|&[a, b]| angles.ask_gap(a, b));
        angles.find_gaps(false);
        for (i, &[a, b]) in pairs.iter().enumerate() {
            assert_eq!(angles.get(i).to_bits(), curved_angle(a, b).to_bits(), "curved {i}");
        }
        angles.find_gaps(true);
        for (i, [a, b]) in pairs.iter().enumerate() {
            let plain = angle_between(a.position, b.position);
            assert_eq!(angles.get(i).to_bits(), plain.to_bits(), "plain {i}");
        }
        let mut directions = Directions::default();
        pairs.iter().for_each(|[a, _]| directions.ask(a.position.x, a.position.y));
        directions.find();
        for (angle, [a, _]) in directions.angles.iter().zip(&pairs) {
            let single = direction_angle(a.position.y, a.position.x);
            assert_eq!(angle.to_bits(), single.to_bits());
        }
    }
}
