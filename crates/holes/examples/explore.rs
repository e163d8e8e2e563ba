//! explore
use surfine_holes::*;
use surfine_points::*;
fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    if args[0] == "fill" {
        let (points, source) = ply::read(args[1].as_ref()).unwrap();
        let ids: Vec<u32> = args[2].split(',').map(|i| i.parse().unwrap()).collect();
        let all = loops(&points);
        let chosen: Vec<Loop> = all.into_iter().filter(|l| ids.contains(&l.id)).collect();
        let filled = fill_holes(&points, &Choice::Ids(ids)).unwrap();
        println!("restored {} kept {}", filled.restored, filled.kept_raised);
        for f in &filled.fills { println!("{f:?}"); }
        measure(&filled.points, points.len(), &chosen);
        ply::write(args[3].as_ref(), &filled.points, None, &source, ply::Encoding::Binary).unwrap();
        return;
    }
    for path in args {
        let (points, _) = match surfine_points::ply::read(path.as_ref()) { Ok(p) => p, Err(e) => { println!("{path}: {e}"); continue } };
        let t = std::time::Instant::now();
        let found = loops(&points);
        println!("{path}: {} points, {} loops, {:?}", points.len(), found.len(), t.elapsed());
        for l in found.iter().take(16) {
            println!("   {} {} points span {:.4} = {:.2} s, perimeter {:.2} s, turning {:.0} {} width {:.2}", l.id, l.points.len(), l.span, l.span / l.spacing(), l.perimeter / l.spacing(), l.turning.to_degrees(), l.kind(), l.width.unwrap_or(9e9) / l.spacing());
        }
    }
}
fn measure(p: &PointSet, n: usize, loops: &[Loop]) {
    let near: Vec<(f32, f32)> = (0..p.len()).map(|i| {
        let mut d: Vec<(f32, usize)> = (0..p.len()).filter(|&j| j != i).map(|j| ((p.positions[j] - p.positions[i]).length(), j)).collect();
        d.sort_by(|a, b| a.0.total_cmp(&b.0));
        let a = d[..6].iter().map(|x| p.normals[x.1].dot(p.normals[i]).clamp(-1.0, 1.0).acos().to_degrees()).sum::<f32>() / 6.0;
        (d[0].0, a)
    }).collect();
    let stat = |w: &[usize]| {
        let k = w.len() as f32;
        let m = w.iter().map(|&i| near[i].0).sum::<f32>() / k;
        let v = w.iter().map(|&i| (near[i].0 - m).powi(2)).sum::<f32>() / k;
        let a = w.iter().map(|&i| near[i].1).sum::<f32>() / k;
        println!("  {} points nn {m:.5} cv {:.3} normal to 6 nearest {a:.2} max {:.2}", w.len(), v.sqrt() / m, w.iter().map(|&i| near[i].1).fold(0.0, f32::max));
    };
    for l in loops {
        let c = l.points.iter().map(|&q| p.positions[q as usize]).sum::<Vec3>() / l.points.len() as f32;
        let inside: Vec<usize> = (n..p.len()).filter(|&i| (p.positions[i] - c).length() < l.span).collect();
        let around: Vec<usize> = (0..n).filter(|&i| (p.positions[i] - c).length() < 1.5 * l.span).collect();
        stat(&inside); stat(&around);
    }
}
