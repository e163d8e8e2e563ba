// Scratch memory of one invocation: ROWS rows of words in the arena, as long as need be. Twin: rows_private.wgsl
//
// Expects `arena`, `counters` and `count_members`: how long the rows of a point must be. If the arena is too small, the
// counters tell the host what to provide.

/// First word and length of the rows.
var<private> rows: vec2<u32>;

const IN_ARENA: bool = true;

/// Words of a block. A point takes whole blocks: the words of all points of a dispatch may be more than 32 bits can
/// count.
const ARENA_BLOCK: u32 = 32u;

fn open_rows(p: u32) -> bool {
    let words = count_members(p);
    let blocks = (ROWS * words + ARENA_BLOCK - 1u) / ARENA_BLOCK;
    let first = atomicAdd(&counters.arena, blocks);
    rows = vec2(first * ARENA_BLOCK, words);
    atomicMax(&counters.arena_peak, first + blocks);
    atomicMax(&counters.longest_row, words);
    return first + blocks <= params.arena_words / ARENA_BLOCK;
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
