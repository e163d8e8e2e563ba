//! The body: entries from the parser, with errors that name the place.

use super::error::quoted;
use super::file::check_size;
use super::header::Header;
use super::scalar::{self, Scalar};
use super::{Encoding, PlyError};
use crate::Values;
use ply_rs_bw::parser::{ParseError, Parser};
use ply_rs_bw::ply::{
    Addable, ElementDef, PropertyAccess, PropertyAccessResult, PropertyDef, PropertyType,
    ScalarType,
};
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read};
use std::path::Path;

/// The body of a file, read entry by entry.
pub(super) struct Body<'a> {
    path: &'a Path,
    reader: BufReader<File>,
    encoding: Encoding,
    /// Its length in bytes.
    size: u64,
    /// Lines read so far, the header among them.
    line: usize,
    /// The current line of an ASCII file.
    text: Vec<u8>,
}

impl<'a> Body<'a> {
    /// The body behind the header that `reader` has just read; `size` is its length.
    ///
    /// # Errors
    /// A body too short for the counts in the header.
    pub(super) fn new(
        path: &'a Path,
        reader: BufReader<File>,
        header: &Header,
        size: u64,
    ) -> Result<Self, PlyError> {
        check_size(path, header, size)?;
        let (encoding, line) = (header.encoding, header.lines);
        Ok(Self { path, reader, encoding, size, line, text: Vec::new() })
    }

    /// Reads an element into one column for each scalar property.
    pub(super) fn read_columns(&mut self, element: &ElementDef) -> Result<Vec<Values>, PlyError> {
        let mut columns: Vec<Values> =
            scalars(element).map(|(_, kind)| scalar::column(kind, element.count)).collect();
        self.read_entries(element, |row: Row| {
            columns.iter_mut().zip(row.values()).for_each(|(c, v)| scalar::push(c, v));
            Ok(())
        })?;
        Ok(columns)
    }

    pub(super) fn skip(&mut self, element: &ElementDef) -> Result<(), PlyError> {
        self.read_entries(element, |_: Skipped| Ok(()))
    }

    /// Hands the entries of an element to `take`, which says what is wrong with one, and the remedy.
    pub(super) fn read_entries<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut take: impl FnMut(E) -> Result<(), String>,
    ) -> Result<(), PlyError> {
        let parser = Parser::<E>::new();
        for index in 0..element.count {
            let entry = self.read_entry(&parser, element, index)?;
            take(entry).map_err(|problem| self.entry_error(element, index, problem))?;
        }
        Ok(())
    }

    fn read_entry<E: PropertyAccess>(
        &mut self,
        parser: &Parser<E>,
        element: &ElementDef,
        index: usize,
    ) -> Result<E, PlyError> {
        let read = match self.encoding {
            Encoding::Binary => parser.read_little_endian_element(&mut self.reader, element),
            Encoding::BinaryBigEndian => parser.read_big_endian_element(&mut self.reader, element),
            Encoding::Ascii => {
                let text = self.next_line(element, index)?;
                let entry = parser.read_ascii_element(text, element);
                let problem = match entry {
                    Ok(entry) if !has_surplus(text, element) => return Ok(entry),
                    _ => explain(text, element),
                };
                let problem = format!("line {}: {problem}", self.line);
                return Err(self.entry_error(element, index, problem));
            }
        };
        read.map_err(|error| self.binary_error(element, index, &error))
    }

    /// The next line of an ASCII body that is not blank.
    fn next_line(&mut self, element: &ElementDef, index: usize) -> Result<&str, PlyError> {
        let limit = line_limit(element);
        loop {
            self.text.clear();
            self.line += 1;
            let read = self.reader.by_ref().take(limit).read_until(b'\n', &mut self.text);
            match read {
                Err(cause) => return Err(PlyError::Read { path: self.path.into(), cause }),
                Ok(0) => return Err(self.truncated(element, index)),
                Ok(_) if !self.text.trim_ascii().is_empty() => break,
                Ok(_) => {}
            }
        }
        if self.text.len() as u64 == limit {
            let problem = format!("line {} is too long: put each entry on its own line", self.line);
            return Err(self.entry_error(element, index, problem));
        }
        str::from_utf8(&self.text).map_err(|_| {
            let problem = format!("line {} is not text: check the `format` line", self.line);
            self.entry_error(element, index, problem)
        })
    }

    fn binary_error(&self, element: &ElementDef, index: usize, error: &ParseError) -> PlyError {
        match error.kind() {
            ErrorKind::UnexpectedEof => self.truncated(element, index),
            // The parser's own complaints: there is only one about values.
            ErrorKind::InvalidInput | ErrorKind::InvalidData => self.entry_error(
                element,
                index,
                "a list has a negative length: the header does not fit the body, correct it".into(),
            ),
            kind => PlyError::Read { path: self.path.into(), cause: io::Error::from(kind) },
        }
    }

    fn truncated(&self, element: &ElementDef, found: usize) -> PlyError {
        PlyError::Truncated {
            path: self.path.into(),
            element: element.name.clone(),
            promised: element.count,
            found: found as u64,
            bytes: self.size,
        }
    }

    fn entry_error(&self, element: &ElementDef, index: usize, problem: String) -> PlyError {
        let element = element.name.clone();
        PlyError::Entry { path: self.path.into(), element, index, problem }
    }

    /// Checks that nothing but blanks follows.
    pub(super) fn finish(mut self) -> Result<(), PlyError> {
        let mut bytes = 0;
        let mut blank = true;
        loop {
            let chunk = match self.reader.fill_buf() {
                Ok([]) => break,
                Ok(chunk) => chunk,
                Err(cause) => return Err(PlyError::Read { path: self.path.into(), cause }),
            };
            blank &= chunk.trim_ascii().is_empty();
            bytes += chunk.len() as u64;
            let read = chunk.len();
            self.reader.consume(read);
        }
        if blank { Ok(()) } else { Err(PlyError::Trailing { path: self.path.into(), bytes }) }
    }
}

/// Longest line that an entry may have: generous for any way to print numbers, and more where lists are.
fn line_limit(element: &ElementDef) -> u64 {
    let limit = |property: &PropertyDef| match property.data_type {
        PropertyType::Scalar(_) => 512,
        PropertyType::List(..) => 1 << 24,
    };
    4096 + element.properties.values().map(limit).sum::<u64>()
}

/// The scalar properties of an element in order.
pub(super) fn scalars(element: &ElementDef) -> impl Iterator<Item = (&str, &ScalarType)> {
    element.properties.values().filter_map(|property| match &property.data_type {
        PropertyType::Scalar(kind) => Some((property.name.as_str(), kind)),
        PropertyType::List(..) => None,
    })
}

fn has_list(element: &ElementDef) -> bool {
    element.properties.values().any(|p| matches!(p.data_type, PropertyType::List(..)))
}

/// Whether the line of an entry without lists holds more values than there are properties.
fn has_surplus(line: &str, element: &ElementDef) -> bool {
    !has_list(element) && line.split_ascii_whitespace().nth(element.properties.len()).is_some()
}

/// Finds what is wrong with a line that the parser rejected.
fn explain(line: &str, element: &ElementDef) -> String {
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    for (property, word) in element.properties.values().zip(&words) {
        let PropertyType::Scalar(kind) = &property.data_type else {
            return "the values do not fit the lists in the header: correct the line".into();
        };
        let mut alone = ElementDef::new(String::new());
        alone.properties.add(property.clone());
        if Parser::<Skipped>::new().read_ascii_element(word, &alone).is_err() {
            let (name, word) = (quoted(&property.name), quoted(word));
            let kind = scalar::type_name(&scalar::column(kind, 0));
            return format!(
                "property {name}: {word} is no number of type {kind}: write it like 12, or -0.5 or 1.5e-3 if the type \
                 has fractions"
            );
        }
    }
    let (found, needed) = (words.len(), element.properties.len());
    format!("the line has {found} values for {needed} properties: correct the line or the header")
}

/// The scalar values of one entry in the order of the header.
struct Row {
    count: usize,
    /// The first values, so that usual entries need no allocation.
    first: [Scalar; Self::INLINE],
    more: Vec<Scalar>,
}

impl Row {
    const INLINE: usize = 12;

    fn push(&mut self, value: Scalar) -> PropertyAccessResult {
        match self.first.get_mut(self.count) {
            Some(place) => *place = value,
            None => self.more.push(value),
        }
        self.count += 1;
        PropertyAccessResult::Set
    }

    fn values(&self) -> impl Iterator<Item = Scalar> {
        self.first.iter().take(self.count).chain(&self.more).copied()
    }
}

/// The parser sets the properties in the order of the header, so their names do not matter. Lists are left out.
impl PropertyAccess for Row {
    fn new() -> Self {
        Self { count: 0, first: [Scalar::U8(0); Self::INLINE], more: Vec::new() }
    }
    fn set_char(&mut self, _: &str, value: i8) -> PropertyAccessResult {
        self.push(Scalar::I8(value))
    }
    fn set_uchar(&mut self, _: &str, value: u8) -> PropertyAccessResult {
        self.push(Scalar::U8(value))
    }
    fn set_short(&mut self, _: &str, value: i16) -> PropertyAccessResult {
        self.push(Scalar::I16(value))
    }
    fn set_ushort(&mut self, _: &str, value: u16) -> PropertyAccessResult {
        self.push(Scalar::U16(value))
    }
    fn set_int(&mut self, _: &str, value: i32) -> PropertyAccessResult {
        self.push(Scalar::I32(value))
    }
    fn set_uint(&mut self, _: &str, value: u32) -> PropertyAccessResult {
        self.push(Scalar::U32(value))
    }
    fn set_float(&mut self, _: &str, value: f32) -> PropertyAccessResult {
        self.push(Scalar::F32(value))
    }
    fn set_double(&mut self, _: &str, value: f64) -> PropertyAccessResult {
        self.push(Scalar::F64(value))
    }
}

/// An entry that nobody wants: the parser checks it and its values go nowhere.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}
