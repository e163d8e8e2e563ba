//! A refinement step on the device: its buffers and kernels, and what all of its stages do. The stages are in
//! `stages/`.
//!
//! Nothing that grows with the cloud is read back, but for the gaps of possible boundary points: only [`Counters`],
//! ring and class totals and the number of new points, since buffers are sized on the host. A stage whose buffers turn
//! out too small runs again with larger ones.

use crate::buffers::Buffer;
use crate::commands::Commands;
use crate::curves::Curves;
use crate::kernel::Kernel;
use crate::records::{ARENA_BLOCK, Counters, Params};
use crate::scan::Scan;
use crate::shaders::SHADERS;
use crate::sizing::{Sizing, WORD, counted, words_of};
use crate::uniforms::Uniforms;
use crate::{Error, Gpu};
use surfine_points::{Neighborhood, RefineParams};

/// Values of the kernels' `override`s.
pub type Constants = Vec<(&'static str, f64)>;

/// The values of the kernels' `override`s that parameters ask for, for levels with such curves.
pub fn constants(params: &RefineParams, curves: Curves) -> Constants {
    let accurate = params.effective_neighborhood() == Neighborhood::Accurate;
    let plain_angle = params.effective_plain_angle();
    let modes =
        [("accurate", accurate), ("simplified", params.simplified), ("plain_angle", plain_angle)];
    let kinds =
        [("with_curves", curves != Curves::None), ("with_creases", curves == Curves::Creases)];
    let modes = modes.into_iter().chain(kinds);
    // The host splits the curves.
    let rules = params.effective_rules();
    let rules = rules.named().into_iter().filter(|(name, _)| *name != "even_steps");
    let all = modes.chain(rules);
    all.map(|(name, on)| (name, f64::from(on))).collect()
}

/// The kernels of a device for one set of constants.
#[derive(Debug)]
pub(crate) struct Kernels(Vec<Kernel>);

impl Kernels {
    pub(crate) fn new(gpu: &Gpu, constants: &Constants) -> Result<Self, Error> {
        Ok(Self(SHADERS.iter().map(|s| Kernel::new(gpu, s, constants)).collect::<Result<_, _>>()?))
    }

    pub(crate) fn get(&self, name: &str) -> &Kernel {
        self.0.iter().find(|k| k.name() == name).expect("every kernel of a stage is in the table")
    }
}

/// Declares the buffers of a step with their labels.
macro_rules! buffers {
    ($($(#[$doc:meta])* $name:ident: $label:literal,)*) => {
        /// Device memory of a step; used again for the next step and the next cloud.
        #[derive(Debug)]
        pub(crate) struct Buffers {
            $($(#[$doc])* pub(crate) $name: Buffer,)*
        }

        impl Buffers {
            pub(crate) fn new(gpu: &Gpu) -> Result<Self, Error> {
                Ok(Self { $($name: Buffer::new(gpu, $label, 0)?,)* })
            }

            /// Bytes of all buffers.
            pub(crate) fn size(&self) -> u64 {
                0 $(+ self.$name.size())*
            }
        }
    };
}

buffers! {
    points: "points",
    parents: "parents",
    /// First entry of each cell: of the points, later of the candidates.
    grid: "grid cells",
    /// The entries.
    places: "grid entries",
    /// Cell and rank of each item of a counting sort.
    cells: "cells",
    fans: "fans",
    ring_entries: "ring entries",
    /// The candidate of each slot.
    of_slot: "candidates of slots",
    numbers: "numbers of candidates",
    first_candidates: "first candidates",
    candidates: "candidates",
    /// Lists of candidates around points and of conflicts.
    around: "candidates around points",
    /// Links of conflicts to the point that did not find them, or of candidates to those that discard them.
    mirror_heads: "heads of links",
    mirror_links: "links",
    classes: "classes",
    /// Points without a class, or candidates that are not decided, and their number.
    waiting: "waiting",
    rounds: "numbers of those who wait",
    workgroups: "workgroups",
    class_members: "class members",
    next_radii: "radii",
    new_indices: "new indices",
    /// Scratch memory of points with many neighbours.
    arena: "long rows",
    counters: "counters",
    /// Creases and boundaries.
    curves: "curves",
    /// Points whose rings leave wide gaps, and their number.
    gaps: "boundary gaps",
    gap_count: "boundary gap count",
}

/// One refinement step on the device.
pub(crate) struct Step<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) kernels: &'a Kernels,
    pub(crate) uniforms: &'a Uniforms,
    pub(crate) buffers: &'a mut Buffers,
    pub(crate) scan: &'a mut Scan,
    pub(crate) sizing: &'a Sizing,
    /// Whether new points are selected among all candidates.
    pub(crate) largest_first: bool,
    /// Whether contested candidates alone are asked who discards them.
    pub(crate) asks_contested_alone: bool,
    /// Whether radii cover the next level's rings.
    pub(crate) next_ring: bool,
    pub(crate) params: Params,
    /// New points that this step puts on creases and boundaries.
    pub(crate) curve_points: u32,
}

// Bits of `Counters::left_over`: the kernels that leave points to their variant with rows in the arena.
pub(crate) const NEIGHBORHOOD: u32 = 1;
pub(crate) const CONFLICTS: u32 = 2;
pub(crate) const INSERTION: u32 = 4;
pub(crate) const NEXT_RING: u32 = 8;

impl Step<'_> {
    pub(crate) fn commands(&self) -> Commands<'_> {
        self.uniforms.set(self.gpu, &self.params);
        Commands::new(self.gpu, self.uniforms)
    }

    pub(crate) async fn record_scan(
        &self,
        commands: &mut Commands<'_>,
        values: &Buffer,
        first: u32,
        count: u32,
    ) {
        let kernels = (self.kernels.get("scan_sum"), self.kernels.get("scan_add"));
        self.scan.record(commands, kernels, values, first, count).await;
    }

    /// Reads the counters and single words (buffer, index).
    pub(crate) async fn read(
        &self,
        words: &[(&Buffer, u32)],
    ) -> Result<(Counters, Vec<u32>), Error> {
        let size = size_of::<Counters>() as u64;
        let mut parts = vec![(self.buffers.counters.raw(), 0, size)];
        parts.extend(words.iter().map(|(buffer, i)| (buffer.raw(), WORD * u64::from(*i), WORD)));
        let bytes = self.uniforms.read(self.gpu, &parts).await?;
        let (counters, words) = bytes.split_at(size as usize);
        let counters: Counters = bytemuck::pod_read_unaligned(counters);
        if counters.cut_loops > 0 {
            return Err(self.crowded(counters.cut_loops as usize - 1));
        }
        Ok((counters, bytemuck::pod_collect_to_vec(words)))
    }

    /// Reads the counters alone.
    pub(crate) async fn counters(&self) -> Result<Counters, Error> {
        Ok(self.read(&[]).await?.0)
    }

    /// The error that names a record whose neighbors are too many.
    fn crowded(&self, record: usize) -> Error {
        let (level, adapter) = (self.params.level, self.gpu.name.clone());
        Error::Crowded { vertex: Some(record), level, adapter }
    }

    /// The bytes of a list of so many entries.
    ///
    /// # Errors
    /// Kernels cannot count that many.
    pub(crate) fn countable(
        &self,
        what: &'static str,
        entry: u64,
        entries: u64,
    ) -> Result<u64, Error> {
        let (need, have) = (entry.saturating_mul(entries), entry * u64::from(u32::MAX));
        if need > have {
            return Err(Error::Limit { what, need, have, adapter: self.gpu.name.clone() });
        }
        Ok(need)
    }

    /// Whether there was room for all links; else makes it.
    pub(crate) fn make_room_for_links(
        &mut self,
        what: &'static str,
        counters: &Counters,
    ) -> Result<bool, Error> {
        let links = counted(counters.mirrored, counters.mirrored_high);
        if links <= self.params.mirror_links.into() {
            return Ok(true);
        }
        let bytes = self.countable(what, 2 * WORD, links)?;
        self.buffers.mirror_links.reserve(self.gpu, bytes)?;
        Ok(false)
    }

    pub(crate) fn cells(&self) -> u32 {
        1 << self.params.bits.iter().sum::<u32>()
    }

    /// Runs the variant of a kernel with rows in the arena for what was left over, in parts that fit there.
    /// `longest_row` is the longest row that will be, as far as it is known.
    pub(crate) async fn run_large(
        &mut self,
        kernel: &str,
        buffers: fn(&Buffers) -> Vec<&Buffer>,
        longest_row: u32,
    ) -> Result<Counters, Error> {
        let n = self.params.points;
        let mut chunk = n.clamp(1, self.sizing.chunk_of(longest_row));
        loop {
            self.params.arena_words = words_of(&self.buffers.arena);
            let mut commands = self.commands();
            commands.clear_range(&self.buffers.counters, 0, 2);
            let bound = commands.bind(self.kernels.get(kernel), &buffers(self.buffers));
            for first in (0..n).step_by(chunk as usize) {
                let count = chunk.min(n - first);
                commands.clear_range(&self.buffers.counters, 0, 1);
                commands.dispatch(&bound, [first, count, 0, 0], count).await;
            }
            commands.finish().await?;
            let counters = self.counters().await?;
            if self.make_room_in_arena(&counters, &mut chunk)? {
                return Ok(counters);
            }
        }
    }

    /// Whether the arena sufficed; else makes it larger, or `part` smaller where no larger one fits in a binding.
    pub(crate) fn make_room_in_arena(
        &mut self,
        counters: &Counters,
        part: &mut u32,
    ) -> Result<bool, Error> {
        let need = WORD * u64::from(ARENA_BLOCK) * u64::from(counters.arena_peak);
        if need <= WORD * u64::from(self.params.arena_words) {
            return Ok(true);
        }
        if need <= self.gpu.largest_binding() {
            self.buffers.arena.reserve(self.gpu, need)?;
        } else if *part > 1 {
            *part = part.div_ceil(2);
        } else {
            let (what, have) = ("neighbors of one point", self.gpu.largest_binding());
            return Err(Error::Limit { what, need, have, adapter: self.gpu.name.clone() });
        }
        Ok(false)
    }
}
