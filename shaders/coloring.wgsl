// coloring: one round of a colouring of the conflict graph (Jones and Plassmann 1993).
// Twin: crates/reference/src/coloring.rs
// One invocation per point. dispatch: 1 in the round whose leftovers are counted.
//
// A point takes the lowest class that none of its neighbours with a higher priority has, once these all have one. So
// the classes are those of a sequential loop by priority, whatever rounds it takes to reach them.

@group(0) @binding(2) var<storage, read> conflict_blocks: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> conflict_entries: array<u32>;
@group(0) @binding(4) var<storage, read_write> mirror_heads: array<u32>;
@group(0) @binding(5) var<storage, read> mirror_links: array<vec2<u32>>;
/// One more than the class of each point; 0 for none yet.
@group(0) @binding(6) var<storage, read_write> classes: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> counters: Counters;

@compute @workgroup_size(64)
fn coloring(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if p >= params.points || atomicLoad(&classes[p]) != 0u {
        return;
    }
    // Classes are looked at in windows of 32.
    for (var window = 0u; ; window += 32u) {
        let taken = taken_classes(p, window);
        if taken.waiting {
            atomicAdd(&counters.uncolored, dispatch.x);
            break;
        }
        if taken.mask != 0xffffffffu {
            let number = window + firstTrailingBit(~taken.mask) + 1u;
            atomicStore(&classes[p], number);
            atomicMax(&counters.classes, number);
            break;
        }
    }
    note_cut_loops(p);
}

struct Taken {
    /// A bit for each class of the window that a neighbour of higher priority has.
    mask: u32,
    /// Whether a neighbour of higher priority has no class yet.
    waiting: bool,
}

fn taken_classes(p: u32, window: u32) -> Taken {
    var taken = Taken(0u, false);
    let list = conflict_blocks[p];
    for (var i = list.x; i < list.x + list.y; i++) {
        note_class(&taken, p, conflict_entries[i], window);
    }
    for (var link = mirror_heads[p]; link != 0u; link = mirror_links[link - 1u].y) {
        note_class(&taken, p, mirror_links[link - 1u].x, window);
    }
    return taken;
}

fn note_class(taken: ptr<function, Taken>, p: u32, q: u32, window: u32) {
    if scramble(q) <= scramble(p) {
        return;
    }
    let number = atomicLoad(&classes[q]);
    if number == 0u {
        (*taken).waiting = true;
    } else if number > window && number <= window + 32u {
        (*taken).mask |= 1u << (number - window - 1u);
    }
}

/// A bijection of the 32-bit integers without visible order (lowbias32, C. Wellons): the priority of an index.
fn scramble(id: u32) -> u32 {
    var x = id;
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}
