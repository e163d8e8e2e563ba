// Cells of a uniform grid that wraps around. Twin: crates/points/src/grid.rs

fn cell_coordinates(x: vec3<f32>) -> vec3<i32> {
    return vec3<i32>(floor((x - params.origin) * params.inverse_cell));
}

/// Index of a cell: its coordinates wrapped, x running fastest.
fn cell_index(c: vec3<i32>) -> u32 {
    return wrapped_index(c, params.bits);
}

fn wrapped_index(c: vec3<i32>, bits: vec3<u32>) -> u32 {
    let wrapped = vec3<u32>(c) & ((vec3(1u) << bits) - vec3(1u));
    return wrapped.x | (wrapped.y << bits.x) | (wrapped.z << (bits.x + bits.y));
}
