//! The same input gives the same evaluation, whatever the machine does meanwhile; and what people see of it.

use surfine_evaluate::{Evaluation, Options, evaluate};
use surfine_points::Model;
use surfine_points::shapes::{Sampling, Shape};

use crate::scenes;

/// Normals, colours, creases' doubled points and an input: every section.
fn everything(options: &Options) -> Evaluation {
    let mut mesh = scenes::torus(60, 30);
    scenes::paint(&mut mesh, |p| [(90.0 * (p.x + 1.4)) as u8, 9, 200]);
    let mut output = scenes::points(Shape::Torus, Sampling::BlueNoise, 1500, 4);
    output.positions[3] = output.positions[2];
    scenes::paint(&mut output, |_| [90, 10, 190]);
    let input = Model { radii: None, ..output.clone() };
    evaluate(&output, &scenes::truth(&mesh), Some(&input), options, &mut |_| ()).expect("fit")
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let options = Options { samples: 20_000, seed: 3 };
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        // The shortest text that reads back as the same number: equal texts are equal bytes.
        format!("{:?}", pool.expect("threads start").install(|| everything(&options)))
    };
    let one = with_threads(1);
    assert!([2, 3, 7].into_iter().all(|threads| with_threads(threads) == one));
}

#[test]
fn another_seed_takes_other_samples_and_finds_much_the_same() {
    let with_seed = |seed| everything(&Options { samples: 20_000, seed });
    let (a, b) = (with_seed(1), with_seed(2));
    assert_ne!(a.coverage.max, b.coverage.max);
    assert!((a.coverage.p999 / b.coverage.p999 - 1.0).abs() < 0.1);
    assert!((a.chamfer.plain.chamfer / b.chamfer.plain.chamfer - 1.0).abs() < 0.1);
    assert_eq!((a.distance, a.colors), (b.distance, b.colors));
}

#[test]
fn only_units_change_with_the_size() {
    // A power of two changes no digit.
    let scale = |mut model: Model| {
        model.positions.iter_mut().for_each(|p| *p *= 1024.0);
        model
    };
    let (mesh, output) =
        (scenes::torus(60, 30), scenes::points(Shape::Torus, Sampling::BlueNoise, 800, 4));
    let small = scenes::measure(&output, &scenes::truth(&mesh));
    let large = scenes::measure(&scale(output), &scenes::truth(&scale(mesh)));
    assert_eq!(large.distance.in_spacings, small.distance.in_spacings);
    assert_eq!(large.distance.in_diagonals, small.distance.in_diagonals);
    assert_eq!(large.distance.absolute.max, 1024.0 * small.distance.absolute.max);
    assert_eq!(large.coverage.max, small.coverage.max);
    assert_eq!(large.coverage.max_distance, 1024.0 * small.coverage.max_distance);
    assert_eq!((large.normals, large.smoothness), (small.normals, small.smoothness));
    assert_eq!(large.uniformity.nn_cv, small.uniformity.nn_cv);
    assert_eq!(large.chamfer.pu, small.chamfer.pu);
    assert_eq!(large.chamfer.plain.hausdorff, 1024.0 * small.chamfer.plain.hausdorff);
}

#[test]
fn samples_are_as_many_as_wanted() {
    let samples = |samples| everything(&Options { samples, seed: 0 }).coverage.samples;
    assert_eq!((samples(0), samples(77)), (100_000, 77));
}

#[test]
fn every_measure_is_named_as_it_begins() {
    let mut names = Vec::new();
    let output = scenes::points(Shape::Sphere, Sampling::Random, 50, 1);
    let truth = scenes::truth(&output);
    let options = Options::default();
    evaluate(&output, &truth, None, &options, &mut |name| names.push(name)).expect("fit");
    assert_eq!(names[..3], ["spacing", "distance", "coverage"]);
    assert_eq!(names.len(), 9);
}

#[test]
fn the_report_has_a_line_for_what_was_measured_and_none_for_the_rest() {
    let report = everything(&Options { samples: 1000, seed: 0 }).report();
    let line = |name: &str| report.lines().find(|l| l.starts_with(name)).unwrap_or("").to_string();
    assert!(
        line("output").contains("1500") && line("output").contains("1499 different"),
        "{report}"
    );
    assert!(line("truth ").contains("3600, diagonal"), "{report}");
    assert!(line("distance to the mesh").contains("file units"), "{report}");
    assert!(line("normal error").contains("degrees"), "{report}");
    assert!(line("color error").contains("of 255"), "{report}");
    assert!(line("input kept").contains("1500 of 1500"), "{report}");
    let plain = scenes::cloud(scenes::torus(9, 9).positions);
    let report = scenes::measure(&plain, &scenes::truth(&plain)).to_string();
    assert!(report.contains("distance to points"), "{report}");
    for absent in ["normal", "colour", "uniformity", "input"] {
        assert!(!report.contains(absent), "{absent} in\n{report}");
    }
}
