// The order in which points choose their classes. Twin: `scramble` in crates/reference/src/coloring.rs

/// Ranges of priorities, one after the other: few points of one range are in conflict.
const RANGES: u32 = 32u;

/// The priority of a point: a bijection of the 32-bit integers without visible order (lowbias32, C. Wellons).
fn scramble(id: u32) -> u32 {
    var x = id;
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

/// The range of a point: those of the highest priorities come first.
fn range_of(p: u32) -> u32 {
    return RANGES - 1u - scramble(p) / (0xffffffffu / RANGES + 1u);
}
