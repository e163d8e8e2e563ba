//! `surfine refine`, `adapters` and `sample`.

use crate::folder::{Folder, text};
use serde_json::Value;
use std::fs;
use std::process::Stdio;
use surfine_points::{Values, Vec3};

const CORE: &str = "property float x\nproperty float y\nproperty float z\nproperty float nx\n\
    property float ny\nproperty float nz\nproperty float radius\n";

/// The lines of a triangle.
const TINY: [&str; 3] = ["0 0 0 0 0 1 2\n", "1 0 0 0 0 1 2\n", "0 1 0 0 0 1 2\n"];

/// An ASCII file of points with the usual properties.
fn ascii(count: usize, rows: &str) -> String {
    format!("ply\nformat ascii 1.0\nelement vertex {count}\n{CORE}end_header\n{rows}")
}

/// A file of three points of which the second has this line.
fn with_line(line: &str) -> String {
    ascii(3, &format!("0 0 0 0 0 1 2\n{line}\n0 1 0 0 0 1 2\n"))
}

/// A binary file of one point with the usual properties and more.
fn binary(more: &str, row: &[f32]) -> Vec<u8> {
    let format = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n";
    let mut bytes = format!("{format}{CORE}{more}end_header\n").into_bytes();
    bytes.extend(row.iter().flat_map(|v| v.to_le_bytes()));
    bytes
}

#[test]
fn sampled_cloud_is_refined() {
    let folder = Folder::with_sample("sphere", "500");
    let summary = folder.refine(&[]);
    let (input, output) = (folder.points("in.ply"), folder.points("out.ply"));
    assert_eq!(input.len(), 500);
    assert!((8 * 500..10 * 500).contains(&output.len()), "{} points", output.len());
    assert!(output.positions.iter().all(|x| (x.length() - 1.0).abs() < 0.01));
    assert_eq!(folder.names(), ["in.ply", "out.ply"]);
    let count = format!("out.ply: {} points", output.len());
    for part in ["in.ply: 500 points", &count, "cpu", "level 2", "neighborhood", "a second"] {
        assert!(summary.contains(part), "no `{part}` in:\n{summary}");
    }
}

#[test]
fn input_points_come_first_and_unchanged() {
    let folder = Folder::with_sample("torus", "300");
    folder.refine(&[]);
    let (input, output) = (folder.points("in.ply"), folder.points("out.ply"));
    assert_eq!(output.positions[..300], input.positions);
    assert_eq!(output.normals[..300], input.normals);
}

#[test]
fn every_run_gives_the_same_bytes() {
    let folder = Folder::with_sample("torus", "400");
    folder.refine(&[]);
    let expected = folder.bytes("out.ply");
    folder.refine_to("again.ply", &[]);
    assert!(folder.bytes("again.ply") == expected, "a second run differs");
    for threads in ["1", "2"] {
        let args = ["refine", "in.ply", "-o", "threads.ply", "--backend", "cpu", "--json"];
        let output =
            folder.command(&args).env("RAYON_NUM_THREADS", threads).output().unwrap().stdout;
        let report: Value = serde_json::from_slice(&output).unwrap();
        assert_eq!(report["threads"].to_string(), threads);
        assert!(folder.bytes("threads.ply") == expected, "{threads} threads differ");
    }
    let report = folder.refine_json(&["--threads", "3"]);
    assert_eq!(report["threads"], 3);
    assert!(folder.bytes("out.ply") == expected, "3 threads differ");
}

#[test]
fn too_many_threads_of_the_environment_are_refused() {
    let folder = Folder::with_sample("sphere", "50");
    let run = |more: &[&str]| {
        let args = [&["refine", "in.ply", "-o", "out.ply", "--backend", "cpu"], more].concat();
        let output = folder.command(&args).env("RAYON_NUM_THREADS", "100000").output().unwrap();
        (output.status.code(), text(&output.stderr))
    };
    let (code, complaint) = run(&[]);
    assert!(code == Some(1) && complaint.contains("RAYON_NUM_THREADS is 100000"), "{complaint}");
    assert_eq!(run(&["--threads", "2"]), (Some(0), String::new()));
}

#[test]
fn samples_depend_on_their_arguments_alone() {
    let folder = Folder::new();
    let sample = |more: &[&str]| {
        folder.succeed(&[&["sample", "saddle", "-n", "200", "-o", "s.ply"], more].concat());
        folder.bytes("s.ply")
    };
    let first = sample(&[]);
    assert!(first == sample(&["--seed", "0"]));
    assert!(first != sample(&["--seed", "1"]));
    assert!(first != sample(&["--random"]));
    let decimal = sample(&["--ascii"]);
    assert!(decimal.starts_with(b"ply\nformat ascii 1.0\n"));
    let points = folder.points("s.ply");
    sample(&[]);
    assert_eq!(folder.points("s.ply"), points);
    for shape in ["sphere", "torus", "ellipsoid", "saddle", "plane"] {
        let summary = folder.succeed(&["sample", shape, "-n", "50", "-o", "s.ply"]);
        assert!(summary.contains("50 points") && summary.contains(shape), "{summary}");
        assert_eq!(folder.points("s.ply").len(), 50);
    }
}

#[test]
fn json_adds_up() {
    let folder = Folder::with_sample("ellipsoid", "400");
    let report = folder.refine_json(&["--levels", "3", "--theta-f", "45"]);
    let count = |value: &Value| value.as_u64().unwrap();
    assert_eq!(report["input"], "in.ply");
    assert_eq!(report["output"], "out.ply");
    assert_eq!(report["backend"], "cpu");
    assert_eq!(report["adapter"], Value::Null);
    assert_eq!(report["mode"], "exact");
    assert_eq!(report["params"]["levels"], 3);
    assert_eq!(report["params"]["neighborhood"], "accurate");
    assert_eq!(report["params"]["theta_f_degrees"], 45.0);
    assert_eq!(report["params"]["theta_c_degrees"], 89.0);
    assert_eq!(report["points_in"], 400);
    assert_eq!(count(&report["points_out"]) as usize, folder.points("out.ply").len());
    assert_eq!(report["notes"], Value::Array(Vec::new()));

    let levels = report["levels"].as_array().unwrap();
    assert_eq!(levels.len(), 3);
    let mut points = 400;
    let mut ms = 0.0;
    for level in levels {
        assert_eq!(count(&level["points_in"]), points);
        let growth = count(&level["points_out"]) as f64 / points as f64;
        assert!((level["growth"].as_f64().unwrap() - growth).abs() < 1e-12);
        let mean = |name: &str| level[name].as_f64().unwrap();
        assert!(mean("ball_neighbors_mean") >= mean("ring_neighbors_mean"));
        assert!((5.0..7.0).contains(&mean("ring_neighbors_mean")));
        // Only the paper's loop has classes.
        assert_eq!(level["classes"], 0);
        assert_eq!(level["isolated"], 0);
        let stages = level["stages_ms"].as_object().unwrap();
        // Boundaries are looked for in the input alone.
        assert_eq!(stages.len(), if points == 400 { 7 } else { 6 });
        ms += stages.values().map(|t| t.as_f64().unwrap()).sum::<f64>();
        points = count(&level["points_out"]);
    }
    assert_eq!(count(&report["points_out"]), points);
    let seconds = |step: &str| report["seconds"][step].as_f64().unwrap();
    assert!(seconds("refine") * 1e3 >= ms, "stages took longer than the whole");
    assert!(seconds("read") > 0.0 && seconds("setup") >= 0.0 && seconds("write") > 0.0);
    let speed = (points - 400) as f64 / seconds("refine");
    assert!((report["points_per_second"].as_f64().unwrap() / speed - 1.0).abs() < 1e-6);
}

#[test]
fn stats_show_how_levels_converge() {
    let folder = Folder::with_sample("ellipsoid", "400");
    assert!(folder.refine_json(&[]).get("stats").is_none());
    let report = folder.refine_json(&["--levels", "3", "--stats"]);
    let levels = report["stats"].as_array().unwrap();
    assert_eq!(levels.len(), 4);
    assert_eq!(
        (&levels[0]["points"], &levels[0]["radius_ratio"]["mean"]),
        (&400.into(), &1.0.into())
    );
    assert_eq!(levels[3]["points"], report["points_out"]);
    for pair in levels.windows(2) {
        for measure in ["radius", "radius_ratio", "co_cone_degrees"] {
            for kind in ["median", "mean", "max"] {
                let value = |level: &Value| level[measure][kind].as_f64().unwrap();
                assert!(value(&pair[1]) < value(&pair[0]), "{measure} {kind}: {levels:?}");
            }
        }
    }
    let args =
        ["refine", "in.ply", "-o", "out.ply", "--backend", "cpu", "--levels", "3", "--stats"];
    let summary = folder.succeed(&args);
    let row = summary.lines().find(|line| line.trim_start().starts_with("3 ")).unwrap();
    let columns: Vec<&str> = row.split_whitespace().collect();
    let angle = levels[3]["co_cone_degrees"]["median"].as_f64().unwrap();
    assert_eq!((columns.len(), columns[8]), (11, &*format!("{angle:.3}")), "{summary}");
}

#[test]
fn options_reach_the_refinement() {
    let folder = Folder::with_sample("torus", "300");
    folder.refine(&[]);
    let usual = folder.bytes("out.ply");
    let options: [&[&str]; 9] = [
        &["--literal"],
        &["--without", "next_ring"],
        &["--without", "largest_first"],
        &["--levels", "1"],
        &["--neighborhood", "fuzzy"],
        &["--simplified"],
        &["--theta-f", "80"],
        &["--lambda1", "0.9"],
        &["--lambda2", "0.9"],
    ];
    for more in options {
        folder.refine(more);
        assert!(folder.bytes("out.ply") != usual, "{more:?} changes nothing");
    }
    // The paper's loop has parameters of its own, which ask for it.
    folder.refine(&["--theta-c", "89"]);
    let paper_loop = folder.bytes("out.ply");
    folder.refine(&["--without", "largest_first"]);
    assert!(folder.bytes("out.ply") == paper_loop, "--theta-c asks for the paper's loop");
    for more in [["--theta-c", "60"], ["--plain-angle", "--quiet"]] {
        folder.refine(&more);
        assert!(folder.bytes("out.ply") != paper_loop, "{more:?} changes nothing");
    }
    let report = folder.refine_json(&["--literal"]);
    let levels = report["levels"].as_array().unwrap();
    assert!(levels.iter().all(|level| level["classes"].as_u64().unwrap() > 0), "{report}");
    let report = folder.refine_json(&["--simplified"]);
    assert_eq!(report["params"]["neighborhood"], "fuzzy");
    assert_eq!(report["params"]["simplified"], true);
}

#[test]
fn rules_in_effect_are_reported() {
    let folder = Folder::with_sample("torus", "50");
    let rules = |more: &[&str]| {
        let report = folder.refine_json(more);
        let rules = report["params"]["rules"].as_array().unwrap().clone();
        rules.iter().map(|rule| rule.as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    let usual = rules(&[]);
    let without = |names: &[&str]| {
        let mut rest = usual.clone();
        rest.retain(|rule| !names.contains(&rule.as_str()));
        rest
    };
    // The selection among all candidates has no use for radii, nor for gaps.
    assert!(usual.len() == 13 && without(&["first_radii", "curve_bounds"]) == usual, "{usual:?}");
    let irregular = ["natural_neighbors", "sure_neighbors", "next_ring"];
    assert_eq!(rules(&["--simplified"]), without(&irregular));
    let two = ["--without", "own_side", "--without", "next_ring"];
    assert_eq!(rules(&two), without(&["own_side", "next_ring"]));
    assert_eq!(rules(&["--without", "natural_neighbors"]), without(&irregular[..2]));
    let paper_loop = rules(&["--without", "largest_first"]);
    assert!(paper_loop.len() == 14 && paper_loop.contains(&"first_radii".into()), "{paper_loop:?}");
    assert_eq!(rules(&["--plain-angle"]), paper_loop);
    assert!(rules(&["--literal"]).is_empty());
}

#[test]
fn attribute_rules_come_from_the_command_line() {
    let rows = "0 0 0 0 0 1 2 5 1 0 0\n1 0 0 0 0 1 2 7 0 1 0\n0 1 0 0 0 1 2 7 0 0 1\n";
    let more = "property uchar label\nproperty float tx\nproperty float ty\nproperty float tz\n";
    let folder =
        Folder::with_input(ascii(3, rows).replace("end_header", &format!("{more}end_header")));
    let refined = |rules: &[&str]| {
        let rules: Vec<&str> = rules.iter().flat_map(|rule| ["--attribute", rule]).collect();
        folder.refine(&[&["--levels", "1"], &rules[..]].concat());
        let points = folder.points("out.ply");
        let Some(Values::U8(labels)) = points.attribute("label").map(|a| &a.values) else {
            panic!("no label")
        };
        let Some(Values::F32(tx)) = points.attribute("tx").map(|a| &a.values) else {
            panic!("no tx")
        };
        (labels[3], tx[3])
    };
    assert_eq!(refined(&[]), (7, 1.0 / 3.0));
    assert_eq!(refined(&["label=linear"]).0, 6);
    let unit = refined(&["tx,ty,tz=unit"]).1;
    assert!((unit - 1.0 / 3f32.sqrt()).abs() < 1e-6, "{unit}");
    let fail = |rule: &str, part: &str| {
        folder.fail(&["refine", "in.ply", "-o", "new.ply", "--attribute", rule], part);
    };
    fail("tint=vote", "no property tint");
    fail("label,tx,ty=unit", "no direction");
    for wrong in ["label", "label=", "label=mean", "tx,ty=unit", ",=vote"] {
        let output = folder.run(&["refine", "in.ply", "-o", "new.ply", "--attribute", wrong]);
        assert_eq!(output.status.code(), Some(2), "{wrong}: {}", text(&output.stderr));
    }
}

#[test]
fn decimal_output_holds_the_same_points() {
    let folder = Folder::with_sample("sphere", "100");
    folder.refine(&[]);
    folder.refine_to("decimal.ply", &["--ascii"]);
    assert!(folder.bytes("decimal.ply").starts_with(b"ply\nformat ascii 1.0\n"));
    assert_eq!(folder.points("decimal.ply"), folder.points("out.ply"));
}

#[test]
fn provenance_is_written() {
    let folder = Folder::with_sample("sphere", "100");
    folder.refine(&["--provenance"]);
    let points = folder.points("out.ply");
    let values = |name: &str| &points.attribute(name).unwrap().values;
    let Values::U8(levels) = values("level") else { panic!("no bytes") };
    assert_eq!(levels[..100], [0; 100]);
    assert!(levels.is_sorted() && levels.ends_with(&[2]));
    for name in ["parent0", "parent1", "parent2"] {
        let Values::I32(parents) = values(name) else { panic!("no integers") };
        assert_eq!(parents[..100], [-1; 100]);
        assert!((100..).zip(&parents[100..]).all(|(i, &parent)| (0..i).contains(&parent)));
    }
}

#[test]
fn quiet_says_nothing() {
    let folder = Folder::with_sample("sphere", "100");
    assert_eq!(folder.refine(&["--quiet"]), "");
}

#[test]
fn special_points_are_reported() {
    let rows = "0 0 0 0 0 2 2\n1 0 0 0 0 1 2\n0 1 0 0 0 1 2\n90 0 0 0 0 3 2\n";
    let vertices = ascii(4, rows);
    let face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let bytes = vertices.replace("end_header\n", face) + "3 0 1 2\n";
    let folder = Folder::with_input(bytes);
    let report = folder.refine_json(&["--levels", "1"]);
    let notes: Vec<&str> =
        report["notes"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
    let parts = ["`face` element", "2 normals are not of unit length", "level 1: 1 point has no"];
    assert_eq!(notes.len(), parts.len(), "{notes:?}");
    for (note, part) in notes.iter().zip(parts) {
        assert!(note.contains(part), "no `{part}` in: {note}");
    }
    assert_eq!(report["levels"][0]["isolated"], 1);
    let summary = folder.refine(&["--levels", "1"]);
    assert!(notes.iter().all(|note| summary.contains(note)), "{summary}");
}

#[test]
fn zero_levels_copy() {
    let folder = Folder::with_sample("sphere", "100");
    let report = folder.refine_json(&["--levels", "0"]);
    assert!(folder.bytes("out.ply") == folder.bytes("in.ply"));
    assert_eq!(report["levels"], Value::Array(Vec::new()));
    assert_eq!(report["points_per_second"], 0.0);
}

#[test]
fn tiny_clouds_work() {
    for count in 0..=3 {
        let folder = Folder::with_input(ascii(count, &TINY[..count].concat()));
        let report = folder.refine_json(&[]);
        let output = folder.points("out.ply");
        assert_eq!(report["points_in"], count);
        assert_eq!(report["points_out"], output.len());
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        assert_eq!(output.positions[..count], corners[..count]);
        let sample = folder.succeed(&["sample", "torus", "-n", &count.to_string(), "-o", "s.ply"]);
        assert!(sample.contains(&format!("{count} points")), "{sample}");
        assert_eq!(folder.points("s.ply").len(), count);
    }
}

#[test]
fn bad_files_are_refused() {
    let good = ascii(1, "0 0 0 0 0 1 2\n");
    let without = |name: &str| {
        let line = format!("property float {name}\n");
        assert!(good.contains(&line));
        good.replace(&line, "")
    };
    let cases = [
        (String::new(), "header line 1: the file is empty"),
        ("solid\n".into(), "header line 1: the file does not begin with a line `ply`"),
        (
            "ply\nformat ascii 1.0\nelement vertex 1\n".into(),
            "header line 4: the file ends before `end_header`",
        ),
        (ascii(3, "0 0 0 0 0 1 2\n"), "element `vertex`: the header promises 3 entries"),
        (without("nz"), "element `vertex` has no `nz`: add normals"),
        (without("radius"), "element `vertex` has no `radius`: add a property `radius`"),
        (without("x"), "element `vertex` has no `x`: add the coordinates"),
        (with_line("nan 0 0 0 0 1 2"), "vertex 1: line 13: property `x`: `nan`"),
        (with_line("1 0 0 0 0 0 2"), "vertex 1: the normal has length 0"),
        (with_line("1 0 0 0 0 1 0"), "vertex 1: the radius is 0"),
        (with_line("1 0 0 0 0 1 -2"), "vertex 1: the radius is -2"),
        (with_line("1 0 0 0 0 1 inf"), "vertex 1: line 13: property `radius`: `inf`"),
        (with_line("1.000 0 0 0 0 1"), "vertex 1: line 13: the line has 6 values for 7 properties"),
        (with_line("1 0 0 0 0 1 two"), "vertex 1: line 13: property `radius`: `two`"),
    ];
    for (bytes, part) in cases {
        let folder = Folder::with_input(bytes);
        folder.fail(&["refine", "in.ply", "-o", "out.ply"], &format!("in.ply: {part}"));
    }
}

#[test]
fn bad_values_are_refused() {
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let cases = [
        ([nan, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0], "a coordinate is not finite (NaN)"),
        ([0.0, -inf, 0.0, 0.0, 0.0, 1.0, 2.0], "a coordinate is not finite (-inf)"),
        ([1e20, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0], "coordinate 1e20 is beyond"),
        ([0.0, 0.0, 0.0, 0.0, 0.0, nan, 2.0], "a normal component is not finite (NaN)"),
        ([0.0, 0.0, 0.0, 0.0, 0.0, -0.0, 2.0], "the normal has length 0"),
        ([0.0, 0.0, 0.0, 0.0, 0.0, 1.0, nan], "the radius is not finite (NaN)"),
        ([0.0, 0.0, 0.0, 0.0, 0.0, 1.0, inf], "the radius is not finite (inf)"),
        ([0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0], "the radius is 0"),
        ([0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0], "the radius is -1"),
    ];
    for (row, part) in cases {
        let folder = Folder::with_input(binary("", &row));
        folder.fail(&["refine", "in.ply", "-o", "out.ply"], &format!("in.ply: vertex 0: {part}"));
    }
}

#[test]
fn cut_binary_file_is_refused() {
    let folder = Folder::with_sample("sphere", "50");
    let bytes = folder.bytes("in.ply");
    fs::write(folder.path("in.ply"), &bytes[..bytes.len() - 5]).unwrap();
    let part = "in.ply: element `vertex`: the header promises 50 entries, the file ends after 49";
    folder.fail(&["refine", "in.ply", "-o", "out.ply"], part);
}

#[test]
fn bad_inputs_are_refused() {
    let folder = Folder::new();
    folder.fail(&["refine", "in.ply", "-o", "out.ply"], "in.ply: cannot be read: ");
    fs::create_dir(folder.path("folder")).unwrap();
    folder.fail(&["refine", "folder", "-o", "out.ply"], "folder: is not a regular file");
    folder.fail(&["refine", "two\nlines", "-o", "out.ply"], "two lines: cannot be read: ");
    folder.fail(&["refine", "\x1b[31mred", "-o", "out.ply"], "error:  [31mred: cannot be read: ");
}

#[test]
fn bad_outputs_are_refused_before_reading() {
    // If this was read, the message would be about it.
    let folder = Folder::with_input("no PLY file");
    fs::create_dir(folder.path("folder")).unwrap();
    let cases = [
        ("no/out.ply", "no/out.ply: cannot be written: no is no folder"),
        ("in.ply/out.ply", "in.ply/out.ply: cannot be written: in.ply is no folder"),
        ("folder", "folder: is not a regular file: name a file"),
        ("new/", "new/: is not a regular file: name a file"),
    ];
    for (output, part) in cases {
        folder.fail(&["refine", "in.ply", "-o", output], part);
        folder.fail(&["sample", "sphere", "-n", "9", "-o", output], part);
    }
    let long = format!("{}.ply", "x".repeat(300));
    folder.fail(&["refine", "in.ply", "-o", &long], ".ply: cannot be written: ");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("loop.ply", folder.path("loop.ply")).unwrap();
        folder.fail(&["refine", "in.ply", "-o", "loop.ply"], "loop.ply: cannot be written: ");
    }
    fs::write(folder.path("kept.ply"), "kept").unwrap();
    let mut permissions = fs::metadata(folder.path("kept.ply")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(folder.path("kept.ply"), permissions).unwrap();
    folder.fail(&["refine", "in.ply", "-o", "kept.ply"], "kept.ply: cannot be written: ");
    assert_eq!(folder.bytes("kept.ply"), b"kept");
}

/// Not even a superuser can write there.
#[cfg(target_os = "linux")]
#[test]
fn unwritable_folder_is_refused_before_reading() {
    let folder = Folder::with_input("no PLY file");
    let part = "/proc/out.ply: cannot be written: ";
    folder.fail(&["refine", "in.ply", "-o", "/proc/out.ply"], part);
}

#[test]
fn output_must_not_be_the_input() {
    let folder = Folder::with_input("no PLY file");
    let mut outputs = vec!["in.ply", "./in.ply"];
    fs::hard_link(folder.path("in.ply"), folder.path("hard.ply")).unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("in.ply", folder.path("soft.ply")).unwrap();
        outputs.extend(["hard.ply", "soft.ply"]);
    }
    for output in outputs {
        let part = format!("{output}: is the input too");
        folder.fail(&["refine", "in.ply", "-o", output], &part);
    }
    assert_eq!(folder.bytes("in.ply"), b"no PLY file");
}

#[test]
fn attributes_that_cannot_be_written_are_refused() {
    let bytes = |name: &str, value: f32| {
        let row = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, value];
        binary(&format!("property float {name}\n"), &row)
    };
    let refine = ["refine", "in.ply", "-o", "out.ply"];
    let folder = Folder::with_input(bytes("parent1", 5.0));
    let part = "in.ply: property `parent1` cannot be written: the name is taken";
    folder.fail(&[&refine[..], &["--provenance"]].concat(), part);
    folder.refine(&[]);
    let folder = Folder::with_input(bytes("curvature", f32::NAN));
    let part = "in.ply: property `curvature` cannot be written: vertex 0 has no finite value";
    folder.fail(&[&refine[..], &["--ascii"]].concat(), part);
    folder.refine(&[]);
}

#[test]
fn failure_keeps_an_earlier_output() {
    let folder = Folder::with_input("no PLY file");
    fs::write(folder.path("out.ply"), "earlier").unwrap();
    folder.fail(&["refine", "in.ply", "-o", "out.ply"], "in.ply: ");
    assert_eq!(folder.bytes("out.ply"), b"earlier");
}

#[test]
fn wrong_usage_exits_with_2() {
    let folder = Folder::with_sample("sphere", "20");
    let refine = ["refine", "in.ply", "-o", "out.ply"];
    let wrong: [&[&str]; 26] = [
        &["--without", "rules"],
        &["--literal", "--without", "next_ring"],
        &["--levels", "21"],
        &["--levels", "-1"],
        &["--levels", "two"],
        &["--backend", "tpu"],
        &["--backend", "cpu", "--adapter", "x"],
        &["--neighborhood", "k"],
        &["--theta-f", "0"],
        &["--theta-f", "90.1"],
        &["--theta-f", "nan"],
        &["--theta-c", "180"],
        &["--theta-c", "-3"],
        &["--lambda1", "0"],
        &["--lambda1", "1.1"],
        &["--lambda2", "-0.1"],
        &["--lambda2", "1.5"],
        &["--lambda2", "inf"],
        &["--lambda2", "half"],
        &["--threads", "0"],
        &["--threads", "x"],
        &["--adapter", ""],
        &["--boundary-property", ""],
        &["--provenance=1"],
        &["--no-such-option"],
        &["more.ply"],
    ];
    let mut commands: Vec<Vec<&str>> = wrong.map(|more| [&refine, more].concat()).to_vec();
    let sample = ["sample", "sphere", "-n"];
    commands.extend([
        vec![],
        vec!["paint"],
        vec!["refine", "in.ply"],
        vec!["refine", "-o", "out.ply"],
        vec!["sample", "cube", "-n", "9", "-o", "out.ply"],
        [&sample[..], &["-1", "-o", "out.ply"]].concat(),
        [&sample[..], &["1000000000", "-o", "out.ply"]].concat(),
        vec!["sample", "sphere", "-o", "out.ply"],
        vec!["adapters", "x"],
        vec!["bench", "--sizes", "99"],
        vec!["bench", "--sizes", "10k,,1M"],
        vec!["bench", "--sizes", "1k", "--input", "in.ply"],
        vec!["bench", "--runs", "0"],
        vec!["bench", "--levels", "0"],
        vec!["bench", "--backend", "cpu", "--adapter", "x"],
    ]);
    for args in commands {
        let output = folder.run(&args);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", text(&output.stderr));
        assert!(!output.stderr.is_empty() && output.stdout.is_empty(), "{args:?}");
        assert_eq!(folder.names(), ["in.ply"], "{args:?}");
    }
}

#[test]
fn help_has_examples() {
    let folder = Folder::new();
    let version = folder.succeed(&["--version"]);
    assert_eq!(version, concat!("surfine ", env!("CARGO_PKG_VERSION"), "\n"));
    let commands = [&["--help"][..], &["help", "refine"]];
    for command in
        [&commands[..], &[&["adapters", "-h"], &["bench", "-h"], &["sample", "-h"]]].concat()
    {
        let help = folder.succeed(command);
        let examples = help.split("Examples:\n").nth(1).expect("there are examples");
        assert!(examples.matches("surfine").count() >= 3, "{help}");
    }
}

#[test]
fn reader_that_leaves_is_no_failure() {
    let folder = Folder::with_sample("sphere", "300");
    let args = ["refine", "in.ply", "-o", "out.ply", "--backend", "cpu", "--json"];
    let mut command = folder.command(&args);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(text(&output.stderr), "");
    assert!(output.status.success());
    assert!(folder.path("out.ply").exists());
}

/// `auto` takes the CPU unless there is a hardware GPU, and says so.
#[test]
fn auto_says_why_it_takes_the_cpu() {
    let folder = Folder::with_sample("sphere", "100");
    let output = folder.run(&["refine", "in.ply", "-o", "out.ply", "--json"]);
    let (complaint, report) = (text(&output.stderr), text(&output.stdout));
    assert!(output.status.success(), "{complaint}");
    let report: Value = serde_json::from_str(&report).unwrap();
    if report["backend"] == "gpu" {
        assert_eq!(complaint, "");
    } else {
        let reason = complaint.strip_prefix("surfine: ").unwrap().strip_suffix('\n').unwrap();
        assert!(reason.starts_with("using the CPU: ") && !reason.contains('\n'), "{complaint}");
        assert_eq!(report["notes"][0], reason);
    }
}

/// A backend that the engine has no code for stands for a machine without a driver.
#[test]
fn missing_driver_is_named() {
    let folder = Folder::with_sample("sphere", "100");
    let run = |args: &[&str]| {
        let output = folder.command(args).env("WGPU_BACKEND", "noop").output().unwrap();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    let refine = ["refine", "in.ply", "-o", "out.ply", "--quiet", "--backend"];
    for args in [&["adapters"][..], &["adapters", "--json"], &[&refine[..], &["gpu"]].concat()] {
        let (code, out, complaint) = run(args);
        assert_eq!((code, out.as_str()), (Some(1), ""), "{args:?}: {complaint}");
        assert!(complaint.starts_with("surfine: error: no GPU adapter found: "), "{complaint}");
        assert!(complaint.contains("mesa-vulkan-drivers"), "{complaint}");
        assert_eq!(complaint.matches('\n').count(), 1, "{complaint}");
        assert_eq!(folder.names(), ["in.ply"]);
    }
    let (code, _, complaint) = run(&[&refine[..], &["auto"]].concat());
    assert_eq!(code, Some(0), "{complaint}");
    assert!(complaint.starts_with("surfine: using the CPU: no GPU adapter found"), "{complaint}");
    assert_eq!(folder.names(), ["in.ply", "out.ply"]);
}

/// Needs an adapter; a software one will do.
#[test]
fn gpu_gives_the_bytes_of_the_cpu() {
    let folder = Folder::with_sample("torus", "500");
    let list = folder.run(&["adapters", "--json"]);
    assert!(
        list.status.success(),
        "this test needs a Vulkan adapter: install the Debian package mesa-vulkan-drivers ({})",
        text(&list.stderr)
    );
    let list: Value = serde_json::from_slice(&list.stdout).unwrap();
    let entries = list["adapters"].as_array().unwrap();
    let chosen: Vec<&Value> = entries.iter().filter(|e| e["chosen"] == true).collect();
    assert_eq!(chosen.len(), 1, "{list}");
    let table = folder.succeed(&["adapters"]);
    assert!(table.contains(&format!("* {}", chosen[0]["name"].as_str().unwrap())), "{table}");

    folder.refine(&["--provenance"]);
    let refine = ["refine", "in.ply", "-o", "gpu.ply", "--provenance", "--json"];
    let report = folder.succeed(&[&refine[..], &["--backend", "gpu"]].concat());
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["backend"], "gpu");
    assert_eq!(report["adapter"], chosen[0]["name"]);
    assert_eq!(report["mode"], chosen[0]["mode"]);
    assert_eq!(report["mode"], "exact", "bytes are equal in exact mode only");
    assert!(folder.bytes("gpu.ply") == folder.bytes("out.ply"), "GPU and CPU differ");
    // The numbers of `--stats` are equal too, to the last digit.
    let gpu = folder.succeed(&[&refine[..], &["--backend", "gpu", "--stats"]].concat());
    let gpu: Value = serde_json::from_str(&gpu).unwrap();
    let cpu = folder.refine_json(&["--stats"]);
    assert!(gpu["stats"].is_array() && gpu["stats"] == cpu["stats"], "{gpu}");

    let part = "no GPU adapter is named like \"no such thing\"; there are: ";
    fs::remove_file(folder.path("gpu.ply")).unwrap();
    folder.fail(&[&refine[..], &["--adapter", "no such thing"]].concat(), part);

    for count in 0..=3 {
        fs::write(folder.path("in.ply"), ascii(count, &TINY[..count].concat())).unwrap();
        folder.refine(&["--provenance"]);
        folder.succeed(&[&refine[..], &["--backend", "gpu"]].concat());
        assert!(folder.bytes("gpu.ply") == folder.bytes("out.ply"), "{count} points differ");
    }
}

/// Needs an adapter, whose name is then given; a software one will do.
#[test]
fn adapter_that_the_environment_names_is_taken() {
    let folder = Folder::with_sample("sphere", "100");
    let json = |args: &[&str], name: &str| {
        let output = folder.command(args).env("WGPU_ADAPTER_NAME", name).output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    let list = json(&["adapters", "--json"], "");
    let name = list["adapters"][0]["name"].as_str().unwrap();
    assert_eq!(json(&["adapters", "--json"], name)["auto_backend"], "gpu");
    let report = json(&["refine", "in.ply", "-o", "out.ply", "--json"], name);
    assert_eq!((&report["backend"], &report["adapter"]), (&"gpu".into(), &name.into()));
}
