//! The stages of one refinement step, as dispatches of their kernels.
//!
//! Nothing that grows with the cloud is read back, but for the gaps of possible boundary points: only [`Counters`], ring and class totals and the number of new
//! points, since buffers are sized on the host. A stage whose buffers turn out too small runs again with larger ones.

use crate::buffers::{Buffer, read_parts};
use crate::commands::{Commands, Uniforms};
use crate::kernel::Kernel;
use crate::records::{Counters, Params, Point};
use crate::scan::Scan;
use crate::shaders::SHADERS;
use crate::{Error, Gpu};
use surfine_features::Gap;
use surfine_points::{Grid, Neighborhood, RefineParams, Rules};

/// Rounds of colouring between two looks at what is left.
const ROUNDS: u32 = 16;
/// Bytes of a word.
const WORD: u64 = 4;

/// How much is done and provided for at once. No result depends on it.
#[derive(Clone, Copy, Debug)]
pub struct Sizing {
    /// Points whose neighbourhoods are computed together: their scratch memory is used again for the next ones.
    pub chunk: u32,
    /// Points of a class that are refined together.
    pub part: u32,
    /// Entries of lists that are provided for each point before their need is known.
    pub entries: u32,
}

impl Default for Sizing {
    fn default() -> Self {
        Self { chunk: 1 << 17, part: u32::MAX, entries: 24 }
    }
}

/// Values of the kernels' `override`s.
pub type Constants = Vec<(&'static str, f64)>;

/// The values of the kernels' `override`s that parameters ask for, for clouds with creases or boundaries or without.
pub fn constants(params: &RefineParams, with_curves: bool) -> Constants {
    let accurate = params.effective_neighborhood() == Neighborhood::Accurate;
    let plain_angle = params.effective_plain_angle();
    let modes =
        [("accurate", accurate), ("simplified", params.simplified), ("plain_angle", plain_angle)];
    let modes = modes.into_iter().chain([("with_curves", with_curves)]);
    // The host splits the curves.
    let rules = params.rules.named().into_iter().filter(|(name, _)| *name != "even_steps");
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
    /// Starts of cells, then entries: of the points, later of the candidates.
    grid: "grid entries",
    /// Cell and rank of each item of a counting sort.
    cells: "cells",
    ring_starts: "ring starts",
    ring_entries: "ring entries",
    /// Arena block of each point.
    blocks: "arena blocks",
    /// Scratch memory of neighborhood and insertion.
    arena: "neighbours",
    candidate_positions: "candidate positions",
    candidate_normals: "candidate normals",
    owners: "candidate owners",
    states: "candidate states",
    conflict_blocks: "conflict blocks",
    conflict_entries: "conflicts",
    mirror_heads: "mirrored conflict heads",
    mirror_links: "mirrored conflicts",
    classes: "classes",
    class_members: "class members",
    next_radii: "radii",
    new_indices: "new indices",
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
    pub(crate) rules: Rules,
    pub(crate) params: Params,
    /// New points that this step puts on creases and boundaries.
    pub(crate) curve_points: u32,
    /// Bytes of the table of creases and boundaries: its buffer may be larger.
    pub(crate) curve_bytes: u64,
}

impl Step<'_> {
    fn commands(&self) -> Commands<'_> {
        self.uniforms.set(self.gpu, &self.params);
        Commands::new(self.gpu, self.uniforms)
    }

    fn record_scan(&self, commands: &mut Commands<'_>, values: &Buffer, first: u32, count: u32) {
        let kernels = (self.kernels.get("scan_sum"), self.kernels.get("scan_add"));
        self.scan.record(commands, kernels, values, first, count);
    }

    /// Reads the counters and single words (buffer, index).
    fn read(&self, words: &[(&Buffer, u32)]) -> Result<(Counters, Vec<u32>), Error> {
        let size = size_of::<Counters>() as u64;
        let mut parts = vec![(self.buffers.counters.raw(), 0, size)];
        parts.extend(words.iter().map(|(buffer, i)| (buffer.raw(), WORD * u64::from(*i), WORD)));
        let bytes = read_parts(self.gpu, &parts)?;
        let (counters, words) = bytes.split_at(size as usize);
        let counters: Counters = bytemuck::pod_read_unaligned(counters);
        if counters.cut_loops > 0 {
            return Err(self.crowded(counters.cut_loops as usize - 1));
        }
        Ok((counters, bytemuck::pod_collect_to_vec(words)))
    }

    /// The error that names a point whose neighbours are too many.
    fn crowded(&self, point: usize) -> Error {
        let members = [(self.buffers.blocks.raw(), 8 * point as u64 + 4, WORD)];
        let neighbors = match read_parts(self.gpu, &members) {
            Ok(bytes) => bytemuck::pod_read_unaligned(&bytes),
            Err(e) => return e,
        };
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

    /// `grid` of the input: built on the host.
    pub(crate) fn upload_grid(&mut self, grid: &Grid) -> Result<(), Error> {
        let words = [grid.starts.as_slice(), &grid.items].concat();
        self.buffers.grid.reserve(self.gpu, WORD * words.len() as u64)?;
        let raw = self.buffers.grid.raw();
        self.gpu.queue.write_buffer(raw, 0, bytemuck::cast_slice(&words));
        Ok(())
    }

    /// `grid` of the points of later levels.
    pub(crate) fn grid_points(&mut self) -> Result<(), Error> {
        self.sort_into_grid("grid_points", self.params.points)
    }

    /// Sorts points or candidates by cell.
    fn sort_into_grid(&mut self, kernel: &str, items: u32) -> Result<(), Error> {
        let cells = self.cells();
        let words = u64::from(cells) + 1 + u64::from(items);
        self.buffers.grid.reserve(self.gpu, WORD * words)?;
        self.buffers.cells.reserve(self.gpu, 2 * WORD * u64::from(items))?;
        self.scan.reserve(self.gpu, cells + 1)?;
        let b = &*self.buffers;
        let from = if kernel == "grid_points" { &b.points } else { &b.candidate_positions };
        let mut commands = self.commands();
        commands.clear(&b.grid, u64::from(cells) + 1);
        commands.run(self.kernels.get(kernel), &[from, &b.grid, &b.cells], [0; 4], items);
        self.record_scan(&mut commands, &b.grid, 0, cells + 1);
        let fill = self.kernels.get("sort_fill");
        commands.run(fill, &[&b.cells, &b.grid], [items, cells, 0, 0], items);
        commands.finish()
    }

    /// Copies the table of curves behind the candidates' grid: the kernels that read both have no binding left for it.
    fn append_curves(&mut self) -> Result<(), Error> {
        if self.params.records == 0 {
            return Ok(());
        }
        let at = WORD * (u64::from(self.cells()) + 1 + u64::from(self.params.slots));
        let bytes = self.curve_bytes;
        self.buffers.grid.grow(self.gpu, at + bytes, at)?;
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let (curves, grid) = (self.buffers.curves.raw(), self.buffers.grid.raw());
        encoder.copy_buffer_to_buffer(curves, 0, grid, at, bytes);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// `neighborhood`: the rings. Returns the counters.
    pub(crate) fn neighborhood(&mut self) -> Result<Counters, Error> {
        let n = self.params.points;
        let mut chunk = n.clamp(1, self.sizing.chunk);
        self.buffers.blocks.reserve(self.gpu, 2 * WORD * u64::from(n))?;
        self.buffers.ring_starts.reserve(self.gpu, WORD * (u64::from(n) + 1))?;
        let entries = u64::from(self.sizing.entries);
        self.buffers.ring_entries.reserve(self.gpu, 2 * WORD * entries.min(7) * u64::from(n))?;
        self.buffers.arena.reserve(self.gpu, 4 * WORD * entries * u64::from(chunk))?;
        self.scan.reserve(self.gpu, n + 1)?;
        loop {
            self.params.arena_words = words_of(&self.buffers.arena);
            self.params.ring_entries = words_of(&self.buffers.ring_entries) / 2;
            self.record_neighborhood(chunk)?;
            let (counters, totals) = self.read(&[(&self.buffers.ring_starts, n)])?;
            let enough = self.make_room_in_arena(&counters, &mut chunk)?;
            if enough && totals[0] <= self.params.ring_entries {
                self.params.fan_slots = totals[0];
                self.params.slots = totals[0] + self.curve_points;
                return Ok(counters);
            }
            self.buffers.ring_entries.reserve(self.gpu, 2 * WORD * u64::from(totals[0]))?;
        }
    }

    fn record_neighborhood(&self, chunk: u32) -> Result<(), Error> {
        let b = &*self.buffers;
        let n = self.params.points;
        let mut commands = self.commands();
        commands.clear(&b.counters, words_of(&b.counters).into());
        commands.clear(&b.ring_starts, 1);
        let k = self.kernels;
        let ball = [&b.points, &b.grid, &b.arena, &b.blocks, &b.counters, &b.curves];
        let ball = commands.bind(k.get("neighborhood_ball"), &ball);
        let badness = [&b.points, &b.blocks, &b.arena, &b.counters];
        let badness = commands.bind(k.get("neighborhood_badness"), &badness);
        let natural = [&b.blocks, &b.arena, &b.counters];
        let natural = commands.bind(k.get("neighborhood_natural"), &natural);
        let ring = [&b.blocks, &b.arena, &b.ring_starts, &b.counters];
        let ring = commands.bind(k.get("neighborhood_ring"), &ring);
        let store = [&b.arena, &b.blocks, &b.ring_starts, &b.ring_entries];
        let store = commands.bind(k.get("neighborhood_store"), &store);
        for first in (0..n).step_by(chunk as usize) {
            let count = chunk.min(n - first);
            commands.clear(&b.counters, 1);
            let words = [first, count, 0, 0];
            commands.dispatch(&ball, words, count);
            commands.dispatch(&badness, words, self.params.arena_words / 4);
            if self.rules.natural_neighbors {
                commands.dispatch(&natural, words, self.params.arena_words / 4);
            }
            commands.dispatch(&ring, words, count);
            self.record_scan(&mut commands, &b.ring_starts, first, count + 1);
            commands.dispatch(&store, words, count);
        }
        commands.finish()
    }

    /// Whether the arena sufficed; else makes it larger, or `chunk` smaller where the adapter allows no larger one.
    fn make_room_in_arena(&mut self, counters: &Counters, chunk: &mut u32) -> Result<bool, Error> {
        if counters.arena_peak <= self.params.arena_words {
            return Ok(true);
        }
        let need = WORD * u64::from(counters.arena_peak);
        if need <= self.gpu.largest_binding() {
            self.buffers.arena.reserve(self.gpu, need)?;
        } else if *chunk > 1 {
            *chunk = chunk.div_ceil(2);
        } else {
            let (what, have) = ("neighbours of one point", self.gpu.largest_binding());
            return Err(Error::Limit { what, need, have, adapter: self.gpu.name.clone() });
        }
        Ok(false)
    }

    /// The widest gaps of the rings (section 6), of those wider than an angle in radians, by point.
    pub(crate) fn boundary_gaps(&mut self, theta_b: f32) -> Result<Vec<Gap>, Error> {
        let room = self.params.points / 16 + 1024;
        self.buffers.gaps.reserve(self.gpu, 4 * WORD * u64::from(room))?;
        self.buffers.gap_count.reserve(self.gpu, WORD)?;
        let count = loop {
            let b = &*self.buffers;
            let room = words_of(&b.gaps) / 4;
            let mut commands = self.commands();
            commands.clear(&b.gap_count, 1);
            let buffers = [&b.ring_starts, &b.ring_entries, &b.gaps, &b.gap_count];
            let words = [theta_b.to_bits(), room, 0, 0];
            let kernel = self.kernels.get("boundary_gaps");
            commands.run(kernel, &buffers, words, self.params.points);
            commands.finish()?;
            let count: u32 = bytemuck::pod_read_unaligned(&read_parts(
                self.gpu,
                &[(b.gap_count.raw(), 0, WORD)],
            )?);
            if count <= room {
                break count;
            }
            self.buffers.gaps.reserve(self.gpu, 4 * WORD * u64::from(count))?;
        };
        let bytes = 4 * WORD * u64::from(count);
        let words = read_parts(self.gpu, &[(self.buffers.gaps.raw(), 0, bytes)])?;
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
    pub(crate) fn candidates(&mut self) -> Result<(), Error> {
        let slots = u64::from(self.params.slots);
        self.buffers.candidate_positions.reserve(self.gpu, 4 * WORD * slots)?;
        self.buffers.candidate_normals.reserve(self.gpu, 4 * WORD * slots)?;
        self.buffers.owners.reserve(self.gpu, WORD * slots)?;
        self.buffers.states.reserve(self.gpu, WORD * slots)?;
        let mut commands = self.commands();
        let b = &*self.buffers;
        let inputs = [&b.points, &b.ring_starts, &b.ring_entries];
        let outputs =
            [&b.candidate_positions, &b.candidate_normals, &b.owners, &b.states, &b.curves];
        let kernel = self.kernels.get("candidates");
        let invocations = self.params.points.max(self.curve_points);
        commands.run(kernel, &[&inputs[..], &outputs].concat(), [0; 4], invocations);
        commands.finish()
    }

    /// `conflicts`: the candidates by cell, then the conflict graph.
    pub(crate) fn conflicts(&mut self) -> Result<(), Error> {
        self.sort_into_grid("grid_candidates", self.params.slots)?;
        self.append_curves()?;
        let n = u64::from(self.params.points);
        self.buffers.conflict_blocks.reserve(self.gpu, 2 * WORD * n)?;
        self.buffers.mirror_heads.reserve(self.gpu, WORD * n)?;
        let entries = u64::from(self.sizing.entries);
        self.buffers.conflict_entries.reserve(self.gpu, WORD * entries / 2 * n)?;
        self.buffers.mirror_links.reserve(self.gpu, 2 * WORD * entries / 12 * n)?;
        loop {
            self.params.conflict_entries = words_of(&self.buffers.conflict_entries);
            self.record_conflicts()?;
            let (counters, _) = self.read(&[])?;
            let links = words_of(&self.buffers.mirror_links) / 2;
            if counters.conflicts <= self.params.conflict_entries && counters.mirrored <= links {
                return Ok(());
            }
            let (entries, links) = (u64::from(counters.conflicts), u64::from(counters.mirrored));
            self.buffers.conflict_entries.reserve(self.gpu, WORD * entries)?;
            self.buffers.mirror_links.reserve(self.gpu, 2 * WORD * links)?;
        }
    }

    fn record_conflicts(&self) -> Result<(), Error> {
        let b = &*self.buffers;
        let n = self.params.points;
        let mut commands = self.commands();
        commands.clear(&b.counters, words_of(&b.counters).into());
        commands.clear(&b.mirror_heads, n.into());
        let inputs = [
            &b.points,
            &b.ring_starts,
            &b.candidate_positions,
            &b.candidate_normals,
            &b.owners,
            &b.grid,
        ];
        let lists = [&b.conflict_blocks, &b.conflict_entries];
        let kernel = self.kernels.get("conflicts");
        commands.run(kernel, &[&inputs[..], &lists, &[&b.counters]].concat(), [0; 4], n);
        let links = [&b.mirror_heads, &b.mirror_links, &b.counters];
        let kernel = self.kernels.get("conflicts_mirror");
        commands.run(kernel, &[&lists[..], &links].concat(), [0; 4], n);
        commands.finish()
    }

    /// `coloring`: the classes, and the points by class. Returns the first member of each class and the end.
    pub(crate) fn coloring(&mut self) -> Result<Vec<u32>, Error> {
        let n = self.params.points;
        self.buffers.classes.reserve(self.gpu, WORD * u64::from(n))?;
        let mut commands = self.commands();
        commands.clear(&self.buffers.classes, n.into());
        commands.finish()?;
        let classes = loop {
            self.record_rounds()?;
            let (counters, _) = self.read(&[])?;
            if counters.uncolored == 0 {
                break counters.classes;
            }
        };
        self.sort_by_class(classes)?;
        let bytes = WORD * (u64::from(classes) + 1);
        let starts = read_parts(self.gpu, &[(self.buffers.class_members.raw(), 0, bytes)])?;
        Ok(bytemuck::pod_collect_to_vec(&starts))
    }

    fn record_rounds(&self) -> Result<(), Error> {
        let b = &*self.buffers;
        let n = self.params.points;
        let mut commands = self.commands();
        // The number of classes is a maximum over all rounds, but a point has its class from one round only.
        commands.clear(&b.counters, 5);
        let graph = [&b.conflict_blocks, &b.conflict_entries, &b.mirror_heads, &b.mirror_links];
        let kernel = self.kernels.get("coloring");
        let round = commands.bind(kernel, &[&graph[..], &[&b.classes, &b.counters]].concat());
        for i in 1..=ROUNDS {
            commands.dispatch(&round, [u32::from(i == ROUNDS), 0, 0, 0], n);
        }
        commands.finish()
    }

    fn sort_by_class(&mut self, classes: u32) -> Result<(), Error> {
        let n = self.params.points;
        let words = u64::from(classes) + 1 + u64::from(n);
        self.buffers.class_members.reserve(self.gpu, WORD * words)?;
        self.buffers.cells.reserve(self.gpu, 2 * WORD * u64::from(n))?;
        self.scan.reserve(self.gpu, classes + 1)?;
        let b = &*self.buffers;
        let mut commands = self.commands();
        commands.clear(&b.class_members, u64::from(classes) + 1);
        let count = self.kernels.get("class_count");
        commands.run(count, &[&b.classes, &b.class_members, &b.cells], [0; 4], n);
        self.record_scan(&mut commands, &b.class_members, 0, classes + 1);
        let fill = self.kernels.get("sort_fill");
        commands.run(fill, &[&b.cells, &b.class_members], [n, classes, 0, 0], n);
        commands.finish()
    }

    /// `insertion`, class by class. `starts` is what [`Step::coloring`] returned. Returns the number of new points.
    pub(crate) fn insertion(&mut self, starts: &[u32]) -> Result<u32, Error> {
        let (n, slots) = (u64::from(self.params.points), u64::from(self.params.slots));
        self.buffers.next_radii.reserve(self.gpu, 2 * WORD * (n + slots))?;
        self.buffers.new_indices.reserve(self.gpu, WORD * (slots + 1))?;
        self.scan.reserve(self.gpu, self.params.slots + 1)?;
        let largest = starts.windows(2).map(|bounds| bounds[1] - bounds[0]).max().unwrap_or(1);
        let mut part = largest.clamp(1, self.sizing.part);
        loop {
            self.params.arena_words = words_of(&self.buffers.arena);
            self.record_insertion(starts, part)?;
            let (counters, totals) =
                self.read(&[(&self.buffers.new_indices, self.params.slots)])?;
            if self.make_room_in_arena(&counters, &mut part)? {
                return Ok(totals[0]);
            }
            // The run that lacked memory has left marks on the candidates.
            self.candidates()?;
        }
    }

    fn record_insertion(&self, starts: &[u32], part: u32) -> Result<(), Error> {
        let b = &*self.buffers;
        let Params { points, slots, .. } = self.params;
        let mut commands = self.commands();
        commands.clear(&b.counters, words_of(&b.counters).into());
        commands.clear(&b.next_radii, 2 * (u64::from(points) + u64::from(slots)));
        let inputs = [&b.points, &b.ring_starts, &b.candidate_positions, &b.candidate_normals];
        let lists = [&b.grid, &b.class_members];
        let outputs = [&b.states, &b.next_radii, &b.arena, &b.counters];
        let kernel = self.kernels.get("insertion");
        let insertion = commands.bind(kernel, &[&inputs[..], &lists, &outputs].concat());
        let classes = starts.len() as u32 - 1;
        for (class, bounds) in (0..).zip(starts.windows(2)) {
            for first in (bounds[0]..bounds[1]).step_by(part as usize) {
                let count = part.min(bounds[1] - first);
                commands.clear(&b.counters, 1);
                commands.dispatch(&insertion, [class + 1, first, count, classes], count);
            }
        }
        commands.clear(&b.new_indices, 1);
        let count = self.kernels.get("commit_count");
        commands.run(count, &[&b.states, &b.new_indices], [0; 4], slots);
        self.record_scan(&mut commands, &b.new_indices, 0, slots + 1);
        commands.finish()
    }

    /// `next_ring`: radii that cover the next level's rings.
    pub(crate) fn next_ring(&mut self) -> Result<(), Error> {
        if !self.rules.next_ring {
            return Ok(());
        }
        let n = self.params.points;
        let mut part = n.clamp(1, self.sizing.chunk);
        loop {
            self.params.arena_words = words_of(&self.buffers.arena);
            self.record_next_ring(part)?;
            let (counters, _) = self.read(&[])?;
            // Radii are maxima: a second run adds what the first one left out.
            if self.make_room_in_arena(&counters, &mut part)? {
                return Ok(());
            }
        }
    }

    fn record_next_ring(&self, part: u32) -> Result<(), Error> {
        let b = &*self.buffers;
        let n = self.params.points;
        let mut commands = self.commands();
        commands.clear(&b.counters, words_of(&b.counters).into());
        let rings = [&b.points, &b.ring_starts, &b.ring_entries];
        let candidates = [&b.candidate_positions, &b.candidate_normals, &b.grid, &b.states];
        let outputs = [&b.next_radii, &b.arena, &b.counters];
        let kernel = self.kernels.get("next_ring");
        let bound = commands.bind(kernel, &[&rings[..], &candidates, &outputs].concat());
        for first in (0..n).step_by(part as usize) {
            let count = part.min(n - first);
            commands.clear(&b.counters, 1);
            commands.dispatch(&bound, [first, count, 0, 0], count);
        }
        commands.finish()
    }

    /// `commit`: appends the new points; `earlier` is the number of new points of earlier steps.
    pub(crate) fn commit(&mut self, new: u32, earlier: u32) -> Result<(), Error> {
        let point = size_of::<Point>() as u64;
        let n = u64::from(self.params.points);
        self.buffers.points.grow(self.gpu, point * (n + u64::from(new)), point * n)?;
        let kept = 3 * WORD * u64::from(earlier);
        self.buffers.parents.grow(self.gpu, kept + 3 * WORD * u64::from(new), kept)?;
        let b = &*self.buffers;
        let mut commands = self.commands();
        let rings = [&b.points, &b.ring_starts, &b.ring_entries];
        let candidates = [&b.candidate_positions, &b.candidate_normals, &b.owners];
        let outputs = [&b.new_indices, &b.next_radii, &b.parents, &b.curves];
        let kernel = self.kernels.get("commit");
        let invocations = self.params.points.max(self.params.slots);
        commands.run(
            kernel,
            &[&rings[..], &candidates, &outputs].concat(),
            [earlier, 0, 0, 0],
            invocations,
        );
        commands.finish()
    }
}

/// Whole words in a buffer.
fn words_of(buffer: &Buffer) -> u32 {
    u32::try_from(buffer.size() / WORD).unwrap_or(u32::MAX)
}
