//! Whether both backends gave the same.

use surfine::{PointSet, Refined};

/// The first place where two results differ in their bytes, for people.
pub(super) fn difference(cpu: &Refined, gpu: &Refined) -> Option<String> {
    if cpu.level_sizes != gpu.level_sizes {
        let [cpu, gpu] = [cpu, gpu].map(|r| format!("{:?}", r.level_sizes));
        return Some(format!("the levels have {cpu} points on the CPU and {gpu} on the GPU"));
    }
    let points = cpu.points.len();
    let differs = |&i: &usize| bits(&cpu.points, i) != bits(&gpu.points, i);
    let count = (0..points).filter(differs).count();
    if let Some(first) = (0..points).find(differs) {
        return Some(format!("{count} of {points} points differ, the first is point {first}"));
    }
    let first = cpu.parents.iter().zip(&gpu.parents).position(|(cpu, gpu)| cpu != gpu)?;
    Some(format!("the parents of new point {first} differ"))
}

/// Equal numbers need not have equal bytes.
fn bits(points: &PointSet, i: usize) -> [u32; 7] {
    let ([x, y, z], [nx, ny, nz]) = (points.positions[i].to_array(), points.normals[i].to_array());
    [x, y, z, nx, ny, nz, points.radii[i]].map(f32::to_bits)
}
