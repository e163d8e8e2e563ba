// Numbers in rows. Expects rows_private.wgsl or rows_arena.wgsl.

fn number(row: u32, i: u32) -> f32 {
    return bitcast<f32>(word(row, i));
}

fn set_number(row: u32, i: u32, value: f32) {
    set_word(row, i, bitcast<u32>(value));
}

/// A vector in three rows that follow each other.
fn vector(row: u32, i: u32) -> vec3<f32> {
    return vec3(number(row, i), number(row + 1u, i), number(row + 2u, i));
}

fn set_vector(row: u32, i: u32, value: vec3<f32>) {
    set_number(row, i, value.x);
    set_number(row + 1u, i, value.y);
    set_number(row + 2u, i, value.z);
}
