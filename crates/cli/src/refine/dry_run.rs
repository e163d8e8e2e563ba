//! `surfine refine --dry-run`: what a refinement would take.

mod pace;
mod report;

use super::backend::{Choice, fallback_after};
use crate::args::RefineArgs;
use crate::need::Need;
use crate::watch::Watch;
use crate::{Failure, files, fill};
use pace::Pace;
use report::{Estimate, Report};
use surfine::{Error, Gpu, PointSet, RefineParams, Refiner, wgpu};
use surfine_points::ply;

pub(super) fn run(args: &RefineArgs) -> Result<(), Failure> {
    let report = report(args, &args.summary.watch())?;
    args.summary.print(&report)
}

fn report(args: &RefineArgs, watch: &Watch) -> Result<Report, Failure> {
    let (points, source) = super::read(args, watch)?;
    // It takes as long as it will, but far less than the refinement, and may refuse.
    let filled = fill::filled(&args.input, &points, &args.fill_holes(), watch)?;
    let Plan { need, pace, fallback } = plan(args, &filled.points, watch)?;
    let size = need.size();
    let encoding = files::encoding(args.ascii);
    let output_bytes = ply::file_size(&filled.points, size, args.provenance, &source, encoding)?;
    let fits = need.fits()?;
    let estimate = Estimate { need, pace, output_bytes, fits };
    let mut notes: Vec<String> = fallback.into_iter().chain(source.notes).collect();
    notes.extend(fill::fill_notes(&args.fill_holes(), &filled));
    Ok(Report::new(args, points.len(), filled.points.len() - points.len(), estimate, notes))
}

/// What the backend that would be taken needs, and how fast it is.
struct Plan {
    need: Need,
    pace: Pace,
    /// Why it is the CPU although it might have been a GPU.
    fallback: Option<String>,
}

fn plan(args: &RefineArgs, points: &PointSet, watch: &Watch) -> Result<Plan, Failure> {
    let params = args.params();
    let fallback = match Choice::of(args)? {
        Choice::Cpu { fallback } => fallback,
        Choice::Gpu { adapter, or_cpu } => match on_gpu(&adapter, points, &params, watch) {
            Err(error) if or_cpu => Some(fallback_after(error)?),
            result => return Ok(result?),
        },
    };
    Ok(Plan { fallback, ..on_cpu(points, &params, watch)? })
}

fn on_cpu(points: &PointSet, params: &RefineParams, watch: &Watch) -> Result<Plan, Failure> {
    // No step, but every check before the first one.
    let none = RefineParams { levels: 0, ..params.clone() };
    surfine_reference::refine(points, &none)?;
    let need = Need::of_cpu(points, params);
    need.fits()?;
    watch.step("measuring the pace".into());
    let size = need.size();
    let pace = Pace::measure(params, size, &mut |points, params| {
        Ok::<_, Failure>(surfine_reference::refine(points, params)?.points.len())
    })?;
    Ok(Plan { need, pace, fallback: None })
}

fn on_gpu(
    adapter: &wgpu::Adapter,
    points: &PointSet,
    params: &RefineParams,
    watch: &Watch,
) -> Result<Plan, Error> {
    let mut refiner = Refiner::with_gpu(Gpu::open(adapter)?)?;
    let need = Need::of_gpu(&refiner, points, params)?;
    watch.step("measuring the pace".into());
    let size = need.size();
    let pace = Pace::measure(params, size, &mut |points, params| {
        Ok::<_, Error>(refiner.refine(points, params)?.points.len())
    })?;
    Ok(Plan { need, pace, fallback: None })
}
