//! Memory of this machine, where the system tells: on Linux.

use std::fs;

/// Bytes that can be had without swapping: what is free, within what a container allows.
pub(crate) fn available() -> Option<u64> {
    let free = kilobytes("/proc/meminfo", "MemAvailable:")?;
    let of_container = || {
        let value = |name| fs::read_to_string(format!("/sys/fs/cgroup/memory.{name}")).ok();
        let [max, current] = ["max", "current"].map(|n| value(n)?.trim().parse::<u64>().ok());
        Some(max?.saturating_sub(current?))
    };
    Some(of_container().map_or(free, |left| left.min(free)))
}

/// Bytes of a line `name: 123 kB`.
fn kilobytes(path: &str, name: &str) -> Option<u64> {
    let text = fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().strip_suffix(" kB")?.parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
}
