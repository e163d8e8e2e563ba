//! The `next_ring` kernel on the reference's decisions.

use crate::harness::{ARENA_WORDS, compare, device, grid_words, must, steps};
use crate::tolerance::RADIUS;
use surfine::records::Counters;

#[test]
fn covers_are_those_of_the_reference() {
    let mut device = device();
    for step in steps().into_iter().filter(|step| step.refine.rules.next_ring) {
        let (n, slots) = (step.level.len(), step.state.rings.len());
        let state = &step.state;
        let points = device.buffer("points", &step.points());
        let starts = device.buffer("starts", &state.rings.starts);
        let entries = device.buffer("entries", &step.ring_entries());
        let positions = device.buffer("positions", &step.candidate_positions());
        let normals = device.buffer("normals", &step.candidate_normals());
        let grid = device.buffer("grid", &grid_words(&state.candidate_grid));
        // A state from 1 on is one more than the class that inserted the slot.
        let of_slot = |s: usize| match (state.insertion.inserted[s], state.candidates.exists(s)) {
            (true, _) => 1 + s as u32 % 7,
            (false, true) => {
                if s.is_multiple_of(2) {
                    0
                } else {
                    u32::MAX - 1
                }
            }
            (false, false) => u32::MAX,
        };
        let states = device.buffer("states", &(0..slots).map(of_slot).collect::<Vec<u32>>());
        let mut radii = [state.insertion.radii.as_slice(), &state.insertion.slot_radii].concat();
        radii.resize(2 * (n + slots), 0.0);
        let guarded = [bytemuck::cast_slice(&radii), &[0xa5u8; 64][..]].concat();
        let radii = device.buffer("radii", &guarded);
        let arena = device.output::<u32>("arena", ARENA_WORDS);
        let counters = device.output::<u32>("counters", size_of::<Counters>() / 4);
        let rings = [&points, &starts, &entries];
        let candidates = [&positions, &normals, &grid, &states];
        let outputs = [&radii, &arena, &counters];
        let buffers = [&rings[..], &candidates, &outputs].concat();
        device.run(step.run("next_ring", [0, n as u32, 0, 0], n), &buffers);

        let counters = device.read::<Counters>(&counters, 1)[0];
        assert_eq!(counters.cut_loops, 0, "{}", step.name);
        assert!(counters.arena_peak as usize <= ARENA_WORDS, "{}: too small an arena", step.name);
        let found: Vec<f32> = device.read(&radii, 2 * (n + slots));
        let expected = [state.covers.radii.as_slice(), &state.covers.slot_radii].concat();
        assert!(expected.iter().any(|&r| r > 0.0), "{}: nothing is covered", step.name);
        let scale = expected.iter().copied().fold(0.0, f32::max);
        let allowed = device.allows(RADIUS);
        must(compare(&step.name, &expected, &found[n + slots..], allowed, scale));
    }
}
