//! Where the coordinates of a picture are.

use glam::{DVec3, Vec3};
use surfine_points::PointSet;

/// The coordinates of a picture: relative to a centre, and in a unit of about the size of what is shown. Pictures are
/// computed in 32-bit floats, which far or tiny clouds would bring to their ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space {
    /// The place of (0, 0, 0).
    pub center: DVec3,
    /// Length of a unit of the files in the space: a power of two, so that scaling loses no digits.
    pub scale: f64,
}

impl Default for Space {
    /// The coordinates of the files themselves.
    fn default() -> Self {
        Self { center: DVec3::ZERO, scale: 1.0 }
    }
}

impl Space {
    /// A space around clouds that are to be seen by one camera.
    pub fn around<'a>(clouds: impl IntoIterator<Item = &'a PointSet>) -> Self {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut radius = 0.0f32;
        for cloud in clouds {
            for position in &cloud.positions {
                let position = cloud.origin + position.as_dvec3();
                (low, high) = (low.min(position), high.max(position));
            }
            radius = cloud.radii.iter().copied().filter(|r| r.is_finite()).fold(radius, f32::max);
        }
        if low.x > high.x {
            return Self::default();
        }
        let extent = (high - low).max_element();
        // One place has no extent.
        let size = if extent > 0.0 { extent } else { radius.into() };
        let scale = if size > 0.0 { (-size.log2().floor()).exp2() } else { 1.0 };
        Self { center: low + 0.5 * (high - low), scale }
    }

    /// A place of the files in the space.
    pub fn place(&self, place: DVec3) -> Vec3 {
        (self.scale * (place - self.center)).as_vec3()
    }

    /// A length of the files in the space.
    pub fn length(&self, length: f32) -> f32 {
        (self.scale * f64::from(length)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clouds_get_a_size_of_about_one() {
        for exponent in [-22, -3, 0, 9, 14] {
            let scale = 10f32.powi(exponent);
            let positions = [Vec3::ZERO, Vec3::new(3.0, -1.0, 0.5)].map(|p| scale * p).to_vec();
            let mut points = PointSet::new(positions, vec![Vec3::Z; 2], vec![0.1 * scale; 2]);
            points.origin = DVec3::splat(f64::from(scale) * 1e6);
            let space = Space::around([&points]);
            let [a, b] =
                [0, 1].map(|i| space.place(points.origin + points.positions[i].as_dvec3()));
            assert!((1.0..2.01).contains(&(b - a).abs().max_element()), "{exponent}: {a} {b}");
            assert!((a + b).abs().max_element() < 1e-6, "{exponent}: {a} {b}");
            assert!((0.02..0.1).contains(&space.length(points.radii[0])), "{exponent}");
        }
    }

    #[test]
    fn nothing_and_one_place_have_a_space() {
        assert_eq!(Space::around([]), Space::default());
        let one = |radius| PointSet::new(vec![Vec3::X], vec![Vec3::Z], vec![radius]);
        assert_eq!(Space::around([&one(0.0)]), Space { center: DVec3::X, scale: 1.0 });
        assert_eq!(Space::around([&one(1e-6)]).length(1e-6), 1e-6 * 1_048_576.0);
    }
}
