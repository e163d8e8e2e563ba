// What a new neighbourhood starts with (section 5, eq. 10). Twin: crates/reference/src/new_ring/gather.rs
//
// Expects what insertion.wgsl, new_ring.wgsl and discard.wgsl have.

/// A rule beyond the paper: see `Rules` in crates/points/src/params.rs.
override curve_bounds: bool = true;

/// Starts N' with the new points nearer than λ1 r, and Y with the others nearer than r (eq. 10).
fn gather(p: u32) {
    let near = fans[p].near;
    let list = fans[p].around;
    // First the inserted ones are listed where Y will be: loops over few are cheaper than branches.
    var size = 0u;
    for (var i = list.x; i < list.x + list.y; i++) {
        let c = around[i];
        set_word(OUTER, size, c);
        // Inserted by an earlier class.
        size += u32(atomicLoad(&candidates[c].state) < dispatch.x);
    }
    for (var i = 0u; i < size; i++) {
        let c = word(OUTER, i);
        let there = candidates[c].place;
        let d = there.xyz - ring.center;
        let d2 = dot3(d, d);
        let sphere = params.lambda2 * there.w;
        // A new point in the centre's own place has no direction: it can only discard.
        let joins = d2 < near * near & is_apart(d2, ring.radius);
        if joins {
            place(c, d, candidates[c].normal, sphere);
        }
        set_word(OUTER, ring.outer_size, c);
        set_vector(OUTER_OFFSET, ring.outer_size, d);
        set_number(OUTER_SPHERE, ring.outer_size, sphere);
        ring.outer_size += u32(!joins & d2 < ring.radius * ring.radius);
    }
    add_bounds();
}

/// Lists the candidates of the fan that are not in N'.
fn gather_own(slots: vec2<u32>, near: f32) {
    for (var slot = slots.x; slot < slots.x + slots.y; slot++) {
        // Slots without a triangle have one that does not exist.
        let c = of_slot[slot];
        let at = min(c, params.candidates - 1u);
        let there = candidates[at].place;
        let d = there.xyz - ring.center;
        let d2 = dot3(d, d);
        let is_there = atomicLoad(&candidates[at].state) < dispatch.x;
        let is_new = is_there & d2 < near * near & is_apart(d2, ring.radius);
        set_word(OWN, ring.own, c);
        set_number(OWN_ANGLE, ring.own, angle_of(d));
        set_vector(OWN_OFFSET, ring.own, d);
        set_number(OWN_INVERSE, ring.own, 1.0 / sqrt(d2));
        ring.own += u32(c != NONE & there.w > 0.0 & !is_new);
    }
    for (var k = 0u; k < ring.own; k++) {
        let closest = discarded_by_outer(k);
        set_word(OWN_OUTER, k, closest.c);
        set_number(OWN_SQUARED, k, closest.squared);
    }
}

/// Where a step keeps the curves, the neighbours of a point along them bound its gaps, though they are not new.
fn add_bounds() {
    if !with_curves || ring.record == NONE || !curve_bounds || params.candidates > params.triangles {
        return;
    }
    let partners = record_partners(ring.record);
    for (var k = 0u; k < 2u; k++) {
        if partners[k] != NONE {
            let q = record_point(partners[k]);
            place(params.candidates + q, points[q].position - ring.center, points[q].normal, 0.0);
        }
    }
}
