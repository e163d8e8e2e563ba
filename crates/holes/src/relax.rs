//! Smoothing of the fill (rule 5, ours): fill points move to where their neighbours' tangent planes want them, the rim stays.

use crate::front::Front;
use glam::Vec3;
use rayon::prelude::*;
use surfine_reference::math::unit;
use surfine_reference::neighborhood::Rings;

/// Sweeps a round, and after how many of them the fans are made anew.
const SWEEPS: u32 = 20;
const SWEEPS_A_FAN: u32 = 5;
/// Least value of `n·(n + n_j)`: beyond a right angle or so the height that a neighbour asks for says little.
const LEAST_COSINE: f32 = 0.2;
/// Share of the way to the middle of the neighbours along the surface.
const TANGENTIAL: f32 = 0.5;

/// Smooths the fill.
pub(crate) fn relax(front: &mut Front) {
    for _ in 0..SWEEPS / SWEEPS_A_FAN {
        let rings = front.fit_fans();
        for _ in 0..SWEEPS_A_FAN {
            sweep(front, &rings);
        }
    }
}

/// Moves all fill points at once.
fn sweep(front: &mut Front, rings: &Rings) {
    let moved = |p: usize| moved(front, rings, p);
    let moved: Vec<(Vec3, Vec3)> = front.fill().into_par_iter().map(moved).collect();
    for (p, (position, normal)) in front.fill().zip(moved) {
        front.level.positions[p] = position;
        front.level.normals[p] = normal;
    }
}

/// How far a point must move along its normal to lie on one circle with a neighbour at offset `d`, each with its normal.
///
/// Such a circle has `d·(n + n_j) = 0`. So spheres stay as they are.
pub(crate) fn height(d: Vec3, normal: Vec3, other: Vec3) -> f32 {
    let both = normal + other;
    d.dot(both) / normal.dot(both).max(LEAST_COSINE)
}

/// Where a fill point and its normal go: to the mean height that its neighbours want, and towards their middle.
fn moved(front: &Front, rings: &Rings, p: usize) -> (Vec3, Vec3) {
    let (position, old) = (front.level.positions[p], front.level.normals[p]);
    let ring = rings.ring(p);
    let sum = ring.iter().fold(Vec3::ZERO, |sum, e| sum + front.level.normals[e.id as usize]);
    if ring.len() < 3 || sum.dot(sum) < 1e-6 {
        return (position, old);
    }
    let normal = unit(sum);
    let (mut raise, mut middle) = (0.0, Vec3::ZERO);
    for e in ring {
        let (d, other) = (front.offset(p, e.id as usize), front.level.normals[e.id as usize]);
        raise += height(d, normal, other);
        middle += d;
    }
    let share = 1.0 / ring.len() as f32;
    let tangential = (middle - normal * middle.dot(normal)) * share;
    (position + normal * (raise * share) + tangential * TANGENTIAL, normal)
}

/// The normals of the fill from its final positions: each is the sum over its fan's triangles of
/// `d_j × d_k / |d_j|²|d_k|²` (Max 1999), which is exact on spheres. Smoothed normals would show at later levels.
pub(crate) fn refit_normals(front: &mut Front) {
    let rings = front.fit_fans();
    let fit = |p: usize| {
        let ring = rings.ring(p);
        let old = front.level.normals[p];
        let sum = (0..ring.len()).fold(Vec3::ZERO, |sum, i| {
            let next = ring[if i + 1 == ring.len() { 0 } else { i + 1 }];
            let [a, b] = [ring[i], next].map(|e| front.offset(p, e.id as usize));
            // In units of the ball, so that no product leaves the range of f32.
            let [a, b] = [a, b].map(|d| d * (1.0 / front.level.radii[p]));
            sum + a.cross(b) * (1.0 / (a.dot(a) * b.dot(b)))
        });
        if ring.len() >= 3 && sum.dot(sum) > 1e-6 && sum.dot(old) > 0.0 { unit(sum) } else { old }
    };
    let normals: Vec<Vec3> = front.fill().into_par_iter().map(fit).collect();
    let fill = front.fill();
    front.level.normals[fill].copy_from_slice(&normals);
}
