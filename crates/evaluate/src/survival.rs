//! Whether the input is still there.

use std::collections::HashSet;

use serde::Serialize;
use surfine_points::{DVec3, Model, Values, Vec3};

/// Whether the output begins with the points of the input, bit for bit.
///
/// A point is kept if its position, its normal and every attribute are the same bits: a zero of the other sign is a
/// change. Radii may change and don't count.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Survival {
    /// Points of the input.
    pub input_points: usize,
    /// Those of them that are kept, each at its own index.
    pub kept: usize,
    /// Index of the first one that is not.
    pub first_changed: Option<usize>,
    /// If not all are kept: those whose position is found anywhere in the output.
    pub found_anywhere: Option<usize>,
    /// Properties of the input that the output doesn't have, or has in another type: they don't count.
    pub missing: Vec<String>,
}

pub(crate) fn measure(output: &Model, input: &Model) -> Survival {
    let shared = input.len().min(output.len());
    let mut same: Vec<bool> = (0..input.len())
        .map(|i| i < shared && bits(input.positions[i]) == bits(output.positions[i]))
        .collect();
    let mut missing = Vec::new();
    match (&input.normals, &output.normals) {
        (Some(ours), Some(theirs)) => {
            let bits = |n: &Vec3| n.to_array().map(f32::to_bits);
            and_same(&mut same, ours, theirs, |a, b| bits(a) == bits(b));
        }
        (Some(_), None) => missing.extend(["nx", "ny", "nz"].map(String::from)),
        (None, _) => {}
    }
    for attribute in &input.attributes {
        let there = output.attribute(&attribute.name).map(|a| &a.values);
        if !there.is_some_and(|values| and_same_values(&mut same, &attribute.values, values)) {
            missing.push(attribute.name.clone());
        }
    }
    let kept = same.iter().filter(|&&s| s).count();
    Survival {
        input_points: input.len(),
        kept,
        first_changed: same.iter().position(|s| !s),
        found_anywhere: (kept < input.len()).then(|| found_anywhere(output, input)),
        missing,
    }
}

fn bits(position: DVec3) -> [u64; 3] {
    position.to_array().map(f64::to_bits)
}

fn found_anywhere(output: &Model, input: &Model) -> usize {
    let there: HashSet<[u64; 3]> = output.positions.iter().map(|&p| bits(p)).collect();
    input.positions.iter().filter(|&&p| there.contains(&bits(p))).count()
}

/// Keeps the marks of those entries that are equal in both columns.
fn and_same<T>(same: &mut [bool], ours: &[T], theirs: &[T], equal: impl Fn(&T, &T) -> bool) {
    for ((same, a), b) in same.iter_mut().zip(ours).zip(theirs) {
        *same &= equal(a, b);
    }
}

/// The same for attributes. Whether they are of one type; if not, nothing is done.
fn and_same_values(same: &mut [bool], ours: &Values, theirs: &Values) -> bool {
    match (ours, theirs) {
        (Values::I8(a), Values::I8(b)) => and_same(same, a, b, i8::eq),
        (Values::U8(a), Values::U8(b)) => and_same(same, a, b, u8::eq),
        (Values::I16(a), Values::I16(b)) => and_same(same, a, b, i16::eq),
        (Values::U16(a), Values::U16(b)) => and_same(same, a, b, u16::eq),
        (Values::I32(a), Values::I32(b)) => and_same(same, a, b, i32::eq),
        (Values::U32(a), Values::U32(b)) => and_same(same, a, b, u32::eq),
        (Values::F32(a), Values::F32(b)) => {
            and_same(same, a, b, |a, b| a.to_bits() == b.to_bits());
        }
        (Values::F64(a), Values::F64(b)) => {
            and_same(same, a, b, |a, b| a.to_bits() == b.to_bits());
        }
        _ => return false,
    }
    true
}
