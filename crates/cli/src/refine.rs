//! `surfine refine`.

use crate::args::RefineArgs;
use crate::backend::{self, Computed};
use crate::report::{Report, Times};
use crate::watch::Watch;
use crate::{Failure, files, print};
use std::time::{Duration, Instant};
use surfine_points::ply::{self, PlyError, Provenance, Source};
use surfine_points::{PointSet, Values};

pub(crate) fn run(args: &RefineArgs) -> Result<(), Failure> {
    check_paths(args)?;
    backend::start_threads(args.threads)?;
    let report = refine(args, &Watch::new(args.quiet || args.json))?;
    if args.json {
        print(&format!("{}\n", serde_json::to_string_pretty(&report)?))
    } else if args.quiet {
        Ok(())
    } else {
        print(&report.to_string())
    }
}

/// Everything that can be refused before the input is read.
fn check_paths(args: &RefineArgs) -> Result<(), Failure> {
    if ply::same_file(&args.input, &args.output) {
        let output = args.output.display();
        return Err(Failure(format!("{output}: is the input too: give the output another name")));
    }
    files::check_output(&args.output)
}

fn refine(args: &RefineArgs, watch: &Watch) -> Result<Report, Failure> {
    watch.step(format!("reading {}", args.input.display()));
    let (read, input) = timed(|| ply::read(&args.input));
    let (points, source) = input?;
    check_attributes(args, &points)?;
    watch.step("preparing".into());
    let computed = backend::compute(args, &points, watch)?;
    watch.step(format!("writing {}", args.output.display()));
    let (write, written) = timed(|| write(args, &computed, &source));
    written?;
    let times = Times { read, setup: computed.setup, refine: computed.refine, write };
    Ok(Report::new(args, &points, &source, &computed, times))
}

fn timed<T>(work: impl FnOnce() -> T) -> (Duration, T) {
    let begin = Instant::now();
    let result = work();
    (begin.elapsed(), result)
}

fn write(args: &RefineArgs, computed: &Computed, source: &Source) -> Result<(), PlyError> {
    let refined = &computed.refined;
    let levels = refined.levels();
    let provenance = Provenance { levels: &levels, parents: &refined.parents };
    let provenance = args.provenance.then_some(provenance);
    let encoding = files::encoding(args.ascii);
    ply::write(&args.output, &refined.points, provenance, source, encoding)
}

/// Refuses attributes that could not be written, rather than after the computation.
fn check_attributes(args: &RefineArgs, points: &PointSet) -> Result<(), PlyError> {
    let path = || args.input.clone();
    let names = ["level", "parent0", "parent1", "parent2"];
    for attribute in &points.attributes {
        let name = || attribute.name.clone();
        if args.provenance && names.contains(&attribute.name.as_str()) {
            let problem = "the name is taken by --provenance: rename the property, or write none";
            return Err(PlyError::Property { path: path(), name: name(), problem: problem.into() });
        }
        if args.ascii
            && let Some(point) = first_not_finite(&attribute.values)
        {
            let problem = format!("vertex {point} has no finite value: leave --ascii out");
            return Err(PlyError::Property { path: path(), name: name(), problem });
        }
    }
    Ok(())
}

fn first_not_finite(values: &Values) -> Option<usize> {
    match values {
        Values::F32(values) => values.iter().position(|v| !v.is_finite()),
        Values::F64(values) => values.iter().position(|v| !v.is_finite()),
        _ => None,
    }
}
