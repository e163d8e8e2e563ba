//! Buffers that are longer than a binding may be: the same bytes through several windows.

use crate::clouds::{Cloud, variants, whole, whole_outlined};
use crate::harness::{FREE, device};
use crate::refine::{check_with, pipelines};
use surfine::testing::Kernel;
use surfine::testing::curves::Curves;
use surfine::testing::records::{Candidate, Params};
use surfine::testing::shaders::SHADERS;
use surfine::testing::{Buffer, Commands, Uniforms, constants, read};
use surfine::{Error, Gpu, Mode, RefineParams, Refiner, wgpu};

/// Bytes that the devices of these tests allow in a binding: a third of the largest buffers, and no multiple of a
/// record.
const BINDING: u64 = 100_000;

/// A device with small bindings.
pub(crate) fn small(features: wgpu::Features) -> Gpu {
    let adapter = surfine::choose_adapter(None).expect("the suite has an adapter");
    let usual = adapter.limits();
    let required_limits = wgpu::Limits {
        max_storage_buffer_binding_size: BINDING,
        // Hardware allows so many that nothing would ever be too long.
        max_storage_buffers_per_shader_stage: usual.max_storage_buffers_per_shader_stage.min(32),
        ..usual
    };
    let descriptor = wgpu::DeviceDescriptor {
        required_features: adapter.features() & features,
        required_limits,
        ..Default::default()
    };
    let opened = pollster::block_on(adapter.request_device(&descriptor));
    let (device, queue) = opened.expect("the adapter opens");
    Gpu::from_device(device, queue)
}

/// Storage buffers that a kernel may have on it.
pub(crate) fn bindings(gpu: &Gpu) -> u32 {
    gpu.device.limits().max_storage_buffers_per_shader_stage
}

fn kernel(gpu: &Gpu, name: &str) -> Kernel {
    let shader = SHADERS.iter().find(|s| s.name == name).expect("it is in the table");
    Kernel::new(gpu, shader, &constants(&RefineParams::default(), Curves::None))
        .expect("it compiles")
}

/// Runs a kernel alone.
fn run(
    gpu: &Gpu,
    kernel: &Kernel,
    params: Params,
    buffers: &[&Buffer],
    invocations: u32,
) -> Result<(), Error> {
    let uniforms = Uniforms::new(gpu);
    uniforms.set(gpu, &params);
    let mut commands = Commands::new(gpu, &uniforms);
    pollster::block_on(async {
        commands.run(kernel, buffers, [0; 4], invocations).await;
        commands.finish().await
    })
}

fn check(refiner: &mut Refiner, cloud: &Cloud, params: &RefineParams, is_exact: bool) {
    let found = check_with(refiner, is_exact, cloud, params);
    assert!(32 * found.points.len() as u64 > 2 * BINDING, "{}: few bindings would do", cloud.name);
}

#[test]
fn buffers_that_an_earlier_run_left_long_have_one_binding_for_a_small_cloud() {
    let gpu = small(wgpu::Features::PASSTHROUGH_SHADERS);
    if bindings(&gpu) < 32 {
        // There no cloud that needs windows runs at all, as the next test asks.
        return;
    }
    let mut refiner = Refiner::with_gpu(gpu).expect("the kernels compile");
    let params = RefineParams { levels: 2, ..Default::default() };
    let cloud = whole().swap_remove(0).0.points;
    refiner.refine(&cloud, &params).expect("it fits in windows");
    let before = pipelines(&refiner);
    let tiny = surfine_points::shapes::icosphere(1);
    refiner.refine(&tiny, &RefineParams { levels: 1, ..params }).expect("it fits");
    // Kernels for other numbers of windows would have been compiled.
    assert_eq!(pipelines(&refiner), before);
}

#[test]
fn windows_give_the_bytes_of_whole_buffers() {
    let is_exact = device().is_exact();
    let gpu = small(wgpu::Features::PASSTHROUGH_SHADERS);
    let bindings = bindings(&gpu);
    let mut refiner = Refiner::with_gpu(gpu).expect("the kernels compile");
    let cloud = |i| whole().swap_remove(i).0;
    let cube = whole_outlined().swap_remove(0).0;
    if bindings < 32 {
        // Ten storage buffers a stage leave none for further windows, a few more may be too few.
        let params = RefineParams { levels: 3, ..Default::default() };
        match refiner.refine(&cube.points, &params) {
            Err(Error::TooLarge { .. } | Error::Limit { .. } | Error::Bindings { .. }) => (),
            Err(other) => panic!("{other}"),
            Ok(_) => assert!(bindings > 10, "{bindings} bindings do not suffice"),
        }
        return;
    }
    let [accurate, _, simplified, paper_loop, ..] = variants();
    for (cloud, params) in [(cloud(0), &accurate), (cloud(1), &simplified), (cloud(1), &paper_loop)]
    {
        check(&mut refiner, &cloud, &RefineParams { levels: 2, ..params.clone() }, is_exact);
    }
    let accurate = RefineParams { levels: 3, ..accurate };
    check(&mut refiner, &cube, &accurate, is_exact);
    // The rows of its many neighbours are done in parts that fit in one binding.
    check(&mut refiner, &cloud(5), &accurate, is_exact);
}

#[test]
fn plain_kernels_have_windows_too() {
    let gpu = small(wgpu::Features::empty());
    assert_eq!(gpu.mode, Mode::Plain);
    let state = |c| if c % 3 == 0 { FREE } else { 1 };
    let states = (0..6000).map(state);
    let candidates: Vec<_> =
        states.clone().map(|state| Candidate { state, ..Default::default() }).collect();
    let expected: Vec<u32> = states.map(|state| u32::from(state != FREE)).collect();
    let count = candidates.len();
    let params = Params { candidates: count as u32, ..Params::default() };
    let new_indices = Buffer::new(&gpu, "indices", 4 * (count as u64 + 1)).expect("it fits");
    if let Ok(candidates) = Buffer::with_data(&gpu, "candidates", &candidates) {
        let kernel = kernel(&gpu, "commit_count");
        run(&gpu, &kernel, params, &[&candidates, &new_indices], count as u32).expect("it runs");
        let found: Vec<u32> = read(&gpu, new_indices.raw(), count + 1).expect("it is alive");
        assert_eq!(found[1..], expected);
    } else {
        assert!(
            bindings(&gpu) < 32,
            "three windows are too many only where hardly any is to spare"
        );
    }
}

#[test]
fn a_kernel_that_needs_too_many_windows_says_so() {
    let gpu = small(wgpu::Features::PASSTHROUGH_SHADERS);
    // Six buffers of as many windows as the largest one may have.
    let bytes = gpu.largest_buffer();
    let buffers = [(); 6].map(|()| Buffer::new(&gpu, "any", bytes).expect("it is allowed"));
    let windows = 6 * bytes.div_ceil(BINDING) as u32;
    match run(&gpu, &kernel(&gpu, "commit"), Params::default(), &buffers.each_ref(), 0) {
        Err(failure @ Error::Bindings { need, .. }) => {
            assert!(need >= windows && need > bindings(&gpu), "{failure}");
            assert!(failure.to_string().contains("use fewer levels"), "{failure}");
        }
        // Ten bindings leave none to spare, so that buffers have one window each.
        Ok(()) => assert!(windows <= bindings(&gpu), "{windows} windows"),
        Err(other) => panic!("{other}"),
    }
}
