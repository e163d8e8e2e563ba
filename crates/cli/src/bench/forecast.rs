//! Whether a larger cloud is worth the attempt.

use super::measure::Measured;
use crate::memory;
use crate::need::{CPU_BYTES, READ_BACK_BYTES};
use std::time::Duration;

/// Time for each backend, where the user did not choose the sizes.
const MOST_TIME: Duration = Duration::from_secs(60);

/// Memory of a device for each point of the result, until it is measured.
const DEVICE_BYTES: f64 = 200.0;

/// This share of the available memory may be taken.
const SHARE: f64 = 0.8;

/// What is known of a backend from smaller clouds.
pub(super) struct Forecast {
    /// Whether its time counts.
    is_limited: bool,
    /// Whether its device has its buffers in the memory of the machine.
    device_on_host: bool,
    spent: Duration,
    /// Of all runs of a cloud together, for each point of the result.
    seconds_per_point: Option<f64>,
    /// On the host, for each point of the result.
    bytes_per_point: f64,
    failed: Option<String>,
}

impl Forecast {
    pub(super) fn of_cpu(is_limited: bool) -> Self {
        Self {
            is_limited,
            device_on_host: false,
            spent: Duration::ZERO,
            seconds_per_point: None,
            bytes_per_point: CPU_BYTES as f64,
            failed: None,
        }
    }

    pub(super) fn of_gpu(is_limited: bool, device_on_host: bool) -> Self {
        let mut forecast = Self { device_on_host, ..Self::of_cpu(is_limited) };
        forecast.set_device_bytes(DEVICE_BYTES);
        forecast
    }

    /// Learns what the device takes for each point. What is read back counts in any case; the CPU's result beside it is
    /// small.
    fn set_device_bytes(&mut self, bytes: f64) {
        let on_host = if self.device_on_host { bytes } else { 0.0 };
        self.bytes_per_point = READ_BACK_BYTES as f64 + on_host;
    }

    /// Why a result of that size is not tried.
    pub(super) fn objection(&self, size: usize) -> Option<String> {
        if let Some(failure) = &self.failed {
            return Some(failure.clone());
        }
        let seconds = self.seconds_per_point.unwrap_or(0.0) * size as f64;
        let left = MOST_TIME.saturating_sub(self.spent).as_secs_f64();
        if self.is_limited && seconds > left {
            return Some(format!(
                "its runs would take about {seconds:.0} s, {left:.0} s are left of a minute: ask for it with --sizes"
            ));
        }
        let bytes = self.bytes_per_point * size as f64;
        let available = memory::available()? as f64;
        (bytes > SHARE * available).then(|| {
            let [need, have] = [bytes, available].map(|b| b / 1e9);
            format!("it would take about {need:.1} GB of memory, {have:.1} GB are available")
        })
    }

    /// Learns from a cloud.
    pub(super) fn learn(&mut self, measured: &Measured) {
        let points = measured.refined.points.len().max(1) as f64;
        let time = measured.time();
        self.spent += time;
        self.seconds_per_point = Some(time.as_secs_f64() / points);
        if let Some(bytes) = measured.refined.device_bytes {
            self.set_device_bytes(bytes as f64 / points);
        }
    }

    /// Larger clouds would fail too.
    pub(super) fn fail(&mut self, why: String) {
        self.failed = Some(why);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_and_large_clouds_are_objected_to() {
        let slow =
            |is_limited| Forecast { seconds_per_point: Some(1e-3), ..Forecast::of_cpu(is_limited) };
        assert_eq!(slow(true).objection(50_000), None);
        let objection = slow(true).objection(100_000).unwrap();
        assert!(objection.contains("about 100 s, 60 s are left"), "{objection}");
        let spent = Forecast { spent: Duration::from_secs(20), ..slow(true) };
        assert!(spent.objection(50_000).is_some());
        assert_eq!(slow(false).objection(100_000), None);
        let large = Forecast { bytes_per_point: 1e12, ..slow(false) };
        if memory::available().is_some() {
            assert!(large.objection(100_000).unwrap().contains("100000000.0 GB of memory"));
        }
        let per_point = |on_host| Forecast::of_gpu(true, on_host).bytes_per_point;
        assert_eq!(per_point(true) - per_point(false), DEVICE_BYTES);
        let mut failed = Forecast::of_gpu(true, true);
        failed.fail("a smaller one failed".into());
        assert!(failed.objection(100).is_some());
    }
}
