//! What the selection among all candidates promises, tried on all pairs of one level.

use crate::clouds::{levels, random, with_uneven_radii};
use surfine_features::Records;
use surfine_points::shapes::Shape;
use surfine_points::{PointSet, RefineParams};
use surfine_reference::candidates::Candidates;
use surfine_reference::insertion::FREE;
use surfine_reference::{Level, LevelState, NO_POINT, run_level};

fn clouds() -> [PointSet; 3] {
    let sphere = random(Shape::Sphere, 300, 3);
    [random(Shape::Torus, 600, 5), with_uneven_radii(sphere.clone(), 2), sphere]
}

fn first_level(points: &PointSet, params: &RefineParams) -> LevelState {
    let level = Level::new(&Records::split(points).expect("the points are fit"));
    run_level(&level, params, Default::default(), &mut |_| ()).0
}

/// Whether a candidate lies in the discard sphere (eq. 11) of another one, on the same side of the surface.
fn discards(c: &Candidates, h: usize, x: usize, params: &RefineParams) -> bool {
    let distance = (c.positions[h] - c.positions[x]).length();
    h != x && distance < params.lambda2 * c.sizes[h] && c.normals[h].dot(c.normals[x]) > 0.0
}

#[test]
fn candidates_are_inserted_or_in_the_sphere_of_a_larger_one_that_is() {
    let params = levels(1);
    let (mut free, mut inserted) = (0, 0);
    for state in clouds().map(|points| first_level(&points, &params)) {
        let (c, states) = (&state.candidates, &state.insertion.states);
        for x in (0..c.len()).filter(|&x| c.exists(x)) {
            let is_discarded = (0..c.len()).any(|h| {
                states[h] != FREE && c.sizes[h] > c.sizes[x] && discards(c, h, x, &params)
            });
            assert_eq!(states[x] == FREE, is_discarded, "candidate {x}");
            (free, inserted) =
                (free + usize::from(is_discarded), inserted + usize::from(!is_discarded));
        }
    }
    assert!(free > 100 && inserted > 1000, "{free} discarded, {inserted} inserted");
}

#[test]
fn new_neighborhoods_hold_the_closest_of_those_that_discard() {
    let params = levels(1);
    for state in clouds().map(|points| first_level(&points, &params)) {
        let (c, states) = (&state.candidates, &state.insertion.states);
        let stand_in = |&x: &u32| {
            let x = x as usize;
            let place = |h: &usize| (c.positions[*h] - c.positions[x]).length_squared();
            let discarding = (0..c.len()).filter(|&h| {
                states[h] != FREE && c.sizes[h] > c.sizes[x] && discards(c, h, x, &params)
            });
            let closest = || discarding.min_by(|a, b| place(a).total_cmp(&place(b)));
            if states[x] == FREE { closest() } else { Some(x) }
        };
        for p in 0..state.rings.lists.len() {
            let slots = c.of_slot[state.rings.slots(p)].iter().filter(|&&x| x != NO_POINT);
            let mut expected: Vec<u32> = slots.filter_map(stand_in).map(|h| h as u32).collect();
            let mut found = state.conflicts.around.of(p).to_vec();
            expected.sort_unstable();
            found.sort_unstable();
            expected.dedup();
            assert_eq!(expected, found, "N' of {p}");
        }
    }
}

#[test]
fn simplified_discards_contested_candidates_alone() {
    let params = RefineParams { simplified: true, ..levels(1) };
    let mut contested = 0;
    for state in clouds().map(|points| first_level(&points, &params)) {
        let (c, states) = (&state.candidates, &state.insertion.states);
        let fan = |p: u32| &c.of_slot[state.rings.slots(p as usize)];
        let is_contested = |x: usize| !c.corners[x].iter().all(|&p| fan(p).contains(&(x as u32)));
        for x in (0..c.len()).filter(|&x| c.exists(x)) {
            let around = c.corners[x].iter().flat_map(|&p| fan(p)).filter(|&&h| h != NO_POINT);
            let is_discarded = around.map(|&h| h as usize).any(|h| {
                let is_before = c.sizes[h] > c.sizes[x] || !is_contested(h);
                states[h] != FREE && is_before && discards(c, h, x, &params)
            });
            assert_eq!(states[x] == FREE, is_contested(x) && is_discarded, "candidate {x}");
            contested += usize::from(is_contested(x));
        }
    }
    assert!(contested > 500, "{contested}");
}
