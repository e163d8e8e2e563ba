//! The colouring rounds and the sort by class.

use crate::conflicts::ConflictBuffers;
use crate::harness::{GUARD_WORD, compare_equal, device, must, steps};
use surfine::records::Counters;

#[test]
fn classes_are_those_of_the_reference_after_enough_rounds() {
    let mut device = device();
    for step in steps() {
        let n = step.level.len();
        let graph = ConflictBuffers::compute(&mut device, step);
        let blocks = device.buffer("blocks", &graph.blocks);
        let entries = device.buffer("entries", &graph.entries);
        let heads = device.buffer("heads", &graph.heads);
        let links = device.buffer("links", &graph.links);
        let classes = device.output::<u32>("classes", n);
        let mut rounds = 0;
        let counters = loop {
            let counters = device.output::<u32>("counters", size_of::<Counters>() / 4);
            let buffers = [&blocks, &entries, &heads, &links, &classes, &counters];
            device.run(step.run("coloring", [1, 0, 0, 0], n), &buffers);
            let counters = device.read::<Counters>(&counters, 1)[0];
            rounds += 1;
            assert!(rounds <= n, "{}: at least one point a round gets its class", step.name);
            if counters.uncolored == 0 {
                break counters;
            }
        };
        let found: Vec<u32> = device.read(&classes, n);
        let expected: Vec<u32> = step.state.classes.class.iter().map(|c| c + 1).collect();
        must(compare_equal(&format!("{}: classes", step.name), &expected, &found));
        // The last round alone knows the classes that it gave; the engine takes the maximum over all rounds.
        assert!(counters.classes as usize <= step.state.classes.members.len(), "{}", step.name);
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
