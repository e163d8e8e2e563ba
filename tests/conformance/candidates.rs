//! The candidates kernel on the reference's rings.

use crate::harness::{compare, compare_equal, device, must, steps};
use crate::tolerance::{NORMAL, POSITION};

#[test]
fn candidates_are_those_of_the_reference() {
    let mut device = device();
    for step in steps() {
        let slots = step.state.candidates.len();
        let points = device.buffer("points", &step.points());
        let starts = device.buffer("starts", &step.state.rings.starts);
        let entries = device.buffer("entries", &step.ring_entries());
        let positions = device.output::<[f32; 4]>("positions", slots);
        let normals = device.output::<[f32; 4]>("normals", slots);
        let (owners, states) =
            (device.output::<u32>("owners", slots), device.output::<u32>("states", slots));
        let curves = device.buffer("curves", &step.curves());
        let inputs = [&points, &starts, &entries];
        let outputs = [&positions, &normals, &owners, &states, &curves];
        let buffers = [&inputs[..], &outputs].concat();
        let invocations = step.level.len().max(step.level.curve_points.len());
        device.run(step.run("candidates", [0; 4], invocations), &buffers);

        let what = |column| format!("{}: candidate {column}", step.name);
        let scale = step.state.candidates.rho.iter().copied().fold(0.0, f32::max);
        let found: Vec<f32> = device.read(&positions, 4 * slots);
        let expected = step.candidate_positions().concat();
        must(compare(&what("positions"), &expected, &found, device.allows(POSITION), scale));
        let found: Vec<f32> = device.read(&normals, 4 * slots);
        let expected = step.candidate_normals().concat();
        must(compare(&what("normals"), &expected, &found, device.allows(NORMAL), 1.0));
        let owners: Vec<u32> = device.read(&owners, slots);
        must(compare_equal(&what("owners"), &step.state.candidates.owners, &owners));
        let states: Vec<u32> = device.read(&states, slots);
        must(compare_equal(&what("states"), &step.initial_states(), &states));
    }
}
