//! A cloud or mesh to be looked at or measured.

use crate::Failure;
use crate::watch::Watch;
use std::path::{Path, PathBuf};
use surfine_points::{Completed, Model, PointSet, Values, ply};

/// An input of `render`.
pub(crate) struct Cloud {
    pub(crate) path: PathBuf,
    pub(crate) model: Model,
    pub(crate) points: PointSet,
}

/// Reads a file and says what was left out.
pub(crate) fn read(path: &Path, watch: &Watch) -> Result<Model, Failure> {
    watch.step(format!("reading {}", path.display()));
    let (model, notes) = ply::read_model(path)?;
    notes.iter().for_each(|note| watch.warn(&format!("{}: {note}", path.display())));
    Ok(model)
}

/// The points to draw; says what was made up.
pub(crate) fn to_points(path: &Path, model: &Model, watch: &Watch) -> PointSet {
    let (points, completed) = model.to_points();
    let notes = notes(model, &completed);
    notes.iter().for_each(|note| watch.warn(&format!("{}: {note}", path.display())));
    points
}

/// What the user does not see in the file, or not in the picture.
fn notes(model: &Model, completed: &Completed) -> Vec<String> {
    let &Completed { unusable_normals, made_radii, unusable_radii, .. } = completed;
    let total = model.len();
    let mut notes = Vec::new();
    if total == 0 {
        notes.push("there are no points: its picture is empty".into());
    } else if model.normals.is_none() && !model.is_mesh() {
        notes.push("there are no normals nx ny nz: points are drawn as dots".into());
    }
    if unusable_normals > 0 {
        notes.push(format!(
            "{unusable_normals} of {total} normals are zero or not finite: their points are drawn as dots"
        ));
    }
    if unusable_radii > 0 {
        notes.push(format!(
            "{unusable_radii} of {total} radii are negative or not finite: their points are drawn as dots"
        ));
    }
    // The edges of a mesh tell its radii.
    if made_radii > 0 && !model.is_mesh() {
        notes.push(format!("there is no radius: {made_radii} were made from the neighbors"));
    }
    notes
}

impl Cloud {
    pub(crate) fn read(path: &Path, watch: &Watch) -> Result<Self, Failure> {
        let model = read(path, watch)?;
        let points = to_points(path, &model, watch);
        Ok(Self { path: path.into(), model, points })
    }

    pub(crate) fn colors(&self) -> Result<Vec<[u8; 3]>, Failure> {
        let missing =
            "there are no properties red, green and blue of type uchar: use another --color";
        self.model.colors().ok_or_else(|| self.failure(missing))
    }

    /// The smallest and the largest radius, if there are any points.
    pub(crate) fn radii(&self) -> Result<Option<[f32; 2]>, Failure> {
        let radii = self.points.radii.iter().copied().filter(|&r| r > 0.0);
        let found = radii.map(|r| [r, r]).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
        if found.is_none() && !self.points.is_empty() {
            let missing = "there is no usable radius, and none can be made: use another --color";
            return Err(self.failure(missing));
        }
        Ok(found)
    }

    pub(crate) fn highest_level(&self) -> Result<u8, Failure> {
        match self.points.attribute("level").map(|a| &a.values) {
            Some(Values::U8(levels)) => Ok(levels.iter().copied().max().unwrap_or(0)),
            _ => Err(self.failure(
                "there is no property level of type uchar: write it with `surfine refine --provenance`",
            )),
        }
    }

    fn failure(&self, why: &str) -> Failure {
        Failure(format!("{}: {why}", self.path.display()))
    }
}
