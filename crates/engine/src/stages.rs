//! The stages of one refinement step, as dispatches of their kernels.
//!
//! Nothing that grows with the cloud is read back, but for the gaps of possible boundary points: only [`Counters`], ring and class totals and the number of new
//! points, since buffers are sized on the host. A stage whose buffers turn out too small runs again with larger ones.

use crate::buffers::Buffer;
use crate::commands::Commands;
use crate::curves::Curves;
use crate::kernel::Kernel;
use crate::records::{Candidate, Counters, Fan, Params, Point};
use crate::scan::Scan;
use crate::shaders::SHADERS;
use crate::uniforms::Uniforms;
use crate::{Error, Gpu};
use std::mem::offset_of;
use std::ops::Range;
use surfine_features::Gap;
use surfine_points::{Neighborhood, RefineParams};

/// Ranges of priorities, as in `shaders/shared/priority.wgsl`: as many rounds of colouring have points that were not there before.
const RANGES: u32 = 32;
/// Bytes of a word.
pub(crate) const WORD: u64 = 4;

/// How much is done and provided for at once. No result depends on it.
#[derive(Clone, Copy, Debug)]
pub struct Sizing {
    /// Points that share the arena: those after them use it again.
    pub chunk: u32,
    /// Points of a class that are refined together.
    pub part: u32,
    /// Entries of lists that are provided for each point before their need is known.
    pub entries: u32,
    /// Rounds of the selection, or of the colouring, that are recorded together.
    pub rounds: u32,
}

impl Default for Sizing {
    fn default() -> Self {
        Self { chunk: 1 << 17, part: u32::MAX, entries: 18, rounds: 8 }
    }
}

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

/// The word of [`Counters`] that `candidates` leaves to `conflicts`.
const WIDEST: u64 = offset_of!(Counters, widest) as u64 / WORD;
/// Words of four from one item to the next of those that are sorted by cell.
const POINT_STRIDE: u32 = 2;
pub(crate) const CANDIDATE_STRIDE: u32 = 3;

// Bits of `Counters::left_over`: the kernels that leave points to their variant with rows in the arena.
const NEIGHBORHOOD: u32 = 1;
const CONFLICTS: u32 = 2;
const INSERTION: u32 = 4;
const NEXT_RING: u32 = 8;

impl Step<'_> {
    pub(crate) fn commands(&self) -> Commands<'_> {
        self.uniforms.set(self.gpu, &self.params);
        Commands::new(self.gpu, self.uniforms)
    }

    async fn record_scan(
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
            return Err(self.crowded(counters.cut_loops as usize - 1, counters.longest_row));
        }
        Ok((counters, bytemuck::pod_collect_to_vec(words)))
    }

    /// Reads the counters alone.
    async fn counters(&self) -> Result<Counters, Error> {
        Ok(self.read(&[]).await?.0)
    }

    /// The error that names a point whose neighbours are too many.
    fn crowded(&self, point: usize, neighbors: u32) -> Error {
        Error::Crowded {
            point,
            neighbors,
            level: self.params.level,
            adapter: self.gpu.name.clone(),
        }
    }

    fn cells(&self) -> u32 {
        1 << self.params.bits.iter().sum::<u32>()
    }

    /// `grid` of the points.
    pub(crate) async fn grid_points(&mut self) -> Result<(), Error> {
        self.sort_into_grid(self.params.points, POINT_STRIDE).await
    }

    /// Sorts points or candidates by cell.
    pub(crate) async fn sort_into_grid(&mut self, items: u32, stride: u32) -> Result<(), Error> {
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

    /// Runs the variant of a kernel with rows in the arena for what was left over, in parts that fit there.
    async fn run_large(
        &mut self,
        kernel: &str,
        buffers: fn(&Buffers) -> Vec<&Buffer>,
    ) -> Result<Counters, Error> {
        let n = self.params.points;
        let mut chunk = n.clamp(1, self.sizing.chunk);
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
    fn make_room_in_arena(&mut self, counters: &Counters, part: &mut u32) -> Result<bool, Error> {
        if counters.arena_peak <= self.params.arena_words {
            return Ok(true);
        }
        let need = WORD * u64::from(counters.arena_peak);
        if need <= self.gpu.largest_binding() {
            self.buffers.arena.reserve(self.gpu, need)?;
        } else if *part > 1 {
            *part = part.div_ceil(2);
        } else {
            let (what, have) = ("neighbours of one point", self.gpu.largest_binding());
            return Err(Error::Limit { what, need, have, adapter: self.gpu.name.clone() });
        }
        Ok(false)
    }

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
        let entries = u64::from(self.sizing.entries.min(7)) * u64::from(n);
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
                counters = self.run_large("neighborhood_large", buffers).await?;
            }
            if counters.slots <= self.params.ring_entries {
                self.params.slots = counters.slots;
                return Ok(counters);
            }
            self.buffers.ring_entries.reserve(self.gpu, 2 * WORD * u64::from(counters.slots))?;
        }
    }

    /// The widest gaps of the rings (section 6), of those wider than an angle in radians, by point.
    pub(crate) async fn boundary_gaps(&mut self, theta_b: f32) -> Result<Vec<Gap>, Error> {
        let room = self.params.points / 16 + 1024;
        self.buffers.gaps.reserve(self.gpu, 4 * WORD * u64::from(room))?;
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

    async fn record_candidates(&self, commands: &mut Commands<'_>) {
        let b = &*self.buffers;
        let buffers = [&b.points, &b.fans, &b.candidates, &b.counters, &b.curves];
        commands.clear_range(&b.counters, WIDEST, 1);
        commands
            .run(self.kernels.get("candidates"), &buffers, [0; 4], self.params.candidates)
            .await;
    }

    /// `conflicts`: the candidates by cell, then what is around each point, and the conflict graph.
    pub(crate) async fn conflicts(&mut self) -> Result<Counters, Error> {
        fn buffers(b: &Buffers) -> Vec<&Buffer> {
            let inputs = [&b.points, &b.fans, &b.of_slot, &b.candidates, &b.grid, &b.places];
            [&inputs[..], &[&b.around, &b.arena, &b.counters, &b.curves]].concat()
        }
        self.sort_into_grid(self.params.candidates, CANDIDATE_STRIDE).await?;
        let n = self.params.points;
        let entries = 4 * u64::from(self.sizing.entries) / 3 * u64::from(n);
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
                counters = self.run_large("conflicts_large", buffers).await?;
            }
            if counters.around <= self.params.around_entries {
                return Ok(counters);
            }
            self.buffers.around.reserve(self.gpu, WORD * u64::from(counters.around))?;
        }
    }

    /// `coloring`: the classes, and the points by class. Returns the first member of each class and the end.
    pub(crate) async fn coloring(&mut self) -> Result<Vec<u32>, Error> {
        let n = self.params.points;
        self.buffers.classes.reserve(self.gpu, WORD * u64::from(n))?;
        self.buffers.mirror_heads.reserve(self.gpu, WORD * u64::from(n))?;
        self.buffers.waiting.reserve(self.gpu, 2 * WORD * u64::from(n))?;
        self.buffers.rounds.reserve(self.gpu, 2 * WORD)?;
        self.buffers.workgroups.reserve(self.gpu, 3 * WORD)?;
        let links = u64::from(self.sizing.entries) / 12 * u64::from(n);
        self.buffers.mirror_links.reserve(self.gpu, 2 * WORD * links)?;
        loop {
            self.params.mirror_links = items_of(&self.buffers.mirror_links, 2);
            self.record_mirror().await?;
            self.sort_by_priority().await?;
            let mut round = RANGES + self.sizing.rounds;
            let (mut counters, mut left) = self.run_rounds(0..round).await?;
            let links = counters.mirrored;
            if links > self.params.mirror_links {
                self.buffers.mirror_links.reserve(self.gpu, 2 * WORD * u64::from(links))?;
                continue;
            }
            while left > 0 {
                let next = round + self.sizing.rounds;
                (counters, left) = self.run_rounds(round..next).await?;
                round = next;
            }
            self.sort_by_class(counters.classes).await?;
            let bytes = WORD * (u64::from(counters.classes) + 1);
            let starts = self
                .uniforms
                .read(self.gpu, &[(self.buffers.class_members.raw(), 0, bytes)])
                .await?;
            return Ok(bytemuck::pod_collect_to_vec(&starts));
        }
    }

    async fn record_mirror(&self) -> Result<(), Error> {
        let b = &*self.buffers;
        let n = self.params.points;
        let mut commands = self.commands();
        commands.clear(&b.counters, words_of(&b.counters).into());
        commands.clear(&b.mirror_heads, n.into());
        commands.clear(&b.classes, n.into());
        let buffers = [&b.fans, &b.around, &b.mirror_heads, &b.mirror_links, &b.counters];
        commands.run(self.kernels.get("conflicts_mirror"), &buffers, [0; 4], n).await;
        commands.finish().await
    }

    async fn sort_by_priority(&mut self) -> Result<(), Error> {
        let n = self.params.points;
        self.reserve_members(RANGES)?;
        let b = &*self.buffers;
        let mut commands = self.commands();
        commands.clear(&b.rounds, 2);
        commands.clear(&b.class_members, u64::from(RANGES) + 1);
        let count = self.kernels.get("coloring_order");
        commands.run(count, &[&b.class_members, &b.cells], [0; 4], n).await;
        self.record_members(&mut commands, RANGES).await;
        commands.finish().await
    }

    /// Some rounds of colouring. Returns the counters and how many points are left.
    async fn run_rounds(&self, rounds: Range<u32>) -> Result<(Counters, u32), Error> {
        let b = &*self.buffers;
        let mut commands = self.commands();
        let graph = [&b.fans, &b.around, &b.mirror_heads, &b.mirror_links];
        let state = [&b.classes, &b.class_members, &b.waiting, &b.rounds, &b.counters];
        let round = commands.bind(self.kernels.get("coloring"), &[&graph[..], &state].concat());
        let prepare = [&b.rounds, &b.class_members, &b.workgroups];
        let prepare = commands.bind(self.kernels.get("coloring_round"), &prepare);
        let row = self.gpu.device.limits().max_compute_workgroups_per_dimension;
        for i in rounds.clone() {
            commands.dispatch(&prepare, [i, row, 0, 0], 1).await;
            // After the last range few wait.
            let about = if i < RANGES { self.params.points.div_ceil(RANGES) } else { 0 };
            commands.dispatch_indirect(&round, [i, 0, 0, 0], &b.workgroups, about).await;
        }
        commands.finish().await?;
        // Who waits after the last round waits for the next one.
        let (counters, waiting) = self.read(&[(&b.rounds, rounds.end % 2)]).await?;
        Ok((counters, waiting[0]))
    }

    async fn sort_by_class(&mut self, classes: u32) -> Result<(), Error> {
        let n = self.params.points;
        self.reserve_members(classes)?;
        let b = &*self.buffers;
        let mut commands = self.commands();
        commands.clear(&b.class_members, u64::from(classes) + 1);
        let count = self.kernels.get("class_count");
        commands.run(count, &[&b.classes, &b.class_members, &b.cells], [0; 4], n).await;
        self.record_members(&mut commands, classes).await;
        commands.finish().await
    }

    /// Makes room for the points by class, or by range of priorities.
    fn reserve_members(&mut self, classes: u32) -> Result<(), Error> {
        let n = self.params.points;
        let words = u64::from(classes) + 1 + u64::from(n);
        self.buffers.class_members.reserve(self.gpu, WORD * words)?;
        self.buffers.cells.reserve(self.gpu, 2 * WORD * u64::from(n))?;
        self.scan.reserve(self.gpu, classes + 1)
    }

    /// Records the second half of the sort by class.
    async fn record_members(&self, commands: &mut Commands<'_>, classes: u32) {
        let (b, n) = (&*self.buffers, self.params.points);
        self.record_scan(commands, &b.class_members, 0, classes + 1).await;
        let fill = self.kernels.get("sort_fill");
        commands.run(fill, &[&b.cells, &b.class_members], [n, classes, 0, 0], n).await;
    }

    /// `insertion`, class by class. `starts` is what [`Step::coloring`] returned, `left_over` what [`Step::conflicts`] did.
    /// Returns the number of new points.
    pub(crate) async fn insertion(&mut self, starts: &[u32], left_over: u32) -> Result<u32, Error> {
        let (n, candidates) = (u64::from(self.params.points), u64::from(self.params.candidates));
        self.buffers.next_radii.reserve(self.gpu, WORD * (2 * n + candidates))?;
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

    /// Records the numbering of the new points.
    pub(crate) async fn record_new_indices(&self, commands: &mut Commands<'_>) {
        let (b, candidates) = (&*self.buffers, self.params.candidates);
        commands.clear(&b.new_indices, 1);
        let count = self.kernels.get("commit_count");
        commands.run(count, &[&b.candidates, &b.new_indices], [0; 4], candidates).await;
        self.record_scan(commands, &b.new_indices, 0, candidates + 1).await;
    }

    /// `next_ring`: radii that cover the next level's rings.
    pub(crate) async fn next_ring(&mut self, left_over: u32) -> Result<(), Error> {
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
        if left_over & NEXT_RING != 0 {
            // Radii are maxima: a second run adds what the first one left out.
            self.run_large("next_ring_large", buffers).await?;
        }
        self.counters().await.map(|_| ())
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

/// Whole words in a buffer.
pub(crate) fn words_of(buffer: &Buffer) -> u32 {
    items_of(buffer, 1)
}

/// Whole items of so many words in a buffer.
pub(crate) fn items_of(buffer: &Buffer, words: u64) -> u32 {
    u32::try_from(buffer.size() / (WORD * words)).unwrap_or(u32::MAX)
}
