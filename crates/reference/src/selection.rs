//! The selection of new points among all candidates, the largest first (ours). Twins: `shaders/selection*.wgsl`.
//!
//! Section 5 selects new points around one point after the other, gap by gap, and what comes out depends on the order
//! of the points. Here the candidates have an order of their own: the larger one comes first. Each is inserted unless
//! it lies in the discard sphere (eq. 11) of one that was inserted before it; that one then stands for it in the fans,
//! as in step 3 of section 5. Candidates overlap rarely, so almost all of them are decided at once.
//!
//! The size of a candidate ([`Candidates::sizes`]) takes the place of `ρ` in eq. 11. N' of a point is what stands for
//! the candidates of its fan.

use crate::candidates::Candidates;
use crate::coloring::scramble;
use crate::insertion::{COVER, FREE, Insertion, raise};
use crate::lists::{Chunk, Lists, TooLong};
use crate::nearby::{Marks, Nearby};
use crate::neighborhood::Rings;
use crate::visible::{View, same_side};
use crate::{Level, NO_POINT};
use glam::Vec3;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use surfine_points::{Grid, RefineParams};

/// State of all inserted candidates but those on curves: there are no classes.
const INSERTED: u32 = 1;

/// For each candidate those whose discard sphere holds it, of those before it.
///
/// # Errors
/// Too long lists.
pub fn overlaps(
    level: &Level,
    candidates: &Candidates,
    grid: &Grid,
    params: &RefineParams,
) -> Result<Lists, TooLong> {
    let sphere = |c: usize| params.lambda2 * candidates.sizes[c];
    let scratch = <(Nearby, Marks)>::default;
    let [discarded] =
        Lists::in_chunks(candidates.len(), scratch, |(nearby, marks), own, [lists]| {
            for h in own.clone() {
                if candidates.exists(h) {
                    nearby.look(grid, h..own.end, |c| (candidates.positions[c], sphere(c)));
                    list_discarded(level, candidates, params, h, nearby, marks, lists);
                }
                lists.end();
            }
        })?;
    Ok(discarded.mirrored())
}

/// Lists the candidates near by that `h` discards.
fn list_discarded(
    level: &Level,
    candidates: &Candidates,
    params: &RefineParams,
    h: usize,
    nearby: &Nearby,
    marks: &mut Marks,
    list: &mut Chunk<u32>,
) {
    let (position, radius) = (candidates.positions[h], params.lambda2 * candidates.sizes[h]);
    // Most find themselves alone: to count costs less than to list.
    if nearby.count_in_ball(position, radius) <= 1 {
        return;
    }
    let view = View::new(level, candidates.seen(h, level), radius, params.rules);
    for &i in nearby.in_ball(position, radius, marks) {
        let x = nearby.items[i as usize];
        list.offer(x, discards(level, candidates, params, view.as_ref(), h, x as usize));
    }
}

/// Whether a candidate discards another one: is decided before it, and has it in its discard sphere and on its sheet.
#[inline(always)]
fn discards(
    level: &Level,
    candidates: &Candidates,
    params: &RefineParams,
    view: Option<&View<'_>>,
    h: usize,
    x: usize,
) -> bool {
    precedes(candidates, h, x)
        && holds(candidates, params, h, x)
        && view.is_none_or(|view| view.sees(candidates.seen(x, level)))
}

/// Whether a candidate lies in the discard sphere (eq. 11) of `h` and on the same side of the surface.
#[inline(always)]
pub(crate) fn holds(candidates: &Candidates, params: &RefineParams, h: usize, x: usize) -> bool {
    let offset = candidates.positions[x] - candidates.positions[h];
    let sphere = params.lambda2 * candidates.sizes[h];
    offset.dot(offset) < sphere * sphere
        && same_side(params.rules, candidates.normals[h], candidates.normals[x])
}

/// Whether a candidate is decided before another one. Points on curves are inserted before all
/// others, whatever their place.
pub(crate) fn precedes(candidates: &Candidates, a: usize, b: usize) -> bool {
    let on_curve = |c: usize| c >= candidates.first_on_curve;
    !on_curve(b) && (on_curve(a) || rank(candidates, a) > rank(candidates, b))
}

/// The rank of a candidate of a triangle: its size (positive floats are ordered as their bits
/// are), ties by hashed index.
fn rank(candidates: &Candidates, c: usize) -> (u32, u32) {
    (candidates.sizes[c].to_bits(), scramble(c as u32))
}

/// Selects the new points, and gives all points their radii. Returns the new neighbourhoods too, each with its members
/// once; they are empty where [`crate::next_ring`] does not ask for them.
///
/// # Errors
/// Too long lists.
pub fn selection(
    level: &Level,
    rings: &Rings,
    candidates: &Candidates,
    overlaps: &Lists,
    params: &RefineParams,
) -> Result<(Insertion, Lists), TooLong> {
    let states = select(candidates, overlaps);
    let stands_for: Vec<u32> = (0..candidates.len())
        .into_par_iter()
        .map(|c| stand_in(candidates, overlaps.of(c), &states, c))
        .collect();
    let stand_in = |c: u32| if c == NO_POINT { c } else { stands_for[c as usize] };
    let zeros = |len| (0..len).into_par_iter().map(|_| AtomicU32::new(0)).collect();
    let (own, squares): (Vec<_>, Vec<_>) = (zeros(level.len()), zeros(candidates.len()));
    let is_asked = params.effective_next_ring();
    let [members] = Lists::in_chunks(level.len(), Vec::new, |fan, points, [lists]| {
        for p in points {
            let slots = &candidates.of_slot[rings.slots(p)];
            fan.clear();
            fan.extend(slots.iter().map(|&c| Member::new(candidates, stand_in(c))));
            own[p].store(cover_fan(level.positions[p], fan, &squares).to_bits(), Relaxed);
            for (i, member) in fan.iter().enumerate().filter(|_| is_asked) {
                let is_new = member.id != NO_POINT && !is_repeated(slots, i, member.id, stand_in);
                lists.offer(member.id, is_new);
            }
            lists.end();
        }
    })?;
    let cover = |square: AtomicU32| COVER * f32::from_bits(square.into_inner()).sqrt();
    let radii = own.into_par_iter().map(cover).zip(&level.radii);
    let radii = radii.map(|(radius, &old)| if radius == 0.0 { old } else { radius }).collect();
    let mut candidate_radii: Vec<f32> = squares.into_par_iter().map(cover).collect();
    let on_curve = &mut candidate_radii[candidates.first_on_curve..];
    for (radius, point) in on_curve.iter_mut().zip(&level.curve_points) {
        *radius = radius.max(point.radius);
    }
    Ok((Insertion { states, candidate_radii, radii }, members))
}

/// Who stands for a candidate of a fan.
struct Member {
    /// [`NO_POINT`] where the slot has no candidate.
    id: u32,
    place: Vec3,
}

impl Member {
    fn new(candidates: &Candidates, id: u32) -> Self {
        let place = candidates.positions.get(id as usize).copied().unwrap_or(Vec3::NAN);
        Self { id, place }
    }

    /// The square of a distance; 0 where there is nobody.
    fn squared(&self, from: Vec3) -> f32 {
        let d = self.place - from;
        d.dot(d).max(0.0)
    }
}

/// Which candidates are inserted.
fn select(candidates: &Candidates, overlaps: &Lists) -> Vec<u32> {
    let mut waiting = Vec::new();
    let mut states = vec![FREE; candidates.len()];
    for (c, state) in states.iter_mut().enumerate().filter(|&(c, _)| candidates.exists(c)) {
        if overlaps.of(c).is_empty() {
            *state = if c < candidates.first_on_curve { INSERTED } else { 0 };
        } else {
            waiting.push(c);
        }
    }
    waiting.par_sort_unstable_by_key(|&c| Reverse(rank(candidates, c)));
    for c in waiting {
        if overlaps.of(c).iter().all(|&h| states[h as usize] == FREE) {
            states[c] = INSERTED;
        }
    }
    states
}

/// Who stands for a candidate in the fans: itself if it was inserted, else the closest of those that
/// discard it; ties go by index.
fn stand_in(candidates: &Candidates, overlaps: &[u32], states: &[u32], c: usize) -> u32 {
    if states[c] != FREE {
        return c as u32;
    }
    let mut closest = (f32::INFINITY, NO_POINT);
    for &h in overlaps.iter().filter(|&&h| states[h as usize] != FREE) {
        let offset = candidates.positions[h as usize] - candidates.positions[c];
        let d2 = offset.dot(offset);
        if (d2, h) < closest {
            closest = (d2, h);
        }
    }
    closest.1
}

/// New radii around a point (section 5, end): the members of N', in the order of the fan, cover the point and their
/// neighbours in N'. Raises the squares of what they cover, and returns that of what covers N', 0 if N' is empty.
fn cover_fan(center: Vec3, fan: &[Member], squares: &[AtomicU32]) -> f32 {
    let Some(last) = fan.last() else { return 0.0 };
    let mut farthest = 0.0f32;
    // Each side is between two members: the one before looks back on it.
    let mut back = last.squared(fan[0].place);
    for (member, after) in fan.iter().zip(fan[1..].iter().chain([&fan[0]])) {
        let (own, ahead) = (member.squared(center), member.squared(after.place));
        farthest = farthest.max(own);
        if member.id != NO_POINT {
            raise(&squares[member.id as usize], own.max(back).max(ahead));
        }
        back = ahead;
    }
    farthest
}

/// Whether a member of slot `i` is in the fan in its own right, or for an earlier slot.
fn is_repeated(slots: &[u32], i: usize, member: u32, stand_in: impl Fn(u32) -> u32) -> bool {
    let repeats =
        |(k, &c): (usize, &u32)| k != i && (k < i || c == member) && stand_in(c) == member;
    slots[i] != member && slots.iter().enumerate().any(repeats)
}
