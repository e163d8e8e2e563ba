//! The members of a ring in the order of their angles. Twin: `shaders/shared/sort_ring.wgsl`.

use crate::columns::{LANES, vectorized};

/// Members in the order of their angles, ties by index.
#[derive(Default)]
pub(crate) struct RingOrder {
    len: usize,
    /// Which members these are in their ball.
    members: Vec<u32>,
    /// Angles are not negative, so their bits order like they do. Those of the index follow them.
    keys: Vec<u64>,
    /// How many keys are smaller than each.
    ranks: Vec<u64>,
}

impl RingOrder {
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes room for so many more.
    pub(crate) fn prepare(&mut self, count: usize) {
        let room = (self.len + count + 1).next_multiple_of(LANES);
        if self.keys.len() < room {
            self.members.resize(room, 0);
            self.keys.resize(room, 0);
            self.ranks.resize(room, 0);
        }
    }

    /// Adds a member if it is wanted; there must be room. It is written in any case: a branch
    /// would be guessed wrong often.
    #[inline(always)]
    pub(crate) fn offer(&mut self, member: u32, angle: f32, id: u32, is_wanted: bool) {
        self.members[self.len] = member;
        self.keys[self.len] = u64::from(angle.to_bits()) << 32 | u64::from(id);
        self.len += usize::from(is_wanted);
    }

    /// The members, in any order.
    pub(crate) fn members(&self) -> &[u32] {
        &self.members[..self.len]
    }

    /// The members, each with its rank among all. To count what comes before each takes as many comparisons as there
    /// are pairs, but they are made in vector registers, and none has to be guessed.
    pub(crate) fn sorted(&mut self) -> impl ExactSizeIterator<Item = (usize, usize)> {
        find_ranks(&self.keys[..self.len.next_multiple_of(LANES)], self.len, &mut self.ranks);
        let members = &self.members[..self.len];
        members.iter().zip(&self.ranks).map(|(&member, &rank)| (member as usize, rank as usize))
    }
}

vectorized! {
    /// How many of the first `count` keys are smaller than each.
    fn find_ranks(keys: &[u64], count: usize, ranks: &mut [u64]) {
        let blocks = keys.as_chunks::<LANES>().0.iter().zip(ranks.as_chunks_mut::<LANES>().0);
        for (own, ranks) in blocks {
            let mut smaller = [0; LANES];
            for &key in &keys[..count] {
                for lane in 0..LANES {
                    smaller[lane] += u64::from(key < own[lane]);
                }
            }
            *ranks = smaller;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_are_ranked_by_angle_then_index() {
        for count in [0u32, 1, 7, 8, 9, 30] {
            let (mut order, mut expected) = (RingOrder::default(), Vec::new());
            order.prepare(count as usize);
            for i in 0..count {
                let (angle, id) = ((i * 7 % 5) as f32, i * 11 % 31);
                order.offer(i, angle, id, i % 4 != 3);
                expected.extend((i % 4 != 3).then_some((angle.to_bits(), id, i as usize)));
            }
            expected.sort_unstable();
            for (member, rank) in order.sorted() {
                assert_eq!(expected[rank].2, member, "of {count}");
            }
        }
    }
}
