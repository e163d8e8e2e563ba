//! The insertion kernel, class by class, on the reference's candidates and classes.

use crate::harness::{
    ARENA_WORDS, Device, ON_CURVE, Step, USED, compare, compare_equal, device, must, steps,
};
use crate::tolerance::RADIUS;
use surfine::records::Counters;

/// States of the slots and bits of the radii after all classes, each in the order that `arrange` makes of it.
fn insert(device: &mut Device, step: &Step, arrange: fn(&mut Vec<u32>)) -> (Vec<u32>, Vec<u32>) {
    let (n, slots) = (step.level.len(), step.state.candidates.len());
    let mut lists = step.state.classes.members.clone();
    lists.iter_mut().for_each(arrange);
    let mut starts = vec![0];
    starts.extend(lists.iter().scan(0, |end, list| {
        *end += list.len() as u32;
        Some(*end)
    }));
    let points = device.buffer("points", &step.points());
    let ring_starts = device.buffer("ring starts", &step.state.rings.starts);
    let positions = device.buffer("positions", &step.candidate_positions());
    let normals = device.buffer("normals", &step.candidate_normals());
    let grid = device.buffer("grid", &step.candidate_grid_words());
    let members = device.buffer("members", &[starts.as_slice(), &lists.concat()].concat());
    let guarded = [bytemuck::cast_slice(&step.initial_states()), &[0xa5u8; 64][..]].concat();
    let states = device.buffer("states", &guarded);
    let radii = device.output::<u32>("radii", n + slots);
    let arena = device.output::<u32>("arena", ARENA_WORDS);
    for class in 0..lists.len() {
        let counters = device.output::<u32>("counters", size_of::<Counters>() / 4);
        let count = lists[class].len();
        let words = [class as u32 + 1, starts[class], count as u32, lists.len() as u32];
        let inputs = [&points, &ring_starts, &positions, &normals, &grid, &members];
        let outputs = [&states, &radii, &arena, &counters];
        device.run(step.run("insertion", words, count), &[&inputs[..], &outputs].concat());
        let counters = device.read::<Counters>(&counters, 1)[0];
        assert_eq!(counters.cut_loops, 0, "{}", step.name);
        assert!(
            counters.arena_peak as usize <= ARENA_WORDS,
            "{}: the test's arena is too small",
            step.name
        );
    }
    (device.read(&states, slots), device.read(&radii, n + slots))
}

fn inserted(states: &[u32]) -> Vec<bool> {
    states.iter().map(|&s| (ON_CURVE..USED).contains(&s)).collect()
}

#[test]
fn decisions_and_radii_are_those_of_the_reference() {
    let mut device = device();
    for step in steps() {
        let (states, radii) = insert(&mut device, step, |_| ());
        let expected = &step.state.insertion;
        must(compare_equal(
            &format!("{}: inserted", step.name),
            &expected.inserted,
            &inserted(&states),
        ));
        let mut radii: Vec<f32> = radii.into_iter().map(f32::from_bits).collect();
        // What new points on curves have at least is left to the commit.
        let on_curve = step.level.len() + step.state.candidates.first_on_curve;
        for (radius, point) in radii[on_curve..].iter_mut().zip(&step.level.curve_points) {
            *radius = radius.max(point.radius);
        }
        let all = [expected.radii.as_slice(), &expected.slot_radii].concat();
        let scale = all.iter().copied().fold(0.0, f32::max);
        must(compare(&format!("{}: radii", step.name), &all, &radii, device.allows(RADIUS), scale));
    }
}

#[test]
fn the_order_inside_a_class_does_not_matter() {
    let mut device = device();
    for step in steps() {
        let ascending = insert(&mut device, step, |_| ());
        let descending = insert(&mut device, step, |list| list.reverse());
        must(compare_equal(&format!("{}: states", step.name), &ascending.0, &descending.0));
        must(compare_equal(&format!("{}: radii", step.name), &ascending.1, &descending.1));
    }
}
