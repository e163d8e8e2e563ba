//! Classes of points that may be refined together: a colouring of `T` (Jones and Plassmann 1993).
//! Twin: `shaders/coloring.wgsl`.

use crate::lists::Lists;
use rayon::prelude::*;

/// The class of every point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Classes {
    /// Class of each point, from 0.
    pub class: Vec<u32>,
    /// The points of each class, ascending.
    pub members: Vec<Vec<u32>>,
}

/// The priority of a point: a bijection of the 32-bit integers without visible order (`lowbias32`, C. Wellons).
fn scramble(id: u32) -> u32 {
    let mut x = id;
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Gives every point, in the order of priority, the lowest class that none of its neighbours chose before it.
///
/// The kernels reach the same classes in rounds, since a point's choice depends on those before it alone.
pub fn coloring(graph: &Lists) -> Classes {
    let mut order: Vec<(u32, u32)> =
        (0..graph.len() as u32).into_par_iter().map(|p| (scramble(p), p)).collect();
    order.par_sort_unstable_by(|a, b| b.cmp(a));
    let mut class = vec![NONE_YET; graph.len()];
    let mut taken = Vec::new();
    for (_, p) in order {
        taken.clear();
        for &q in graph.of(p as usize) {
            let chosen = class[q as usize] as usize;
            if chosen != NONE_YET as usize {
                taken.resize(taken.len().max(chosen + 1), false);
                taken[chosen] = true;
            }
        }
        let lowest = taken.iter().position(|&t| !t).unwrap_or(taken.len());
        class[p as usize] = lowest as u32;
    }
    let mut members: Vec<Vec<u32>> = Vec::new();
    for (p, &class) in (0..).zip(&class) {
        members.resize_with(members.len().max(class as usize + 1), Vec::new);
        members[class as usize].push(p);
    }
    Classes { class, members }
}

/// Of points that have not chosen.
const NONE_YET: u32 = u32::MAX;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbors_differ_in_class() {
        // A wheel: the hub touches all, the rim is a ring of odd length.
        let rim = 9u32;
        let mut lists = vec![(1..=rim).collect::<Vec<u32>>()];
        for i in 0..rim {
            lists.push(vec![0, 1 + (i + 1) % rim, 1 + (i + rim - 1) % rim]);
        }
        let mut graph = Lists::default();
        for list in &lists {
            graph.items.extend(list);
            graph.starts.push(graph.items.len() as u32);
        }
        let classes = coloring(&graph);
        for (p, list) in lists.iter().enumerate() {
            for &q in list {
                assert_ne!(classes.class[p], classes.class[q as usize], "{p} {q}");
            }
        }
        assert_eq!(classes.members.iter().map(Vec::len).sum::<usize>(), lists.len());
    }
}
