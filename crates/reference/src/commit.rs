//! The next level: old points with their new radii, then the inserted ones. Twin: `shaders/commit.wgsl`.

use crate::Level;
use crate::candidates::Candidates;
use crate::columns::BLOCK;
use crate::refine::LevelState;
use crate::triangles::{NewPoints, Triangles, displaced_points};
use glam::Vec3;
use rayon::prelude::*;
use surfine_points::{RefineParams, Rules};

/// Appends the inserted candidates to the level, in their order, and returns the corners of their triangles.
pub fn commit(level: &mut Level, state: &LevelState, params: &RefineParams) -> Vec<[u32; 3]> {
    let LevelState { candidates, insertion, covers, .. } = state;
    let larger = |(a, b): (&f32, &f32)| a.max(*b);
    level.radii = insertion.radii.par_iter().zip(&covers.radii).map(larger).collect();
    let all = (0..candidates.len() as u32).into_par_iter();
    let inserted: Vec<u32> = all.filter(|&c| insertion.is_inserted(c as usize)).collect();
    if params.simplified {
        let (positions, normals) = displaced(level, candidates, params.rules, &inserted);
        level.positions.par_extend(positions);
        level.normals.par_extend(normals);
    } else {
        let own = inserted.par_iter().map(|&c| c as usize);
        level.positions.par_extend(own.clone().map(|c| candidates.positions[c]));
        level.normals.par_extend(own.map(|c| candidates.normals[c]));
    }
    let inserted = inserted.par_iter().map(|&c| c as usize);
    let radius = |c: usize| insertion.candidate_radii[c].max(covers.candidate_radii[c]);
    level.radii.par_extend(inserted.clone().map(radius));
    level.end_step();
    inserted.map(|c| candidates.corners[c]).collect()
}

/// Positions and normals of the inserted candidates as points of the next level (section 7, simplification 4): the displacement is
/// computed for inserted points only. The points on curves, which come last, are in their places.
fn displaced(
    level: &Level,
    candidates: &Candidates,
    rules: Rules,
    inserted: &[u32],
) -> (Vec<Vec3>, Vec<Vec3>) {
    let own = |&c: &u32| (candidates.positions[c as usize], candidates.normals[c as usize]);
    let (mut positions, mut normals): (Vec<Vec3>, Vec<Vec3>) = inserted.par_iter().map(own).unzip();
    let smooth = inserted.partition_point(|&c| (c as usize) < candidates.first_on_curve);
    positions[..smooth]
        .par_chunks_mut(BLOCK)
        .zip(normals[..smooth].par_chunks_mut(BLOCK))
        .zip(inserted.par_chunks(BLOCK))
        .for_each(|((positions, normals), inserted)| {
            displace(level, candidates, rules, inserted, positions, normals);
        });
    (positions, normals)
}

/// Displaces some points. Their candidates have the normals of the flat triangles, which stay where the curved ones have none.
fn displace(
    level: &Level,
    candidates: &Candidates,
    rules: Rules,
    inserted: &[u32],
    positions: &mut [Vec3],
    normals: &mut [Vec3],
) {
    let (mut triangles, mut new) = (Triangles::EMPTY, NewPoints::EMPTY);
    let mut corners = [[0; 3]; BLOCK];
    for (i, &c) in inserted.iter().enumerate().take(positions.len()) {
        (corners[i], new.rho[i]) = (candidates.corners[c as usize], candidates.rho[c as usize]);
    }
    triangles.gather(level, &corners[..positions.len()]);
    displaced_points(&triangles, rules, &mut new);
    for (i, (position, normal)) in positions.iter_mut().zip(normals).enumerate() {
        let curved = new.normals.get(i);
        *position = new.positions.get(i);
        *normal = if curved == Vec3::ZERO { *normal } else { curved };
    }
}
