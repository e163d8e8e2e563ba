//! Radii that cover the next level's rings (ours).

use crate::Error;
use crate::buffers::Buffer;
use crate::records::Counters;
use crate::sizing::words_of;
use crate::step::{Buffers, NEXT_RING, Step};

impl Step<'_> {
    /// `next_ring`. `before` are the counters of the stage that said which points have long rows.
    pub(crate) async fn next_ring(&mut self, before: &Counters) -> Result<(), Error> {
        fn with<'b>(b: &'b Buffers, around: &'b Buffer) -> Vec<&'b Buffer> {
            let inputs = [&b.points, &b.fans, &b.ring_entries, &b.candidates, around];
            [&inputs[..], &[&b.next_radii, &b.arena, &b.counters, &b.curves]].concat()
        }
        if !self.next_ring {
            return Ok(());
        }
        // The selection has left N' in the place of the numbers by slot.
        let buffers: fn(&Buffers) -> Vec<&Buffer> =
            if self.largest_first { |b| with(b, &b.numbers) } else { |b| with(b, &b.around) };
        let n = self.params.points;
        let mut commands = self.commands();
        commands.clear(&self.buffers.counters, words_of(&self.buffers.counters).into());
        commands.run(self.kernels.get("next_ring"), &buffers(self.buffers), [0, n, 0, 0], n).await;
        commands.finish().await?;
        if before.left_over & NEXT_RING != 0 {
            // Radii are maxima: a second run adds what the first one left out.
            self.run_large("next_ring_large", buffers, before.longest_row).await?;
        }
        self.counters().await.map(|_| ())
    }
}
