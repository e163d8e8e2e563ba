//! From records back to points with several normals.

use crate::Features;
use crate::records::{FURTHER, Records, columns};
use glam::Vec3;
use std::collections::HashMap;
use surfine_points::{LevelReport, PointSet, Values};

/// Property that says what a point is: 0 smooth, 1 on a crease, 2 a corner.
const KIND: &str = "kind";

/// A refined cloud of records.
#[derive(Clone, Debug, Default)]
pub struct Refinement {
    /// Positions of all records.
    pub positions: Vec<Vec3>,
    /// Their unit normals.
    pub normals: Vec<Vec3>,
    /// Their radii.
    pub radii: Vec<f32>,
    /// The corners of each new record.
    pub parents: Vec<[u32; 3]>,
    /// Number of records at each level.
    pub level_sizes: Vec<usize>,
    /// Radii of the records of each level, if they were kept.
    pub level_radii: Vec<Vec<f32>>,
}

/// A refined cloud of points.
#[derive(Clone, Debug, Default)]
pub struct Folded {
    /// The input points and the new ones with all their attributes.
    pub points: PointSet,
    /// The corners of each new point.
    pub parents: Vec<[u32; 3]>,
    /// Number of points at each level.
    pub level_sizes: Vec<usize>,
    /// Radii of the points of each level, if they were kept.
    pub level_radii: Vec<Vec<f32>>,
}

/// Puts records together to points again, as the input had them: where it gave further normals as properties, new crease
/// points get them so too; else each side stays a record. `marks` names a property that marks the boundary.
pub fn fold(
    input: &PointSet,
    split: &Records,
    features: &Features,
    refined: Refinement,
    marks: Option<&str>,
) -> Folded {
    if is_plain(input, features, marks) {
        return keep(input, refined);
    }
    let places = Places::new(input, split, features, refined.radii.len());
    let first = input.len();
    let new = |record: u32| record as usize - split.len();
    let to_point = |record: u32| places.point_of[record as usize];
    let parents: Vec<[u32; 3]> =
        places.kept.iter().map(|&r| refined.parents[new(r)].map(to_point)).collect();
    let mut points = input.clone();
    points.positions.extend(places.kept.iter().map(|&r| refined.positions[r as usize]));
    points.normals.extend(places.kept.iter().map(|&r| refined.normals[r as usize]));
    points.radii = places.fold_radii(&refined.radii);
    points.extend_attributes(&parents);
    let sides = places.sides_of_new(first, split.len(), features, &refined.normals);
    if places.merges {
        set_further_normals(&mut points, first, &sides);
    }
    if features.records.iter().any(|record| record.sides > 1) {
        set_column(&mut points, KIND, first, sides.iter().map(|s| s.count.max(1) as u8 - 1));
    }
    if let Some(name) = marks {
        set_column(&mut points, name, first, sides.iter().map(|s| u8::from(s.count == 1)));
    }
    // Records are numbered level by level, so the points are too.
    let points_of = |&size: &usize| first + places.kept.partition_point(|&r| (r as usize) < size);
    let level_sizes = refined.level_sizes.iter().map(points_of).collect();
    let level_radii = refined.level_radii.iter().map(|radii| places.fold_radii(radii)).collect();
    Folded { points, parents, level_sizes, level_radii }
}

/// What [`fold`] gives where there is nothing to fold.
fn keep(input: &PointSet, refined: Refinement) -> Folded {
    let Refinement { positions, mut normals, radii, parents, level_sizes, level_radii } = refined;
    // The records have the unit normals that the input may lack.
    normals[..input.len()].copy_from_slice(&input.normals);
    let (attributes, origin) = (input.attributes.clone(), input.origin);
    let mut points = PointSet { positions, normals, radii, attributes, origin };
    points.extend_attributes(&parents);
    Folded { points, parents, level_sizes, level_radii }
}

/// Whether every record is a point, and no property says what it is.
fn is_plain(input: &PointSet, features: &Features, marks: Option<&str>) -> bool {
    let is_one_record = |record: &crate::Record| record.is_boundary();
    features.records.iter().all(is_one_record) && marks.is_none() && !has_further_normals(input)
}

/// Which record is which point.
struct Places {
    /// The point of each record.
    point_of: Vec<u32>,
    /// The record of each new point.
    kept: Vec<u32>,
    /// Whether further sides of new points are properties of the first.
    merges: bool,
}

/// What a new point is.
#[derive(Clone, Default)]
struct Sides {
    /// 0 off the feature curves, 1 on a boundary, else the number of sides.
    count: u32,
    /// Normals of the sides after the first.
    further: Vec<Vec3>,
}

impl Folded {
    /// Gives reports that count records the numbers of points.
    pub fn count_points(&self, reports: &mut [LevelReport]) {
        for (report, sizes) in reports.iter_mut().zip(self.level_sizes.windows(2)) {
            (report.points_in, report.points_out) = (sizes[0], sizes[1]);
        }
    }
}

impl Places {
    fn new(input: &PointSet, split: &Records, features: &Features, records: usize) -> Self {
        let merges = has_further_normals(input);
        let mut leader_of: HashMap<u32, u32> = HashMap::new();
        for record in features.records.iter().filter(|r| merges && r.point as usize >= split.len())
        {
            leader_of.insert(record.point, features.records[record.first as usize].point);
        }
        let mut point_of: Vec<u32> =
            (0..input.len() as u32).chain(split.owners.iter().copied()).collect();
        let mut kept = Vec::new();
        for record in split.len() as u32..records as u32 {
            let leader = leader_of.get(&record).copied().unwrap_or(record);
            if leader == record {
                point_of.push((input.len() + kept.len()) as u32);
                kept.push(record);
            } else {
                point_of.push(point_of[leader as usize]);
            }
        }
        Self { point_of, kept, merges }
    }

    /// Radii of the points of a level from those of its records: a point has the largest of its sides.
    fn fold_radii(&self, radii: &[f32]) -> Vec<f32> {
        let places = &self.point_of[..radii.len()];
        let mut folded = vec![0.0f32; places.iter().max().map_or(0, |&last| last as usize + 1)];
        for (&place, &radius) in places.iter().zip(radii) {
            let own = &mut folded[place as usize];
            *own = own.max(radius);
        }
        folded
    }

    /// What each new point is; `points` and `records` are those of the input.
    fn sides_of_new(
        &self,
        points: usize,
        records: usize,
        features: &Features,
        normals: &[Vec3],
    ) -> Vec<Sides> {
        let mut sides = vec![Sides::default(); self.kept.len()];
        for record in features.records.iter().filter(|r| r.point as usize >= records) {
            let own = &mut sides[self.point_of[record.point as usize] as usize - points];
            if own.count > 0 && self.merges {
                own.further.push(normals[record.point as usize]);
            }
            own.count = record.sides;
        }
        sides
    }
}

/// Whether further normals are properties.
fn has_further_normals(points: &PointSet) -> bool {
    FURTHER.iter().any(|names| columns(points, names).is_some())
}

/// Gives new points their own further normals, instead of what their corners have in the mean.
fn set_further_normals(points: &mut PointSet, first: usize, sides: &[Sides]) {
    for (rank, names) in FURTHER.iter().enumerate() {
        for (axis, name) in names.iter().enumerate() {
            let attribute = points.attributes.iter_mut().find(|a| a.name == *name);
            let Some(attribute) = attribute else { continue };
            for (i, sides) in (first..).zip(sides) {
                let value = sides.further.get(rank).copied().unwrap_or(Vec3::ZERO)[axis];
                match &mut attribute.values {
                    Values::F32(column) => column[i] = value,
                    Values::F64(column) => column[i] = f64::from(value),
                    _ => {}
                }
            }
        }
    }
}

/// Makes the points from the first on smooth ones: without further normals, of kind 0. For new points that others put in.
pub fn clear_sides(points: &mut PointSet, first: usize) {
    if has_further_normals(points) {
        let smooth = vec![Sides::default(); points.len() - first];
        set_further_normals(points, first, &smooth);
        set_column(points, KIND, first, smooth.iter().map(|_| 0));
    }
}

/// Sets the values of new points in a column, whatever its type.
fn set_column(points: &mut PointSet, name: &str, first: usize, values: impl Iterator<Item = u8>) {
    let Some(attribute) = points.attributes.iter_mut().find(|a| a.name == name) else { return };
    for (i, value) in (first..).zip(values) {
        match &mut attribute.values {
            Values::I8(column) => column[i] = value as i8,
            Values::U8(column) => column[i] = value,
            Values::I16(column) => column[i] = value.into(),
            Values::U16(column) => column[i] = value.into(),
            Values::I32(column) => column[i] = value.into(),
            Values::U32(column) => column[i] = value.into(),
            Values::F32(column) => column[i] = value.into(),
            Values::F64(column) => column[i] = value.into(),
        }
    }
}
