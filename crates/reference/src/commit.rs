//! The next level: old points with their new radii, then the inserted ones. Twin: `shaders/commit.wgsl`.

use crate::Level;
use crate::refine::LevelState;
use rayon::prelude::*;

/// Appends the inserted candidates to the level, in their order, and returns the corners of their triangles.
pub fn commit(level: &mut Level, state: &LevelState) -> Vec<[u32; 3]> {
    let LevelState { candidates, insertion, covers, .. } = state;
    let larger = |(a, b): (&f32, &f32)| a.max(*b);
    level.radii = insertion.radii.par_iter().zip(&covers.radii).map(larger).collect();
    let all = (0..candidates.len() as u32).into_par_iter();
    let inserted: Vec<u32> = all.filter(|&c| insertion.is_inserted(c as usize)).collect();
    let inserted = inserted.par_iter().map(|&c| c as usize);
    level.positions.par_extend(inserted.clone().map(|c| candidates.positions[c]));
    level.normals.par_extend(inserted.clone().map(|c| candidates.normals[c]));
    let radius = |c: usize| insertion.candidate_radii[c].max(covers.candidate_radii[c]);
    level.radii.par_extend(inserted.clone().map(radius));
    level.end_step();
    inserted.map(|c| candidates.corners[c]).collect()
}
