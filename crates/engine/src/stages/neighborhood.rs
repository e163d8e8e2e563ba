//! The rings (sections 3 and 4).

use crate::Error;
use crate::buffers::Buffer;
use crate::records::{Counters, Fan};
use crate::sizing::{WORD, items_of, words_of};
use crate::step::{Buffers, NEIGHBORHOOD, Step};

impl Step<'_> {
    /// `neighborhood`: the rings. Returns the counters.
    pub(crate) async fn neighborhood(&mut self) -> Result<Counters, Error> {
        fn buffers(b: &Buffers) -> Vec<&Buffer> {
            vec![
                &b.points,
                &b.grid,
                &b.places,
                &b.fans,
                &b.ring_entries,
                &b.arena,
                &b.counters,
                &b.curves,
            ]
        }
        let n = self.params.points;
        self.buffers.fans.reserve(self.gpu, size_of::<Fan>() as u64 * u64::from(n))?;
        let entries = self.sizing.ring_entries(n.into());
        self.buffers.ring_entries.reserve(self.gpu, 2 * WORD * entries)?;
        loop {
            self.params.ring_entries = items_of(&self.buffers.ring_entries, 2);
            let mut commands = self.commands();
            commands.clear(&self.buffers.counters, words_of(&self.buffers.counters).into());
            let kernel = self.kernels.get("neighborhood");
            commands.run(kernel, &buffers(self.buffers), [0, n, 0, 0], n).await;
            commands.finish().await?;
            let mut counters = self.counters().await?;
            if counters.left_over & NEIGHBORHOOD != 0 {
                counters =
                    self.run_large("neighborhood_large", buffers, counters.longest_row).await?;
            }
            if counters.slots <= self.params.ring_entries {
                self.params.slots = counters.slots;
                return Ok(counters);
            }
            self.buffers.ring_entries.reserve(self.gpu, 2 * WORD * u64::from(counters.slots))?;
        }
    }
}
