// The lists of a point: the candidates that it sees around it, and its conflicts. Twin: `conflicts` in
// crates/reference/src/conflicts.rs
//
// Expects what conflicts.wgsl declares.

/// How many words the rows must hold: the corners of each candidate may be in conflict.
fn count_members(p: u32) -> u32 {
    return 3u * count_within(points[p].position, query_radius(p, reach_of(p))) + 1u;
}

/// Number of candidates that a point sees, and of points in conflict with it.
struct Looked {
    seen: u32,
    found: u32,
}

/// Stores both lists; false if there are more conflicts than fit. Too small a buffer is seen by the host in the
/// counters, and the stage runs again.
fn store(p: u32, reach: Reach, size: u32) -> bool {
    let looked = look_around(p, reach, size);
    let found = looked.found;
    let seen = looked.seen;
    if !fits(found + 1u) {
        return false;
    }
    if fans[p].left_over != 0u {
        atomicOr(&counters.left_over, fans[p].left_over);
        atomicMax(&counters.longest_row, seen + fans[p].slots.y + 1u);
    }
    let first = atomicAdd(&counters.around, seen + found);
    if first + seen + found < first {
        atomicAdd(&counters.around_high, 1u);
    }
    fans[p].around = vec2(first, seen);
    if first + seen + found > params.around_entries {
        fans[p].conflicts = vec2(0u);
        return true;
    }
    for (var i = 0u; i < seen; i++) {
        around[first + i] = word(ID, i);
    }
    // Those that choose their class before p come first.
    var before = 0u;
    var after = found;
    for (var i = 0u; i < found; i++) {
        let q = word(FOUND, i);
        if scramble(q) > scramble(p) {
            around[first + seen + before] = q;
            before += 1u;
        } else {
            after -= 1u;
            around[first + seen + after] = q;
        }
    }
    fans[p].conflicts = vec2(found, before);
    return true;
}

/// Looks at the candidates around p: lists the corners of those within the distance of conflicts in the row
/// FOUND, each once and not p itself, and keeps those that p sees within its largest radius. Says which kernels'
/// rows are too short for them.
fn look_around(p: u32, reach: Reach, size: u32) -> Looked {
    let center = Seen(points[p].position, points[p].normal, record_of(p));
    let near_curves = is_near_curves(center.position, reach.largest);
    let near = fans[p].near;
    var looked = Looked(0u, 0u);
    var conflicting = 0u;
    var close = 0u;
    for (var i = 0u; i < size; i++) {
        let c = word(ID, i);
        let d = candidates[c].place.xyz - center.position;
        let d2 = dot3(d, d);
        // New points on curves are there before all others: nobody has them.
        set_word(CLOSE, conflicting, c);
        conflicting += u32(d2 <= reach.conflicts * reach.conflicts & c < params.triangles);
        let within = reach_of_candidate(p, reach, params.lambda2 * candidates[c].place.w);
        var seen = d2 <= within * within & same_side(candidates[c].normal, center.normal);
        if with_curves {
            let other = Seen(candidates[c].place.xyz, candidates[c].normal, record_of_candidate(c));
            seen = seen && sees(center, near_curves, reach.largest, other);
        }
        set_word(ID, looked.seen, c);
        looked.seen += u32(seen);
        close += u32(seen & d2 < near * near);
    }
    for (var i = 0u; i < conflicting; i++) {
        looked.found = note_conflicts(p, candidates[word(CLOSE, i)].corners, looked.found);
    }
    // Besides those that are near already, each own candidate can enter N' or bring in one of Y, and curves bound gaps.
    // All that are seen may be listed at once.
    let longest = max(close + reach.own + 2u, looked.seen);
    fans[p].left_over = select(0u, INSERTION, longest + 1u > LONGEST_NEW)
        | select(0u, NEXT_RING, looked.seen + fans[p].slots.y + 1u > LONGEST_NEXT);
    return looked;
}

/// Adds corners to the row FOUND that are not there yet.
fn note_conflicts(p: u32, corners: vec3<u32>, found: u32) -> u32 {
    var known = corners == vec3(p);
    for (var i = 0u; i < found; i++) {
        known |= corners == vec3(word(FOUND, i));
    }
    var size = found;
    set_word(FOUND, size, corners.x);
    size += u32(!known.x);
    set_word(FOUND, size, corners.y);
    size += u32(!known.y);
    set_word(FOUND, size, corners.z);
    return size + u32(!known.z);
}
