//! How large a file will be, before it is there.

use super::write::{columns, provenance_columns, write_body, write_header};
use super::{Encoding, PlyError, Provenance, Source};
use crate::PointSet;
use std::io::{self, Write};
use std::path::Path;

/// Points whose lines are measured.
const SAMPLE: usize = 1000;

/// Bytes of the file that [`write()`](super::write()) would make of `count` points of which `points` are the first, with
/// provenance or without: exact in binary, about in ASCII, where numbers have no fixed length.
///
/// # Errors
/// None that [`write()`](super::write()) would not give for these points.
pub fn file_size(
    points: &PointSet,
    count: u64,
    has_provenance: bool,
    source: &Source,
    encoding: Encoding,
) -> Result<u64, PlyError> {
    let path = Path::new("");
    let sampled = points.len().min(SAMPLE);
    let indices: Vec<u32> = (0..sampled as u32).collect();
    let sample = points.select(&indices);
    let mut columns = columns(&sample, source);
    if has_provenance {
        let provenance = Provenance { levels: &vec![0; sampled], parents: &[] };
        columns.extend(provenance_columns(path, &sample, provenance)?);
    }
    let failed = |cause| PlyError::Write { path: path.into(), cause };
    let (mut header, mut body) = (Count(0), Count(0));
    write_header(&mut header, &columns, count as usize, source, encoding).map_err(failed)?;
    write_body(&mut body, &columns, sampled, encoding).map_err(failed)?;
    let mut row = body.0 as f64 / sampled.max(1) as f64;
    if has_provenance && encoding == Encoding::Ascii {
        // Input points have -1 for each of three parents, new points have indices.
        row += 3.0 * (count.max(1).ilog10() as f64 - 1.0).max(0.0);
    }
    Ok(header.0 + (row * count as f64).round() as u64)
}

/// Counts bytes and forgets them.
struct Count(u64);

impl Write for Count {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
