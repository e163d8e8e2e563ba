//! By the paper's loop: what is around each point, and which points may not be refined together (ours).

use crate::Error;
use crate::buffers::Buffer;
use crate::records::Counters;
use crate::sizing::{WORD, counted, words_of};
use crate::stages::candidates::WIDEST;
use crate::step::{Buffers, CONFLICTS, Step};

impl Step<'_> {
    /// `conflicts`: the candidates by cell, then what is around each point, and the conflict graph.
    pub(crate) async fn conflicts(&mut self) -> Result<Counters, Error> {
        fn buffers(b: &Buffers) -> Vec<&Buffer> {
            let inputs = [&b.points, &b.fans, &b.of_slot, &b.candidates, &b.grid, &b.places];
            [&inputs[..], &[&b.around, &b.arena, &b.counters, &b.curves]].concat()
        }
        self.grid_candidates().await?;
        let n = self.params.points;
        let entries = self.sizing.around_entries(n.into());
        self.buffers.around.reserve(self.gpu, WORD * entries)?;
        loop {
            self.params.around_entries = words_of(&self.buffers.around);
            let mut commands = self.commands();
            commands.clear(&self.buffers.counters, WIDEST);
            let kernel = self.kernels.get("conflicts");
            commands.run(kernel, &buffers(self.buffers), [0, n, 0, 0], n).await;
            commands.finish().await?;
            let mut counters = self.counters().await?;
            if counters.left_over & CONFLICTS != 0 {
                counters = self.run_large("conflicts_large", buffers, counters.longest_row).await?;
            }
            let entries = counted(counters.around, counters.around_high);
            if entries <= self.params.around_entries.into() {
                return Ok(counters);
            }
            let bytes = self.countable("lists of candidates around points", WORD, entries)?;
            self.buffers.around.reserve(self.gpu, bytes)?;
        }
    }
}
