//! New points on feature curves: two at the thirds of each segment's cubic Bézier curve, at every second step (section 6).

use crate::{Features, NONE, Record, Segment};
use glam::Vec3;
use surfine_points::math::unit;

/// A new radius exceeds the distance to the neighbours on the curve by this factor, as all radii do.
const COVER: f32 = 1.02;
/// Cosine of 60°: a boundary that turns more at a point has a corner there, not a tangent.
const CORNER: f32 = 0.5;

/// A new record on a feature curve: one side of a new crease point, or a new boundary point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Position on the curve.
    pub position: Vec3,
    /// Unit normal of the side.
    pub normal: Vec3,
    /// `ρ`: half of the segment, so that the discard spheres keep candidates off the curve.
    pub rho: f32,
    /// Smallest radius: it covers the neighbours on the curve.
    pub radius: f32,
    /// The ends of the segment as points; the nearer one counts twice.
    pub parents: [u32; 3],
}

/// A new point before it has a record.
struct Third {
    position: Vec3,
    tangent: Vec3,
    radius: f32,
}

impl Features {
    /// Puts new records on all segments, after the old ones and in the order of the segments. They join the level in
    /// [`Features::commit`].
    pub fn split(&mut self) -> Vec<CurvePoint> {
        let mut points = Vec::new();
        for index in 0..self.segments.len() {
            let segment = self.segments[index];
            // Where numbers have no room for a point between the ends the curve stays as it is.
            let Some([near_a, near_b]) = self.thirds(segment) else { continue };
            let sides = 1 + usize::from(!segment.is_boundary());
            for (third, [near, far]) in [(near_a, [0, 1]), (near_b, [1, 0])] {
                let first = self.records.len() as u32;
                for ends in &segment.sides[..sides] {
                    let ends = [ends[near], ends[far]].map(|r| self.records[r as usize]);
                    let record = new_record(&third, ends);
                    let (segment, sides) = (index as u32, sides as u32);
                    self.records.push(Record { first, sides, segment, ..record });
                    points.push(CurvePoint {
                        position: record.position,
                        normal: record.normal,
                        rho: 0.5 * (ends[1].position - ends[0].position).length(),
                        radius: third.radius,
                        parents: [ends[0].point, ends[0].point, ends[1].point],
                    });
                }
            }
            self.set_new_partners(segment, sides);
        }
        points
    }

    /// Partners of the last records, which lie on this segment: its ends and each other.
    fn set_new_partners(&mut self, segment: Segment, sides: usize) {
        let first = self.records.len() - 2 * sides;
        for side in 0..sides {
            let (a, b) = (first + side, first + sides + side);
            self.records[a].partners = [segment.sides[side][0], b as u32];
            self.records[b].partners = [a as u32, segment.sides[side][1]];
        }
        self.set_fans(first..self.records.len());
    }

    /// Makes the new records records of the level, numbered from `first_point` on, and joins them along the curves.
    pub fn commit(&mut self, first_point: usize) {
        for (i, record) in self.records[self.old..].iter_mut().enumerate() {
            record.point = (first_point + i) as u32;
        }
        let mut next = self.old as u32;
        let mut segments = Vec::new();
        if next < self.records.len() as u32 {
            for (index, segment) in (0u32..).zip(std::mem::take(&mut self.segments)) {
                if self.records.get(next as usize).is_none_or(|r| r.segment != index) {
                    segments.push(segment);
                    continue;
                }
                let sides = 1 + u32::from(!segment.is_boundary());
                let [a, b] = [next, next + sides];
                let piece = |from: Option<u32>, to: Option<u32>| Segment {
                    sides: [0, 1].map(|k| {
                        let ends = segment.sides[k as usize];
                        let new = |first: u32| first + k;
                        if k < sides {
                            [from.map_or(ends[0], new), to.map_or(ends[1], new)]
                        } else {
                            [NONE; 2]
                        }
                    }),
                };
                segments.extend([
                    piece(None, Some(a)),
                    piece(Some(a), Some(b)),
                    piece(Some(b), None),
                ]);
                next += 2 * sides;
            }
            self.segments = segments;
            self.records.iter_mut().for_each(|r| r.segment = NONE);
            self.records.iter_mut().for_each(|r| r.partners = [NONE; 2]);
            for segment in self.segments.clone() {
                self.join(segment);
            }
            self.set_fans(0..self.records.len());
        }
        self.old = self.records.len();
    }

    /// The points at the thirds of a segment's Bézier curve, from its first end on; none if any of the four fall together.
    fn thirds(&self, segment: Segment) -> Option<[Third; 2]> {
        let [a, b] = segment.sides[0].map(|r| self.records[r as usize]);
        let chord = b.position - a.position;
        let length = chord.length();
        if length == 0.0 {
            return None;
        }
        let leave_a = self.tangent(segment, 0, chord) * (length / 3.0);
        let leave_b = self.tangent(segment, 1, -chord) * (length / 3.0);
        // Control points relative to the first end.
        let (b1, b2, b3) = (leave_a, chord + leave_b, chord);
        let at = |t: f32| {
            let s = 1.0 - t;
            let position = b1 * (3.0 * s * s * t) + b2 * (3.0 * s * t * t) + b3 * (t * t * t);
            let derivative = b1 * (s * s) + (b2 - b1) * (2.0 * s * t) + (b3 - b2) * (t * t);
            let tangent =
                if derivative.dot(derivative) > 0.0 { unit(derivative) } else { Vec3::ZERO };
            (position, tangent)
        };
        let [(x, tx), (y, ty)] = [at(1.0 / 3.0), at(2.0 / 3.0)];
        let (x, y) = (a.position + x, a.position + y);
        let [first, middle, last] =
            [(a.position, x), (x, y), (y, b.position)].map(|(from, to)| (to - from).length());
        let radius = |to_end: f32| COVER * to_end.max(middle);
        (first.min(middle).min(last) > 0.0).then(|| {
            [
                Third { position: x, tangent: tx, radius: radius(first) },
                Third { position: y, tangent: ty, radius: radius(last) },
            ]
        })
    }

    /// Unit tangent of the curve at an end of a segment, into the segment along the chord that leaves there.
    fn tangent(&self, segment: Segment, end: usize, chord: Vec3) -> Vec3 {
        let own = self.records[segment.sides[0][end] as usize];
        let t = if segment.is_boundary() {
            self.boundary_tangent(&own, segment.sides[0][1 - end], chord)
        } else {
            own.normal.cross(self.records[segment.sides[1][end] as usize].normal)
        };
        if t.dot(t) == 0.0 {
            return unit(chord);
        }
        if t.dot(chord) < 0.0 { -unit(t) } else { unit(t) }
    }

    /// Direction of a boundary at a point: that of the circle through it and its partners, else that of the chord in the
    /// tangent plane.
    fn boundary_tangent(&self, own: &Record, to: u32, chord: Vec3) -> Vec3 {
        let flat = |d: Vec3| d - own.normal * d.dot(own.normal);
        let other = own.partners.into_iter().find(|&p| p != to && p != NONE);
        let Some(other) = other else { return flat(chord) };
        let back = own.position - self.records[other as usize].position;
        let (c2, b2) = (chord.dot(chord), back.dot(back));
        let turn = chord.dot(back) / (c2 * b2).sqrt();
        if b2 == 0.0 || turn < CORNER {
            flat(chord)
        } else {
            flat(chord * (1.0 / c2) + back * (1.0 / b2))
        }
    }
}

/// A side of a new crease point, or a new boundary point, from those at the ends of its segment, the nearer first.
fn new_record(third: &Third, [near, far]: [Record; 2]) -> Record {
    let &Third { position, tangent, .. } = third;
    let normal = normal_at_third(&near, &far);
    let across = normal - tangent * normal.dot(tangent);
    let normal = if across.dot(across) > 1e-6 { unit(across) } else { near.normal };
    let side = tangent.cross(normal);
    let inward = near.conormal + far.conormal;
    let conormal = if side.dot(inward) < 0.0 { -side } else { side };
    let mut record = Record::new(NONE, position, normal);
    record.conormal =
        if conormal.dot(conormal) > 1e-6 { unit(conormal) } else { record.frame_default() };
    record
}

/// Quadratic normal (Vlachos et al. 2001, section 3.3) at the third of an edge that is nearer to its first end, of any
/// length.
fn normal_at_third(near: &Record, far: &Record) -> Vec3 {
    let d = far.position - near.position;
    let sum = near.normal + far.normal;
    let d2 = d.dot(d);
    let reflected = if d2 > 0.0 { sum - d * (2.0 * (d.dot(sum) / d2)) } else { sum };
    let middle = if reflected.dot(reflected) > 1e-12 { unit(reflected) } else { Vec3::ZERO };
    near.normal * (4.0 / 9.0) + middle * (4.0 / 9.0) + far.normal * (1.0 / 9.0)
}
