//! The next level: old points with their new radii, then the inserted ones. Twin: `shaders/commit.wgsl`.

use crate::Level;
use crate::candidates::fan_triangle;
use crate::pn_triangle;
use crate::refine::LevelState;
use surfine_points::RefineParams;

/// Appends the inserted candidates to the level, by (creator, slot), and returns the corners of their triangles.
pub fn commit(level: &mut Level, state: &LevelState, params: &RefineParams) -> Vec<[u32; 3]> {
    let LevelState { rings, candidates, insertion, covers, .. } = state;
    let mut parents = Vec::new();
    let larger = |(a, b): (&f32, &f32)| a.max(*b);
    level.radii = insertion.radii.iter().zip(&covers.radii).map(larger).collect();
    for slot in (0..candidates.len()).filter(|&s| insertion.inserted[s]) {
        level.radii.push(insertion.slot_radii[slot].max(covers.slot_radii[slot]));
        if let Some(rank) = slot.checked_sub(candidates.first_on_curve) {
            let point = level.curve_points[rank];
            parents.push(point.parents);
            level.positions.push(point.position);
            level.normals.push(point.normal);
            continue;
        }
        let owner = candidates.owners[slot] as usize;
        let triangle = fan_triangle(level, rings, owner, slot - rings.slots(owner).start);
        let triangle = triangle.expect("an inserted candidate has a triangle");
        let (position, normal) = if params.simplified {
            // Section 7, simplification 4: the displacement is computed for inserted points only.
            let corners = triangle.map(|c| level.corner(c));
            // The candidate has the normal of the flat triangle.
            let normal = pn_triangle::new_normal(corners, candidates.rho[slot], params.rules)
                .unwrap_or(candidates.normals[slot]);
            (pn_triangle::displaced_center(corners), normal)
        } else {
            (candidates.positions[slot], candidates.normals[slot])
        };
        parents.push(triangle);
        level.positions.push(position);
        level.normals.push(normal);
    }
    level.end_step();
    parents
}
