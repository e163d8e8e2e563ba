// Scratch memory of one invocation: ROWS rows of CAPACITY words, short enough to be its own. Twin: rows_arena.wgsl
//
// Points that need longer rows are left over, and the same kernel with rows in the arena does them afterwards.

var<private> row_words: array<u32, ROWS * CAPACITY>;

/// Whether this is the variant for points that were left over.
const IN_ARENA: bool = false;

/// Makes the rows of a point; false if there is no room.
fn open_rows(p: u32) -> bool {
    return true;
}

/// Whether rows of that many words fit.
fn fits(words: u32) -> bool {
    return words <= CAPACITY;
}

fn word(row: u32, i: u32) -> u32 {
    return row_words[row * CAPACITY + i];
}

/// Words behind the end of a row are lost.
fn set_word(row: u32, i: u32, value: u32) {
    row_words[row * CAPACITY + min(i, CAPACITY - 1u)] = value;
}
