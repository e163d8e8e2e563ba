//! By the paper's loop: the classes of points that are refined together (ours).

use crate::Error;
use crate::commands::Commands;
use crate::records::Counters;
use crate::sizing::{WORD, items_of, words_of};
use crate::step::Step;
use std::ops::Range;

/// Ranges of priorities, as in `shaders/shared/priority.wgsl`: as many rounds of colouring have points that were not
/// there before.
const RANGES: u32 = 32;

impl Step<'_> {
    /// `coloring`: the classes, and the points by class. Returns the first member of each class and the end.
    pub(crate) async fn coloring(&mut self) -> Result<Vec<u32>, Error> {
        let n = self.params.points;
        self.buffers.classes.reserve(self.gpu, WORD * u64::from(n))?;
        self.buffers.mirror_heads.reserve(self.gpu, WORD * u64::from(n))?;
        self.buffers.waiting.reserve(self.gpu, 2 * WORD * u64::from(n))?;
        self.buffers.rounds.reserve(self.gpu, 2 * WORD)?;
        self.buffers.workgroups.reserve(self.gpu, 3 * WORD)?;
        let links = self.sizing.mirror_links(n.into());
        self.buffers.mirror_links.reserve(self.gpu, 2 * WORD * links)?;
        loop {
            self.params.mirror_links = items_of(&self.buffers.mirror_links, 2);
            self.record_mirror().await?;
            self.sort_by_priority().await?;
            let mut round = RANGES + self.sizing.rounds;
            let (mut counters, mut left) = self.run_rounds(0..round).await?;
            if !self.make_room_for_links("links of conflicts", &counters)? {
                continue;
            }
            while left > 0 {
                let next = round + self.sizing.rounds;
                (counters, left) = self.run_rounds(round..next).await?;
                round = next;
            }
            self.sort_by_class(counters.classes).await?;
            let bytes = WORD * (u64::from(counters.classes) + 1);
            let starts = self
                .uniforms
                .read(self.gpu, &[(self.buffers.class_members.raw(), 0, bytes)])
                .await?;
            return Ok(bytemuck::pod_collect_to_vec(&starts));
        }
    }

    async fn record_mirror(&self) -> Result<(), Error> {
        let b = &*self.buffers;
        let n = self.params.points;
        let mut commands = self.commands();
        commands.clear(&b.counters, words_of(&b.counters).into());
        commands.clear(&b.mirror_heads, n.into());
        commands.clear(&b.classes, n.into());
        let buffers = [&b.fans, &b.around, &b.mirror_heads, &b.mirror_links, &b.counters];
        commands.run(self.kernels.get("conflicts_mirror"), &buffers, [0; 4], n).await;
        commands.finish().await
    }

    async fn sort_by_priority(&mut self) -> Result<(), Error> {
        let n = self.params.points;
        self.reserve_members(RANGES)?;
        let b = &*self.buffers;
        let mut commands = self.commands();
        commands.clear(&b.rounds, 2);
        commands.clear(&b.class_members, u64::from(RANGES) + 1);
        let count = self.kernels.get("coloring_order");
        commands.run(count, &[&b.class_members, &b.cells], [0; 4], n).await;
        self.record_members(&mut commands, RANGES).await;
        commands.finish().await
    }

    /// Some rounds of colouring. Returns the counters and how many points are left.
    async fn run_rounds(&self, rounds: Range<u32>) -> Result<(Counters, u32), Error> {
        let b = &*self.buffers;
        let mut commands = self.commands();
        let graph = [&b.fans, &b.around, &b.mirror_heads, &b.mirror_links];
        let state = [&b.classes, &b.class_members, &b.waiting, &b.rounds, &b.counters];
        let round = commands.bind(self.kernels.get("coloring"), &[&graph[..], &state].concat());
        let prepare = [&b.rounds, &b.class_members, &b.workgroups];
        let prepare = commands.bind(self.kernels.get("coloring_round"), &prepare);
        let row = self.gpu.device.limits().max_compute_workgroups_per_dimension;
        for i in rounds.clone() {
            commands.dispatch(&prepare, [i, row, 0, 0], 1).await;
            // After the last range few wait.
            let about = if i < RANGES { self.params.points.div_ceil(RANGES) } else { 0 };
            commands.dispatch_indirect(&round, [i, 0, 0, 0], &b.workgroups, about).await;
        }
        commands.finish().await?;
        // Who waits after the last round waits for the next one.
        let (counters, waiting) = self.read(&[(&b.rounds, rounds.end % 2)]).await?;
        Ok((counters, waiting[0]))
    }

    async fn sort_by_class(&mut self, classes: u32) -> Result<(), Error> {
        let n = self.params.points;
        self.reserve_members(classes)?;
        let b = &*self.buffers;
        let mut commands = self.commands();
        commands.clear(&b.class_members, u64::from(classes) + 1);
        let count = self.kernels.get("class_count");
        commands.run(count, &[&b.classes, &b.class_members, &b.cells], [0; 4], n).await;
        self.record_members(&mut commands, classes).await;
        commands.finish().await
    }

    /// Makes room for the points by class, or by range of priorities.
    fn reserve_members(&mut self, classes: u32) -> Result<(), Error> {
        let n = self.params.points;
        let words = u64::from(classes) + 1 + u64::from(n);
        self.buffers.class_members.reserve(self.gpu, WORD * words)?;
        self.buffers.cells.reserve(self.gpu, 2 * WORD * u64::from(n))?;
        self.scan.reserve(self.gpu, classes + 1)
    }

    /// Records the second half of the sort by class.
    async fn record_members(&self, commands: &mut Commands<'_>, classes: u32) {
        let (b, n) = (&*self.buffers, self.params.points);
        self.record_scan(commands, &b.class_members, 0, classes + 1).await;
        let fill = self.kernels.get("sort_fill");
        commands.run(fill, &[&b.cells, &b.class_members], [n, classes, 0, 0], n).await;
    }
}
