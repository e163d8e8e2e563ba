//! The kernels of what is around each point and of the conflict graph, on the reference's candidates.

use crate::harness::{
    ARENA_WORDS, CONFLICTS, Device, INSERTION, MIRROR_LINKS, NEXT_RING, Step, compare_equal,
    constant, device, grid_words, must, steps_with,
};
use surfine::testing::records::{Counters, Fan};

/// What the kernels leave: lists, and links to the points whose conflicts only the other side found.
pub(crate) struct ConflictBuffers {
    pub fans: Vec<Fan>,
    pub around: Vec<u32>,
    pub heads: Vec<u32>,
    pub links: Vec<[u32; 2]>,
}

impl ConflictBuffers {
    /// Runs a kernel and, if it leaves nothing over, the mirroring one. All points were left over before.
    pub(crate) fn compute(device: &mut Device, step: &Step, kernel: &str) -> Option<Self> {
        let n = step.level.len();
        let points = device.buffer("points", &step.points());
        let before = |fan: Fan| Fan { around: [0; 2], conflicts: [0; 2], ..fan };
        let fans: Vec<Fan> = step.fans(CONFLICTS).into_iter().map(before).collect();
        let fans = device.guarded("fans", &fans);
        let of_slot = device.buffer("of slot", &step.state.candidates.of_slot);
        let candidates = device.buffer("candidates", &step.candidates());
        let (starts, places) = grid_words(step.candidate_grid());
        let (grid, places) = (device.buffer("grid", &starts), device.buffer("places", &places));
        let entries = step.params().around_entries as usize;
        let around = device.output::<u32>("around", entries);
        let arena = device.output::<u32>("arena", ARENA_WORDS);
        let widest = step.state.candidates.rho.iter().copied().fold(0.0, f32::max);
        let counters = Counters { widest: widest.to_bits(), ..Counters::default() };
        let counters = device.guarded("counters", &[counters]);
        let curves = device.buffer("curves", &step.curves());
        let inputs = [&points, &fans, &of_slot, &candidates, &grid, &places];
        let buffers = [&inputs[..], &[&around, &arena, &counters, &curves]].concat();
        device.run(step.run(kernel, [0, n as u32, 0, 0], n), &buffers);
        if device.read_counters(&counters, &step.name).left_over & CONFLICTS != 0 {
            assert_eq!(kernel, "conflicts", "the arena holds all");
            return None;
        }
        let heads = device.output::<u32>("heads", n);
        let links = device.output::<[u32; 2]>("links", MIRROR_LINKS);
        let mirror = [&fans, &around, &heads, &links, &counters];
        device.run(step.run("conflicts_mirror", [0; 4], n), &mirror);
        assert!(device.read_counters(&counters, &step.name).mirrored as usize <= MIRROR_LINKS);
        Some(Self {
            fans: device.read(&fans, n),
            around: device.read(&around, entries),
            heads: device.read(&heads, n),
            links: device.read(&links, MIRROR_LINKS),
        })
    }

    /// The candidates around a point, ascending.
    fn around(&self, p: usize) -> Vec<u32> {
        let [first, size] = self.fans[p].around.map(|v| v as usize);
        sorted(self.around[first..first + size].to_vec())
    }

    /// The points in conflict with it as it found them itself, those that choose before it first.
    fn found(&self, p: usize) -> &[u32] {
        let Fan { around, conflicts, .. } = self.fans[p];
        let first = (around[0] + around[1]) as usize;
        &self.around[first..first + conflicts[0] as usize]
    }

    /// The points in conflict with it that choose before it, each once for each time it is noted.
    fn before(&self, p: usize) -> Vec<u32> {
        let mut before = self.found(p)[..self.fans[p].conflicts[1] as usize].to_vec();
        let mut link = self.heads[p];
        while link != 0 {
            let [q, next] = self.links[link as usize - 1];
            before.push(q);
            link = next;
        }
        sorted(before)
    }
}

fn sorted(mut list: Vec<u32>) -> Vec<u32> {
    list.sort_unstable();
    list
}

#[test]
fn lists_and_graph_are_those_of_the_reference() {
    let mut device = device();
    let [longest_new, longest_next] =
        ["insertion", "next_ring"].map(|kernel| constant(kernel, "CAPACITY"));
    let mut left_over = 0;
    for step in steps_with(false) {
        let n = step.level.len();
        let reference = &step.state.conflicts;
        for kernel in ["conflicts", "conflicts_large"] {
            let Some(found) = ConflictBuffers::compute(&mut device, step, kernel) else { continue };
            for p in 0..n {
                let what = format!("{} {kernel}: around {p}", step.name);
                let around = sorted(reference.around.of(p).to_vec());
                must(compare_equal(&what, &around, &found.around(p)));
                // Equal lists also say that no conflict is noted twice.
                let what = format!("{} {kernel}: conflicts of {p}", step.name);
                let before = sorted(reference.before.of(p).to_vec());
                must(compare_equal(&what, &before, &found.before(p)));
                // Rows of the insertion may grow beyond the lists, those of the next ring do not.
                let Fan { slots, around, left_over: bits, .. } = found.fans[p];
                let is_long = around[1] + slots[1] + 1 > longest_next;
                assert_eq!(bits & NEXT_RING != 0, is_long, "{what}");
                assert!(bits & INSERTION != 0 || around[1] < longest_new, "{what}");
                left_over |= bits;
            }
        }
    }
    assert_eq!(left_over, INSERTION | NEXT_RING, "not both have rows that are too long");
}
