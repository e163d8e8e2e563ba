// Records that cross stages, and the two uniforms that every kernel has.
// Mirrored by crates/engine/src/records.rs; tests/shaders.rs compares the offsets.

/// A point of the cloud: fit for a vertex buffer of 32-byte stride.
struct Point {
    position: vec3<f32>,
    radius: f32,
    normal: vec3<f32>,
    /// Low byte: the refinement step that inserted the point; 0 for input points. Above it one more than the point's
    /// record if it lies on a crease or boundary.
    level: u32,
}

/// What belongs to a point of the level.
struct Fan {
    /// The first of its ring entries and their number: its slots.
    slots: vec2<u32>,
    /// Within this distance new points are new neighbours: λ1 r, or less in the first step. For a selection among all
    /// candidates λ1 times the distance to the farthest neighbour; 0 if simplified.
    near: f32,
    /// A bit for each kernel that leaves it to its variant with rows in the arena.
    left_over: u32,
    /// The first of the candidates around it and their number; of the selection, those in N'.
    around: vec2<u32>,
    /// The number of its conflicts, which follow these, and how many of them come first since they
    /// choose their class before it.
    conflicts: vec2<u32>,
}

/// A possible new point.
struct Candidate {
    /// Position, and ρ: the largest distance to the three corners, or -1 where the triangle has no candidate.
    place: vec4<f32>,
    normal: vec3<f32>,
    /// The class that inserted it, from 1; or ON_CURVE, or FREE. Of a selection among all candidates also WAITING,
    /// and INSERTED for any class.
    state: u32,
    /// Corners of its triangle, smallest index first and orientation kept.
    corners: vec3<u32>,
    /// ρ, or λ1 times the distance from its corners to their farthest neighbours in the mean, whichever is larger. By
    /// the paper's loop, or if simplified, ρ.
    size: f32,
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
    /// Number of slots: entries of all rings.
    slots: u32,
    /// Number of candidates that are centres of triangles; then come new points on creases and boundaries.
    triangles: u32,
    /// Number of candidates.
    candidates: u32,
    /// The step, from 1.
    level: u32,
    /// Number of records of creases and boundaries on this level.
    records: u32,
    /// Capacities of the buffers whose need is known only afterwards, in entries.
    arena_words: u32,
    ring_entries: u32,
    around_entries: u32,
    mirror_links: u32,
    /// Half of the longest crease segment.
    longest_half: f32,
    /// Points of a larger cosine between their normals lie on one side of every crease.
    softest_crease: f32,
    /// The grid of the crease segments, as that above.
    segment_origin: vec3<f32>,
    segment_inverse_cell: f32,
    segment_bits: vec3<u32>,
    segment_cell: f32,
    /// Where the segments, their cells and the entries of these begin in the table of curves, in words.
    segments_begin: u32,
    segment_cells_begin: u32,
    segment_entries_begin: u32,
}

/// What changes from dispatch to dispatch.
struct Dispatch {
    /// Four words; each kernel says what they are.
    x: u32,
    y: u32,
    z: u32,
    w: u32,
    /// The invocations before this dispatch, where it does a part of them.
    first: u32,
}

/// Counters that the host reads between stages.
struct Counters {
    /// Blocks of the arena that were asked for since the counter was cleared.
    arena: atomic<u32>,
    /// Largest number of blocks that one dispatch asked for.
    arena_peak: atomic<u32>,
    /// Entries of rings that were asked for.
    slots: atomic<u32>,
    /// Entries of lists of candidates around points and of conflicts that were asked for.
    around: atomic<u32>,
    /// The same, high word.
    around_high: atomic<u32>,
    /// Links of mirrored conflicts, or of candidates to those that discard them, that were asked for.
    mirrored: atomic<u32>,
    /// The same, high word.
    mirrored_high: atomic<u32>,
    /// Number of classes.
    classes: atomic<u32>,
    /// Points without a ring.
    isolated: atomic<u32>,
    /// Sum of the sizes of all Euclidean neighbourhoods, low word.
    ball_low: atomic<u32>,
    /// The same, high word.
    ball_high: atomic<u32>,
    /// A bit for each kernel that left points to its variant with rows in the arena.
    left_over: atomic<u32>,
    /// The longest row of a point that is left to a variant with rows in the arena, in words.
    longest_row: atomic<u32>,
    /// One more than the last point for which the driver cut loops short; see cut_loops.wgsl.
    cut_loops: atomic<u32>,
    /// Bits of the largest ρ of a candidate.
    widest: atomic<u32>,
}

/// No entry: the largest index.
const NONE: u32 = 0xffffffffu;

/// Bits of a point's level.
const LEVEL_BITS: u32 = 8u;

// Bits of the kernels that leave points over.
const NEIGHBORHOOD: u32 = 1u;
const CONFLICTS: u32 = 2u;
const INSERTION: u32 = 4u;
const NEXT_RING: u32 = 8u;

// States of a candidate besides the class that inserted it.
const FREE: u32 = 0xffffffffu;
const ON_CURVE: u32 = 0u;
/// Inserted by the selection, which has no classes; and not decided yet.
const INSERTED: u32 = 1u;
const WAITING: u32 = 0xfffffffeu;

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<uniform> dispatch: Dispatch;

/// Index of an invocation in a dispatch of rows of workgroups of 64.
fn linear_index(id: vec3<u32>, groups: vec3<u32>) -> u32 {
    return dispatch.first + id.x + id.y * groups.x * 64u;
}
