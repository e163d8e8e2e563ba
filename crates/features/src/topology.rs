//! Who follows whom along the curves.

use crate::{Cloud, Features, NONE, Record, Segment};
use glam::Vec3;
use std::collections::HashMap;
use std::f32::consts::{FRAC_PI_2, PI, TAU};
use surfine_points::math::{direction_angle, tangent_frame};

/// A fan reaches beyond the curves that bound it by 15°, radians: its members lie on both sides of the true curve.
const BEYOND: f32 = 0.261_799_4;

impl Record {
    pub(crate) fn new(point: u32, position: Vec3, normal: Vec3) -> Self {
        Self {
            point,
            position,
            normal,
            conormal: Vec3::ZERO,
            partners: [NONE; 2],
            first: 0,
            sides: 1,
            wedge: [0.0, TAU],
            segment: NONE,
        }
    }

    /// Any direction in the tangent plane.
    pub(crate) fn frame_default(&self) -> Vec3 {
        tangent_frame(self.normal).0
    }
}

impl Features {
    /// Records of the groups that the segments reach, which are given by points; translates the segments to records.
    pub(crate) fn add_creases(
        &mut self,
        cloud: Cloud<'_>,
        groups: &[Vec<u32>],
        segments: &[Segment],
    ) {
        let mut record_of: HashMap<u32, u32> = HashMap::new();
        let mut reached: Vec<u32> =
            segments.iter().flat_map(|s| s.sides.into_iter().flatten()).collect();
        reached.sort_unstable();
        for group in groups.iter().filter(|g| g.iter().any(|p| reached.binary_search(p).is_ok())) {
            let first = self.records.len() as u32;
            for (i, &point) in (first..).zip(group) {
                let at = point as usize;
                let record = Record::new(point, cloud.positions[at], cloud.normals[at]);
                self.records.push(Record { first, sides: group.len() as u32, ..record });
                record_of.insert(point, i);
            }
        }
        self.segments = segments
            .iter()
            .map(|s| Segment { sides: s.sides.map(|ends| ends.map(|point| record_of[&point])) })
            .collect();
        for segment in self.segments.clone() {
            self.join(segment);
        }
    }

    /// Makes the ends of a segment each other's partners, in whatever order.
    pub(crate) fn join(&mut self, segment: Segment) {
        for [a, b] in segment.sides.into_iter().filter(|ends| ends[0] != NONE) {
            for (from, to) in [(a, b), (b, a)] {
                let partners = &mut self.records[from as usize].partners;
                let place = usize::from(partners[0] != NONE);
                partners[place] = to;
            }
        }
    }

    /// Orders the partners of records around them, and sets the angles between which their fans lie.
    pub(crate) fn set_fans(&mut self, records: std::ops::Range<usize>) {
        for i in records {
            let record = self.records[i];
            let angle = |partner: u32| {
                let d = self.records[partner as usize].position - record.position;
                let (e1, e2) = record.frame();
                direction_angle(d.dot(e2), d.dot(e1))
            };
            let (partners, [from, to]) = match record.partners {
                [NONE, NONE] => ([NONE; 2], [FRAC_PI_2, 3.0 * FRAC_PI_2]),
                [a, NONE] | [NONE, a] if angle(a) < PI => ([a, NONE], [angle(a), 3.0 * FRAC_PI_2]),
                [a, NONE] | [NONE, a] => ([NONE, a], [FRAC_PI_2, angle(a)]),
                [a, b] if angle(a) <= angle(b) => ([a, b], [angle(a), angle(b)]),
                [a, b] => ([b, a], [angle(b), angle(a)]),
            };
            let record = &mut self.records[i];
            record.partners = partners;
            record.wedge = [from - BEYOND, to + BEYOND];
        }
    }
}
