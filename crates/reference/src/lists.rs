//! Lists that belong to points, one after the other in memory.

use rayon::prelude::*;
use std::ops::Range;

/// Points whose lists one thread makes before it takes the next ones.
const CHUNK: usize = 1024;

/// The lists of a level have more entries together than 32 bits number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLong;

/// One list a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Lists<T = u32> {
    /// First entry of each list, and one more: the number of entries.
    pub starts: Vec<u32>,
    /// The entries of all lists.
    pub items: Vec<T>,
}

impl<T> Default for Lists<T> {
    fn default() -> Self {
        Self { starts: vec![0], items: Vec::new() }
    }
}

impl<T: Copy + Default + Send + Sync> Lists<T> {
    /// Makes the lists of so many points on all cores: `make` appends that of a point.
    pub(crate) fn make(
        points: usize,
        make: impl Fn(usize, &mut Chunk<T>) + Sync,
    ) -> Result<Self, TooLong> {
        let make = |(): &mut (), points: Range<usize>, [lists]: &mut [Chunk<T>; 1]| {
            for p in points {
                make(p, lists);
                lists.end();
            }
        };
        let [lists] = Self::in_chunks(points, || (), make)?;
        Ok(lists)
    }

    /// Makes some lists for each point, those of many points at once: `make` appends and ends them. `scratch` makes
    /// what a thread keeps from one call to the next.
    pub(crate) fn in_chunks<const N: usize, S>(
        points: usize,
        scratch: impl Fn() -> S + Sync,
        make: impl Fn(&mut S, Range<usize>, &mut [Chunk<T>; N]) + Sync,
    ) -> Result<[Self; N], TooLong> {
        let init = || (scratch(), [0; N]);
        let chunks: Vec<[Chunk<T>; N]> = (0..points.div_ceil(CHUNK))
            .into_par_iter()
            .map_init(init, |(scratch, entries), chunk| {
                // As many as the last chunk of the thread had, and some more.
                let mut lists = entries.map(Chunk::new);
                let own = chunk * CHUNK..((chunk + 1) * CHUNK).min(points);
                make(scratch, own, &mut lists);
                *entries = lists.each_ref().map(|list| list.items.len() * 9 / 8);
                lists
            })
            .collect();
        // Beyond, the places of lists would wrap around.
        let total = |k: usize| chunks.iter().map(|lists| lists[k].items.len()).sum::<usize>();
        if (0..N).any(|k| u32::try_from(total(k)).is_err()) {
            return Err(TooLong);
        }
        Ok(std::array::from_fn(|k| Self::join(chunks.iter().map(|lists| &lists[k]))))
    }

    fn join<'a>(chunks: impl Iterator<Item = &'a Chunk<T>> + Clone) -> Self
    where
        T: 'a,
    {
        let total = chunks.clone().map(|chunk| chunk.items.len()).sum();
        let mut starts = vec![0];
        let mut items = vec![T::default(); total];
        let (mut rest, mut parts) = (items.as_mut_slice(), Vec::new());
        for chunk in chunks {
            let first = starts[starts.len() - 1];
            starts.extend(chunk.ends.iter().map(|end| first + end));
            let (part, after) = rest.split_at_mut(chunk.items.len());
            parts.push((part, &chunk.items));
            rest = after;
        }
        parts.into_par_iter().for_each(|(part, own)| part.copy_from_slice(own));
        Self { starts, items }
    }
}

/// The lists of some points: where each ends, and their entries.
pub(crate) struct Chunk<T> {
    ends: Vec<u32>,
    pub(crate) items: Vec<T>,
}

impl<T: Copy> Chunk<T> {
    fn new(entries: usize) -> Self {
        Self { ends: Vec::with_capacity(CHUNK), items: Vec::with_capacity(entries) }
    }

    /// Appends an entry to the list of a point if it is wanted.
    #[inline(always)]
    pub(crate) fn offer(&mut self, entry: T, is_wanted: bool) {
        offer(&mut self.items, entry, is_wanted);
    }

    /// Ends the list of a point.
    pub(crate) fn end(&mut self) {
        self.ends.push(self.items.len() as u32);
    }
}

impl<T> Lists<T> {
    /// Number of lists.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there are no lists.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where the entries of a point's list are.
    pub fn range(&self, p: usize) -> Range<usize> {
        self.starts[p] as usize..self.starts[p + 1] as usize
    }

    /// The list of a point.
    pub fn of(&self, p: usize) -> &[T] {
        &self.items[self.range(p)]
    }
}

/// So many entries of the same value, written by all cores: they will fill them, and fresh memory costs
/// more than to write to it.
pub(crate) fn filled<T: Copy + Send + Sync>(value: T, len: usize) -> Vec<T> {
    (0..len).into_par_iter().with_min_len(1 << 14).map(|_| value).collect()
}

/// Appends an entry if it is wanted. It is written in any case: where about half of the entries are wanted, a branch
/// would be guessed wrong often.
#[inline(always)]
pub(crate) fn offer<T: Copy>(list: &mut Vec<T>, entry: T, is_wanted: bool) {
    let len = list.len() + usize::from(is_wanted);
    list.push(entry);
    list.truncate(len);
}

/// The entries that fit, in a buffer that keeps its memory. It writes all and counts those that fit: where about half
/// of them do, a branch would be guessed wrong often.
pub(crate) fn choose<'a>(
    list: &[u32],
    fits: impl Fn(u32) -> bool,
    buffer: &'a mut Vec<u32>,
) -> &'a [u32] {
    if buffer.len() < list.len() {
        buffer.resize(list.len(), 0);
    }
    let mut count = 0;
    for &entry in list {
        buffer[count] = entry;
        count += usize::from(fits(entry));
    }
    &buffer[..count]
}

/// Sorts a short list.
pub(crate) fn insertion_sort<T: Copy>(list: &mut [T], precedes: impl Fn(&T, &T) -> bool) {
    for i in 1..list.len() {
        let (entry, mut place) = (list[i], i);
        while place > 0 && precedes(&entry, &list[place - 1]) {
            list[place] = list[place - 1];
            place -= 1;
        }
        list[place] = entry;
    }
}

impl Lists {
    /// Lists of the points on whose lists each point is, ascending.
    pub fn mirrored(&self) -> Self {
        let mut starts = vec![0; self.starts.len()];
        for &q in &self.items {
            starts[q as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let (mut next, mut items) = (starts.clone(), vec![0; self.items.len()]);
        for p in 0..self.len() {
            for &q in self.of(p) {
                items[next[q as usize] as usize] = p as u32;
                next[q as usize] += 1;
            }
        }
        Self { starts, items }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_more_entries_than_32_bits_number_are_refused() {
        // Entries without a size take no memory, however many there are.
        let lists = |each: usize| {
            Lists::make(3 * CHUNK, |_, list: &mut Chunk<()>| {
                list.items.resize(list.items.len() + each, ());
            })
        };
        let most = u32::MAX as usize / (3 * CHUNK);
        let all = lists(most).expect("they are numbered");
        assert_eq!(all.items.len(), 3 * CHUNK * most);
        assert_eq!(all.range(3 * CHUNK - 1).end, all.items.len());
        assert_eq!(lists(most + 1), Err(TooLong));
    }
}
