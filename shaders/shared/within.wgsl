// The entries of the grid in a ball. Expects ball_walk.wgsl, `places`: positions and numbers of
// the entries, and the row ID.

/// Lists the entries within the radius whose squared distance is above `beyond`, and returns how many they are, of
/// which no more are listed than fit.
fn list_within(center: vec3<f32>, radius: f32, beyond: f32) -> u32 {
    var size = 0u;
    var walk = ball_walk(center, radius);
    while !is_over(walk) {
        let entries = next_entries(&walk);
        for (var i = entries.x; i < entries.y; i++) {
            let entry = places[i];
            let d = bitcast<vec3<f32>>(entry.xyz) - center;
            let d2 = dot3(d, d);
            // Written in any case: branches that neighbouring points take differently cost more.
            set_word(ID, size, entry.w);
            size += u32(d2 <= radius * radius & d2 > beyond);
        }
    }
    return size;
}
