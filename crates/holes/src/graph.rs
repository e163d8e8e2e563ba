//! The graph of mutual neighbours, drawn without crossings (rule 0, ours).
//!
//! The one-rings of [R] section 4 need not agree: p may have q where q does not have p. Where they do agree the edges
//! nearly triangulate the surface, and what they leave open is a loop.

use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::collections::BTreeSet;
use surfine_points::RefineParams;
use surfine_reference::math::tangent_frame;
use surfine_reference::neighborhood::{RingEntry, neighborhood};
use surfine_reference::{Level, point_grid};

/// For each point its neighbours by angle, one list after the other. Every edge is there twice, once from each end.
#[derive(Debug)]
pub(crate) struct Graph {
    /// First entry of each point's list, and one more: the number of entries.
    pub(crate) starts: Vec<u32>,
    pub(crate) entries: Vec<RingEntry>,
}

/// An edge, its lower index first.
pub(crate) type Edge = [u32; 2];

impl Graph {
    /// The mutual edges of the one-rings; of two that cross the longer is dropped.
    pub(crate) fn new(level: &Level) -> Self {
        let rings = neighborhood(level, &point_grid(level), &RefineParams::default());
        let lists = (0..level.len()).into_par_iter().map(|p| {
            let has_p =
                |e: &&RingEntry| rings.ring(e.id as usize).iter().any(|b| b.id as usize == p);
            rings.ring(p).iter().filter(has_p).copied().collect()
        });
        let mutual = Self::from_lists(lists.collect());
        let dropped = mutual.longer_of_crossing(level);
        mutual.without(&dropped)
    }

    /// The graph without these edges; they are sorted.
    pub(crate) fn without(&self, dropped: &[Edge]) -> Self {
        let lists = (0..self.starts.len() - 1).map(|p| {
            let keeps = |e: &&RingEntry| dropped.binary_search(&edge(p as u32, e.id)).is_err();
            self.list(p).iter().filter(keeps).copied().collect()
        });
        Self::from_lists(lists.collect())
    }

    fn from_lists(lists: Vec<Vec<RingEntry>>) -> Self {
        let mut starts = vec![0];
        let mut end = 0;
        starts.extend(lists.iter().map(|list| {
            end += list.len() as u32;
            end
        }));
        Self { starts, entries: lists.concat() }
    }

    /// The neighbours of a point by angle.
    pub(crate) fn list(&self, p: usize) -> &[RingEntry] {
        &self.entries[self.starts[p] as usize..self.starts[p + 1] as usize]
    }

    /// Mean length of the edges at a point; 0 if it has none.
    pub(crate) fn mean_edge(&self, level: &Level, p: usize) -> f32 {
        let list = self.list(p);
        let sum: f32 = list.iter().map(|e| distance(level, p as u32, e.id)).sum();
        sum / list.len().max(1) as f32
    }

    /// The edges that cross a shorter one that stays, sorted.
    fn longer_of_crossing(&self, level: &Level) -> Vec<Edge> {
        let mut pairs: Vec<[Edge; 2]> = (0..level.len())
            .into_par_iter()
            .flat_map_iter(|p| self.list(p).iter().map(move |e| (p as u32, e.id)))
            .filter(|(p, q)| p < q)
            .flat_map_iter(|(p, q)| self.crossing(level, [p, q]))
            .collect();
        // The longer edge first; an edge is judged after all shorter ones that it crosses.
        let by_length = |a: &Edge, b: &Edge| {
            let [a_length, b_length] = [a, b].map(|e| distance(level, e[0], e[1]));
            a_length.total_cmp(&b_length).then(a.cmp(b))
        };
        for pair in &mut pairs {
            if by_length(&pair[0], &pair[1]).is_lt() {
                pair.swap(0, 1);
            }
        }
        pairs.sort_by(|a, b| by_length(&a[0], &b[0]).then(a[1].cmp(&b[1])));
        let mut dropped = BTreeSet::new();
        for [long, short] in pairs {
            if !dropped.contains(&short) {
                dropped.insert(long);
            }
        }
        dropped.into_iter().collect()
    }

    /// The edges at neighbours of either end that cross this edge on the tangent plane of its first end.
    fn crossing(&self, level: &Level, [p, q]: Edge) -> Vec<[Edge; 2]> {
        let center = level.positions[p as usize];
        let (e1, e2) = tangent_frame(level.normals[p as usize]);
        let flat = |id: u32| {
            let d: Vec3 = level.positions[id as usize] - center;
            Vec2::new(d.dot(e1), d.dot(e2))
        };
        let end = flat(q);
        let mut found = Vec::new();
        for e in [p, q].into_iter().flat_map(|end| self.list(end as usize)) {
            let c = e.id;
            if c == p || c == q {
                continue;
            }
            for d in self.list(c as usize).iter().map(|e| e.id) {
                if d != p && d != q && cross(Vec2::ZERO, end, flat(c), flat(d)) {
                    found.push([[p, q], edge(c, d)]);
                }
            }
        }
        found
    }
}

/// The edge between two points.
pub(crate) fn edge(a: u32, b: u32) -> Edge {
    if a < b { [a, b] } else { [b, a] }
}

/// Distance of two points.
pub(crate) fn distance(level: &Level, a: u32, b: u32) -> f32 {
    let d = level.positions[b as usize] - level.positions[a as usize];
    d.dot(d).sqrt()
}

/// Whether the insides of two segments cross.
fn cross(a: Vec2, b: Vec2, c: Vec2, d: Vec2) -> bool {
    let side = |a: Vec2, b: Vec2, x: Vec2| (b - a).perp_dot(x - a);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}
