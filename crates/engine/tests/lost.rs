//! A device that is lost ends runs with an error. Needs an adapter; a software one will do.

use std::time::Duration;
use surfine::{Error, RefineParams, Refiner};
use surfine_points::shapes::{Sampling, Shape, sample};

#[test]
fn a_lost_device_is_an_error_and_no_panic() {
    let mut refiner = Refiner::new(None).unwrap_or_else(|e| panic!("{e}"));
    let sphere = sample(Shape::Sphere, Sampling::BlueNoise, 200, 1);
    refiner.refine(&sphere, &RefineParams::default()).expect("it is there");
    refiner.gpu().device.destroy();
    for _ in 0..2 {
        let failure = refiner.refine(&sphere, &RefineParams::default()).unwrap_err();
        assert!(matches!(failure, Error::Device { .. }), "{failure:?}");
    }
    let mut run = refiner.begin(sphere, RefineParams::default());
    let failure = loop {
        match run.advance(Duration::from_millis(4)) {
            Ok(None) => continue,
            Ok(Some(_)) => panic!("a lost device gave a result"),
            Err(failure) => break failure,
        }
    };
    assert!(matches!(failure, Error::Device { .. }), "{failure:?}");
}
