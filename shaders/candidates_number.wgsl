// candidates: numbers the triangles in the order of the slots to which they belong, and notes their corners.
// Twin: `number` in crates/reference/src/triangle_homes.rs
// One invocation per point.

@group(0) @binding(2) var<storage, read> fans: array<Fan>;
@group(0) @binding(3) var<storage, read> ring_entries: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> homes: array<u32>;
/// The first candidate of each point.
@group(0) @binding(5) var<storage, read> first_candidates: array<u32>;
/// The candidate of each slot that a triangle belongs to.
@group(0) @binding(6) var<storage, read_write> numbers: array<u32>;
@group(0) @binding(7) var<storage, read_write> candidates: array<Candidate>;

@compute @workgroup_size(64)
fn candidates_number(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if p >= params.points {
        return;
    }
    let block = fans[p].slots;
    if block.y == 0u {
        return;
    }
    var next = first_candidates[p];
    var begin = ring_entries[block.x].x;
    for (var slot = block.x; slot < block.x + block.y; slot++) {
        let is_last = slot + 1u == block.x + block.y;
        let end = ring_entries[select(slot + 1u, block.x, is_last)].x;
        if homes[slot] == slot {
            numbers[slot] = next;
            candidates[next].corners = canonical(p, begin, end);
            next += 1u;
        }
        begin = end;
    }
}
