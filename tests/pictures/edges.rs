//! Unusual clouds, cameras and sizes.

use crate::comparator::assert_alike;
use crate::geometry::fills_outline;
use crate::painters::Painter;
use crate::scenes::{CLEAR, Scene, moved, one_point, sphere};
use surfine_points::{DVec3, PointSet, Vec3};
use surfine_render::{Camera, Coloring, Error, Size, Space};

/// A square picture with a transparent ground, seen from +z at distance 4: one pixel in the middle.
fn scene(points: &PointSet) -> Scene {
    Scene::new(points)
        .style(|style| style.background = CLEAR)
        .square(41)
        .from(4.0 * Vec3::Z, Vec3::ZERO)
}

const MIDDLE: usize = 20 * 41 + 20;

fn covered(pixels: &[[u8; 4]]) -> usize {
    pixels.iter().filter(|pixel| pixel[3] > 0).count()
}

#[test]
fn nothing_gives_the_background() {
    for background in [[255; 4], CLEAR, [12, 200, 99, 255], [200, 100, 50, 128]] {
        let scene = scene(&PointSet::default()).style(|style| style.background = background);
        for painter in Painter::BOTH {
            let picture = painter.draw(&scene);
            // Without opacity there is no colour, and half floats aside each byte comes back.
            let exact = |p: &[u8; 4]| (0..4).all(|i| p[i].abs_diff(background[i]) <= 1);
            assert!(picture.pixels.iter().all(exact), "{painter:?}: {:?}", picture.pixels[0]);
        }
    }
}

#[test]
fn one_point_is_one_disc() {
    for painter in Painter::BOTH {
        let picture = painter.draw(&scene(&one_point(0.6)));
        // A circle with 0.65 of the radius at distance 4, whose picture is 41 pixels high.
        let radius = 0.65 * 0.6 / 4.0 / f64::from(0.5 * Camera::FOV).tan() * 20.5;
        let area = std::f64::consts::PI * radius * radius;
        let shown: f64 = picture.pixels.iter().map(|p| f64::from(p[3]) / 255.0).sum();
        // Of 210 pixels the outline has 50: a quarter of the subpixels is exact to 1 % of the area.
        assert!((shown / area - 1.0).abs() < 0.01, "{painter:?}: {shown} of {area}");
        assert_eq!(picture.pixels[MIDDLE][3], 255);
    }
}

#[test]
fn points_without_normal_or_radius_are_dots() {
    let without_normal = PointSet { normals: vec![Vec3::ZERO], ..one_point(0.5) };
    let without_both = PointSet { radii: vec![0.0], ..without_normal.clone() };
    for points in [one_point(0.0), without_normal, without_both] {
        for painter in Painter::BOTH {
            let picture = painter.draw(&scene(&points));
            // A radius of 0.75 pixels around the middle of a pixel.
            let shown: u32 = picture.pixels.iter().map(|p| u32::from(p[3])).sum();
            assert!((255..=3 * 255).contains(&shown), "{painter:?}: {shown}");
            assert_eq!(picture.pixels[MIDDLE][3], 255, "{painter:?}");
            assert!(covered(&picture.pixels) <= 9, "{painter:?}");
        }
    }
}

#[test]
fn dots_have_their_radius_at_any_distance() {
    for distance in [1.0, 4.0, 400.0] {
        let scene = scene(&one_point(0.1))
            .style(|style| style.dots = Some(6.0))
            .from(distance * Vec3::Z, Vec3::ZERO);
        for painter in Painter::BOTH {
            let picture = painter.draw(&scene);
            let shown: f64 = picture.pixels.iter().map(|p| f64::from(p[3]) / 255.0).sum();
            let area = std::f64::consts::PI * 36.0;
            assert!((shown / area - 1.0).abs() < 0.03, "{painter:?} {distance}: {shown} of {area}");
        }
    }
}

#[test]
fn missing_and_opposite_normals_give_colours() {
    let points = PointSet::new(vec![Vec3::ZERO; 2], vec![Vec3::X, -Vec3::X], vec![1.0; 2]);
    let opposite = scene(&points).style(|style| style.dots = Some(5.0));
    let points = PointSet::new(vec![Vec3::ZERO], vec![Vec3::ZERO], vec![1.0]);
    let missing = scene(&points).style(|style| style.dots = Some(5.0));
    // What a surface that faces the eye looks like.
    let facing = scene(&one_point(1.0)).style(|style| style.dots = Some(5.0));
    for painter in Painter::BOTH {
        let expected = painter.draw(&facing);
        assert_alike("opposite-normals", &expected, &painter.draw(&opposite));
        assert_alike("missing-normals", &expected, &painter.draw(&missing));
    }
}

#[test]
fn points_at_the_eye_and_behind_it_are_not_seen() {
    let alone = scene(&one_point(0.5));
    let mut points = one_point(0.5);
    let eye = 4.0 * Vec3::Z;
    for offset in
        [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::new(0.1, 0.2, 3.0), Vec3::new(-1.0, 0.3, 1e-3)]
    {
        for normal in [Vec3::Z, -Vec3::Z, Vec3::ZERO] {
            points.positions.push(eye + offset);
            points.normals.push(normal);
            points.radii.push(0.5);
        }
    }
    let crowded = scene(&points);
    for painter in Painter::BOTH {
        for dots in [None, Some(3.0)] {
            let [expected, found] = [&alone, &crowded]
                .map(|scene| painter.draw(&scene.clone().style(|style| style.dots = dots)));
            assert_alike("behind the eye", &expected, &found);
        }
    }
}

#[test]
fn discs_around_the_eye_do_no_harm() {
    // A floor that runs through below the eye: what reaches behind it is cut off or left out.
    let mut points = one_point(0.5);
    points.positions.push(Vec3::new(0.0, -0.5, 4.0));
    points.normals.push(Vec3::Y);
    points.radii.push(5.0);
    for painter in Painter::BOTH {
        let picture = painter.draw(&scene(&points));
        assert_eq!(picture.pixels[MIDDLE], painter.draw(&scene(&one_point(0.5))).pixels[MIDDLE]);
    }
}

#[test]
fn any_size_can_be_drawn() {
    for painter in Painter::BOTH {
        let pixel = painter.draw(&scene(&one_point(100.0)).square(1));
        assert_eq!(pixel.pixels[0][3], 255, "{painter:?}");
        let mut wide = scene(&one_point(1000.0));
        wide.size = Size { width: 301, height: 3 };
        let picture = painter.draw(&wide);
        assert!(picture.pixels.iter().all(|p| p[3] == 255), "{painter:?}: 301 x 3");
    }
}

#[test]
fn supersampling_smooths_outlines_and_changes_nothing_else() {
    let points = sphere(0);
    for painter in Painter::BOTH {
        let draw = |side| painter.draw(&scene(&points).style(|style| style.supersampling = side));
        let [one, eight] = [1, 8].map(draw);
        let partly = |p: &&[u8; 4]| p[3] > 0 && p[3] < 255;
        assert_eq!(one.pixels.iter().filter(partly).count(), 0, "{painter:?}");
        assert!(eight.pixels.iter().filter(partly).count() > 40, "{painter:?}");
        let inside = (0..one.pixels.len()).filter(|&i| eight.pixels[i][3] == 255);
        let differences = inside.map(|i| {
            let channels = one.pixels[i].iter().zip(eight.pixels[i]);
            f64::from(channels.map(|(a, b)| a.abs_diff(b)).max().unwrap())
        });
        let (sum, count) = differences.fold((0.0, 0), |(sum, n), d| (sum + d, n + 1));
        // The middle of a pixel against its mean.
        assert!(sum / f64::from(count) < 3.0, "{painter:?}: {}", sum / f64::from(count));
    }
}

#[test]
fn impossible_sizes_are_errors() {
    let draw = |painter: Painter, width, height, side| {
        let mut scene = scene(&one_point(1.0)).style(|style| style.supersampling = side);
        scene.size = Size { width, height };
        painter.try_draw(&scene)
    };
    for painter in Painter::BOTH {
        for (width, height, side) in
            [(0, 5, 1), (5, 0, 1), (40_000, 1, 1), (1, 40_000, 1), (20_000, 1, 2), (u32::MAX, 1, 2)]
        {
            let error = draw(painter, width, height, side).unwrap_err();
            let named = matches!(error, Error::Size { width: w, height: h, supersampling: s, .. }
                if (w, h, s) == (width, height, side));
            assert!(named, "{painter:?} {width} x {height}, {side}: {error}");
        }
        for side in [0, 9] {
            let error = draw(painter, 5, 5, side).unwrap_err();
            assert!(matches!(error, Error::Supersampling { .. }), "{painter:?}, {side}: {error}");
        }
    }
}

#[test]
fn a_camera_may_look_along_its_upright() {
    let mut scene = Scene::new(&sphere(2)).style(|style| style.background = CLEAR).square(160);
    scene = scene.from(4.5 * Vec3::Y, Vec3::ZERO);
    assert_eq!(scene.camera.up, Vec3::Y);
    for painter in Painter::BOTH {
        let picture = painter.draw(&scene);
        // Any rotation will do: the outline is a circle all the same.
        let mut upright = scene.clone();
        upright.camera.up = Vec3::X;
        let alpha = |mut picture: surfine_render::Picture| {
            picture.pixels.iter_mut().for_each(|p| *p = [p[3]; 4]);
            picture
        };
        assert_alike("upright", &alpha(painter.draw(&upright)), &alpha(picture));
    }
    scene.camera.up = Vec3::X;
    fills_outline(&scene, 0.02);
}

#[test]
fn points_in_one_place_are_seen() {
    let points = PointSet::new(vec![Vec3::ONE; 5], vec![Vec3::Z; 5], vec![0.2; 5]);
    let seen = points.positions.iter().copied();
    let mut crowd = scene(&points);
    crowd.camera = Camera::look(seen, Vec3::Z, Vec3::Y, 1.0);
    let mut one = scene(&moved(&one_point(0.2), 1.0, Vec3::ONE));
    one.camera = crowd.camera;
    for painter in Painter::BOTH {
        let picture = painter.draw(&crowd);
        assert_eq!(picture.pixels[MIDDLE][3], 255, "{painter:?}");
        assert_alike("one place", &painter.draw(&one), &picture);
    }
}

#[test]
fn the_unit_of_length_does_not_show() {
    let points = sphere(1);
    let draw = |painter: Painter, scale: f32| {
        let mut scene = Scene::new(&moved(&points, scale, Vec3::ZERO));
        scene.style.coloring = Coloring::Shaded;
        painter.draw(&scene)
    };
    for painter in Painter::BOTH {
        let one = draw(painter, 1.0);
        for scale in [1e6, 1e-6] {
            assert_alike(&format!("scale {scale}"), &one, &draw(painter, scale));
        }
    }
}

#[test]
fn far_and_tiny_clouds_have_a_space() {
    let points = sphere(1);
    let draw = |painter: Painter, scale: f32, origin: f64| {
        let mut points = moved(&points, scale, Vec3::ZERO);
        points.origin = DVec3::splat(origin);
        let space = Space::around([&points]);
        painter.draw(&Scene::in_space(&points, space, None).style(|style| {
            let [low, high] = [0.05, 0.2].map(|radius| space.length(scale * radius));
            style.coloring = Coloring::Radius { low, high };
        }))
    };
    for painter in Painter::BOTH {
        let one = draw(painter, 1.0, 0.0);
        for (scale, origin) in
            [(1e15, 0.0), (1e12, 1e14), (1e-15, 0.0), (1e-22, 0.0), (1.0, 4_194_305.0)]
        {
            assert_alike(&format!("space {scale}"), &one, &draw(painter, scale, origin));
        }
    }
}

#[test]
fn a_far_target_hides_nothing() {
    let points = sphere(1);
    for painter in Painter::BOTH {
        let [near, far] = [-1.0, -5000.0]
            .map(|z| painter.draw(&scene(&points).from(5.0 * Vec3::Z, Vec3::new(0.0, 0.0, z))));
        assert_alike("far target", &near, &far);
    }
}
