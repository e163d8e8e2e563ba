//! `surfine holes`, `fill` and `refine --fill-holes`.

use crate::folder::Folder;
use serde_json::Value;
use surfine_points::ply::{self, Encoding, Source};
use surfine_points::shapes::natural_radii;
use surfine_points::{PointSet, Values, Vec3};

/// A folder with a sphere that has holes at both poles, the wider one at +z.
fn with_holes() -> Folder {
    let folder = Folder::with_sample("sphere", "1200");
    let sphere = folder.points("in.ply");
    let cut = |x: &Vec3| (*x - Vec3::Z).length() < 0.6 || (*x - Vec3::NEG_Z).length() < 0.4;
    let positions: Vec<Vec3> = sphere.positions.into_iter().filter(|x| !cut(x)).collect();
    let radii = natural_radii(&positions, &positions);
    write(&folder, &PointSet::new(positions.clone(), positions, radii));
    folder
}

fn write(folder: &Folder, points: &PointSet) {
    let path = folder.path("in.ply");
    ply::write(&path, points, None, &Source::default(), Encoding::Binary).unwrap();
}

fn tags(points: &PointSet) -> Vec<i32> {
    match points.attribute("hole").map(|a| &a.values) {
        Some(Values::I32(tags)) => tags.clone(),
        other => panic!("the tags are {other:?}"),
    }
}

#[test]
fn loops_are_listed() {
    let folder = with_holes();
    let table = folder.succeed(&["holes", "in.ply"]);
    assert_eq!(table.lines().count(), 3, "{table}");
    assert_eq!(table.matches("  hole").count(), 2, "{table}");
    let report: Value =
        serde_json::from_str(&folder.succeed(&["holes", "in.ply", "--json"])).unwrap();
    let loops = report["loops"].as_array().unwrap();
    assert_eq!(loops.len(), 2);
    assert_eq!((&loops[0]["id"], &loops[1]["id"]), (&1.into(), &2.into()));
    assert_eq!(loops[0]["kind"], "hole");
    let number = |i: usize, name: &str| loops[i][name].as_f64().unwrap();
    assert!(number(0, "span") > number(1, "span") && number(1, "span_spacings") > 2.5);
    assert!((200.0..400.0).contains(&number(0, "turning_degrees")));

    let closed = Folder::with_sample("torus", "500");
    assert!(closed.succeed(&["holes", "in.ply"]).contains("no loops"));
}

#[test]
fn fill_adds_points_and_tags_them() {
    let folder = with_holes();
    let summary = folder.succeed(&["fill", "in.ply", "-o", "out.ply"]);
    assert!(summary.contains("holes    2 filled"), "{summary}");
    let (input, output) = (folder.points("in.ply"), folder.points("out.ply"));
    assert_eq!(output.positions[..input.len()], input.positions);
    assert_eq!(output.normals[..input.len()], input.normals);
    let tags = tags(&output);
    assert!(tags[..input.len()].iter().all(|&tag| tag == 0));
    assert!(tags[input.len()..].iter().all(|&tag| tag == 1 || tag == 2));
    folder.succeed(&["fill", "in.ply", "-o", "two.ply", "--fill-holes", "2", "--quiet"]);
    let two = folder.points("two.ply");
    assert!(input.len() < two.len() && two.len() < output.len());
    let json = ["fill", "in.ply", "-o", "out.ply", "--json", "--fill-holes", "max-span=0.95"];
    let report: Value = serde_json::from_str(&folder.succeed(&json)).unwrap();
    assert_eq!(report["holes"].as_array().unwrap().len(), 1);
    assert_eq!(report["holes"][0]["id"], 2);
    let filled = report["holes"][0]["points"].as_u64().unwrap() as usize;
    assert_eq!(report["points_out"].as_u64().unwrap() as usize, input.len() + filled);
    assert_eq!(filled, two.len() - input.len());
}

#[test]
fn nothing_to_fill_is_said() {
    let folder = Folder::with_sample("plane", "400");
    let summary = folder.succeed(&["fill", "in.ply", "-o", "out.ply"]);
    assert!(summary.contains("nothing to fill"), "{summary}");
    assert_eq!(folder.points("out.ply"), folder.points("in.ply"));
}

#[test]
fn unknown_ids_are_refused() {
    let folder = with_holes();
    folder.fail(
        &["fill", "in.ply", "-o", "out.ply", "--fill-holes", "1,9"],
        "in.ply: there is no loop 9: they are 1 to 2",
    );
    for wrong in ["some", "1,,2", "max-span=0", "max-span=nan", "-1"] {
        let choice = format!("--fill-holes={wrong}");
        let output = folder.run(&["fill", "in.ply", "-o", "out.ply", &choice]);
        assert_eq!(output.status.code(), Some(2), "{wrong}");
    }
    folder.fail(&["fill", "in.ply", "-o", "in.ply"], "is the input too");
}

#[test]
fn refine_fills_first_where_it_is_asked_to() {
    let folder = with_holes();
    let report = folder.refine_json(&["--levels", "1"]);
    assert_eq!(report["holes"], Value::Array(Vec::new()));
    assert!(folder.points("out.ply").attribute("hole").is_none());
    let report = folder.refine_json(&["--levels", "1", "--fill-holes", "all"]);
    assert_eq!(report["holes"].as_array().unwrap().len(), 2);
    let fill: u64 =
        report["holes"].as_array().unwrap().iter().map(|h| h["points"].as_u64().unwrap()).sum();
    assert_eq!(
        report["points_in"].as_u64().unwrap() + fill,
        report["levels"][0]["points_in"].as_u64().unwrap()
    );
    let output = folder.points("out.ply");
    // Refined points have the tags of their corners.
    let tagged = tags(&output).iter().filter(|&&tag| tag > 0).count();
    assert!(tagged > 2 * fill as usize, "{tagged} of {fill}");
    let lowest = output.positions.iter().map(|x| (*x - Vec3::Z).length()).fold(1.0, f32::min);
    assert!(lowest < 0.06, "the pole is {lowest} from the next point");
}

#[test]
fn raised_radii_are_taken_for_a_wish_to_fill() {
    let folder = with_holes();
    let natural = folder.points("in.ply");
    let mut raised = natural.clone();
    for (x, r) in raised.positions.iter().zip(&mut raised.radii) {
        if x.z > 0.7 {
            *r = 1.3;
        }
    }
    write(&folder, &raised);
    let report = folder.refine_json(&["--levels", "1"]);
    assert_eq!(report["holes"][0]["id"], 1);
    assert_eq!(report["holes"].as_array().unwrap().len(), 1);
    assert!(report["notes"].to_string().contains("natural again"), "{}", report["notes"]);
    for kept in [["--fill-holes", "none"].as_slice(), &["--literal"]] {
        let report = folder.refine_json(&[&["--levels", "0"], kept].concat());
        assert_eq!(report["holes"], Value::Array(Vec::new()));
        assert_eq!(folder.points("out.ply"), raised, "{kept:?}");
    }
}
