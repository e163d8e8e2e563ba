//! What was measured, as JSON; `table.rs` shows it to people.

use super::clouds::Cloud;
use super::measure::{Measured, Run, median, ms};
use super::slices::Sliced;
use crate::adapters::Description;
use crate::summary::{Params, in_order, per_second};
use serde::Serialize;

/// Everything that was measured. Its names are the keys of the JSON object.
#[derive(Serialize)]
pub(super) struct Report {
    pub(super) version: &'static str,
    pub(super) cpu: Option<Cpu>,
    pub(super) gpu: Option<Gpu>,
    pub(super) params: Params,
    /// Measured runs of each cloud and backend.
    pub(super) runs: u16,
    /// From the smallest cloud to the largest.
    pub(super) cases: Vec<Case>,
    pub(super) left_out: Vec<LeftOut>,
    pub(super) notes: Vec<String>,
}

#[derive(Serialize)]
pub(super) struct Cpu {
    pub(super) threads: usize,
}

#[derive(Serialize)]
pub(super) struct Gpu {
    #[serde(flatten)]
    pub(super) adapter: Description,
    /// Opening it and compiling the first kernels.
    pub(super) setup_seconds: f64,
}

impl Report {
    /// Whether an adapter that must give the CPU's bytes gave others. Hardware may round otherwise.
    pub(super) fn shows_bug(&self) -> bool {
        let differs = self.cases.iter().any(|case| case.difference.is_some());
        differs && self.gpu.as_ref().is_some_and(|gpu| gpu.adapter.gives_cpu_bytes())
    }
}

/// One cloud on the backends.
#[derive(Serialize)]
pub(super) struct Case {
    /// The points that were asked for; the user's own cloud has none.
    pub(super) size: Option<usize>,
    pub(super) input: String,
    pub(super) points_in: usize,
    pub(super) points_out: usize,
    pub(super) cpu: Option<Side>,
    /// The result stays on the device.
    pub(super) gpu: Option<Side>,
    pub(super) gpu_read_back: Option<Pace>,
    /// Two runs, if `--slice` asks for them.
    pub(super) gpu_sliced: Vec<Sliced>,
    /// Whether both backends gave the same bytes.
    pub(super) same_bytes: Option<bool>,
    /// Where they did not.
    pub(super) difference: Option<String>,
}

/// A cloud on one backend.
#[derive(Serialize)]
pub(super) struct Side {
    #[serde(flatten)]
    pub(super) pace: Pace,
    /// Of the engine's buffers at the end, the result included. The CPU's memory is not measured.
    pub(super) device_bytes: Option<u64>,
    /// Over all points of the result.
    pub(super) bytes_per_point: Option<f64>,
    /// Of the median run, all levels together, in the order of the stages.
    #[serde(serialize_with = "in_order")]
    pub(super) stages_ms: Vec<(&'static str, f64)>,
    /// The rest of the median run: upload, checks, creases.
    pub(super) outside_ms: f64,
}

/// How fast it went.
#[derive(Serialize)]
pub(super) struct Pace {
    pub(super) seconds: Spread,
    pub(super) new_points_per_second: f64,
    /// Over that of the CPU.
    pub(super) speed_to_cpu: Option<f64>,
}

#[derive(Serialize)]
pub(super) struct Spread {
    pub(super) median: f64,
    pub(super) min: f64,
    pub(super) max: f64,
}

/// A cloud that a backend did not refine.
#[derive(Serialize)]
pub(super) struct LeftOut {
    /// None for the user's own cloud.
    pub(super) size: Option<usize>,
    /// `cpu` or `gpu`.
    pub(super) backend: &'static str,
    pub(super) why: String,
}

impl Case {
    /// A cloud that at least one backend refined.
    pub(super) fn new(
        size: Option<usize>,
        cloud: Cloud,
        cpu: Option<&Measured>,
        gpu: Option<&Measured>,
        difference: Option<String>,
    ) -> Self {
        let refined = cpu.or(gpu).map(|measured| &measured.refined);
        let cpu_speed = cpu.map(|cpu| Pace::new(&cpu.runs, new_points(cpu), None));
        let cpu_speed = cpu_speed.map(|pace| pace.new_points_per_second);
        let read_back = gpu.and_then(|gpu| Some((gpu, gpu.read_back.as_ref()?)));
        Self {
            size,
            input: cloud.origin,
            points_in: cloud.points.len(),
            points_out: refined.map_or(0, |refined| refined.points.len()),
            cpu: cpu.map(|cpu| Side::new(cpu, cpu_speed)),
            gpu: gpu.map(|gpu| Side::new(gpu, cpu_speed)),
            gpu_read_back: read_back.map(|(gpu, r)| Pace::new(r, new_points(gpu), cpu_speed)),
            gpu_sliced: gpu.map(|gpu| gpu.sliced.clone()).unwrap_or_default(),
            same_bytes: cpu.and(gpu).map(|_| difference.is_none()),
            difference,
        }
    }
}

fn new_points(measured: &Measured) -> usize {
    measured.refined.parents.len()
}

impl Side {
    fn new(measured: &Measured, cpu_speed: Option<f64>) -> Self {
        let Run { time, stages } = median(&measured.runs);
        let stages_ms: Vec<_> = stages.iter().map(|(s, t)| (*s, ms(*t))).collect();
        let inside: f64 = stages_ms.iter().map(|(_, ms)| ms).sum();
        let points = measured.refined.points.len().max(1) as f64;
        let device_bytes = measured.refined.device_bytes;
        Self {
            pace: Pace::new(&measured.runs, new_points(measured), cpu_speed),
            device_bytes,
            bytes_per_point: device_bytes.map(|bytes| bytes as f64 / points),
            outside_ms: (ms(*time) - inside).max(0.0),
            stages_ms,
        }
    }

    /// The whole median run.
    pub(super) fn ms(&self) -> f64 {
        1e3 * self.pace.seconds.median
    }
}

impl Pace {
    /// Of runs that are sorted.
    fn new(runs: &[Run], new_points: usize, cpu_speed: Option<f64>) -> Self {
        let median = median(runs).time;
        let [min, max] = [&runs[0], &runs[runs.len() - 1]].map(|run| run.time.as_secs_f64());
        let speed = per_second(new_points, median);
        Self {
            seconds: Spread { median: median.as_secs_f64(), min, max },
            new_points_per_second: speed,
            // A cloud that does not grow has no speed.
            speed_to_cpu: cpu_speed.filter(|&cpu| cpu > 0.0).map(|cpu| speed / cpu),
        }
    }
}
