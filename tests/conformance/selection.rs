//! The selection kernels on the reference's candidates.

use crate::harness::{
    Device, FREE, INSERTED, MIRROR_LINKS, NEXT_RING, Step, WAITING, compare, compare_equal,
    constant, device, grid_words, must, steps_with,
};
use crate::tolerance::RADIUS;
use surfine::testing::Buffer;
use surfine::testing::records::{Candidate, Fan};
use surfine_points::Grid;

/// The candidates and the links of those that discard each other.
struct Overlaps {
    candidates: Buffer,
    heads: Buffer,
    links: Buffer,
    /// The candidates that wait, and how many in even and odd rounds.
    waiting: Buffer,
    rounds: Buffer,
    /// The first round, and how many wait for it.
    first: (u32, usize),
}

impl Overlaps {
    fn compute(device: &mut Device, step: &Step) -> Self {
        match &step.state.candidate_grid {
            Some(grid) => Self::of_all(device, step, grid),
            None => Self::of_contested(device, step),
        }
    }

    fn new(
        device: &mut Device,
        candidates: Buffer,
        heads: Buffer,
        links: Buffer,
        count: usize,
    ) -> Self {
        let waiting = device.output::<u32>("waiting", 2 * count);
        let rounds = device.output::<u32>("rounds", 2);
        Self { candidates, heads, links, waiting, rounds, first: (0, count) }
    }

    /// Of those that only some fans have.
    fn of_contested(device: &mut Device, step: &Step) -> Self {
        let count = step.state.candidates.len();
        let candidates = device.guarded("candidates", &step.candidates());
        let fans = device.buffer("fans", &step.fans(0));
        let of_slot = device.buffer("of slot", &step.state.candidates.of_slot);
        let first_candidates = device.buffer("first candidates", &step.first_candidates());
        let heads = device.output::<u32>("heads", count);
        let links = device.output::<[u32; 2]>("links", MIRROR_LINKS);
        let counters = device.counters();
        let mut overlaps = Self::new(device, candidates, heads, links, count);
        let Self { candidates, heads, links, waiting, rounds, .. } = &overlaps;
        let buffers = [candidates, &fans, &of_slot, &first_candidates, waiting, rounds, &counters];
        device.run(step.run("selection_contested", [0; 4], count), &buffers);
        let contested = device.read::<u32>(rounds, 2)[1] as usize;
        let buffers = [candidates, &fans, &of_slot, waiting, rounds, heads, links, &counters];
        // More invocations than there are candidates must not matter.
        device.run(step.run("selection_links", [0; 4], contested + 64), &buffers);
        assert!(device.read_counters(&counters, &step.name).mirrored as usize <= MIRROR_LINKS);
        overlaps.first = (1, contested);
        overlaps
    }

    fn of_all(device: &mut Device, step: &Step, grid: &Grid) -> Self {
        let count = step.state.candidates.len();
        let points = device.buffer("points", &step.points());
        let candidates = device.guarded("candidates", &step.candidates());
        let (starts, places) = grid_words(grid);
        let (grid, places) = (device.buffer("grid", &starts), device.buffer("places", &places));
        let heads = device.output::<u32>("heads", count);
        let links = device.output::<[u32; 2]>("links", MIRROR_LINKS);
        let counters = device.counters();
        let curves = device.buffer("curves", &step.curves());
        let inputs = [&points, &candidates, &grid, &places];
        let buffers = [&inputs[..], &[&heads, &links, &counters, &curves]].concat();
        device.run(step.run("selection_overlaps", [0; 4], count), &buffers);
        assert!(device.read_counters(&counters, &step.name).mirrored as usize <= MIRROR_LINKS);
        Self::new(device, candidates, heads, links, count)
    }
}

#[test]
fn overlaps_are_those_of_the_reference() {
    let mut device = device();
    let mut found_any = 0;
    for step in steps_with(true) {
        let expected = &step.state.overlaps;
        let found = Overlaps::compute(&mut device, step);
        let heads: Vec<u32> = device.read(&found.heads, expected.len());
        let links: Vec<[u32; 2]> = device.read(&found.links, MIRROR_LINKS);
        for (c, head) in heads.into_iter().enumerate() {
            let (mut list, mut link) = (Vec::new(), head);
            while link != 0 {
                let [h, next] = links[link as usize - 1];
                list.push(h);
                link = next;
            }
            list.sort_unstable();
            let mut expected = expected.of(c).to_vec();
            expected.sort_unstable();
            must(compare_equal(&format!("{}: overlaps of {c}", step.name), &expected, &list));
        }
        found_any += expected.items.len();
    }
    assert!(found_any > 1000, "{found_any} overlaps in all: the clouds are too tame");
}

/// Runs rounds until all candidates are decided.
fn select(device: &mut Device, step: &Step, overlaps: &Overlaps) {
    let Overlaps { waiting, rounds, .. } = overlaps;
    let counters = device.counters();
    let (mut round, mut left) = overlaps.first;
    while left > 0 {
        if round > 0 {
            let groups = device.output::<u32>("workgroups", 3);
            // Rows of two workgroups, so that they have to be folded.
            let prepare = step.run("selection_round", [round, 2, 0, 0], 1);
            device.run(prepare, &[rounds, &groups]);
            let needed = left.div_ceil(64) as u32;
            assert_eq!(device.read::<u32>(&groups, 3), [needed.min(2), needed.div_ceil(2), 1]);
        }
        let graph = [&overlaps.candidates, &overlaps.heads, &overlaps.links];
        let buffers = [&graph[..], &[waiting, rounds, &counters]].concat();
        // More invocations than there are candidates must not matter.
        device.run(step.run("selection", [round, 0, 0, 0], left + 64), &buffers);
        round += 1;
        let now = device.read::<u32>(rounds, 2)[round as usize % 2] as usize;
        assert!(now < left, "{}: a candidate is decided", step.name);
        left = now;
    }
    device.read_counters(&counters, &step.name);
}

#[test]
fn new_points_neighborhoods_and_radii_are_those_of_the_reference() {
    let mut device = device();
    // What the rows of the kernel for them hold.
    let longest = constant("next_ring", "CAPACITY") as usize;
    let mut found_long = false;
    for step in steps_with(true) {
        let (n, count) = (step.level.len(), step.state.candidates.len());
        let slots = step.state.rings.len();
        let overlaps = Overlaps::compute(&mut device, step);
        select(&mut device, step, &overlaps);
        let expected = &step.state.insertion;
        let states: Vec<Candidate> = device.read(&overlaps.candidates, count);
        let states: Vec<u32> = states.iter().map(|c| c.state).collect();
        must(compare_equal(&format!("{}: states", step.name), &expected.states, &states));

        let (stand_ins, counters) = (device.output::<u32>("stand-ins", count), device.counters());
        let Overlaps { candidates, heads, links, .. } = &overlaps;
        let buffers = [candidates, heads, links, &stand_ins, &counters];
        device.run(step.run("selection_stand_in", [0; 4], count), &buffers);
        let points = device.buffer("points", &step.points());
        let fans = device.guarded("fans", &step.fans(0));
        let of_slot = device.buffer("of slot", &step.state.candidates.of_slot);
        let radii = device.output::<u32>("radii", n + count);
        let members = device.output::<u32>("members", slots);
        let inputs = [&points, &fans, &of_slot, candidates, &stand_ins];
        let buffers = [&inputs[..], &[&radii, &members, &counters]].concat();
        device.run(step.run("selection_radii", [0; 4], n), &buffers);
        device.read_counters(&counters, &step.name);

        let members: Vec<u32> = device.read(&members, slots);
        for (p, fan) in device.read::<Fan>(&fans, n).into_iter().enumerate() {
            let [first, size] = fan.around.map(|v| v as usize);
            let what = format!("{}: N' of {p}", step.name);
            let expected = step.state.conflicts.around.of(p);
            must(compare_equal(&what, expected, &members[first..first + size]));
            let row = size + step.state.rings.slots(p).len() + 1;
            let is_long = step.refine.effective_next_ring() && row > longest;
            found_long |= is_long;
            assert_eq!(fan.left_over, if is_long { NEXT_RING } else { 0 }, "{what}");
        }
        let mut radii: Vec<f32> =
            device.read::<u32>(&radii, n + count).into_iter().map(f32::from_bits).collect();
        // What new points on curves have at least is left to the commit.
        let on_curve = n + step.state.candidates.first_on_curve;
        for (radius, point) in radii[on_curve..].iter_mut().zip(&step.level.curve_points) {
            *radius = radius.max(point.radius);
        }
        let all = [expected.radii.as_slice(), &expected.candidate_radii].concat();
        let scale = all.iter().copied().fold(0.0, f32::max);
        must(compare(&format!("{}: radii", step.name), &all, &radii, device.allows(RADIUS), scale));
    }
    assert!(found_long, "no row is too long");
}

/// A chain of candidates, each discarded by the one before: every second one is inserted, in as many rounds as the
/// timing makes of it.
const CHAIN: u32 = 100;

fn chain(device: &mut Device, step: &Step) -> Overlaps {
    let count = step.state.candidates.len();
    let wait = |c: Candidate| Candidate { state: WAITING, ..c };
    let candidates: Vec<Candidate> = step.candidates().into_iter().map(wait).collect();
    let candidates = device.guarded("candidates", &candidates);
    // Link i is of candidate i + 1, to the one before.
    let heads: Vec<u32> = (0..count as u32).map(|c| if c < CHAIN { c } else { 0 }).collect();
    let links: Vec<[u32; 2]> = (0..CHAIN).map(|i| [i, 0]).collect();
    let (heads, links) = (device.buffer("heads", &heads), device.buffer("links", &links));
    Overlaps::new(device, candidates, heads, links, count)
}

fn states(device: &mut Device, overlaps: &Overlaps, count: usize) -> Vec<u32> {
    let candidates: Vec<Candidate> = device.read(&overlaps.candidates, count);
    candidates.iter().map(|c| c.state).collect()
}

fn every_second(c: u32) -> u32 {
    if c % 2 == 1 { FREE } else { INSERTED }
}

#[test]
fn a_candidate_waits_for_those_before_it() {
    let mut device = device();
    let step = steps_with(true).next().expect("there are steps");
    let count = step.state.candidates.len();
    let overlaps = chain(&mut device, step);
    select(&mut device, step, &overlaps);
    for (c, state) in (0..).zip(states(&mut device, &overlaps, count)) {
        assert_eq!(state, if c < CHAIN { every_second(c) } else { INSERTED }, "candidate {c}");
    }
}

#[test]
fn one_workgroup_does_the_last_rounds() {
    let mut device = device();
    let step = steps_with(true).next().expect("there are steps");
    let count = step.state.candidates.len();
    let mut overlaps = chain(&mut device, step);
    // The last of the chain comes first, so that each round decides few.
    let mut waiting: Vec<u32> = (0..CHAIN).rev().collect();
    waiting.resize(2 * count, u32::MAX);
    overlaps.waiting = device.guarded("waiting", &waiting);
    let run = |device: &mut Device, overlaps: &Overlaps, left: u32| {
        let rounds = device.guarded("rounds", &[left, 7]);
        let counters = device.counters();
        let Overlaps { candidates, heads, links, waiting, .. } = overlaps;
        let buffers = [candidates, heads, links, waiting, &rounds, &counters];
        device.run(step.run("selection_tail", [2, 0, 0, 0], 1), &buffers);
        device.read_counters(&counters, &step.name);
        device.read::<u32>(&rounds, 2)[0]
    };
    let [few, rounds] = ["FEW", "ROUNDS"].map(|name| constant("selection_tail", name));
    assert_eq!(run(&mut device, &overlaps, few + 1), few + 1, "they are left to others");
    assert_eq!(states(&mut device, &overlaps, count), vec![WAITING; count]);
    let mut left = CHAIN;
    let mut runs = 0;
    while left > 0 {
        let now = run(&mut device, &overlaps, left);
        // Each of the rounds decides one at least.
        assert!(now + left.min(rounds) <= left, "{left} waited, {now} wait");
        (left, runs) = (now, runs + 1);
    }
    assert!(runs <= CHAIN.div_ceil(rounds), "{runs} runs");
    for (c, state) in (0..).zip(states(&mut device, &overlaps, count)) {
        assert_eq!(state, if c < CHAIN { every_second(c) } else { WAITING }, "candidate {c}");
    }
}
