//! Classes of points that may be refined together: a colouring of `T` (Jones and Plassmann 1993).
//! Twin: `shaders/coloring.wgsl`.

use crate::conflicts::Graph;

/// The class of every point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Classes {
    /// Class of each point, from 0.
    pub class: Vec<u32>,
    /// The points of each class, ascending.
    pub members: Vec<Vec<u32>>,
}

/// A bijection of the 32-bit integers without visible order (`lowbias32`, C. Wellons).
fn scramble(id: u32) -> u32 {
    let mut x = id;
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Whether `p` chooses its class before `q`: by a priority that depends on the index alone, never on timing.
pub fn chooses_before(p: u32, q: u32) -> bool {
    scramble(p) > scramble(q)
}

/// Gives every point, in the order of priority, the lowest class that none of its neighbours chose before it.
///
/// The kernels reach the same classes in rounds, since a point's choice depends on those before it alone.
pub fn coloring(graph: &Graph) -> Classes {
    let n = graph.starts.len() - 1;
    let mut order: Vec<u32> = (0..n as u32).collect();
    order.sort_unstable_by_key(|&p| std::cmp::Reverse(scramble(p)));
    let mut class = vec![0; n];
    let mut members: Vec<Vec<u32>> = Vec::new();
    let mut taken = Vec::new();
    for p in order {
        taken.clear();
        taken.resize(members.len() + 1, false);
        for &q in graph.neighbors(p as usize) {
            if chooses_before(q, p) {
                taken[class[q as usize] as usize] = true;
            }
        }
        let lowest = taken.iter().position(|&t| !t).unwrap_or(members.len());
        class[p as usize] = lowest as u32;
        if lowest == members.len() {
            members.push(Vec::new());
        }
        members[lowest].push(p);
    }
    members.iter_mut().for_each(|m| m.sort_unstable());
    Classes { class, members }
}

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
        let mut graph = Graph { starts: vec![0], items: Vec::new() };
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
