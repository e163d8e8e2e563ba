//! The selection of new points, the largest triangles first, as dispatches of its kernels.

use crate::Error;
use crate::commands::Commands;
use crate::records::Counters;
use crate::sizing::{WORD, items_of, radii, words_of};
use crate::step::Step;
use std::ops::Range;

/// Rounds that have a dispatch of their own before one workgroup does the rest: after three of them a few candidates
/// wait, or none.
const ROUNDS: u32 = 3;

impl Step<'_> {
    /// `selection`: which candidates are inserted, and the radii of all points. Returns the number of new points, and
    /// the counters, which tell what is left over.
    pub(crate) async fn selection(&mut self) -> Result<(u32, Counters), Error> {
        let (n, candidates) = (u64::from(self.params.points), u64::from(self.params.candidates));
        if !self.asks_contested_alone {
            self.grid_candidates().await?;
        }
        self.buffers.mirror_heads.reserve(self.gpu, WORD * candidates)?;
        self.buffers.mirror_links.reserve(self.gpu, 2 * WORD * self.sizing.links(n))?;
        self.buffers.waiting.reserve(self.gpu, 2 * WORD * candidates)?;
        self.buffers.rounds.reserve(self.gpu, 2 * WORD)?;
        self.buffers.workgroups.reserve(self.gpu, 3 * WORD)?;
        self.buffers.next_radii.reserve(self.gpu, WORD * radii(n, candidates))?;
        self.buffers.new_indices.reserve(self.gpu, WORD * (candidates + 1))?;
        self.scan.reserve(self.gpu, self.params.candidates + 1)?;
        loop {
            self.params.mirror_links = items_of(&self.buffers.mirror_links, 2);
            self.record_links().await?;
            // Where contested candidates alone are asked, they wait for round 1.
            let first = u32::from(self.asks_contested_alone);
            let each = self.sizing.rounds.min(ROUNDS);
            let mut rounds = first..first + each;
            let (counters, mut left) = self.run_selection(rounds.clone()).await?;
            if !self.make_room_for_links("links between candidates", &counters)? {
                continue;
            }
            while left > 0 {
                rounds = rounds.end..rounds.end + each;
                left = self.run_selection(rounds.clone()).await?.1;
            }
            break;
        }
        self.record_radii().await?;
        let last = self.params.candidates;
        let (counters, totals) = self.read(&[(&self.buffers.new_indices, last)]).await?;
        Ok((totals[0], counters))
    }

    /// Records who discards whom.
    async fn record_links(&self) -> Result<(), Error> {
        let b = &*self.buffers;
        let mut commands = self.commands();
        commands.clear(&b.counters, words_of(&b.counters).into());
        commands.clear(&b.mirror_heads, self.params.candidates.into());
        commands.clear(&b.rounds, 2);
        if self.asks_contested_alone {
            self.record_contested(&mut commands).await;
        } else {
            self.record_overlaps(&mut commands).await;
        }
        commands.finish().await
    }

    async fn record_overlaps(&self, commands: &mut Commands<'_>) {
        let b = &*self.buffers;
        let inputs = [&b.points, &b.candidates, &b.grid, &b.places];
        let outputs = [&b.mirror_heads, &b.mirror_links, &b.counters, &b.curves];
        let kernel = self.kernels.get("selection_overlaps");
        let buffers = [&inputs[..], &outputs].concat();
        commands.run(kernel, &buffers, [0; 4], self.params.candidates).await;
    }

    /// Records who discards contested candidates.
    async fn record_contested(&self, commands: &mut Commands<'_>) {
        let b = &*self.buffers;
        let (graph, list) = ([&b.candidates, &b.fans, &b.of_slot], [&b.waiting, &b.rounds]);
        let kernel = self.kernels.get("selection_contested");
        let buffers = [&graph[..], &[&b.first_candidates], &list, &[&b.counters]].concat();
        commands.run(kernel, &buffers, [0; 4], self.params.candidates).await;
        self.record_round(commands, 1).await;
        let outputs = [&b.mirror_heads, &b.mirror_links, &b.counters];
        let links = self.kernels.get("selection_links");
        let links = commands.bind(links, &[&graph[..], &list, &outputs].concat());
        commands.dispatch_indirect(&links, [0; 4], &b.workgroups, self.waiting_for(1)).await;
    }

    /// About how many candidates wait for a round. Up to a third are contested, on random points; of them few wait for
    /// others.
    fn waiting_for(&self, round: u32) -> u32 {
        if self.asks_contested_alone && round == 1 { self.params.candidates / 8 } else { 0 }
    }

    /// Prepares a round.
    async fn record_round(&self, commands: &mut Commands<'_>, round: u32) {
        let b = &*self.buffers;
        let row = self.gpu.device.limits().max_compute_workgroups_per_dimension;
        let buffers = [&b.rounds, &b.workgroups];
        commands.run(self.kernels.get("selection_round"), &buffers, [round, row, 0, 0], 1).await;
    }

    /// Some rounds, and what one workgroup can do of the others. Returns the counters and how many candidates are left.
    async fn run_selection(&self, rounds: Range<u32>) -> Result<(Counters, u32), Error> {
        let b = &*self.buffers;
        let mut commands = self.commands();
        let graph = [&b.candidates, &b.mirror_heads, &b.mirror_links];
        let state = [&b.waiting, &b.rounds, &b.counters];
        let buffers = [&graph[..], &state].concat();
        let round = commands.bind(self.kernels.get("selection"), &buffers);
        for i in rounds.clone() {
            if i == 0 {
                commands.dispatch(&round, [0; 4], self.params.candidates).await;
                continue;
            }
            self.record_round(&mut commands, i).await;
            let about = self.waiting_for(i);
            commands.dispatch_indirect(&round, [i, 0, 0, 0], &b.workgroups, about).await;
        }
        let tail = self.kernels.get("selection_tail");
        commands.run(tail, &buffers, [rounds.end, 0, 0, 0], 1).await;
        commands.finish().await?;
        let (counters, waiting) = self.read(&[(&b.rounds, rounds.end % 2)]).await?;
        Ok((counters, waiting[0]))
    }

    /// Records the radii and the numbers of the new points.
    async fn record_radii(&self) -> Result<(), Error> {
        let b = &*self.buffers;
        let (points, candidates) = (self.params.points, self.params.candidates);
        let mut commands = self.commands();
        commands.clear(&b.next_radii, 2 * u64::from(points) + u64::from(candidates));
        // Nobody waits any more.
        let links = [&b.candidates, &b.mirror_heads, &b.mirror_links, &b.waiting, &b.counters];
        let stand_in = self.kernels.get("selection_stand_in");
        commands.run(stand_in, &links, [0; 4], candidates).await;
        let inputs = [&b.points, &b.fans, &b.of_slot, &b.candidates];
        // The numbers of candidates by slot are with the slots' candidates now.
        let outputs = [&b.waiting, &b.next_radii, &b.numbers, &b.counters];
        let buffers = [&inputs[..], &outputs].concat();
        commands.run(self.kernels.get("selection_radii"), &buffers, [0; 4], points).await;
        self.record_new_indices(&mut commands).await;
        commands.finish().await
    }
}
