// neighborhood: removes the members of N^E that lie behind others (eq. 8).
// Twin: `is_behind` in crates/reference/src/neighborhood.rs
// One invocation per arena entry: the entries of a point are compared with each other, which is too much for one.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> blocks: array<vec2<u32>>;
/// As in neighborhood_ball; the last word gets the bit REMOVED for removed members.
@group(0) @binding(4) var<storage, read_write> arena: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read_write> counters: Counters;

/// The accurate neighbourhood N^g, or else the fuzzy one N^f.
override accurate: bool = true;

@compute @workgroup_size(64)
fn neighborhood_badness(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = linear_index(id, groups);
    if i >= min(atomicLoad(&counters.arena), params.arena_words) / 4u {
        return;
    }
    let p = arena[i].w;
    // Removal is simultaneous: only the last word changes, and of it nobody else reads but the bit of doubtful members.
    if p < params.points && is_behind(p, i) {
        arena[i].w = p | REMOVED;
    }
    note_cut_loops(p);
}

/// The vector whose fuzzy plane is tested: q' - p for the accurate neighbourhood, p_i - p for the fuzzy one.
fn plane_vector(center: Point, i: u32) -> vec3<f32> {
    if accurate {
        return vec3(bitcast<f32>(arena[i].y), bitcast<f32>(arena[i].z), 0.0);
    }
    return (points[arena[i].x].position - center.position) * (1.0 / center.radius);
}

/// Whether the badness w_i (eq. 8) of member i is above 1: it lies behind its successors and predecessors.
fn is_behind(p: u32, i: u32) -> bool {
    let center = points[p];
    let block = blocks[p];
    let own = plane_vector(center, i);
    let x = bitcast<f32>(arena[i].y);
    let y = bitcast<f32>(arena[i].z);
    var badness = Badness(-2.0, -2.0);
    for (var j = block.x; j < block.x + block.y; j++) {
        // An exactly collinear point counts as successor.
        let succeeds = x * bitcast<f32>(arena[j].z) - y * bitcast<f32>(arena[j].y) >= 0.0;
        let takes_part = i != j && (arena[j].w & DOUBTFUL) == 0u;
        if takes_part && is_bad(&badness, own, plane_vector(center, j), succeeds) {
            return true;
        }
    }
    return false;
}
