// Links of lists that many invocations append to.
//
// Expects `counters`.

/// The place of a new link, or NONE if there is no room: too small a buffer is seen by the host in the counters, and the
/// stage runs again.
fn new_link() -> u32 {
    let link = atomicAdd(&counters.mirrored, 1u);
    if link == NONE {
        atomicAdd(&counters.mirrored_high, 1u);
    }
    // Once the count has wrapped around, places were given before.
    let is_free = link < params.mirror_links && atomicLoad(&counters.mirrored_high) == 0u;
    return select(NONE, link, is_free);
}
