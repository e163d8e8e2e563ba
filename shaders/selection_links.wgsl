// selection: links each contested candidate to those in the fans of its corners that discard it (eq. 11): the larger
// ones, and those that are not contested.
// Twin: `contested_overlaps` in crates/reference/src/contested.rs
// One invocation per candidate that waits for round 1.

@group(0) @binding(2) var<storage, read> candidates: array<Candidate>;
@group(0) @binding(3) var<storage, read> fans: array<Fan>;
@group(0) @binding(4) var<storage, read> of_slot: array<u32>;
/// The candidates that wait in even rounds, then those that wait in odd ones.
@group(0) @binding(5) var<storage, read> waiting: array<u32>;
/// Number of both.
@group(0) @binding(6) var<storage, read> rounds: array<u32, 2>;
/// One more than the first link of each candidate; 0 for none.
@group(0) @binding(7) var<storage, read_write> heads: array<u32>;
/// The candidate that discards, and one more than the next link.
@group(0) @binding(8) var<storage, read_write> links: array<vec2<u32>>;
@group(0) @binding(9) var<storage, read_write> counters: Counters;

@compute @workgroup_size(64)
fn selection_links(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = linear_index(id, groups);
    if i >= rounds[1] {
        return;
    }
    let c = waiting[params.candidates + i];
    let contested = Contested(c, candidates[c].place.xyz, candidates[c].normal);
    let corners = candidates[c].corners;
    let first = add_links(contested, corners.x, 0u);
    let second = add_links(contested, corners.y, first);
    heads[c] = add_links(contested, corners.z, second);
    note_cut_loops(corners.x);
}

struct Contested {
    id: u32,
    place: vec3<f32>,
    normal: vec3<f32>,
}

/// Puts those of a fan that discard a candidate before its other links, and returns one more than the first one.
fn add_links(x: Contested, p: u32, head: u32) -> u32 {
    let block = fans[p].slots;
    var first = head;
    for (var slot = block.x; slot < block.x + block.y; slot++) {
        let h = of_slot[slot];
        if h != NONE && h != x.id && discards(h, x) {
            first = add_link(h, first);
        }
    }
    return first;
}

fn discards(h: u32, x: Contested) -> bool {
    let d = x.place - candidates[h].place.xyz;
    let sphere = params.lambda2 * candidates[h].size;
    return candidates[h].place.w > 0.0 && dot3(d, d) < sphere * sphere
        && same_side(candidates[h].normal, x.normal)
        && (candidates[h].state == INSERTED || precedes(h, x.id));
}

/// Links a candidate to one that discards it, before its other links, and returns one more than the first of them.
fn add_link(h: u32, next: u32) -> u32 {
    let link = new_link();
    if link == NONE {
        return next;
    }
    links[link] = vec2(h, next);
    return link + 1u;
}
