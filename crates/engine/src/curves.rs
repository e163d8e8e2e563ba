//! The creases and boundaries of a level as the kernels read them: a mirror of `shaders/shared/curves.wgsl`.

use crate::buffers::Buffer;
use crate::{Error, Gpu};
use surfine_features::{CurvePoint, Features, Record};
use surfine_points::{GridShape, Vec3};

/// What curves a level has: kernels do without the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curves {
    /// None.
    None,
    /// Boundaries alone.
    Boundaries,
    /// Creases, and boundaries too.
    Creases,
}

impl Curves {
    /// What there is.
    pub fn of(features: &Features) -> Self {
        let has_creases = features.segments.iter().any(|segment| !segment.is_boundary());
        match (features.is_empty(), has_creases) {
            (true, _) => Self::None,
            (false, false) => Self::Boundaries,
            (false, true) => Self::Creases,
        }
    }
}

/// Words of a record.
pub const RECORD_WORDS: usize = 24;
/// Words of a segment.
pub const SEGMENT_WORDS: usize = 4;

/// The curves of a step.
#[derive(Clone, Debug)]
pub struct Table {
    /// The records (those of new points last), the segments, and crease segments by cell: the first entry of each cell
    /// and one more, then the entries.
    pub words: Vec<u32>,
    /// The grid of the crease segments.
    pub shape: GridShape,
    /// Half of the longest of them.
    pub longest_half: f32,
    /// Points of a larger cosine between their normals lie on one side of every crease.
    pub softest_crease: f32,
    /// Where segments, cells and entries begin, in words.
    pub begins: [u32; 3],
}

/// The table of a level, with the new points on its curves.
pub fn table(features: &Features, new: &[CurvePoint]) -> Table {
    let (grid, longest_half) = features.segment_grid();
    let segments = RECORD_WORDS * features.records.len();
    let starts = segments + SEGMENT_WORDS * features.segments.len();
    let begins = [segments, starts, starts + grid.starts.len()].map(|at| at as u32);
    let mut words: Vec<u32> = Vec::new();
    for (i, record) in features.records.iter().enumerate() {
        let new = i.checked_sub(features.old).map(|rank| &new[rank]);
        words.extend(record_words(record, new));
    }
    words.extend(features.segments.iter().flat_map(|segment| segment.sides.into_iter().flatten()));
    // Without segments nobody asks.
    if !grid.items.is_empty() {
        words.extend(grid.starts);
        words.extend(grid.items);
    }
    let softest_crease = features.softest();
    Table { words, shape: grid.shape, longest_half, softest_crease, begins }
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

/// Writes the table of a step into its buffer.
pub(crate) fn upload(
    gpu: &Gpu,
    buffer: &mut Buffer,
    features: &Features,
    new: &[CurvePoint],
) -> Result<Table, Error> {
    let table = table(features, new);
    buffer.reserve(gpu, 4 * table.words.len() as u64)?;
    gpu.queue.write_buffer(buffer.raw(), 0, bytemuck::cast_slice(&table.words));
    Ok(table)
}
