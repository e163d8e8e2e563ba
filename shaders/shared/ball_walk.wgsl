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
    let low = cell_coordinates(center - reach);
    // A query wider than the period would meet its own cells again.
    let last = vec3<i32>((vec3(1u) << params.bits) - vec3(1u));
    let high = min(cell_coordinates(center + reach), low + last);
    let rows_y = u32(high.y - low.y + 1);
    return BallWalk(low, high.x, rows_y, 0u, 2u * rows_y * u32(high.z - low.z + 1), 0u, 0u);
}

/// The next entry of a walk, or NONE.
fn next_entry(walk: ptr<function, BallWalk>) -> u32 {
    while (*walk).item == (*walk).end {
        if (*walk).run == (*walk).runs {
            return NONE;
        }
        open_run(walk);
    }
    let entry = grid[cell_count() + 1u + (*walk).item];
    (*walk).item += 1u;
    return entry;
}

fn open_run(walk: ptr<function, BallWalk>) {
    let row = (*walk).run >> 1u;
    let second = ((*walk).run & 1u) == 1u;
    (*walk).run += 1u;
    let y = (*walk).low.y + i32(row % (*walk).rows_y);
    let z = (*walk).low.z + i32(row / (*walk).rows_y);
    let begin = cell_index(vec3((*walk).low.x, y, z));
    let end = cell_index(vec3((*walk).last_x, y, z));
    let row_mask = (1u << params.bits.x) - 1u;
    var first = begin;
    var after = end + 1u;
    if begin <= end && second {
        after = begin;
    } else if begin > end && !second {
        after = (begin | row_mask) + 1u;
    } else if begin > end {
        first = end & ~row_mask;
    }
    (*walk).item = grid[first];
    (*walk).end = grid[after];
}
