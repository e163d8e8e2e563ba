//! Where a picture is taken from.

use glam::Vec3;
use std::fmt;
use std::str::FromStr;

/// Room that [`Camera::fit`] leaves between positions and the edges of the picture, as a factor.
const MARGIN: f32 = 1.03;

/// A perspective camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands: not at the target, or it looks along −z.
    pub eye: Vec3,
    /// The middle of the picture.
    pub target: Vec3,
    /// A direction that is upright in the picture; any length. If it is zero or along the line of sight, any direction
    /// may be upright.
    pub up: Vec3,
    /// Angle between the lower and the upper edge of the picture, radians.
    pub fov: f32,
}

/// The directions from which a cloud is looked at. The axes are those of most scans: x to the right, y up, z to the
/// viewer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// From +z.
    #[default]
    Front,
    /// From −z.
    Back,
    /// From −x.
    Left,
    /// From +x.
    Right,
    /// From +y.
    Top,
    /// From −y.
    Bottom,
    /// From the corner between front, right and top.
    Iso,
}

/// A name that stands for no view.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown view {0:?}: use front, back, left, right, top, bottom or iso")]
pub struct UnknownView(String);

impl View {
    /// Every view.
    pub const ALL: [Self; 7] =
        [Self::Front, Self::Back, Self::Left, Self::Right, Self::Top, Self::Bottom, Self::Iso];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Back => "back",
            Self::Left => "left",
            Self::Right => "right",
            Self::Top => "top",
            Self::Bottom => "bottom",
            Self::Iso => "iso",
        }
    }

    /// From the target to the eye, unit length.
    pub fn direction(self) -> Vec3 {
        match self {
            Self::Front => Vec3::Z,
            Self::Back => Vec3::NEG_Z,
            Self::Left => Vec3::NEG_X,
            Self::Right => Vec3::X,
            Self::Top => Vec3::Y,
            Self::Bottom => Vec3::NEG_Y,
            Self::Iso => Vec3::new(1.0, 0.8, 1.2).normalize(),
        }
    }

    /// Upright in the picture.
    pub fn up(self) -> Vec3 {
        match self {
            Self::Top => Vec3::NEG_Z,
            Self::Bottom => Vec3::Z,
            _ => Vec3::Y,
        }
    }
}

impl fmt::Display for View {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for View {
    type Err = UnknownView;

    fn from_str(name: &str) -> Result<Self, UnknownView> {
        let view = Self::ALL.into_iter().find(|view| view.name() == name);
        view.ok_or_else(|| UnknownView(name.into()))
    }
}

impl Camera {
    /// Angle of view of [`Camera::look`], radians.
    pub const FOV: f32 = 0.5;

    /// Looks at the middle of these positions (a cloud, or the corners of a box around it) from a direction, from as far
    /// as it takes to see all of them in a picture of this shape (width over height). `direction` and `up` need no unit
    /// length.
    pub fn look(
        positions: impl Iterator<Item = Vec3> + Clone,
        direction: Vec3,
        up: Vec3,
        aspect: f32,
    ) -> Self {
        let (low, high) = bounds(positions.clone()).unwrap_or_default();
        let target = low + 0.5 * (high - low);
        // From zero first, so that the direction loses no digits.
        let camera = Self { eye: direction, target: Vec3::ZERO, up, fov: Self::FOV };
        let distance = camera.fit(positions.map(|p| p - target), aspect).distance();
        camera.with_distance(target, distance)
    }

    /// The same direction towards the same target, from as far as it takes to see all of these positions.
    #[must_use]
    pub fn fit(self, positions: impl Iterator<Item = Vec3> + Clone, aspect: f32) -> Self {
        let [right, up, forward] = self.axes();
        let rise = MARGIN / (0.5 * self.fov).tan();
        let needed = |p: Vec3| {
            let p = p - self.target;
            (rise * p.dot(up).abs()).max(rise / aspect * p.dot(right).abs()) - p.dot(forward)
        };
        let size = bounds(positions.clone()).map_or(0.0, |(low, high)| low.distance(high));
        // Points in one place have no size: then any distance will do.
        let least = if size > 0.0 { 0.1 * size } else { 1.0 };
        self.with_distance(self.target, positions.map(needed).fold(least, f32::max))
    }

    /// The same direction towards a target, from a distance.
    #[must_use]
    pub fn with_distance(self, target: Vec3, distance: f32) -> Self {
        let direction = (self.eye - self.target).normalize_or(Vec3::Z);
        Self { eye: target + distance * direction, target, ..self }
    }

    /// From the eye to the target.
    pub fn distance(&self) -> f32 {
        self.eye.distance(self.target)
    }

    /// Goes around an axis through the target by an angle in radians, anticlockwise seen from the axis's tip. What is
    /// upright turns with it, so that only the cloud seems to turn.
    #[must_use]
    pub fn orbit(self, axis: Vec3, angle: f32) -> Self {
        let turn = glam::Quat::from_axis_angle(axis.normalize_or(Vec3::Y), angle);
        let eye = self.target + turn * (self.eye - self.target);
        Self { eye, up: turn * self.up, ..self }
    }

    /// Whether [`Camera::up`] tells what is upright: it is not zero and not along the line of sight.
    pub fn is_upright(&self) -> bool {
        let forward = (self.target - self.eye).normalize_or_zero();
        // A thousandth of a radian: the direction of less is mostly rounding.
        forward.cross(self.up.normalize_or_zero()).length() > 1e-3
    }

    /// The unit vectors to the right, upwards and forward.
    pub(crate) fn axes(&self) -> [Vec3; 3] {
        let forward = (self.target - self.eye).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(self.up).normalize_or(forward.any_orthonormal_vector());
        [right, right.cross(forward), forward]
    }
}

/// The corners of the box around some positions; `None` without any.
fn bounds(positions: impl Iterator<Item = Vec3>) -> Option<(Vec3, Vec3)> {
    positions.map(|p| (p, p)).reduce(|(low, high), (p, _)| (low.min(p), high.max(p)))
}
