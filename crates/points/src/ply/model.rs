//! Reading anything that can be looked at.

use super::body::{Body, scalars};
use super::error::quoted;
use super::faces::{Face, Faces, has_corners, other_properties};
use super::file::open;
use super::read::check_core;
use super::scalar::{narrowed, to_f64, vectors};
use super::{Core, PlyError};
use crate::{Attribute, Model, Values};
use glam::DVec3;
use ply_rs_bw::ply::{ElementDef, KeyMap, PropertyType};
use std::path::Path;

/// The limit that points to be refined have too: products of two farther coordinates near the end of 32-bit floats.
const FARTHEST: f64 = 1e15;

/// Reads the cloud or mesh of a PLY file, with a note for the user on each thing that is left out.
///
/// The element `vertex` must have the scalar properties `x y z`; `nx ny nz` and `radius` may be there, and its other
/// scalar properties become attributes. The list `vertex_indices` or `vertex_index` of the element `face` gives
/// triangles: polygons are cut into fans around their first corner, faces of fewer than three corners and triangles that
/// use a vertex twice are dropped, and the notes count both.
///
/// # Errors
/// A file that cannot be read, breaks the format, is cut off, lacks coordinates, has one that is not finite or beyond
/// ±1e15, or a face with a vertex that does not exist.
pub fn read_model(path: &Path) -> Result<(Model, Vec<String>), PlyError> {
    let (header, reader, size) = open(path)?;
    check_core(path, &header, &Core::ALL[..3])?;
    let vertex = header.elements.get("vertex").expect("`check_core` has seen it");
    let mut body = Body::new(path, reader, &header, size)?;
    let mut columns = Vec::new();
    let mut faces = Faces::new(vertex.count);
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => columns = body.read_columns(element)?,
            "face" if has_corners(element) => {
                body.read_entries(element, |face: Face| faces.add(&face))?;
            }
            _ => body.skip(element)?,
        }
    }
    body.finish()?;
    let mut notes = element_notes(&header.elements);
    notes.extend(vertex_notes(vertex));
    notes.extend(faces.notes());
    let mut model = assemble(vertex, columns);
    model.triangles = faces.triangles;
    check_coordinates(path, &model.positions)?;
    Ok((model, notes))
}

/// Makes a model of the columns of the scalar properties of `vertex`.
fn assemble(vertex: &ElementDef, columns: Vec<Values>) -> Model {
    let mut model = Model::default();
    let mut core = Core::ALL.map(|_| None);
    for ((name, _), values) in scalars(vertex).zip(columns) {
        match Core::ALL.iter().position(|core| core.name() == name) {
            Some(place) => core[place] = Some(values),
            None => model.attributes.push(Attribute::new(name, values)),
        }
    }
    let [x, y, z, nx, ny, nz, radius] = core;
    let [x, y, z] = [x, y, z].map(|c| to_f64(&c.expect("`check_core` has seen it")));
    model.positions = x.into_iter().zip(y).zip(z).map(|((x, y), z)| DVec3::new(x, y, z)).collect();
    if let (Some(nx), Some(ny), Some(nz)) = (nx, ny, nz) {
        model.normals = Some(vectors([nx, ny, nz].map(|values| narrowed(&values, 0.0))));
    }
    model.radii = radius.map(|values| narrowed(&values, 0.0));
    model
}

fn check_coordinates(path: &Path, positions: &[DVec3]) -> Result<(), PlyError> {
    // In this order a value that is no number is found too.
    let fits = |p: &DVec3| p.to_array().iter().all(|c| c.abs() <= FARTHEST);
    let Some(index) = positions.iter().position(|p| !fits(p)) else {
        return Ok(());
    };
    let position = positions[index];
    let problem = if position.is_finite() {
        format!(
            "coordinate {:e} is beyond ±1e15: move or scale the file",
            position.abs().max_element()
        )
    } else {
        "a coordinate is not finite: remove or repair the point".into()
    };
    Err(PlyError::Entry { path: path.into(), element: "vertex".into(), index, problem })
}

/// What is left out of the elements other than `vertex`.
fn element_notes(elements: &KeyMap<ElementDef>) -> Vec<String> {
    let mut notes = Vec::new();
    for element in elements.values().filter(|e| e.name != "vertex" && e.count > 0) {
        let (name, count) = (quoted(&element.name), element.count);
        let why = match element.name.as_str() {
            "face" if has_corners(element) => {
                if let Some(others) = other_properties(element) {
                    notes.push(format!(
                        "{others} of {count} faces are not read: only their corners are"
                    ));
                }
                continue;
            }
            "face" => "it has no list of integers `vertex_indices` or `vertex_index`",
            "tristrips" => "write the triangles as an element `face`",
            _ => "only points and triangles are",
        };
        notes.push(format!("{name} element with {count} entries is not read: {why}"));
    }
    notes
}

/// What is left out of the vertices.
fn vertex_notes(vertex: &ElementDef) -> Vec<String> {
    let mut notes = Vec::new();
    for property in vertex.properties.values() {
        if let PropertyType::List(..) = property.data_type {
            let (name, count) = (quoted(&property.name), vertex.count);
            notes.push(format!(
                "list property {name} of {count} points is not read: attributes are single numbers"
            ));
        }
    }
    let normal = |name: &&str| matches!(Core::from_name(name), Some(Core::Normal(_)));
    let found: Vec<&str> = scalars(vertex).map(|(name, _)| name).filter(normal).collect();
    if matches!(found.len(), 1 | 2) {
        let found = found.join("` and `");
        notes.push(format!(
            "`{found}` alone make no normals and are not read: a normal is nx ny nz"
        ));
    }
    notes
}
