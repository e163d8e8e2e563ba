//! A uniform grid that wraps around: ball queries in time proportional to what they find.
//!
//! Cells repeat with a period of a power of two along each axis, so a grid of about as many cells as points serves a
//! cloud of any extent, and no two cells of one query fall together. A query visits every entry whose cell it touches,
//! far ones of the same residue too: callers test the distance. So neither the cell size nor the period can change a
//! result, only the time. Twins: `cells.wgsl` and `ball_walk.wgsl` in
//! `shaders/shared`.

use glam::{IVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Geometry of a grid: everything a query needs besides the cells themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridShape {
    /// Corner of cell (0, 0, 0).
    pub origin: Vec3,
    /// Edge length of a cell.
    pub cell: f32,
    /// log2 of the period along x, y and z.
    pub bits: [u32; 3],
}

/// Entries sorted by cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Where the cells are.
    pub shape: GridShape,
    /// First entry of each cell, and one more: the number of entries.
    pub starts: Vec<u32>,
    /// Entries by cell, ascending within one.
    pub items: Vec<u32>,
    /// Their positions: a query reads them one after the other.
    pub places: Vec<Vec3>,
}

/// Cells in mean radii: smaller ones hold fewer entries that are too far, and make more rows to look at.
const WIDTH: f32 = 1.5;

/// Widens a query a little, so that rounding at a cell's face can't lose an entry.
const SLACK: f32 = 1.0 + 1e-4;

impl GridShape {
    /// A grid for points of these radii: cells one and a half times as large as their harmonic mean, but no less than an eighth of
    /// their mean. Where radii differ much, cells that are small for the large ones cost less than cells that hold whole clusters.
    pub fn fit(positions: &[Vec3], radii: &[f32]) -> Self {
        let low = positions.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let high = positions.iter().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
        let extent = (high - low).max_element();
        let inverse = radii.iter().map(|&r| 1.0 / f64::from(r)).sum::<f64>();
        let sum = radii.iter().map(|&r| f64::from(r)).sum::<f64>();
        // A few tiny radii must not make cells that all others search by the thousand.
        let count = radii.len().max(1) as f64;
        let mean = (count / inverse.max(1e-30)).max(sum / count / 8.0);
        // 2^20 cells along the longest side keep cell coordinates exact in f32.
        let cell = (WIDTH * mean as f32).max(extent / 1_048_576.0).max(1e-30);
        Self::with_cell(low, cell, positions.len())
    }

    /// A grid of that cell size with about two to four cells a point, and not so few that a query of some cells' width
    /// wraps around.
    pub fn with_cell(origin: Vec3, cell: f32, points: usize) -> Self {
        let total = (2 * points).next_power_of_two().trailing_zeros().clamp(15, 27);
        Self { origin, cell, bits: [total.div_ceil(3), (total + 1) / 3, total / 3] }
    }

    /// How far from a ball's centre its cells may be along an axis.
    #[inline]
    pub fn reach(&self, radius: f32) -> f32 {
        radius * SLACK + self.cell * 1e-4
    }

    /// Number of cells in a period.
    pub fn cells(&self) -> usize {
        1 << (self.bits[0] + self.bits[1] + self.bits[2])
    }

    /// Coordinates of the cell that holds `x`, before wrapping.
    #[inline]
    fn coordinates(&self, x: Vec3) -> IVec3 {
        let places = (x - self.origin) * (1.0 / self.cell);
        IVec3::from_array(places.to_array().map(floor))
    }

    /// Index of a cell: its coordinates wrapped, x running fastest.
    fn index(&self, c: IVec3) -> usize {
        let wrap = |v: i32, bits: u32| v as usize & ((1 << bits) - 1);
        let [bx, by, bz] = self.bits;
        wrap(c.x, bx) | wrap(c.y, by) << bx | wrap(c.z, bz) << (bx + by)
    }

    /// Index of the cell that holds `x`.
    pub fn cell_of(&self, x: Vec3) -> usize {
        self.index(self.coordinates(x))
    }
}

/// The largest integer that is no larger: where the processor has no instruction for it a call of the system library is slow.
#[inline]
fn floor(x: f32) -> i32 {
    let truncated = x as i32;
    truncated.saturating_sub(i32::from(truncated as f32 > x))
}

impl Grid {
    /// Sorts the positions into cells; entries are the numbers that come with them.
    pub fn build(shape: GridShape, positions: impl Iterator<Item = (u32, Vec3)> + Clone) -> Self {
        let (numbers, positions): (Vec<u32>, Vec<Vec3>) = positions.unzip();
        Self::sort(shape, &positions, |i| numbers[i])
    }

    /// Sorts positions into cells; `number` says what number the entry of each has.
    pub fn sort(
        shape: GridShape,
        positions: &[Vec3],
        number: impl Fn(usize) -> u32 + Sync,
    ) -> Self {
        let cells: Vec<u32> = positions.par_iter().map(|&x| shape.cell_of(x) as u32).collect();
        let mut starts = vec![0u32; shape.cells() + 1];
        // Each thread sorts the entries of some of the cells.
        let share = shape.cells() / rayon::current_num_threads().next_power_of_two().min(16);
        let own = |part: usize| (part * share) as u32..((part + 1) * share) as u32;
        let counts = starts[1..].par_chunks_mut(share).enumerate().map(|(part, counts)| {
            let own = own(part);
            let cells = cells.iter().filter(|cell| own.contains(cell));
            cells.for_each(|cell| counts[(cell - own.start) as usize] += 1);
            counts.iter().sum::<u32>()
        });
        let counts: Vec<u32> = counts.collect();
        let mut items = vec![0; cells.len()];
        let mut places = vec![Vec3::ZERO; cells.len()];
        let (mut rest, mut parts, mut first) = ((&mut *items, &mut *places), Vec::new(), 0);
        for (counts, starts) in counts.iter().zip(starts[1..].chunks_mut(share)) {
            let items = rest.0.split_at_mut(*counts as usize);
            let places = rest.1.split_at_mut(*counts as usize);
            parts.push((first, starts, items.0, places.0));
            (rest, first) = ((items.1, places.1), first + counts);
        }
        parts.into_par_iter().enumerate().for_each(|(part, (first, starts, items, places))| {
            let mut next = 0;
            for start in &mut *starts {
                next += std::mem::replace(start, next);
            }
            let own = own(part);
            for (i, cell) in cells.iter().enumerate().filter(|(_, cell)| own.contains(cell)) {
                let slot = &mut starts[(cell - own.start) as usize];
                items[*slot as usize] = number(i);
                places[*slot as usize] = positions[i];
                *slot += 1;
            }
            // Each cell's start has become its end: that of the next one.
            starts.iter_mut().for_each(|start| *start += first);
        });
        Self { shape, starts, items, places }
    }

    /// Calls `visit` once for each entry of every cell that the ball touches: a superset of those inside.
    pub fn visit_ball(&self, center: Vec3, radius: f32, mut visit: impl FnMut(u32, Vec3)) {
        self.visit_runs(center, radius, |run| {
            for (&item, &place) in self.items[run.clone()].iter().zip(&self.places[run]) {
                visit(item, place);
            }
        });
    }

    /// Calls `visit` with the entries of every cell that the ball touches, a few cells at a time.
    #[inline]
    fn visit_runs(&self, center: Vec3, radius: f32, visit: impl FnMut(Range<usize>)) {
        let reach = Vec3::splat(self.shape.reach(radius));
        self.visit_box(center - reach, center + reach, visit);
    }

    /// Calls `visit` with the entries of every cell that the box touches, a few cells at a time.
    #[inline]
    pub fn visit_box(&self, low: Vec3, high: Vec3, mut visit: impl FnMut(Range<usize>)) {
        let low = self.shape.coordinates(low);
        // A query wider than the period would meet its own cells again.
        let last = IVec3::from_array(self.shape.bits.map(|b| (1 << b) - 1));
        let high = self.shape.coordinates(high).min(low.saturating_add(last));
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                self.visit_row(low.with_y(y).with_z(z), high.x, &mut visit);
            }
        }
    }

    /// Visits the cells from `first` to `last_x` along x: one run of entries, or two where the period ends between.
    #[inline]
    fn visit_row(&self, first: IVec3, last_x: i32, visit: &mut impl FnMut(Range<usize>)) {
        let begin = self.shape.index(first);
        let end = self.shape.index(first.with_x(last_x));
        let entries =
            |from: usize, to: usize| self.starts[from] as usize..self.starts[to + 1] as usize;
        if begin <= end {
            visit(entries(begin, end));
        } else {
            let row = (1 << self.shape.bits[0]) - 1;
            visit(entries(begin, begin | row));
            visit(entries(end & !row, end));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ball_queries_find_what_brute_force_finds_and_nothing_twice() {
        let mut random = fastrand::Rng::with_seed(7);
        for scale in [1e-6f32, 1.0, 1e6] {
            let mut coordinate = || (random.f32() - 0.3) * scale;
            let positions: Vec<Vec3> =
                (0..700).map(|_| Vec3::new(coordinate(), coordinate(), coordinate())).collect();
            let shape = GridShape::fit(&positions, &vec![0.1 * scale; positions.len()]);
            let grid =
                Grid::build(shape, positions.iter().enumerate().map(|(i, &x)| (i as u32, x)));
            // The last radius spans more than one period along every axis.
            for (center, radius) in [(3, 0.05), (10, 0.3), (11, 100.0)] {
                let (center, radius) = (positions[center], radius * scale);
                let inside = |i: u32| (positions[i as usize] - center).length() <= radius;
                let mut found = Vec::new();
                grid.visit_ball(center, radius, |i, x| {
                    assert_eq!(x, positions[i as usize]);
                    found.push(i);
                });
                let visits = found.len();
                found.sort_unstable();
                found.dedup();
                assert_eq!(visits, found.len(), "an entry was visited twice");
                found.retain(|&i| inside(i));
                let expected: Vec<u32> =
                    (0..positions.len() as u32).filter(|&i| inside(i)).collect();
                assert_eq!(found, expected, "scale {scale}, radius {radius}");
            }
        }
    }
}
