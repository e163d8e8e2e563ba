// Radii at the next level (section 5, end). Twins: `new_radius` and `covers` in crates/reference/src/insertion.rs
//
// Expects `next_radii` and what new_ring.wgsl has.

/// Radii exceed the distances they must cover by this factor, so that rounding can't lose the farthest ring.
const COVER: f32 = 1.02;

/// Makes the next radius of a slot at least this.
fn cover(slot: u32, distance: vec3<f32>) {
    atomicMax(&next_radii[params.points + slot], bitcast<u32>(COVER * sqrt(dot3(distance, distance))));
}

/// The centre's radius covers N', those of N' cover the centre and their neighbours there. A point without new
/// neighbours keeps its radius.
fn store_radii(p: u32) {
    var farthest = 0.0;
    for (var i = 0u; i < ring.size; i++) {
        let slot = slot_at(i);
        if is_bound(slot) {
            continue;
        }
        let d = offset_of(slot);
        farthest = max(farthest, dot3(d, d));
        cover(slot, d);
        let next = slot_at(next_member(i));
        if directed_gap(i) < PI && !is_bound(next) {
            let side = offset_of(next) - d;
            cover(slot, side);
            cover(next, side);
        }
    }
    let radius = select(COVER * sqrt(farthest), ring.radius, farthest == 0.0);
    atomicStore(&next_radii[p], bitcast<u32>(radius));
}
