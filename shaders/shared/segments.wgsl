// Segments of creases, and those near a place. Twin: `Curves` in crates/reference/src/visible.rs
//
// Expects what curves.wgsl has.

/// The records at the two ends of a segment, on one of its sides.
fn segment_side(segment: u32, side: u32) -> vec2<u32> {
    let at = curve_word(9) + SEGMENT_WORDS * segment + 2u * side;
    return vec2(curve_word(at), curve_word(at + 1u));
}

/// Half of the longest segment.
fn longest_half() -> f32 {
    return bitcast<f32>(curve_word(8));
}

/// Points of a larger cosine between their normals lie on one side of every crease.
fn softest_crease() -> f32 {
    return bitcast<f32>(curve_word(12u));
}

fn segment_cell(x: vec3<f32>) -> vec3<i32> {
    return vec3<i32>(floor((x - curve_vector(0u)) * bitcast<f32>(curve_word(3))));
}

fn segment_bits() -> vec3<u32> {
    return vec3(curve_word(4), curve_word(5), curve_word(6));
}

/// As ball_walk.
fn segment_walk(center: vec3<f32>, radius: f32) -> BallWalk {
    let reach = vec3(radius * SLACK + bitcast<f32>(curve_word(7)) * 1e-4);
    return walk_between(segment_cell(center - reach), segment_cell(center + reach), segment_bits());
}

/// The entries of the next run of segments: the first one and that after the last.
fn next_segments(walk: ptr<function, BallWalk>) -> vec2<u32> {
    let cells = next_cells(walk, segment_bits());
    return vec2(curve_word(curve_word(10) + cells.x), curve_word(curve_word(10) + cells.y));
}

/// The segment of an entry.
fn segment_at(entry: u32) -> u32 {
    return curve_word(curve_word(11) + entry);
}
