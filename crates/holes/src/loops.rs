//! Boundary loops (rule 0, ours): what the mutual edges leave open.
//!
//! The faces of the graph are the orbits of (p→q) → (q→ successor of p around q). Nearly all are triangles; a face of many
//! edges or with an open corner is a loop if it is wide.

use crate::graph::{Edge, Graph, distance, edge};
use crate::natural::least_radii;
use crate::width::{circumradius, width};
use glam::Vec3;
use rayon::prelude::*;
use std::fmt;
use surfine_points::{PointSet, Values};
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
/// Width of the narrowest loop, in mean edges, in an even cloud. Where rings disagree at sharp bends of closed models loops
/// are up to 1.01 wide; the narrowest true holes that were seen are 1.2.
const LEAST_WIDTH: f32 = 1.15;
/// The circles around all but the largest hundredth of a cloud's triangles are smaller than this many mean edges if the cloud
/// is even; what they are larger is added to the least width so many times. Random clouds: 0.92 to 0.96 and widths of up to 1.8.
const EVEN_TRIANGLE: f32 = 0.78;
const EXCESS: f32 = 4.0;
const LARGE_TRIANGLES: usize = 99;
/// An edge with loops on both sides is a bridge over one hole from so many mean edges on.
const LONG_EDGE: f32 = 1.4;
/// A loop turns clearly from a quarter of a full turn on, radians.
const CLEAR_TURNING: f32 = 0.25 * TAU;
/// From one and a half turns on a loop is no hole but a tangle where sheets meet, radians.
const TANGLED: f32 = 1.5 * TAU;

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
    /// Radius of the largest circle around a triangle of a triangulation of the points, as small as it can be, in the
    /// units of the positions; `None` for more than 400 points.
    pub width: Option<f32>,
    /// Sum of π - gap, radians: 2π around a flat hole, less around one in a round surface, -2π along a flat outline.
    pub turning: f32,
}

/// What a loop goes around, told by its turning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A hole: turning between π/2 and 3π.
    Hole,
    /// The outline of the surface: turning below -π/2.
    OuterRim,
    /// Any other turning: the end of a tube, half of a sphere, a tangle.
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
        if self.turning < -CLEAR_TURNING {
            Kind::OuterRim
        } else if self.turning > CLEAR_TURNING && self.turning < TANGLED {
            Kind::Hole
        } else {
            Kind::Undecided
        }
    }

    /// Mean of [`Loop::spacings`], in the units of the positions.
    pub fn spacing(&self) -> f32 {
        self.spacings.iter().sum::<f32>() / self.spacings.len() as f32
    }
}

/// The boundary loops of a cloud, the widest first.
///
/// Rings are taken with natural radii, or with those of the input where they are smaller: they may know more, for instance
/// which points a mesh connects. A loop is left out if it could be closed with triangles that are hardly larger than
/// those of the cloud, or if half of its points are on creases, of which one side does not see the other.
///
/// # Panics
/// If there are fewer normals or radii than positions.
pub fn loops(points: &PointSet) -> Vec<Loop> {
    let level = Level {
        positions: points.positions.clone(),
        normals: points.unit_normals(),
        radii: least_radii(points),
        ..Level::default()
    };
    let (edges, usual, faces) = wide_faces(&level, Graph::new(&level));
    let creases = Creases::new(points);
    let open = faces.into_par_iter().filter(|face| face.is_open() && !creases.holds(&face.points));
    let mut loops: Vec<Loop> =
        open.filter_map(|face| face.into_loop(&level, &edges, usual)).collect();
    loops.sort_by(|a, b| b.span.total_cmp(&a.span).then(a.points.cmp(&b.points)));
    for (id, found) in (1..).zip(&mut loops) {
        found.id = id;
    }
    loops
}

/// The faces of a graph, once the longest edges of triangles as wide as a loop are taken out: natural radii bridge holes of some
/// spacings. Also the mean edge at each point, and how wide a loop must be in mean edges.
fn wide_faces(level: &Level, mut graph: Graph) -> (Vec<f32>, f32, Vec<Face>) {
    let mut usual = None;
    loop {
        let mean = |p| graph.mean_edge(level, p);
        let edges: Vec<f32> = (0..level.len()).into_par_iter().map(mean).collect();
        let faces = faces(&graph);
        let ratio = |face: &Face| face.ratio(level, &edges);
        let usual =
            *usual.get_or_insert_with(|| usual_width(faces.par_iter().filter_map(ratio).collect()));
        let bridges = bridges(level, &edges, usual, &faces);
        if bridges.is_empty() {
            return (edges, usual, faces);
        }
        graph = graph.without(&bridges);
    }
}

/// The longest edges of triangles as wide as a loop, and long edges with loops on both sides; sorted.
fn bridges(level: &Level, edges: &[f32], usual: f32, faces: &[Face]) -> Vec<Edge> {
    let is_wide = |face: &&Face| match face.ratio(level, edges) {
        Some(ratio) => ratio >= usual,
        None => face.is_open() && face.is_wide(level, edges, usual),
    };
    let wide: Vec<&Face> = faces.par_iter().filter(is_wide).collect();
    let triangles = wide.iter().filter(|face| face.points.len() == 3);
    let mut bridges: Vec<Edge> = triangles.map(|face| face.longest_edge(level)).collect();
    let mut sides: Vec<Edge> = wide.iter().flat_map(|face| face.edges()).collect();
    sides.sort_unstable();
    let is_long = |[a, b]: Edge| {
        distance(level, a, b) > LONG_EDGE * 0.5 * (edges[a as usize] + edges[b as usize])
    };
    let between = sides.windows(2).filter(|pair| pair[0] == pair[1] && is_long(pair[0]));
    bridges.extend(between.map(|pair| pair[0]));
    bridges.sort_unstable();
    bridges
}

/// How wide a loop must be, in mean edges: [`LEAST_WIDTH`], and more in clouds of large triangles, as random samples are.
fn usual_width(mut ratios: Vec<f32>) -> f32 {
    let rank = ratios.len() * LARGE_TRIANGLES / 100;
    if rank == ratios.len() {
        return LEAST_WIDTH;
    }
    let large = *ratios.select_nth_unstable_by(rank, f32::total_cmp).1;
    LEAST_WIDTH + EXCESS * (large - EVEN_TRIANGLE).max(0.0)
}

/// An orbit: points, and the gap at each.
#[derive(Debug)]
struct Face {
    points: Vec<u32>,
    gaps: Vec<f32>,
}

/// All faces.
fn faces(graph: &Graph) -> Vec<Face> {
    let mut seen = vec![false; graph.entries.len()];
    let mut faces = Vec::new();
    for p in 0..graph.starts.len() - 1 {
        for first in graph.starts[p] as usize..graph.starts[p + 1] as usize {
            if !seen[first] {
                faces.push(face(graph, p as u32, first, &mut seen));
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
    /// Radius of the circle around a triangle in mean edges; `None` if it has more corners.
    fn ratio(&self, level: &Level, edges: &[f32]) -> Option<f32> {
        let [a, b, c] = self.points[..] else { return None };
        let sides = [[a, b], [b, c], [c, a]].map(|[a, b]| distance(level, a, b));
        let edge = [a, b, c].map(|p| edges[p as usize]).iter().sum::<f32>() / 3.0;
        Some(circumradius(sides) / edge)
    }

    /// Whether it is as wide as a loop.
    fn is_wide(&self, level: &Level, edges: &[f32], usual: f32) -> bool {
        let spacing =
            self.points.iter().map(|&p| edges[p as usize]).sum::<f32>() / self.points.len() as f32;
        span(level, &self.points) >= SMALLEST_SPAN * spacing
            && width(level, &self.points).is_none_or(|width| width >= usual * spacing)
    }

    fn edges(&self) -> impl Iterator<Item = Edge> {
        let next = self.points.iter().cycle().skip(1);
        self.points.iter().zip(next).map(|(&a, &b)| edge(a, b))
    }

    /// The longest edge, the first of equal ones.
    fn longest_edge(&self, level: &Level) -> Edge {
        let length = |[a, b]: Edge| distance(level, a, b);
        let longer = |x: Edge, y: Edge| if length(y) > length(x) { y } else { x };
        self.edges().reduce(longer).expect("a face has edges")
    }

    fn is_open(&self) -> bool {
        let edges = self.points.len();
        edges >= MANY_EDGES
            || edges >= FEWEST_EDGES && self.gaps.iter().any(|&gap| gap > OPEN_CORNER)
    }

    fn into_loop(self, level: &Level, edges: &[f32], usual_width: f32) -> Option<Loop> {
        let Self { points, gaps } = self;
        let spacings: Vec<f32> = points.iter().map(|&p| edges[p as usize]).collect();
        let spacing = spacings.iter().sum::<f32>() / spacings.len() as f32;
        let span = span(level, &points);
        if span < SMALLEST_SPAN * spacing {
            return None;
        }
        let width = width(level, &points);
        if width.is_some_and(|width| width < usual_width * spacing) {
            return None;
        }
        let next = points.iter().cycle().skip(1);
        let perimeter = points.iter().zip(next).map(|(&a, &b)| distance(level, a, b)).sum();
        let turning = gaps.iter().map(|gap| PI - gap).sum();
        Some(Loop { id: 0, points, gaps, spacings, span, perimeter, width, turning })
    }
}

/// Which points are on creases: they have further normals, or share their place with another point.
struct Creases {
    has_more_normals: Vec<bool>,
    doubled: Vec<[u32; 3]>,
    places: Vec<[u32; 3]>,
}

impl Creases {
    fn new(points: &PointSet) -> Self {
        // Zeros of either sign are one place.
        let bits = |x: &Vec3| (*x + Vec3::ZERO).to_array().map(f32::to_bits);
        let places: Vec<[u32; 3]> = points.positions.iter().map(bits).collect();
        let mut sorted = places.clone();
        sorted.par_sort_unstable();
        let doubled = sorted.chunk_by(|a, b| a == b).filter(|equal| equal.len() > 1);
        let doubled = doubled.map(|equal| equal[0]).collect();
        let second = ["nx2", "ny2", "nz2"].map(|name| points.attribute(name).map(|a| &a.values));
        let has_more = |p: usize| {
            second.iter().any(|values| matches!(values, Some(Values::F32(v)) if v[p] != 0.0))
        };
        let has_more_normals = (0..points.len()).map(has_more).collect();
        Self { has_more_normals, doubled, places }
    }

    /// Whether at least half of the points are on creases.
    fn holds(&self, points: &[u32]) -> bool {
        let on_crease = |&&p: &&u32| {
            let p = p as usize;
            self.has_more_normals[p] || self.doubled.binary_search(&self.places[p]).is_ok()
        };
        2 * points.iter().filter(on_crease).count() >= points.len()
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
