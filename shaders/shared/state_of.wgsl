// Who is inserted: a candidate unless one before it that discards it was. Twin: `select` in
// crates/reference/src/selection.rs
//
// Expects `candidates`, `heads` and `links`.

/// The state of a candidate, as far as those that discard it have theirs.
fn state_of(c: u32) -> u32 {
    var state = INSERTED;
    for (var link = heads[c]; link != 0u; link = links[link - 1u].y) {
        let other = atomicLoad(&candidates[links[link - 1u].x].state);
        if other == WAITING {
            state = WAITING;
        } else if other != FREE {
            return FREE;
        }
    }
    return state;
}
