//! Candidates of a round and which of them are taken (rules 3 and 4): the candidates of [R] section 3, chosen all at once
//! (ours).

use crate::front::Front;
use glam::Vec3;
use rayon::prelude::*;
use surfine_points::{Grid, GridShape, Rules};
use surfine_reference::candidates::fan_triangle;
use surfine_reference::neighborhood::Rings;
use surfine_reference::pn_triangle;

/// No point comes nearer to another than this many spacings.
const CLEARANCE: f32 = 0.65;
/// Nor than this many ρ to another of the same round (λ2 of [R] section 5).
const APART: f32 = 0.5;

/// A possible fill point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
    /// Largest distance to the corners.
    pub(crate) rho: f32,
    /// The corners, indices into the front.
    pub(crate) corners: [u32; 3],
    /// Distance to the nearest point of the front.
    clearance: f32,
    /// No other candidate of the round may be nearer.
    apart: f32,
}

/// The candidates of the fans: one for each triangle that lies in the hole and leaves room for a point.
pub(crate) fn candidates(front: &Front, rings: &Rings) -> Vec<Candidate> {
    let mut triangles: Vec<[u32; 3]> = (0..front.len())
        .flat_map(|p| {
            (0..rings.ring(p).len()).filter_map(move |i| fan_triangle(&front.level, rings, p, i))
        })
        .collect();
    // The copies of a triangle are equal but for their orientation where a fold turns it.
    triangles.sort_unstable_by_key(|&t| (sorted(t), t));
    triangles.dedup_by_key(|t| sorted(*t));
    let grid = front.grid();
    let inside = triangles.into_par_iter().filter(|&t| front.is_inside(t));
    inside.filter_map(|t| candidate(front, &grid, t)).collect()
}

fn sorted(mut triangle: [u32; 3]) -> [u32; 3] {
    triangle.sort_unstable();
    triangle
}

fn candidate(front: &Front, grid: &Grid, triangle: [u32; 3]) -> Option<Candidate> {
    let corners = triangle.map(|c| front.level.corner(c));
    let position = pn_triangle::displaced_center(corners);
    let rho = pn_triangle::reach(corners, position);
    let spacing = front.mean_spacing(triangle);
    if rho < CLEARANCE * spacing {
        return None;
    }
    let normal = pn_triangle::new_normal(corners, rho, Rules::ALL)?;
    let mut nearest = rho * rho;
    grid.visit_ball(position, rho, |id, _| {
        let d = front.level.positions[id as usize] - position;
        nearest = nearest.min(d.dot(d));
    });
    let clearance = nearest.sqrt();
    let apart = (APART * rho).max(CLEARANCE * spacing);
    let taken = Candidate { position, normal, rho, corners: triangle, clearance, apart };
    (clearance >= CLEARANCE * spacing).then_some(taken)
}

/// The candidates that are taken: a maximal set of which no two are too near, those with the most room first.
pub(crate) fn independent(candidates: &[Candidate]) -> Vec<Candidate> {
    let reach: Vec<f32> = candidates.iter().map(|c| c.apart).collect();
    let positions: Vec<Vec3> = candidates.iter().map(|c| c.position).collect();
    let shape = GridShape::fit(&positions, &reach);
    let grid = Grid::build(shape, (0u32..).zip(positions.iter().copied()));
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    let room = |i: usize| candidates[i].clearance;
    order.sort_by(|&a, &b| {
        room(b).total_cmp(&room(a)).then_with(|| hash(a).cmp(&hash(b))).then(a.cmp(&b))
    });
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        Open,
        Taken,
        Out,
    }
    let mut states = vec![State::Open; candidates.len()];
    for i in order {
        if states[i] == State::Out {
            continue;
        }
        let near = |other: u32| {
            let d = positions[other as usize] - positions[i];
            other as usize != i && d.dot(d) < reach[i] * reach[i]
        };
        let mut crowded = false;
        grid.visit_ball(positions[i], reach[i], |other, _| {
            crowded |= near(other) && states[other as usize] == State::Taken;
        });
        if crowded {
            states[i] = State::Out;
            continue;
        }
        states[i] = State::Taken;
        grid.visit_ball(positions[i], reach[i], |other, _| {
            if near(other) {
                states[other as usize] = State::Out;
            }
        });
    }
    let taken = (0..candidates.len()).filter(|&i| states[i] == State::Taken);
    taken.map(|i| candidates[i]).collect()
}

/// A number that looks random, so that equal candidates are not taken in rows.
fn hash(i: usize) -> u32 {
    let x = (i as u32).wrapping_add(1).wrapping_mul(0x9e37_79b9);
    let x = (x ^ (x >> 16)).wrapping_mul(0x85eb_ca6b);
    (x ^ (x >> 13)).wrapping_mul(0xc2b2_ae35)
}
