//! What may happen around each point: the candidates that it may meet, and the conflict graph `T` of the points that must not
//! be refined at the same time. Twins: `shaders/conflicts*.wgsl`.
//!
//! The insertion around a point (section 5) depends on those before it. Two points commute unless
//! a candidate of one lies within `λ1 r` of the other, so that it would enter its N', or
//! candidates x and y of the two have `|x - y| < λ2 max(ρ_x, ρ_y)`, so that one would discard the other.
//!
//! Both happen only within `max(λ1 r, |x - p| + λ2 ρ_x)` of a point p with candidates x: the corners of all candidates there
//! count as being in conflict with p. That is more than needed (docs/algorithm.md says how much), and needs no look at pairs of candidates.

use crate::candidates::Candidates;
use crate::insertion::COVER;
use crate::lists::Lists;
use crate::neighborhood::Rings;
use crate::visible::{View, same_side};
use crate::{Level, NO_POINT};
use surfine_points::{Found, Grid, RefineParams};

/// Widens what lists must hold, so that rounding can't lose an entry.
const SLACK: f32 = 1.0 + 1e-5;

/// What may happen around each point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Conflicts {
    /// The candidates that a point sees within the largest radius that it may get.
    pub around: Lists,
    /// The neighbours of a point in `T`: symmetric, without loops.
    pub graph: Lists,
}

/// Finds the candidates around each point and computes `T`.
pub fn conflicts(
    level: &Level,
    rings: &Rings,
    candidates: &Candidates,
    candidate_grid: &Grid,
    params: &RefineParams,
) -> Conflicts {
    let (around, known) = Lists::pair(
        level.len(),
        || Scratch { found: Vec::new(), met_by: vec![NO_POINT; level.len()] },
        |Scratch { found, met_by }, p, around, known| {
            let reach = Reach::of(level, rings, candidates, params, p);
            let Reach { largest, conflicts, .. } = reach;
            let center = level.seen(p);
            let view = View::new(level, p, largest, params.rules);
            met_by[p] = p as u32;
            for near in candidate_grid.find(center.position, largest.max(conflicts), found) {
                let c = near.item as usize;
                // Points on curves are there before all others: nobody has them.
                if near.squared <= conflicts * conflicts && c < candidates.first_on_curve {
                    for q in candidates.corners[c] {
                        if std::mem::replace(&mut met_by[q as usize], p as u32) != p as u32 {
                            known.push(q);
                        }
                    }
                }
                let within = reach.of_candidate(params.lambda2 * candidates.rho[c]);
                if near.squared <= within * within
                    && same_side(params.rules, candidates.normals[c], center.normal)
                    && view.as_ref().is_none_or(|view| view.sees(candidates.seen(c, level)))
                {
                    around.push(near.item);
                }
            }
        },
    );
    Conflicts { around, graph: symmetric(&known) }
}

/// What a thread uses again for the next point.
struct Scratch {
    found: Vec<Found>,
    /// The last point that met each point.
    met_by: Vec<u32>,
}

/// How far what bears on a point may be.
struct Reach {
    /// The largest radius that it may have at the next level: that of now, or as far as its own candidates are.
    largest: f32,
    /// Within this distance are the candidates of all points that it is in conflict with, as far as it can see.
    conflicts: f32,
    /// Within this distance new points are new neighbours.
    near: f32,
    /// The farthest own candidate, if there is any.
    own: Option<f32>,
}

impl Reach {
    /// Within which distance a candidate with that discard sphere is of interest: others can neither enter N' nor discard what
    /// might.
    fn of_candidate(&self, sphere: f32) -> f32 {
        self.own.map_or(self.largest, |own| {
            self.largest.min(COVER * SLACK * self.near.max(own + sphere))
        })
    }

    fn of(
        level: &Level,
        rings: &Rings,
        candidates: &Candidates,
        params: &RefineParams,
        p: usize,
    ) -> Self {
        let near = candidates.near[p];
        let (mut own, mut conflicts) = (None, near);
        for x in candidates.own(rings, p) {
            let d = candidates.positions[x] - level.positions[p];
            let distance = d.dot(d).sqrt();
            own = Some(distance.max(own.unwrap_or(0.0)));
            conflicts = conflicts.max(distance + params.lambda2 * candidates.rho[x]);
        }
        let farthest = level.radii[p].max(own.unwrap_or(0.0));
        Self { largest: COVER * SLACK * farthest, conflicts: SLACK * conflicts, near, own }
    }
}

/// Both ends of a conflict see it only where their reaches are alike: adds the other side.
fn symmetric(found: &Lists) -> Lists {
    let points = found.len();
    let one_sided = Lists::make(
        points,
        || (),
        |(), p, one_sided| {
            let sees_p = |q: u32| found.of(q as usize).contains(&(p as u32));
            one_sided.extend(found.of(p).iter().copied().filter(|&q| !sees_p(q)));
        },
    );
    let mirrored = one_sided.mirrored();
    Lists::make(
        points,
        || (),
        |(), p, all| {
            all.extend(found.of(p));
            all.extend(mirrored.of(p));
        },
    )
}
