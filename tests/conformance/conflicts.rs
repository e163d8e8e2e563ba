//! The two kernels of the conflict graph on the reference's candidates.

use crate::harness::{
    CONFLICT_ENTRIES, Device, Step, compare_equal, device, grid_words, must, steps,
};
use surfine::records::Counters;

/// What the kernels leave for the colouring: lists, and links to the points that only one side found.
pub(crate) struct ConflictBuffers {
    pub blocks: Vec<[u32; 2]>,
    pub entries: Vec<u32>,
    pub heads: Vec<u32>,
    pub links: Vec<[u32; 2]>,
}

impl ConflictBuffers {
    pub(crate) fn compute(device: &mut Device, step: &Step) -> Self {
        let n = step.level.len();
        let points = device.buffer("points", &step.points());
        let starts = device.buffer("starts", &step.state.rings.starts);
        let candidates = device.buffer("candidates", &step.candidate_positions());
        let normals = device.buffer("normals", &step.candidate_normals());
        let owners = device.buffer("owners", &step.state.candidates.owners);
        let grid = device.buffer("grid", &grid_words(&step.state.candidate_grid));
        let blocks = device.output::<[u32; 2]>("blocks", n);
        let entries = device.output::<u32>("entries", CONFLICT_ENTRIES);
        let heads = device.output::<u32>("heads", n);
        let links = device.output::<[u32; 2]>("links", CONFLICT_ENTRIES);
        let counters = device.output::<u32>("counters", size_of::<Counters>() / 4);
        let inputs = [&points, &starts, &candidates, &normals, &owners, &grid];
        let lists = [&blocks, &entries];
        device.run(step.run("conflicts", [0; 4], n), &[&inputs[..], &lists, &[&counters]].concat());
        let mirror = [&blocks, &entries, &heads, &links, &counters];
        device.run(step.run("conflicts_mirror", [0; 4], n), &mirror);
        let counters: Vec<Counters> = device.read(&counters, 1);
        assert_eq!(counters[0].cut_loops, 0, "{}", step.name);
        Self {
            blocks: device.read(&blocks, n),
            entries: device.read(&entries, CONFLICT_ENTRIES),
            heads: device.read(&heads, n),
            links: device.read(&links, CONFLICT_ENTRIES),
        }
    }

    /// The neighbours of a point, each once for each time it is noted.
    fn neighbors(&self, p: usize) -> Vec<u32> {
        let [first, size] = self.blocks[p].map(|v| v as usize);
        let mut neighbors = self.entries[first..first + size].to_vec();
        let mut link = self.heads[p];
        while link != 0 {
            let [q, next] = self.links[link as usize - 1];
            neighbors.push(q);
            link = next;
        }
        neighbors.sort_unstable();
        neighbors
    }
}

#[test]
fn the_graph_is_that_of_the_reference() {
    let mut device = device();
    for step in steps() {
        let found = ConflictBuffers::compute(&mut device, step);
        for p in 0..step.level.len() {
            let what = format!("{}: conflicts of {p}", step.name);
            // Equal lists also say that no conflict is noted twice.
            must(compare_equal(&what, step.state.conflicts.neighbors(p), &found.neighbors(p)));
        }
    }
}
