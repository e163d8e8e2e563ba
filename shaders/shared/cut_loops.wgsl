// Software drivers end all loops of an invocation after 65 535 iterations in total, without a word. Kernels whose loops
// grow with the number of neighbours call this last, so that the host can report it.
//
// Expects `counters`.

/// The loop runs over values that no compiler knows, so that it isn't unrolled.
fn note_cut_loops(p: u32) {
    var iterations = 0u;
    for (var i = p; i != p + 3u; i++) {
        iterations += 1u;
    }
    if iterations != 3u {
        atomicMax(&counters.cut_loops, p + 1u);
    }
}
