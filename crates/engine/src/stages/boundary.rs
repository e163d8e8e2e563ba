//! The gaps of rings that may lie on boundaries (section 6).

use crate::Error;
use crate::sizing::{WORD, items_of};
use crate::step::Step;
use surfine_features::Gap;

impl Step<'_> {
    /// The widest gaps of the rings, of those wider than an angle in radians, by point.
    /// `room` is how many of them are provided for.
    pub(crate) async fn boundary_gaps(
        &mut self,
        theta_b: f32,
        room: u64,
    ) -> Result<Vec<Gap>, Error> {
        self.buffers.gaps.reserve(self.gpu, 4 * WORD * room)?;
        self.buffers.gap_count.reserve(self.gpu, WORD)?;
        let count = loop {
            let b = &*self.buffers;
            let room = items_of(&b.gaps, 4);
            let mut commands = self.commands();
            commands.clear(&b.gap_count, 1);
            let buffers = [&b.fans, &b.ring_entries, &b.gaps, &b.gap_count];
            let words = [theta_b.to_bits(), room, 0, 0];
            let kernel = self.kernels.get("boundary_gaps");
            commands.run(kernel, &buffers, words, self.params.points).await;
            commands.finish().await?;
            let count = self.uniforms.read(self.gpu, &[(b.gap_count.raw(), 0, WORD)]).await?;
            let count: u32 = bytemuck::pod_read_unaligned(&count);
            if count <= room {
                break count;
            }
            self.buffers.gaps.reserve(self.gpu, 4 * WORD * u64::from(count))?;
        };
        let bytes = 4 * WORD * u64::from(count);
        let words = self.uniforms.read(self.gpu, &[(self.buffers.gaps.raw(), 0, bytes)]).await?;
        let words: Vec<[u32; 4]> = bytemuck::pod_collect_to_vec(&words);
        let gap = |[point, begin, end, angle]: [u32; 4]| Gap {
            point,
            begin,
            end,
            angle: f32::from_bits(angle),
        };
        let mut gaps: Vec<Gap> = words.into_iter().map(gap).collect();
        gaps.sort_unstable_by_key(|gap| gap.point);
        Ok(gaps)
    }
}
