//! The output, ready to be asked.

use rayon::prelude::*;
use surfine_points::{DVec3, Model, Vec3};

use crate::error::{Unfit, check, check_length, check_places};
use crate::places::Places;
use crate::spread::mean;
use crate::tree::Tree;

/// Neighbours that are looked up once for all measures.
const NEIGHBORS: usize = 8;
/// Neighbours whose mean distance is the local spacing: as many as a regular lattice of triangles has.
const SPACING_NEIGHBORS: usize = 6;

/// A cloud with its different positions, its neighbourhoods and its spacing.
pub(crate) struct Cloud<'a> {
    /// As it came.
    pub(crate) model: &'a Model,
    /// Unit normal of each point; `None` where it has no direction. No column if the model has none and is no mesh.
    pub(crate) normals: Option<Vec<Option<DVec3>>>,
    /// The different positions.
    pub(crate) places: Places,
    /// Of the different positions.
    pub(crate) tree: Tree,
    /// The nearest other places of each place, nearest first: `row` for each.
    neighbors: Vec<u32>,
    row: usize,
    /// Mean distance from each place to its six nearest other places, or to all if there are fewer.
    pub(crate) spacings: Vec<f64>,
    /// Mean of `spacings`.
    pub(crate) spacing: f64,
}

impl<'a> Cloud<'a> {
    pub(crate) fn new(model: &'a Model) -> Result<Self, Unfit> {
        check(model, "output")?;
        let places = Places::new(&model.positions);
        check_places(&places, "output")?;
        let tree = Tree::new(&places.positions);
        let row = NEIGHBORS.min(places.len() - 1);
        let neighbors = neighbors(&places.positions, &tree, row);
        let mut cloud = Self {
            model,
            normals: normals(model),
            places,
            tree,
            neighbors,
            row,
            spacings: Vec::new(),
            spacing: 0.0,
        };
        let count = SPACING_NEIGHBORS.min(row);
        let local = |place| mean((0..count).map(|k| cloud.neighbor_distance(place, k)));
        cloud.spacings = (0..cloud.places.len()).into_par_iter().map(local).collect();
        cloud.spacing = mean(cloud.spacings.iter().copied());
        let smallest = cloud.spacings.iter().copied().fold(f64::INFINITY, f64::min);
        check_length(smallest, "smallest spacing", "output")?;
        Ok(cloud)
    }

    /// The eight nearest other places, or all if there are fewer, the nearest first.
    pub(crate) fn neighbors(&self, place: usize) -> &[u32] {
        &self.neighbors[place * self.row..][..self.row]
    }

    /// Distance to the neighbour of that number.
    pub(crate) fn neighbor_distance(&self, place: usize, number: usize) -> f64 {
        let neighbor = self.neighbors(place)[number] as usize;
        self.places.positions[place].distance(self.places.positions[neighbor])
    }

    /// The normal of a point, if it has one.
    pub(crate) fn normal(&self, point: usize) -> Option<DVec3> {
        self.normals.as_ref()?[point]
    }

    /// Points whose normal is zero or not finite, if there are normals.
    pub(crate) fn bad_normals(&self) -> usize {
        self.normals.as_ref().map_or(0, |normals| normals.iter().filter(|n| n.is_none()).count())
    }
}

/// Unit normals of a model; a mesh without normals has those of its triangles.
pub(crate) fn normals(model: &Model) -> Option<Vec<Option<DVec3>>> {
    match &model.normals {
        Some(normals) => Some(units(normals)),
        None if model.is_mesh() => {
            Some(model.vertex_normals().into_iter().map(DVec3::try_normalize).collect())
        }
        None => None,
    }
}

/// Unit normals; `None` for those without a direction.
pub(crate) fn units(normals: &[Vec3]) -> Vec<Option<DVec3>> {
    normals.par_iter().map(|n| n.as_dvec3().try_normalize()).collect()
}

/// The `row` nearest other positions of each, the nearest first.
fn neighbors(positions: &[DVec3], tree: &Tree, row: usize) -> Vec<u32> {
    let others = |(place, &x): (usize, &DVec3)| {
        let mut found = tree.nearest_n(x, row + 1);
        // The place itself is the one at distance zero: no other place is, though its square may underflow.
        match found.iter().position(|&f| f as usize == place) {
            Some(own) => drop(found.remove(own)),
            None => drop(found.pop()),
        }
        found
    };
    positions.par_iter().enumerate().flat_map_iter(others).collect()
}
