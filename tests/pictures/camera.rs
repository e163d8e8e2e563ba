//! Where pictures are taken from.

use glam::DVec3;
use std::f32::consts::{PI, TAU};
use std::ops::Range;
use surfine_points::Vec3;
use surfine_render::{Camera, View};

/// Place of a point in the picture: −1 to 1 to the right and upwards; computed apart from the crate's own projection.
fn project(camera: &Camera, aspect: f32, point: Vec3) -> [f64; 2] {
    let [eye, target, up, point] =
        [camera.eye, camera.target, camera.up, point].map(Vec3::as_dvec3);
    let forward = (target - eye).normalize();
    let right = forward.cross(up).normalize();
    let up = right.cross(forward);
    let ray: DVec3 = point - eye;
    let depth = ray.dot(forward);
    assert!(depth > 0.0, "behind the eye");
    let half = depth * f64::from(0.5 * camera.fov).tan();
    [ray.dot(right) / (half * f64::from(aspect)), ray.dot(up) / half]
}

/// Where the outermost point of a cloud that fits lies. The margin is 3 %, so at 1 / 1.03, but for rounding.
const FILLED: Range<f64> = 0.970..0.972;

/// A long box off the origin, so that no direction and no axis is like another.
fn corners() -> impl Iterator<Item = Vec3> + Clone {
    let corner = |i: u32| Vec3::from([0, 1, 2].map(|bit| (i >> bit & 1) as f32));
    (0..8).map(move |i| Vec3::new(10.0, -4.0, 3.0) + corner(i) * Vec3::new(5.0, 1.0, 2.0))
}

#[test]
fn everything_fits_into_the_picture_and_fills_it() {
    for view in View::ALL {
        for aspect in [0.3, 0.7, 1.0, 1.6, 3.0] {
            for fov in [0.1, Camera::FOV, 1.5] {
                let start = Camera::look(corners(), view.direction(), view.up(), aspect);
                let camera = Camera { fov, ..start }.fit(corners(), aspect);
                let places = corners().flat_map(|point| project(&camera, aspect, point));
                let largest = places.map(f64::abs).fold(0.0, f64::max);
                assert!(FILLED.contains(&largest), "{view} {aspect} {fov}: {largest}");
                let direction = (camera.eye - camera.target).normalize();
                assert!(direction.abs_diff_eq(view.direction(), 1e-6), "{view}");
            }
        }
    }
}

#[test]
fn look_is_fit_with_the_usual_angle() {
    let direction = 7.0 * View::Iso.direction();
    let camera = Camera::look(corners(), direction, Vec3::Y, 1.5);
    assert_eq!(camera.fov, Camera::FOV);
    assert!(camera.target.abs_diff_eq(Vec3::new(12.5, -3.5, 4.0), 1e-6));
    let largest =
        corners().flat_map(|p| project(&camera, 1.5, p)).map(f64::abs).fold(0.0, f64::max);
    assert!(FILLED.contains(&largest), "{largest}");
}

#[test]
fn up_is_up_in_every_view() {
    for view in View::ALL {
        let camera = Camera::look(corners(), view.direction(), view.up(), 1.0);
        let [x, y] = project(&camera, 1.0, camera.target + 0.1 * view.up());
        assert!(x.abs() < 1e-6 && y > 0.0, "{view}: {x} {y}");
    }
}

#[test]
fn one_point_and_none_can_be_looked_at() {
    let point = Vec3::new(3.0, 4.0, 5.0);
    let camera = Camera::look([point].into_iter(), Vec3::Z, Vec3::Y, 1.0);
    assert_eq!(camera.target, point);
    assert!(camera.eye.is_finite() && camera.distance() > 0.0);
    let camera = Camera::look([].into_iter(), Vec3::Z, Vec3::Y, 1.0);
    assert_eq!(camera.target, Vec3::ZERO);
    assert!(camera.eye.is_finite() && camera.distance() > 0.0);
}

#[test]
fn fit_keeps_the_target() {
    let target = Vec3::new(9.0, -3.0, 4.0);
    let start = Camera { eye: target + 3.0 * Vec3::Z, target, up: Vec3::Y, fov: 0.7 };
    let camera = start.fit(corners(), 1.0);
    assert_eq!((camera.target, camera.up, camera.fov), (target, Vec3::Y, 0.7));
    assert!((camera.eye - target).normalize().abs_diff_eq(Vec3::Z, 1e-6));
    let places = corners().flat_map(|point| project(&camera, 1.0, point));
    let largest = places.map(f64::abs).fold(0.0, f64::max);
    assert!(FILLED.contains(&largest), "{largest}");
}

#[test]
fn orbits_close() {
    let camera = Camera::look(corners(), View::Iso.direction(), Vec3::Y, 1.0);
    let (distance, offset) = (camera.distance(), camera.eye - camera.target);
    // The sine of 2π in f32 is 2e-7.
    let near = 1e-5 * distance;
    let orbit = |camera: Camera, angle| camera.orbit(Vec3::Y, angle);
    assert!(orbit(camera, TAU).eye.abs_diff_eq(camera.eye, near));
    let steps = (0..12).fold(camera, |camera, _| orbit(camera, TAU / 12.0));
    assert!(steps.eye.abs_diff_eq(camera.eye, near));
    let opposite = orbit(camera, PI);
    let turned = camera.target + offset * Vec3::new(-1.0, 1.0, -1.0);
    assert!(opposite.eye.abs_diff_eq(turned, near), "{opposite:?}");
    assert_eq!((opposite.target, opposite.up), (camera.target, camera.up));
    // Anticlockwise from above: from the front to the right.
    let front = Camera { eye: Vec3::Z, target: Vec3::ZERO, ..camera };
    assert!(orbit(front, 0.5 * PI).eye.abs_diff_eq(Vec3::X, 1e-6));
    // From above the picture turns.
    let above = Camera { eye: Vec3::Y, up: Vec3::NEG_Z, ..front };
    let turned = orbit(above, 0.5 * PI);
    assert!(turned.eye.abs_diff_eq(Vec3::Y, 1e-6) && turned.up.abs_diff_eq(Vec3::NEG_X, 1e-6));
}

#[test]
fn an_upright_direction_is_needed() {
    let camera = Camera::look(corners(), Vec3::Z, Vec3::Y, 1.0);
    assert!(camera.is_upright());
    for up in [Vec3::ZERO, Vec3::Z, -3.0 * Vec3::Z, Vec3::new(0.0, 1e-5, 1.0)] {
        assert!(!Camera { up, ..camera }.is_upright(), "{up}");
    }
}

#[test]
fn views_have_names() {
    for view in View::ALL {
        assert_eq!(view.name().parse(), Ok(view));
        assert_eq!(view.to_string(), view.name());
        assert!(view.direction().is_normalized() && view.up().is_normalized());
    }
    let error = "above".parse::<View>().unwrap_err().to_string();
    assert!(error.contains("\"above\"") && View::ALL.iter().all(|v| error.contains(v.name())));
}
