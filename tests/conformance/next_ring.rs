//! The `next_ring` kernel on the reference's decisions, with private rows and with rows in the arena.

use crate::harness::{ARENA_WORDS, NEXT_RING, compare, constant, device, must, steps};
use crate::tolerance::RADIUS;

#[test]
fn covers_are_those_of_the_reference() {
    let mut device = device();
    let capacity = constant("next_ring", "CAPACITY");
    for step in steps().iter().filter(|step| step.refine.effective_next_ring()) {
        let (n, count) = (step.level.len(), step.state.candidates.len());
        let state = &step.state;
        let points = device.buffer("points", &step.points());
        let mut fans = step.fans(0);
        for (p, fan) in fans.iter_mut().enumerate() {
            // What the rows of the kernel surely hold.
            let is_short = fan.around[1] + fan.slots[1] < capacity;
            fan.left_over = if is_short && p.is_multiple_of(2) { 0 } else { NEXT_RING };
        }
        let fans = device.buffer("fans", &fans);
        let entries = device.buffer("entries", &step.ring_entries());
        let candidates = device.buffer("candidates", &step.decided());
        let around = device.buffer("around", &step.around());
        let insertion = &state.insertion;
        let mut radii = [insertion.radii.as_slice(), &insertion.candidate_radii].concat();
        radii.resize(2 * n + count, 0.0);
        let radii = device.guarded("radii", &radii);
        let arena = device.output::<u32>("arena", ARENA_WORDS);
        let counters = device.counters();
        let curves = device.buffer("curves", &step.curves());
        let inputs = [&points, &fans, &entries, &candidates, &around];
        let buffers = [&inputs[..], &[&radii, &arena, &counters, &curves]].concat();
        for kernel in ["next_ring", "next_ring_large"] {
            device.run(step.run(kernel, [0, n as u32, 0, 0], n), &buffers);
        }
        device.read_counters(&counters, &step.name);
        let found: Vec<f32> = device.read(&radii, 2 * n + count);
        let pairs = insertion.candidate_radii.iter().zip(&state.covers.candidate_radii);
        let mut expected: Vec<f32> = pairs.map(|(a, b)| a.max(*b)).collect();
        expected.extend(&state.covers.radii);
        assert!(state.covers.radii.iter().any(|&r| r > 0.0), "{}: nothing is covered", step.name);
        let scale = expected.iter().copied().fold(0.0, f32::max);
        let allowed = device.allows(RADIUS);
        must(compare(&step.name, &expected, &found[n..], allowed, scale));
    }
}
