//! Boundary loops (rule 0, ours): what the mutual edges leave open.
//!
//! The faces of the graph are the orbits of (p→q) → (q→ successor of p around q). Nearly all are triangles; a face of many
//! edges or with an open corner is a loop if it is wide.

use crate::graph::{Graph, distance};
use crate::width::{MOST_POINTS, width, circumradius};
use rayon::prelude::*;
use std::fmt;
use surfine_points::PointSet;
use surfine_points::shapes::natural_radii;
use surfine_reference::Level;
use surfine_reference::math::{PI, TAU};

/// A face with fewer edges is a triangle.
const FEWEST_EDGES: usize = 4;
/// From so many edges on a face is open whatever its corners.
const MANY_EDGES: usize = 6;
/// A face of fewer edges needs a corner that is wider, radians (120°).
const OPEN_CORNER: f32 = 2.094_395_2;
/// Span of the smallest loop, in mean edges.
const SMALLEST_SPAN: f32 = 2.5;
/// A loop turns clearly from a quarter of a full turn on, radians.
const CLEAR_TURNING: f32 = 0.25 * TAU;

/// A closed chain of points around a place without points.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// Number of the loop: from 1, by span, the widest first; ties by the lowest point.
    pub id: u32,
    /// The points in order, the open side to the right seen from outside. A point where the loop touches itself is there
    /// several times.
    pub points: Vec<u32>,
    /// The angle that each point sees open, radians on its tangent plane: from the point before counter-clockwise to
    /// the point after.
    pub gaps: Vec<f32>,
    /// Mean distance of each point to its neighbours, in the units of the positions.
    pub spacings: Vec<f32>,
    /// Largest distance of two points, in the units of the positions.
    pub span: f32,
    /// Length, in the units of the positions.
    pub perimeter: f32,
    /// Radius of the largest disc that must be spanned to close the loop, in the units of the positions: the largest
    /// circumscribed circle of a triangulation of its points, as small as it can be.
    pub width: f32,
    /// Sum of π - gap, radians: 2π around a flat hole, less around one in a round surface, -2π along a flat outline.
    pub turning: f32,
}

/// What a loop goes around, told by its turning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A hole: turning above π/2.
    Hole,
    /// The outline of the surface: turning below -π/2.
    OuterRim,
    /// Turning between the two: the end of a tube, half of a sphere, a long slit.
    Undecided,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Hole => "hole",
            Self::OuterRim => "outer rim",
            Self::Undecided => "undecided",
        })
    }
}

impl Loop {
    /// What the loop goes around.
    pub fn kind(&self) -> Kind {
        if self.turning > CLEAR_TURNING {
            Kind::Hole
        } else if self.turning < -CLEAR_TURNING {
            Kind::OuterRim
        } else {
            Kind::Undecided
        }
    }

    /// Mean distance between neighbours along the loop and beside it, in the units of the positions.
    pub fn spacing(&self) -> f32 {
        self.spacings.iter().sum::<f32>() / self.spacings.len() as f32
    }
}

/// The boundary loops of a cloud, the widest first. Radii are not looked at: natural ones are made.
///
/// # Panics
/// If there are fewer normals than positions.
pub fn loops(points: &PointSet) -> Vec<Loop> {
    let normals = points.unit_normals();
    let radii = natural_radii(&points.positions, &normals);
    let radii: Vec<f32> = if std::env::var("OWN").is_ok() { radii.iter().zip(&points.radii).map(|(a, b)| a.min(*b)).collect() } else { radii };
    let positions = points.positions.clone();
    let level = Level { positions, normals, radii, ..Level::default() };
    let graph = Graph::new(&level);
    let mut ratios: Vec<f32> = triangles(&level, &graph);
    ratios.sort_by(f32::total_cmp);
    let q = |x: f32| ratios.get((ratios.len() as f32 * x) as usize).copied().unwrap_or(0.0);
    println!("  q50 {} q90 {} q99 {} q999 {} q9999 {} max {}", q(0.5), q(0.9), q(0.99), q(0.999), q(0.9999), ratios.last().unwrap());
    let mut loops: Vec<Loop> =
        faces(&graph).into_par_iter().filter_map(|face| face.to_loop(&level, &graph)).collect();
    loops.sort_by(|a, b| b.span.total_cmp(&a.span).then(a.points.cmp(&b.points)));
    for (id, found) in (1..).zip(&mut loops) {
        found.id = id;
    }
    loops
}

fn triangles(level: &Level, graph: &Graph) -> Vec<f32> {
    let mut out = vec![];
    for p in 0..level.len() as u32 {
        let list = graph.list(p as usize);
        for (i, e) in list.iter().enumerate() {
            let f = list[(i + 1) % list.len()].id;
            if p < e.id && p < f && graph.list(e.id as usize).iter().any(|x| x.id == f) {
                let r = circumradius([distance(level, p, e.id), distance(level, e.id, f), distance(level, f, p)]);
                let s = [p, e.id, f].map(|v| graph.mean_edge(level, v as usize).unwrap()).iter().sum::<f32>() / 3.0;
                out.push(r / s);
            }
        }
    }
    out
}

/// An orbit: points, and the gap at each.
#[derive(Debug)]
struct Face {
    points: Vec<u32>,
    gaps: Vec<f32>,
}

/// All faces that may be loops.
fn faces(graph: &Graph) -> Vec<Face> {
    let mut seen = vec![false; graph.entries.len()];
    let mut faces = Vec::new();
    for p in 0..graph.starts.len() - 1 {
        for first in graph.starts[p] as usize..graph.starts[p + 1] as usize {
            if !seen[first] {
                let face = face(graph, p as u32, first, &mut seen);
                faces.extend(face.is_open().then_some(face));
            }
        }
    }
    faces
}

/// The orbit of the entry `first` of point `p`; it starts at its lowest point.
fn face(graph: &Graph, p: u32, first: usize, seen: &mut [bool]) -> Face {
    let mut face = Face { points: Vec::new(), gaps: Vec::new() };
    let (mut from, mut entry) = (p, first);
    while !seen[entry] {
        seen[entry] = true;
        let at = graph.entries[entry].id;
        let list = graph.list(at as usize);
        let back = list.iter().position(|e| e.id == from).expect("every edge is there twice");
        let next = if back + 1 == list.len() { 0 } else { back + 1 };
        let turn = list[next].angle - list[back].angle;
        face.points.push(at);
        face.gaps.push(if next <= back { turn + TAU } else { turn });
        (from, entry) = (at, graph.starts[at as usize] as usize + next);
    }
    let lowest = (0..face.points.len()).min_by_key(|&i| face.points[i]).unwrap_or(0);
    face.points.rotate_left(lowest);
    face.gaps.rotate_left(lowest);
    face
}

impl Face {
    fn is_open(&self) -> bool {
        let edges = self.points.len();
        edges >= MANY_EDGES
            || edges >= FEWEST_EDGES && self.gaps.iter().any(|&gap| gap > OPEN_CORNER)
    }

    fn to_loop(self, level: &Level, graph: &Graph) -> Option<Loop> {
        let Self { points, gaps } = self;
        let spacings: Vec<f32> =
            points.iter().map(|&p| graph.mean_edge(level, p as usize).unwrap_or(0.0)).collect();
        let span = span(level, &points);
        let next = points.iter().cycle().skip(1);
        let perimeter = points.iter().zip(next).map(|(&a, &b)| distance(level, a, b)).sum();
        let turning = gaps.iter().map(|gap| PI - gap).sum();
        let width = if points.len() <= MOST_POINTS { width(level, &points) } else { f32::INFINITY };
        let found = Loop { id: 0, points, gaps, spacings, span, perimeter, width, turning };
        (span >= SMALLEST_SPAN * found.spacing()).then_some(found)
    }
}

/// Largest distance of two of the points.
fn span(level: &Level, points: &[u32]) -> f32 {
    let squared = |i: usize| {
        let x = level.positions[points[i] as usize];
        let others = points[i + 1..].iter().map(|&q| level.positions[q as usize] - x);
        others.map(|d| d.dot(d)).fold(0.0, f32::max)
    };
    (0..points.len()).into_par_iter().map(squared).reduce(|| 0.0, f32::max).sqrt()
}
