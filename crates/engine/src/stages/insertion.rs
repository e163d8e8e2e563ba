//! By the paper's loop: the new points around each point, class by class (section 5, eq. 5, 10 and 11).

use crate::Error;
use crate::records::Params;
use crate::sizing::{WORD, radii, words_of};
use crate::step::{INSERTION, Step};

impl Step<'_> {
    /// `insertion`, class by class. `starts` is what [`Step::coloring`] returned, `left_over` says what
    /// [`Step::conflicts`] left over. Returns the number of new points.
    pub(crate) async fn insertion(&mut self, starts: &[u32], left_over: u32) -> Result<u32, Error> {
        let (n, candidates) = (u64::from(self.params.points), u64::from(self.params.candidates));
        self.buffers.next_radii.reserve(self.gpu, WORD * radii(n, candidates))?;
        self.buffers.new_indices.reserve(self.gpu, WORD * (candidates + 1))?;
        self.scan.reserve(self.gpu, self.params.candidates + 1)?;
        let largest = starts.windows(2).map(|bounds| bounds[1] - bounds[0]).max().unwrap_or(1);
        let mut part = largest.clamp(1, self.sizing.part);
        loop {
            self.params.arena_words = words_of(&self.buffers.arena);
            self.record_insertion(starts, part, left_over & INSERTION != 0).await?;
            let last = self.params.candidates;
            let (counters, totals) = self.read(&[(&self.buffers.new_indices, last)]).await?;
            if self.make_room_in_arena(&counters, &mut part)? {
                return Ok(totals[0]);
            }
            // The run that lacked memory has left marks on the candidates.
            let mut commands = self.commands();
            self.record_candidates(&mut commands).await;
            commands.finish().await?;
        }
    }

    async fn record_insertion(
        &self,
        starts: &[u32],
        part: u32,
        has_large: bool,
    ) -> Result<(), Error> {
        let b = &*self.buffers;
        let Params { points, candidates, .. } = self.params;
        let mut commands = self.commands();
        commands.clear(&b.counters, words_of(&b.counters).into());
        commands.clear(&b.next_radii, 2 * u64::from(points) + u64::from(candidates));
        let inputs = [&b.points, &b.fans, &b.of_slot, &b.candidates, &b.around, &b.class_members];
        let outputs = [&b.next_radii, &b.arena, &b.counters, &b.curves];
        let buffers = [&inputs[..], &outputs].concat();
        let insertion = commands.bind(self.kernels.get("insertion"), &buffers);
        let large = has_large.then(|| commands.bind(self.kernels.get("insertion_large"), &buffers));
        let classes = starts.len() as u32 - 1;
        for (class, bounds) in (1..).zip(starts.windows(2)) {
            let count = bounds[1] - bounds[0];
            commands.dispatch(&insertion, [class, bounds[0], count, classes], count).await;
            let Some(large) = &large else { continue };
            for first in (bounds[0]..bounds[1]).step_by(part as usize) {
                let count = part.min(bounds[1] - first);
                commands.clear_range(&b.counters, 0, 1);
                commands.dispatch(large, [class, first, count, classes], count).await;
            }
        }
        self.record_new_indices(&mut commands).await;
        commands.finish().await
    }
}
