// Ball queries on the wrapping grid. Twin: crates/points/src/grid.rs
//
// Expects `grid`: the first entry of each cell and one more.

/// Widens a query a little, so that rounding at a cell's face can't lose an entry.
const SLACK: f32 = 1.0001;

/// The cells that a ball touches: rows along x, each one run of entries, or two where the period ends inside.
struct Span {
    low: vec3<i32>,
    last_x: i32,
    rows_y: u32,
    wraps: bool,
    /// Number of runs.
    runs: u32,
}

fn ball_span(center: vec3<f32>, radius: f32) -> Span {
    let reach = vec3(radius * SLACK + params.cell * 1e-4);
    return span_between(cell_coordinates(center - reach), cell_coordinates(center + reach), params.bits);
}

fn span_between(low: vec3<i32>, top: vec3<i32>, bits: vec3<u32>) -> Span {
    // A query wider than the period would meet its own cells again.
    let last = vec3<i32>((vec3(1u) << bits) - vec3(1u));
    let high = min(top, low + last);
    let rows_y = u32(high.y - low.y + 1);
    let rows = rows_y * u32(high.z - low.z + 1);
    let wraps = (low.x >> bits.x) != (high.x >> bits.x);
    return Span(low, high.x, rows_y, wraps, select(rows, 2u * rows, wraps));
}

/// The cells of a run: the first one and that after the last.
fn cells_of_run(span: Span, run: u32, bits: vec3<u32>) -> vec2<u32> {
    let row = select(run, run >> 1u, span.wraps);
    let y = span.low.y + i32(row % span.rows_y);
    let z = span.low.z + i32(row / span.rows_y);
    let begin = wrapped_index(vec3(span.low.x, y, z), bits);
    let end = wrapped_index(vec3(span.last_x, y, z), bits);
    if !span.wraps {
        return vec2(begin, end + 1u);
    }
    let row_mask = (1u << bits.x) - 1u;
    return select(vec2(begin, (begin | row_mask) + 1u), vec2(end & ~row_mask, end + 1u), (run & 1u) == 1u);
}

/// The entries of a run: the first one and that after the last.
fn entries_of_run(span: Span, run: u32) -> vec2<u32> {
    let cells = cells_of_run(span, run, params.bits);
    return vec2(grid[cells.x], grid[cells.y]);
}
