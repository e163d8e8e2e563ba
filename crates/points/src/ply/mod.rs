//! PLY files: points in, refined points out.
//!
//! [`read()`] takes the `vertex` element of an ASCII or binary file and [`write()`] gives one back, with the properties of
//! the input in their order and type. What a [`PointSet`](crate::PointSet) has no room for travels in a [`Source`].
//! [`read_model()`] takes any cloud or mesh, to be looked at.
//!
//! The header is scanned here, under limits, and its counts are checked against the size of the file. Only then does
//! `ply-rs-bw` read the body, one entry at a time, so hostile files cost no more than their own size.

mod body;
mod error;
mod faces;
mod file;
mod header;
mod model;
mod read;
mod scalar;
mod size;
mod write;

pub use error::PlyError;
pub use model::read_model;
pub use read::read;
pub use size::file_size;
pub use write::write;

use std::borrow::Cow;
use std::fs;
use std::path::Path;

/// How numbers are stored in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// Decimal numbers, one point a line.
    Ascii,
    /// Binary, little-endian: what most programs write.
    #[default]
    Binary,
    /// Binary, big-endian.
    BinaryBigEndian,
}

impl Encoding {
    /// The word of the `format` line.
    fn word(self) -> &'static str {
        match self {
            Self::Ascii => "ascii",
            Self::Binary => "binary_little_endian",
            Self::BinaryBigEndian => "binary_big_endian",
        }
    }

    fn from_word(word: &str) -> Option<Self> {
        [Self::Ascii, Self::Binary, Self::BinaryBigEndian].into_iter().find(|e| e.word() == word)
    }
}

/// What a file holds besides its points, so that [`write()`] can keep it.
///
/// `Source::default()` is right for points that come from no file: [`write()`] then uses 32-bit floats in the order
/// `x y z nx ny nz radius`, followed by the attributes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Source {
    /// One line for each thing that the file holds and the output will not, or not as it was.
    pub notes: Vec<String>,
    /// How the file was encoded.
    pub encoding: Encoding,
    /// The `comment` and `obj_info` lines as they came; they need not be UTF-8.
    remarks: Vec<Vec<u8>>,
    /// The properties of the file in order.
    layout: Vec<Slot>,
}

impl Source {
    /// The `comment` and `obj_info` lines of the header, keyword included.
    pub fn remarks(&self) -> impl Iterator<Item = Cow<'_, str>> {
        self.remarks.iter().map(|line| String::from_utf8_lossy(line))
    }

    /// Adds a `comment` line for the output; line breaks in `text` become spaces.
    pub fn add_comment(&mut self, text: &str) {
        let line = text.replace(['\n', '\r'], " ");
        self.remarks.push(format!("comment {line}").into_bytes());
    }
}

/// Where the points of a refined cloud come from; [`write()`] appends it as further properties.
#[derive(Clone, Copy, Debug)]
pub struct Provenance<'a> {
    /// The level of each point, 0 for the input: becomes `property uchar level`.
    pub levels: &'a [u8],
    /// The corners of the triangle of each of the last `parents.len()` points: become `property int parent0` to
    /// `parent2`. The points before them, the input, get -1.
    pub parents: &'a [[u32; 3]],
}

/// Whether both paths lead to one existing file, be it through links.
pub fn same_file(a: &Path, b: &Path) -> bool {
    match (fs::canonicalize(a), fs::canonicalize(b)) {
        (Ok(a), Ok(b)) => a == b || same_inode(&a, &b),
        _ => false,
    }
}

/// Two names of one file (hard links) have different paths even when canonical.
#[cfg(unix)]
fn same_inode(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let key = |path| fs::metadata(path).map(|m| (m.dev(), m.ino())).ok();
    key(a).is_some_and(|k| key(b) == Some(k))
}

#[cfg(not(unix))]
fn same_inode(_: &Path, _: &Path) -> bool {
    false
}

/// A property of the file.
#[derive(Clone, Debug, PartialEq)]
struct Slot {
    name: String,
    /// The values of the file, for a core property that is no 32-bit float there.
    original: Option<Vec<f64>>,
}

/// A property that every file of points must have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Core {
    Coordinate(usize),
    Normal(usize),
    Radius,
}

impl Core {
    /// In the usual order.
    const ALL: [Self; 7] = [
        Self::Coordinate(0),
        Self::Coordinate(1),
        Self::Coordinate(2),
        Self::Normal(0),
        Self::Normal(1),
        Self::Normal(2),
        Self::Radius,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Coordinate(axis) => ["x", "y", "z"][axis],
            Self::Normal(axis) => ["nx", "ny", "nz"][axis],
            Self::Radius => "radius",
        }
    }

    fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|core| core.name() == name)
    }
}
