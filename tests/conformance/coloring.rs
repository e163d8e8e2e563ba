//! The colouring rounds and the sort by class.

use crate::conflicts::ConflictBuffers;
use crate::harness::{Device, GUARD_WORD, Step, compare_equal, device, must, steps_with};
use surfine::testing::Buffer;
use surfine_reference::coloring::RANGES;

/// The points by range of priorities, with the first of each range before them.
fn by_priority(device: &mut Device, step: &Step) -> Buffer {
    let n = step.level.len();
    let (order, ranks) =
        (device.output::<u32>("order", RANGES + 1 + n), device.output::<[u32; 2]>("ranks", n));
    device.run(step.run("coloring_order", [0; 4], n), &[&order, &ranks]);
    let mut summed: Vec<u32> = device.read(&order, RANGES + 1 + n);
    for i in 1..=RANGES {
        summed[i] += summed[i - 1];
    }
    assert_eq!(summed[RANGES] as usize, n, "{}: each point is in one range", step.name);
    let order = device.buffer("order", &[summed, vec![GUARD_WORD; 16]].concat());
    let fill = step.run("sort_fill", [n as u32, RANGES as u32, 0, 0], n);
    device.run(fill, &[&ranks, &order]);
    let mut members: Vec<u32> = device.read(&order, RANGES + 1 + n).split_off(RANGES + 1);
    members.sort_unstable();
    must(compare_equal(&step.name, &(0..n as u32).collect::<Vec<_>>(), &members));
    order
}

#[test]
fn classes_are_those_of_the_reference_after_enough_rounds() {
    let mut device = device();
    for step in steps_with(false) {
        let n = step.level.len();
        let graph = ConflictBuffers::compute(&mut device, step, "conflicts_large");
        let graph = graph.expect("the arena holds all");
        let fans = device.buffer("fans", &graph.fans);
        let around = device.buffer("around", &graph.around);
        let heads = device.buffer("heads", &graph.heads);
        let links = device.buffer("links", &graph.links);
        let classes = device.output::<u32>("classes", n);
        let waiting = device.output::<u32>("waiting", 2 * n);
        let rounds = device.output::<u32>("rounds", 2);
        let counters = device.counters();
        let order = by_priority(&mut device, step);
        let starts = device.read::<u32>(&order, RANGES + 1 + n)[..=RANGES].to_vec();
        let (mut round, mut left) = (0u32, 0);
        while (round as usize) < RANGES || left > 0 {
            let groups = device.output::<u32>("workgroups", 3);
            // Rows of two workgroups, so that they have to be folded.
            let prepare = step.run("coloring_round", [round, 2, 0, 0], 1);
            device.run(prepare, &[&rounds, &order, &groups]);
            let range = starts.get(round as usize..round as usize + 2);
            let points = left + range.map_or(0, |range| range[1] - range[0]) as usize;
            let needed = points.div_ceil(64) as u32;
            assert_eq!(device.read::<u32>(&groups, 3), [needed.min(2), needed.div_ceil(2), 1]);
            let state = [&classes, &order, &waiting, &rounds, &counters];
            let buffers = [&[&fans, &around, &heads, &links][..], &state].concat();
            // More invocations than there are points must not matter.
            device.run(step.run("coloring", [round, 0, 0, 0], points + 64), &buffers);
            round += 1;
            let now = device.read::<u32>(&rounds, 2)[round as usize % 2] as usize;
            assert!(points == 0 || now < points, "{}: a point gets its class", step.name);
            left = now;
        }
        let found: Vec<u32> = device.read(&classes, n);
        let expected: Vec<u32> = step.state.classes.class.iter().map(|c| c + 1).collect();
        must(compare_equal(&format!("{}: classes", step.name), &expected, &found));
        let counters = device.read_counters(&counters, &step.name);
        assert_eq!(counters.classes as usize, step.state.classes.members.len(), "{}", step.name);
    }
}

#[test]
fn points_are_sorted_by_class() {
    let mut device = device();
    for step in steps_with(false) {
        let (n, members) = (step.level.len(), &step.state.classes.members);
        let numbers: Vec<u32> = step.state.classes.class.iter().map(|c| c + 1).collect();
        let classes = device.buffer("classes", &numbers);
        let words = members.len() + 1 + n;
        let (sorted, ranks) =
            (device.output::<u32>("sorted", words), device.output::<[u32; 2]>("ranks", n));
        device.run(step.run("class_count", [0; 4], n), &[&classes, &sorted, &ranks]);
        let mut summed: Vec<u32> = device.read(&sorted, words);
        for i in 1..=members.len() {
            summed[i] += summed[i - 1];
        }
        let sorted = device.buffer("summed", &[summed, vec![GUARD_WORD; 16]].concat());
        let fill = step.run("sort_fill", [n as u32, members.len() as u32, 0, 0], n);
        device.run(fill, &[&ranks, &sorted]);
        let found: Vec<u32> = device.read(&sorted, words);
        let (starts, found) = found.split_at(members.len() + 1);
        for (class, expected) in members.iter().enumerate() {
            let mut list = found[starts[class] as usize..starts[class + 1] as usize].to_vec();
            list.sort_unstable();
            must(compare_equal(&format!("{}: class {class}", step.name), expected, &list));
        }
    }
}
