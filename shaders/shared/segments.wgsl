// Segments of creases, and those near a place. Twin: `Curves` in crates/reference/src/visible.rs
//
// Expects what curves.wgsl has.

/// The records at the two ends of a segment, on one of its sides.
fn segment_side(segment: u32, side: u32) -> vec2<u32> {
    let at = params.segments_begin + SEGMENT_WORDS * segment + 2u * side;
    return vec2(curve_word(at), curve_word(at + 1u));
}

fn segment_cell(x: vec3<f32>) -> vec3<i32> {
    return vec3<i32>(floor((x - params.segment_origin) * params.segment_inverse_cell));
}

/// As ball_walk.
fn segment_walk(center: vec3<f32>, radius: f32) -> BallWalk {
    let reach = vec3(radius * SLACK + params.segment_cell * 1e-4);
    return walk_between(segment_cell(center - reach), segment_cell(center + reach), params.segment_bits);
}

/// The entries of the next run of segments: the first one and that after the last.
fn next_segments(walk: ptr<function, BallWalk>) -> vec2<u32> {
    let cells = next_cells(walk, params.segment_bits) + vec2(params.segment_cells_begin);
    return vec2(curve_word(cells.x), curve_word(cells.y));
}

/// The segment of an entry.
fn segment_at(entry: u32) -> u32 {
    return curve_word(params.segment_entries_begin + entry);
}
