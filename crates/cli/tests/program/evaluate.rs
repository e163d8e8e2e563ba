//! `surfine evaluate`.

use crate::folder::{Folder, text};
use crate::render::MESH;
use serde_json::Value;

fn evaluate_json(folder: &Folder, args: &[&str]) -> Value {
    let printed = folder.succeed(&[&["evaluate", "--json", "--quiet"], args].concat());
    serde_json::from_str(&printed).unwrap()
}

#[test]
fn refined_sphere_is_measured() {
    let folder = Folder::with_sample("sphere", "300");
    folder.succeed(&["sample", "sphere", "-n", "20000", "--random", "-o", "truth.ply"]);
    folder.refine(&[]);
    let table =
        folder.succeed(&["evaluate", "out.ply", "--truth", "truth.ply", "--input", "in.ply", "-q"]);
    for part in [
        "distance to tangent planes",
        "spacings",
        "holes",
        "normal error",
        "nnCV",
        "Chamfer",
        "300 of 300",
    ] {
        assert!(table.contains(part), "no `{part}` in:\n{table}");
    }
    let json = evaluate_json(&folder, &["out.ply", "--truth", "truth.ply", "--input", "in.ply"]);
    assert_eq!(json["output"], "out.ply");
    assert_eq!(json["truth"], "truth.ply");
    let measures = &json["evaluation"];
    assert!(measures["distance"]["in_diagonals"]["mean"].as_f64().unwrap() < 1e-3);
    assert!(measures["normals"]["all"]["max"].as_f64().unwrap() < 5.0);
    assert_eq!(measures["survival"]["input_points"], 300);
    assert_eq!(folder.names(), ["in.ply", "out.ply", "truth.ply"]);
}

#[test]
fn changed_input_is_found() {
    let folder = Folder::with_sample("sphere", "100");
    folder.succeed(&["sample", "sphere", "-n", "100", "--seed", "1", "-o", "other.ply"]);
    folder.refine(&[]);
    let kept = |input: &str| {
        let args = ["out.ply", "--truth", "in.ply", "--input", input];
        evaluate_json(&folder, &args)["evaluation"]["survival"]["kept"].as_u64().unwrap()
    };
    assert_eq!((kept("in.ply"), kept("other.ply")), (100, 0));
}

#[test]
fn mesh_is_a_truth_and_an_output() {
    let folder = Folder::with_input(MESH);
    let json = evaluate_json(&folder, &["in.ply", "--truth", "in.ply", "--samples", "1000"]);
    let measures = &json["evaluation"];
    assert_eq!(measures["distance"]["absolute"]["max"], 0.0);
    assert_eq!(measures["coverage"]["samples"], 1000);
    assert!(!measures["normals"].is_null(), "a mesh has the normals of its triangles");
    let other = ["in.ply", "--truth", "in.ply", "--samples", "1000", "--seed", "1"];
    assert_ne!(evaluate_json(&folder, &other), json);
    // All dihedral angles of a tetrahedron are 109.5 degrees from flat.
    let sharp = |angle: &str| {
        let args = ["in.ply", "--truth", "in.ply", "--crease-angle", angle];
        evaluate_json(&folder, &args)["evaluation"]["truth"]["sharp_edges"].as_u64().unwrap()
    };
    assert_eq!((sharp("40"), sharp("120")), (6, 0));
}

#[test]
fn heatmap_is_drawn() {
    let folder = Folder::with_sample("torus", "200");
    folder.succeed(&["sample", "torus", "-n", "2000", "-o", "truth.ply"]);
    let args =
        ["evaluate", "in.ply", "--truth", "truth.ply", "--heatmap", "heat.png", "--size", "80x60"];
    folder.succeed(&[&args[..], &["--backend", "cpu", "-q"]].concat());
    assert_eq!(folder.names(), ["heat.png", "in.ply", "truth.ply"]);
    let y_up = folder.bytes("heat.png");
    folder.succeed(&[&args[..], &["--backend", "cpu", "-q", "--z-up"]].concat());
    assert_ne!(folder.bytes("heat.png"), y_up);
    // Refused before anything is read.
    let large = ["--size", "32768x9", "--heatmap", "heat.png", "--backend", "cpu"];
    folder.fail(&[&["evaluate", "none.ply", "--truth", "truth.ply"], &large[..]].concat(), "32768");
    assert!(folder.bytes("heat.png").starts_with(b"\x89PNG"));
    folder
        .fail(&["evaluate", "in.ply", "--truth", "truth.ply", "--heatmap", "heat.gif"], "heat.gif");
}

#[test]
fn unfit_files_are_named() {
    let folder = Folder::with_input(MESH);
    let empty = MESH.replace("vertex 4", "vertex 0").replace("face 4", "face 0");
    let header = &empty[..empty.find("end_header").unwrap() + "end_header\n".len()];
    std::fs::write(folder.path("empty.ply"), header).unwrap();
    folder.fail(&["evaluate", "in.ply", "--truth", "empty.ply"], "empty.ply");
    folder.fail(&["evaluate", "empty.ply", "--truth", "in.ply"], "empty.ply");
    folder.fail(&["evaluate", "none.ply", "--truth", "in.ply"], "none.ply");
    for wrong in [&["--crease-angle", "0"][..], &["--samples", "0"], &["--view", "top"]] {
        let output = folder.run(&[&["evaluate", "in.ply", "--truth", "in.ply"], wrong].concat());
        assert_eq!(output.status.code(), Some(2), "{wrong:?}: {}", text(&output.stderr));
    }
}

#[test]
fn what_is_not_measured_is_named() {
    let folder = Folder::with_sample("sphere", "100");
    let bare = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n\
        1 0 0 1 2 3\n0 1 0 1 2 3\n0 0 1 1 2 3\n";
    std::fs::write(folder.path("bare.ply"), bare).unwrap();
    let notes = |args: &[&str]| {
        let output = folder.run(&[&["evaluate"], args].concat());
        assert!(output.status.success());
        text(&output.stderr)
    };
    let found = notes(&["bare.ply", "--truth", "in.ply"]);
    for part in [
        "normal error not measured: OUT has no normals",
        "smoothness of normals not measured: OUT has no normals",
        "PU-GAN's uniformity not measured",
        "color error not measured: the truth has no uchar red, green and blue",
    ] {
        assert!(found.contains(part), "no `{part}` in {found}");
    }
    let found = notes(&["in.ply", "--truth", "bare.ply"]);
    for part in [
        "gaps along the surface not measured: the truth has no normals",
        "normal error not measured: the truth has no normals",
        "color error not measured: OUT has no uchar",
    ] {
        assert!(found.contains(part), "no `{part}` in {found}");
    }
    assert_eq!(notes(&["in.ply", "--truth", "bare.ply", "--quiet"]), "");
}

#[test]
fn made_normals_have_not_survived() {
    let folder = Folder::with_input(MESH);
    folder.succeed(&["sample", "sphere", "-n", "100", "-o", "cloud.ply"]);
    let args = ["in.ply", "--truth", "in.ply", "--input", "cloud.ply"];
    let json = evaluate_json(&folder, &args);
    assert_eq!(json["evaluation"]["survival"]["missing"], serde_json::json!(["nx", "ny", "nz"]));
}
