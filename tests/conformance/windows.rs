//! Buffers that are longer than a binding may be: the same bytes through several windows.

use crate::clouds::{Cloud, describe, variants, whole, whole_outlined};
use crate::harness::device;
use crate::refine::{must_be_close, must_be_identical};
use surfine::testing::Sizing;
use surfine::{Error, Gpu, RefineParams, Refiner, wgpu};

/// Bytes that the devices of these tests allow in a binding: a tenth to a fifth of what the clouds need, and no multiple of a record.
const BINDING: u64 = 50_000;

/// A refiner whose device has small bindings, and whether its kernels may have more of them.
fn refiner() -> (Refiner, bool) {
    let adapter = surfine::choose_adapter(None).expect("the suite has an adapter");
    let limits = adapter.limits();
    let has_more = limits.max_storage_buffers_per_shader_stage >= 32;
    let descriptor = wgpu::DeviceDescriptor {
        required_features: adapter.features() & wgpu::Features::PASSTHROUGH_SHADERS,
        required_limits: wgpu::Limits { max_storage_buffer_binding_size: BINDING, ..limits },
        ..Default::default()
    };
    let (own, queue) =
        pollster::block_on(adapter.request_device(&descriptor)).expect("the adapter opens");
    (Refiner::with_gpu(Gpu::from_device(own, queue)).expect("the kernels compile"), has_more)
}

fn check(refiner: &mut Refiner, cloud: &Cloud, params: &RefineParams, is_exact: bool) {
    let name = format!("{} {} in windows", cloud.name, describe(params));
    let expected = surfine_reference::refine(&cloud.points, params).expect("the cloud is sound");
    let found = refiner.refine(&cloud.points, params).unwrap_or_else(|e| panic!("{name}: {e}"));
    let bytes = 32 * found.points.len() as u64;
    assert!(bytes > 3 * BINDING, "{name}: {bytes} bytes of points are no more than few bindings");
    if is_exact {
        must_be_identical(&name, &expected, &found);
    } else {
        must_be_close(&name, &expected, &found);
    }
}

#[test]
fn windows_give_the_bytes_of_whole_buffers() {
    let is_exact = device().is_exact();
    let (mut refiner, has_more) = refiner();
    let clouds = || [whole().swap_remove(0).0, whole().swap_remove(1).0];
    let cube = whole_outlined().swap_remove(0).0;
    if !has_more {
        // Ten storage buffers a stage leave none for further windows.
        let failure =
            refiner.refine(&cube.points, &RefineParams { levels: 3, ..Default::default() });
        assert!(matches!(failure, Err(Error::TooLarge { .. })), "{failure:?}");
        return;
    }
    for params in variants() {
        let params = RefineParams { levels: 2, ..params };
        clouds().iter().for_each(|cloud| check(&mut refiner, cloud, &params, is_exact));
    }
    check(&mut refiner, &cube, &RefineParams { levels: 3, ..Default::default() }, is_exact);
    // Long rows are done in parts that fit in one binding.
    let crowded = whole().swap_remove(5).0;
    refiner.set_sizing(Sizing { rounds: 1, ..Sizing::default() });
    check(&mut refiner, &crowded, &RefineParams { levels: 3, ..Default::default() }, is_exact);
}

#[test]
fn a_kernel_that_needs_too_many_windows_says_so() {
    let (mut refiner, _) = refiner();
    let cloud = whole().swap_remove(0).0;
    let failure = refiner.refine(&cloud.points, &RefineParams { levels: 5, ..Default::default() });
    let failure = failure.expect_err("there are not so many bindings");
    assert!(matches!(failure, Error::TooLarge { .. } | Error::Bindings { .. }), "{failure}");
    assert!(failure.to_string().contains("use fewer levels"), "{failure}");
    // The refiner can be used again.
    refiner.refine(&cloud.points, &RefineParams { levels: 1, ..Default::default() }).expect("fits");
}
