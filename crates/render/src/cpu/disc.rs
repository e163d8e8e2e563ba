//! A point in the picture: the vertex shaders of splat.wgsl.

use crate::shading::{to_linear, unpack};
use crate::splats::Extra;
use crate::style::{SOFT, SOLID};
use crate::view::{DATA, LEVEL, NORMAL, PAINT, RADIUS, Uniform};
use crate::{Size, Splats};
use glam::{Mat3, Vec2, Vec3};
use surfine::Point;

/// Share of a disc's radius by which the visibility passes push it away from the eye.
pub(crate) const PUSH: f32 = 0.5;
/// A disc whose normal turns farther from the eye than this cosine shows its back.
const BACK: f32 = -0.25;

/// A disc or a dot in the picture.
pub(super) struct Disc {
    /// Takes the offset (x, y, 1) of a subpixel's centre from the disc's to a multiple of (place in the disc, 1); the
    /// factor is 1 / distance.
    pub(super) to_place: Mat3,
    /// Column and row of the centre in subpixels, and its distance.
    pub(super) center: Vec3,
    /// First column and row.
    pub(super) low: [u32; 2],
    /// The column and the row after the last.
    pub(super) high: [u32; 2],
    /// Squared radius of the disc that decides what is seen, where that of colours and normals is 1.
    pub(super) solid: f32,
    /// Products of the disc's axes with its ends, and where it ends.
    pub(super) ends: [Vec3; 2],
    /// Distance by which the visibility passes push it away from the eye.
    pub(super) pushed: f32,
    pub(super) color: Vec3,
    /// Turned to the eye.
    pub(super) normal: Vec3,
    pub(super) shows_back: bool,
    /// At a crease: another side shows its front.
    pub(super) is_far_side: bool,
}

/// Where a disc lies in the world.
struct Placed {
    is_dot: bool,
    normal: Vec3,
    /// Of the disc of colours and normals, and of the one that decides what is seen.
    soft: f32,
    solid: f32,
    /// Of the length of the soft radius.
    axes: [Vec3; 2],
}

impl Disc {
    /// The disc of a point; `None` where nothing is seen of it.
    pub(super) fn project(
        view: &Uniform,
        ramp: &[Vec3],
        splats: &Splats,
        i: usize,
        size: Size,
    ) -> Option<Self> {
        let (point, extra) = (&splats.points[i], splats.extra(i));
        let ray = Vec3::from(point.position) - Vec3::from(view.eye);
        let distance = ray.dot(view.forward.into());
        let Placed { is_dot, normal, soft, solid, axes } = place(view, point, distance);
        let screen = Screen::new(view, size);
        let [a, b] = axes.map(|axis| screen.project(axis));
        let center = screen.project(ray);
        let (low, high) = screen.covered([a, b], center, view.near)?;
        // Relative to the centre's subpixel, so that large pictures lose no digits.
        let middle = center.truncate() / distance;
        let relative = |v: Vec3| (v.truncate() - middle * v.z).extend(v.z);
        let matrix = Mat3::from_cols(relative(a), relative(b), Vec3::new(0.0, 0.0, distance));
        if matrix.determinant() == 0.0 {
            return None;
        }
        let end = |end: [f32; 4]| {
            let direction = Vec3::from_slice(&end[..3]);
            let products = Vec2::from(axes.map(|axis| axis.dot(direction)));
            if is_dot { Vec3::ZERO } else { products.extend(-end[3]) }
        };
        let given = Vec3::from(point.normal);
        // Raw points hide nothing, so half of them would.
        let shows_back =
            view.dot_radius == 0.0 && given.dot(-ray) < BACK * given.length() * ray.length();
        Some(Self {
            to_place: matrix.inverse(),
            center: middle.extend(distance),
            low,
            high,
            solid: (solid / soft).powi(2),
            ends: extra.ends.map(end),
            pushed: if is_dot { 0.0 } else { PUSH * solid * distance / ray.length() },
            color: color(view, ramp, point, extra.paint, normal, shows_back),
            normal: if shows_back { -normal } else { normal },
            shows_back,
            is_far_side: is_far_side(&extra, -ray),
        })
    }
}

/// Whether another side of the crease shows its front to an eye in that direction.
fn is_far_side(extra: &Extra, to_eye: Vec3) -> bool {
    (0..2).any(|i| {
        let turned = Vec3::from_slice(&extra.ends[i][..3]).dot(to_eye);
        (extra.sides & (1 << i) != 0 && turned > 0.0)
            || (extra.sides & (4 << i) != 0 && turned < 0.0)
    })
}

/// Takes vectors of the world into the picture.
struct Screen<'a> {
    view: &'a Uniform,
    /// Columns and rows of subpixels.
    size: Vec2,
}

impl<'a> Screen<'a> {
    fn new(view: &'a Uniform, size: Size) -> Self {
        let side = view.supersampling;
        let size = Vec2::new((size.width * side) as f32, (size.height * side) as f32);
        Self { view, size }
    }

    /// Column and row, both times the distance, and the distance.
    fn project(&self, v: Vec3) -> Vec3 {
        let view = self.view;
        let w = v.dot(view.forward.into());
        let x = v.dot(view.right.into()) * view.scale[0] + w;
        let y = w - v.dot(view.up.into()) * view.scale[1];
        Vec3::new(0.5 * self.size.x * x, 0.5 * self.size.y * y, w)
    }

    /// The subpixels around a disc: the first column and row, and those after the last.
    fn covered(&self, [a, b]: [Vec3; 2], center: Vec3, near: f32) -> Option<([u32; 2], [u32; 2])> {
        let corners = [a + b, a - b, b - a, -a - b].map(|offset| center + offset);
        if corners.iter().any(|corner| corner.z <= near) {
            return None;
        }
        let corners = corners.map(|corner| corner.truncate() / corner.z);
        let low = corners.into_iter().reduce(Vec2::min)?;
        let high = corners.into_iter().reduce(Vec2::max)?;
        // A subpixel counts if its centre is inside.
        let inside = |v: Vec2| (v - 0.5).ceil().clamp(Vec2::ZERO, self.size).as_uvec2().to_array();
        let (low, high) = (inside(low), inside(high));
        (low[0] < high[0] && low[1] < high[1]).then_some((low, high))
    }
}

/// `corner` of splat.wgsl, up to the offset.
fn place(view: &Uniform, point: &Point, distance: f32) -> Placed {
    let [right, up, forward] = [view.right, view.up, view.forward].map(Vec3::from);
    let pixel = distance * view.pixel;
    let normal = Vec3::from(point.normal).normalize_or(-forward);
    let is_dot = view.dot_radius > 0.0 || point.normal == [0.0; 3] || point.radius <= 0.0;
    if is_dot {
        let radius = view.dot_radius.max(0.75 * view.supersampling as f32) * pixel;
        let axes = [radius * right, radius * up];
        return Placed { is_dot, normal, soft: radius, solid: radius, axes };
    }
    let disc = |size: f32| (size * view.disc_scale * point.radius).max(0.75 * pixel);
    let (soft, solid) = (disc(SOFT), disc(SOLID));
    let along = tangent(normal);
    Placed { is_dot, normal, soft, solid, axes: [soft * along, soft * normal.cross(along)] }
}

/// A unit vector at right angles to `n`.
fn tangent(n: Vec3) -> Vec3 {
    let helper = if n.x.abs() > 0.7 { Vec3::Y } else { Vec3::X };
    helper.cross(n).normalize()
}

fn color(
    view: &Uniform,
    ramp: &[Vec3],
    point: &Point,
    paint: u32,
    normal: Vec3,
    shows_back: bool,
) -> Vec3 {
    let on_ramp = |value: f32| {
        let t = ((value - view.ramp_low) * view.ramp_inverse).clamp(0.0, 1.0);
        ramp[(255.0 * t + 0.5) as usize]
    };
    match view.coloring {
        NORMAL => to_linear(0.5 + 0.5 * normal),
        _ if shows_back => Vec3::new(0.75, 0.12, 0.03),
        PAINT | DATA => unpack(paint),
        RADIUS => on_ramp(point.radius),
        LEVEL => on_ramp(point.level as f32),
        _ => Vec3::new(0.62, 0.59, 0.55),
    }
}
