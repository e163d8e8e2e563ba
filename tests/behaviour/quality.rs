//! measuring
use crate::clouds::*;
use crate::measure::*;
use std::time::Instant;
use surfine_points::shapes::{Shape, icosphere};

#[test]
fn a_measure() {
    let t = Instant::now();
    println!("ico {:?} {:?}", refine(&icosphere(3), &levels(3)).level_sizes, t.elapsed());
    for seed in 1..=6 {
        let t = Instant::now();
        let r = refine(&blue_noise(Shape::Sphere, 1000, seed), &levels(4));
        let e = t.elapsed();
        println!(
            "sphere {:?} total {} cv {} d {:e} n {} {:?} {:?}",
            growths(&r),
            (r.points.len() as f64 / 1000.).powf(0.25),
            nearest_variation(&r.points),
            mean_distance(&r, Shape::Sphere),
            mean_normal_error(&r, Shape::Sphere),
            e,
            t.elapsed()
        );
    }
    if let Some(m) = model("igea-600-uniform.ply") {
        for seed in 0..6 {
            let t = Instant::now();
            let m = if seed == 0 { m.clone() } else { shuffled(&m, seed) };
            let r = refine(&m, &levels(5));
            let rings: Vec<f64> =
                r.reports.iter().map(|r| r.ring_neighbors as f64 / r.points_in as f64).collect();
            println!(
                "igea {} {:?} rings {:?} cv {} {:?}",
                r.points.len(),
                growths(&r),
                rings,
                nearest_variation(&r.points),
                t.elapsed()
            );
            if seed == 0 {
                let mut last = median(&m.radii);
                for l in 1..=5 {
                    let q = refine(&m, &levels(l));
                    let md = median(&q.points.radii);
                    println!("med ratio {}", last / md);
                    last = md;
                }
            }
        }
    }
    for seed in 1..=5 {
        let t = Instant::now();
        let r = refine(&random(Shape::Torus, 2000, seed), &levels(4));
        let e = t.elapsed();
        let area = 4.0 * std::f64::consts::PI.powi(2) * 0.4;
        let s = (area / r.points.len() as f64).sqrt();
        let cls: Vec<usize> = r.reports.iter().map(|r| r.classes).collect();
        let disc = largest_empty_disc(&r.points, Shape::Torus, 1_000_000) / s;
        println!(
            "torus {:?} mean {} cv {} disc {} {} meannn {} cls {cls:?} {e:?} {:?}",
            growths(&r),
            mean(growths(&r)),
            nearest_variation(&r.points),
            disc,
            disc / 1.0746,
            disc * s / mean(nearest_distances(&r.points)),
            t.elapsed()
        );
    }
    if let Some(m) = model("nefertiti-3500-random.ply") {
        for seed in 0..3 {
            let t = Instant::now();
            let m = if seed == 0 { m.clone() } else { shuffled(&m, seed) };
            let r = refine(&m, &levels(4));
            let balls: Vec<f64> =
                r.reports.iter().map(|r| r.ball_neighbors as f64 / r.points_in as f64).collect();
            let cls: Vec<usize> = r.reports.iter().map(|r| r.classes).collect();
            println!(
                "nef {} {:?} balls {:?} cls {:?} {:?}",
                r.points.len(),
                growths(&r),
                balls,
                cls,
                t.elapsed()
            );
        }
    }
}
