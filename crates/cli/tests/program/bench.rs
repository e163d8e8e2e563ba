//! `surfine bench`.

use crate::folder::{Folder, text};
use serde_json::Value;

/// Small enough for a test: 333 and 1000 points become about 3000 and 9000.
const SMALL: [&str; 7] = ["bench", "--sizes", "9k,3k", "--levels", "2", "--runs", "2"];

fn cpu(more: &[&str]) -> String {
    Folder::new().succeed(&[&SMALL[..], &["--backend", "cpu"], more].concat())
}

fn parse(report: &str) -> Value {
    serde_json::from_str(report).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// What every measured backend tells fits together.
fn check_side(case: &Value, side: &Value) {
    let seconds = |name: &str| number(&side["seconds"][name]);
    let (min, median, max) = (seconds("min"), seconds("median"), seconds("max"));
    assert!(0.0 < min && min <= median && median <= max, "{side}");
    let new = number(&case["points_out"]) - number(&case["points_in"]);
    let speed = number(&side["new_points_per_second"]);
    assert!((speed * median / new - 1.0).abs() < 1e-6, "{side}");
    let stages = side["stages_ms"].as_object().unwrap();
    assert_eq!(stages.len(), 7, "{side}");
    let ms = stages.values().map(number).sum::<f64>() + number(&side["outside_ms"]);
    assert!((ms / (1e3 * median) - 1.0).abs() < 0.01, "{side}");
}

#[test]
fn tables_show_each_size_and_stage() {
    let table = cpu(&["--threads", "2"]);
    let rows: Vec<Vec<&str>> = table
        .lines()
        .map(|line| line.split_whitespace().collect())
        .filter(|row: &Vec<&str>| row.get(2) == Some(&"cpu"))
        .collect();
    let points_in: Vec<&str> = rows.iter().map(|row| row[0]).collect();
    assert_eq!(points_in, ["333", "1000"], "{table}");
    for part in ["2 levels", "threads: 2", "median of 2", "M new points/s", "not compared"] {
        assert!(table.contains(part), "no `{part}` in:\n{table}");
    }
    let stages = table.split("stages from 1000").nth(1).expect("the largest size has stages");
    for stage in ["neighborhood", "selection", "outside", "whole run"] {
        assert!(stages.contains(stage), "no `{stage}` in:\n{table}");
    }
    assert!(!table.contains("left out") && !table.contains("gpu  "), "{table}");
}

#[test]
fn json_adds_up() {
    let report = parse(&cpu(&["--json"]));
    assert_eq!((&report["gpu"], &report["runs"]), (&Value::Null, &2.into()));
    assert!(number(&report["cpu"]["threads"]) >= 1.0);
    let cases = report["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 2);
    for (case, size) in cases.iter().zip([3_000, 9_000]) {
        assert_eq!(case["size"], size);
        assert!((number(&case["points_out"]) / f64::from(size) - 1.0).abs() < 0.05, "{case}");
        check_side(case, &case["cpu"]);
        assert_eq!(case["cpu"]["speed_to_cpu"], 1.0);
        assert_eq!((&case["gpu"], &case["same_bytes"]), (&Value::Null, &Value::Null));
    }
    for (option, key, value) in [
        ("--simplified", "simplified", Value::Bool(true)),
        ("--literal", "rules", Value::Array(Vec::new())),
        ("--closed", "boundary_angle_degrees", Value::Null),
        ("--neighborhood=fuzzy", "neighborhood", "fuzzy".into()),
    ] {
        assert_ne!(report["params"][key], value);
        assert_eq!(parse(&cpu(&["--json", option]))["params"][key], value, "{option}");
    }
}

/// Needs an adapter; a software one will do.
#[test]
fn both_backends_are_measured_and_compared() {
    let folder = Folder::new();
    let report = parse(&folder.succeed(&[&SMALL[..], &["--json"]].concat()));
    for case in report["cases"].as_array().unwrap() {
        check_side(case, &case["cpu"]);
        check_side(case, &case["gpu"]);
        let to_cpu = number(&case["gpu"]["new_points_per_second"])
            / number(&case["cpu"]["new_points_per_second"]);
        assert!((number(&case["gpu"]["speed_to_cpu"]) / to_cpu - 1.0).abs() < 1e-6, "{case}");
        assert!(number(&case["gpu"]["bytes_per_point"]) > 44.0, "less than the result: {case}");
        assert!(number(&case["gpu_read_back"]["seconds"]["median"]) > 0.0, "{case}");
        let is_sure = report["gpu"]["mode"] == "exact" && report["gpu"]["type"] == "software";
        assert!(case["same_bytes"] == true || !is_sure, "{case}");
    }
    let gpu = [&SMALL[..], &["--backend", "gpu"]].concat();
    let table = folder.succeed(&gpu);
    assert!(table.contains(report["gpu"]["name"].as_str().unwrap()), "{table}");
    assert!(table.contains("gpu, read back") && !table.contains("threads"), "{table}");
}

#[test]
fn own_cloud_is_measured() {
    let folder = Folder::with_sample("torus", "300");
    let input = ["bench", "--input", "in.ply", "--levels", "1", "--runs", "1", "--json"];
    let cpu = [&input[..], &["--backend", "cpu"]].concat();
    let report = parse(&folder.succeed(&cpu));
    let case = &report["cases"][0];
    assert_eq!((&case["input"], &case["points_in"]), (&"in.ply".into(), &300.into()));
    assert_eq!(case["size"], Value::Null);
    check_side(case, &case["cpu"]);
    Folder::with_input("no PLY file").fail(&cpu, "in.ply: header line 1");
}

#[test]
fn what_is_left_out_is_said() {
    let folder = Folder::new();
    let bench = ["bench", "--backend", "cpu", "--runs", "1", "--levels", "2", "--sizes"];
    let table = folder.succeed(&[&bench[..], &["500,3k"]].concat());
    let line = "left out 500 points on the CPU: too few for 2 levels";
    assert!(table.contains(line), "{table}");
    folder.fail(&[&bench[..], &["500"]].concat(), "nothing was measured: 500 points on the CPU");
}

/// A backend that the engine has no code for stands for a machine without a driver.
#[test]
fn machine_without_a_driver_measures_the_cpu() {
    let run = |backend: &str| {
        let args = [&SMALL[..], &["--backend", backend, "--json"]].concat();
        let output = Folder::new().command(&args).env("WGPU_BACKEND", "noop").output().unwrap();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    for backend in ["both", "auto"] {
        let (code, out, complaint) = run(backend);
        assert_eq!(code, Some(0), "{complaint}");
        let told = "surfine: only the CPU is measured: no GPU adapter found";
        assert!(complaint.starts_with(told) && complaint.matches('\n').count() == 1, "{complaint}");
        let report = parse(&out);
        assert_eq!(report["gpu"], Value::Null);
        assert!(report["notes"][0].as_str().unwrap().starts_with("only the CPU is measured"));
    }
    let (code, out, complaint) = run("gpu");
    assert_eq!((code, out.as_str()), (Some(1), ""), "{complaint}");
    assert!(complaint.starts_with("surfine: error: no GPU adapter found"), "{complaint}");
}
