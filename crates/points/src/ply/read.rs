//! Reading.

use super::body::{Body, scalars};
use super::error::quoted;
use super::file::open;
use super::header::Header;
use super::scalar::{narrowed, vectors};
use super::{Core, PlyError, Slot, Source, scalar};
use crate::model::round_center;
use crate::{Attribute, PointSet, Values};
use glam::DVec3;
use ply_rs_bw::ply::{ElementDef, KeyMap, PropertyType, ScalarType};
use std::path::Path;

/// Reads the points of a PLY file and checks them with [`PointSet::validate`].
///
/// The element `vertex` must have the scalar properties `x y z`, `nx ny nz` and `radius`, in any order and type. Its
/// other scalar properties become attributes. Coordinates that 32-bit floats cannot hold (`double`, `int`, `uint`) are
/// taken relative to [`PointSet::origin`], a round number near the centre. [`Source::notes`] names what is not kept.
///
/// # Errors
/// A file that cannot be read, breaks the format, is cut off, lacks properties or holds points that
/// [`PointSet::validate`] rejects.
pub fn read(path: &Path) -> Result<(PointSet, Source), PlyError> {
    let (header, reader, size) = open(path)?;
    check_core(path, &header, &Core::ALL)?;
    let mut body = Body::new(path, reader, &header, size)?;
    let mut columns = Vec::new();
    for element in header.elements.values() {
        if element.name == "vertex" {
            columns = body.read_columns(element)?;
        } else {
            body.skip(element)?;
        }
    }
    body.finish()?;
    let (points, source) = assemble(header, columns);
    points.validate().map_err(|invalid| PlyError::Invalid { path: path.into(), invalid })?;
    Ok((points, source))
}

/// Checks that the points have these scalar properties.
pub(super) fn check_core(path: &Path, header: &Header, needed: &[Core]) -> Result<(), PlyError> {
    let missing = |problem| Err(PlyError::Missing { path: path.into(), problem });
    let Some(vertex) = header.elements.get("vertex") else {
        return missing("there is no element `vertex`: give a file of points".into());
    };
    let absent = |core: &Core| !scalars(vertex).any(|(name, _)| name == core.name());
    let absent: Vec<Core> = needed.iter().copied().filter(absent).collect();
    let Some(first) = absent.first() else {
        return Ok(());
    };
    let names: Vec<String> = absent.iter().map(|core| format!("`{}`", core.name())).collect();
    let has = |kind: fn(&Core) -> bool| absent.iter().any(kind);
    let remedies = [
        (has(|r| matches!(r, Core::Coordinate(_))), "add the coordinates x y z"),
        (has(|r| matches!(r, Core::Normal(_))), "add normals nx ny nz, unit length, outward"),
        (
            has(|r| matches!(r, Core::Radius)),
            "add a property `radius`, at least the distance to the farthest natural neighbor, about 1.25 times it",
        ),
    ];
    let remedies: Vec<&str> = remedies.into_iter().filter(|r| r.0).map(|r| r.1).collect();
    let list = if vertex.properties.contains_key(first.name()) { " that is no list" } else { "" };
    let names = names.join(", ");
    missing(format!("element `vertex` has no {names}{list}: {}", remedies.join("; ")))
}

/// Makes a point set of the columns of the scalar properties of `vertex`.
fn assemble(header: Header, columns: Vec<Values>) -> (PointSet, Source) {
    let vertex = header.elements.get("vertex");
    let vertex = vertex.expect("`check_core` has seen it");
    let notes = notes(&header.elements, vertex);
    let names: Vec<&str> = scalars(vertex).map(|(name, _)| name).collect();
    let find = |core: Core| {
        let index = names.iter().position(|name| *name == core.name());
        &columns[index.expect("`check_core` has seen it")]
    };
    let [x, y, z, nx, ny, nz, radius] = Core::ALL.map(find);
    let origin = origin([x, y, z]);
    let mut points = PointSet::new(
        vectors([narrowed(x, origin.x), narrowed(y, origin.y), narrowed(z, origin.z)]),
        vectors([narrowed(nx, 0.0), narrowed(ny, 0.0), narrowed(nz, 0.0)]),
        narrowed(radius, 0.0),
    );
    points.origin = origin;
    let mut layout = Vec::new();
    for (name, values) in names.into_iter().zip(columns) {
        let mut original = None;
        if Core::from_name(name).is_none() {
            points.attributes.push(Attribute::new(name, values));
        } else if !matches!(values, Values::F32(_)) {
            original = Some(scalar::to_f64(&values));
        }
        layout.push(Slot { name: name.into(), original });
    }
    (points, Source { notes, encoding: header.encoding, remarks: header.remarks, layout })
}

/// What the output will lack or have in another type.
fn notes(elements: &KeyMap<ElementDef>, vertex: &ElementDef) -> Vec<String> {
    let mut notes = Vec::new();
    for element in elements.values().filter(|e| e.name != "vertex" && e.count > 0) {
        let (name, count) = (quoted(&element.name), element.count);
        notes.push(format!(
            "{name} element with {count} entries is not kept: the output has points only"
        ));
    }
    for property in vertex.properties.values() {
        let name = quoted(&property.name);
        match &property.data_type {
            PropertyType::List(..) => notes.push(format!(
                "list property {name} of {} points is not kept: attributes are single numbers",
                vertex.count
            )),
            PropertyType::Scalar(ScalarType::Float | ScalarType::Double) => {}
            PropertyType::Scalar(_) if Core::from_name(&property.name).is_none() => {}
            PropertyType::Scalar(kind) => {
                let kind = scalar::type_name(&scalar::column(kind, 0));
                notes.push(format!(
                    "property {name} of type {kind} is written as double: new points have fractions"
                ));
            }
        }
    }
    notes
}

/// An origin for the axes whose coordinates need not be exact in 32-bit floats; 0 on the others.
fn origin(coordinates: [&Values; 3]) -> DVec3 {
    let wide = coordinates.map(|c| matches!(c, Values::F64(_) | Values::I32(_) | Values::U32(_)));
    if wide == [false; 3] {
        return DVec3::ZERO;
    }
    round_center(coordinates.map(bounds), wide)
}

/// The least and the greatest value; infinite and crossed for no values.
fn bounds(values: &Values) -> (f64, f64) {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    scalar::to_f64(values).into_iter().fold(none, |(low, high), v| (low.min(v), high.max(v)))
}
