//! Surfaces with a formula: area, random points, closest points and normals, all in f64.

use std::f64::consts::PI;

use fastrand::Rng;
use glam::{DVec2, DVec3, Vec3, Vec3Swizzles};

/// A surface with a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    /// `x² + y² + z² = 1`.
    Sphere,
    /// `(sqrt(x² + y²) - 1)² + z² = 0.4²`.
    Torus,
    /// `x² + (y / 0.7)² + (z / 0.45)² = 1`.
    Ellipsoid,
    /// `z = 0.4 (x² - y²)` over the square `|x|, |y| <= 1`; its normals point up.
    Saddle,
    /// `z = 0` over the square `|x|, |y| <= 1`; its normals are +z.
    Plane,
}

/// Radius of the torus's tube; the circle at its heart has radius 1.
const TUBE: f64 = 0.4;
/// Semi-axes of the ellipsoid, the smallest last.
const AXES: DVec3 = DVec3::new(1.0, 0.7, 0.45);
/// Steepness of the saddle.
const STEEP: f64 = 0.4;

impl Shape {
    /// Unsigned distance from `x` to the surface, in the units of the surface; from the rim where that is closest.
    ///
    /// Exact to rounding, except for a point farther than 1.25 from the saddle: it may get the distance to a point of
    /// the saddle that isn't the closest one.
    pub fn distance(&self, x: Vec3) -> f32 {
        let x = x.as_dvec3();
        (x - self.foot(x)).length() as f32
    }

    /// Unit normal at the point of the surface that is closest to `x`: outward, or up for the saddle and the plane.
    pub fn normal(&self, x: Vec3) -> Vec3 {
        self.unit_normal(self.foot(x.as_dvec3())).as_vec3()
    }

    /// Unit normal at a point of the surface, from the exact gradient.
    pub(super) fn unit_normal(self, x: DVec3) -> DVec3 {
        let gradient = match self {
            Self::Sphere => x,
            Self::Torus => x - heart(x),
            Self::Ellipsoid => x / (AXES * AXES),
            Self::Saddle => DVec3::new(-2.0 * STEEP * x.x, 2.0 * STEEP * x.y, 1.0),
            Self::Plane => DVec3::Z,
        };
        gradient.normalize_or(DVec3::Z)
    }

    /// The point of the surface that is closest to `x`, one of them if there are many.
    fn foot(self, x: DVec3) -> DVec3 {
        match self {
            Self::Sphere => x.normalize_or(DVec3::Z),
            Self::Torus => heart(x) + TUBE * (x - heart(x)).normalize_or(DVec3::Z),
            Self::Ellipsoid => ellipsoid_foot(x),
            Self::Saddle => saddle_foot(x),
            Self::Plane => DVec3::new(x.x.clamp(-1.0, 1.0), x.y.clamp(-1.0, 1.0), 0.0),
        }
    }

    /// Area of the surface, to at least nine digits.
    pub(super) fn area(self) -> f64 {
        match self {
            Self::Sphere => 4.0 * PI,
            Self::Torus => 4.0 * PI * PI * TUBE,
            Self::Ellipsoid => ellipsoid_area(),
            Self::Saddle => integrate(|x, y| saddle_stretch(DVec2::new(x, y))),
            Self::Plane => 4.0,
        }
    }

    /// A random point, area-uniform: a point of a simpler domain is kept with a probability in proportion to the area
    /// that the map to the surface gives its surroundings.
    pub(super) fn draw(self, random: &mut Rng) -> DVec3 {
        match self {
            Self::Sphere => in_ball(random).normalize(),
            Self::Torus => draw_torus(random),
            Self::Ellipsoid => loop {
                let unit = in_ball(random).normalize();
                // The largest stretch is that of the shortest axis.
                if random.f64() * AXES.x * AXES.y <= ellipsoid_stretch(unit) {
                    return unit * AXES;
                }
            },
            Self::Saddle => loop {
                let foot = in_square(random);
                if random.f64() * saddle_stretch(DVec2::ONE) <= saddle_stretch(foot) {
                    return on_saddle(foot);
                }
            },
            Self::Plane => in_square(random).extend(0.0),
        }
    }
}

/// Uniform in the square `|x|, |y| <= 1`.
pub(super) fn in_square(random: &mut Rng) -> DVec2 {
    let mut coordinate = || 2.0 * random.f64() - 1.0;
    DVec2::new(coordinate(), coordinate())
}

/// Uniform in the unit disc less a speck at its centre, where the direction would be coarse.
pub(super) fn in_disc(random: &mut Rng) -> DVec2 {
    loop {
        let point = in_square(random);
        if (1e-6..=1.0).contains(&point.length_squared()) {
            return point;
        }
    }
}

/// Uniform in the unit ball less a speck at its centre.
fn in_ball(random: &mut Rng) -> DVec3 {
    loop {
        let point = in_square(random).extend(2.0 * random.f64() - 1.0);
        if (1e-6..=1.0).contains(&point.length_squared()) {
            return point;
        }
    }
}

/// The point of the unit circle in the plane z = 0 that is closest to `x`: the heart of the torus's tube.
fn heart(x: DVec3) -> DVec3 {
    x.with_z(0.0).normalize_or(DVec3::X)
}

fn draw_torus(random: &mut Rng) -> DVec3 {
    let across = loop {
        let across = in_disc(random).normalize();
        // A ring around the axis is as long as its distance from the axis.
        if random.f64() * (1.0 + TUBE) <= 1.0 + TUBE * across.x {
            break across;
        }
    };
    let around = in_disc(random).normalize();
    (around * (1.0 + TUBE * across.x)).extend(TUBE * across.y)
}

/// Area that the map from the unit sphere to the ellipsoid gives a unit of area: the length of the cofactor's image.
fn ellipsoid_stretch(unit: DVec3) -> f64 {
    let DVec3 { x: a, y: b, z: c } = AXES;
    (unit * DVec3::new(b * c, c * a, a * b)).length()
}

/// The stretch over the unit sphere, integrated over three faces of the cube around it and doubled for the other three.
fn ellipsoid_area() -> f64 {
    let face = |u: f64, v: f64| {
        let point = DVec3::new(1.0, u, v);
        let length = point.length();
        let unit = point / length;
        let stretches = [unit, unit.zxy(), unit.yzx()].map(ellipsoid_stretch);
        // A patch of the cube's face seen from the centre covers this much of the sphere.
        stretches.iter().sum::<f64>() / (length * length * length)
    };
    2.0 * integrate(face)
}

/// Integral over the square `|x|, |y| <= 1` by Simpson's rule.
fn integrate(f: impl Fn(f64, f64) -> f64) -> f64 {
    const STEPS: u32 = 128;
    let weight = |i: u32| match i {
        0 | STEPS => 1.0,
        _ if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let node = |i: u32| f64::from(i) * 2.0 / f64::from(STEPS) - 1.0;
    let row = |j: u32| (0..=STEPS).map(|i| weight(i) * f(node(i), node(j))).sum::<f64>();
    let sum = (0..=STEPS).map(|j| weight(j) * row(j)).sum::<f64>();
    let third = 2.0 / f64::from(STEPS) / 3.0;
    sum * third * third
}

/// The closest point of the ellipsoid, after D. Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a
/// Hyperellipsoid" (2013): it is `a_i² x_i / (a_i² + t)` for the largest t that puts it on the ellipsoid.
///
/// The unknown here is `s = t + c²`, above zero and small where the point is near the middle of the solid. Newton's
/// method is applied to the reciprocal of the length of `a_i x_i / (a_i² + t)`: it grows with s and is concave, so the
/// steps go up from a lower bound and never beyond the root.
fn ellipsoid_foot(x: DVec3) -> DVec3 {
    let squares = AXES * AXES;
    let offsets = squares - squares.z;
    // Off the plane z = 0 by less than any f32 cloud shows, the root exists inside too, where two points are closest.
    let x = x.with_z(if x.z.abs() < 1e-20 { 1e-20 } else { x.z });
    let scaled = AXES * x.abs();
    let mut s = scaled.z;
    for _ in 0..100 {
        let ratios = scaled / (offsets + s);
        let squared = ratios.length_squared();
        let slope = (ratios * ratios / (offsets + s)).element_sum();
        let next = s + (squared.sqrt() - 1.0) * squared / slope;
        if next <= s {
            break;
        }
        s = next;
    }
    let foot = squares * x / (offsets + s);
    foot / (foot / AXES).length()
}

/// The point of the saddle over or under a point of the square.
pub(super) fn on_saddle(foot: DVec2) -> DVec3 {
    foot.extend(STEEP * (foot.x * foot.x - foot.y * foot.y))
}

/// Area of the saddle over a unit of area of the square.
fn saddle_stretch(foot: DVec2) -> f64 {
    (1.0 + 4.0 * STEEP * STEEP * foot.length_squared()).sqrt()
}

/// The closest point of the saddle: that of the endless saddle if it lies over the square, else one of the rim's.
fn saddle_foot(x: DVec3) -> DVec3 {
    let foot = endless_saddle_foot(x);
    if foot.x.abs() <= 1.0 && foot.y.abs() <= 1.0 {
        return foot;
    }
    let distance = |p: &DVec3| (*p - x).length_squared();
    let candidates = rim_feet(x).into_iter().map(on_saddle);
    candidates.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(foot)
}

/// The closest point of `z = k (x² - y²)` without bounds.
///
/// It is off `x` by t times the gradient (2 k u, -2 k v, -1), so `u = x / (1 - 2 k t)` and `v = y / (1 + 2 k t)`. Of
/// all such points the one with |2 k t| <= 1 is the closest (the Lagrangian is convex there), and on that interval the
/// miss `k (u² - v²) - (z - t)` grows with t. Points closer than 1 / (2 k) = 1.25 have their t inside.
fn endless_saddle_foot(x: DVec3) -> DVec3 {
    let steep = 2.0 * STEEP;
    let at = |t: f64| DVec2::new(x.x / (1.0 - steep * t), x.y / (1.0 + steep * t));
    let miss = |t: f64| {
        let DVec2 { x: u, y: v } = at(t);
        let slope = 1.0 + steep * steep * (u * u / (1.0 - steep * t) + v * v / (1.0 + steep * t));
        (STEEP * (u * u - v * v) - x.z + t, slope)
    };
    let limit = (1.0 - 1e-12) / steep;
    on_saddle(at(increasing_root(-limit, limit, miss)))
}

/// Where on the four sides of the square the distance to `x` has its local minima.
///
/// Half the derivative of the squared distance along a side is the cubic `2 k² v³ + (1 - 2 k² ± 2 k z) v - y`. It
/// grows outside its two turning points, so each outer branch holds one minimum at most, maybe at the corner.
fn rim_feet(x: DVec3) -> [DVec2; 8] {
    let cubic = 2.0 * STEEP * STEEP;
    let along_side = |target: f64, height: f64| {
        let linear = 1.0 - cubic + 2.0 * STEEP * height;
        let turn = (-linear / (3.0 * cubic)).max(0.0).sqrt().min(1.0);
        let miss = |v: f64| ((cubic * v * v + linear) * v - target, 3.0 * cubic * v * v + linear);
        [increasing_root(-1.0, -turn, miss), increasing_root(turn, 1.0, miss)]
    };
    let [y0, y1] = along_side(x.y, x.z);
    let [x0, x1] = along_side(x.x, -x.z);
    let ends = [(1.0, y0), (1.0, y1), (-1.0, y0), (-1.0, y1)];
    let others = [(x0, 1.0), (x1, 1.0), (x0, -1.0), (x1, -1.0)];
    let mut feet = [DVec2::ZERO; 8];
    for (foot, (u, v)) in feet.iter_mut().zip(ends.into_iter().chain(others)) {
        *foot = DVec2::new(u, v);
    }
    feet
}

/// Root of a growing function, given with its slope, or the end of the interval that is closest to it: Newton's method,
/// halving where a step leaves the interval in which the root is known to lie.
fn increasing_root(mut low: f64, mut high: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    if f(low).0 >= 0.0 {
        return low;
    }
    if f(high).0 <= 0.0 {
        return high;
    }
    let mut x = 0.5 * (low + high);
    for _ in 0..200 {
        let (value, slope) = f(x);
        if value > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let newton = x - value / slope;
        let next = if low < newton && newton < high { newton } else { 0.5 * (low + high) };
        if next == x || value == 0.0 {
            break;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_are_those_of_the_formulas() {
        // Legendre's formula with elliptic integrals, and polar coordinates, both by 20,000 steps of Simpson's rule.
        approx::assert_relative_eq!(Shape::Ellipsoid.area(), 6.328075230757, max_relative = 1e-9);
        approx::assert_relative_eq!(Shape::Saddle.area(), 4.756724258455, max_relative = 1e-9);
    }
}
