//! From points with several normals to records with one each.

use glam::Vec3;
use std::collections::HashMap;
use surfine_points::{Invalid, PointSet, Values, unit_normal};

/// Properties of further normals.
pub(crate) const FURTHER: [[&str; 3]; 2] = [["nx2", "ny2", "nz2"], ["nx3", "ny3", "nz3"]];
/// Normals of one point are sides of a crease if their cross product is no shorter, 2.9°.
pub(crate) const CREASED: f32 = 0.05;

/// The points of the input with one record for each normal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Records {
    /// Positions of the records: those of the points by index, then those of further normals.
    pub positions: Vec<Vec3>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Radii.
    pub radii: Vec<f32>,
    /// The records of each point that has several, ascending.
    pub groups: Vec<Vec<u32>>,
    /// The point of each record that is a further normal, from the first one on.
    pub owners: Vec<u32>,
}

impl Records {
    /// Takes the points apart: a record for each further normal (`nx2 ny2 nz2`, `nx3 ny3 nz3`; zero where there is none).
    /// Records of the input that share a position and differ in their normals belong to one point too.
    ///
    /// # Errors
    /// A further normal is not finite.
    pub fn split(points: &PointSet) -> Result<Self, Invalid> {
        let mut records = Self {
            positions: points.positions.clone(),
            normals: points.unit_normals(),
            radii: points.radii.clone(),
            ..Self::default()
        };
        for names in &FURTHER {
            records.add_further(points, names)?;
        }
        records.groups = groups(&records.positions, &records.normals);
        Ok(records)
    }

    fn add_further(&mut self, points: &PointSet, names: &[&str; 3]) -> Result<(), Invalid> {
        let Some(columns) = columns(points, names) else { return Ok(()) };
        for point in 0..points.len() {
            let normal = Vec3::from_array(columns.map(|values| component(values, point)));
            if let Some(value) = normal.to_array().into_iter().find(|v| !v.is_finite()) {
                return Err(Invalid::NotFinite { point, what: "a further normal", value });
            }
            if normal.as_dvec3().length() > 1e-15 {
                self.positions.push(points.positions[point]);
                self.normals.push(unit_normal(normal));
                self.radii.push(points.radii[point]);
                self.owners.push(point as u32);
            }
        }
        Ok(())
    }

    /// Number of records.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }
}

/// The columns of a direction, if all three are floats.
pub(crate) fn columns<'a>(points: &'a PointSet, names: &[&str; 3]) -> Option<[&'a Values; 3]> {
    let column = |name| points.attribute(name).map(|a| &a.values).filter(|v| v.is_float());
    Some([column(names[0])?, column(names[1])?, column(names[2])?])
}

fn component(values: &Values, i: usize) -> f32 {
    match values {
        Values::F32(column) => column[i],
        Values::F64(column) => column[i] as f32,
        // Only floats are asked for.
        _ => 0.0,
    }
}

/// Records of one position whose normals differ pairwise. Like ones are copies and opposite ones two sheets, not creases.
fn groups(positions: &[Vec3], normals: &[Vec3]) -> Vec<Vec<u32>> {
    // Adding zero makes one zero of the two.
    let key = |x: Vec3| (x + 0.0).to_array().map(f32::to_bits);
    let mut first: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
    let mut groups: HashMap<u32, Vec<u32>> = HashMap::new();
    for (i, &x) in (0u32..).zip(positions) {
        let leader = *first.entry(key(x)).or_insert(i);
        if leader != i {
            groups.entry(leader).or_insert_with(|| vec![leader]).push(i);
        }
    }
    let differ = |a: u32, b: u32| {
        let cross = normals[a as usize].cross(normals[b as usize]);
        cross.dot(cross) >= CREASED * CREASED
    };
    let creased = |group: &Vec<u32>| {
        (1..group.len()).all(|i| group[..i].iter().all(|&other| differ(group[i], other)))
    };
    let mut groups: Vec<Vec<u32>> = groups.into_values().filter(creased).collect();
    groups.sort_unstable();
    groups
}
