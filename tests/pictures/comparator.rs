//! How far apart two pictures are, and how far they may be; with proof that it notices what should be noticed.

use crate::painters::Painter;
use crate::scenes::{Scene, chosen, flip, sphere};
use std::fmt;
use std::fs;
use std::path::PathBuf;
use surfine_points::{PointSet, Vec3};
use surfine_render::{Coloring, Picture};

/// A channel that is this far off differs to the eye: less is hardly seen beside an outline.
const STEP: u8 = 12;
/// Share of the pixels that may differ to the eye. Measured between lavapipe and the CPU: 0.02 %, where a subpixel's
/// centre lies on an outline and rounding decides. The least of the errors below makes 0.6 %.
const SHARE: f64 = 0.001;
/// Mean over the pixels of the largest difference in a channel. Measured: 0.06, from sums in half floats. The least of
/// the errors below makes 0.7.
const MEAN: f64 = 0.2;

/// How far apart two pictures of one size are.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Difference {
    /// Share of the pixels of which a channel differs by more than [`STEP`].
    pub share: f64,
    /// Mean over the pixels of the largest difference in a channel.
    pub mean: f64,
    /// Largest difference.
    pub worst: u8,
}

/// Largest difference in a channel of each pixel.
fn distances(expected: &Picture, found: &Picture) -> Vec<u8> {
    assert_eq!(expected.size, found.size);
    let pixels = expected.pixels.iter().zip(&found.pixels);
    let largest = |(a, b): (&[u8; 4], &[u8; 4])| (0..4).map(|i| a[i].abs_diff(b[i])).max().unwrap();
    pixels.map(largest).collect()
}

impl Difference {
    pub(crate) fn of(expected: &Picture, found: &Picture) -> Self {
        let distances = distances(expected, found);
        let share_of = |count: usize| count as f64 / distances.len() as f64;
        Self {
            share: share_of(distances.iter().filter(|&&d| d > STEP).count()),
            mean: share_of(distances.iter().map(|&d| usize::from(d)).sum()),
            worst: distances.iter().copied().max().unwrap_or(0),
        }
    }

    pub(crate) fn is_small(&self) -> bool {
        self.share <= SHARE && self.mean <= MEAN
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { share, mean, worst } = self;
        write!(
            f,
            "{:.3} % of the pixels differ by more than {STEP} ({:.3} allowed), the mean difference is {mean:.3} ({MEAN} \
             allowed), the largest {worst}",
            100.0 * share,
            100.0 * SHARE
        )
    }
}

/// Compares two pictures.
///
/// # Errors
/// They differ: by how much, and where the pictures lie.
pub(crate) fn compare(what: &str, expected: &Picture, found: &Picture) -> Result<(), String> {
    let difference = Difference::of(expected, found);
    println!("{what}: {difference}");
    if difference.is_small() {
        return Ok(());
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("pictures").join(what);
    let write = |name: &str, picture: &Picture| picture.write_png(&folder.join(name)).unwrap();
    fs::create_dir_all(&folder).unwrap();
    write("expected.png", expected);
    write("actual.png", found);
    // Eight times as strong, so that small ones show.
    let grey = |d: u8| [d.saturating_mul(8), d.saturating_mul(8), d.saturating_mul(8), 255];
    let pixels = distances(expected, found).into_iter().map(grey).collect();
    write("difference.png", &Picture { size: expected.size, pixels });
    Err(format!("{what}: {difference}; see {}", folder.display()))
}

/// Compares two pictures and panics where they differ.
#[track_caller]
pub(crate) fn assert_alike(what: &str, expected: &Picture, found: &Picture) {
    if let Err(difference) = compare(what, expected, found) {
        panic!("{difference}");
    }
}

/// A painted sphere of 200 points.
fn scene(points: &PointSet) -> Scene {
    Scene::painted(points, Some(&vec![[200, 180, 90]; points.len()]))
        .style(|style| style.coloring = Coloring::Paint)
}

/// Fails unless both painters' pictures of `other` are told from that of the sphere.
#[track_caller]
fn assert_noticed(what: &str, other: &Scene) {
    for painter in Painter::BOTH {
        let difference = Difference::of(&painter.draw(&scene(&sphere(0))), &painter.draw(other));
        println!("{what}, {painter:?}: {difference}");
        assert!(!difference.is_small(), "{what}, {painter:?}: {difference}");
    }
}

#[test]
fn cracks_are_noticed() {
    assert_noticed("cracks", &scene(&sphere(0)).style(|style| style.splat_scale = 0.5));
}

#[test]
fn flipped_normals_are_noticed() {
    let mut points = sphere(0);
    flip(&mut points, |_| true);
    assert_noticed("flipped normals", &scene(&points));
}

#[test]
fn a_turned_camera_is_noticed() {
    let mut turned = scene(&sphere(0));
    turned.camera = turned.camera.orbit(Vec3::Y, 3f32.to_radians());
    assert_noticed("turned camera", &turned);
}

/// The points of the sphere that are nearest to the eye, nearest first.
fn nearest(points: &PointSet) -> Vec<usize> {
    let eye = scene(points).camera.eye;
    let distance = |&i: &usize| points.positions[i].distance(eye);
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    order
}

#[test]
fn one_other_colour_is_noticed() {
    let points = sphere(0);
    let mut paint = vec![[200, 180, 90]; points.len()];
    paint[nearest(&points)[0]] = [90, 180, 200];
    let other = Scene::painted(&points, Some(&paint));
    assert_noticed("one other colour", &other.style(|style| style.coloring = Coloring::Paint));
}

#[test]
fn missing_points_are_noticed() {
    let points = sphere(0);
    // Spread over the visible side.
    let removed: Vec<usize> = nearest(&points).into_iter().step_by(8).take(8).collect();
    let mut other = scene(&chosen(&points, |i| !removed.contains(&i)));
    other.camera = scene(&points).camera;
    assert_noticed("8 missing points", &other);
}

#[test]
fn a_shift_by_a_row_is_noticed() {
    for painter in Painter::BOTH {
        let picture = painter.draw(&scene(&sphere(0)));
        let mut shifted = picture.clone();
        shifted.pixels.rotate_right(picture.size.width as usize);
        let difference = Difference::of(&picture, &shifted);
        assert!(!difference.is_small(), "{painter:?}: {difference}");
    }
}

#[test]
fn equal_pictures_are_alike() {
    let picture = Painter::Cpu.draw(&scene(&sphere(0)).from(Vec3::splat(3.0), Vec3::ZERO));
    let difference = Difference::of(&picture, &picture);
    assert_eq!((difference.share, difference.mean, difference.worst), (0.0, 0.0, 0));
}
