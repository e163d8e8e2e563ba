//! The same bytes from every driver: the CPU backend, lavapipe with each number of threads, and `SwiftShader`.
//!
//! Runs that the threads of lavapipe order differently are a race test too: no result may depend on atomic order.

// Both drivers come as Linux packages.
#![cfg(target_os = "linux")]

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// What to do about a missing driver.
const REMEDY: &str = "run tests/run.sh, which installs mesa-vulkan-drivers and SwiftShader";

/// The kernels are compiled in two ways.
const VARIANTS: [&str; 2] = ["--neighborhood=accurate", "--simplified"];

/// A cloud with clusters and gaps, so that all branches run, in a folder of its own.
struct Cloud(TempDir);

impl Cloud {
    fn new() -> Self {
        let cloud = Self(tempfile::tempdir().unwrap());
        cloud.run("sample torus -n 800 --random --seed 3 -o in.ply", &[]);
        cloud
    }

    /// Runs the program with these variables set and returns what it prints.
    fn run(&self, args: &str, variables: &[(&str, &str)]) -> String {
        let mut command = Command::new(env!("CARGO_BIN_EXE_surfine"));
        command.args(args.split(' ')).current_dir(self.0.path());
        for name in ["WGPU_ADAPTER_NAME", "WGPU_BACKEND", "VK_ICD_FILENAMES", "LP_NUM_THREADS"] {
            command.env_remove(name);
        }
        // A layer of Mesa's that reorders drivers, for desktops.
        command.env("NODEVICE_SELECT", "1").envs(variables.iter().copied());
        let output = command.output().unwrap();
        let complaint = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{args} with {variables:?}: {complaint}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// Refines three times and returns the file and the summary.
    fn refine(&self, options: &str, variables: &[(&str, &str)]) -> (Vec<u8>, Value) {
        let args = format!("refine in.ply -o out.ply --levels 3 --json {options}");
        let report = serde_json::from_str(&self.run(&args, variables)).unwrap();
        (fs::read(self.0.path().join("out.ply")).unwrap(), report)
    }

    fn refine_on_cpu(&self, variant: &str) -> Vec<u8> {
        let (bytes, report) = self.refine(&format!("{variant} --backend cpu"), &[]);
        // Each level multiplies the points by about 3; clusters of random points do somewhat worse.
        let points = report["points_out"].as_u64().unwrap();
        assert!(points > 10 * 800, "only {points} points: this would prove little");
        bytes
    }

    /// Refines with a driver, which must be the one of this name.
    fn refine_with(&self, driver: &str, variant: &str, variables: &[(&str, &str)]) -> Vec<u8> {
        let (bytes, report) = self.refine(&format!("{variant} --backend gpu"), variables);
        assert_eq!(report["backend"], "gpu");
        let adapter = report["adapter"].as_str().unwrap();
        assert!(adapter.contains(driver), "{adapter} was taken instead of {driver}");
        assert_eq!(report["mode"], "exact", "{adapter}");
        bytes
    }
}

/// Manifests of lavapipe, one for each architecture that is installed, as the loader wants them.
fn lavapipe() -> String {
    let folder = Path::new("/usr/share/vulkan/icd.d");
    let entries = fs::read_dir(folder).into_iter().flatten().map(|e| e.unwrap().path());
    let is_manifest = |path: &PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy();
        name.starts_with("lvp_icd") && name.ends_with(".json")
    };
    let manifests: Vec<String> =
        entries.filter(is_manifest).map(|path| path.display().to_string()).collect();
    assert!(!manifests.is_empty(), "lavapipe is not in {}: {REMEDY}", folder.display());
    manifests.join(":")
}

/// Manifest of `SwiftShader`, which no distribution puts in a fixed place.
fn swiftshader() -> String {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = std::env::var_os("SURFINE_SWIFTSHADER")
        .map_or_else(|| workspace.join("target/swiftshader"), PathBuf::from);
    for name in ["libvk_swiftshader.so", "vk_swiftshader_icd.json"] {
        let there = folder.join(name).is_file();
        assert!(there, "SwiftShader's {name} is not in {}: {REMEDY}", folder.display());
    }
    let manifest = folder.join("vk_swiftshader_icd.json").canonicalize().unwrap();
    manifest.display().to_string()
}

#[test]
fn lavapipe_gives_the_bytes_of_the_cpu() {
    let drivers = lavapipe();
    let cloud = Cloud::new();
    for variant in VARIANTS {
        let expected = cloud.refine_on_cpu(variant);
        // 0 is no thread but the program's own: everything runs in order.
        for threads in ["1", "2", "0"] {
            let variables = [("VK_DRIVER_FILES", drivers.as_str()), ("LP_NUM_THREADS", threads)];
            let found = cloud.refine_with("llvmpipe", variant, &variables);
            assert!(found == expected, "lavapipe with {threads} threads differs: {variant}");
        }
    }
}

#[test]
fn swiftshader_gives_the_bytes_of_the_cpu() {
    let driver = swiftshader();
    let cloud = Cloud::new();
    for variant in VARIANTS {
        let expected = cloud.refine_on_cpu(variant);
        let found = cloud.refine_with("SwiftShader", variant, &[("VK_DRIVER_FILES", &driver)]);
        assert!(found == expected, "SwiftShader differs: {variant}");
    }
}
