//! How much memory a step provides before it knows what it needs. `forecast.rs` counts with the same sizes.

use crate::buffers::Buffer;
use surfine_points::{Boundary, RefineParams};

/// Bytes of a word.
pub(crate) const WORD: u64 = 4;

/// How much is done and provided for at once. No result depends on it.
#[derive(Clone, Copy, Debug)]
pub struct Sizing {
    /// Points that share the arena: those after them use it again.
    pub chunk: u32,
    /// Points of a class that are refined together.
    pub part: u32,
    /// Entries of lists that are provided for each point before their need is known: as many candidates are around a
    /// point, by the paper's loop. Other lists have their part of it.
    pub entries: u32,
    /// Rounds of the colouring that are recorded together; those of the selection too, but three at most.
    pub rounds: u32,
}

impl Default for Sizing {
    fn default() -> Self {
        Self { chunk: 1 << 17, part: u32::MAX, entries: 18, rounds: 8 }
    }
}

impl Sizing {
    /// Entries of all rings. Points of an even cloud have six; a seventh saves the second run where a few have more.
    pub(crate) fn ring_entries(&self, points: u64) -> u64 {
        points.saturating_mul(self.entries.min(7).into())
    }

    /// Links from candidates to those that discard them: about one for each point, where .02 to .1 for each candidate
    /// were seen.
    pub(crate) fn links(&self, points: u64) -> u64 {
        points.saturating_mul(self.entries.into()) / 16
    }

    /// Entries of the lists around points, by the paper's loop: candidates, and points in conflict.
    pub(crate) fn around_entries(&self, points: u64) -> u64 {
        points.saturating_mul((4 * self.entries / 3).into())
    }

    /// Links of conflicts to the point that did not find them: few are seen from one side only.
    pub(crate) fn mirror_links(&self, points: u64) -> u64 {
        points.saturating_mul((self.entries / 12).into())
    }

    /// Points that share the arena, if the longest row has so many words: one for each neighbour, for `conflicts`
    /// three.
    pub(crate) fn chunk_of(&self, longest_row: u32) -> u32 {
        // A point with k neighbours looks at k² pairs. Drivers end what takes them seconds; a workgroup is the least.
        const PAIRS: u64 = 1 << 36;
        let row = u64::from(longest_row.max(1));
        let points = (PAIRS / (row * row)).max(64);
        u32::try_from(points).unwrap_or(u32::MAX).min(self.chunk)
    }
}

/// Points whose rings may leave gaps that are read back: a sixteenth of them where few lie on boundaries, all where a
/// property says which do.
pub(crate) fn boundary_gaps(params: &RefineParams, points: u64) -> u64 {
    match params.boundary {
        Boundary::None => 0,
        Boundary::Angle(_) => points / 16 + 1024,
        Boundary::Marked(_) => points,
    }
}

/// Radii of a step: of the points, of the candidates, and of the points as they were before `next_ring`.
pub(crate) fn radii(points: u64, candidates: u64) -> u64 {
    points.saturating_mul(2).saturating_add(candidates)
}

/// What kernels counted in two words.
pub(crate) fn counted(low: u32, high: u32) -> u64 {
    u64::from(high) << 32 | u64::from(low)
}

/// Whole words that kernels see of a buffer.
pub(crate) fn words_of(buffer: &Buffer) -> u32 {
    items_of(buffer, 1)
}

/// Whole items of so many words that kernels see of a buffer.
pub(crate) fn items_of(buffer: &Buffer, words: u64) -> u32 {
    u32::try_from(buffer.seen() / (WORD * words)).unwrap_or(u32::MAX)
}
