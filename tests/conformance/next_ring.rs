//! The `next_ring` kernel on the reference's decisions.

use crate::harness::{ARENA_WORDS, FREE, USED, compare, device, must, steps};
use crate::tolerance::RADIUS;
use surfine::records::Counters;

#[test]
fn covers_are_those_of_the_reference() {
    let mut device = device();
    for step in steps().iter().filter(|step| step.refine.rules.next_ring) {
        let (n, slots) = (step.level.len(), step.state.candidates.len());
        let state = &step.state;
        let points = device.buffer("points", &step.points());
        let starts = device.buffer("starts", &state.rings.starts);
        let entries = device.buffer("entries", &step.ring_entries());
        let positions = device.buffer("positions", &step.candidate_positions());
        let normals = device.buffer("normals", &step.candidate_normals());
        let grid = device.buffer("grid", &step.candidate_grid_words());
        // Slots that nobody inserted are free or were tried: both must be seen as not there.
        let mut states = step.initial_states();
        for (slot, own) in states.iter_mut().enumerate() {
            match (*own, state.insertion.inserted[slot]) {
                (FREE, true) => *own = 2 + slot as u32 % 7,
                (FREE, false) if !slot.is_multiple_of(2) => *own = USED,
                _ => {}
            }
        }
        let states = device.buffer("states", &states);
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
