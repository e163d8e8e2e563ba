//! A folder in which the program runs.

use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};
use surfine_points::{PointSet, ply};
use tempfile::TempDir;

/// A folder in which the program runs, for the files of one test.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A folder with a cloud `in.ply`.
    pub(crate) fn with_sample(shape: &str, points: &str) -> Self {
        let folder = Self::new();
        folder.succeed(&["sample", shape, "-n", points, "-o", "in.ply"]);
        folder
    }

    /// A folder with these bytes as `in.ply`.
    pub(crate) fn with_input(bytes: impl AsRef<[u8]>) -> Self {
        let folder = Self::new();
        fs::write(folder.path("in.ply"), bytes).unwrap();
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    pub(crate) fn points(&self, name: &str) -> PointSet {
        ply::read(&self.path(name)).unwrap().0
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    pub(crate) fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_surfine"));
        command.args(args).current_dir(self.0.path());
        // The tests say themselves what they need.
        for name in ["WGPU_ADAPTER_NAME", "WGPU_BACKEND", "RAYON_NUM_THREADS"] {
            command.env_remove(name);
        }
        command
    }

    pub(crate) fn run(&self, args: &[&str]) -> Output {
        self.command(args).output().unwrap()
    }

    /// Runs without complaint and returns what was printed.
    pub(crate) fn succeed(&self, args: &[&str]) -> String {
        let output = self.run(args);
        let complaint = text(&output.stderr);
        assert!(output.status.success(), "{args:?}: {complaint}");
        assert_eq!(complaint, "", "{args:?}");
        text(&output.stdout)
    }

    /// Refines `in.ply` to `out.ply` on the CPU.
    pub(crate) fn refine(&self, more: &[&str]) -> String {
        self.refine_to("out.ply", more)
    }

    pub(crate) fn refine_to(&self, output: &str, more: &[&str]) -> String {
        let usual = ["refine", "in.ply", "-o", output, "--backend", "cpu"];
        self.succeed(&[&usual, more].concat())
    }

    pub(crate) fn refine_json(&self, more: &[&str]) -> Value {
        serde_json::from_str(&self.refine(&[more, &["--json"]].concat())).unwrap()
    }

    /// Expects a failure that is told in one line with this in it, and that changes no file.
    pub(crate) fn fail(&self, args: &[&str], part: &str) {
        let before = self.names();
        let output = self.run(args);
        let complaint = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{args:?}: {complaint}");
        assert!(complaint.starts_with("surfine: error: "), "{args:?}: {complaint}");
        assert_eq!(complaint.matches('\n').count(), 1, "{args:?}: {complaint}");
        assert!(complaint.contains(part), "{args:?}: no `{part}` in: {complaint}");
        assert_eq!(text(&output.stdout), "", "{args:?}");
        assert_eq!(self.names(), before, "{args:?}");
    }
}

/// Bytes that must be UTF-8.
pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}
