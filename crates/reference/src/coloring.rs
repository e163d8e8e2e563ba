//! Classes of points that may be refined together: a colouring of `T` (Jones and Plassmann 1993).
//! Twin: `shaders/coloring.wgsl`.

use crate::lists::Lists;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// The class of every point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Classes {
    /// Class of each point, from 0.
    pub class: Vec<u32>,
    /// The points of each class, ascending.
    pub members: Vec<Vec<u32>>,
}

/// The priority of a point: a bijection of the 32-bit integers without visible order (`lowbias32`, C. Wellons).
pub(crate) fn scramble(id: u32) -> u32 {
    let mut x = id;
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Ranges of priorities, one after the other: few points of one range are neighbours.
pub const RANGES: usize = 32;

/// Gives every point, in the order of priority, the lowest class that none of its neighbours `before` it chose.
///
/// A point's choice depends on those before it alone. So the points of a range choose in any order, on all cores, and
/// those with a neighbour before them that has not chosen yet try again; the kernels do the same.
pub fn coloring(before: &Lists) -> Classes {
    let points = before.len() as u32;
    let range = |&p: &u32| scramble(p) as usize / (1 << 32 >> RANGES.ilog2());
    let mut ranges = vec![Vec::new(); RANGES];
    (0..points).for_each(|p| ranges[range(&p)].push(p));
    let class: Vec<AtomicU32> = (0..points).map(|_| AtomicU32::new(NONE_YET)).collect();
    for mut waiting in ranges.into_iter().rev() {
        while !waiting.is_empty() {
            let chosen = |p: &u32| choose(before.of(*p as usize), &class, *p);
            waiting = waiting.into_par_iter().with_min_len(1024).filter(|p| !chosen(p)).collect();
        }
    }
    let class: Vec<u32> = class.into_iter().map(AtomicU32::into_inner).collect();
    let mut members: Vec<Vec<u32>> = Vec::new();
    for (p, &class) in (0..).zip(&class) {
        members.resize_with(members.len().max(class as usize + 1), Vec::new);
        members[class as usize].push(p);
    }
    Classes { class, members }
}

/// Of points that have not chosen.
const NONE_YET: u32 = u32::MAX;

/// Gives a point its class, if all neighbours before it have theirs.
fn choose(before: &[u32], class: &[AtomicU32], p: u32) -> bool {
    let mut taken = 0u64;
    for &q in before {
        let class = class[q as usize].load(Relaxed);
        if class == NONE_YET {
            return false;
        }
        taken |= 1u64.checked_shl(class).unwrap_or(0);
    }
    let mut lowest = taken.trailing_ones();
    // More classes than bits are rare.
    let is_taken = |own: u32| before.iter().any(|&q| class[q as usize].load(Relaxed) == own);
    while lowest >= u64::BITS && is_taken(lowest) {
        lowest += 1;
    }
    class[p as usize].store(lowest, Relaxed);
    true
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
        let mut before = Lists::default();
        for (p, list) in (0..).zip(&lists) {
            before.items.extend(list.iter().filter(|&&q| scramble(q) > scramble(p)));
            before.starts.push(before.items.len() as u32);
        }
        let classes = coloring(&before);
        for (p, list) in lists.iter().enumerate() {
            for &q in list {
                assert_ne!(classes.class[p], classes.class[q as usize], "{p} {q}");
            }
        }
        assert_eq!(classes.members.iter().map(Vec::len).sum::<usize>(), lists.len());
    }
}
