//! How far the output's normals are turned from those of the truth.

use rayon::prelude::*;
use serde::Serialize;
use surfine_points::DVec3;

use crate::cloud::Cloud;
use crate::spread::Angles;
use crate::truth::{Closest, Truth};

/// Angles between the normals of the output and those of the truth, 0 to 180°: a normal to the wrong side counts as such.
///
/// At a crease the side that agrees best counts, see [`Truth::nearest`]. Points without a usable normal on either side are
/// left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NormalError {
    /// Points that were measured.
    pub points: usize,
    /// Of all of them.
    pub all: Angles,
    /// Of those away from creases, if the truth is a mesh with sharp edges.
    pub away_from_creases: Option<AwayFromCreases>,
}

/// Angles at the points that are no closer than one mean spacing of the output to a sharp edge of the truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AwayFromCreases {
    /// Points that were measured.
    pub points: usize,
    /// Of these.
    pub angles: Angles,
}

/// Angle between two unit vectors, degrees. The cross product keeps its digits at small angles, the inverse cosine doesn't.
pub(crate) fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// `None` if no point has a normal that can be compared.
pub(crate) fn measure(
    output: &Cloud<'_>,
    truth: &Truth,
    closest: &[Closest],
) -> Option<NormalError> {
    output.normals.as_ref()?;
    let error = |point: usize| Some(angle(output.normal(point)?, closest[point].normal?));
    let errors: Vec<Option<f64>> = (0..closest.len()).into_par_iter().map(error).collect();
    let measured: Vec<f64> = errors.iter().copied().flatten().collect();
    Some(NormalError {
        points: measured.len(),
        all: Angles::of(&measured)?,
        away_from_creases: away_from_creases(output, truth, &errors),
    })
}

fn away_from_creases(
    output: &Cloud<'_>,
    truth: &Truth,
    errors: &[Option<f64>],
) -> Option<AwayFromCreases> {
    if truth.summary().sharp_edges == 0 {
        return None;
    }
    let positions = &output.model.positions;
    let away = |(point, error): (usize, &Option<f64>)| {
        error.filter(|_| !truth.crease_within(positions[point], output.spacing))
    };
    let measured: Vec<Option<f64>> = errors.par_iter().enumerate().map(away).collect();
    let measured: Vec<f64> = measured.into_iter().flatten().collect();
    Some(AwayFromCreases { points: measured.len(), angles: Angles::of(&measured)? })
}
