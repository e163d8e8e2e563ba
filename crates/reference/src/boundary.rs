//! The boundaries of the input (section 6). Twin: `shaders/boundary_gaps.wgsl`.

use crate::Level;
use crate::neighborhood::Rings;
use surfine_features::{Gap, may_be_boundary};
use surfine_points::{PointSet, RefineParams};

/// Finds the boundaries of the input from its rings and gives the level their records; false if there are none.
pub fn boundary(
    level: &mut Level,
    rings: &Rings,
    points: &PointSet,
    params: &RefineParams,
) -> bool {
    let ring = |p: usize| rings.ring(p).iter().map(|entry| (entry.id, entry.angle));
    let gaps = (0..level.len()).filter_map(|p| Gap::widest(p as u32, ring(p)));
    let gaps: Vec<Gap> = gaps.filter(|gap| may_be_boundary(points, params, gap)).collect();
    let mut features = level.curves.take().map(|curves| curves.features).unwrap_or_default();
    let before = features.records.len();
    features.add_boundary(level.cloud(), &gaps);
    let found = features.records.len() > before;
    level.set_features(features);
    found
}
