//! The conflict graph `T`: which points must not be refined at the same time. Twin: `shaders/conflicts.wgsl`.
//!
//! The insertion around a point (section 5) depends on those before it. Two points commute unless
//! a candidate of one lies within `λ1 r` of the other, so that it would enter its N', or
//! candidates x and y of the two have `|x - y| < λ2 max(ρ_x, ρ_y)`, so that one would discard the other.

use crate::candidates::Candidates;
use crate::neighborhood::Rings;
use crate::{Level, NO_POINT};
use rayon::prelude::*;
use surfine_points::{Grid, RefineParams};

/// Lists of points, one list a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    /// First entry of each list, and one more: the number of entries.
    pub starts: Vec<u32>,
    /// Neighbours in the graph, ascending within a list.
    pub items: Vec<u32>,
}

impl Graph {
    /// The neighbours of a point.
    pub fn neighbors(&self, p: usize) -> &[u32] {
        &self.items[self.starts[p] as usize..self.starts[p + 1] as usize]
    }
}

/// Computes `T`: symmetric, without loops.
pub fn conflicts(
    level: &Level,
    rings: &Rings,
    candidates: &Candidates,
    candidate_grid: &Grid,
    params: &RefineParams,
) -> Graph {
    let found: Vec<Vec<u32>> = (0..level.len())
        .into_par_iter()
        .map(|p| found_from(level, rings, candidates, candidate_grid, params, p))
        .collect();
    // Both conditions are seen from one side only when the radii differ: add the other side.
    let mut lists = found.clone();
    for (p, list) in found.iter().enumerate() {
        for &q in list {
            lists[q as usize].push(p as u32);
        }
    }
    let mut graph = Graph { starts: vec![0], items: Vec::new() };
    for mut list in lists {
        list.sort_unstable();
        list.dedup();
        graph.items.extend(list);
        graph.starts.push(graph.items.len() as u32);
    }
    graph
}

/// The points in conflict with `p` through its own balls: `λ1 r` around it, `λ2 ρ` around its candidates.
fn found_from(
    level: &Level,
    rings: &Rings,
    candidates: &Candidates,
    candidate_grid: &Grid,
    params: &RefineParams,
    p: usize,
) -> Vec<u32> {
    let center = level.positions[p];
    let near = candidates.near[p];
    let own: Vec<usize> = rings.slots(p).filter(|&s| candidates.exists(s)).collect();
    let mut reach = near;
    for &s in &own {
        let d = candidates.positions[s] - center;
        reach = reach.max(d.dot(d).sqrt() + params.lambda2 * candidates.rho[s]);
    }
    // Beyond it no ball reaches, whatever the rounding.
    let reach_squared = reach * reach * 1.001;
    let mut found = Vec::new();
    candidate_grid.visit_ball(center, reach, |y| {
        let position = candidates.positions[y as usize];
        let d = position - center;
        let d2 = d.dot(d);
        let q = candidates.owners[y as usize];
        // Points on curves are there before all others: nobody has them.
        if q == NO_POINT || d2 > reach_squared || q as usize == p || found.contains(&q) {
            return;
        }
        let close = d2 < near * near
            || own.iter().any(|&x| {
                let d = position - candidates.positions[x];
                let sphere = params.lambda2 * candidates.rho[x];
                d.dot(d) < sphere * sphere
            });
        if close {
            found.push(q);
        }
    });
    found
}
