//! Values that new points inherit.

use surfine_points::shapes::{Shape, square_grid};
use surfine_points::{Attribute, Interpolation, PointSet, Refined, Values, Vec3};

use crate::clouds::{blue_noise, closed, jittered_grid, levels, random, refine};

/// A cloud with one attribute, refined.
fn refined_with(mut points: PointSet, name: &str, values: Values) -> Refined {
    points.attributes = vec![Attribute::new(name, values)];
    refine(&points, &levels(2))
}

fn test_cloud() -> PointSet {
    random(Shape::Torus, 300, 1)
}

/// One number a point without visible order, in the range of i32.
fn hashed(n: usize) -> impl Iterator<Item = i32> {
    (0..n as u32).map(|i| (i ^ (i << 7)).wrapping_mul(0x9e37_79b9).rotate_left(13) as i32)
}

/// The new points and their values with those of their parents.
fn inherited<T: Copy>(refined: &Refined, values: &[T]) -> Vec<(T, [T; 3])> {
    assert_eq!(values.len(), refined.points.len(), "one value a point");
    let new = values[refined.level_sizes[0]..].iter().copied();
    new.zip(refined.parents.iter().map(|p| p.map(|c| values[c as usize]))).collect()
}

/// The integer nearest to a third of the sum. Thirds have no halves, so nothing ties.
fn rounded_mean(corners: [i64; 3]) -> i64 {
    (corners.iter().sum::<i64>() as f64 / 3.0 + 0.5).floor() as i64
}

#[test]
fn colours_are_rounded_means() {
    for name in ["red", "green", "blue", "alpha"] {
        let cloud = test_cloud();
        let values = Values::U8(hashed(cloud.len()).map(|v| v as u8).collect());
        let refined = refined_with(cloud, name, values);
        let Some(Attribute { values: Values::U8(values), .. }) = refined.points.attribute(name)
        else {
            panic!("{name} changed its type");
        };
        let values: Vec<i64> = values.iter().map(|&v| i64::from(v)).collect();
        for (found, corners) in inherited(&refined, &values) {
            assert_eq!(found, rounded_mean(corners), "{name}: mean of {corners:?}");
        }
    }
}

#[test]
fn colours_of_one_value_stay() {
    for value in [0, 1, 127, 254, 255] {
        let cloud = test_cloud();
        let values = Values::U8(vec![value; cloud.len()]);
        let refined = refined_with(cloud, "green", values);
        let expected = Values::U8(vec![value; refined.points.len()]);
        assert_eq!(refined.points.attributes[0].values, expected);
    }
}

#[test]
fn negative_colours_round_up_too() {
    let cloud = test_cloud();
    let values = Values::I16(hashed(cloud.len()).map(|v| v as i16).collect());
    let refined = refined_with(cloud, "red", values);
    let Values::I16(values) = &refined.points.attributes[0].values else {
        panic!("the attribute changed its type");
    };
    let values: Vec<i64> = values.iter().map(|&v| i64::from(v)).collect();
    for (found, corners) in inherited(&refined, &values) {
        assert_eq!(found, rounded_mean(corners), "mean of {corners:?}");
    }
}

#[test]
fn floats_are_means() {
    let cloud = test_cloud();
    let values = hashed(cloud.len()).map(|v| v as f32 / 1e6).collect();
    let refined = refined_with(cloud, "intensity", Values::F32(values));
    let Values::F32(values) = &refined.points.attributes[0].values else {
        panic!("the attribute changed its type");
    };
    for (found, corners) in inherited(&refined, values) {
        let exact = corners.iter().map(|&c| f64::from(c)).sum::<f64>() / 3.0;
        let size = corners.iter().fold(1e-30, |m: f32, c| m.max(c.abs()));
        // Two sums and a quotient: three roundings of 6e-8, relative to the largest of the terms.
        let error = (f64::from(found) - exact).abs() / f64::from(size);
        assert!(error < 3e-7, "{found} is the mean of {corners:?}?");
    }
}

#[test]
fn doubles_keep_their_digits() {
    let cloud = test_cloud();
    // Times as seconds since 1970: f32 would be off by a minute.
    let values = hashed(cloud.len()).map(|v| 1.7e9 + f64::from(v) * 1e-9).collect();
    let refined = refined_with(cloud, "time", Values::F64(values));
    let Values::F64(values) = &refined.points.attributes[0].values else {
        panic!("the attribute changed its type");
    };
    for (found, corners) in inherited(&refined, values) {
        let exact = corners[0] + ((corners[1] - corners[0]) + (corners[2] - corners[0])) / 3.0;
        // Three roundings at 5e9 are 1e-6 each at most.
        assert!((found - exact).abs() < 3e-6, "{found} is the mean of {corners:?}?");
    }
}

#[test]
fn linear_fields_are_kept_on_a_plane() {
    let mut cloud = jittered_grid(12, 1);
    cloud.positions.iter_mut().for_each(|p| p.z = 0.0);
    let field = |points: &PointSet| -> Vec<f64> {
        points.positions.iter().map(|p| 2.0 * f64::from(p.x) - 3.0 * f64::from(p.y)).collect()
    };
    let values = Values::F64(field(&cloud));
    cloud.attributes = vec![Attribute::new("height", values)];
    // On a rim that is curved new points lie off the chord from which they have their values.
    let refined = refine(&cloud, &closed(2));
    let Values::F64(values) = &refined.points.attributes[0].values else {
        panic!("the attribute changed its type");
    };
    for (found, exact) in values.iter().zip(field(&refined.points)) {
        // Positions up to 12 in f32 round by 1e-6 a level, times the slopes.
        assert!((found - exact).abs() < 2e-5, "{found} instead of {exact}");
    }
}

/// Checks that each new point's value is the one that two parents share; returns how many such points there are.
fn check_votes(refined: &Refined, values: &[i64]) -> usize {
    let mut votes = 0;
    for (i, corners) in refined.parents.iter().enumerate() {
        let [a, b, c] = corners.map(|c| values[c as usize]);
        if a == b || b == c || c == a {
            let majority = if a == b || a == c { a } else { b };
            assert_eq!(
                values[refined.level_sizes[0] + i],
                majority,
                "new point {i} of {corners:?}"
            );
            votes += 1;
        }
    }
    votes
}

/// Checks that each new point's value is that of the parent nearest to it.
fn check_nearest(refined: &Refined, values: &[i64]) {
    let positions = &refined.points.positions;
    let old = refined.level_sizes[0];
    for (i, corners) in refined.parents.iter().enumerate() {
        let distance = |c: u32| (positions[c as usize] - positions[old + i]).length();
        let least = corners.iter().map(|&c| distance(c)).fold(f32::MAX, f32::min);
        // Corners at the same distance but for rounding may both be meant.
        let mut nearest = corners.iter().filter(|&&c| distance(c) <= least * (1.0 + 1e-5));
        assert!(
            nearest.any(|&c| values[c as usize] == values[old + i]),
            "new point {i}: {} is not from the nearest of {corners:?}",
            values[old + i]
        );
    }
}

#[test]
fn categories_are_voted_for() {
    for (name, kinds) in [("label", 2), ("classification", 5)] {
        let cloud = test_cloud();
        let labels = Values::I32(hashed(cloud.len()).map(|v| v.rem_euclid(kinds)).collect());
        let refined = refined_with(cloud, name, labels);
        let Values::I32(values) = &refined.points.attributes[0].values else {
            panic!("the attribute changed its type");
        };
        let values: Vec<i64> = values.iter().map(|&v| i64::from(v)).collect();
        let votes = check_votes(&refined, &values);
        // Of two kinds there is always a majority.
        let new = refined.parents.len();
        assert!(
            if kinds == 2 { votes == new } else { votes > 0 && votes < new },
            "{votes} of {new}"
        );
    }
}

#[test]
fn categories_without_a_majority_come_from_the_nearest_corner() {
    // One step: after it new points share the values of old ones.
    let mut cloud = square_grid(12);
    let labels = Values::U16((0..cloud.len()).map(|i| i as u16).collect());
    cloud.attributes = vec![Attribute::new("label", labels)];
    let refined = refine(&cloud, &levels(1));
    let Values::U16(values) = &refined.points.attributes[0].values else {
        panic!("the attribute changed its type");
    };
    check_nearest(&refined, &values.iter().map(|&v| i64::from(v)).collect::<Vec<_>>());
}

#[test]
fn a_rule_can_be_given_to_a_property() {
    let mut cloud = test_cloud();
    let labels = Values::I32(hashed(cloud.len()).map(|v| v.rem_euclid(2)).collect());
    let nearest =
        Attribute { interpolation: Interpolation::Nearest, ..Attribute::new("label", labels) };
    cloud.attributes = vec![nearest];
    let refined = refine(&cloud, &levels(2));
    let Values::I32(values) = &refined.points.attributes[0].values else {
        panic!("the attribute changed its type");
    };
    check_nearest(&refined, &values.iter().map(|&v| i64::from(v)).collect::<Vec<_>>());
}

#[test]
fn directions_keep_unit_length() {
    // The points' own normals as a second set: new ones must lie near the surface's.
    let mut cloud = blue_noise(Shape::Sphere, 400, 1);
    for (axis, name) in ["tx", "ty", "tz"].into_iter().enumerate() {
        let values = Values::F32(cloud.normals.iter().map(|n| n[axis]).collect());
        let attribute = Attribute::new(name, values);
        cloud.attributes.push(Attribute { interpolation: Interpolation::Unit, ..attribute });
    }
    let refined = refine(&cloud, &levels(2)).points;
    let column = |i: usize| match &refined.attributes[i].values {
        Values::F32(values) => values,
        _ => panic!("the attribute changed its type"),
    };
    let (x, y, z) = (column(0), column(1), column(2));
    for (i, position) in refined.positions.iter().enumerate() {
        let direction = Vec3::new(x[i], y[i], z[i]);
        assert!((direction.length() - 1.0).abs() < 1e-6, "point {i}: {direction}");
        // The mean of three corners is off by some share of the spacing squared, .03.
        assert!(direction.dot(position.normalize()) > 0.999, "point {i}: {direction}");
    }
}
