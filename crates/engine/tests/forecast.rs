//! What is foretold of a refinement against what it takes. Needs an adapter; a software one will do.

use surfine::{Error, Gpu, PointSet, RefineParams, Refiner, choose_adapter, wgpu};
use surfine_points::shapes::{Sampling, Shape, sample};

/// A refiner whose device allows so many bytes in a binding, and so many storage buffers in a stage.
fn refiner(largest_binding: u64, buffers: u32) -> Refiner {
    let adapter = choose_adapter(None).unwrap_or_else(|e| panic!("{e}"));
    let usual = adapter.limits();
    let required_limits = wgpu::Limits {
        max_storage_buffer_binding_size: largest_binding.min(usual.max_storage_buffer_binding_size),
        max_storage_buffers_per_shader_stage: buffers
            .min(usual.max_storage_buffers_per_shader_stage),
        ..usual
    };
    // Kernels are compiled as `Gpu::open` has them: software drivers take longer for the others.
    let required_features = adapter.features() & wgpu::Features::PASSTHROUGH_SHADERS;
    let descriptor =
        wgpu::DeviceDescriptor { required_features, required_limits, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
    Refiner::with_gpu(Gpu::from_device(device, queue)).unwrap()
}

fn levels(levels: u32) -> RefineParams {
    RefineParams { levels, ..RefineParams::default() }
}

/// Bytes that a new refiner took over those foretold, and over those foretold for uneven clouds.
fn ratios(points: &PointSet, params: &RefineParams) -> (f64, f64) {
    let mut refiner = refiner(u64::MAX, u32::MAX);
    let forecast = refiner.forecast(points, params).unwrap();
    let result = refiner.refine_on_device(points, params, &mut |_| ()).unwrap();
    assert_eq!(forecast.points_by_level.len(), result.level_sizes.len());
    for (&foretold, &found) in forecast.points_by_level.iter().zip(&result.level_sizes) {
        let ratio = found as f64 / foretold as f64;
        assert!((0.65..1.1).contains(&ratio), "{found} points, {foretold} foretold");
    }
    let found = result.device_bytes as f64;
    (found / forecast.device_bytes as f64, found / forecast.uneven_bytes as f64)
}

#[test]
fn even_clouds_take_what_is_foretold() {
    let sphere = sample(Shape::Sphere, Sampling::BlueNoise, 2000, 1);
    for count in [0, 1, 3] {
        let (even, uneven) = ratios(&sphere, &levels(count));
        // 0.996 to 1.001.
        assert!((0.97..1.03).contains(&even), "{count} levels: {even}");
        assert!(uneven < 1.0 || count == 0, "{count} levels: {uneven}");
    }
}

#[test]
fn uneven_clouds_take_no_more_than_is_foretold_for_them() {
    let random = sample(Shape::Torus, Sampling::Random, 2000, 1);
    let mut generous = random.clone();
    generous.radii.iter_mut().for_each(|radius| *radius *= 1.5);
    // .8 of what is foretold for even clouds, and a quarter of the other.
    let (even, uneven) = ratios(&random, &levels(2));
    assert!((0.6..2.0).contains(&even) && uneven < 1.0, "{even}, {uneven}");
    let (_, uneven) = ratios(&generous, &levels(1));
    assert!(uneven < 1.25, "with generous radii: {uneven}");
}

#[test]
fn what_is_sure_to_fail_fails_before_the_first_stage() {
    let mut refiner = refiner(1 << 20, 10);
    let sphere = sample(Shape::Sphere, Sampling::BlueNoise, 24_000, 1);
    let foretold = refiner.forecast(&sphere, &levels(2)).unwrap_err();
    let mut stages = Vec::new();
    let failure = refiner.refine_on_device(&sphere, &levels(2), &mut |at| stages.push(at.stage));
    let failure = failure.unwrap_err();
    assert_eq!(stages, [""; 0]);
    assert_eq!(failure.to_string(), foretold.to_string());
    let Error::TooLarge { level, levels, points, need, have, .. } = failure else {
        panic!("{failure}");
    };
    assert_eq!((level, levels, points), (1, 2, 24_000));
    assert!(need > have && have == 1 << 20, "{need} and {have}");
    // Without a step nothing but the cloud is needed.
    refiner.refine(&sphere, &self::levels(0)).unwrap();
}

#[test]
fn what_is_only_likely_to_fail_is_tried() {
    let mut refiner = refiner(1 << 20, 10);
    let sphere = sample(Shape::Sphere, Sampling::BlueNoise, 6800, 1);
    refiner.refine(&sphere, &levels(1)).unwrap();
    let forecast = refiner.forecast(&sphere, &levels(2)).unwrap();
    assert!(forecast.largest_buffer.1 > 1 << 20, "{forecast:?}");
    let mut last = String::new();
    let failure = refiner.refine_on_device(&sphere, &levels(2), &mut |at| {
        last = format!("{} of level {}", at.stage, at.level);
    });
    let failure = failure.unwrap_err();
    assert!(matches!(failure, Error::TooLarge { level: 2, .. }), "{failure}");
    assert_eq!(last, "commit of level 1");
    // Points without neighbours stay as few as they are.
    let mut lonely = sphere;
    lonely.radii.fill(1e-4);
    assert_eq!(refiner.refine(&lonely, &levels(2)).unwrap().points.len(), 6800);
}

#[test]
fn more_bindings_make_for_larger_buffers() {
    let largest = |buffers| refiner(1 << 20, buffers).gpu().largest_buffer();
    assert_eq!(largest(10), 1 << 20);
    let gpu = refiner(1 << 20, u32::MAX).gpu().clone();
    let spare = u64::from(gpu.device.limits().max_storage_buffers_per_shader_stage) - 10;
    let most = gpu.device.limits().max_buffer_size / 96 * 96;
    assert_eq!(gpu.largest_buffer(), most.min((1 << 20) + spare * (1 << 18)));
}
