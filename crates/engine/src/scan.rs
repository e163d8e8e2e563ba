//! Prefix sums and counting sorts on the device, from the kernels `scan_sum`, `scan_add` and `sort_fill`.

use crate::buffers::Buffer;
use crate::commands::Commands;
use crate::kernel::Kernel;
use crate::{Error, Gpu};

/// Values that one invocation sums up; the kernels count on it.
const BLOCK: u32 = 64;

/// Sums of blocks, of blocks of blocks and so on: six layers serve 2^36 values.
#[derive(Debug)]
pub(crate) struct Scan {
    sums: Vec<Buffer>,
}

impl Scan {
    pub(crate) fn new(gpu: &Gpu) -> Result<Self, Error> {
        let layers = (0..6).map(|_| Buffer::new(gpu, "block sums", 0));
        Ok(Self { sums: layers.collect::<Result<_, _>>()? })
    }

    /// Makes room for prefix sums of up to `count` values.
    pub(crate) fn reserve(&mut self, gpu: &Gpu, count: u32) -> Result<(), Error> {
        let mut blocks = count;
        for layer in &mut self.sums {
            blocks = blocks.div_ceil(BLOCK);
            layer.reserve(gpu, 4 * u64::from(blocks))?;
        }
        Ok(())
    }

    /// Records the inclusive prefix sum of `count` values from `first` on, in place.
    pub(crate) async fn record(
        &self,
        commands: &mut Commands<'_>,
        kernels: (&Kernel, &Kernel),
        values: &Buffer,
        first: u32,
        count: u32,
    ) {
        let (sum, add) = kernels;
        let mut layers = vec![(values, first, count)];
        let mut blocks = count;
        for layer in &self.sums {
            if blocks <= BLOCK {
                break;
            }
            blocks = blocks.div_ceil(BLOCK);
            layers.push((layer, 0, blocks));
        }
        for pair in layers.windows(2) {
            let ((from, first, count), (to, _, blocks)) = (pair[0], pair[1]);
            commands.run(sum, &[from, to], [first, count, 0, 0], blocks).await;
        }
        for (i, &(layer, first, count)) in layers.iter().enumerate().rev() {
            // The last layer has one block, which reads no sums.
            let blocks = count.div_ceil(BLOCK);
            commands.run(add, &[layer, &self.sums[i]], [first, count, 0, 0], blocks).await;
        }
    }
}
