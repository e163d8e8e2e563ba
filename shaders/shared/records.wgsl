// Records that cross stages, and the two uniforms that every kernel has.
// Mirrored by crates/engine/src/records.rs; tests/shaders.rs compares the offsets.

/// A point of the cloud: fit for a vertex buffer of 32-byte stride.
struct Point {
    position: vec3<f32>,
    radius: f32,
    normal: vec3<f32>,
    /// Low byte: the refinement step that inserted the point; 0 for input points. Above it one more than the point's record
    /// if it lies on a crease or boundary.
    level: u32,
}

/// What stays the same for all dispatches of one step.
struct Params {
    /// Corner of grid cell (0, 0, 0).
    origin: vec3<f32>,
    inverse_cell: f32,
    /// log2 of the grid's period along x, y and z.
    bits: vec3<u32>,
    cell: f32,
    sin_theta_f: f32,
    theta_c: f32,
    lambda1: f32,
    lambda2: f32,
    /// Number of points of this level.
    points: u32,
    /// Number of slots: entries of all rings, then new points on creases and boundaries.
    slots: u32,
    /// The step, from 1.
    level: u32,
    /// Capacities in entries of the buffers whose need is known only afterwards.
    arena_words: u32,
    ring_entries: u32,
    conflict_entries: u32,
    /// Number of slots that are entries of rings.
    fan_slots: u32,
    /// Number of records of creases and boundaries on this level.
    records: u32,
}

/// Counters that the host reads between stages.
struct Counters {
    /// Words of the arena that were asked for since the counter was cleared.
    arena: atomic<u32>,
    /// Largest number of words that one dispatch asked for.
    arena_peak: atomic<u32>,
    /// Entries of conflict lists that were asked for.
    conflicts: atomic<u32>,
    /// Links of mirrored conflicts that were asked for.
    mirrored: atomic<u32>,
    /// Points without a class after the last round.
    uncolored: atomic<u32>,
    /// Number of classes.
    classes: atomic<u32>,
    /// Points without a ring.
    isolated: atomic<u32>,
    /// Sum of the sizes of all Euclidean neighbourhoods, low word.
    ball_low: atomic<u32>,
    /// The same, high word.
    ball_high: atomic<u32>,
    /// One more than the last point for which the driver cut loops short; see cut_loops.wgsl.
    cut_loops: atomic<u32>,
}

/// No entry: the largest index.
const NONE: u32 = 0xffffffffu;

/// Bits of a point's level.
const LEVEL_BITS: u32 = 8u;

// Last words of arena entries of the neighbourhood: the point whose member it is, with a bit that says that fuzzy planes
// removed it; or what says that it came back.
const REMOVED: u32 = 0x80000000u;
/// Of members that are removed from the start, since they may lie on another sheet.
const DOUBTFUL: u32 = 0x40000000u;
const BACK: u32 = 0xfffffffeu;

// States of a candidate slot; from 1 on, one more than the class that inserted it. Classes count from 1 here: new points
// on creases and boundaries are in class 0.
const FREE: u32 = 0u;
const ON_CURVE: u32 = 1u;
const USED: u32 = 0xfffffffeu;

@group(0) @binding(0) var<uniform> params: Params;
/// What changes from dispatch to dispatch; each kernel says what the four words are.
@group(0) @binding(1) var<uniform> dispatch: vec4<u32>;

/// Index of an invocation in a dispatch of rows of workgroups of 64.
fn linear_index(id: vec3<u32>, groups: vec3<u32>) -> u32 {
    return id.x + id.y * groups.x * 64u;
}
