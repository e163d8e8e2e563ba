//! The order in which the points of a class are refined cannot be seen in the result, not in a single bit.
//!
//! The conflict graph is what makes that true, so it is tried where it is strained: irregular points, ties of lattices,
//! borders, and radii that reach far beyond the natural neighbours.

use rayon::ThreadPoolBuilder;
use surfine_features::Records;
use surfine_points::shapes::{Outlined, Shape, hexagonal_grid, icosphere, square_grid};
use surfine_points::{Neighborhood, PointSet, RefineParams, Refined};
use surfine_reference::coloring::{Classes, coloring};
use surfine_reference::insertion::{Insertion, Order, Stage, insertion};
use surfine_reference::{Level, refine_with, run_level};

use crate::clouds::{
    blue_noise, jittered_grid, levels, paper_loop, random, refine, with_radii_times,
    with_uneven_radii,
};
use crate::curves::{even, uneven};
use crate::measure::assert_same_bytes;

/// The accurate neighbourhood, the fuzzy one, and the simplified variant, at 3 levels with the paper's loop, which
/// alone has an order of points.
fn variants() -> [(&'static str, RefineParams); 3] {
    let fuzzy = RefineParams { neighborhood: Neighborhood::Fuzzy, ..paper_loop(3) };
    let simplified = RefineParams { simplified: true, ..paper_loop(3) };
    [("accurate", paper_loop(3)), ("fuzzy", fuzzy), ("simplified", simplified)]
}

fn refine_in_order(points: &PointSet, params: &RefineParams, order: Order) -> Refined {
    refine_with(points, params, order, &mut |_| ()).expect("the points and parameters are fit")
}

/// Refines in every order with every variant and compares all bytes.
#[track_caller]
fn assert_order_is_invisible(points: &PointSet, cloud: &str) {
    for (variant, params) in variants() {
        let together = refine_in_order(points, &params, Order::Together);
        assert!(together.points.len() > 2 * points.len(), "{cloud}, {variant}: hardly refined");
        for order in [Order::Ascending, Order::Descending] {
            let other = refine_in_order(points, &params, order);
            assert_same_bytes(&together, &other, &format!("{cloud}, {variant}, {order:?}"));
        }
    }
}

#[test]
fn order_is_invisible_on_a_random_torus() {
    assert_order_is_invisible(&random(Shape::Torus, 2000, 1), "random torus");
}

#[test]
fn order_is_invisible_on_random_spheres() {
    for seed in 1..=2 {
        let cloud = random(Shape::Sphere, 500, seed);
        assert_order_is_invisible(&cloud, &format!("random sphere, seed {seed}"));
    }
}

#[test]
fn order_is_invisible_on_blue_noise() {
    assert_order_is_invisible(&blue_noise(Shape::Ellipsoid, 500, 1), "ellipsoid");
}

#[test]
fn order_is_invisible_on_lattices_full_of_ties() {
    assert_order_is_invisible(&square_grid(20), "square grid");
    assert_order_is_invisible(&hexagonal_grid(11), "hexagonal grid");
    assert_order_is_invisible(&icosphere(2), "icosphere");
}

#[test]
fn order_is_invisible_on_a_jittered_grid() {
    assert_order_is_invisible(&jittered_grid(20, 1), "jittered grid");
}

#[test]
fn order_is_invisible_on_saddles_with_a_border() {
    assert_order_is_invisible(&random(Shape::Saddle, 500, 1), "random saddle");
    assert_order_is_invisible(&blue_noise(Shape::Saddle, 500, 1), "saddle");
}

#[test]
fn order_is_invisible_with_generous_radii() {
    for factor in [1.5, 2.0] {
        let cloud = with_radii_times(random(Shape::Torus, 300, 2), factor);
        assert_order_is_invisible(&cloud, &format!("random torus, radii times {factor}"));
        let cloud = with_radii_times(square_grid(13), factor);
        assert_order_is_invisible(&cloud, &format!("square grid, radii times {factor}"));
    }
}

#[test]
fn order_is_invisible_with_uneven_radii() {
    // Neighbours of very different radii see each other from one side only: conflicts must be found from that side.
    let cloud = with_uneven_radii(random(Shape::Torus, 300, 3), 1);
    assert_order_is_invisible(&cloud, "random torus, uneven radii");
    let cloud = with_uneven_radii(blue_noise(Shape::Sphere, 300, 3), 2);
    assert_order_is_invisible(&cloud, "sphere, uneven radii");
    assert_order_is_invisible(&with_uneven_radii(hexagonal_grid(8), 3), "hexagons, uneven radii");
}

#[test]
fn order_is_invisible_where_small_radii_make_the_cells_small() {
    // Cells follow the many small radii, so the balls of the few large ones span many cells.
    let mut cloud = random(Shape::Torus, 600, 6);
    for i in (0..cloud.len()).filter(|i| i % 3 != 0) {
        cloud.radii[i] *= 0.05;
    }
    let cloud = with_radii_times(cloud, 1.5);
    let refined = refine(&cloud, &paper_loop(1));
    assert!(refined.reports[0].isolated > 300, "small radii see nothing");
    for (variant, params) in variants() {
        let ascending = refine_in_order(&cloud, &params, Order::Ascending);
        let descending = refine_in_order(&cloud, &params, Order::Descending);
        assert_same_bytes(&ascending, &descending, variant);
    }
}

#[test]
fn order_is_invisible_with_creases_and_boundaries() {
    for shape in Outlined::ALL {
        assert_order_is_invisible(&even(shape, 300, 1), &format!("even {shape}"));
        assert_order_is_invisible(&uneven(shape, 300, 2), &format!("random {shape}"));
        for factor in [1.5, 2.0] {
            let cloud = with_radii_times(uneven(shape, 200, 3), factor);
            let name = format!("random {shape}, radii times {factor}");
            assert_order_is_invisible(&cloud, &name);
        }
    }
}

#[test]
fn number_of_threads_is_invisible() {
    let clouds = [
        with_uneven_radii(random(Shape::Torus, 300, 4), 4),
        uneven(Outlined::Cube, 300, 4),
        uneven(Outlined::Hole, 300, 4),
    ];
    for cloud in clouds {
        assert_threads_are_invisible(&cloud);
    }
}

#[track_caller]
fn assert_threads_are_invisible(cloud: &PointSet) {
    let simplified = || RefineParams { simplified: true, ..levels(3) };
    let with_threads = |threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads can be started").install(|| {
            [levels(3), paper_loop(3), simplified()].map(|params| refine(cloud, &params))
        })
    };
    let one = with_threads(1);
    for threads in [2, 3] {
        for (one, many) in one.iter().zip(&with_threads(threads)) {
            assert_same_bytes(one, many, &format!("{threads} threads"));
        }
    }
}

/// The insertion of one level under classes of the caller's choice.
fn insert(points: &PointSet, classes: impl Fn(&Classes) -> Classes, order: Order) -> Insertion {
    let level = Level::new(&Records::split(points).expect("the points are fit"));
    let params = paper_loop(1);
    let (state, _) = run_level(&level, &params, order, &mut |_| ());
    assert_eq!(state.classes, coloring(&state.conflicts.before));
    let stage = Stage {
        level: &level,
        rings: &state.rings,
        candidates: &state.candidates,
        conflicts: &state.conflicts,
        params: &params,
    };
    insertion(stage, &classes(&state.classes), order)
}

/// Every point in a class of its own, in the order of the classes that are given.
fn one_by_one(classes: &Classes) -> Classes {
    let members = classes.members.iter().flatten().map(|&p| vec![p]).collect();
    Classes { class: Vec::new(), members }
}

/// Every point in the same class.
fn all_at_once(classes: &Classes) -> Classes {
    let mut all: Vec<u32> = classes.members.concat();
    all.sort_unstable();
    Classes { class: Vec::new(), members: vec![all] }
}

#[test]
fn classes_give_the_sequential_loop_of_the_paper() {
    let cloud = random(Shape::Torus, 1000, 5);
    let by_class = insert(&cloud, Classes::clone, Order::Together);
    let sequential = insert(&cloud, one_by_one, Order::Together);
    // Classes have other numbers.
    let inserted = |insertion: &Insertion| {
        (0..insertion.states.len()).map(|c| insertion.is_inserted(c)).collect::<Vec<_>>()
    };
    assert!(inserted(&by_class) == inserted(&sequential), "a class is not its points one by one");
    assert!(
        by_class.radii == sequential.radii
            && by_class.candidate_radii == sequential.candidate_radii
    );
}

#[test]
fn order_shows_as_soon_as_conflicts_are_ignored() {
    // Or else the tests above would pass with an empty conflict graph.
    let cloud = random(Shape::Torus, 1000, 5);
    let ascending = insert(&cloud, all_at_once, Order::Ascending);
    assert!(ascending != insert(&cloud, all_at_once, Order::Descending));
    assert!(ascending != insert(&cloud, all_at_once, Order::Together));
}
