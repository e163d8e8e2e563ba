/// As Candidate, with the state atomic.
struct SharedCandidate {
    place: vec4<f32>,
    normal: vec3<f32>,
    state: atomic<u32>,
    corners: vec3<u32>,
    size: f32,
}

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
