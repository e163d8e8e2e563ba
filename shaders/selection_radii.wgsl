// selection: the new neighbourhoods N', and radii at the next level (section 5, end).
// Twin: `selection` in crates/reference/src/selection.rs
// One invocation per point.
//
// N' is what stands for the candidates of the fan, in their order. The point's radius covers N', and stays where that
// is empty; the members of N' cover the point and their neighbours in N'.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read_write> fans: array<Fan>;
@group(0) @binding(4) var<storage, read> of_slot: array<u32>;
@group(0) @binding(5) var<storage, read> candidates: array<Candidate>;
/// Who stands for each candidate.
@group(0) @binding(6) var<storage, read> stand_ins: array<u32>;
/// Bits of the radii at the next level: of the points, then of the candidates.
@group(0) @binding(7) var<storage, read_write> next_radii: array<atomic<u32>>;
/// The members of N', each once, from the first slot of each point on.
@group(0) @binding(8) var<storage, read_write> members: array<u32>;
@group(0) @binding(9) var<storage, read_write> counters: Counters;

/// Points with more members are left over by next_ring.wgsl.
const LONGEST_NEXT: u32 = 48u;

/// A rule beyond the paper: see `Rules` in crates/points/src/params.rs. Nothing else asks for N'.
override next_ring: bool = true;

@compute @workgroup_size(64)
fn selection_radii(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if p >= params.points {
        return;
    }
    let slots = fans[p].slots;
    let end = slots.x + slots.y;
    var farthest = 0u;
    var size = 0u;
    var has_others = false;
    // Each side is between two members: the one before looks back on it.
    var member = Member(NONE, false, vec3(0.0));
    var back = 0u;
    if slots.y > 0u {
        member = member_of(slots.x);
        back = side_cover(member_of(end - 1u), member);
    }
    for (var slot = slots.x; slot < end; slot++) {
        let after = member_of(select(slot + 1u, slots.x, slot + 1u == end));
        let ahead = side_cover(member, after);
        if member.id != NONE {
            let radius = cover(member.place - points[p].position);
            farthest = max(farthest, radius);
            raise(member.id, max(radius, max(back, ahead)));
        }
        if next_ring {
            members[slots.x + size] = member.id;
            size += u32(member.id != NONE);
            has_others |= member.is_other;
        }
        back = ahead;
        member = after;
    }
    atomicStore(&next_radii[p], select(farthest, bitcast<u32>(points[p].radius), farthest == 0u));
    if next_ring {
        if has_others {
            size = list_once(slots);
        }
        fans[p].around = vec2(slots.x, size);
        fans[p].left_over = 0u;
        if size + slots.y + 1u > LONGEST_NEXT {
            fans[p].left_over = NEXT_RING;
            atomicOr(&counters.left_over, NEXT_RING);
            atomicMax(&counters.longest_row, size + slots.y + 1u);
        }
    }
    note_cut_loops(p);
}

/// Who stands for the candidate of a slot, or NONE, and its place.
struct Member {
    id: u32,
    /// Whether it is not that candidate itself.
    is_other: bool,
    place: vec3<f32>,
}

fn member_of(slot: u32) -> Member {
    let id = stand_in(slot);
    if id == NONE {
        return Member(NONE, false, vec3(0.0));
    }
    return Member(id, id != of_slot[slot], candidates[id].place.xyz);
}

/// What covers the side between two members that follow each other; 0 where there is none.
fn side_cover(a: Member, b: Member) -> u32 {
    return select(cover(b.place - a.place), 0u, a.id == NONE || b.id == NONE);
}

/// Lists the members of N' once where some stand for others, and returns their number.
fn list_once(slots: vec2<u32>) -> u32 {
    var size = 0u;
    for (var slot = slots.x; slot < slots.x + slots.y; slot++) {
        let member = stand_in(slot);
        members[slots.x + size] = member;
        size += u32(member != NONE && !is_repeated(slot, member, slots));
    }
    return size;
}

/// Whether a member is in the fan in its own right, or for an earlier slot.
fn is_repeated(slot: u32, member: u32, slots: vec2<u32>) -> bool {
    if of_slot[slot] == member {
        return false;
    }
    for (var other = slots.x; other < slots.x + slots.y; other++) {
        let is_first = other < slot || of_slot[other] == member;
        if is_first && other != slot && stand_in(other) == member {
            return true;
        }
    }
    return false;
}

/// Who stands for the candidate of a slot, or NONE.
fn stand_in(slot: u32) -> u32 {
    let c = of_slot[slot];
    if c == NONE {
        return NONE;
    }
    return stand_ins[c];
}

/// Raises the radius of a candidate. Most are large enough: to look costs less than to write.
fn raise(c: u32, radius: u32) {
    let at = params.points + c;
    if atomicLoad(&next_radii[at]) < radius {
        atomicMax(&next_radii[at], radius);
    }
}
