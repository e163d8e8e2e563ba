//! The insertion kernel, class by class, with private rows and with rows in the arena, on the reference's candidates
//! and classes.

use crate::harness::{
    ARENA_WORDS, Device, INSERTION, Step, compare, compare_equal, constant, device, must,
    steps_with,
};
use crate::tolerance::RADIUS;
use surfine::testing::records::Candidate;

/// States of the candidates and bits of the radii after all classes, each in the order that `arrange` makes of it.
/// Points with an odd index are left to the rows in the arena, and others only where the private rows are too short.
fn insert(device: &mut Device, step: &Step, arrange: fn(&mut Vec<u32>)) -> (Vec<u32>, Vec<u32>) {
    let (n, count) = (step.level.len(), step.state.candidates.len());
    let mut lists = step.state.classes.members.clone();
    lists.iter_mut().for_each(arrange);
    let mut starts = vec![0];
    starts.extend(lists.iter().scan(0, |end, list| {
        *end += list.len() as u32;
        Some(*end)
    }));
    let points = device.buffer("points", &step.points());
    let capacity = constant("insertion", "CAPACITY");
    let mut fans = step.fans(0);
    for (p, fan) in fans.iter_mut().enumerate() {
        // What the rows of the kernel surely hold.
        let is_short = fan.around[1] + fan.slots[1] + 3 <= capacity;
        fan.left_over = if is_short && p.is_multiple_of(2) { 0 } else { INSERTION };
    }
    let fans = device.buffer("fans", &fans);
    let of_slot = device.buffer("of slot", &step.state.candidates.of_slot);
    let candidates = device.guarded("candidates", &step.candidates());
    let around = device.buffer("around", &step.around());
    let members = device.buffer("members", &[starts.as_slice(), &lists.concat()].concat());
    let radii = device.output::<u32>("radii", n + count);
    let arena = device.output::<u32>("arena", ARENA_WORDS);
    let curves = device.buffer("curves", &step.curves());
    for class in 0..lists.len() {
        let counters = device.counters();
        let size = lists[class].len();
        let words = [class as u32 + 1, starts[class], size as u32, lists.len() as u32];
        let inputs = [&points, &fans, &of_slot, &candidates, &around, &members];
        let buffers = [&inputs[..], &[&radii, &arena, &counters, &curves]].concat();
        for kernel in ["insertion", "insertion_large"] {
            device.run(step.run(kernel, words, size), &buffers);
        }
        device.read_counters(&counters, &step.name);
    }
    let states = device.read::<Candidate>(&candidates, count).iter().map(|c| c.state).collect();
    (states, device.read(&radii, n + count))
}

#[test]
fn decisions_and_radii_are_those_of_the_reference() {
    let mut device = device();
    for step in steps_with(false) {
        let (states, radii) = insert(&mut device, step, |_| ());
        let expected = &step.state.insertion;
        must(compare_equal(&format!("{}: states", step.name), &expected.states, &states));
        let mut radii: Vec<f32> = radii.into_iter().map(f32::from_bits).collect();
        // What new points on curves have at least is left to the commit.
        let on_curve = step.level.len() + step.state.candidates.first_on_curve;
        for (radius, point) in radii[on_curve..].iter_mut().zip(&step.level.curve_points) {
            *radius = radius.max(point.radius);
        }
        let all = [expected.radii.as_slice(), &expected.candidate_radii].concat();
        let scale = all.iter().copied().fold(0.0, f32::max);
        must(compare(&format!("{}: radii", step.name), &all, &radii, device.allows(RADIUS), scale));
    }
}

#[test]
fn the_order_inside_a_class_does_not_matter() {
    let mut device = device();
    for step in steps_with(false) {
        let ascending = insert(&mut device, step, |_| ());
        let descending = insert(&mut device, step, |list| list.reverse());
        must(compare_equal(&format!("{}: states", step.name), &ascending.0, &descending.0));
        must(compare_equal(&format!("{}: radii", step.name), &ascending.1, &descending.1));
    }
}
