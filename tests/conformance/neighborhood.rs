//! The five kernels of the neighbourhood, one after the other on the reference's level and grid.

use crate::harness::{
    ARENA_WORDS, Device, Step, compare, compare_equal, device, grid_words, must, steps,
};
use crate::tolerance::ANGLE;
use surfine::records::Counters;
use surfine_reference::neighborhood::RingEntry;

/// The rings that the kernels find, and the size of all Euclidean neighbourhoods.
fn rings(device: &mut Device, step: &Step) -> (Vec<u32>, Vec<[u32; 2]>, u64) {
    let n = step.level.len();
    let points = device.buffer("points", &step.points());
    let grid = device.buffer("grid", &grid_words(&step.state.grid));
    let arena = device.output::<u32>("arena", ARENA_WORDS);
    let blocks = device.output::<[u32; 2]>("blocks", n);
    let counters = device.output::<u32>("counters", size_of::<Counters>() / 4);
    let starts = device.output::<u32>("starts", n + 1);
    let all = [0, n as u32, 0, 0];
    let curves = device.buffer("curves", &step.curves());
    let ball = [&points, &grid, &arena, &blocks, &counters, &curves];
    device.run(step.run("neighborhood_ball", all, n), &ball);
    let badness = [&points, &blocks, &arena, &counters];
    device.run(step.run("neighborhood_badness", all, ARENA_WORDS / 4), &badness);
    if step.refine.rules.natural_neighbors {
        let natural = [&blocks, &arena, &counters];
        device.run(step.run("neighborhood_natural", all, ARENA_WORDS / 4), &natural);
    }
    device.run(step.run("neighborhood_ring", all, n), &[&blocks, &arena, &starts, &counters]);
    let mut summed: Vec<u32> = device.read(&starts, n + 1);
    for i in 1..=n {
        summed[i] += summed[i - 1];
    }
    let total = summed[n] as usize;
    let entries = device.output::<[u32; 2]>("entries", total);
    let starts = device.buffer("starts", &summed);
    // Entries that the reference does not have would be left out: give the kernel room for all of them.
    let mut store = step.run("neighborhood_store", all, n);
    store.params.ring_entries = total as u32;
    device.run(store, &[&arena, &blocks, &starts, &entries]);
    let counters: Vec<Counters> = device.read(&counters, 1);
    assert_eq!(counters[0].cut_loops, 0, "{}", step.name);
    let ball = u64::from(counters[0].ball_high) << 32 | u64::from(counters[0].ball_low);
    (summed, device.read(&entries, total), ball)
}

#[test]
fn rings_are_those_of_the_reference() {
    let mut device = device();
    for step in steps() {
        let (starts, entries, ball) = rings(&mut device, step);
        let expected = &step.state.rings;
        let ids = |e: &[RingEntry]| e.iter().map(|e| e.id).collect::<Vec<_>>();
        let angles: Vec<f32> = expected.entries.iter().map(|e| e.angle).collect();
        let found: Vec<f32> = entries.iter().map(|e| f32::from_bits(e[1])).collect();
        let what = |column| format!("{}: {column}", step.name);
        must(compare_equal(&what("ring starts"), &expected.starts, &starts));
        let found_ids: Vec<u32> = entries.iter().map(|e| e[0]).collect();
        must(compare_equal(&what("ring ids"), &ids(&expected.entries), &found_ids));
        let tolerance = device.allows(ANGLE);
        must(compare(&what("ring angles"), &angles, &found, tolerance, std::f32::consts::TAU));
        assert_eq!(ball, expected.ball_neighbors, "{}", step.name);
    }
}

#[test]
fn an_arena_that_is_too_small_is_told_and_not_overrun() {
    let mut device = device();
    let step = &steps()[0];
    let n = step.level.len();
    let points = device.buffer("points", &step.points());
    let grid = device.buffer("grid", &grid_words(&step.state.grid));
    let (arena, blocks) =
        (device.output::<u32>("arena", 100), device.output::<[u32; 2]>("blocks", n));
    let counters = device.output::<u32>("counters", size_of::<Counters>() / 4);
    let curves = device.buffer("curves", &step.curves());
    let mut run = step.run("neighborhood_ball", [0, n as u32, 0, 0], n);
    run.params.arena_words = 100;
    device.run(run, &[&points, &grid, &arena, &blocks, &counters, &curves]);
    let counters: Vec<Counters> = device.read(&counters, 1);
    assert_eq!(u64::from(counters[0].arena_peak), 4 * step.state.rings.ball_neighbors);
    // Reading checks the guard words.
    let _: Vec<u32> = device.read(&arena, 100);
}
