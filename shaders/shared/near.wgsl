// Within which distance new points are new neighbours (section 5). Expects `points`, `ring_starts`, `candidate_normals`.

/// λ1 r, or less in the first step: candidates.wgsl puts it into every slot of the point.
fn near_radius(p: u32) -> f32 {
    let first = ring_starts[p];
    if first == ring_starts[p + 1u] {
        return params.lambda1 * points[p].radius;
    }
    return candidate_normals[first].w;
}
