//! The header: scanned under limits, with errors that name the line.

use super::Encoding;
use super::error::quoted;
use ply_rs_bw::ply::{Addable, ElementDef, KeyMap, PropertyDef, PropertyType, ScalarType};
use std::io::{self, BufRead, Read};

/// More than any sensible header line, little enough to read it whole.
const MAX_LINE: usize = 4096;
/// More than any sensible header.
const MAX_HEADER: usize = 1 << 20;

/// What the header says.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    /// The `comment` and `obj_info` lines.
    pub(super) remarks: Vec<Vec<u8>>,
    pub(super) elements: KeyMap<ElementDef>,
    /// Length in bytes.
    pub(super) bytes: u64,
    /// Length in lines.
    pub(super) lines: usize,
}

/// Why the header is no good, with the number of the line.
#[derive(Debug)]
pub(super) enum HeaderError {
    Io(io::Error),
    Line(usize, String),
}

/// Reads up to and with the line `end_header`.
pub(super) fn read_header(reader: &mut impl BufRead) -> Result<Header, HeaderError> {
    let mut scan = Scan::default();
    let mut line = Vec::new();
    loop {
        line.clear();
        scan.line += 1;
        let limit = MAX_LINE as u64 + 1;
        let read = reader.by_ref().take(limit).read_until(b'\n', &mut line);
        scan.bytes += read.map_err(HeaderError::Io)?;
        let number = scan.line;
        if scan.take(&line).map_err(|problem| HeaderError::Line(number, problem))? {
            return scan.finish().map_err(|problem| HeaderError::Line(number, problem));
        }
    }
}

/// The header so far.
#[derive(Default)]
struct Scan {
    line: usize,
    bytes: usize,
    encoding: Option<Encoding>,
    remarks: Vec<Vec<u8>>,
    elements: KeyMap<ElementDef>,
}

impl Scan {
    /// Takes the next line; true after `end_header`.
    fn take(&mut self, line: &[u8]) -> Result<bool, String> {
        if self.line == 1 {
            return check_magic(line).map(|()| false);
        }
        if line.len() > MAX_LINE {
            return Err(format!("the line is longer than {MAX_LINE} bytes: shorten it"));
        }
        if self.bytes > MAX_HEADER {
            return Err(format!("the header is longer than {MAX_HEADER} bytes: shorten it"));
        }
        if !line.ends_with(b"\n") {
            return Err("the file ends before `end_header`: get the whole file".into());
        }
        let line = line.trim_ascii_end();
        if is_remark(line) {
            self.remarks.push(line.to_vec());
            return Ok(false);
        }
        let text = str::from_utf8(line).map_err(|_| "the line is not UTF-8: retype it")?;
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        self.take_words(&words)
    }

    fn take_words(&mut self, words: &[&str]) -> Result<bool, String> {
        match words {
            [] => {}
            ["end_header"] => return Ok(true),
            ["format", rest @ ..] => self.take_format(rest)?,
            ["element", name, count] => self.take_element(name, count)?,
            ["property", "list", count, item, name] => {
                let (count, item) = (scalar_type(count)?, scalar_type(item)?);
                if matches!(count, ScalarType::Float | ScalarType::Double) {
                    return Err("the length of a list must have an integer type: name one".into());
                }
                self.take_property(name, PropertyType::List(count, item))?;
            }
            ["property", kind, name] => {
                self.take_property(name, PropertyType::Scalar(scalar_type(kind)?))?;
            }
            [word, ..] => {
                return Err(format!(
                    "{} is not understood: write `element NAME COUNT`, `property TYPE NAME`, `property list TYPE TYPE \
                     NAME`, `comment TEXT` or `end_header`",
                    quoted(word)
                ));
            }
        }
        Ok(false)
    }

    fn take_format(&mut self, words: &[&str]) -> Result<(), String> {
        if self.encoding.is_some() {
            return Err("a second `format` line: remove one".into());
        }
        let encoding = match words {
            [word, "1.0"] => Encoding::from_word(word),
            _ => None,
        };
        self.encoding = Some(encoding.ok_or_else(|| {
            format!(
                "format {} is unknown: write `ascii 1.0`, `binary_little_endian 1.0` or `binary_big_endian 1.0`",
                quoted(&words.join(" "))
            )
        })?);
        Ok(())
    }

    fn take_element(&mut self, name: &str, count: &str) -> Result<(), String> {
        let mut element = ElementDef::new(checked_name(name)?);
        element.count = count.parse().map_err(|_| {
            format!("{} is no count of entries: write a whole number from 0", quoted(count))
        })?;
        if self.elements.contains_key(name) {
            return Err(format!("a second element {}: rename or remove one", quoted(name)));
        }
        self.elements.add(element);
        Ok(())
    }

    fn take_property(&mut self, name: &str, kind: PropertyType) -> Result<(), String> {
        let name = checked_name(name)?;
        let Some((_, element)) = self.elements.last_mut() else {
            return Err("a property before any element: put an `element` line before it".into());
        };
        if element.properties.contains_key(&name) {
            return Err(format!("a second property {}: rename or remove one", quoted(&name)));
        }
        element.properties.add(PropertyDef::new(name, kind));
        Ok(())
    }

    fn finish(self) -> Result<Header, String> {
        let encoding = self.encoding.ok_or(
            "there is no `format` line: add `format ascii 1.0`, `format binary_little_endian 1.0` or \
             `format binary_big_endian 1.0` after the first line",
        )?;
        // Entries of no bytes could be any number without making the file longer.
        if let Some(e) = self.elements.values().find(|e| e.count > 0 && e.properties.is_empty()) {
            let (name, count) = (quoted(&e.name), e.count);
            return Err(format!(
                "element {name} has {count} entries but no properties: add `property` lines"
            ));
        }
        let Self { line: lines, bytes, remarks, elements, .. } = self;
        Ok(Header { encoding, remarks, elements, bytes: bytes as u64, lines })
    }
}

fn check_magic(line: &[u8]) -> Result<(), String> {
    if line.is_empty() {
        return Err("the file is empty: give a PLY file".into());
    }
    if line.trim_ascii_end() != b"ply" {
        return Err(
            "the file does not begin with a line `ply`: give a PLY file with LF or CRLF line ends"
                .into(),
        );
    }
    Ok(())
}

fn is_remark(line: &[u8]) -> bool {
    let word = line.split(u8::is_ascii_whitespace).next();
    matches!(word, Some(b"comment" | b"obj_info"))
}

/// Names go into messages and into the output, where a control character could spoil the line.
fn checked_name(name: &str) -> Result<String, String> {
    if name.contains(char::is_control) {
        return Err(format!("the name {} has control characters: rename it", quoted(name)));
    }
    Ok(name.into())
}

fn scalar_type(word: &str) -> Result<ScalarType, String> {
    Ok(match word {
        "char" | "int8" => ScalarType::Char,
        "uchar" | "uint8" => ScalarType::UChar,
        "short" | "int16" => ScalarType::Short,
        "ushort" | "uint16" => ScalarType::UShort,
        "int" | "int32" => ScalarType::Int,
        "uint" | "uint32" => ScalarType::UInt,
        "float" | "float32" => ScalarType::Float,
        "double" | "float64" => ScalarType::Double,
        _ => {
            return Err(format!(
                "type {} is unknown: use char, uchar, short, ushort, int, uint, float or double",
                quoted(word)
            ));
        }
    })
}

/// Bytes of a value in a binary file.
fn binary_size(kind: &ScalarType) -> u64 {
    match kind {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// The least bytes that an entry can take: empty lists, numbers of one digit.
pub(super) fn least_bytes(element: &ElementDef, encoding: Encoding) -> u64 {
    let size = |property: &PropertyDef| match (&property.data_type, encoding) {
        (_, Encoding::Ascii) => 2,
        (PropertyType::Scalar(kind) | PropertyType::List(kind, _), _) => binary_size(kind),
    };
    element.properties.values().map(size).sum()
}
