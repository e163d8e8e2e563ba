// Candidates of which some invocations write the state while others read it.

/// As Candidate, with the state atomic.
struct SharedCandidate {
    place: vec4<f32>,
    normal: vec3<f32>,
    state: atomic<u32>,
    corners: vec3<u32>,
    size: f32,
}
