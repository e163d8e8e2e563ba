//! The paper's models, where their files are.

use crate::clouds::spacing;
use std::path::Path;
use surfine_holes::{Choice, Filled, Kind, fill_holes, loops};
use surfine_points::{PointSet, Values, Vec3, ply};

/// A cloud of the test data; `None` where there is none.
fn model(name: &str) -> Option<PointSet> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/points");
    let path = data.join(name);
    path.exists().then(|| ply::read(&path).unwrap().0)
}

#[test]
fn loops_are_those_of_the_meshes() {
    let cases: [(&str, &[Kind]); 8] = [
        ("igea-2500-uniform.ply", &[]),
        ("armadillo-10000-uniform.ply", &[]),
        ("rockerarm-4000-uniform.ply", &[]),
        ("nefertiti-3500-random.ply", &[]),
        ("spot-2500-colour.ply", &[]),
        ("face-4000-boundary.ply", &[Kind::OuterRim]),
        ("igea-5000-hole-open.ply", &[Kind::Hole]),
        ("bunny-14379-uniform.ply", &[Kind::Hole; 5]),
    ];
    for (name, expected) in cases {
        if let Some(cloud) = model(name) {
            let kinds: Vec<Kind> = loops(&cloud).iter().map(|found| found.kind()).collect();
            assert_eq!(kinds, expected, "{name}");
        }
    }
}

#[test]
fn the_hole_of_igea_is_filled_however_its_rim_is_given() {
    for (name, choice) in
        [("igea-5000-hole.ply", Choice::Raised), ("igea-5000-hole-open.ply", Choice::All)]
    {
        let Some(cloud) = model(name) else { continue };
        let Filled { points, fills, .. } = fill_holes(&cloud, &choice).unwrap();
        assert_eq!(fills.len(), 1, "{name}");
        assert!((300..480).contains(&fills[0].points), "{name}: {} points", fills[0].points);
        let Some(Values::I32(tags)) = points.attribute("hole").map(|a| &a.values) else {
            panic!("{name}: there are no tags")
        };
        let center = Vec3::new(-0.195, 0.099, 0.049);
        let inside = spacing(&points, |i| tags[i] > 0);
        let around =
            spacing(&points, |i| tags[i] == 0 && (points.positions[i] - center).length() < 0.28);
        assert!((0.67..1.5).contains(&(inside / around)), "{name}: {inside} against {around}");
    }
}
