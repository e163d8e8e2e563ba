//! The possible new points of all fans (section 5, eq. 12).

use crate::Error;
use crate::commands::Commands;
use crate::records::{Candidate, Counters};
use crate::sizing::WORD;
use crate::step::Step;
use std::mem::offset_of;

/// The word of [`Counters`] that `candidates` leaves to `conflicts`.
pub(super) const WIDEST: u64 = offset_of!(Counters, widest) as u64 / WORD;

impl Step<'_> {
    /// `candidates` of all fans.
    pub(crate) async fn candidates(&mut self) -> Result<(), Error> {
        let (n, slots) = (self.params.points, self.params.slots);
        self.buffers.of_slot.reserve(self.gpu, WORD * u64::from(slots))?;
        self.buffers.numbers.reserve(self.gpu, WORD * u64::from(slots))?;
        self.buffers.first_candidates.reserve(self.gpu, WORD * (u64::from(n) + 1))?;
        self.scan.reserve(self.gpu, n + 1)?;
        let b = &*self.buffers;
        let mut commands = self.commands();
        commands.clear(&b.first_candidates, 1);
        let buffers =
            [&b.points, &b.fans, &b.ring_entries, &b.of_slot, &b.first_candidates, &b.curves];
        commands.run(self.kernels.get("candidates_home"), &buffers, [0; 4], n).await;
        self.record_scan(&mut commands, &b.first_candidates, 0, n + 1).await;
        commands.finish().await?;
        let (_, totals) = self.read(&[(&b.first_candidates, n)]).await?;
        self.params.triangles = totals[0];
        self.params.candidates = totals[0] + self.curve_points;
        let bytes = size_of::<Candidate>() as u64 * u64::from(self.params.candidates);
        self.buffers.candidates.reserve(self.gpu, bytes)?;
        let b = &*self.buffers;
        let mut commands = self.commands();
        let inputs = [&b.fans, &b.ring_entries, &b.of_slot, &b.first_candidates];
        let outputs = [&b.numbers, &b.candidates];
        let kernel = self.kernels.get("candidates_number");
        commands.run(kernel, &[&inputs[..], &outputs].concat(), [0; 4], n).await;
        let link = self.kernels.get("candidates_link");
        commands.run(link, &[&b.numbers, &b.of_slot], [0; 4], slots).await;
        self.record_candidates(&mut commands).await;
        commands.finish().await
    }

    pub(super) async fn record_candidates(&self, commands: &mut Commands<'_>) {
        let b = &*self.buffers;
        let buffers = [&b.points, &b.fans, &b.candidates, &b.counters, &b.curves];
        commands.clear_range(&b.counters, WIDEST, 1);
        commands
            .run(self.kernels.get("candidates"), &buffers, [0; 4], self.params.candidates)
            .await;
    }
}
