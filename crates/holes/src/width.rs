//! How wide a loop is: whether it can be closed with triangles like those around it (ours).
//!
//! Faces of several edges also come up where rings disagree, at sharp bends and in random samples. Their points lie close
//! together: triangles no larger than usual close them. Around a hole every triangulation has a large one.

use crate::graph::distance;
use surfine_reference::Level;

/// The search takes the third power of the number of points.
const MOST_POINTS: usize = 400;

/// The largest circumscribed circle of a triangulation of the closed chain, as small as it can be: its radius; `None` for
/// chains of more than [`MOST_POINTS`].
///
/// Dynamic programming over the pieces of the chain (Barequet and Sharir 1995, with another weight).
pub(crate) fn width(level: &Level, chain: &[u32]) -> Option<f32> {
    let n = chain.len();
    if n > MOST_POINTS {
        return None;
    }
    let edges: Vec<f32> = (0..n * n).map(|i| distance(level, chain[i / n], chain[i % n])).collect();
    let edge = |i: usize, j: usize| edges[i * n + j];
    let mut best = vec![0.0f32; n * n];
    for length in 2..n {
        for i in 0..n - length {
            let j = i + length;
            let through = |k: usize| {
                let circle = circumradius([edge(i, k), edge(k, j), edge(i, j)]);
                circle.max(best[i * n + k]).max(best[k * n + j])
            };
            best[i * n + j] = (i + 1..j).map(through).fold(f32::INFINITY, f32::min);
        }
    }
    Some(best[n - 1])
}

/// Radius of the circle through the corners of a triangle with these sides; without area half of the longest side if
/// two corners are in one place, else infinite.
pub(crate) fn circumradius(sides: [f32; 3]) -> f32 {
    let longest = sides.into_iter().fold(f32::MIN_POSITIVE, f32::max);
    // Heron's formula for sixteen times the squared area, in units of the longest side.
    let [a, b, c] = sides.map(|side| side / longest);
    let area = (a + b + c) * (b + c - a) * (c + a - b) * (a + b - c);
    if area > 1e-10 {
        longest * (a * b * c / area.sqrt()).max(0.5)
    } else if a.min(b).min(c) < 1e-3 {
        0.5 * longest
    } else {
        f32::INFINITY
    }
}
