// conflicts: makes the graph symmetric. A conflict that only one side found is linked to the other side's point.
// One invocation per point. The order of the links is that of timing; the colouring does not depend on it.

@group(0) @binding(2) var<storage, read> conflict_blocks: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> conflict_entries: array<u32>;
/// One more than the first link of each point; 0 for none.
@group(0) @binding(4) var<storage, read_write> mirror_heads: array<atomic<u32>>;
/// The point that found the conflict, and one more than the next link.
@group(0) @binding(5) var<storage, read_write> mirror_links: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read_write> counters: Counters;

@compute @workgroup_size(64)
fn conflicts_mirror(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if p >= params.points {
        return;
    }
    let own = conflict_blocks[p];
    for (var i = own.x; i < own.x + own.y; i++) {
        let q = conflict_entries[i];
        if found(q, p) {
            continue;
        }
        let link = atomicAdd(&counters.mirrored, 1u);
        if link < arrayLength(&mirror_links) {
            mirror_links[link] = vec2(p, atomicExchange(&mirror_heads[q], link + 1u));
        }
    }
    note_cut_loops(p);
}

/// Whether q's own list holds p.
fn found(q: u32, p: u32) -> bool {
    let list = conflict_blocks[q];
    for (var i = list.x; i < list.x + list.y; i++) {
        if conflict_entries[i] == p {
            return true;
        }
    }
    return false;
}
