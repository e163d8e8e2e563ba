//! The kernel that finds the wide gaps of the reference's rings.

use crate::harness::{compare_equal, device, must, steps};
use surfine_features::Gap;

/// The widest gaps of a step's rings that are wider than `theta_b`, by point, as words.
fn widest_gaps(step: &crate::harness::Step, theta_b: f32) -> Vec<[u32; 4]> {
    let rings = &step.state.rings;
    let gap = |p: usize| Gap::widest(p as u32, rings.ring(p).iter().map(|e| (e.id, e.angle)));
    (0..step.level.len())
        .filter_map(gap)
        .filter(|gap| gap.angle > theta_b)
        .map(|gap| [gap.point, gap.begin, gap.end, gap.angle.to_bits()])
        .collect()
}

#[test]
fn gaps_are_those_of_the_reference() {
    let mut device = device();
    let mut found_any = false;
    for step in steps() {
        let n = step.level.len();
        let fans = device.buffer("fans", &step.fans(0));
        let entries = device.buffer("entries", &step.ring_entries());
        for theta_b in [0.0f32, 1.2, 160f32.to_radians()] {
            let expected = widest_gaps(step, theta_b);
            let gaps = device.output::<[u32; 4]>("gaps", n);
            let count = device.output::<u32>("count", 1);
            let words = [theta_b.to_bits(), n as u32, 0, 0];
            let buffers = [&fans, &entries, &gaps, &count];
            device.run(step.run("boundary_gaps", words, n), &buffers);
            let size = device.read::<u32>(&count, 1)[0] as usize;
            // They come in the order of timing.
            let mut found: Vec<[u32; 4]> = device.read(&gaps, n);
            found.truncate(size);
            found.sort_unstable();
            must(compare_equal(&format!("{}: gaps", step.name), &expected, &found));
            found_any |= theta_b > 2.0 && size > 20;
        }
    }
    assert!(found_any, "no cloud has a boundary");
}

#[test]
fn a_list_that_is_too_short_is_told_and_not_overrun() {
    let mut device = device();
    let step = &steps()[0];
    let n = step.level.len();
    let fans = device.buffer("fans", &step.fans(0));
    let entries = device.buffer("entries", &step.ring_entries());
    let (gaps, count) = (device.output::<[u32; 4]>("gaps", 5), device.output::<u32>("count", 1));
    let run = step.run("boundary_gaps", [0f32.to_bits(), 5, 0, 0], n);
    device.run(run, &[&fans, &entries, &gaps, &count]);
    assert_eq!(device.read::<u32>(&count, 1)[0] as usize, widest_gaps(step, 0.0).len());
    // Reading checks the guard words.
    let _: Vec<[u32; 4]> = device.read(&gaps, 5);
}
