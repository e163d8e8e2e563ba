//! What makes a model unfit for being measured.

use surfine_points::Model;

use crate::places::Places;

/// Why a model can't be measured or measured against, with what to do about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum Unfit {
    #[error("the {model} has no points: give a file with at least two")]
    Empty { model: &'static str },
    #[error("all points of the {model} are in one place: give at least two different positions")]
    OnePlace { model: &'static str },
    #[error("the {model}'s {what} is {length:e}, too near to zero to divide by: scale the file")]
    TooSmall { model: &'static str, what: &'static str, length: f64 },
    #[error(
        "the {model}'s vertex {vertex} has the coordinate {value:e}, which is not within ±1e70: remove or repair it"
    )]
    Coordinate { model: &'static str, vertex: usize, value: f64 },
    #[error("the {model} has {found} entries of {column} for {points} points: give one a point")]
    Length { model: &'static str, column: String, found: usize, points: usize },
    #[error(
        "triangle {triangle} of the {model} names vertex {vertex}, but there are {vertices}: repair the file"
    )]
    Corner { model: &'static str, triangle: usize, vertex: u32, vertices: usize },
    #[error(
        "none of the {triangles} triangles of the truth has any area: repair the mesh or give its vertices as points"
    )]
    NoArea { triangles: usize },
    #[error(
        "the {model} has {points} points, too many for indices of 32 bits: measure a part of it"
    )]
    TooMany { model: &'static str, points: usize },
}

/// Checks everything that measures rely on but the number of different positions.
pub(crate) fn check(model: &Model, name: &'static str) -> Result<(), Unfit> {
    let points = model.len();
    if points == 0 {
        return Err(Unfit::Empty { model: name });
    }
    if points >= u32::MAX as usize || model.triangles.len() >= u32::MAX as usize {
        return Err(Unfit::TooMany { model: name, points: points.max(model.triangles.len()) });
    }
    let normals = model.normals.iter().map(|n| ("normals".into(), n.len()));
    let attributes = model.attributes.iter().map(|a| (a.name.clone(), a.values.len()));
    if let Some((column, found)) = normals.chain(attributes).find(|&(_, found)| found != points) {
        return Err(Unfit::Length { model: name, column, found, points });
    }
    check_coordinates(model, name)?;
    check_corners(model, name)
}

fn check_coordinates(model: &Model, name: &'static str) -> Result<(), Unfit> {
    // Squares of areas of larger ones overflow. The comparison is false for what isn't a number.
    let fits = |value: &f64| value.abs() <= 1e70;
    for (vertex, position) in model.positions.iter().enumerate() {
        if let Some(value) = position.to_array().into_iter().find(|v| !fits(v)) {
            return Err(Unfit::Coordinate { model: name, vertex, value });
        }
    }
    Ok(())
}

fn check_corners(model: &Model, name: &'static str) -> Result<(), Unfit> {
    let vertices = model.len();
    for (triangle, corners) in model.triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&c| c as usize >= vertices) {
            return Err(Unfit::Corner { model: name, triangle, vertex, vertices });
        }
    }
    Ok(())
}

/// Checks that not everything lies in one place: there is no spacing and no scale otherwise.
pub(crate) fn check_places(places: &Places, name: &'static str) -> Result<(), Unfit> {
    if places.len() < 2 { Err(Unfit::OnePlace { model: name }) } else { Ok(()) }
}

/// Checks a length that measures are divided by: tiny ones underflow.
pub(crate) fn check_length(
    length: f64,
    what: &'static str,
    model: &'static str,
) -> Result<(), Unfit> {
    let fits = length > 0.0 && length.is_normal();
    if fits { Ok(()) } else { Err(Unfit::TooSmall { model, what, length }) }
}
