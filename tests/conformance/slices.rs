//! Runs in slices: the bytes of whole runs, however they are cut, dropped or mixed with other work.

use crate::clouds::{whole, whole_outlined};
use crate::harness::device;
use crate::windows::{bindings, small};
use std::time::Duration;
use surfine::testing::{Sizing, read};
use surfine::{
    Error, Gpu, GpuRefined, LevelReport, PointSet, RefineParams, Refiner, Rules, Slices, wgpu,
};

/// So little that each slice holds a workgroup.
const TINY: Duration = Duration::from_nanos(1);

/// Everything that a run leaves on the device, and what it reports but for times.
#[derive(PartialEq)]
struct Contents {
    points: Vec<u32>,
    parents: Vec<u32>,
    level_sizes: Vec<usize>,
    level_radii: Vec<Vec<f32>>,
    reports: Vec<LevelReport>,
}

fn contents(gpu: &Gpu, result: &GpuRefined) -> Contents {
    let words = |buffer, count| read::<u32>(gpu, buffer, count).expect("the device is alive");
    let untimed = |report: &LevelReport| LevelReport { stages: Vec::new(), ..report.clone() };
    Contents {
        points: words(&result.points, 8 * result.len()),
        parents: words(&result.parents, 3 * (result.len() - result.level_sizes[0])),
        level_sizes: result.level_sizes.clone(),
        level_radii: result.level_radii.clone(),
        reports: result.reports.iter().map(untimed).collect(),
    }
}

/// The same cloud refined at once.
fn at_once(refiner: &mut Refiner, points: &PointSet, params: &RefineParams) -> Contents {
    let result = refiner.refine_on_device(points, params, &mut |_| ()).expect("it runs");
    contents(refiner.gpu(), &result)
}

/// Drives a run to its end, with budgets in turn. Returns the number of calls too.
fn drive(run: &mut Slices, budgets: &[Duration]) -> Result<(GpuRefined, usize), Error> {
    for (calls, budget) in (1..).zip(budgets.iter().cycle()) {
        if let Some(result) = run.advance(*budget)? {
            return Ok((result, calls));
        }
    }
    unreachable!("the budgets never end")
}

/// A refiner beside the shared one.
fn own_refiner(gpu: &Gpu) -> Refiner {
    Refiner::with_gpu(gpu.clone()).expect("the kernels compile")
}

fn cases() -> Vec<(PointSet, RefineParams)> {
    let params = RefineParams { levels: 2, ..RefineParams::default() };
    let sphere = whole().swap_remove(0).0.points;
    let crowded = whole().swap_remove(5).0.points;
    let cube = whole_outlined().swap_remove(0).0.points;
    vec![
        (sphere.clone(), RefineParams { simplified: true, ..params.clone() }),
        (sphere, RefineParams { keep_radii: true, ..params.clone() }),
        (cube, params.clone()),
        (crowded, params),
    ]
}

#[test]
fn slices_give_the_bytes_of_a_whole_run() {
    let device = device();
    let mut refiner = own_refiner(device.gpu());
    let budgets = [TINY, Duration::from_micros(300), TINY, Duration::from_millis(2)];
    for (points, params) in cases() {
        let expected = at_once(&mut refiner, &points, &params);
        for (budgets, least) in [(&budgets[..1], 300), (&budgets, 50)] {
            let mut run = refiner.begin(points.clone(), params.clone());
            let (result, calls) = drive(&mut run, budgets).expect("it runs");
            assert_eq!(run.progress().map(|p| (p.stage, p.level)), Some(("commit", 2)));
            refiner = run.into_refiner();
            assert!(calls > least, "{calls} calls");
            assert!(contents(device.gpu(), &result) == expected, "{params:?}, {calls} calls");
        }
    }
}

#[test]
fn slices_of_buffers_in_windows_give_the_bytes_of_a_whole_run() {
    let gpu = small(wgpu::Features::PASSTHROUGH_SHADERS);
    let (points, params) = cases().swap_remove(1);
    // Kernels for the windows are compiled in slices, then once more for the whole run.
    let mut run = own_refiner(&gpu).begin(points.clone(), params.clone());
    let sliced = drive(&mut run, &[TINY, Duration::from_micros(300)]);
    let whole = own_refiner(&gpu).refine_on_device(&points, &params, &mut |_| ());
    match (sliced, whole) {
        (Ok((sliced, _)), Ok(whole)) => {
            assert!(contents(&gpu, &sliced) == contents(&gpu, &whole));
        }
        // Ten storage buffers leave none for further windows.
        (Err(sliced), Err(whole)) => {
            assert!(bindings(&gpu) < 32, "{whole}");
            assert_eq!(sliced.to_string(), whole.to_string());
        }
        (sliced, whole) => panic!("{:?} and {:?}", sliced.err(), whole.err()),
    }
}

#[test]
fn slices_of_stages_that_run_again_give_the_bytes_of_a_whole_run() {
    let device = device();
    let mut refiner = own_refiner(device.gpu());
    let (points, params) = cases().pop().expect("there are some");
    let rules = Rules { largest_first: false, ..Rules::ALL };
    for params in [RefineParams { rules, ..params.clone() }, params] {
        let expected = at_once(&mut refiner, &points, &params);
        let mut refiner = own_refiner(device.gpu());
        refiner.set_sizing(Sizing { chunk: 100, part: 7, entries: 1, rounds: 1 });
        let mut run = refiner.begin(points.clone(), params);
        let (result, _) = drive(&mut run, &[TINY, Duration::from_micros(300)]).expect("it runs");
        assert!(contents(device.gpu(), &result) == expected);
    }
}

#[test]
fn a_dropped_run_leaves_the_refiner_fit() {
    let device = device();
    let mut refiner = own_refiner(device.gpu());
    for (points, params) in cases() {
        let expected = at_once(&mut refiner, &points, &params);
        for calls in [0, 1, 2, 40, 160] {
            let mut run = refiner.begin(points.clone(), params.clone());
            for _ in 0..calls {
                assert!(run.advance(TINY).expect("it runs").is_none());
            }
            refiner = run.into_refiner();
            assert!(at_once(&mut refiner, &points, &params) == expected, "after {calls} calls");
        }
    }
}

#[test]
fn the_caller_submits_work_of_his_own_between_slices() {
    let device = device();
    let gpu = device.gpu();
    let mut refiner = own_refiner(gpu);
    let (points, params) = cases().swap_remove(1);
    let expected = at_once(&mut refiner, &points, &params);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("the caller's"),
        size: 4,
        usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut run = refiner.begin(points, params);
    // The first call is the longest of the host's: it can be made elsewhere.
    let first = std::thread::spawn(move || run.advance(TINY).map(|none| (run, none)));
    let (mut run, none) = first.join().expect("it does not panic").expect("it runs");
    assert!(none.is_none());
    let mut calls = 0u32;
    let result = loop {
        calls += 1;
        gpu.queue.write_buffer(&buffer, 0, &calls.to_le_bytes());
        gpu.queue.submit([]);
        if let Some(result) = run.advance(Duration::from_micros(100)).expect("it runs") {
            break result;
        }
        // Seen at once, whatever the run still does.
        if calls.is_multiple_of(16) {
            assert_eq!(read::<u32>(gpu, &buffer, 1).expect("the device is alive"), [calls]);
        }
    };
    assert!(calls > 50, "{calls} calls");
    assert!(contents(gpu, &result) == expected);
}

#[test]
fn a_run_in_slices_leaves_the_callers_errors_to_him() {
    let device = device();
    let gpu = device.gpu();
    let (points, params) = cases().swap_remove(1);
    let mut run = own_refiner(gpu).begin(points, params);
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    for call in 0..20 {
        assert!(run.advance(TINY).expect("the caller's error is not the run's").is_none());
        if call == 10 {
            // Nothing can be mapped for both.
            let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::MAP_WRITE;
            let descriptor = wgpu::BufferDescriptor {
                label: None,
                size: 4,
                usage: usage | wgpu::BufferUsages::STORAGE,
                mapped_at_creation: false,
            };
            drop(gpu.device.create_buffer(&descriptor));
        }
    }
    assert!(pollster::block_on(scope.pop()).is_some(), "the caller's error was swallowed");
    drive(&mut run, &[Duration::from_millis(4)]).expect("it runs");
}

#[test]
fn a_failed_run_is_told_and_leaves_the_refiner_fit() {
    let device = device();
    let mut refiner = own_refiner(device.gpu());
    let (points, params) = cases().swap_remove(1);
    let expected = at_once(&mut refiner, &points, &params);
    let mut unfit = points.clone();
    unfit.radii[3] = f32::NAN;
    // Software drivers end its loops early; others refine it.
    let mut crowded = points.clone();
    crowded.radii.iter_mut().for_each(|r| *r = 3.0);
    for (cloud, must_fail) in [(unfit, true), (crowded, device.is_exact())] {
        let whole = refiner.refine_on_device(&cloud, &params, &mut |_| ()).map(|_| ());
        let mut run = refiner.begin(cloud, params.clone());
        let sliced = drive(&mut run, &[Duration::from_millis(1)]).map(|_| ());
        assert!(sliced.is_err() || !must_fail);
        assert_eq!(sliced.map_err(|e| e.to_string()), whole.map_err(|e| e.to_string()));
        refiner = run.into_refiner();
        assert!(at_once(&mut refiner, &points, &params) == expected);
    }
}

#[test]
fn slices_need_no_timestamps() {
    // The shared device rests meanwhile.
    let _device = device();
    let adapter = surfine::choose_adapter(None).expect("the suite has an adapter");
    let required_limits = adapter.limits();
    let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
    let opened = pollster::block_on(adapter.request_device(&descriptor));
    let (own_device, queue) = opened.expect("the adapter opens");
    let mut refiner = Refiner::with_device(own_device, queue).expect("the kernels compile");
    assert!(!refiner.gpu().device.features().contains(wgpu::Features::TIMESTAMP_QUERY));
    let (points, params) = cases().swap_remove(1);
    let expected = at_once(&mut refiner, &points, &params);
    for budget in [TINY, Duration::from_millis(1)] {
        let mut run = refiner.begin(points.clone(), params.clone());
        let (result, calls) = drive(&mut run, &[budget]).expect("it runs");
        refiner = run.into_refiner();
        assert!(calls > 50, "{calls} calls");
        assert!(contents(refiner.gpu(), &result) == expected);
    }
}

#[test]
fn kernels_are_profiled_in_slices_too() {
    let device = device();
    let mut refiner = own_refiner(device.gpu());
    if refiner.set_profiling(true).is_err() {
        return;
    }
    let (points, params) = cases().swap_remove(1);
    let mut run = refiner.begin(points, params);
    drive(&mut run, &[TINY]).expect("it runs");
    let profile = run.into_refiner().take_profile();
    let dispatches = |kernel| profile.iter().find(|t| t.kernel == kernel).map(|t| t.dispatches);
    // A workgroup each, in two steps of 1000 and of some 3000 points.
    assert!(dispatches("neighborhood").is_some_and(|n| n > 40), "{profile:?}");
}
