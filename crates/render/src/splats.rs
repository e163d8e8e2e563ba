//! The points of a picture.

use crate::style::{SOLID, pack};
use crate::{Space, creases};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use surfine::Point;
use surfine_points::{PointSet, Values};

/// Points ready to be drawn, on the host.
#[derive(Clone, Debug, Default)]
pub struct Splats {
    /// One record a disc.
    pub(crate) points: Vec<Point>,
    /// One a point, or none.
    pub(crate) extras: Vec<Extra>,
    /// Corners of a box around all discs, if there are any.
    pub(crate) bounds: Option<[Vec3; 2]>,
}

/// Farther than any disc reaches.
const NOWHERE: f32 = 1e30;

/// What a disc may have beyond the record of the engine: mirror of `Extra` in `shaders/render/splat.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Extra {
    /// The disc ends where the offset from its centre has a product with the first three that exceeds the fourth; zero
    /// for no end.
    pub(crate) ends: [[f32; 4]; 2],
    /// Colour for [`Coloring::Paint`](crate::Coloring::Paint).
    pub(crate) paint: u32,
    /// Bit 0 and 1 tell that an end has the normal of another disc in the same place, bit 2 and 3 the opposite.
    pub(crate) sides: u32,
    /// How far the creases of the ends are.
    distances: [f32; 2],
}

impl Extra {
    /// Ends the disc of a crease point with another side: at the plane of that `normal`, or below it where the crease is
    /// concave.
    pub(crate) fn end_at_side(&mut self, i: usize, normal: Vec3, is_concave: bool) {
        let direction = if is_concave { -normal } else { normal };
        self.ends[i] = direction.extend(0.0).to_array();
        self.sides |= if is_concave { 4 } else { 1 } << i;
    }

    /// Hides the disc where another in the same place, which looks the opposite way, shows its front. It ends nowhere.
    pub(crate) fn hide_behind(&mut self, normal: Vec3) {
        self.ends[1] = normal.extend(NOWHERE).to_array();
        self.sides |= 2;
    }

    /// Ends the disc of a smooth point at a plane: its direction, its distance from the centre, and that of the crease
    /// point which it belongs to. The nearest two in different directions count.
    pub(crate) fn end_at_plane(&mut self, direction: Vec3, place: f32, distance: f32) {
        let direction_of = |end: [f32; 4]| Vec3::from_slice(&end[..3]);
        let is_like = |i: &usize| direction_of(self.ends[*i]).dot(direction) > 0.9;
        let is_free = |i: &usize| direction_of(self.ends[*i]) == Vec3::ZERO;
        let farther = usize::from(self.distances[0] <= self.distances[1]);
        let slot = (0..2).find(is_like).or((0..2).find(is_free)).unwrap_or(farther);
        if is_free(&slot) || distance < self.distances[slot] {
            self.ends[slot] = direction.extend(place).to_array();
            self.distances[slot] = distance;
        }
    }
}

impl Splats {
    /// The points of a cloud in a space, that of the camera: [`Space::around`] makes one. The values of
    /// [`Coloring::Radius`](crate::Coloring::Radius) are lengths in it too.
    ///
    /// A point without a normal (zero) or a radius is drawn as a dot. `paint` gives each point a colour for
    /// [`Coloring::Paint`](crate::Coloring::Paint). An attribute `level` gives the levels, as
    /// `surfine refine --provenance` writes it. A crease point, one with further normals `nx2 ny2 nz2` and `nx3 ny3 nz3` or
    /// with records that share its position, becomes one disc a side, cut off at the crease.
    ///
    /// # Panics
    /// If the columns of the cloud or the paint have other lengths than the positions.
    pub fn new(points: &PointSet, space: Space, paint: Option<&[[u8; 3]]>) -> Self {
        let n = points.len();
        assert!(points.normals.len() == n && points.radii.len() == n, "columns of one length");
        let levels = match points.attribute("level").map(|a| &a.values) {
            Some(Values::U8(levels)) => &levels[..],
            _ => &[],
        };
        let place = |p: Vec3| space.place(points.origin + p.as_dvec3());
        let record = |i: usize| Point {
            position: place(points.positions[i]).to_array(),
            radius: space.length(points.radii[i]),
            normal: points.normals[i].to_array(),
            level: levels.get(i).copied().unwrap_or(0).into(),
        };
        let extras = paint.map_or_else(Vec::new, |paint| {
            assert_eq!(paint.len(), n, "one colour a point");
            paint.iter().map(|&c| Extra { paint: pack(c), ..Extra::default() }).collect()
        });
        let mut splats = Self { points: (0..n).map(record).collect(), extras, bounds: None };
        splats.bounds = splats.bounds();
        creases::cut(points, &mut splats);
        splats
    }

    fn bounds(&self) -> Option<[Vec3; 2]> {
        let one = |point: &Point| {
            let (center, radius) = (Vec3::from(point.position), Vec3::splat(point.radius.max(0.0)));
            [center - radius, center + radius]
        };
        self.points.iter().map(one).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
    }

    /// Adds a copy of a disc with another normal.
    pub(crate) fn push_copy(&mut self, i: usize, normal: Vec3) {
        self.points.push(Point { normal: normal.to_array(), ..self.points[i] });
        if !self.extras.is_empty() {
            self.extras.push(self.extras[i]);
        }
    }

    /// One record a disc or dot: position, radius, normal and level, in the space of the picture.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Number of discs and dots.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Places that must be seen for all discs of that scale to be seen: four on the outline of each, and the middle of
    /// each dot. For [`Camera::look`](crate::Camera::look).
    pub fn outline(&self, splat_scale: f32) -> impl Iterator<Item = Vec3> + Clone {
        self.points.iter().flat_map(move |point| {
            let (along, across) =
                Vec3::from(point.normal).normalize_or_zero().any_orthonormal_pair();
            let radius = SOLID * splat_scale * point.radius.max(0.0);
            let radius = if point.normal == [0.0; 3] { 0.0 } else { radius };
            [along, -along, across, -across].map(|axis| Vec3::from(point.position) + radius * axis)
        })
    }

    pub(crate) fn extra(&self, i: usize) -> Extra {
        self.extras.get(i).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::tests::{members, module, wgsl_struct};

    #[test]
    fn records_are_laid_out_alike() {
        let module = module("splat");
        let point = members!(Point::default(), Point { position, radius, normal, level });
        assert_eq!(wgsl_struct(&module, "Point"), (point, size_of::<Point>()));

        let extra = members!(Extra::default(), Extra { ends, paint, sides } padding distances);
        let (mut members, size) = wgsl_struct(&module, "Extra");
        // The shader does not read the distances.
        assert_eq!(members.pop().map(|m| m.0).as_deref(), Some("padding"));
        assert_eq!((members, size), (extra, size_of::<Extra>()));
    }
}
