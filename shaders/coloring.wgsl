// coloring: one round of a colouring of the conflict graph (Jones and Plassmann 1993).
// Twin: crates/reference/src/coloring.rs
// One invocation per point that waits, then one per point of the next range of priorities.
// dispatch: number of the round.
//
// A point takes the lowest class that none of those in conflict with it has that choose before it, once these all have
// one. So the classes are those of a sequential loop by priority, whatever rounds it takes to reach them. Most points
// choose in the round of their range.

@group(0) @binding(2) var<storage, read> fans: array<Fan>;
/// Lists of candidates around points and of conflicts.
@group(0) @binding(3) var<storage, read> around: array<u32>;
@group(0) @binding(4) var<storage, read> mirror_heads: array<u32>;
@group(0) @binding(5) var<storage, read> mirror_links: array<vec2<u32>>;
/// One more than the class of each point; 0 for none yet.
@group(0) @binding(6) var<storage, read_write> classes: array<atomic<u32>>;
/// The first point of each range of priorities and one more, then the points by range.
@group(0) @binding(7) var<storage, read> order: array<u32>;
/// The points that wait in even rounds, then those that wait in odd ones.
@group(0) @binding(8) var<storage, read_write> waiting: array<u32>;
/// Number of both.
@group(0) @binding(9) var<storage, read_write> rounds: array<atomic<u32>, 2>;
@group(0) @binding(10) var<storage, read_write> counters: Counters;

@compute @workgroup_size(64)
fn coloring(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = linear_index(id, groups);
    let parity = dispatch.x & 1u;
    let left = atomicLoad(&rounds[parity]);
    var p = 0u;
    if i < left {
        p = waiting[parity * params.points + i];
    } else {
        let member = order[min(dispatch.x, RANGES)] + i - left;
        if member >= order[min(dispatch.x + 1u, RANGES)] {
            return;
        }
        p = order[RANGES + 1u + member];
    }
    // Classes are looked at in windows of 32.
    for (var window = 0u; ; window += 32u) {
        let taken = taken_classes(p, window);
        if taken.waiting {
            let at = atomicAdd(&rounds[1u - parity], 1u);
            waiting[(1u - parity) * params.points + at] = p;
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
    /// A bit for each class of the window that is taken.
    mask: u32,
    /// Whether somebody who chooses before has no class yet.
    waiting: bool,
}

fn taken_classes(p: u32, window: u32) -> Taken {
    var taken = Taken(0u, false);
    let first = fans[p].around.x + fans[p].around.y;
    for (var i = first; i < first + fans[p].conflicts.y; i++) {
        note_class(&taken, around[i], window);
    }
    for (var link = mirror_heads[p]; link != 0u; link = mirror_links[link - 1u].y) {
        note_class(&taken, mirror_links[link - 1u].x, window);
    }
    return taken;
}

fn note_class(taken: ptr<function, Taken>, q: u32, window: u32) {
    let number = atomicLoad(&classes[q]);
    (*taken).waiting |= number == 0u;
    let inside = number > window & number <= window + 32u;
    (*taken).mask |= select(0u, 1u << ((number - window - 1u) & 31u), inside);
}
