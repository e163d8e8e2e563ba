// Sheets that lie close to each other (ours). Twin: `same_side` in crates/reference/src/visible.rs

/// A rule beyond the paper: see `Rules` in crates/points/src/params.rs.
override own_side: bool = true;

/// Whether normals are on one side of the surface, so that their points see each other.
fn same_side(a: vec3<f32>, b: vec3<f32>) -> bool {
    return !own_side | dot3(a, b) > 0.0;
}
