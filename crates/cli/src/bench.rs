//! `surfine bench`.

mod clouds;
mod compare;
mod device;
mod forecast;
mod measure;
mod report;
mod slices;
mod table;

use crate::args::{BenchArgs, BenchBackend};
use crate::summary::Params;
use crate::watch::Watch;
use crate::{Failure, print, print_json};
use clouds::Cloud;
use device::{Choice, Device};
use forecast::Forecast;
use measure::{Measured, Plan, on_cpu, on_gpu};
use report::{Case, Cpu, LeftOut, Report};
use surfine::{Error, RefineParams};

pub(crate) fn run(args: &BenchArgs) -> Result<(), Failure> {
    args.threads.start()?;
    let report = {
        let watch = Watch::new(args.quiet || args.json);
        Bench::open(args, &watch)?.report()?
    };
    if args.json {
        print_json(&report)?;
    } else {
        print(&report.to_string())?;
    }
    if report.shows_bug() {
        let bug =
            "the backends differ although this adapter must give the same bytes: this is a bug";
        return Err(Failure(format!("{bug}: please report it with the output above")));
    }
    Ok(())
}

/// The backends, and what became known of them.
struct Bench<'a> {
    args: &'a BenchArgs,
    watch: &'a Watch,
    params: RefineParams,
    cpu: Option<Forecast>,
    gpu: Option<(Device, Forecast)>,
    left_out: Vec<LeftOut>,
    notes: Vec<String>,
}

/// Which backends refine a cloud.
struct Wanted {
    cpu: bool,
    gpu: bool,
}

impl<'a> Bench<'a> {
    fn open(args: &'a BenchArgs, watch: &'a Watch) -> Result<Self, Failure> {
        watch.step("opening the adapter".into());
        let Choice { device, note } = device::open(args)?;
        if let Some(note) = note.as_ref().filter(|_| !args.quiet) {
            watch.warn(note);
        }
        let has_cpu = match args.backend() {
            BenchBackend::Both | BenchBackend::Cpu => true,
            BenchBackend::Auto => device.is_none(),
            BenchBackend::Gpu => false,
        };
        let is_limited = !args.sizes().1;
        let cpu = has_cpu.then(|| Forecast::of_cpu(is_limited));
        let gpu = device.map(|device| {
            let forecast = Forecast::of_gpu(is_limited, device.is_on_host);
            (device, forecast)
        });
        let notes = note.into_iter().collect();
        Ok(Self { args, watch, params: args.params(), cpu, gpu, left_out: Vec::new(), notes })
    }

    /// Measures everything.
    fn report(mut self) -> Result<Report, Failure> {
        let cases = match &self.args.input {
            Some(path) => {
                let cloud = clouds::read(path, self.args, self.watch)?;
                let wanted = Wanted { cpu: self.cpu.is_some(), gpu: self.gpu.is_some() };
                self.case(None, cloud, &wanted)?.into_iter().collect()
            }
            None => self.spheres()?,
        };
        if cases.is_empty() {
            let why: Vec<String> = self.left_out.iter().map(LeftOut::to_string).collect();
            return Err(Failure(format!("nothing was measured: {}", why.join("; "))));
        }
        let cpu = self.cpu.is_some().then(|| Cpu { threads: rayon::current_num_threads() });
        Ok(Report {
            version: env!("CARGO_PKG_VERSION"),
            cpu,
            gpu: self.gpu.map(|(device, _)| device.report),
            params: Params::new(&self.params),
            runs: self.args.runs,
            cases,
            left_out: self.left_out,
            notes: self.notes,
        })
    }

    fn spheres(&mut self) -> Result<Vec<Case>, Failure> {
        let mut cases = Vec::new();
        for size in self.args.sizes().0 {
            let points = clouds::points_in(size, self.params.levels);
            let wanted = self.wanted(size, points.is_some());
            if let Some(points) = points.filter(|_| wanted.cpu || wanted.gpu) {
                self.watch.step(format!("making a sphere of {points} points"));
                let cloud = clouds::sphere(points)?;
                cases.extend(self.case(Some(size), cloud, &wanted)?);
            }
        }
        Ok(cases)
    }

    /// Which backends refine a sphere to that size. Those that don't are noted.
    fn wanted(&mut self, size: usize, can_begin: bool) -> Wanted {
        let too_small = || format!("too few for {} levels", self.params.levels);
        let objection = |forecast: &Forecast| match can_begin {
            true => forecast.objection(size),
            false => Some(too_small()),
        };
        let forecasts = [self.cpu.as_ref(), self.gpu.as_ref().map(|(_, forecast)| forecast)];
        let [cpu, gpu] = forecasts.map(|forecast| forecast.map(objection));
        let wanted = Wanted { cpu: cpu == Some(None), gpu: gpu == Some(None) };
        for (backend, why) in [("cpu", cpu), ("gpu", gpu)] {
            let left_out = why.flatten().map(|why| LeftOut { size: Some(size), backend, why });
            self.left_out.extend(left_out);
        }
        wanted
    }

    /// Refines a cloud with both backends. None if neither could.
    fn case(
        &mut self,
        size: Option<usize>,
        cloud: Cloud,
        wanted: &Wanted,
    ) -> Result<Option<Case>, Failure> {
        let cpu = if wanted.cpu { Some(self.on_cpu(&cloud)?) } else { None };
        let gpu = if wanted.gpu { self.on_gpu(size, &cloud)? } else { None };
        if cpu.is_none() && gpu.is_none() {
            return Ok(None);
        }
        self.watch.step("comparing".into());
        let both = cpu.as_ref().zip(gpu.as_ref());
        let difference = both.and_then(|(c, g)| compare::difference(&c.refined, &g.refined));
        Ok(Some(Case::new(size, cloud, cpu.as_ref(), gpu.as_ref(), difference)))
    }

    fn on_cpu(&mut self, cloud: &Cloud) -> Result<Measured, Failure> {
        let tell = |run: &str| self.tell("cpu", cloud, run);
        let measured = on_cpu(&self.plan(cloud, &tell))?;
        self.cpu.iter_mut().for_each(|forecast| forecast.learn(&measured));
        Ok(measured)
    }

    /// What the device could not do is noted, for others may do it.
    fn on_gpu(&mut self, size: Option<usize>, cloud: &Cloud) -> Result<Option<Measured>, Failure> {
        let Some((mut device, mut forecast)) = self.gpu.take() else { return Ok(None) };
        let tell = |run: &str| self.tell("gpu", cloud, run);
        let plan = self.plan(cloud, &tell);
        let mut result = on_gpu(&plan, &mut device.refiner);
        if let (Some(budget), Ok(measured)) = (self.args.slice, &mut result) {
            let sliced;
            (device.refiner, sliced) = slices::in_slices(device.refiner, &plan, budget);
            match sliced {
                Ok(sliced) => measured.sliced = sliced,
                Err(error) => result = Err(error),
            }
        }
        match &result {
            Ok(measured) => forecast.learn(measured),
            Err(error) => {
                let why = error.to_string();
                forecast.fail(format!("a smaller one failed: {why}"));
                self.left_out.push(LeftOut { size, backend: "gpu", why });
            }
        }
        self.gpu = Some((device, forecast));
        match result {
            // The CPU would refuse them too.
            Err(error @ (Error::Points(_) | Error::Params(_))) => Err(error.into()),
            result => Ok(result.ok()),
        }
    }

    fn tell(&self, backend: &str, cloud: &Cloud, run: &str) {
        self.watch.step(format!("{backend}, {} points to refine: {run}", cloud.points.len()));
    }

    fn plan<'b>(&'b self, cloud: &'b Cloud, tell: &'b dyn Fn(&str)) -> Plan<'b> {
        Plan { points: &cloud.points, params: &self.params, runs: self.args.runs, tell }
    }
}

/// 25000, 100k, 2M.
fn short(count: usize) -> String {
    match count {
        0 => "0".into(),
        _ if count.is_multiple_of(1_000_000) => format!("{}M", count / 1_000_000),
        _ if count.is_multiple_of(1_000) => format!("{}k", count / 1_000),
        _ => count.to_string(),
    }
}
