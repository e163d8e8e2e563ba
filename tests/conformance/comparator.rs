//! The comparator must see what it is there for: each of these changes is an error.

use crate::harness::{compare, compare_equal};
use crate::tolerance::{EXACT, POSITION};

fn values() -> Vec<f32> {
    (0..50).map(|i| 0.25 + i as f32 * 0.125).collect()
}

#[test]
fn equal_values_pass() {
    compare("values", &values(), &values(), EXACT, 1.0).expect("they are equal");
}

#[test]
fn the_smallest_step_is_seen_in_exact_mode() {
    let mut found = values();
    found[17] = f32::from_bits(found[17].to_bits() + 1);
    let error = compare("values", &values(), &found, EXACT, 1.0).expect_err("one bit differs");
    assert!(error.contains("values[17]") && error.contains("-1 steps"), "{error}");
}

#[test]
fn signs_of_zero_differ_in_exact_mode() {
    assert!(compare("zero", &[0.0], &[-0.0], EXACT, 1.0).is_err());
}

#[test]
fn a_tolerance_ends_where_it_says() {
    let inside = [1.0 + POSITION.relative * 0.9];
    let outside = [1.0 + POSITION.relative * 1.2];
    assert!(compare("inside", &[1.0], &inside, POSITION, 1.0).is_ok());
    assert!(compare("outside", &[1.0], &outside, POSITION, 1.0).is_err());
    assert!(compare("scaled", &[1.0], &inside, POSITION, 0.5).is_err());
}

#[test]
fn truncated_values_are_seen() {
    let all = values();
    assert!(compare("values", &all, &all[..49], EXACT, 1.0).is_err());
    assert!(compare("values", &all[..49], &all, POSITION, 1.0).is_err());
    assert!(compare_equal("ids", &[1, 2, 3], &[1, 2]).is_err());
    assert!(compare_equal("nothing", &[1], &[]).is_err());
}

#[test]
fn swapped_values_are_seen() {
    let mut found = values();
    found.swap(3, 4);
    assert!(compare("values", &values(), &found, POSITION, 1.0).is_err());
    assert!(compare_equal("ids", &[1, 2, 3], &[2, 1, 3]).is_err());
}

#[test]
fn nan_and_infinity_are_seen_even_where_both_have_them() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut found = values();
        found[0] = bad;
        assert!(compare("values", &values(), &found, POSITION, 1.0).is_err());
        assert!(compare("values", &found, &found, POSITION, 1.0).is_err());
    }
}
