// Scratch memory of one invocation: ROWS rows of words in the arena, as long as need be. Twin: rows_private.wgsl
//
// Expects `arena`, `counters` and `count_members`: how long the rows of a point must be. If the arena is too small, the counters tell the host what to provide.

/// First word and length of the rows.
var<private> rows: vec2<u32>;

const IN_ARENA: bool = true;

fn open_rows(p: u32) -> bool {
    let words = count_members(p);
    let first = atomicAdd(&counters.arena, ROWS * words);
    rows = vec2(first, words);
    atomicMax(&counters.arena_peak, first + ROWS * words);
    atomicMax(&counters.longest_row, words);
    return first + ROWS * words <= params.arena_words;
}

fn fits(words: u32) -> bool {
    return true;
}

fn word(row: u32, i: u32) -> u32 {
    return arena[rows.x + row * rows.y + i];
}

fn set_word(row: u32, i: u32, value: u32) {
    arena[rows.x + row * rows.y + i] = value;
}
