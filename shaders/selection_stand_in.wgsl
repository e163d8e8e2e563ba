// selection: who stands for each candidate in the fans. Twin: `stand_in` in crates/reference/src/selection.rs
// One invocation per candidate.

@group(0) @binding(2) var<storage, read> candidates: array<Candidate>;
@group(0) @binding(3) var<storage, read> heads: array<u32>;
@group(0) @binding(4) var<storage, read> links: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read_write> stand_ins: array<u32>;
@group(0) @binding(6) var<storage, read_write> counters: Counters;

@compute @workgroup_size(64)
fn selection_stand_in(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let c = linear_index(id, groups);
    if c >= params.candidates {
        return;
    }
    if candidates[c].state != FREE {
        stand_ins[c] = c;
    } else {
        stand_ins[c] = closest_discarding(c);
        note_cut_loops(candidates[c].corners.x);
    }
}

/// The closest of those that discard a candidate; ties go by index.
fn closest_discarding(c: u32) -> u32 {
    var closest = NONE;
    var squared = 0.0;
    for (var link = heads[c]; link != 0u; link = links[link - 1u].y) {
        let h = links[link - 1u].x;
        if candidates[h].state != FREE {
            let d = candidates[h].place.xyz - candidates[c].place.xyz;
            let d2 = dot3(d, d);
            if closest == NONE || d2 < squared || (d2 == squared && h < closest) {
                closest = h;
                squared = d2;
            }
        }
    }
    return closest;
}
