// neighborhood: takes natural neighbours back that were removed, in gaps of the ring that are wide open (ours).
// Twins: `is_in_open_gap` and `is_natural` in crates/reference/src/neighborhood.rs
// One invocation per arena entry.

@group(0) @binding(2) var<storage, read> blocks: array<vec2<u32>>;
/// As neighborhood_badness leaves it; the last word becomes BACK for members that come back.
@group(0) @binding(3) var<storage, read_write> arena: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read_write> counters: Counters;

/// A ring gap from 100° on may miss a natural neighbour, radians.
const OPEN_GAP: f32 = 1.7453293;

@compute @workgroup_size(64)
fn neighborhood_natural(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = linear_index(id, groups);
    if i >= min(atomicLoad(&counters.arena), params.arena_words) / 4u {
        return;
    }
    // Kept members stay, and others see no difference between removed ones and those that come back.
    let word = arena[i].w;
    let p = word & ~(REMOVED | DOUBTFUL);
    if (word & REMOVED) != 0u && p < params.points {
        if is_in_open_gap(p, i) && is_natural(p, i) {
            arena[i].w = BACK;
        }
        note_cut_loops(p);
    }
}

/// Whether the kept members next to member i on both sides leave a gap that may miss a neighbour.
fn is_in_open_gap(p: u32, i: u32) -> bool {
    let block = blocks[p];
    let own = plane_place(i);
    var after = TAU;
    var before = TAU;
    for (var j = block.x; j < block.x + block.y; j++) {
        if arena[j].w == p {
            let other = plane_place(j);
            let along = own.x * other.x + own.y * other.y;
            let across = own.x * other.y - own.y * other.x;
            after = min(after, direction_angle(across, along));
            before = min(before, direction_angle(-across, along));
        }
    }
    return after + before >= OPEN_GAP;
}

/// Whether member i is a natural neighbour of the centre on its tangent plane: whether a piece of their bisector, no
/// farther from its middle than the radius, is nearer to both than to every other member.
fn is_natural(p: u32, i: u32) -> bool {
    let block = blocks[p];
    let own = plane_place(i);
    // Places on the bisector are own / 2 + t (-own.y, own.x).
    var high = 1.0 / sqrt(own.x * own.x + own.y * own.y);
    var low = -high;
    for (var j = block.x; j < block.x + block.y; j++) {
        if j == i {
            continue;
        }
        let other = plane_place(j);
        let along = own.x * other.x + own.y * other.y;
        let across = own.x * other.y - own.y * other.x;
        let room = 0.5 * ((other.x * other.x + other.y * other.y) - along);
        if across > 0.0 {
            high = min(high, room / across);
        } else if across < 0.0 {
            low = max(low, room / across);
        } else if room < 0.0 {
            return false;
        }
    }
    return low < high;
}

/// Where member i lies on the tangent plane.
fn plane_place(i: u32) -> vec2<f32> {
    return vec2(bitcast<f32>(arena[i].y), bitcast<f32>(arena[i].z));
}
