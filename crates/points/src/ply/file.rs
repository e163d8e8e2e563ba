//! Opening: a regular file, its header, and whether the body can hold what the header promises.

use super::header::{Header, HeaderError, least_bytes, read_header};
use super::{Encoding, PlyError};
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

/// Opens a file and reads its header: that, a reader of the body, and the length of the body in bytes.
pub(super) fn open(path: &Path) -> Result<(Header, BufReader<File>, u64), PlyError> {
    let (file, size) = open_regular(path)?;
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let header = read_header(&mut reader).map_err(|error| match error {
        HeaderError::Io(cause) => PlyError::Read { path: path.into(), cause },
        HeaderError::Line(line, problem) => PlyError::Header { path: path.into(), line, problem },
    })?;
    let size = size.saturating_sub(header.bytes);
    Ok((header, reader, size))
}

/// Opens a regular file. Pipes and devices are refused unopened: they might block or never end.
fn open_regular(path: &Path) -> Result<(File, u64), PlyError> {
    let failed = |cause| PlyError::Read { path: path.into(), cause };
    let metadata = fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        return Err(PlyError::NotAFile { path: path.into() });
    }
    Ok((File::open(path).map_err(failed)?, metadata.len()))
}

/// Checks that the body is long enough for the counts in the header, before anything is allocated for them.
pub(super) fn check_size(path: &Path, header: &Header, size: u64) -> Result<(), PlyError> {
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
