//! What lies near points, in columns. Points that follow each other are near each other as a rule, so one look into the
//! grid serves many of them, and their distances are taken in vector registers.

use crate::columns::{LANES, vectorized};
use glam::Vec3;
use std::ops::Range;
use surfine_points::Grid;

/// Points that are served by one look.
const MOST_POINTS: usize = 8;
/// The longest side of the box of such a look, in cells.
const WIDEST: f32 = 3.0;
/// Widens the sphere around the balls of these points, so that rounding can't lose an entry.
const SLACK: f32 = 1.0 + 1e-5;

/// The entries of a grid near some points, padded with places that are near nothing.
#[derive(Default)]
pub(crate) struct Nearby {
    /// These points.
    points: Range<usize>,
    pub(crate) items: Vec<u32>,
    places: [Vec<f32>; 3],
}

impl Nearby {
    /// Makes sure that all entries in the ball of the first of some points are there, and takes along what is near
    /// those that follow. Returns whether the entries are others than before.
    pub(crate) fn look(
        &mut self,
        grid: &Grid,
        points: Range<usize>,
        ball: impl Fn(usize) -> (Vec3, f32),
    ) -> bool {
        if self.points.contains(&points.start) {
            return false;
        }
        let bounds = |p: usize| {
            let (center, radius) = ball(p);
            let reach = Vec3::splat(grid.shape.reach(radius));
            (center - reach, center + reach)
        };
        self.points = points.start..points.start + 1;
        let (mut low, mut high) = bounds(points.start);
        for p in points.skip(1).take(MOST_POINTS - 1) {
            let (below, above) = bounds(p);
            let (below, above) = (low.min(below), high.max(above));
            if (above - below).max_element() > WIDEST * grid.shape.cell {
                break;
            }
            (low, high, self.points.end) = (below, above, p + 1);
        }
        let middle = (low + high) * 0.5;
        let radius = self.points.clone().map(|p| {
            let (center, radius) = ball(p);
            (center - middle).length() + radius
        });
        let radius = radius.fold(0.0, f32::max) * SLACK;
        self.gather(grid, (low, high), (middle, radius));
        true
    }

    /// Takes the entries that are in a sphere and in cells that a box touches.
    fn gather(&mut self, grid: &Grid, (low, high): (Vec3, Vec3), (middle, radius): (Vec3, f32)) {
        let limit = radius * radius;
        let Self { items, places: [x, y, z], .. } = self;
        let mut count = 0;
        grid.visit_box(low, high, |run| {
            let room = (count + run.len()).next_multiple_of(LANES);
            if items.len() < room {
                items.resize(2 * room, 0);
                for column in [&mut *x, y, z] {
                    column.resize(2 * room, 0.0);
                }
            }
            // All are written and those inside counted: a branch would be guessed wrong often.
            let columns = (&mut x[count..], &mut y[count..], &mut z[count..], &mut items[count..]);
            let mut kept = 0;
            for (&item, &place) in grid.items[run.clone()].iter().zip(&grid.places[run]) {
                let offset = place - middle;
                (columns.0[kept], columns.1[kept], columns.2[kept]) = place.into();
                columns.3[kept] = item;
                kept += usize::from(offset.dot(offset) <= limit);
            }
            count += kept;
        });
        let padded = count.next_multiple_of(LANES);
        items.truncate(padded);
        items.resize(padded, 0);
        for column in [x, y, z] {
            column.truncate(count);
            column.resize(padded, f32::NAN);
        }
    }

    /// The places of all entries along the axes.
    pub(crate) fn places(&self) -> [&[f32]; 3] {
        self.places.each_ref().map(Vec::as_slice)
    }

    /// The place of an entry.
    pub(crate) fn place(&self, i: u32) -> Vec3 {
        Vec3::from_array(self.places.each_ref().map(|column| column[i as usize]))
    }

    /// How many entries are in a ball.
    pub(crate) fn count_in_ball(&self, center: Vec3, radius: f32) -> u32 {
        let mut count = 0;
        count_ball(self.places(), center, radius * radius, &mut count);
        count
    }

    /// The entries in a ball.
    pub(crate) fn in_ball<'a>(&self, center: Vec3, radius: f32, marks: &'a mut Marks) -> &'a [u32] {
        mark_ball(self.places(), center, radius * radius, marks.prepare(self.items.len()));
        marks.find();
        &marks.marked
    }
}

vectorized! {
    fn mark_ball(places: [&[f32]; 3], center: Vec3, limit: f32, marks: &mut [u8]) {
        let count = marks.len();
        let [x, y, z] = places.map(|column| &column[..count]);
        for i in 0..count {
            let offset = Vec3::new(x[i], y[i], z[i]) - center;
            marks[i] = u8::from(offset.dot(offset) <= limit);
        }
    }
}

vectorized! {
    fn count_ball(places: [&[f32]; 3], center: Vec3, limit: f32, count: &mut u32) {
        let len = places[0].len();
        let [x, y, z] = places.map(|column| &column[..len]);
        for i in 0..len {
            let offset = Vec3::new(x[i], y[i], z[i]) - center;
            *count += u32::from(offset.dot(offset) <= limit);
        }
    }
}

/// A byte for each of some entries, most of which are 0.
#[derive(Default)]
pub(crate) struct Marks {
    marks: Vec<u8>,
    /// Those that are not 0.
    pub(crate) marked: Vec<u32>,
}

impl Marks {
    /// Room for the marks of so many entries, a multiple of [`LANES`].
    pub(crate) fn prepare(&mut self, count: usize) -> &mut [u8] {
        self.marks.resize(count, 0);
        &mut self.marks
    }

    pub(crate) fn get(&self, i: u32) -> u8 {
        self.marks[i as usize]
    }

    /// Finds the marked entries.
    pub(crate) fn find(&mut self) {
        self.marked.clear();
        for (first, word) in (0..).step_by(64).zip(self.marks.chunks(64)) {
            let mut bits = 0u64;
            for (k, bytes) in word.as_chunks::<LANES>().0.iter().enumerate() {
                bits |= bits_of(*bytes) << (LANES * k);
            }
            while bits != 0 {
                self.marked.push(first + bits.trailing_zeros());
                bits &= bits - 1;
            }
        }
    }
}

/// Which of eight bytes, all below 4, are not 0: a bit for each.
fn bits_of(bytes: [u8; LANES]) -> u64 {
    let word = u64::from_le_bytes(bytes);
    let ones = (word | (word >> 1)) & 0x0101_0101_0101_0101;
    ones.wrapping_mul(0x0102_0408_1020_4080) >> 56
}

#[cfg(test)]
mod tests {
    use super::*;
    use surfine_points::GridShape;

    #[test]
    fn what_is_in_a_ball_is_found_whoever_looks_along() {
        let mut seed = 1u32;
        let mut coordinate = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 24) as f32
        };
        let mut places: Vec<Vec3> =
            (0..500).map(|_| Vec3::from_array([0; 3].map(|_| coordinate()))).collect();
        // Some that follow each other are near each other, others are not.
        places[..300].sort_by(|a, b| a.x.total_cmp(&b.x));
        for radius in [0.0, 0.02, 0.15, 3.0] {
            let shape = GridShape::fit(&places, &vec![0.1; places.len()]);
            let grid = Grid::sort(shape, &places, |i| i as u32);
            let (mut nearby, mut marks) = (Nearby::default(), Marks::default());
            for p in 0..places.len() {
                nearby.look(&grid, p..places.len(), |p| (places[p], radius));
                let found = nearby.in_ball(places[p], radius, &mut marks).iter();
                let mut found: Vec<u32> = found.map(|&i| nearby.items[i as usize]).collect();
                found.sort_unstable();
                let inside = |&i: &u32| {
                    let offset = places[i as usize] - places[p];
                    offset.dot(offset) <= radius * radius
                };
                let expected: Vec<u32> = (0..places.len() as u32).filter(inside).collect();
                assert_eq!(found, expected, "{p}, radius {radius}");
            }
        }
    }

    #[test]
    fn every_mark_is_found() {
        for mark in 1..4 {
            for i in 0..LANES {
                let mut bytes = [0; LANES];
                bytes[i] = mark;
                assert_eq!(bits_of(bytes), 1 << i);
            }
            assert_eq!(bits_of([mark; LANES]), 0xff);
        }
    }
}
