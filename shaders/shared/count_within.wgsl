// How many entries of the grid are in a ball. Expects ball_walk.wgsl and `places`: positions
// and numbers of the entries.

/// Counts the entries within the radius.
fn count_within(center: vec3<f32>, radius: f32) -> u32 {
    var size = 0u;
    var walk = ball_walk(center, radius);
    while !is_over(walk) {
        let entries = next_entries(&walk);
        for (var i = entries.x; i < entries.y; i++) {
            let d = bitcast<vec3<f32>>(places[i].xyz) - center;
            size += u32(dot3(d, d) <= radius * radius);
        }
    }
    return size;
}
