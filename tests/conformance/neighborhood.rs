//! The kernel of the neighbourhood, with private rows and with rows in the arena, on the reference's level and grid.

use crate::harness::{
    ARENA_WORDS, Device, NEIGHBORHOOD, Step, compare, compare_equal, device, grid_words, must,
    steps,
};
use crate::tolerance::ANGLE;
use surfine::testing::records::{ARENA_BLOCK, Counters, Fan};
use surfine_reference::neighborhood::RingEntry;

/// The fans and ring entries that a kernel leaves, and the counters. All points were left over before.
fn run(device: &mut Device, step: &Step, kernel: &str) -> (Vec<Fan>, Vec<[u32; 2]>, Counters) {
    let n = step.level.len();
    let points = device.buffer("points", &step.points());
    let (starts, places) = grid_words(&step.state.grid);
    let (grid, places) = (device.buffer("grid", &starts), device.buffer("places", &places));
    let left_over = Fan { left_over: NEIGHBORHOOD, ..Fan::default() };
    let fans = device.guarded("fans", &vec![left_over; n]);
    let total = step.state.rings.len();
    let entries = device.output::<[u32; 2]>("entries", total);
    let arena = device.output::<u32>("arena", ARENA_WORDS);
    let counters = device.counters();
    let curves = device.buffer("curves", &step.curves());
    let buffers = [&points, &grid, &places, &fans, &entries, &arena, &counters, &curves];
    device.run(step.run(kernel, [0, n as u32, 0, 0], n), &buffers);
    let counters = device.read_counters(&counters, &step.name);
    (device.read(&fans, n), device.read(&entries, total), counters)
}

/// The ring of a fan as the reference has it.
fn ring(fan: &Fan, entries: &[[u32; 2]]) -> Vec<RingEntry> {
    let [first, size] = fan.slots.map(|v| v as usize);
    let entry = |e: &[u32; 2]| RingEntry { id: e[0], angle: f32::from_bits(e[1]) };
    entries[first..first + size].iter().map(entry).collect()
}

#[test]
fn rings_are_those_of_the_reference() {
    let mut device = device();
    let mut some_are_left_over = false;
    for step in steps() {
        for kernel in ["neighborhood", "neighborhood_large"] {
            let (fans, entries, counters) = run(&mut device, step, kernel);
            let what = format!("{} {kernel}", step.name);
            let left_over = |fan: &Fan| fan.left_over == NEIGHBORHOOD;
            assert_eq!(counters.left_over != 0, fans.iter().any(left_over), "{what}");
            some_are_left_over |= counters.left_over != 0;
            for (p, fan) in fans.iter().enumerate().filter(|(_, fan)| !left_over(fan)) {
                let (expected, found) = (step.state.rings.ring(p), ring(fan, &entries));
                let ids = |ring: &[RingEntry]| ring.iter().map(|e| e.id).collect::<Vec<_>>();
                let angles = |ring: &[RingEntry]| ring.iter().map(|e| e.angle).collect::<Vec<_>>();
                must(compare_equal(&format!("{what}: ring of {p}"), &ids(expected), &ids(&found)));
                let (tolerance, turn) = (device.allows(ANGLE), std::f32::consts::TAU);
                let what = format!("{what}: angles of {p}");
                must(compare(&what, &angles(expected), &angles(&found), tolerance, turn));
            }
            if counters.left_over == 0 {
                assert_eq!(counters.slots as usize, step.state.rings.len(), "{what}");
                let ball = u64::from(counters.ball_high) << 32 | u64::from(counters.ball_low);
                assert_eq!(ball, step.state.rings.ball_neighbors, "{what}");
            } else {
                assert_eq!(kernel, "neighborhood", "the arena holds all");
            }
        }
    }
    assert!(some_are_left_over, "no cloud has balls that are too large for private rows");
}

#[test]
fn buffers_that_are_too_small_are_told_and_not_overrun() {
    let mut device = device();
    let step = &steps()[0];
    let n = step.level.len();
    let points = device.buffer("points", &step.points());
    let (starts, places) = grid_words(&step.state.grid);
    let (grid, places) = (device.buffer("grid", &starts), device.buffer("places", &places));
    let left_over = Fan { left_over: NEIGHBORHOOD, ..Fan::default() };
    let curves = device.buffer("curves", &step.curves());
    for kernel in ["neighborhood", "neighborhood_large"] {
        let fans = device.guarded("fans", &vec![left_over; n]);
        let entries = device.output::<[u32; 2]>("entries", 10);
        let (arena, counters) = (device.output::<u32>("arena", 100), device.counters());
        let mut run = step.run(kernel, [0, n as u32, 0, 0], n);
        (run.params.arena_words, run.params.ring_entries) = (100, 10);
        let buffers = [&points, &grid, &places, &fans, &entries, &arena, &counters, &curves];
        device.run(run, &buffers);
        let counters: Vec<Counters> = device.read(&counters, 1);
        if kernel == "neighborhood" {
            assert_eq!(counters[0].slots as usize, step.state.rings.len());
        } else {
            let words = ARENA_BLOCK * counters[0].arena_peak;
            assert!(u64::from(words) > 7 * step.state.rings.ball_neighbors);
        }
        // Reading checks the guard words.
        let _: (Vec<u32>, Vec<[u32; 2]>) = (device.read(&arena, 100), device.read(&entries, 10));
    }
}
