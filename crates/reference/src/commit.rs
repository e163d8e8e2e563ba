//! The next level: old points with their new radii, then the inserted ones. Twin: `shaders/commit.wgsl`.

use crate::Level;
use crate::pn_triangle;
use crate::refine::LevelState;
use surfine_points::RefineParams;

/// Appends the inserted candidates to the level, in their order, and returns the corners of their triangles.
pub fn commit(level: &mut Level, state: &LevelState, params: &RefineParams) -> Vec<[u32; 3]> {
    let LevelState { candidates, insertion, covers, .. } = state;
    let mut parents = Vec::new();
    let larger = |(a, b): (&f32, &f32)| a.max(*b);
    level.radii = insertion.radii.iter().zip(&covers.radii).map(larger).collect();
    for c in (0..candidates.len()).filter(|&c| insertion.is_inserted(c)) {
        let (mut position, mut normal) = (candidates.positions[c], candidates.normals[c]);
        if params.simplified && c < candidates.first_on_curve {
            // Section 7, simplification 4: the displacement is computed for inserted points only.
            let corners = candidates.corners[c].map(|corner| level.corner(corner));
            position = pn_triangle::displaced_center(corners);
            // The candidate has the normal of the flat triangle.
            normal =
                pn_triangle::new_normal(corners, candidates.rho[c], params.rules).unwrap_or(normal);
        }
        parents.push(candidates.corners[c]);
        level.positions.push(position);
        level.normals.push(normal);
        level.radii.push(insertion.candidate_radii[c].max(covers.candidate_radii[c]));
    }
    level.end_step();
    parents
}
