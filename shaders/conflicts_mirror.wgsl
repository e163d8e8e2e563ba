// conflicts: makes the graph symmetric. A conflict that only one side found is linked to the point of the other side,
// if that chooses its class later.
// Twin: `with_others` in crates/reference/src/conflicts.rs
// One invocation per point. The order of the links is that of timing; the colouring does not depend on it.

@group(0) @binding(2) var<storage, read> fans: array<Fan>;
/// Lists of candidates around points and of conflicts.
@group(0) @binding(3) var<storage, read> around: array<u32>;
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
    let conflicts = fans[p].conflicts;
    let first = fans[p].around.x + fans[p].around.y;
    for (var i = first + conflicts.y; i < first + conflicts.x; i++) {
        let q = around[i];
        if found_before(q, p) {
            continue;
        }
        let link = new_link();
        if link != NONE {
            mirror_links[link] = vec2(p, atomicExchange(&mirror_heads[q], link + 1u));
        }
    }
    note_cut_loops(p);
}

/// Whether q's own list holds p among those that choose before it.
fn found_before(q: u32, p: u32) -> bool {
    let first = fans[q].around.x + fans[q].around.y;
    for (var i = first; i < first + fans[q].conflicts.y; i++) {
        if around[i] == p {
            return true;
        }
    }
    return false;
}
