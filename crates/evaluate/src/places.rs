//! Different positions, and the points that share them.

use std::collections::HashMap;

use surfine_points::DVec3;

/// The different positions of a cloud in the order in which they first occur.
///
/// Files may store a point of a crease once a normal: several points, one place.
#[derive(Clone, Debug)]
pub(crate) struct Places {
    /// Each position once.
    pub(crate) positions: Vec<DVec3>,
    /// Index of each point's place.
    pub(crate) of_point: Vec<u32>,
    /// Where each place's points begin in `points`, and the end.
    starts: Vec<u32>,
    /// Points by place, ascending within one.
    points: Vec<u32>,
}

impl Places {
    pub(crate) fn new(points: &[DVec3]) -> Self {
        let mut seen = HashMap::with_capacity(points.len());
        let mut positions = Vec::new();
        let of_point: Vec<u32> = points
            .iter()
            .map(|&p| {
                // Adding zero makes one zero of the two.
                let bits = (p + 0.0).to_array().map(f64::to_bits);
                *seen.entry(bits).or_insert_with(|| {
                    positions.push(p);
                    positions.len() as u32 - 1
                })
            })
            .collect();
        let (starts, points) = invert(&of_point, positions.len());
        Self { positions, of_point, starts, points }
    }

    /// Number of different positions.
    pub(crate) fn len(&self) -> usize {
        self.positions.len()
    }

    /// The points at a place: one at least.
    pub(crate) fn points_at(&self, place: usize) -> &[u32] {
        &self.points[self.starts[place] as usize..self.starts[place + 1] as usize]
    }
}

/// Lists, for each of `count` groups, the entries that belong to it: where each list begins, and the lists in a row.
pub(crate) fn invert(group_of: &[u32], count: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; count + 1];
    for &group in group_of {
        starts[group as usize + 1] += 1;
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut entries = vec![0; group_of.len()];
    for (entry, &group) in (0u32..).zip(group_of) {
        let slot = &mut next[group as usize];
        entries[*slot as usize] = entry;
        *slot += 1;
    }
    (starts, entries)
}

/// Of several points, the one whose normal agrees best with `normal`: points of a crease that share a place stand for
/// its sides. The first one if there is nothing to choose by.
pub(crate) fn same_side(
    points: &[u32],
    normals: Option<&[Option<DVec3>]>,
    normal: Option<DVec3>,
) -> usize {
    let first = points[0] as usize;
    let (Some(normals), Some(normal), true) = (normals, normal, points.len() > 1) else {
        return first;
    };
    let agreement = |i: usize| normals[i].map_or(f64::NEG_INFINITY, |n| n.dot(normal));
    points
        .iter()
        .map(|&i| i as usize)
        .fold(first, |best, i| if agreement(i) > agreement(best) { i } else { best })
}
