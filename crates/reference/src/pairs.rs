//! Pairs of points: the centres of neighbourhoods with their members, many side by side, and eq. 6, which says
//! whether they see each other.
//! Twin: `shaders/shared/ball.wgsl`.

use crate::Level;
use crate::columns::{BLOCK, Column, vectorized};
use glam::Vec3;
use std::ops::Range;
use surfine_points::Rules;

/// Cosine of 150°: points whose normals differ more are no neighbours, though eq. 6 lets exactly opposite ones pass.
pub const OPPOSITE: f32 = -0.866_025_4;
/// Share of the bound of eq. 6 from which pairs are rejected.
pub const NARROW: f32 = 0.7;
/// Share of the bound of eq. 6 from which pairs are doubtful.
pub const DOUBTFUL: f32 = 0.5;

/// What is known of a member.
pub(crate) type Verdict = u32;
/// It is no neighbour and hides none.
pub(crate) const OUT: Verdict = 0;
/// It is a neighbour unless others hide it.
pub(crate) const SURE: Verdict = 1;
/// It may lie on another sheet: then it is no neighbour unless a gap stays open, and hides none.
pub(crate) const DOUBT: Verdict = 2;

/// The centre of a neighbourhood.
#[derive(Clone, Copy, Default)]
pub(crate) struct Center {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
    /// Span its tangent plane.
    pub(crate) frame: (Vec3, Vec3),
    pub(crate) radius: f32,
    pub(crate) inverse_radius: f32,
}

impl Center {
    pub(crate) fn of(level: &Level, p: usize) -> Self {
        let radius = level.radii[p];
        Self {
            position: level.positions[p],
            normal: level.normals[p],
            frame: level.frame(p),
            radius,
            inverse_radius: 1.0 / radius,
        }
    }
}

/// Centres with one member each, in columns.
#[derive(Default)]
pub(crate) struct Pairs {
    /// From the centre to the member.
    pub(crate) d: [Vec<f32>; 3],
    normal: [Vec<f32>; 3],
    other: [Vec<f32>; 3],
    /// Of `d` in the frame of the tangent plane.
    plane: [Vec<f32>; 2],
    inverse_radius: Vec<f32>,
}

impl Pairs {
    pub(crate) fn resize(&mut self, room: usize) {
        let Self { d, normal, other, plane, inverse_radius } = self;
        let columns = d.iter_mut().chain(normal).chain(other).chain(plane).chain([inverse_radius]);
        columns.for_each(|column| column.resize(room, 0.0));
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, d: Vec3, other: Vec3) {
        for axis in 0..3 {
            (self.d[axis][i], self.other[axis][i]) = (d[axis], other[axis]);
        }
    }

    /// Gives pairs their centre.
    pub(crate) fn set_center(&mut self, own: Range<usize>, center: &Center) {
        let Self { d, normal, plane, inverse_radius, .. } = self;
        for (column, value) in normal.iter_mut().zip(center.normal.to_array()) {
            column[own.clone()].fill(value);
        }
        inverse_radius[own.clone()].fill(center.inverse_radius);
        let d = d.each_ref().map(|column| &column[own.clone()]);
        let [x, y] = plane.each_mut().map(|column| &mut column[own.clone()]);
        along(d, center.frame.0, x);
        along(d, center.frame.1, y);
    }

    pub(crate) fn block(&self, block: usize) -> Block<'_> {
        fn of(column: &[f32], block: usize) -> &Column {
            &column.as_chunks().0[block]
        }
        Block {
            d: self.d.each_ref().map(|column| of(column, block)),
            normal: self.normal.each_ref().map(|column| of(column, block)),
            other: self.other.each_ref().map(|column| of(column, block)),
            plane: self.plane.each_ref().map(|column| of(column, block)),
            inverse_radius: of(&self.inverse_radius, block),
        }
    }
}

/// A block of [`Pairs`].
#[derive(Clone, Copy)]
pub(crate) struct Block<'a> {
    d: [&'a Column; 3],
    normal: [&'a Column; 3],
    other: [&'a Column; 3],
    pub(crate) plane: [&'a Column; 2],
    pub(crate) inverse_radius: &'a Column,
}

impl Block<'_> {
    /// The vector between the points of a pair, and their normals.
    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> (Vec3, Vec3, Vec3) {
        let at = |columns: [&Column; 3]| Vec3::from_array(columns.map(|column| column[i]));
        (at(self.d), at(self.normal), at(self.other))
    }
}

vectorized! {
    fn along(d: [&[f32]; 3], axis: Vec3, places: &mut [f32]) {
        let count = places.len();
        let [x, y, z] = d.map(|column| &column[..count]);
        for i in 0..count {
            places[i] = Vec3::new(x[i], y[i], z[i]).dot(axis);
        }
    }

    /// Applies eq. 6.
    pub(crate) fn judge(pairs: Block<'_>, rules: Rules, verdicts: &mut [Verdict; BLOCK]) {
        for (i, verdict) in verdicts.iter_mut().enumerate() {
            let (d, normal, other) = pairs.get(i);
            let u = d * (1.0 / d.dot(d).sqrt());
            let sure = if is_doubtful(u, normal, other, rules) { DOUBT } else { SURE };
            let is_out = (*verdict == OUT) | !consistent(u, normal, other, rules);
            *verdict = if is_out { OUT } else { sure };
        }
    }
}

/// Eq. 6, printed inverted: whether neither point lies in the cone of apex the other and axis `n0 + n1`. `u` is the
/// unit vector between them.
#[inline(always)]
fn consistent(u: Vec3, n0: Vec3, n1: Vec3, rules: Rules) -> bool {
    let cosine = n0.dot(n1);
    if rules.opposite_pairs && cosine < OPPOSITE {
        return false;
    }
    let along = (n0 + n1).dot(u).abs();
    // The margin is for flat surfaces, where both sides are rounding.
    if rules.narrow_cones { along <= NARROW * (1.0 + cosine) + 1e-6 } else { along <= 1.0 + cosine }
}

/// Whether a pair that passes is doubtful: a step between two sheets rather than a slope of one.
#[inline(always)]
fn is_doubtful(u: Vec3, n0: Vec3, n1: Vec3, rules: Rules) -> bool {
    let along = (n0 + n1).dot(u).abs();
    let beyond = along > DOUBTFUL * (1.0 + n0.dot(n1)) + 1e-6;
    rules.sure_neighbors && rules.natural_neighbors && beyond
}
