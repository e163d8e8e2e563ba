//! What a dry run tells, for people and as JSON.

use super::pace::Pace;
use crate::args::RefineArgs;
use crate::memory;
use crate::need::{DeviceNeed, Fits, Need, bytes};
use crate::summary::{name, points};
use serde::Serialize;
use std::fmt::{self, Display, Formatter};

/// What was found out.
pub(super) struct Estimate {
    pub(super) need: Need,
    pub(super) pace: Pace,
    pub(super) output_bytes: u64,
    pub(super) fits: Fits,
}

/// The report. Its names are the keys of the JSON object.
#[derive(Serialize)]
pub(super) struct Report {
    /// Always true, so that it is not taken for a refinement's summary.
    dry_run: bool,
    input: String,
    output: String,
    points_in: usize,
    /// Points that fill holes.
    points_filled: usize,
    /// Points before the first step, fill points included, and after each step, about.
    points_by_level: Vec<u64>,
    /// `gpu` or `cpu`.
    backend: &'static str,
    /// Name of the GPU adapter.
    adapter: Option<String>,
    /// Threads of the CPU backend.
    threads: Option<usize>,
    memory: Memory,
    /// Of the refinement, about.
    seconds: f64,
    pace: Sphere,
    /// Size of the output file: exact in binary if the points are.
    output_bytes: u64,
    /// `yes` or `unlikely`: what surely does not fit is an error.
    fits: &'static str,
    /// Why it is unlikely to fit.
    why: Option<String>,
    notes: Vec<String>,
}

/// Bytes, about.
#[derive(Serialize)]
struct Memory {
    host: u64,
    /// What can be had, where the system tells.
    host_available: Option<u64>,
    device: Option<Device>,
}

#[derive(Serialize)]
struct Device {
    /// For an even cloud.
    bytes: u64,
    /// For a cloud with clusters and gaps, or with generous radii.
    uneven_bytes: u64,
    largest_buffer: &'static str,
    largest_buffer_bytes: u64,
    /// What the adapter allows in one buffer.
    largest_allowed_bytes: u64,
    /// Whether it is a part of the host's memory.
    on_host: bool,
}

/// What was refined to learn the pace.
#[derive(Serialize)]
struct Sphere {
    points: usize,
    seconds: f64,
}

impl Report {
    pub(super) fn new(
        args: &RefineArgs,
        points_in: usize,
        points_filled: usize,
        estimate: Estimate,
        notes: Vec<String>,
    ) -> Self {
        let Estimate { need, pace, output_bytes, fits } = estimate;
        let seconds = pace.seconds(&need.points_by_level);
        let (fits, why) = match fits {
            Fits::Yes => ("yes", None),
            Fits::Unlikely(why) => ("unlikely", Some(why)),
        };
        let adapter = need.device.as_ref().map(|device| device.adapter.clone());
        let device = need.device.map(Device::new);
        Self {
            dry_run: true,
            input: name(&args.input),
            output: name(&args.output),
            points_in,
            points_filled,
            points_by_level: need.points_by_level,
            backend: if adapter.is_some() { "gpu" } else { "cpu" },
            threads: adapter.is_none().then(rayon::current_num_threads),
            adapter,
            memory: Memory { host: need.host, host_available: memory::available(), device },
            seconds,
            pace: Sphere { points: pace.points, seconds: pace.time.as_secs_f64() },
            output_bytes,
            fits,
            why,
            notes,
        }
    }
}

impl Device {
    fn new(need: DeviceNeed) -> Self {
        let DeviceNeed { forecast, largest_allowed, on_host, .. } = need;
        let (largest_buffer, largest_buffer_bytes) = forecast.largest_buffer;
        Self {
            bytes: forecast.device_bytes,
            uneven_bytes: forecast.uneven_bytes,
            largest_buffer,
            largest_buffer_bytes,
            largest_allowed_bytes: largest_allowed,
            on_host,
        }
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "dry run  nothing is written; what is to come is estimated")?;
        writeln!(f, "input    {}: {}", self.input, points(self.points_in))?;
        if self.points_filled > 0 {
            writeln!(f, "holes    filled with {}", points(self.points_filled))?;
        }
        match (&self.adapter, self.threads) {
            (Some(adapter), _) => writeln!(f, "backend  gpu, {adapter}")?,
            (None, threads) => writeln!(f, "backend  cpu, threads: {}", threads.unwrap_or(1))?,
        }
        for (level, points) in self.points_by_level.iter().enumerate().skip(1) {
            writeln!(f, "level {level}  about {points} points")?;
        }
        write!(f, "{}", self.memory)?;
        let Sphere { points, seconds } = self.pace;
        writeln!(
            f,
            "time     about {}, at the pace of a sphere refined to {points} points in {seconds:.3} s \
             with the same parameters",
            duration(self.seconds)
        )?;
        writeln!(f, "output   {}: about {}", self.output, bytes(self.output_bytes))?;
        match &self.why {
            None => writeln!(f, "fits     {}", self.fits)?,
            Some(why) => writeln!(f, "fits     {}: {why}", self.fits)?,
        }
        self.notes.iter().try_for_each(|note| writeln!(f, "note     {note}"))
    }
}

impl Display for Memory {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "memory   about {} on the host, ", bytes(self.host))?;
        match self.host_available {
            Some(available) => writeln!(f, "{} are available", bytes(available))?,
            None => writeln!(f, "what is available is not known")?,
        }
        self.device.iter().try_for_each(|device| write!(f, "{device}"))
    }
}

impl Display for Device {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [even, uneven] = [self.bytes, self.uneven_bytes].map(bytes);
        // Drivers do not tell through this interface how much memory a device has.
        let place = if self.on_host { "on the device, a part of that" } else { "on the device" };
        writeln!(
            f,
            "         about {even} {place}; with clusters, gaps or generous radii up to {uneven}"
        )?;
        let [need, have] = [self.largest_buffer_bytes, self.largest_allowed_bytes].map(bytes);
        let name = self.largest_buffer;
        writeln!(f, "         largest buffer: {name} {need}, the adapter allows {have}")
    }
}

/// 0.034 s, 12.3 s, 5.6 min, 7.8 h.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => format!("{s:.3} s"),
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.1} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}
