//! Throughput of both backends: whole runs, several levels, and single stages, in new points a second.
//!
//! `cargo bench --bench throughput` measures with the adapter that `WGPU_ADAPTER_NAME` names, else with the best one,
//! for some ten minutes where that is a software adapter. `-- stage` or any other part of an id picks some of them;
//! making the clouds takes up to a minute all the same. `-- --test` runs each once, on small clouds.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, SamplingMode, Throughput};
use std::time::Duration;
use surfine::wgpu::{AdapterInfo, DeviceType};
use surfine::{Gpu, LevelReport, PointSet, RefineParams, Refiner, choose_adapter};
use surfine_points::shapes::{Sampling, Shape, sample};
use surfine_reference as reference;

/// Samples of a benchmark: criterion's least, since runs of this length vary little.
const SAMPLES: usize = 10;

/// A GPU, if there is one, with what is known of its adapter.
type Device = Option<(Refiner, AdapterInfo)>;

/// A cloud to refine, and how many points its refinement adds.
struct Case {
    name: &'static str,
    points: PointSet,
    params: RefineParams,
    new_points: u64,
    /// Whether a software adapter would take minutes for each run.
    is_large: bool,
}

impl Case {
    fn new(name: &'static str, points: PointSet, levels: u32) -> Self {
        Self::with_params(name, points, RefineParams { levels, ..RefineParams::default() })
    }

    fn with_params(name: &'static str, points: PointSet, params: RefineParams) -> Self {
        let refined = reference::refine(&points, &params).expect("generated clouds are fit");
        let is_large = points.len() > 200_000;
        Self { name, points, params, new_points: refined.parents.len() as u64, is_large }
    }
}

/// An even but irregular cloud.
fn sphere(points: usize) -> PointSet {
    sample(Shape::Sphere, Sampling::BlueNoise, points, 1)
}

/// About 900,000 points, as refinement leaves them: blue noise of that size takes a minute to make.
fn large_sphere() -> PointSet {
    let params = RefineParams { levels: 2, ..RefineParams::default() };
    reference::refine(&sphere(100_000), &params).expect("generated clouds are fit").points
}

/// The clouds that are refined once. A test of the benchmarks is content with small ones.
fn cases(is_test: bool) -> Vec<Case> {
    let mut cases = vec![Case::new("1k", sphere(1_000), 1), Case::new("10k", sphere(10_000), 1)];
    if !is_test {
        cases.push(Case::new("100k", sphere(100_000), 1));
        cases.push(Case::new("900k", large_sphere(), 1));
    }
    cases
}

/// Opens the GPU and says what is measured.
fn open() -> Device {
    println!("CPU: {} threads", rayon::current_num_threads());
    let opened = choose_adapter(None)
        .and_then(|adapter| Ok((Refiner::with_gpu(Gpu::open(&adapter)?)?, adapter.get_info())));
    match opened {
        Ok((refiner, info)) => {
            let AdapterInfo { name, driver, driver_info, backend, .. } = &info;
            let mode = refiner.gpu().mode.name();
            println!("GPU: {name}, driver {driver} {driver_info}, {backend}, mode {mode}");
            Some((refiner, info))
        }
        Err(error) => {
            println!("no GPU adapter: CPU only ({error})");
            None
        }
    }
}

/// Whole runs of both backends, with the way of the points to the device and back.
fn bench_runs(
    group: &mut BenchmarkGroup<'_, WallTime>,
    case: &Case,
    id: &str,
    device: &mut Device,
) {
    let Case { points, params, .. } = case;
    group.throughput(Throughput::Elements(case.new_points));
    group.bench_function(BenchmarkId::new("cpu", id), |b| {
        b.iter(|| reference::refine(points, params).expect("it ran before"));
    });
    let Some((refiner, info)) = device else { return };
    if case.is_large && info.device_type == DeviceType::Cpu {
        println!("{} points: too slow for a software adapter", case.name);
        return;
    }
    group.bench_function(BenchmarkId::new("gpu", id), |b| {
        b.iter(|| refiner.refine(points, params).expect("the adapter can do it"));
    });
}

/// A group whose benchmarks are few and long.
fn group<'a>(criterion: &'a mut Criterion, name: &str) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(SAMPLES).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_secs(1));
    group
}

/// Reports of one run after the other, kept so that all stages are taken from the same runs.
struct Runs<'a> {
    refine: Box<dyn FnMut() -> LevelReport + 'a>,
    reports: Vec<LevelReport>,
}

impl Runs<'_> {
    /// The report of one run. Runs that were not there yet are made.
    fn report(&mut self, run: usize) -> &LevelReport {
        while self.reports.len() <= run {
            let report = (self.refine)();
            self.reports.push(report);
        }
        &self.reports[run]
    }

    /// Time of one stage in one run; never zero, which would stop criterion.
    fn time(&mut self, stage: usize, run: usize) -> Duration {
        self.report(run).stages[stage].1.max(Duration::from_nanos(1))
    }
}

/// One benchmark a stage, from the times that the runs themselves report.
fn bench_stages(
    group: &mut BenchmarkGroup<'_, WallTime>,
    case: &Case,
    backend: &str,
    refine: impl FnMut() -> LevelReport,
) {
    let mut runs = Runs { refine: Box::new(refine), reports: Vec::new() };
    let stages: Vec<&str> = runs.report(0).stages.iter().map(|(stage, _)| *stage).collect();
    group.throughput(Throughput::Elements(case.new_points));
    // Criterion plans by the time that a call takes, which says nothing here. This keeps it from warming up, and from
    // warnings of too little time.
    group.warm_up_time(Duration::from_nanos(1));
    group.measurement_time(Duration::from_millis(1));
    for (index, stage) in stages.into_iter().enumerate() {
        let id = BenchmarkId::new(stage, format!("{backend}/{}", case.name));
        let mut samples = 0..;
        group.bench_function(id, |b| {
            // A sample is one run, whatever number of iterations is asked for.
            b.iter_custom(|iterations| {
                let run = samples.next().expect("the range is endless");
                runs.time(index, run) * iterations as u32
            });
        });
    }
}

fn bench(criterion: &mut Criterion, is_test: bool) {
    let mut device = open();
    println!("making the clouds");
    let cases = cases(is_test);
    let mut refine = group(criterion, "refine");
    for case in &cases {
        bench_runs(&mut refine, case, case.name, &mut device);
    }
    refine.finish();

    let mut levels = group(criterion, "levels");
    let (name, points) = if is_test { ("1k", 1_000) } else { ("50k", 50_000) };
    let cloud = sphere(points);
    let simplified = RefineParams { levels: 3, simplified: true, ..RefineParams::default() };
    for case in
        [Case::new(name, cloud.clone(), 3), Case::with_params("simplified", cloud, simplified)]
    {
        bench_runs(&mut levels, &case, case.name, &mut device);
    }
    levels.finish();

    let case = cases.iter().find(|case| case.name == "10k").expect("it is in both lists");
    let Case { points, params, .. } = case;
    let mut stage = group(criterion, "stage");
    bench_stages(&mut stage, case, "cpu", || {
        reference::refine(points, params).expect("it ran before").reports.remove(0)
    });
    if let Some((refiner, _)) = &mut device {
        bench_stages(&mut stage, case, "gpu", || {
            refiner.refine(points, params).expect("it ran before").reports.remove(0)
        });
    }
    stage.finish();
}

fn main() {
    // `cargo test` runs it without `--bench`, `cargo bench -- --test` with both.
    let given = |flag: &str| std::env::args().any(|argument| argument == flag);
    let is_test = given("--test") || !given("--bench");
    let mut criterion = Criterion::default().configure_from_args();
    bench(&mut criterion, is_test);
    criterion.final_summary();
}
