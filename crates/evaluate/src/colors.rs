//! How far the output's colours are from those of the truth.

use rayon::prelude::*;
use serde::Serialize;
use surfine_points::{DVec3, Model};

use crate::cloud::Cloud;
use crate::spread::mean;
use crate::tree::Tree;
use crate::truth::Closest;

/// Differences of colours over all points and the three channels, in steps of 8 bits: 0 to 255.
///
/// The true colour is interpolated in the triangle of a mesh, or that of the nearest point of a cloud.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ColorError {
    /// Mean absolute difference.
    pub mean: f64,
    /// Root of the mean squared difference.
    pub rms: f64,
    /// Largest difference.
    pub max: f64,
    /// Root of the mean squared difference if each point of the output had the colour of the nearest point of the input,
    /// if there is an input with colours: what interpolation should beat.
    pub nearest_input_rms: Option<f64>,
}

/// `None` if the output or the truth has no colours.
pub(crate) fn measure(
    output: &Cloud<'_>,
    closest: &[Closest],
    input: Option<&Model>,
) -> Option<ColorError> {
    let truth: Option<Vec<[f64; 3]>> = closest.iter().map(|c| c.color).collect();
    let truth = truth?;
    let differences = differences(&output.model.colors()?, &truth);
    Some(ColorError {
        mean: mean(differences.iter().copied()),
        rms: rms(&differences),
        max: differences.iter().copied().fold(0.0, f64::max),
        nearest_input_rms: input.and_then(|input| nearest_input(output, input, &truth)),
    })
}

/// Absolute differences, channel by channel.
fn differences(colors: &[[u8; 3]], truth: &[[f64; 3]]) -> Vec<f64> {
    let channels = colors.as_flattened().iter().zip(truth.as_flattened());
    channels.map(|(&c, &t)| (f64::from(c) - t).abs()).collect()
}

fn rms(differences: &[f64]) -> f64 {
    mean(differences.iter().map(|d| d * d)).sqrt()
}

fn nearest_input(output: &Cloud<'_>, input: &Model, truth: &[[f64; 3]]) -> Option<f64> {
    let colors = input.colors()?;
    let tree = Tree::new(&input.positions);
    let nearest = |&x: &DVec3| colors[tree.nearest(x).0];
    let taken: Vec<[u8; 3]> = output.model.positions.par_iter().map(nearest).collect();
    Some(rms(&differences(&taken, truth)))
}
