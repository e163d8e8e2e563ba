//! Pictures that were looked at and found right, in `tests/golden`.

use crate::comparator::{assert_alike, compare};
use crate::files::read_png;
use crate::painters::Painter;
use crate::scenes::{CLEAR, Creases, Scene, cube, flip, sphere, torus};
use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use surfine_points::Vec3;
use surfine_render::{Coloring, View};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

/// Every scene, by the name of its picture.
fn scenes() -> Vec<(&'static str, Scene)> {
    let colored = |points, coloring| Scene::new(&points).style(|style| style.coloring = coloring);
    let painted = |coloring| {
        let points = sphere(2);
        // Stripes along y, their colours far apart.
        let stripe = |p: &Vec3| {
            [[230, 60, 40], [40, 160, 70], [50, 80, 220]][(3.0 * p.y + 6.0) as usize % 3]
        };
        let paint: Vec<[u8; 3]> = points.positions.iter().map(stripe).collect();
        Scene::painted(&points, Some(&paint)).style(|style| style.coloring = coloring)
    };
    let mut patch = sphere(2);
    flip(&mut patch, |p| p.dot(View::Iso.direction()) > 0.9);
    vec![
        ("sphere-before", Scene::new(&sphere(0))),
        ("sphere-after", Scene::new(&sphere(2))),
        ("torus-before", Scene::new(&torus(0))),
        ("torus-after", Scene::new(&torus(2))),
        ("cube", Scene::new(&cube(Creases::Properties))),
        ("normal", colored(torus(2), Coloring::Normal)),
        ("radius", colored(torus(2), Coloring::Radius { low: 0.02, high: 0.2 })),
        ("level", colored(torus(2), Coloring::Level { high: 2.0 })),
        ("paint", painted(Coloring::Paint)),
        ("data", painted(Coloring::Data)),
        ("dots", Scene::new(&torus(0)).style(|style| style.dots = Some(1.5))),
        ("transparent", Scene::new(&torus(2)).style(|style| style.background = CLEAR)),
        ("flipped-patch", Scene::new(&patch)),
    ]
}

#[test]
fn pictures_are_as_they_were() {
    let update = std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1");
    let mut failures = Vec::new();
    for (name, scene) in scenes() {
        let path = folder().join(name).with_extension("png");
        if update {
            Painter::Cpu.draw(&scene).write_png(&path).unwrap();
        }
        let golden = read_png(&path);
        for painter in Painter::BOTH {
            let what = format!("{name}-{}", painter.name());
            failures.extend(compare(&what, &golden, &painter.draw(&scene)).err());
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    let files = fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().file_name());
    let files: BTreeSet<String> = files.map(|name| name.into_string().unwrap()).collect();
    let names = scenes().into_iter().map(|(name, _)| format!("{name}.png")).collect();
    assert_eq!(files, names, "a file without a scene");
}

#[test]
fn both_ways_to_tell_creases_give_one_picture() {
    for painter in Painter::BOTH {
        let [expected, found] = [Creases::Properties, Creases::Records]
            .map(|creases| painter.draw(&Scene::new(&cube(creases))));
        assert_alike(&format!("cube-records-{}", painter.name()), &expected, &found);
    }
}
