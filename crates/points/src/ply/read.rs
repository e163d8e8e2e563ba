//! Reading.

use super::body::{Body, scalars};
use super::error::quoted;
use super::header::{Header, HeaderError, least_bytes, read_header};
use super::{Core, Encoding, PlyError, Slot, Source, scalar};
use crate::{Attribute, PointSet, Values};
use glam::{DVec3, Vec3};
use ply_rs_bw::ply::{ElementDef, KeyMap, PropertyType, ScalarType};
use std::fs::{self, File};
use std::io::BufReader;
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
    let (file, size) = open(path)?;
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let header = read_header(&mut reader).map_err(|error| match error {
        HeaderError::Io(cause) => PlyError::Read { path: path.into(), cause },
        HeaderError::Line(line, problem) => PlyError::Header { path: path.into(), line, problem },
    })?;
    check_core(path, &header)?;
    let size = size.saturating_sub(header.bytes);
    check_size(path, &header, size)?;
    let mut body = Body::new(path, reader, &header, size);
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

/// Opens a regular file. Pipes and devices are refused unopened: they might block or never end.
fn open(path: &Path) -> Result<(File, u64), PlyError> {
    let failed = |cause| PlyError::Read { path: path.into(), cause };
    let metadata = fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        return Err(PlyError::NotAFile { path: path.into() });
    }
    Ok((File::open(path).map_err(failed)?, metadata.len()))
}

/// Checks that the points have everything that the refinement needs.
fn check_core(path: &Path, header: &Header) -> Result<(), PlyError> {
    let missing = |problem| Err(PlyError::Missing { path: path.into(), problem });
    let Some(vertex) = header.elements.get("vertex") else {
        return missing("there is no element `vertex`: give a file of points".into());
    };
    let absent = |core: &Core| !scalars(vertex).any(|(name, _)| name == core.name());
    let absent: Vec<Core> = Core::ALL.into_iter().filter(absent).collect();
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
            "add a property `radius`, at least the distance to the farthest natural neighbour, about 1.25 times it",
        ),
    ];
    let remedies: Vec<&str> = remedies.into_iter().filter(|r| r.0).map(|r| r.1).collect();
    let list = if vertex.properties.contains_key(first.name()) { " that is no list" } else { "" };
    let names = names.join(", ");
    missing(format!("element `vertex` has no {names}{list}: {}", remedies.join("; ")))
}

/// Checks that the file is long enough for the counts in its header, before anything is allocated for them.
fn check_size(path: &Path, header: &Header, size: u64) -> Result<(), PlyError> {
    // The last number of an ASCII file needs no separator after it.
    let mut left = size + u64::from(header.encoding == Encoding::Ascii);
    for element in header.elements.values() {
        let least = least_bytes(element, header.encoding);
        let needed = u128::from(least) * element.count as u128;
        let Some(rest) = u64::try_from(needed).ok().and_then(|needed| left.checked_sub(needed))
        else {
            return Err(PlyError::Truncated {
                path: path.into(),
                element: element.name.clone(),
                promised: element.count,
                found: left / least,
                bytes: size,
            });
        };
        left = rest;
    }
    Ok(())
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

/// A point near the centre of the bounding box, round to about the size of the box. An axis whose coordinates are
/// exact in 32-bit floats needs none and gets 0.
fn origin(coordinates: [&Values; 3]) -> DVec3 {
    let wide = coordinates.map(|c| matches!(c, Values::F64(_) | Values::I32(_) | Values::U32(_)));
    if wide == [false; 3] {
        return DVec3::ZERO;
    }
    let bounds = coordinates.map(bounds);
    let size = bounds.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    // The largest power of two in the size: all bits but those of the exponent go.
    let step = f64::from_bits(size.to_bits() & f64::INFINITY.to_bits());
    let axis = |axis: usize| {
        let (low, high) = bounds[axis];
        let middle = low + (high - low) / 2.0;
        let round = if step > 0.0 { (middle / step).round() * step } else { middle };
        // Adding 0 makes a zero positive. Values that are not finite are for the validation to find.
        if wide[axis] && round.is_finite() { round + 0.0 } else { 0.0 }
    };
    DVec3::new(axis(0), axis(1), axis(2))
}

/// The least and the greatest value; infinite and crossed for no values.
fn bounds(values: &Values) -> (f64, f64) {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    scalar::to_f64(values).into_iter().fold(none, |(low, high), v| (low.min(v), high.max(v)))
}

/// A column as 32-bit floats relative to `origin`.
fn narrowed(values: &Values, origin: f64) -> Vec<f32> {
    match values {
        // Their origin is 0; a copy keeps even the bits of a NaN.
        Values::F32(values) => values.clone(),
        values => scalar::to_f64(values).into_iter().map(|v| scalar::narrow(v - origin)).collect(),
    }
}

fn vectors([x, y, z]: [Vec<f32>; 3]) -> Vec<Vec3> {
    x.into_iter().zip(y).zip(z).map(|((x, y), z)| Vec3::new(x, y, z)).collect()
}
