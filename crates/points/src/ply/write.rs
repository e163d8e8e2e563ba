//! Writing.

use super::error::quoted;
use super::scalar::{self, Scalar};
use super::{Core, Encoding, PlyError, Provenance, Slot, Source};
use crate::files::replace;
use crate::{Attribute, PointSet, Values};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::fs;
use std::io::{self, Write};
use std::path::Path;

/// The properties that [`Provenance`] adds.
const PROVENANCE: [&str; 4] = ["level", "parent0", "parent1", "parent2"];

/// Writes points to a PLY file, which appears whole or not at all.
///
/// The properties of `source` come first, in their order and type; attributes that it does not know follow, then the
/// provenance. A coordinate, normal or radius that the file gave in another type than `float` is written as `double`:
/// the very value of the file as long as the 32-bit float made of it is unchanged, else that float, to which
/// coordinates add [`PointSet::origin`]. The same points give the same bytes.
///
/// # Errors
/// Points that [`PointSet::validate_numbers`] rejects, names that occur twice or that PLY cannot hold, values that are not
/// finite in ASCII, and a file that cannot be written.
pub fn write(
    path: &Path,
    points: &PointSet,
    provenance: Option<Provenance<'_>>,
    source: &Source,
    encoding: Encoding,
) -> Result<(), PlyError> {
    // Only that: a refinement may have left the ranges that its input must keep.
    points
        .validate_numbers()
        .map_err(|invalid| PlyError::Invalid { path: path.into(), invalid })?;
    let mut columns = columns(points, source);
    if let Some(provenance) = provenance {
        check_provenance_names(path, &columns)?;
        columns.extend(provenance_columns(path, points, provenance)?);
    }
    check_names(path, &columns)?;
    if encoding == Encoding::Ascii {
        check_finite(path, &columns)?;
    }
    if fs::metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
        return Err(PlyError::NotAFile { path: path.into() });
    }
    let failed = |cause| PlyError::Write { path: path.into(), cause };
    replace(path, |mut out| {
        write_header(&mut out, &columns, points.len(), source, encoding)?;
        write_body(&mut out, &columns, points.len(), encoding)
    })
    .map_err(failed)
}

/// A property of the output.
pub(super) struct Column<'a> {
    name: &'a str,
    data: Data<'a>,
}

enum Data<'a> {
    Values(Cow<'a, Values>),
    Core { points: &'a PointSet, core: Core, wide: Option<Wide<'a>> },
}

/// How a core property is written as `double`.
struct Wide<'a> {
    /// The values of the file for the first points.
    original: &'a [f64],
    origin: f64,
}

impl Column<'_> {
    fn type_name(&self) -> &'static str {
        match &self.data {
            Data::Values(values) => scalar::type_name(values),
            Data::Core { wide: Some(_), .. } => "double",
            Data::Core { wide: None, .. } => "float",
        }
    }

    fn value(&self, point: usize) -> Scalar {
        match &self.data {
            Data::Values(values) => scalar::get(values, point),
            Data::Core { points, core, wide } => {
                let value = core_value(points, *core, point);
                match wide {
                    Some(wide) => Scalar::F64(wide.value(value, point)),
                    None => Scalar::F32(value),
                }
            }
        }
    }
}

impl Wide<'_> {
    /// The value of the file where the point still has the float made of it, else that float.
    fn value(&self, value: f32, point: usize) -> f64 {
        let unchanged =
            |original: f64| scalar::narrow(original - self.origin).to_bits() == value.to_bits();
        match self.original.get(point) {
            Some(&original) if unchanged(original) => original,
            _ => self.origin + f64::from(value),
        }
    }
}

fn core_value(points: &PointSet, core: Core, point: usize) -> f32 {
    match core {
        Core::Coordinate(axis) => points.positions[point][axis],
        Core::Normal(axis) => points.normals[point][axis],
        Core::Radius => points.radii[point],
    }
}

/// The columns in the order of the file, then the attributes that are new.
pub(super) fn columns<'a>(points: &'a PointSet, source: &'a Source) -> Vec<Column<'a>> {
    let slots: HashMap<&str, (usize, &Slot)> =
        source.layout.iter().enumerate().map(|(i, slot)| (slot.name.as_str(), (i, slot))).collect();
    let core = |core: Core| {
        let slot = slots.get(core.name());
        core_column(points, core, slot.and_then(|(_, slot)| slot.original.as_deref()))
    };
    let attributes = points.attributes.iter().map(attribute_column);
    let mut columns: Vec<_> = Core::ALL.into_iter().map(core).chain(attributes).collect();
    // The sort is stable: what the file does not know stays in order at the end.
    columns.sort_by_key(|column| slots.get(column.name).map_or(usize::MAX, |(index, _)| *index));
    columns
}

fn attribute_column(attribute: &Attribute) -> Column<'_> {
    Column { name: &attribute.name, data: Data::Values(Cow::Borrowed(&attribute.values)) }
}

fn core_column<'a>(points: &'a PointSet, core: Core, original: Option<&'a [f64]>) -> Column<'a> {
    let origin = match core {
        Core::Coordinate(axis) => points.origin[axis],
        Core::Normal(_) | Core::Radius => 0.0,
    };
    let wide = (original.is_some() || origin != 0.0)
        .then(|| Wide { original: original.unwrap_or_default(), origin });
    Column { name: core.name(), data: Data::Core { points, core, wide } }
}

pub(super) fn provenance_columns(
    path: &Path,
    points: &PointSet,
    provenance: Provenance<'_>,
) -> Result<Vec<Column<'static>>, PlyError> {
    let Provenance { levels, parents } = provenance;
    let wrong = |problem| Err(PlyError::Provenance { path: path.into(), problem });
    let count = points.len();
    if levels.len() != count {
        return wrong(format!("{} levels for {count} points: give one a point", levels.len()));
    }
    let Some(inputs) = count.checked_sub(parents.len()) else {
        return wrong(format!(
            "{} triples of parents for {count} points: give one for each new point",
            parents.len()
        ));
    };
    let mut corners = [(); 3].map(|()| vec![-1; inputs]);
    for (i, triple) in parents.iter().enumerate() {
        for (column, &parent) in corners.iter_mut().zip(triple) {
            match i32::try_from(parent) {
                Ok(parent) if (parent as usize) < inputs + i => column.push(parent),
                _ => {
                    let point = inputs + i;
                    return wrong(format!(
                        "vertex {point} has parent {parent}: name an earlier point"
                    ));
                }
            }
        }
    }
    let values = [Values::U8(levels.to_vec())].into_iter().chain(corners.map(Values::I32));
    let column = |(name, values)| Column { name, data: Data::Values(Cow::Owned(values)) };
    Ok(PROVENANCE.into_iter().zip(values).map(column).collect())
}

fn check_provenance_names(path: &Path, columns: &[Column<'_>]) -> Result<(), PlyError> {
    let taken = |name: &&str| columns.iter().any(|column| column.name == *name);
    let taken: Vec<&str> = PROVENANCE.into_iter().filter(taken).collect();
    if taken.is_empty() {
        return Ok(());
    }
    Err(PlyError::Property {
        path: path.into(),
        name: taken.join("`, `"),
        problem: "the input has it already: rename it there, or write no levels and parents".into(),
    })
}

/// Checks that every name is one word and occurs once.
fn check_names(path: &Path, columns: &[Column<'_>]) -> Result<(), PlyError> {
    let mut seen = HashSet::new();
    for Column { name, .. } in columns {
        let problem = if name.is_empty()
            || name.contains(|c: char| c.is_ascii_whitespace() || c.is_control())
        {
            "a name is one word in PLY: rename it"
        } else if !seen.insert(name) {
            "the name occurs twice: rename one"
        } else {
            continue;
        };
        let name = quoted(name).trim_matches('`').to_owned();
        return Err(PlyError::Property { path: path.into(), name, problem: problem.into() });
    }
    Ok(())
}

/// Checks attributes for values that have no decimal form.
fn check_finite(path: &Path, columns: &[Column<'_>]) -> Result<(), PlyError> {
    for column in columns {
        let Data::Values(values) = &column.data else { continue };
        if let Some(point) = scalar::find_not_finite(values) {
            let problem = format!(
                "vertex {point} has no finite value, which ASCII cannot hold: write a binary file"
            );
            return Err(PlyError::Property {
                path: path.into(),
                name: column.name.into(),
                problem,
            });
        }
    }
    Ok(())
}

pub(super) fn write_header(
    out: &mut impl Write,
    columns: &[Column<'_>],
    points: usize,
    source: &Source,
    encoding: Encoding,
) -> io::Result<()> {
    writeln!(out, "ply\nformat {} 1.0", encoding.word())?;
    for remark in &source.remarks {
        out.write_all(remark)?;
        out.write_all(b"\n")?;
    }
    writeln!(out, "element vertex {points}")?;
    for column in columns {
        writeln!(out, "property {} {}", column.type_name(), column.name)?;
    }
    writeln!(out, "end_header")
}

pub(super) fn write_body(
    out: &mut impl Write,
    columns: &[Column<'_>],
    points: usize,
    encoding: Encoding,
) -> io::Result<()> {
    for point in 0..points {
        for (index, column) in columns.iter().enumerate() {
            if encoding == Encoding::Ascii && index > 0 {
                out.write_all(b" ")?;
            }
            column.value(point).write(out, encoding)?;
        }
        if encoding == Encoding::Ascii {
            out.write_all(b"\n")?;
        }
    }
    Ok(())
}
