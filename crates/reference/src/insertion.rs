//! The insertion of new points (section 5), class by class. Twin: `shaders/insertion.wgsl`.
//!
//! Radii of the discard test are frozen at insertion and all other radii are maxima, so the points of one class give
//! the same result together, in ascending or in descending order: that of the paper's loop in the order
//! (class, index).

use crate::Level;
use crate::angles::{Angles, Directions};
use crate::candidates::Candidates;
use crate::coloring::Classes;
use crate::conflicts::Conflicts;
use crate::neighborhood::Rings;
use crate::new_ring::{NewRing, Sample};
use crate::pool::Pool;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use surfine_points::RefineParams;

/// Radii exceed the distances they must cover by this factor, so that rounding can't lose the farthest ring.
pub const COVER: f32 = 1.02;
/// A gap or an angle must be wider by this factor to be preferred to an earlier one: regular grids tie.
pub const HYSTERESIS: f32 = 1.0 + 1e-5;
/// A candidate nearer than 1e-3 radians to an end of its gap, here its cosine, does not split it.
pub const SMALLEST_SPLIT: f32 = 0.999_999_5;
/// A cosine must be less by this to be preferred to an earlier one.
pub const LESS: f32 = 1e-5;

/// The order in which the points of one class are refined. All give the same result; tests hold that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// All at once, on all cores.
    #[default]
    Together,
    /// One after the other by index, each seeing those before it.
    Ascending,
    /// The same from the last index to the first.
    Descending,
}

/// What the insertion decided.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Insertion {
    /// One more than the class that inserted each candidate; 0 for the new points on curves, which come before the
    /// first class, and [`FREE`] for what was not inserted. A selection among all candidates has one class.
    pub states: Vec<u32>,
    /// Radius of each inserted candidate as a point of the next level.
    pub candidate_radii: Vec<f32>,
    /// Radius of each old point at the next level.
    pub radii: Vec<f32>,
}

/// State of a candidate that is not inserted.
pub const FREE: u32 = u32::MAX;

impl Insertion {
    /// Whether a candidate was inserted.
    pub fn is_inserted(&self, c: usize) -> bool {
        self.states[c] != FREE
    }
}

/// Everything that the insertion reads.
#[derive(Clone, Copy)]
pub struct Stage<'a> {
    /// The points of this level.
    pub level: &'a Level,
    /// Their rings.
    pub rings: &'a Rings,
    /// The candidates of their fans.
    pub candidates: &'a Candidates,
    /// What is around each point.
    pub conflicts: &'a Conflicts,
    /// The parameters.
    pub params: &'a RefineParams,
}

/// What the points of a class write. Nobody else of the class reads it, and maxima have no order:
/// so the threads need none.
pub(crate) struct Shared {
    samples: Vec<Sample>,
    pub(crate) states: Vec<AtomicU32>,
    /// Bits of the radii, which are ordered like their values.
    pub(crate) candidate_radii: Vec<AtomicU32>,
    pub(crate) radii: Vec<AtomicU32>,
}

/// Raises a radius to another, given by their bits. Most are large enough: to look costs less than to write.
pub(crate) fn raise(radius: &AtomicU32, other: f32) {
    if radius.load(Relaxed) < other.to_bits() {
        radius.fetch_max(other.to_bits(), Relaxed);
    }
}

/// Points of a class that a thread refines together.
const BATCH: usize = 64;

/// Refines all points, class by class.
pub fn insertion(stage: Stage<'_>, classes: &Classes, order: Order) -> Insertion {
    let on_curve = stage.candidates.first_on_curve;
    let free = (0..on_curve).map(|_| (FREE, 0.0));
    let curve_points = stage.level.curve_points.iter().map(|point| (0, point.radius));
    let candidates = free.chain(curve_points);
    let shared = Shared {
        samples: Sample::all(stage.candidates, stage.params.lambda2),
        states: candidates.clone().map(|(state, _)| AtomicU32::new(state)).collect(),
        candidate_radii: candidates.map(|(_, radius)| AtomicU32::new(radius.to_bits())).collect(),
        radii: (0..stage.level.len()).map(|_| AtomicU32::new(0)).collect(),
    };
    // A batch has many small vectors, and each class is shared out anew.
    let batches = Pool::<Batch>::default();
    for (class, members) in (1..).zip(&classes.members) {
        // One after the other, the points of a class see what those before them inserted.
        let limit = if order == Order::Together { class } else { class + 1 };
        let refine = |batch: &mut Batch, points: &[u32]| {
            batch.refine(stage, points, &shared, class, limit);
        };
        match order {
            Order::Together => {
                let batch = || batches.lend();
                members.par_chunks(BATCH).for_each_init(batch, |batch, p| refine(batch, p));
            }
            Order::Ascending => {
                members.chunks(1).for_each(|p| refine(&mut Batch::default(), p));
            }
            Order::Descending => {
                members.rchunks(1).for_each(|p| refine(&mut Batch::default(), p));
            }
        }
    }
    let floats = |bits: Vec<AtomicU32>| {
        bits.into_iter().map(|bits| f32::from_bits(bits.into_inner())).collect()
    };
    Insertion {
        states: shared.states.into_iter().map(AtomicU32::into_inner).collect(),
        candidate_radii: floats(shared.candidate_radii),
        radii: floats(shared.radii),
    }
}

/// Points that are refined together, each a step at a time, so that the angles of all are found at once.
#[derive(Default)]
struct Batch {
    /// What a thread uses again for the next points: as many as there were at most.
    new_rings: Vec<NewRing>,
    directions: Directions,
    gaps: Angles,
}

impl Batch {
    /// Completes the new neighbourhoods N' of the points (section 5) and notes what was inserted.
    fn refine(
        &mut self,
        stage: Stage<'_>,
        points: &[u32],
        shared: &Shared,
        class: u32,
        limit: u32,
    ) {
        self.new_rings.resize_with(points.len().max(self.new_rings.len()), NewRing::default);
        let new_rings = &mut self.new_rings[..points.len()];
        self.directions.clear();
        for (ring, &p) in new_rings.iter_mut().zip(points) {
            ring.gather(
                stage,
                p as usize,
                &shared.samples,
                &shared.states,
                limit,
                &mut self.directions,
            );
        }
        self.directions.find();
        self.gaps.clear();
        let mut angles = &*self.directions.angles;
        new_rings.iter_mut().for_each(|ring| ring.start(&mut angles, &mut self.gaps));
        let mut goes_on = true;
        while goes_on {
            self.gaps.find_gaps(stage.params.effective_plain_angle());
            new_rings.iter_mut().for_each(|ring| ring.take_gaps(&self.gaps));
            self.gaps.clear();
            goes_on = false;
            for ring in new_rings.iter_mut().filter(|ring| !ring.is_complete) {
                goes_on = true;
                if let Some(inserted) = ring.step(stage, &mut self.gaps) {
                    shared.states[inserted as usize].store(class, Relaxed);
                }
            }
        }
        new_rings.iter_mut().for_each(|ring| ring.store_radii(stage, shared));
    }
}
