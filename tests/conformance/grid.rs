//! The kernels that sort points and candidates by cell, and the prefix sum that they share with other stages.

use crate::harness::{Device, Step, compare_equal, device, grid_words, must, steps};
use surfine::testing::Buffer;
use surfine_points::Grid;

/// Counts, sums and fills as the engine does, with the prefix sum taken on the host. `stride` is in words of four.
fn check(
    device: &mut Device,
    step: &Step,
    items: &Buffer,
    [count, stride]: [u32; 2],
    expected: &Grid,
) {
    let cells = expected.shape.cells();
    let entries = expected.items.len();
    let grid = device.output::<u32>("grid", cells + 1);
    let ranks = device.output::<[u32; 2]>("ranks", count as usize);
    let words = [count, stride, 0, 0];
    device.run(step.run("grid_count", words, count as usize), &[items, &grid, &ranks]);
    let mut counted: Vec<u32> = device.read(&grid, cells + 1);
    for i in 1..=cells {
        counted[i] += counted[i - 1];
    }
    let (starts, places) = grid_words(expected);
    must(compare_equal(&format!("{}: starts", step.name), &starts, &counted));
    let grid = device.buffer("summed", &counted);
    let found = device.output::<[u32; 4]>("places", entries);
    let run = step.run("grid_fill", words, count as usize);
    device.run(run, &[items, &ranks, &grid, &found]);
    // Entries of a cell come in the order of timing: sort them before they are compared.
    let mut found: Vec<[u32; 4]> = device.read(&found, entries);
    for pair in starts.windows(2) {
        found[pair[0] as usize..pair[1] as usize].sort_unstable_by_key(|entry| entry[3]);
    }
    must(compare_equal(&format!("{}: entries", step.name), &places, &found));
}

#[test]
fn points_and_candidates_are_sorted_by_cell() {
    let mut device = device();
    for step in steps() {
        let points = device.buffer("points", &step.points());
        let count = step.level.len() as u32;
        check(&mut device, step, &points, [count, 2], &step.state.grid);
        let candidates = device.buffer("candidates", &step.candidates());
        let count = step.state.candidates.len() as u32;
        if let Some(grid) = &step.state.candidate_grid {
            check(&mut device, step, &candidates, [count, 3], grid);
        }
    }
}

#[test]
fn prefix_sums_of_three_layers_and_of_a_part() {
    let mut device = device();
    let step = &steps()[0];
    let mut random = fastrand::Rng::with_seed(3);
    let values: Vec<u32> = (0..9000).map(|_| random.u32(0..1000)).collect();
    // Only values 500 to 8999 are summed; 8500 values make 133 blocks, and these make 3.
    let (first, count, blocks, tops) = (500u32, 8500u32, 133u32, 3u32);
    let guarded = [bytemuck::cast_slice(&values), &[0xa5u8; 64][..]].concat();
    let sums = device.buffer("values", &guarded);
    let (lower, upper) = (device.output::<u32>("lower", 133), device.output::<u32>("upper", 3));
    device.run(step.run("scan_sum", [first, count, 0, 0], blocks as usize), &[&sums, &lower]);
    device.run(step.run("scan_sum", [0, blocks, 0, 0], tops as usize), &[&lower, &upper]);
    let nothing = device.output::<u32>("nothing", 1);
    device.run(step.run("scan_add", [0, tops, 0, 0], 1), &[&upper, &nothing]);
    device.run(step.run("scan_add", [0, blocks, 0, 0], tops as usize), &[&lower, &upper]);
    device.run(step.run("scan_add", [first, count, 0, 0], blocks as usize), &[&sums, &lower]);
    let mut expected = values;
    for i in 501..9000 {
        expected[i] += expected[i - 1];
    }
    must(compare_equal("sums", &expected, &device.read::<u32>(&sums, 9000)));
}
