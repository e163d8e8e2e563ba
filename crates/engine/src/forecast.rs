//! What a refinement will need, told before anything is computed.
//!
//! The sizes follow the stages: each step reserves some buffers by its number of points, which is sure, and others by
//! what it finds, which is not. On an even closed surface a point has two triangles and six neighbours, and each
//! triangle gives a new point: buffers are then as foretold, within a hundredth. What depends on the sampling is the
//! memory of long rows: points with many neighbours, where radii are generous or spacings differ.

use crate::buffers::with_headroom;
use crate::records::{Candidate, Fan, Point};
use crate::sizing::{Sizing, WORD, boundary_gaps, radii};
use crate::{Error, Gpu};
use surfine_points::{GridShape, RefineParams, Vec3};

const POINT: u64 = size_of::<Point>() as u64;
/// Bytes of long rows for each point of the first step, where all have far too large radii: half as large again as fit,
/// on random points.
const FIRST_LONG_ROWS: u64 = 4000;
/// The same for later steps, on random points: by then radii fit.
const LONG_ROWS: u64 = 900;

/// What a refinement needs, about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Forecast {
    /// Points before the first step and after each one.
    pub points_by_level: Vec<u64>,
    /// Bytes of all buffers when the last step ends, for a refiner that was not used before and an even cloud.
    pub device_bytes: u64,
    /// The same for a cloud with clusters and gaps, or with generous radii.
    pub uneven_bytes: u64,
    /// The largest buffer: its name and its bytes, which the adapter must allow.
    pub largest_buffer: (&'static str, u64),
}

/// Points before the first step and after each one, on a closed surface: by Euler's formula it has two triangles for
/// each point, but for four in all. Random points were measured to grow by 2.3 to 2.8 instead of 3, open surfaces by
/// 2.9.
pub fn points_by_level(points: usize, levels: u32) -> Vec<u64> {
    let grown = |n: &u64| Some(n.saturating_mul(3).saturating_sub(4).max(*n));
    std::iter::successors(Some(points as u64), grown).take(levels as usize + 1).collect()
}

impl Forecast {
    /// For a cloud of so many points; `records` counts those on creases once for each normal.
    pub(crate) fn new(
        points: usize,
        records: usize,
        params: &RefineParams,
        sizing: &Sizing,
        limit: u64,
    ) -> Self {
        let input = records as u64;
        let sizes = points_by_level(records, params.levels);
        let mut needs = Needs { limit, buffers: vec![("points", POINT * input)] };
        if params.levels > 0 {
            needs.reserve("boundary gaps", 4 * WORD * boundary_gaps(params, input));
        }
        for pair in sizes.windows(2) {
            Step::even(pair[0], pair[1], input).add_to(&mut needs, sizing, params);
        }
        let device_bytes = needs.total();
        Self {
            points_by_level: points_by_level(points, params.levels),
            device_bytes,
            uneven_bytes: device_bytes.saturating_add(long_rows(&sizes, sizing).min(limit)),
            largest_buffer: needs.largest(),
        }
    }
}

/// Bytes of long rows in an uneven cloud of these sizes: points share them in chunks.
fn long_rows(sizes: &[u64], sizing: &Sizing) -> u64 {
    let steps = sizes.iter().take(sizes.len() - 1).enumerate();
    let bytes = |(step, points): (usize, &u64)| {
        let each = if step == 0 { FIRST_LONG_ROWS } else { LONG_ROWS };
        each * (*points).min(sizing.chunk.into())
    };
    steps.map(bytes).max().unwrap_or(0)
}

/// Refuses a step of so many records if a buffer that it surely needs is larger than the adapter allows: each later
/// step would need it too. What depends on the sampling may still fail later.
///
/// # Errors
/// [`Error::TooLarge`].
pub(crate) fn check_step(
    gpu: &Gpu,
    sizing: &Sizing,
    params: &RefineParams,
    (level, records): (u32, usize),
) -> Result<(), Error> {
    let have = gpu.largest_buffer();
    let (what, need) = least_largest(records, sizing, params);
    if need <= have {
        return Ok(());
    }
    let levels = params.levels;
    let rest = RefineParams { levels: levels + 1 - level, ..params.clone() };
    let limit = gpu.largest_binding();
    let total = Forecast::new(records, records, &rest, sizing, limit).device_bytes;
    let adapter = gpu.name.clone();
    Err(Error::TooLarge { level, levels, points: records, what, need, have, total, adapter })
}

/// The largest buffer that a step needs whatever it finds, and its bytes.
pub(crate) fn least_largest(
    records: usize,
    sizing: &Sizing,
    params: &RefineParams,
) -> (&'static str, u64) {
    // No room for more: what is needed at least.
    let mut needs = Needs { limit: 0, buffers: Vec::new() };
    Step::least(records as u64).add_to(&mut needs, sizing, params);
    needs.largest()
}

/// Names and bytes of buffers, which grow as [`crate::buffers::Buffer`] does.
struct Needs {
    /// Bytes that the adapter allows in a binding: up to there buffers have room for more.
    limit: u64,
    buffers: Vec<(&'static str, u64)>,
}

impl Needs {
    /// With room for more where it grows.
    fn reserve(&mut self, name: &'static str, bytes: u64) {
        if bytes > self.size(name) {
            self.grow(name, with_headroom(bytes, self.limit));
        }
    }

    fn grow(&mut self, name: &'static str, bytes: u64) {
        match self.buffers.iter_mut().find(|(n, _)| *n == name) {
            Some((_, size)) => *size = bytes.max(*size),
            None => self.buffers.push((name, bytes)),
        }
    }

    fn size(&self, name: &str) -> u64 {
        self.buffers.iter().find(|(n, _)| *n == name).map_or(0, |(_, bytes)| *bytes)
    }

    fn total(&self) -> u64 {
        self.buffers.iter().fold(0, |sum, (_, bytes)| sum.saturating_add(*bytes))
    }

    fn largest(&self) -> (&'static str, u64) {
        self.buffers.iter().copied().max_by_key(|(_, bytes)| *bytes).unwrap_or(("points", 0))
    }
}

/// The numbers that the buffers of a step go by.
struct Step {
    /// Records before it.
    points: u64,
    /// Records after it.
    after: u64,
    /// Records that were added since the input, after it.
    added: u64,
    /// Neighbours of all points.
    slots: u64,
    candidates: u64,
}

impl Step {
    fn even(points: u64, after: u64, input: u64) -> Self {
        let slots = points.saturating_mul(6);
        Self { points, after, added: after - input, slots, candidates: after - points }
    }

    /// Nobody has a neighbour.
    fn least(points: u64) -> Self {
        Self { points, after: points, added: 0, slots: 0, candidates: 0 }
    }

    /// Its buffers, as the stages reserve them.
    fn add_to(&self, needs: &mut Needs, sizing: &Sizing, params: &RefineParams) {
        let &Self { points, after, added, slots, candidates } = self;
        // Where contested candidates alone are asked, the others are in no cell.
        let items = if params.effective_contested() { points } else { points.max(candidates) };
        // The grid has no more cells for more points.
        let counted = points.min(1 << 30) as usize;
        let cells = GridShape::with_cell(Vec3::ZERO, 1.0, counted).cells() as u64;
        // Name, words of an item, items.
        let buffers = [
            ("grid cells", 1, cells + 1),
            ("grid entries", 4, items),
            ("cells", 2, items),
            ("fans", size_of::<Fan>() as u64 / WORD, points),
            ("ring entries", 2, slots.max(sizing.ring_entries(points))),
            ("candidates of slots", 1, slots),
            ("numbers of candidates", 1, slots),
            ("first candidates", 1, points.saturating_add(1)),
            ("candidates", size_of::<Candidate>() as u64 / WORD, candidates),
            ("radii", 1, radii(points, candidates)),
            ("new indices", 1, candidates.saturating_add(1)),
        ];
        let select = [
            ("heads of links", 1, candidates),
            ("links", 2, sizing.links(points)),
            ("waiting", 2, candidates),
        ];
        let insert = [
            ("candidates around points", 1, sizing.around_entries(points)),
            ("heads of links", 1, points),
            ("links", 2, sizing.mirror_links(points)),
            ("classes", 1, points),
            ("waiting", 2, points),
            ("class members", 1, points),
        ];
        let own = if params.rules.largest_first { &select[..] } else { &insert };
        for (name, words, items) in buffers.iter().chain(own).copied() {
            needs.reserve(name, items.saturating_mul(WORD * words));
        }
        needs.grow("points", after.saturating_mul(POINT));
        needs.grow("parents", added.saturating_mul(3 * WORD));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_grow_and_end() {
        assert_eq!(points_by_level(100, 2), [100, 296, 884]);
        assert_eq!(points_by_level(1, 1), [1, 1]);
        let endless = points_by_level(usize::MAX, 20);
        assert!(endless.len() == 21 && endless[20] >= u64::MAX - 4, "{endless:?}");
        let params = RefineParams { levels: 20, ..RefineParams::default() };
        let huge = Forecast::new(1 << 40, 1 << 40, &params, &Sizing::default(), u64::MAX);
        assert!(huge.device_bytes > 1 << 60, "{huge:?}");
    }

    #[test]
    fn what_is_sure_is_less_than_what_is_likely() {
        for records in [1, 100, 12_345, 10_000_000] {
            let params = RefineParams::default();
            let likely = Forecast::new(records, records, &params, &Sizing::default(), 1 << 27);
            let (_, sure) = least_largest(records, &Sizing::default(), &params);
            assert!(sure <= likely.largest_buffer.1, "{records}: {sure} and {likely:?}");
            assert!(likely.device_bytes < likely.uneven_bytes);
        }
    }

    #[test]
    fn without_a_step_there_is_only_the_cloud() {
        let params = RefineParams { levels: 0, ..RefineParams::default() };
        let forecast = Forecast::new(1000, 1000, &params, &Sizing::default(), 1 << 27);
        assert_eq!(forecast.largest_buffer, ("points", 32_000));
        assert_eq!((forecast.device_bytes, forecast.uneven_bytes), (32_000, 32_000));
    }
}
