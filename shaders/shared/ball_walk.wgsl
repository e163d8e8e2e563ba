// Ball queries on the wrapping grid. Twin: crates/points/src/grid.rs
//
// Expects `grid`: the first entry of each cell and one more, then the entries by cell.

/// Widens a query a little, so that rounding at a cell's face can't lose an entry.
const SLACK: f32 = 1.0001;

/// A walk over the entries of all cells that a ball touches.
struct BallWalk {
    low: vec3<i32>,
    last_x: i32,
    /// Rows of cells along x are walked as two runs each: the second one is used where the period ends inside.
    rows_y: u32,
    run: u32,
    runs: u32,
    item: u32,
    end: u32,
}

fn ball_walk(center: vec3<f32>, radius: f32) -> BallWalk {
    let reach = vec3(radius * SLACK + params.cell * 1e-4);
    return walk_between(cell_coordinates(center - reach), cell_coordinates(center + reach), params.bits);
}

fn walk_between(low: vec3<i32>, top: vec3<i32>, bits: vec3<u32>) -> BallWalk {
    // A query wider than the period would meet its own cells again.
    let last = vec3<i32>((vec3(1u) << bits) - vec3(1u));
    let high = min(top, low + last);
    let rows_y = u32(high.y - low.y + 1);
    return BallWalk(low, high.x, rows_y, 0u, 2u * rows_y * u32(high.z - low.z + 1), 0u, 0u);
}

/// The next entry of a walk, or NONE.
fn next_entry(walk: ptr<function, BallWalk>) -> u32 {
    while (*walk).item == (*walk).end {
        if (*walk).run == (*walk).runs {
            return NONE;
        }
        let cells = next_run(walk, params.bits);
        (*walk).item = grid[cells.x];
        (*walk).end = grid[cells.y];
    }
    let entry = grid[cell_count() + 1u + (*walk).item];
    (*walk).item += 1u;
    return entry;
}

/// The cells of the next run: the first one and that after the last.
fn next_run(walk: ptr<function, BallWalk>, bits: vec3<u32>) -> vec2<u32> {
    let row = (*walk).run >> 1u;
    let second = ((*walk).run & 1u) == 1u;
    (*walk).run += 1u;
    let y = (*walk).low.y + i32(row % (*walk).rows_y);
    let z = (*walk).low.z + i32(row / (*walk).rows_y);
    let begin = wrapped_index(vec3((*walk).low.x, y, z), bits);
    let end = wrapped_index(vec3((*walk).last_x, y, z), bits);
    let row_mask = (1u << bits.x) - 1u;
    var first = begin;
    var after = end + 1u;
    if begin <= end && second {
        after = begin;
    } else if begin > end && !second {
        after = (begin | row_mask) + 1u;
    } else if begin > end {
        first = end & ~row_mask;
    }
    return vec2(first, after);
}
