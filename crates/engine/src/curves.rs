//! The creases and boundaries of a level as the kernels read them: a mirror of `shaders/shared/curves.wgsl`.

use crate::buffers::Buffer;
use crate::{Error, Gpu};
use surfine_features::{CurvePoint, Features, Record};
use surfine_points::Vec3;

/// Words of the header.
pub const HEADER_WORDS: usize = 16;
/// Words of a record.
pub const RECORD_WORDS: usize = 24;
/// Words of a segment.
pub const SEGMENT_WORDS: usize = 4;

/// The table: a header, the records (those of new points last), the segments, and these by cell. A header of zeros where
/// there are no curves.
pub fn table(features: &Features, new: &[CurvePoint]) -> Vec<u32> {
    if features.is_empty() {
        return vec![0; HEADER_WORDS];
    }
    let (grid, reach) = features.segment_grid();
    let segments = HEADER_WORDS + RECORD_WORDS * features.records.len();
    let starts = segments + SEGMENT_WORDS * features.segments.len();
    let mut words: Vec<u32> = Vec::new();
    words.extend(bits(grid.shape.origin));
    words.push((1.0 / grid.shape.cell).to_bits());
    words.extend(grid.shape.bits);
    words.extend([grid.shape.cell, reach].map(f32::to_bits));
    words.extend([segments, starts, starts + grid.starts.len()].map(|at| at as u32));
    words.push(features.softest().to_bits());
    words.resize(HEADER_WORDS, 0);
    for (i, record) in features.records.iter().enumerate() {
        let new = i.checked_sub(features.old).map(|rank| &new[rank]);
        words.extend(record_words(record, new));
    }
    words.extend(features.segments.iter().flat_map(|segment| segment.sides.into_iter().flatten()));
    words.extend(grid.starts);
    words.extend(grid.items);
    words
}

fn record_words(record: &Record, new: Option<&CurvePoint>) -> [u32; RECORD_WORDS] {
    let [x, y, z] = bits(record.position);
    let [nx, ny, nz] = bits(record.normal);
    let [mx, my, mz] = bits(record.conormal);
    let [before, after] = record.partners;
    let [from, to] = record.wedge.map(f32::to_bits);
    let (radius, rho) = new.map_or((0, 0), |new| (new.radius.to_bits(), new.rho.to_bits()));
    let [near, _, far] = new.map_or([0; 3], |new| new.parents);
    let &Record { point, first, sides, segment, .. } = record;
    [
        x, y, z, point, //
        nx, ny, nz, before, //
        mx, my, mz, after, //
        first, sides, segment, radius, //
        from, to, near, far, //
        rho, 0, 0, 0,
    ]
}

fn bits(v: Vec3) -> [u32; 3] {
    v.to_array().map(f32::to_bits)
}

/// Writes the table of a step into its buffer and returns its bytes.
pub(crate) fn upload(
    gpu: &Gpu,
    buffer: &mut Buffer,
    features: &Features,
    new: &[CurvePoint],
) -> Result<u64, Error> {
    let words = table(features, new);
    buffer.reserve(gpu, 4 * words.len() as u64)?;
    gpu.queue.write_buffer(buffer.raw(), 0, bytemuck::cast_slice(&words));
    Ok(4 * words.len() as u64)
}
