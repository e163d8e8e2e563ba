// The corners of a fan's triangle. Twin: `canonical` in crates/reference/src/fan_triangle.rs

/// Smallest index first, orientation kept.
fn canonical(p: u32, a: u32, b: u32) -> vec3<u32> {
    if p < a && p < b {
        return vec3(p, a, b);
    }
    if a < b {
        return vec3(a, b, p);
    }
    return vec3(b, p, a);
}
