//! Conormals of crease records: the direction in the tangent plane that points into the side's own sheet (ours).

use crate::{Cloud, Features, NONE, Record};
use glam::Vec3;
use surfine_points::math::{is_apart, unit};
use surfine_points::{Grid, GridShape};

/// Keeps the weight of neighbours in the tangent plane finite.
const FLATNESS: f32 = 0.01;

/// Sets the conormals of all records from the curves, with the smooth points around telling on which side the sheet lies.
pub(crate) fn set_conormals(features: &mut Features, cloud: Cloud<'_>) {
    let shape = GridShape::fit(cloud.positions, cloud.radii);
    let grid = Grid::build(shape, (0u32..).zip(cloud.positions.iter().copied()));
    let by_point = features.by_point(cloud.positions.len());
    let mut first = 0;
    while first < features.records.len() {
        let sides = features.sides_of(first as u32);
        first = sides.end;
        let around = around(&features.records[sides.clone()], cloud, &grid, &by_point);
        let conormals: Vec<Vec3> = if sides.len() == 2 {
            across_crease(&features.records[sides.clone()], &around).to_vec()
        } else {
            sides.clone().map(|r| at_corner(features, r, &around[r - sides.start])).collect()
        };
        for (record, conormal) in features.records[sides].iter_mut().zip(conormals) {
            record.conormal = conormal;
        }
    }
}

/// Unit vectors to the smooth points around a point, each with the side whose normal is most like its own.
fn around(records: &[Record], cloud: Cloud<'_>, grid: &Grid, by_point: &[u32]) -> Vec<Vec<Vec3>> {
    let mut found: Vec<(u32, usize, Vec3)> = Vec::new();
    let (center, radius) = (records[0].position, cloud.radii[records[0].point as usize]);
    grid.visit_ball(center, radius, |id, _| {
        let d = cloud.positions[id as usize] - center;
        let d2 = d.dot(d);
        if by_point[id as usize] == NONE && d2 <= radius * radius && is_apart(d2, radius) {
            let side = side_of(records, cloud.normals[id as usize]);
            found.push((id, side, d * (1.0 / d2.sqrt())));
        }
    });
    // Sums must not depend on the order of the grid's cells.
    found.sort_unstable_by_key(|&(id, ..)| id);
    let mut around = vec![Vec::new(); records.len()];
    found.into_iter().for_each(|(_, side, u)| around[side].push(u));
    around
}

/// The side whose normal is most like this one, the first of equals.
fn side_of(records: &[Record], normal: Vec3) -> usize {
    let mut best = 0;
    for k in 1..records.len() {
        if records[k].normal.dot(normal) > records[best].normal.dot(normal) {
            best = k;
        }
    }
    best
}

/// How far the smooth points of a side lie in a direction; those in the side's tangent plane count most.
fn vote(around: &[Vec3], normal: Vec3, direction: Vec3) -> f32 {
    let weight = |u: &Vec3| 1.0 / (FLATNESS + u.dot(normal) * u.dot(normal));
    around.iter().map(|u| weight(u) * u.dot(direction)).sum()
}

/// Conormals of the two sides of a crease: at right angles to it, away from the other side's normal or, in a groove,
/// towards it. One sign for both.
fn across_crease(records: &[Record], around: &[Vec<Vec3>]) -> [Vec3; 2] {
    let (a, b) = (records[0].normal, records[1].normal);
    let cosine = a.dot(b);
    let outward = [-unit(b - a * cosine), -unit(a - b * cosine)];
    let votes = vote(&around[0], a, outward[0]) + vote(&around[1], b, outward[1]);
    if votes < 0.0 { outward.map(|m| -m) } else { outward }
}

/// Conormal of one side of a corner: between its two curves, on the side where its points are.
fn at_corner(features: &Features, record: usize, around: &[Vec3]) -> Vec3 {
    let Record { position, normal, partners, .. } = features.records[record];
    let to_partner = |&r: &u32| unit(features.records[r as usize].position - position);
    let along: Vec3 = partners.iter().filter(|&&r| r != NONE).map(to_partner).sum();
    let to_points: Vec3 = around.iter().copied().sum();
    let flat = |v: Vec3| v - normal * v.dot(normal);
    let bisector = flat(along);
    if bisector.dot(bisector) > 1e-4 {
        let m = unit(bisector);
        return if vote(around, normal, m) < 0.0 { -m } else { m };
    }
    let inward = flat(to_points);
    if inward.dot(inward) > 1e-4 { unit(inward) } else { features.records[record].frame_default() }
}
