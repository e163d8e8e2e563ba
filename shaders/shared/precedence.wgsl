// The order in which candidates are decided. Twin: `precedes` in crates/reference/src/selection.rs
//
// Expects `candidates` and what priority.wgsl has.

/// Whether a candidate is decided before another one: points on curves are before all, then comes the larger one, then
/// that of the higher hashed index.
fn precedes(a: u32, b: u32) -> bool {
    let size_a = candidates[a].size;
    let size_b = candidates[b].size;
    let is_larger = size_a > size_b || (size_a == size_b && scramble(a) > scramble(b));
    return a != b && b < params.triangles && (a >= params.triangles || is_larger);
}
