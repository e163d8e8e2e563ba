//! Points and candidates by cell (section 7).

use crate::Error;
use crate::sizing::WORD;
use crate::step::Step;

/// Words of four from one item to the next of those that are sorted.
const POINT_STRIDE: u32 = 2;
const CANDIDATE_STRIDE: u32 = 3;

impl Step<'_> {
    /// `grid` of the points.
    pub(crate) async fn grid_points(&mut self) -> Result<(), Error> {
        self.sort_into_grid(self.params.points, POINT_STRIDE).await
    }

    /// The same of the candidates.
    pub(super) async fn grid_candidates(&mut self) -> Result<(), Error> {
        self.sort_into_grid(self.params.candidates, CANDIDATE_STRIDE).await
    }

    /// Sorts points or candidates by cell.
    async fn sort_into_grid(&mut self, items: u32, stride: u32) -> Result<(), Error> {
        let cells = self.cells();
        self.buffers.grid.reserve(self.gpu, WORD * (u64::from(cells) + 1))?;
        self.buffers.places.reserve(self.gpu, 4 * WORD * u64::from(items))?;
        self.buffers.cells.reserve(self.gpu, 2 * WORD * u64::from(items))?;
        self.scan.reserve(self.gpu, cells + 1)?;
        let b = &*self.buffers;
        let from = if stride == POINT_STRIDE { &b.points } else { &b.candidates };
        let words = [items, stride, 0, 0];
        let mut commands = self.commands();
        commands.clear(&b.grid, u64::from(cells) + 1);
        commands
            .run(self.kernels.get("grid_count"), &[from, &b.grid, &b.cells], words, items)
            .await;
        self.record_scan(&mut commands, &b.grid, 0, cells + 1).await;
        let fill = self.kernels.get("grid_fill");
        commands.run(fill, &[from, &b.cells, &b.grid, &b.places], words, items).await;
        commands.finish().await
    }
}
