//! The colouring rounds and the sort by class.

use crate::conflicts::ConflictBuffers;
use crate::harness::{GUARD_WORD, compare_equal, device, must, steps};

#[test]
fn classes_are_those_of_the_reference_after_enough_rounds() {
    let mut device = device();
    for step in steps() {
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
        let (mut round, mut left) = (0u32, n);
        while left > 0 {
            let groups = device.output::<u32>("workgroups", 3);
            // Rows of two workgroups, so that they have to be folded.
            device.run(step.run("coloring_round", [round, 2, 0, 0], 1), &[&rounds, &groups]);
            let needed = left.div_ceil(64) as u32;
            assert_eq!(device.read::<u32>(&groups, 3), [needed.min(2), needed.div_ceil(2), 1]);
            let buffers = [&fans, &around, &heads, &links, &classes, &waiting, &rounds, &counters];
            device.run(step.run("coloring", [round, 0, 0, 0], left), &buffers);
            round += 1;
            let now = device.read::<u32>(&rounds, 2)[round as usize % 2] as usize;
            assert!(now < left, "{}: at least one point a round gets its class", step.name);
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
    for step in steps() {
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
