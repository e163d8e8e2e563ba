//! The tables for people.

use super::report::{Case, LeftOut, Pace, Report, Side, Spread};
use super::short;
use crate::summary::counted;
use std::fmt::{self, Display, Formatter};

const LEGEND: &str = "\
gpu: the result stays on the device; read back: it returns to the host; both with the upload of the input.
bytes/point: buffers of the device over all points of the result. x cpu: speed over that of the CPU.
";

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { version, params, runs, .. } = self;
        writeln!(f, "surfine  {version}, {params}; median of {runs}, after one uncounted run")?;
        if let Some(cpu) = &self.cpu {
            writeln!(f, "cpu      threads: {}", cpu.threads)?;
        }
        if let Some(gpu) = &self.gpu {
            writeln!(f, "gpu      {}, opened in {:.1} s", gpu.adapter, gpu.setup_seconds)?;
        }
        for like in self.cases.chunk_by(|a, b| a.input == b.input) {
            let counts: Vec<String> = like.iter().map(|case| case.points_in.to_string()).collect();
            writeln!(f, "input    {} points: {}", counts.join(", "), like[0].input)?;
        }
        writeln!(f)?;
        write_cases(f, &self.cases)?;
        write!(f, "{LEGEND}")?;
        for case in self.staged() {
            writeln!(f)?;
            write_stages(f, case)?;
        }
        writeln!(f)?;
        self.write_verdict(f)?;
        self.left_out.iter().try_for_each(|left_out| writeln!(f, "left out {left_out}"))?;
        self.notes.iter().try_for_each(|note| writeln!(f, "note     {note}"))
    }
}

impl Report {
    /// The largest case, and, where that lacks a backend, the largest that both refined.
    fn staged(&self) -> impl Iterator<Item = &Case> {
        let both = self.cases.iter().rposition(|case| case.same_bytes.is_some());
        let last = self.cases.len().checked_sub(1);
        let shown = move |i: &usize| Some(*i) == both || Some(*i) == last;
        (0..self.cases.len()).filter(shown).map(|i| &self.cases[i])
    }

    fn write_verdict(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let compared = self.cases.iter().filter(|case| case.same_bytes.is_some()).count();
        let mut differing = self.cases.iter().filter(|case| case.difference.is_some()).peekable();
        let clouds = counted(compared, "cloud", "clouds");
        if compared == 0 {
            return writeln!(f, "bytes    not compared: no cloud was refined by both backends");
        } else if differing.peek().is_none() {
            return writeln!(f, "bytes    the same from both backends: {clouds} compared");
        }
        let title = match self.shows_bug() {
            true => "bytes    DIFFERENT",
            false => "bytes    different, as can be with this adapter",
        };
        for case in differing {
            let difference = case.difference.as_deref().unwrap_or_default();
            writeln!(f, "{title}: {} points in: {difference}", case.points_in)?;
        }
        Ok(())
    }
}

fn write_cases(f: &mut Formatter<'_>, cases: &[Case]) -> fmt::Result {
    writeln!(
        f,
        "points in  points out  backend           time, ms       min - max, ms  M new points/s  bytes/point  x cpu"
    )?;
    for case in cases {
        let mut counts = format!("{:>9}  {:>10}", case.points_in, case.points_out);
        for (name, side) in [("cpu", &case.cpu), ("gpu", &case.gpu)] {
            if let Some(Side { pace, bytes_per_point, .. }) = side {
                write_pace(f, &counts, name, pace, *bytes_per_point)?;
                counts = " ".repeat(counts.len());
            }
        }
        if let Some(pace) = &case.gpu_read_back {
            write_pace(f, &counts, "gpu, read back", pace, None)?;
        }
        for sliced in &case.gpu_sliced {
            writeln!(f, "{}  {sliced}", " ".repeat(counts.len()))?;
        }
    }
    Ok(())
}

fn write_pace(
    f: &mut Formatter<'_>,
    counts: &str,
    name: &str,
    pace: &Pace,
    bytes: Option<f64>,
) -> fmt::Result {
    let Pace { seconds: Spread { median, min, max }, new_points_per_second, speed_to_cpu } = pace;
    let [median, min, max] = [median, min, max].map(|seconds| 1e3 * seconds);
    let range = format!("{min:.1} - {max:.1}");
    let speed = new_points_per_second / 1e6;
    let or_none = |text: Option<String>| text.unwrap_or("-".into());
    let bytes = or_none(bytes.map(|bytes| format!("{bytes:.0}")));
    let ratio = or_none(speed_to_cpu.map(|ratio| format!("{ratio:.2}")));
    writeln!(
        f,
        "{counts}  {name:<14}  {median:>10.1}  {range:>18}  {speed:>14.3}  {bytes:>11}  {ratio:>5}"
    )
}

/// The stages of a case, the backends side by side.
fn write_stages(f: &mut Formatter<'_>, case: &Case) -> fmt::Result {
    let sides = [("cpu", &case.cpu), ("gpu", &case.gpu)];
    let sides: Vec<(&str, &Side)> =
        sides.into_iter().filter_map(|(name, side)| Some((name, side.as_ref()?))).collect();
    let levels = "all levels of the median run, ms and share";
    writeln!(f, "stages from {} to {} points: {levels}", case.points_in, case.points_out)?;
    let titles: Vec<String> = sides.iter().map(|(name, _)| format!("{name:>20}")).collect();
    writeln!(f, "{:<14}{}", "", titles.concat())?;
    // A backend may have a stage that the other lacks.
    let mut stages: Vec<&str> = Vec::new();
    for (stage, _) in sides.iter().flat_map(|(_, side)| &side.stages_ms) {
        if !stages.contains(stage) {
            stages.push(stage);
        }
    }
    for stage in stages {
        let ms = |side: &Side| side.stages_ms.iter().find(|(s, _)| *s == stage).map(|(_, ms)| *ms);
        write_stage(f, stage, &sides, ms)?;
    }
    write_stage(f, "outside", &sides, |side| Some(side.outside_ms))?;
    write_stage(f, "whole run", &sides, |side| Some(side.ms()))?;
    writeln!(f, "outside: in no stage, such as the upload of the input.")
}

fn write_stage(
    f: &mut Formatter<'_>,
    stage: &str,
    sides: &[(&str, &Side)],
    ms: impl Fn(&Side) -> Option<f64>,
) -> fmt::Result {
    let column = |(_, side): &(&str, &Side)| match ms(side) {
        Some(ms) => format!("{ms:>11.1}{:>7.1} %", 100.0 * ms / side.ms().max(1e-9)),
        None => format!("{:>20}", "-"),
    };
    let columns: Vec<String> = sides.iter().map(column).collect();
    writeln!(f, "{stage:<14}{}", columns.concat())
}

impl Display for LeftOut {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { size, backend, why } = self;
        let size = size.map_or("the cloud".into(), |size| format!("{} points", short(size)));
        write!(f, "{size} on the {}: {why}", backend.to_uppercase())
    }
}
