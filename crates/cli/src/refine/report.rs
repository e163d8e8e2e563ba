//! The summary of a refinement, for people and as JSON.

use super::backend::{Backend, Computed};
use super::stats::Stats;
use crate::args::RefineArgs;
use crate::fill::{Hole, fill_notes, fill_summary};
use crate::summary::{Params, counted, in_order, name, per_second, points};
use serde::Serialize;
use std::fmt::{self, Display, Formatter};
use std::time::Duration;
use surfine::{CurveCounts, LevelReport, Mode, PointSet};
use surfine_holes::Filled;
use surfine_points::Convergence;
use surfine_points::ply::Source;

/// How long the steps took.
pub(super) struct Times {
    pub(super) read: Duration,
    pub(super) fill: Duration,
    pub(super) setup: Duration,
    pub(super) refine: Duration,
    pub(super) write: Duration,
    /// Measuring the levels, where that was asked for.
    pub(super) stats: Duration,
}

/// The cloud that was read, and what was filled.
#[derive(Clone, Copy)]
pub(super) struct Input<'a> {
    pub(super) points: &'a PointSet,
    pub(super) filled: &'a Filled,
    pub(super) source: &'a Source,
}

/// The summary. Its names are the keys of the JSON object.
#[derive(Serialize)]
pub(super) struct Report {
    input: String,
    output: String,
    points_in: usize,
    points_out: usize,
    /// `gpu` or `cpu`.
    backend: &'static str,
    /// Name of the GPU adapter.
    adapter: Option<String>,
    /// `exact` or `plain`; the CPU defines what is exact.
    mode: &'static str,
    /// Threads of the CPU backend.
    threads: Option<usize>,
    /// Bytes of the engine's buffers when the last level ended.
    device_bytes: Option<u64>,
    /// The loops that were chosen to be filled.
    holes: Vec<Hole>,
    params: Params,
    curves: Curves,
    levels: Vec<Level>,
    /// With `--stats`, how far each level has converged.
    #[serde(skip_serializing_if = "Option::is_none")]
    stats: Option<Stats>,
    seconds: Seconds,
    /// New points for each second of refinement, without setup and files.
    points_per_second: f64,
    notes: Vec<String>,
}

/// Creases and boundaries of the input.
#[derive(Serialize)]
struct Curves {
    crease_points: usize,
    corners: usize,
    crease_segments: usize,
    boundary_points: usize,
    boundary_segments: usize,
}

#[derive(Serialize)]
struct Level {
    points_in: usize,
    points_out: usize,
    growth: f64,
    /// Mean size of `N^E`.
    ball_neighbors_mean: f64,
    /// Mean size of `N`.
    ring_neighbors_mean: f64,
    classes: usize,
    isolated: usize,
    /// In the order of the stages.
    #[serde(serialize_with = "in_order")]
    stages_ms: Vec<(&'static str, f64)>,
}

#[derive(Serialize)]
struct Seconds {
    read: f64,
    fill: f64,
    setup: f64,
    refine: f64,
    write: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    stats: Option<f64>,
}

impl Report {
    pub(super) fn new(
        args: &RefineArgs,
        read: Input<'_>,
        computed: &Computed,
        convergence: Option<Vec<Convergence>>,
        times: Times,
    ) -> Self {
        let refined = &computed.refined;
        let (adapter, mode, threads) = match &computed.backend {
            Backend::Gpu { adapter, mode, .. } => (Some(adapter.clone()), *mode, None),
            Backend::Cpu { threads } => (None, Mode::Exact, Some(*threads)),
        };
        Self {
            input: name(&args.input),
            output: name(&args.output),
            points_in: read.points.len(),
            points_out: refined.points.len(),
            backend: if adapter.is_some() { "gpu" } else { "cpu" },
            adapter,
            mode: mode.name(),
            threads,
            device_bytes: refined.device_bytes,
            holes: read.filled.fills.iter().map(Hole::new).collect(),
            params: Params::new(&args.params()),
            curves: Curves::new(refined.curves),
            levels: refined.reports.iter().map(Level::new).collect(),
            points_per_second: per_second(refined.parents.len(), times.refine),
            seconds: Seconds::new(&times, convergence.is_some()),
            stats: convergence.as_deref().map(Stats::new),
            notes: notes(args, read, computed, mode),
        }
    }
}

impl Curves {
    fn new(counts: CurveCounts) -> Self {
        let CurveCounts {
            crease_points,
            corners,
            crease_segments,
            boundary_points,
            boundary_segments,
        } = counts;
        Self { crease_points, corners, crease_segments, boundary_points, boundary_segments }
    }
}

impl Display for Curves {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if self.crease_segments > 0 {
            let points = counted(self.crease_points, "crease point", "crease points");
            let corners = counted(self.corners, "corner", "corners");
            let segments = counted(self.crease_segments, "segment", "segments");
            writeln!(f, "creases  {points}, {corners}, {segments}")?;
        }
        if self.boundary_segments > 0 {
            let points = counted(self.boundary_points, "boundary point", "boundary points");
            let segments = counted(self.boundary_segments, "segment", "segments");
            writeln!(f, "boundary {points}, {segments}")?;
        }
        Ok(())
    }
}

impl Level {
    fn new(report: &LevelReport) -> Self {
        let mean = |sum: u64| sum as f64 / report.points_in.max(1) as f64;
        let in_ms = |&(stage, time): &(_, Duration)| (stage, 1e3 * time.as_secs_f64());
        Self {
            points_in: report.points_in,
            points_out: report.points_out,
            growth: report.growth(),
            ball_neighbors_mean: mean(report.ball_neighbors),
            ring_neighbors_mean: mean(report.ring_neighbors),
            classes: report.classes,
            isolated: report.isolated,
            stages_ms: report.stages.iter().map(in_ms).collect(),
        }
    }

    fn ms(&self) -> f64 {
        self.stages_ms.iter().map(|(_, ms)| ms).sum()
    }
}

impl Seconds {
    fn new(times: &Times, measured: bool) -> Self {
        let &Times { read, fill, setup, refine, write, stats } = times;
        let seconds = [read, fill, setup, refine, write].map(|t| t.as_secs_f64());
        let [read, fill, setup, refine, write] = seconds;
        let stats = measured.then_some(stats.as_secs_f64());
        Self { read, fill, setup, refine, write, stats }
    }

    fn total(&self) -> f64 {
        let stats = self.stats.unwrap_or(0.0);
        self.read + self.fill + self.setup + self.refine + self.write + stats
    }
}

/// Everything that was treated in a special way, with how many points it concerns.
fn notes(args: &RefineArgs, read: Input<'_>, computed: &Computed, mode: Mode) -> Vec<String> {
    let Input { points, filled, source } = read;
    let mut notes: Vec<String> = computed.fallback.iter().cloned().collect();
    notes.extend(source.notes.iter().cloned());
    notes.extend(fill_notes(&args.fill_holes(), filled));
    match points.non_unit_normals() {
        0 => {}
        count => notes.push(format!(
            "{} not of unit length: normalized for the refinement, written as in the input",
            counted(count, "normal is", "normals are")
        )),
    }
    for (level, report) in (1..).zip(&computed.refined.reports) {
        if report.isolated > 0 {
            let isolated = counted(report.isolated, "point has", "points have");
            notes.push(format!("level {level}: {isolated} no neighbor, so none new around them"));
        }
    }
    if let Backend::Gpu { mode: Mode::Exact, software: false, .. } = computed.backend {
        let rounds = "if the driver rounds division and square root correctly";
        notes.push(format!("mode exact on hardware: the bytes of the CPU backend {rounds}"));
    }
    if mode == Mode::Plain {
        notes.push("mode plain: results can differ from the CPU backend's in rounding".into());
    }
    notes
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "input    {}: {}", self.input, points(self.points_in))?;
        writeln!(f, "output   {}: {}", self.output, points(self.points_out))?;
        match (&self.adapter, self.threads) {
            (Some(adapter), _) => writeln!(f, "backend  gpu, {adapter}, mode {}", self.mode)?,
            (None, threads) => writeln!(f, "backend  cpu, threads: {}", threads.unwrap_or(1))?,
        }
        f.write_str(&fill_summary(&self.holes))?;
        write!(f, "{}", self.curves)?;
        for (number, level) in (1..).zip(&self.levels) {
            write!(f, "level {number}  {level}")?;
        }
        self.stats.iter().try_for_each(|stats| write!(f, "{stats}"))?;
        write!(f, "{}", self.seconds)?;
        let filled: usize = self.holes.iter().map(Hole::points).sum();
        let new = self.points_out - self.points_in - filled;
        writeln!(
            f,
            "speed    {new} new points, {:.0} a second of refinement",
            self.points_per_second
        )?;
        if let Some(bytes) = self.device_bytes {
            writeln!(f, "memory   {:.1} MB on the device", bytes as f64 / 1e6)?;
        }
        self.notes.iter().try_for_each(|note| writeln!(f, "note     {note}"))
    }
}

impl Display for Level {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { points_in, points_out, growth, classes, isolated, .. } = self;
        let (ball, ring) = (self.ball_neighbors_mean, self.ring_neighbors_mean);
        writeln!(f, "{points_in} -> {points_out} points (x {growth:.3}) in {:.1} ms", self.ms())?;
        write!(f, "         mean |N^E| {ball:.2}, mean |N| {ring:.2}, ")?;
        if *classes > 0 {
            write!(f, "classes {classes}, ")?;
        }
        writeln!(f, "isolated {isolated}")?;
        let stages: Vec<String> =
            self.stages_ms.iter().map(|(stage, ms)| format!("{stage} {ms:.1}")).collect();
        writeln!(f, "         ms: {}", stages.join(", "))
    }
}

impl Display for Seconds {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { read, fill, setup, refine, write, stats } = self;
        write!(
            f,
            "time     {:.3} s: read {read:.3}, fill {fill:.3}, set up {setup:.3}, refine {refine:.3}, write {write:.3}",
            self.total()
        )?;
        stats.iter().try_for_each(|stats| write!(f, ", stats {stats:.3}"))?;
        writeln!(f)
    }
}
