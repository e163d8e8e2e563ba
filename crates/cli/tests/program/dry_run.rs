//! `surfine refine --dry-run`.

use crate::folder::{Folder, text};
use serde_json::Value;
use surfine_points::ply;

const DRY: [&str; 5] = ["refine", "in.ply", "-o", "out.ply", "--dry-run"];
const ON_CPU: [&str; 2] = ["--backend", "cpu"];

/// What a dry run on the CPU tells.
fn dry(folder: &Folder, more: &[&str]) -> Value {
    let args = [&DRY[..], &ON_CPU, &["--json"], more].concat();
    serde_json::from_str(&folder.succeed(&args)).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Whether the ratio of two numbers is 1, within a tolerance.
fn is_near(a: f64, b: f64, tolerance: f64) -> bool {
    (a / b - 1.0).abs() < tolerance
}

#[test]
fn points_and_file_are_foretold() {
    let folder = Folder::with_sample("sphere", "500");
    for more in
        [&["--levels", "2"][..], &["--provenance"], &["--ascii"], &["--ascii", "--provenance"]]
    {
        let foretold = dry(&folder, more);
        assert_eq!(folder.names(), ["in.ply"]);
        assert_eq!(foretold["points_by_level"], Value::from(vec![500, 1496, 4484]));
        assert_eq!((&foretold["fits"], &foretold["why"]), (&"yes".into(), &Value::Null));
        let found = folder.refine_json(more);
        assert!(is_near(number(&found["points_out"]), 4484.0, 0.03), "{found}");
        let (size, foretold) =
            (folder.bytes("out.ply").len() as f64, number(&foretold["output_bytes"]));
        assert!(is_near(size, foretold, 0.06), "{more:?}: {size} bytes, {foretold} foretold");
        std::fs::remove_file(folder.path("out.ply")).unwrap();
    }
    assert_eq!(dry(&folder, &["--levels", "0"])["points_by_level"], Value::from(vec![500]));
}

#[test]
fn size_of_binary_files_is_exact_for_so_many_points() {
    let folder = Folder::with_sample("torus", "300");
    folder.refine(&["--provenance"]);
    let (points, source) = ply::read(&folder.path("out.ply")).unwrap();
    let count = points.len() as u64;
    let size = ply::file_size(&points, count, false, &source, ply::Encoding::Binary).unwrap();
    assert_eq!(size, folder.bytes("out.ply").len() as u64);
}

#[test]
fn report_tells_memory_time_and_file() {
    let folder = Folder::with_sample("torus", "400");
    let report = folder.succeed(&[&DRY[..], &ON_CPU, &["--threads", "2"]].concat());
    for part in [
        "nothing is written",
        "in.ply: 400 points",
        "cpu, threads: 2",
        "level 2  about 3584 points",
        "1.0 MB on the host, ",
        "at the pace of a sphere",
        "out.ply: about 100",
        "fits     yes",
    ] {
        assert!(report.contains(part), "no `{part}` in:\n{report}");
    }
    assert_eq!(folder.names(), ["in.ply"]);
    assert_eq!(folder.succeed(&[&DRY[..], &ON_CPU, &["--quiet"]].concat()), "");
    let report = dry(&folder, &["--levels", "3"]);
    assert!(report["dry_run"] == true && report["memory"]["device"].is_null(), "{report}");
    assert!(number(&report["seconds"]) > 0.0 && number(&report["pace"]["seconds"]) > 0.0);
}

/// Needs an adapter; a software one will do.
#[test]
fn memory_of_the_device_is_foretold() {
    let folder = Folder::with_sample("ellipsoid", "2000");
    let args = [&DRY[..], &["--backend", "gpu", "--json"]].concat();
    let foretold: Value = serde_json::from_str(&folder.succeed(&args)).unwrap();
    assert_eq!((&foretold["backend"], folder.names()), (&"gpu".into(), vec!["in.ply".into()]));
    let refine = ["refine", "in.ply", "-o", "out.ply", "--backend", "gpu", "--json"];
    let found: Value = serde_json::from_str(&folder.succeed(&refine)).unwrap();
    let device = &foretold["memory"]["device"];
    let (bytes, found) = (number(&device["bytes"]), number(&found["device_bytes"]));
    assert!(is_near(found, bytes, 0.1), "{found} bytes, {bytes} foretold");
    assert!(number(&device["largest_buffer_bytes"]) < number(&device["largest_allowed_bytes"]));
    let report = folder.succeed(&[&DRY[..], &["--backend", "gpu"]].concat());
    for part in ["on the device", "largest buffer: ", "the adapter allows "] {
        assert!(report.contains(part), "no `{part}` in:\n{report}");
    }
}

/// Where the system tells how much memory there is.
#[cfg(target_os = "linux")]
#[test]
fn what_will_probably_not_fit_is_said() {
    let folder = Folder::with_sample("sphere", "500");
    let args = [&DRY[..], &ON_CPU, &["--levels", "20"]].concat();
    let report = folder.succeed(&args);
    assert!(report.contains("fits     unlikely: it would take about "), "{report}");
    assert!(report.contains("use fewer levels or split the cloud"), "{report}");
    let report = dry(&folder, &["--levels", "20"]);
    assert!(report["fits"] == "unlikely" && report["why"].is_string(), "{report}");
}

#[test]
fn what_a_refinement_refuses_is_refused() {
    let folder = Folder::with_sample("torus", "300");
    let dry = [&DRY[..], &ON_CPU].concat();
    folder.fail(&[&dry[..], &["--boundary-property", "rim"]].concat(), "no property rim");
    folder.fail(&[&dry[..], &["--attribute", "hue=vote"]].concat(), "no property hue");
    folder.fail(&[&dry[..], &["--fill-holes", "99"]].concat(), "99");
    folder.fail(&["refine", "in.ply", "-o", "in.ply", "--dry-run"], "is the input too");
    folder.fail(&["refine", "in.ply", "-o", "no/out.ply", "--dry-run"], "is no folder");
    folder.fail(&["refine", "no.ply", "-o", "out.ply", "--dry-run"], "no.ply: cannot be read");
    let noop = |more: &[&str]| {
        let args = [&DRY[..], more].concat();
        let output = folder.command(&args).env("WGPU_BACKEND", "noop").output().unwrap();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    let (code, _, complaint) = noop(&["--backend", "gpu"]);
    assert!(code == Some(1) && complaint.contains("no GPU adapter found"), "{complaint}");
    let (code, report, complaint) = noop(&[]);
    assert!(code == Some(0) && report.contains("note     using the CPU"), "{complaint}{report}");
}
