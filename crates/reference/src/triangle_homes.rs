//! To which slot each triangle belongs, that it is one candidate though three fans have it, and the
//! numbers of the triangles.
//! Twins: `shaders/candidates_home.wgsl`, `candidates_number.wgsl` and `candidates_link.wgsl`.

use crate::fan_triangle::fan_triangle;
use crate::neighborhood::{RingEntry, Rings};
use crate::{Level, NO_POINT};
use rayon::prelude::*;
use std::ops::Range;

/// The triangle of each slot, [`NO_POINT`] for slots without one, and the corners of all triangles: they are numbered
/// by the slots to which they belong.
pub(crate) fn number(level: &Level, rings: &Rings) -> (Vec<u32>, Vec<[u32; 3]>) {
    let (mut homes, mut numbers) = (vec![0; rings.len()], vec![0; rings.len()]);
    let mut parts = Part::all(rings, &mut homes, &mut numbers);
    parts.par_iter_mut().for_each(|part| part.find(level, rings));
    let mut corners = vec![[0; 3]; parts.iter().map(|part| part.corners.len()).sum()];
    let (mut rest, mut first) = (corners.as_mut_slice(), 0);
    for part in &mut parts {
        let (own, after) = rest.split_at_mut(part.corners.len());
        (part.first, part.all_corners, rest) = (first, own, after);
        first += part.all_corners.len() as u32;
    }
    parts.into_par_iter().for_each(Part::join);
    let number = |home: &mut u32| *home = numbers.get(*home as usize).copied().unwrap_or(NO_POINT);
    homes.par_iter_mut().with_min_len(1024).for_each(number);
    (homes, corners)
}

/// Points whose triangles one thread finds before it takes the next ones.
const CHUNK: usize = 1024;

/// The triangles of some points.
struct Part<'a> {
    points: Range<usize>,
    /// For each of their slots that to which its triangle belongs; [`NO_POINT`] for slots without a triangle.
    homes: &'a mut [u32],
    /// How many triangles belong to slots before each one.
    numbers: &'a mut [u32],
    /// The corners of the triangles that belong to these slots.
    corners: Vec<[u32; 3]>,
    /// How many belong to the points before these.
    first: u32,
    /// Where the corners go among those of all triangles.
    all_corners: &'a mut [[u32; 3]],
}

impl<'a> Part<'a> {
    /// Parts for all points.
    fn all(rings: &Rings, mut homes: &'a mut [u32], mut numbers: &'a mut [u32]) -> Vec<Self> {
        let points = rings.lists.len();
        let part = |first: usize| {
            let points = first..(first + CHUNK).min(points);
            let starts = &rings.lists.starts;
            let slots = (starts[points.end] - starts[points.start]) as usize;
            let homes = homes.split_off_mut(..slots).expect("a place for each slot");
            let numbers = numbers.split_off_mut(..slots).expect("a place for each slot");
            Part { points, homes, numbers, corners: Vec::new(), first: 0, all_corners: &mut [] }
        };
        (0..points).step_by(CHUNK).map(part).collect()
    }

    /// Finds the homes, and numbers the triangles that belong to these points from 0.
    fn find(&mut self, level: &Level, rings: &Rings) {
        let base = rings.slots(self.points.start).start;
        let (mut fan, mut elsewhere) = (Vec::new(), Vec::new());
        // A little more than two triangles belong to a point in the mean.
        self.corners.reserve(CHUNK * 9 / 4);
        for p in self.points.clone() {
            let slots = rings.slots(p);
            let own = slots.start - base..slots.end - base;
            let homes = &mut self.homes[own.clone()];
            let room = slots.len().max(fan.len());
            fan.resize(room, [0; 3]);
            elsewhere.resize(room, 0);
            let elsewhere = find_fan(level, rings, p, homes, &mut fan, &mut elsewhere);
            for &i in elsewhere {
                homes[i] = home(level, rings, fan[i], p).unwrap_or(homes[i]);
            }
            // All are written and those at home counted: a branch would be guessed wrong often.
            let mut count = self.corners.len();
            self.corners.resize(count + slots.len(), [0; 3]);
            for (i, number) in self.numbers[own].iter_mut().enumerate() {
                *number = count as u32;
                self.corners[count] = fan[i];
                count += usize::from(homes[i] == (slots.start + i) as u32);
            }
            self.corners.truncate(count);
        }
    }

    /// Numbers the triangles among those of all points.
    fn join(self) {
        self.numbers.iter_mut().for_each(|number| *number += self.first);
        self.all_corners.copy_from_slice(&self.corners);
    }
}

/// Finds the triangles of a fan. They belong to their own slots but for those that it returns: their
/// first corner is another one.
#[inline]
fn find_fan<'a>(
    level: &Level,
    rings: &Rings,
    p: usize,
    homes: &mut [u32],
    fan: &mut [[u32; 3]],
    elsewhere: &'a mut [usize],
) -> &'a [usize] {
    let first = rings.slots(p).start;
    let mut count = 0;
    for (i, (home, corners)) in homes.iter_mut().zip(fan).enumerate() {
        let triangle = fan_triangle(level, rings, p, i);
        *home = if triangle.is_some() { (first + i) as u32 } else { NO_POINT };
        *corners = triangle.unwrap_or([p as u32; 3]);
        elsewhere[count] = i;
        count += usize::from(corners[0] != p as u32);
    }
    &elsewhere[..count]
}

/// The slot of a triangle in the fan of the first of its corners that has it, if that comes
/// before `p`, whose fan has it.
#[inline]
fn home(level: &Level, rings: &Rings, [a, b, c]: [u32; 3], p: usize) -> Option<u32> {
    let of_first = || slot_between(level, rings, a, b, c);
    let of_second = || if p as u32 == b { None } else { slot_between(level, rings, b, c, a) };
    of_first().or_else(of_second)
}

/// The slot of a point's triangle between two neighbours.
#[inline]
fn slot_between(level: &Level, rings: &Rings, p: u32, from: u32, to: u32) -> Option<u32> {
    let (p, slots) = (p as usize, rings.slots(p as usize));
    let ring = rings.ring(p);
    let i = place_of(rings, slots.clone(), from)?;
    let follows = ring[if i + 1 == ring.len() { 0 } else { i + 1 }].id == to;
    let is_triangle = follows && fan_triangle(level, rings, p, i).is_some();
    is_triangle.then_some((slots.start + i) as u32)
}

/// Entries of a ring that are compared in any case, and in which most rings fit.
const WINDOW: usize = 8;

/// The place of a point in a ring. As many entries are compared for each ring, with those that follow it if it has
/// fewer: where a search ends would be guessed wrong often.
#[inline]
fn place_of(rings: &Rings, slots: Range<usize>, id: u32) -> Option<usize> {
    let entries = &rings.lists.items[slots.start..];
    match entries.first_chunk::<WINDOW>() {
        Some(window) if slots.len() <= WINDOW => {
            let bit = |(i, entry): (usize, &RingEntry)| u32::from(entry.id == id) << i;
            let bits = window.iter().enumerate().map(bit).fold(0, |bits, bit| bits | bit);
            let place = bits.trailing_zeros() as usize;
            (place < slots.len()).then_some(place)
        }
        _ => entries[..slots.len()].iter().position(|entry| entry.id == id),
    }
}
