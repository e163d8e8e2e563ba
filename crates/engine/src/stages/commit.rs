//! The new points join the cloud (section 2).

use crate::Error;
use crate::commands::Commands;
use crate::records::Point;
use crate::sizing::WORD;
use crate::step::Step;

impl Step<'_> {
    /// Records the numbering of the new points.
    pub(crate) async fn record_new_indices(&self, commands: &mut Commands<'_>) {
        let (b, candidates) = (&*self.buffers, self.params.candidates);
        commands.clear(&b.new_indices, 1);
        let count = self.kernels.get("commit_count");
        commands.run(count, &[&b.candidates, &b.new_indices], [0; 4], candidates).await;
        self.record_scan(commands, &b.new_indices, 0, candidates + 1).await;
    }

    /// `commit`: appends the new points; `earlier` is the number of new points of earlier steps.
    pub(crate) async fn commit(&mut self, new: u32, earlier: u32) -> Result<(), Error> {
        let point = size_of::<Point>() as u64;
        let n = u64::from(self.params.points);
        self.buffers.points.grow(self.gpu, point * (n + u64::from(new)), point * n)?;
        let kept = 3 * WORD * u64::from(earlier);
        self.buffers.parents.grow(self.gpu, kept + 3 * WORD * u64::from(new), kept)?;
        let b = &*self.buffers;
        let mut commands = self.commands();
        let inputs = [&b.points, &b.candidates, &b.new_indices, &b.next_radii];
        let kernel = self.kernels.get("commit");
        let buffers = [&inputs[..], &[&b.parents, &b.curves]].concat();
        let invocations = self.params.points.max(self.params.candidates);
        commands.run(kernel, &buffers, [earlier, 0, 0, 0], invocations).await;
        commands.finish().await
    }
}
