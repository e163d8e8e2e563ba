// Creases and boundaries of a level: records, segments and a grid of these, as the host wrote them.
// Twin: crates/engine/src/curves.rs
//
// Expects `points` and `curve_word`: a word of the table, wherever the kernel has it.

/// Whether the cloud has creases or boundaries. Without them nothing of this is read.
override with_curves: bool = false;
/// Whether there are creases among them. Boundaries have one side and hide nothing.
override with_creases: bool = false;

// Words of the table: of records, then of segments; after these come the first entry of each cell and
// one more, and the entries.
const RECORD_WORDS: u32 = 24u;
const SEGMENT_WORDS: u32 = 4u;

fn curve_vector(at: u32) -> vec3<f32> {
    return vec3(bitcast<f32>(curve_word(at)), bitcast<f32>(curve_word(at + 1u)), bitcast<f32>(curve_word(at + 2u)));
}

/// First word of a record. The records of new points on curves come after those of the level.
fn record_at(record: u32) -> u32 {
    return RECORD_WORDS * record;
}

fn record_position(record: u32) -> vec3<f32> {
    return curve_vector(record_at(record));
}

fn record_normal(record: u32) -> vec3<f32> {
    return curve_vector(record_at(record) + 4u);
}

/// Unit vector in the tangent plane that points into the record's sheet.
fn record_conormal(record: u32) -> vec3<f32> {
    return curve_vector(record_at(record) + 8u);
}

/// The point of a record, of those of the level.
fn record_point(record: u32) -> u32 {
    return curve_word(record_at(record) + 3u);
}

/// The records next to it on the curves that bound its sheet, or NONE.
fn record_partners(record: u32) -> vec2<u32> {
    return vec2(curve_word(record_at(record) + 7u), curve_word(record_at(record) + 11u));
}

/// First record of the point of a record.
fn record_first(record: u32) -> u32 {
    return curve_word(record_at(record) + 12u);
}

/// Number of records of the point: 1 on a boundary.
fn record_sides(record: u32) -> u32 {
    return curve_word(record_at(record) + 13u);
}

/// The segment on which this step puts it, or NONE.
fn record_segment(record: u32) -> u32 {
    return curve_word(record_at(record) + 14u);
}

/// The smallest radius of a new point on a curve.
fn record_radius(record: u32) -> f32 {
    return bitcast<f32>(curve_word(record_at(record) + 15u));
}

/// The points at the ends of the segment on which a new point lies, the nearer first.
fn record_ends(record: u32) -> vec2<u32> {
    return vec2(curve_word(record_at(record) + 18u), curve_word(record_at(record) + 19u));
}

/// ρ of a new point on a curve.
fn record_rho(record: u32) -> f32 {
    return bitcast<f32>(curve_word(record_at(record) + 20u));
}

/// Angles in its frame between which its fan lies.
fn record_wedge(record: u32) -> vec2<f32> {
    let at = record_at(record) + 16u;
    return vec2(bitcast<f32>(curve_word(at)), bitcast<f32>(curve_word(at + 1u)));
}

/// The first vector points away from the sheet, so that the angles of a fan never wrap around.
fn record_frame(record: u32) -> TangentFrame {
    let e1 = -record_conormal(record);
    return TangentFrame(e1, cross3(record_normal(record), e1));
}

/// The record of a point of the level, or NONE.
fn record_of(p: u32) -> u32 {
    return (points[p].level >> LEVEL_BITS) - 1u;
}

/// The record of a candidate, or NONE.
fn record_of_candidate(c: u32) -> u32 {
    return select(NONE, params.records + (c - params.triangles), c >= params.triangles);
}

/// Whether a point lies on a crease or boundary, where its sheet ends.
fn is_on_curve(p: u32) -> bool {
    return with_curves && record_of(p) != NONE;
}

/// Two unit vectors that span the tangent plane of a point.
fn frame_of(p: u32) -> TangentFrame {
    if is_on_curve(p) {
        return record_frame(record_of(p));
    }
    return tangent_frame(points[p].normal);
}
