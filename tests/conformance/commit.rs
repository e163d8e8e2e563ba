//! The commit kernels on the reference's decisions.

use crate::harness::{compare, compare_equal, device, must, steps};
use crate::tolerance::{NORMAL, POSITION};
use surfine::testing::records::{LEVEL_BITS, Point};
use surfine_reference::commit::commit;

#[test]
fn the_next_level_is_that_of_the_reference() {
    let mut device = device();
    for step in steps() {
        let (n, count) = (step.level.len(), step.state.candidates.len());
        let state = &step.state;
        let mut expected = step.level.clone();
        let parents = commit(&mut expected, state);

        let candidates = device.buffer("candidates", &step.decided());
        let indices = device.output::<u32>("indices", count + 1);
        device.run(step.run("commit_count", [0; 4], count), &[&candidates, &indices]);
        let mut summed: Vec<u32> = device.read(&indices, count + 1);
        for i in 1..=count {
            summed[i] += summed[i - 1];
        }
        assert_eq!(summed[count] as usize, parents.len(), "{}", step.name);

        let mut records = step.points();
        records.resize(expected.len(), Point::default());
        let points = device.guarded("points", &records);
        let indices = device.buffer("indices", &summed);
        let (insertion, covers) = (&state.insertion, &state.covers);
        let larger = |(a, b): (&f32, &f32)| a.max(*b);
        let of_candidates = insertion.candidate_radii.iter().zip(&covers.candidate_radii);
        let of_candidates: Vec<f32> = of_candidates.map(larger).collect();
        let radii = [&insertion.radii, &of_candidates, &covers.radii];
        let radii: Vec<f32> = radii.into_iter().flatten().copied().collect();
        let radii = device.buffer("radii", &radii);
        let found_parents = device.output::<[u32; 3]>("parents", parents.len());
        let curves = device.buffer("curves", &step.curves());
        let buffers = [&points, &candidates, &indices, &radii, &found_parents, &curves];
        device.run(step.run("commit", [0; 4], n.max(count)), &buffers);

        let what = |column| format!("{}: {column}", step.name);
        let found: Vec<Point> = device.read(&points, expected.len());
        must(compare_equal(
            &what("parents"),
            &parents,
            &device.read::<[u32; 3]>(&found_parents, parents.len()),
        ));
        let scale = expected.radii.iter().copied().fold(0.0, f32::max);
        let positions: Vec<f32> = found.iter().flat_map(|p| p.position).collect();
        let normals: Vec<f32> = found.iter().flat_map(|p| p.normal).collect();
        let radii: Vec<f32> = found.iter().map(|p| p.radius).collect();
        let flat = |v: &[surfine::Vec3]| v.iter().flat_map(|v| v.to_array()).collect::<Vec<f32>>();
        let (position, normal) = (device.allows(POSITION), device.allows(NORMAL));
        must(compare(&what("positions"), &flat(&expected.positions), &positions, position, scale));
        must(compare(&what("normals"), &flat(&expected.normals), &normals, normal, 1.0));
        must(compare(&what("radii"), &expected.radii, &radii, crate::tolerance::EXACT, 1.0));
        let levels: Vec<u32> = found.iter().map(|p| p.level).collect();
        let new = step.level.step + 1;
        let record = |i: usize| expected.seen(i).record.wrapping_add(1) << LEVEL_BITS;
        let level = |i: usize| record(i) | if i < n { 0 } else { new };
        let expected: Vec<u32> = (0..found.len()).map(level).collect();
        must(compare_equal(&what("levels"), &expected, &levels));
    }
}
