// Ball queries on the wrapping grid. Twin: crates/points/src/grid.rs
//
// Expects `grid`: the first entry of each cell and one more.

/// Widens a query a little, so that rounding at a cell's face can't lose an entry.
const SLACK: f32 = 1.0001;

/// A walk over the cells that a ball touches: rows along x, each one run of entries, or two
/// where the period ends inside.
struct BallWalk {
    low: vec3<i32>,
    high: vec3<i32>,
    /// Row of the next run.
    y: i32,
    z: i32,
    wraps: bool,
    second: bool,
}

fn ball_walk(center: vec3<f32>, radius: f32) -> BallWalk {
    let reach = vec3(radius * SLACK + params.cell * 1e-4);
    return walk_between(cell_coordinates(center - reach), cell_coordinates(center + reach), params.bits);
}

fn walk_between(low: vec3<i32>, top: vec3<i32>, bits: vec3<u32>) -> BallWalk {
    // A query wider than the period would meet its own cells again.
    let last = vec3<i32>((vec3(1u) << bits) - vec3(1u));
    let high = min(top, low + last);
    let wraps = (low.x >> bits.x) != (high.x >> bits.x);
    return BallWalk(low, high, low.y, low.z, wraps, false);
}

/// Whether all runs were walked.
fn is_over(walk: BallWalk) -> bool {
    return walk.z > walk.high.z;
}

/// The cells of the next run: the first one and that after the last. Counting costs less than dividing.
fn next_cells(walk: ptr<function, BallWalk>, bits: vec3<u32>) -> vec2<u32> {
    let begin = wrapped_index(vec3((*walk).low.x, (*walk).y, (*walk).z), bits);
    let end = wrapped_index(vec3((*walk).high.x, (*walk).y, (*walk).z), bits);
    let row_mask = (1u << bits.x) - 1u;
    let first = select(begin, end & ~row_mask, (*walk).second);
    let after = select(end + 1u, (begin | row_mask) + 1u, (*walk).wraps & !(*walk).second);
    let row_is_over = !(*walk).wraps | (*walk).second;
    let layer_is_over = row_is_over & (*walk).y == (*walk).high.y;
    (*walk).second = !row_is_over;
    (*walk).y = select((*walk).y + i32(row_is_over), (*walk).low.y, layer_is_over);
    (*walk).z += i32(layer_is_over);
    return vec2(first, after);
}

/// The entries of the next run: the first one and that after the last.
fn next_entries(walk: ptr<function, BallWalk>) -> vec2<u32> {
    let cells = next_cells(walk, params.bits);
    return vec2(grid[cells.x], grid[cells.y]);
}
