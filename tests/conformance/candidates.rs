//! The kernels of the candidates, one after the other on the reference's rings.

use crate::harness::{compare, compare_equal, device, must, steps};
use crate::tolerance::{NORMAL, POSITION, RADIUS};
use surfine::testing::records::{Candidate, Fan};

#[test]
fn candidates_are_those_of_the_reference() {
    let mut device = device();
    for step in steps() {
        let (n, slots) = (step.level.len(), step.state.rings.len());
        let expected = &step.state.candidates;
        let what = |column| format!("{}: candidate {column}", step.name);
        let points = device.buffer("points", &step.points());
        let without_near = |fan: Fan| Fan { near: 0.0, ..fan };
        let fans: Vec<Fan> = step.fans(0).into_iter().map(without_near).collect();
        let fans = device.guarded("fans", &fans);
        let entries = device.buffer("entries", &step.ring_entries());
        let curves = device.buffer("curves", &step.curves());
        let of_slot = device.output::<u32>("of slot", slots);
        let counts = device.output::<u32>("counts", n + 1);
        let buffers = [&points, &fans, &entries, &of_slot, &counts, &curves];
        device.run(step.run("candidates_home", [0; 4], n), &buffers);
        let near: Vec<f32> = device.read::<Fan>(&fans, n).iter().map(|fan| fan.near).collect();
        let scale = expected.near.iter().copied().fold(0.0, f32::max);
        must(compare(&what("near"), &expected.near, &near, device.allows(RADIUS), scale));

        let mut summed: Vec<u32> = device.read(&counts, n + 1);
        for i in 1..=n {
            summed[i] += summed[i - 1];
        }
        assert_eq!(summed[n] as usize, expected.first_on_curve, "{}", step.name);
        let firsts = device.buffer("firsts", &summed);
        let numbers = device.output::<u32>("numbers", slots);
        let candidates = device.output::<Candidate>("candidates", expected.len());
        let buffers = [&fans, &entries, &of_slot, &firsts, &numbers, &candidates];
        device.run(step.run("candidates_number", [0; 4], n), &buffers);
        device.run(step.run("candidates_link", [0; 4], slots), &[&numbers, &of_slot]);
        let found: Vec<u32> = device.read(&of_slot, slots);
        must(compare_equal(&what("of slot"), &expected.of_slot, &found));

        let run = step.run("candidates", [0; 4], expected.len());
        let counters = device.counters();
        device.run(run, &[&points, &fans, &candidates, &counters, &curves]);
        let widest = f32::from_bits(device.read_counters(&counters, &step.name).widest);
        let scale = expected.rho.iter().copied().fold(0.0, f32::max);
        // The paper's loop alone asks for it.
        let asked = if step.refine.rules.largest_first { 0.0 } else { scale };
        must(compare(&what("largest rho"), &[asked], &[widest], device.allows(POSITION), scale));
        let found: Vec<Candidate> = device.read(&candidates, expected.len());
        let rows = step.candidates();
        let places = |c: &[Candidate]| c.iter().flat_map(|c| c.place).collect::<Vec<_>>();
        let normals = |c: &[Candidate]| c.iter().flat_map(|c| c.normal).collect::<Vec<_>>();
        let rest = |c: &[Candidate]| c.iter().map(|c| (c.corners, c.state)).collect::<Vec<_>>();
        must(compare_equal(&what("corners and states"), &rest(&rows), &rest(&found)));
        let allowed = device.allows(POSITION);
        must(compare(&what("places"), &places(&rows), &places(&found), allowed, scale));
        let sizes = |c: &[Candidate]| c.iter().map(|c| c.size).collect::<Vec<_>>();
        let allowed = device.allows(RADIUS);
        must(compare(&what("sizes"), &sizes(&rows), &sizes(&found), allowed, scale));
        let allowed = device.allows(NORMAL);
        must(compare(&what("normals"), &normals(&rows), &normals(&found), allowed, 1.0));
    }
}
