// Software drivers end all loops of an invocation after 65 535 iterations in total, without a word. Kernels whose loops
// grow with the number of neighbours call this last, so that the host can report it.
//
// Expects `counters`.

/// `seed` is any value that no compiler knows: the loop must not be unrolled.
fn note_cut_loops(seed: u32) {
    var iterations = 0u;
    for (var i = seed; i != seed + 3u; i++) {
        iterations += 1u;
    }
    if iterations != 3u {
        atomicAdd(&counters.cut_loops, 1u);
    }
}
