//! The memory that a refinement will need, and whether there is that much.

use crate::adapters::shares_memory;
use crate::watch::Watch;
use crate::{Failure, memory};
use surfine::wgpu::DeviceType;
use surfine::{Error, Forecast, PointSet, RefineParams, Refiner, points_by_level};
use surfine_points::Values;

/// Memory of the CPU backend for each point of the result: 160 to 300 bytes were measured.
pub(crate) const CPU_BYTES: u64 = 280;
/// What it surely takes for each point of the input, once that is read: copies in spatial order, a grid, rings.
const LEAST_CPU_BYTES: u64 = 100;
/// Memory on the host for each point that is read back from a GPU: 130 bytes were measured.
pub(crate) const READ_BACK_BYTES: u64 = 200;
/// Memory of a software driver and its compiled kernels.
const DRIVER_BYTES: u64 = 150_000_000;

/// What a refinement needs, about.
pub(crate) struct Need {
    pub(crate) points_by_level: Vec<u64>,
    /// Bytes on the host.
    pub(crate) host: u64,
    /// Bytes on the host that are sure.
    least_host: u64,
    pub(crate) device: Option<DeviceNeed>,
}

pub(crate) struct DeviceNeed {
    pub(crate) adapter: String,
    pub(crate) forecast: Forecast,
    /// Bytes that the adapter allows in one buffer.
    pub(crate) largest_allowed: u64,
    /// Whether the device has its buffers in the memory of the host.
    pub(crate) on_host: bool,
}

/// Whether it fits; what surely does not is an error.
#[derive(Debug, PartialEq)]
pub(crate) enum Fits {
    Yes,
    /// Not unless the cloud grows less than even ones do.
    Unlikely(String),
}

impl Need {
    pub(crate) fn of_cpu(points: &PointSet, params: &RefineParams) -> Self {
        let sizes = points_by_level(points.len(), params.levels);
        let host = end(&sizes).saturating_mul(CPU_BYTES + 2 * attribute_bytes(points));
        let least_host = points.len() as u64 * LEAST_CPU_BYTES;
        Self { points_by_level: sizes, host, least_host, device: None }
    }

    pub(crate) fn of_gpu(
        refiner: &Refiner,
        points: &PointSet,
        params: &RefineParams,
    ) -> Result<Self, Error> {
        let forecast = refiner.forecast(points, params)?;
        let sizes = forecast.points_by_level.clone();
        let gpu = refiner.gpu();
        let kind = gpu.device.adapter_info().device_type;
        let on_host = shares_memory(kind);
        let read_back = end(&sizes).saturating_mul(READ_BACK_BYTES + 2 * attribute_bytes(points));
        let host = read_back.saturating_add(beside(kind, forecast.device_bytes));
        let (adapter, largest_allowed) = (gpu.name.clone(), gpu.largest_buffer());
        let device = Some(DeviceNeed { adapter, forecast, largest_allowed, on_host });
        Ok(Self { points_by_level: sizes, host, least_host: 0, device })
    }

    /// Points at the end.
    pub(crate) fn size(&self) -> u64 {
        end(&self.points_by_level)
    }

    /// Whether there is enough.
    ///
    /// # Errors
    /// There surely is not.
    pub(crate) fn fits(&self) -> Result<Fits, Failure> {
        self.fits_into(memory::available())
    }

    fn fits_into(&self, available: Option<u64>) -> Result<Fits, Failure> {
        let remedy = "use fewer levels or split the cloud";
        if let Some(available) = available {
            let have = bytes(available);
            if self.least_host > available {
                let need = bytes(self.least_host);
                return Err(Failure(format!(
                    "the refinement needs {need} of memory at least, {have} are available: split the cloud"
                )));
            }
            if self.host > available {
                let need = bytes(self.host);
                return Ok(Fits::Unlikely(format!(
                    "it would take about {need} of memory, {have} are available: {remedy}"
                )));
            }
        }
        Ok(self.device.as_ref().map_or(Fits::Yes, |device| device.fits(remedy)))
    }
}

impl DeviceNeed {
    fn fits(&self, remedy: &str) -> Fits {
        let (name, need) = self.forecast.largest_buffer;
        if need <= self.largest_allowed {
            return Fits::Yes;
        }
        let (need, have) = (bytes(need), bytes(self.largest_allowed));
        let adapter = &self.adapter;
        Fits::Unlikely(format!(
            "its buffer of {name} would take about {need}, {adapter} allows {have} in one buffer: \
             {remedy}, or use the CPU"
        ))
    }
}

impl Fits {
    /// Tells the user before a long run that may be in vain.
    pub(crate) fn warn(&self, watch: &Watch) {
        if let Self::Unlikely(why) = self {
            watch.warn(&format!("this will probably fail: {why}"));
        }
    }
}

/// Bytes on the host for a device of that kind and its buffers, beside what is read back.
fn beside(kind: DeviceType, device_bytes: u64) -> u64 {
    let buffers = if shares_memory(kind) { device_bytes } else { 0 };
    let driver = if kind == DeviceType::Cpu { DRIVER_BYTES } else { 0 };
    buffers.saturating_add(driver)
}

/// Points at the end.
fn end(sizes: &[u64]) -> u64 {
    sizes.last().copied().unwrap_or(0)
}

/// Bytes of the attributes of a point.
fn attribute_bytes(points: &PointSet) -> u64 {
    let size = |values: &Values| match values {
        Values::I8(_) | Values::U8(_) => 1,
        Values::I16(_) | Values::U16(_) => 2,
        Values::I32(_) | Values::U32(_) | Values::F32(_) => 4,
        Values::F64(_) => 8,
    };
    points.attributes.iter().map(|attribute| size(&attribute.values)).sum()
}

/// 12 B, 3.4 kB, 56.7 MB, 8.9 GB, 1.2 TB.
pub(crate) fn bytes(count: u64) -> String {
    let mut value = count as f64;
    for unit in ["B", "kB", "MB", "GB"] {
        if value < 999.95 {
            return if unit == "B" { format!("{count} B") } else { format!("{value:.1} {unit}") };
        }
        value /= 1e3;
    }
    format!("{value:.1} TB")
}

#[cfg(test)]
mod tests {
    use super::*;
    use surfine_points::shapes::{Sampling, Shape, sample};

    #[test]
    fn only_what_is_sure_is_refused() {
        let points = sample(Shape::Sphere, Sampling::Random, 1000, 1);
        let params = RefineParams { levels: 2, ..RefineParams::default() };
        let need = Need::of_cpu(&points, &params);
        assert_eq!(need.points_by_level, [1000, 2996, 8984]);
        assert_eq!(need.host, 8984 * CPU_BYTES);
        assert_eq!(need.fits_into(None).unwrap(), Fits::Yes);
        assert_eq!(need.fits_into(Some(need.host)).unwrap(), Fits::Yes);
        let Fits::Unlikely(why) = need.fits_into(Some(1_000_000)).unwrap() else {
            panic!("it fits nowhere");
        };
        assert!(why.contains("2.5 MB of memory, 1.0 MB are available"), "{why}");
        let Failure(why) = need.fits_into(Some(99_999)).unwrap_err();
        assert!(why.contains("100.0 kB of memory at least, 100.0 kB are available"), "{why}");
    }

    #[test]
    fn devices_without_memory_of_their_own_take_that_of_the_host() {
        let pairs = [
            (DeviceType::Cpu, 1000 + DRIVER_BYTES),
            (DeviceType::IntegratedGpu, 1000),
            (DeviceType::DiscreteGpu, 0),
            (DeviceType::VirtualGpu, 0),
            (DeviceType::Other, 0),
        ];
        for (kind, bytes) in pairs {
            assert_eq!(beside(kind, 1000), bytes, "{kind:?}");
        }
    }

    #[test]
    fn bytes_have_units() {
        let pairs = [(0, "0 B"), (999, "999 B"), (1000, "1.0 kB"), (999_960, "1.0 MB")];
        let more =
            [(56_700_000, "56.7 MB"), (8_900_000_000, "8.9 GB"), (u64::MAX, "18446744.1 TB")];
        for (count, text) in pairs.into_iter().chain(more) {
            assert_eq!(bytes(count), text);
        }
    }
}
