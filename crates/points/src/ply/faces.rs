//! Faces: polygons in, triangles out.

use super::error::quoted;
use super::scalar::{self, Scalar};
use crate::Values;
use ply_rs_bw::ply::{ElementDef, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

/// The names under which programs write the corners of a face.
const NAMES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The triangles so far, and what became of the other polygons.
pub(super) struct Faces {
    pub(super) triangles: Vec<[u32; 3]>,
    /// How many vertices there are.
    vertices: usize,
    /// Polygons with more than three corners.
    polygons: usize,
    /// Faces with fewer than three corners.
    few: usize,
    /// Triangles with two corners in one vertex.
    repeated: usize,
}

impl Faces {
    pub(super) fn new(vertices: usize) -> Self {
        Self { triangles: Vec::new(), vertices, polygons: 0, few: 0, repeated: 0 }
    }

    /// Adds the triangles of a polygon: a fan around its first corner.
    ///
    /// # Errors
    /// What is wrong with a corner, and the remedy.
    pub(super) fn add(&mut self, face: &Face) -> Result<(), String> {
        let count = face.corners.len();
        self.polygons += usize::from(count > 3);
        self.few += usize::from(count < 3);
        let (mut first, mut last) = (0, 0);
        for corner in 0..count {
            let index = self.index(corner, scalar::get(&face.corners, corner))?;
            match corner {
                0 => first = index,
                1 => {}
                _ => self.add_triangle([first, last, index]),
            }
            last = index;
        }
        Ok(())
    }

    fn add_triangle(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners;
        if a == b || b == c || c == a {
            self.repeated += 1;
        } else {
            self.triangles.push(corners);
        }
    }

    fn index(&self, corner: usize, value: Scalar) -> Result<u32, String> {
        let value = value.to_integer();
        match u32::try_from(value) {
            Ok(index) if (index as usize) < self.vertices => Ok(index),
            _ => Err(format!(
                "corner {corner} is vertex {value}, but the vertices are numbered from 0 and there are {}: correct \
                 the index, or get the whole file",
                self.vertices
            )),
        }
    }

    /// What became of faces that are no triangles.
    pub(super) fn notes(&self) -> Vec<String> {
        let lines = [
            (self.polygons, "faces with more than three corners are cut into triangles"),
            (self.few, "faces with fewer than three corners are left out"),
            (self.repeated, "triangles with two corners in one vertex are left out"),
        ];
        let some = lines.into_iter().filter(|(count, _)| *count > 0);
        some.map(|(count, line)| format!("{count} {line}")).collect()
    }
}

/// Whether an element has lists of corners.
pub(super) fn has_corners(element: &ElementDef) -> bool {
    NAMES.into_iter().filter_map(|name| element.properties.get(name)).any(|property| {
        matches!(&property.data_type, PropertyType::List(_, kind)
            if !matches!(kind, ScalarType::Float | ScalarType::Double))
    })
}

/// The properties of faces that are not the corners, for a message; `None` if there are none.
pub(super) fn other_properties(element: &ElementDef) -> Option<String> {
    let names = element.properties.values().map(|property| property.name.as_str());
    let others: Vec<String> = names.filter(|name| !NAMES.contains(name)).map(quoted).collect();
    (!others.is_empty()).then(|| others.join(", "))
}

/// The corners of one face; floats are none.
pub(super) struct Face {
    corners: Values,
}

impl Face {
    /// Of a file with both names the first one in [`NAMES`] counts.
    fn set(&mut self, name: &str, corners: Values) -> PropertyAccessResult {
        if name == NAMES[0] || (name == NAMES[1] && self.corners.is_empty()) {
            self.corners = corners;
        }
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self { corners: Values::U8(Vec::new()) }
    }
    fn set_list_char(&mut self, name: &str, corners: Vec<i8>) -> PropertyAccessResult {
        self.set(name, Values::I8(corners))
    }
    fn set_list_uchar(&mut self, name: &str, corners: Vec<u8>) -> PropertyAccessResult {
        self.set(name, Values::U8(corners))
    }
    fn set_list_short(&mut self, name: &str, corners: Vec<i16>) -> PropertyAccessResult {
        self.set(name, Values::I16(corners))
    }
    fn set_list_ushort(&mut self, name: &str, corners: Vec<u16>) -> PropertyAccessResult {
        self.set(name, Values::U16(corners))
    }
    fn set_list_int(&mut self, name: &str, corners: Vec<i32>) -> PropertyAccessResult {
        self.set(name, Values::I32(corners))
    }
    fn set_list_uint(&mut self, name: &str, corners: Vec<u32>) -> PropertyAccessResult {
        self.set(name, Values::U32(corners))
    }
}
