//! `surfine refine`.

mod backend;
mod dry_run;
mod report;
mod stats;

use crate::args::RefineArgs;
use crate::watch::Watch;
use crate::{Failure, files, fill};
use backend::Computed;
use report::{Input, Report, Times};
use std::time::{Duration, Instant};
use surfine_points::ply::{self, PlyError, Provenance, Source};
use surfine_points::{Convergence, Interpolation, PointSet, Values};

pub(crate) fn run(args: &RefineArgs) -> Result<(), Failure> {
    // Everything that can be refused before the input is read.
    files::check_cloud(&args.output, &args.input)?;
    args.threads.start()?;
    if args.dry_run {
        return dry_run::run(args);
    }
    let report = refine(args, &args.summary.watch())?;
    args.summary.print(&report)
}

fn refine(args: &RefineArgs, watch: &Watch) -> Result<Report, Failure> {
    let (read, input) = timed(|| read(args, watch));
    let (points, source) = input?;
    let choice = args.fill_holes();
    let (fill, filled) = timed(|| fill::filled(&args.input, &points, &choice, watch));
    let filled = filled?;
    watch.step("preparing".into());
    let computed = backend::compute(args, &filled.points, watch)?;
    watch.step(format!("writing {}", args.output.display()));
    let (write, written) = timed(|| write(args, &computed, &source));
    written?;
    let (stats, levels) = timed(|| {
        args.shows_stats().then(|| {
            watch.step("measuring the levels".into());
            Convergence::by_level(&computed.refined)
        })
    });
    let (setup, refine) = (computed.setup, computed.refine);
    let times = Times { read, fill, setup, refine, write, stats };
    let input = Input { points: &points, filled: &filled, source: &source };
    Ok(Report::new(args, input, &computed, levels, times))
}

/// Reads the input and refuses what does not fit the arguments.
fn read(args: &RefineArgs, watch: &Watch) -> Result<(PointSet, Source), Failure> {
    watch.step(format!("reading {}", args.input.display()));
    let (mut points, source) = ply::read(&args.input)?;
    set_attribute_rules(args, &mut points)?;
    check_boundary_property(args, &points)?;
    check_attributes(args, &points)?;
    Ok((points, source))
}

/// Gives the properties the rules that the user asks for.
fn set_attribute_rules(args: &RefineArgs, points: &mut PointSet) -> Result<(), Failure> {
    for (names, rule) in &args.attribute {
        let mut found = Vec::new();
        for name in names {
            let place = points.attributes.iter().position(|a| a.name == *name);
            let missing = || {
                let input = args.input.display();
                Failure(format!(
                    "{input}: there is no property {name} to be interpolated: check --attribute"
                ))
            };
            found.push(place.ok_or_else(missing)?);
        }
        if *rule == Interpolation::Unit {
            let fits = found.iter().all(|&i| points.attributes[i].values.is_float());
            // Their columns must follow each other, so that they are taken for one direction.
            if !fits || found[1] != found[0] + 1 || found[2] != found[1] + 1 {
                let (input, names) = (args.input.display(), names.join(", "));
                return Err(Failure(format!(
                    "{input}: {names} are no direction: they must be floats and follow each other in the file"
                )));
            }
        }
        found.into_iter().for_each(|i| points.attributes[i].interpolation = *rule);
    }
    Ok(())
}

/// Refuses a property that is to mark the boundary and is not there.
fn check_boundary_property(args: &RefineArgs, points: &PointSet) -> Result<(), Failure> {
    match &args.boundary_property {
        Some(name) if points.attribute(name).is_none() => {
            let input = args.input.display();
            let remedy = "check --boundary-property";
            Err(Failure(format!(
                "{input}: there is no property {name} to mark the boundary: {remedy}"
            )))
        }
        _ => Ok(()),
    }
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
