//! A cloud as the truth.

use surfine_points::{DVec3, Model};

use super::{Closest, Sample, TruthKind, TruthSummary, diagonal};
use crate::cloud::units;
use crate::error::{Unfit, check_places};
use crate::places::{Places, same_side};
use crate::tree::Tree;

/// A dense cloud: the surface is its tangent planes, near their points.
pub(super) struct Points {
    positions: Vec<DVec3>,
    normals: Option<Vec<Option<DVec3>>>,
    colors: Option<Vec<[u8; 3]>>,
    places: Places,
    tree: Tree,
}

impl Points {
    pub(super) fn new(model: &Model) -> Result<(Self, TruthSummary), Unfit> {
        let places = Places::new(&model.positions);
        check_places(&places, "truth")?;
        let normals = model.normals.as_deref().map(units);
        let bad_normals = normals.iter().flatten().filter(|n| n.is_none()).count();
        let oriented = normals.is_some() && bad_normals < model.len();
        let summary = TruthSummary {
            kind: if oriented { TruthKind::TangentPlanes } else { TruthKind::Points },
            points: model.len(),
            triangles: 0,
            degenerate_triangles: 0,
            sharp_edges: 0,
            inconsistent_edges: 0,
            bad_normals,
            area: None,
            diagonal: diagonal(places.positions.iter().copied()),
        };
        let tree = Tree::new(&places.positions);
        let positions = model.positions.clone();
        Ok((Self { positions, normals, colors: model.colors(), places, tree }, summary))
    }

    pub(super) fn nearest(&self, x: DVec3, normal: Option<DVec3>) -> Closest {
        let (place, _) = self.tree.nearest(x);
        let point = same_side(self.places.points_at(place), self.normals.as_deref(), normal);
        let own = self.normals.as_ref().and_then(|normals| normals[point]);
        let offset = x - self.positions[point];
        let (position, distance) = match own {
            Some(n) => (x - n * offset.dot(n), offset.dot(n).abs()),
            None => (self.positions[point], offset.length()),
        };
        let color = self.colors.as_ref().map(|colors| colors[point].map(f64::from));
        Closest { position, normal: own, color, distance }
    }

    pub(super) fn samples(&self) -> Vec<Sample> {
        let normal = |i: usize| self.normals.as_ref().and_then(|normals| normals[i]);
        let sample = |(i, &position)| Sample { position, normal: normal(i) };
        self.positions.iter().enumerate().map(sample).collect()
    }
}
