//! Models: any cloud or mesh that a PLY file holds, and the points that are drawn of it.

use std::fs;
use std::path::Path;
use surfine_points::ply::{self, Encoding, PlyError};
use surfine_points::shapes::{self, Sampling, Shape, natural_radii};
use surfine_points::{Attribute, DVec3, Model, PointSet, Values, Vec3};

const ENCODINGS: [Encoding; 3] = [Encoding::Ascii, Encoding::Binary, Encoding::BinaryBigEndian];
const INTEGERS: [&str; 6] = ["char", "uchar", "short", "ushort", "int", "uint"];
const XYZ: [&str; 3] = ["float x", "float y", "float z"];

/// What a file is made of: properties as the header has them, and rows with the length before the items of a list.
struct Element {
    name: &'static str,
    properties: Vec<String>,
    rows: Vec<Vec<f64>>,
}

/// The file, written without any code of the crate.
fn encoded(encoding: Encoding, elements: &[Element]) -> Vec<u8> {
    let word = match encoding {
        Encoding::Ascii => "ascii",
        Encoding::Binary => "binary_little_endian",
        Encoding::BinaryBigEndian => "binary_big_endian",
    };
    let mut out = format!("ply\nformat {word} 1.0\n").into_bytes();
    for Element { name, properties, rows } in elements {
        out.extend(format!("element {name} {}\n", rows.len()).bytes());
        properties.iter().for_each(|p| out.extend(format!("property {p}\n").bytes()));
    }
    out.extend(b"end_header\n");
    for Element { properties, rows, .. } in elements {
        for row in rows {
            put_row(&mut out, encoding, properties, row);
        }
    }
    out
}

fn put_row(out: &mut Vec<u8>, encoding: Encoding, properties: &[String], row: &[f64]) {
    let mut values = row.iter().copied();
    for property in properties {
        match property.split(' ').collect::<Vec<_>>()[..] {
            ["list", count, item, _] => {
                let length = values.next().unwrap();
                put(out, encoding, count, length);
                values.by_ref().take(length as usize).for_each(|v| put(out, encoding, item, v));
            }
            [kind, _] => put(out, encoding, kind, values.next().unwrap()),
            _ => panic!("{property}"),
        }
    }
    assert_eq!(values.next(), None);
    if encoding == Encoding::Ascii {
        out.push(b'\n');
    }
}

fn put(out: &mut Vec<u8>, encoding: Encoding, kind: &str, value: f64) {
    if encoding == Encoding::Ascii {
        return out.extend(format!("{value} ").bytes());
    }
    let mut bytes = match kind {
        "char" => (value as i8).to_le_bytes().to_vec(),
        "uchar" => (value as u8).to_le_bytes().to_vec(),
        "short" => (value as i16).to_le_bytes().to_vec(),
        "ushort" => (value as u16).to_le_bytes().to_vec(),
        "int" => (value as i32).to_le_bytes().to_vec(),
        "uint" => (value as u32).to_le_bytes().to_vec(),
        "float" => (value as f32).to_le_bytes().to_vec(),
        "double" => value.to_le_bytes().to_vec(),
        _ => panic!("{kind}"),
    };
    if encoding == Encoding::BinaryBigEndian {
        bytes.reverse();
    }
    out.extend(bytes);
}

/// The corners of a cube of side 2 around the origin: bit 0 of the index says the side in x, bit 1 in y, bit 2 in z.
fn cube_corners() -> Vec<DVec3> {
    let side = |i: u32, bit: u32| f64::from(i >> bit & 1) * 2.0 - 1.0;
    (0..8).map(|i| DVec3::new(side(i, 0), side(i, 1), side(i, 2))).collect()
}

/// Its sides, anticlockwise seen from outside.
const CUBE_SIDES: [[u32; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// The sides cut along the diagonal from their first corner.
fn cube_triangles() -> Vec<[u32; 3]> {
    CUBE_SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}

fn vertices(positions: &[DVec3]) -> Element {
    let rows = positions.iter().map(|p| p.to_array().to_vec()).collect();
    Element { name: "vertex", properties: XYZ.map(String::from).to_vec(), rows }
}

/// An element `face` with these lists of corners.
fn faces(kinds: &str, corners: &[&[i64]]) -> Element {
    let row = |list: &&[i64]| {
        let items = list.iter().map(|&i| i as f64);
        [list.len() as f64].into_iter().chain(items).collect()
    };
    let properties = vec![format!("list {kinds}")];
    Element { name: "face", properties, rows: corners.iter().map(row).collect() }
}

/// The cube with quads.
fn cube_file(encoding: Encoding, kinds: &str) -> Vec<u8> {
    let sides: Vec<Vec<i64>> = CUBE_SIDES.iter().map(|s| s.map(i64::from).to_vec()).collect();
    let sides: Vec<&[i64]> = sides.iter().map(Vec::as_slice).collect();
    encoded(encoding, &[vertices(&cube_corners()), faces(kinds, &sides)])
}

fn try_read(bytes: &[u8]) -> Result<(Model, Vec<String>), PlyError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("input.ply");
    fs::write(&path, bytes).unwrap();
    ply::read_model(&path)
}

fn read(bytes: &[u8]) -> (Model, Vec<String>) {
    try_read(bytes).unwrap()
}

/// What is wrong with a file.
fn refusal(bytes: &[u8]) -> String {
    let text = try_read(bytes).unwrap_err().to_string();
    assert!(text.contains("input.ply: ") && !text.contains(char::is_control), "{text}");
    text
}

#[test]
fn meshes_come_back_in_every_encoding_and_type() {
    let expected = Model::mesh(cube_corners(), cube_triangles());
    for encoding in ENCODINGS {
        for count in INTEGERS {
            for index in INTEGERS {
                for name in ["vertex_indices", "vertex_index"] {
                    let kinds = format!("{count} {index} {name}");
                    let (model, notes) = read(&cube_file(encoding, &kinds));
                    assert_eq!(model, expected, "{encoding:?} {kinds}");
                    assert_eq!(
                        notes,
                        ["6 faces with more than three corners are cut into triangles"]
                    );
                }
            }
        }
    }
}

#[test]
fn polygons_become_fans_and_what_has_no_area_is_dropped() {
    let corners = cube_corners();
    let lists: [&[i64]; 8] = [
        &[4, 3, 2, 1, 0],
        &[],
        &[7],
        &[5, 6],
        &[1, 2, 3],
        &[1, 2, 1],
        &[3, 3, 4, 5],
        &[0, 1, 2, 0],
    ];
    for encoding in ENCODINGS {
        let list = faces("uchar int vertex_indices", &lists);
        let (model, notes) = read(&encoded(encoding, &[vertices(&corners), list]));
        let triangles = [[4, 3, 2], [4, 2, 1], [4, 1, 0], [1, 2, 3], [3, 4, 5], [0, 1, 2]];
        assert_eq!(model.triangles, triangles, "{encoding:?}");
        assert_eq!(
            notes,
            [
                "3 faces with more than three corners are cut into triangles",
                "3 faces with fewer than three corners are left out",
                "3 triangles with two corners in one vertex are left out",
            ]
        );
    }
}

#[test]
fn faces_may_come_before_the_vertices() {
    let list = faces("uchar uint vertex_index", &[&[0, 1, 2]]);
    let (model, notes) = read(&encoded(Encoding::Binary, &[list, vertices(&cube_corners())]));
    assert_eq!(model.triangles, [[0, 1, 2]]);
    assert_eq!(model.positions, cube_corners());
    assert!(notes.is_empty(), "{notes:?}");
}

#[test]
fn corners_that_do_not_exist_are_named() {
    let corners = cube_corners();
    let cases: [(&str, &[i64], &str); 5] = [
        ("uchar int vertex_indices", &[0, 1, 8], "corner 2 is vertex 8,"),
        ("uchar int vertex_indices", &[0, -1, 2], "corner 1 is vertex -1,"),
        ("uchar uint vertex_index", &[4_294_967_295, 1, 2], "corner 0 is vertex 4294967295,"),
        ("int char vertex_index", &[0, 1, 2, -128], "corner 3 is vertex -128,"),
        ("int uchar vertex_index", &[200], "corner 0 is vertex 200,"),
    ];
    for encoding in ENCODINGS {
        for (kinds, wrong, words) in cases {
            let list = faces(kinds, &[&[5, 6, 7], wrong, &[0, 1, 2]]);
            let text = refusal(&encoded(encoding, &[vertices(&corners), list]));
            assert!(text.contains(&format!("face 1: {words}")), "{encoding:?} {text}");
            assert!(text.contains("there are 8: correct the index"), "{text}");
        }
    }
}

#[test]
fn cut_files_and_wild_counts_are_refused() {
    let kinds = "uchar int vertex_indices";
    let binary = cube_file(Encoding::Binary, kinds);
    let cut = |bytes: &[u8], less: usize| refusal(&bytes[..bytes.len() - less]);
    // Six faces of 17 bytes: one byte less, one face less, so little that the header is no longer right.
    let six = "element `face`: the header promises 6 entries, the file ends after";
    for (less, found) in [(1, 5), (17, 5), (18, 4), (99, 3)] {
        let text = cut(&binary, less);
        assert!(text.contains(&format!("{six} {found} (")), "{text}");
    }
    assert!(cut(&binary, 120).contains("element `vertex`: the header promises 8 entries"));
    let ascii = cube_file(Encoding::Ascii, kinds);
    let line = "4 4 5 7 6 \n";
    let text = cut(&ascii, line.len());
    assert!(text.contains(&format!("{six} 5 (")), "{text}");
    let text = cut(&ascii, 5);
    assert!(text.contains("face 5: line 23: the values do not fit the lists"), "{text}");

    let replaced = |bytes: &[u8], from: &str, to: &str| {
        let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
        [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
    };
    for bytes in [&binary, &ascii] {
        for count in ["4000000000", "18446744073709551615"] {
            let text = refusal(&replaced(bytes, "face 6", &format!("face {count}")));
            assert!(
                text.contains(&format!("element `face`: the header promises {count}")),
                "{text}"
            );
            let text = refusal(&replaced(bytes, "vertex 8", &format!("vertex {count}")));
            assert!(
                text.contains(&format!("element `vertex`: the header promises {count}")),
                "{text}"
            );
        }
        let fewer = refusal(&replaced(bytes, "face 6", "face 5"));
        assert!(fewer.contains("bytes follow the last entry"), "{fewer}");
    }
    // A list of four thousand million corners in a file of some bytes.
    let list = Element {
        name: "face",
        properties: vec!["list uint uchar vertex_index".into()],
        rows: vec![vec![4e9, 1.0, 2.0]],
    };
    let text = refusal(&encoded(Encoding::BinaryBigEndian, &[vertices(&cube_corners()), list]));
    assert!(text.contains("element `face`: the header promises 1 entries"), "{text}");
}

#[test]
fn coordinates_are_needed_and_must_be_usable() {
    let with = |kind: &str, value: f64| {
        let properties = ["float x", "float y", kind].map(String::from).to_vec();
        let rows = vec![vec![1.0, 2.0, 3.0], vec![1.0, 2.0, value]];
        encoded(Encoding::Binary, &[Element { name: "vertex", properties, rows }])
    };
    for value in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        for kind in ["float z", "double z"] {
            let text = refusal(&with(kind, value));
            assert!(
                text.contains("vertex 1: a coordinate is not finite: remove or repair"),
                "{text}"
            );
        }
    }
    let text = refusal(&with("double z", -2e15));
    assert!(text.contains("vertex 1: coordinate 2e15 is beyond ±1e15: move or scale"), "{text}");
    assert_eq!(read(&with("double z", 1e15)).0.positions[1].z, 1e15);
    let text = refusal(&with("float w", 0.0));
    assert!(text.contains("element `vertex` has no `z`: add the coordinates x y z"), "{text}");
    assert!(!text.contains("radius") && !text.contains("normals"), "{text}");
    let text = refusal(&with("list uchar float z", 0.0));
    assert!(text.contains("no `z` that is no list"), "{text}");
    let text = refusal(&encoded(Encoding::Ascii, &[faces("uchar int vertex_index", &[&[]])]));
    assert!(text.contains("there is no element `vertex`"), "{text}");
}

/// A vertex element with one vertex: `x y z` and what is added, all 1.
fn one_vertex(more: &[&str]) -> Vec<u8> {
    let properties: Vec<String> = XYZ.iter().chain(more).map(|p| (*p).into()).collect();
    let rows = vec![vec![1.0; properties.len()]];
    encoded(Encoding::Ascii, &[Element { name: "vertex", properties, rows }])
}

#[test]
fn normals_and_radii_may_be_missing() {
    let (model, notes) = read(&one_vertex(&[]));
    assert_eq!(model, Model { positions: vec![DVec3::ONE], ..Model::default() });
    assert!(notes.is_empty(), "{notes:?}");
    let (model, notes) = read(&one_vertex(&["double nz", "uchar radius", "float nx", "char ny"]));
    assert_eq!(model.normals, Some(vec![Vec3::ONE]));
    assert_eq!(model.radii, Some(vec![1.0]));
    assert!(model.attributes.is_empty() && notes.is_empty());
    for (some, named) in
        [(&["float nx", "float nz"][..], "`nx` and `nz`"), (&["double ny"], "`ny`")]
    {
        let (model, notes) = read(&one_vertex(&[some, &["int class"]].concat()));
        assert_eq!(model.normals, None);
        assert_eq!(model.attributes, [Attribute::new("class", Values::I32(vec![1]))]);
        assert_eq!(notes.len(), 1);
        assert!(notes[0].starts_with(&format!("{named} alone make no normals")), "{notes:?}");
    }
}

#[test]
fn what_is_left_out_is_noted() {
    let element = |name: &'static str, properties: &[&str], row: &[f64]| Element {
        name,
        properties: properties.iter().map(|p| (*p).into()).collect(),
        rows: vec![row.to_vec()],
    };
    let elements = [
        element("camera", &["float f"], &[50.0]),
        Element { rows: Vec::new(), ..element("nothing", &[], &[]) },
        element("tristrips", &["list int int vertex_indices"], &[3.0, 0.0, 0.0, 0.0]),
        element(
            "vertex",
            &["list uchar int tags", "float x", "float y", "float z", "list uchar float nx"],
            &[2.0, 8.0, 9.0, 1.0, 2.0, 3.0, 1.0, 0.5],
        ),
        element(
            "face",
            &["uchar red", "list uchar float texcoord", "list uchar int vertex_indices"],
            &[9.0, 1.0, 0.5, 0.0],
        ),
    ];
    for encoding in ENCODINGS {
        let (model, notes) = read(&encoded(encoding, &elements));
        assert_eq!(model, Model { positions: vec![DVec3::new(1.0, 2.0, 3.0)], ..Model::default() });
        assert_eq!(
            notes,
            [
                "`camera` element with 1 entries is not read: only points and triangles are",
                "`tristrips` element with 1 entries is not read: write the triangles as an element `face`",
                "`red`, `texcoord` of 1 faces are not read: only their corners are",
                "list property `tags` of 1 points is not read: attributes are single numbers",
                "list property `nx` of 1 points is not read: attributes are single numbers",
                "1 faces with fewer than three corners are left out",
            ]
        );
    }
    let odd = ["list uchar double vertex_indices", "list uchar int corners"];
    let face = element("face", &odd, &[3.0, 0.0, 0.0, 0.0, 0.0]);
    let (model, notes) = read(&encoded(Encoding::Binary, &[vertices(&[DVec3::ZERO]), face]));
    assert!(!model.is_mesh());
    assert_eq!(notes.len(), 1);
    assert!(
        notes[0].contains("`face` element with 1 entries is not read: it has no list of integers")
    );
}

#[test]
fn lists_of_corners_are_told_from_other_lists() {
    let other = "list uchar int others";
    let [first, second] = ["list uchar int vertex_indices", "list uchar int vertex_index"];
    let cases = [[other, first, second], [second, other, first], [first, second, other]];
    for order in cases {
        let list = |name: &str| match name {
            name if name == first => [3.0, 0.0, 1.0, 2.0],
            name if name == second => [3.0, 5.0, 6.0, 7.0],
            _ => [3.0, 99.0, 99.0, 99.0],
        };
        let row = order.iter().flat_map(|name| list(name)).collect();
        let face =
            Element { name: "face", properties: order.map(String::from).to_vec(), rows: vec![row] };
        let (model, _) = read(&encoded(Encoding::Binary, &[vertices(&cube_corners()), face]));
        assert_eq!(model.triangles, [[0, 1, 2]], "{order:?}");
    }
}

#[test]
fn attributes_keep_their_types_and_reach_the_points() {
    let kinds =
        ["uchar red", "uchar green", "uchar blue", "float quality", "short class", "double t"];
    let properties = XYZ.iter().chain(&kinds).map(|p| (*p).into()).collect();
    let rows = vec![
        vec![0.0, 0.0, 0.0, 255.0, 128.0, 0.0, 0.25, -7.0, 0.1],
        vec![1.0, 0.0, 0.0, 1.0, 2.0, 3.0, -0.5, 300.0, 1e300],
    ];
    let elements = [Element { name: "vertex", properties, rows }];
    for encoding in ENCODINGS {
        let (model, notes) = read(&encoded(encoding, &elements));
        let expected = [
            Attribute::new("red", Values::U8(vec![255, 1])),
            Attribute::new("green", Values::U8(vec![128, 2])),
            Attribute::new("blue", Values::U8(vec![0, 3])),
            Attribute::new("quality", Values::F32(vec![0.25, -0.5])),
            Attribute::new("class", Values::I16(vec![-7, 300])),
            Attribute::new("t", Values::F64(vec![0.1, 1e300])),
        ];
        assert_eq!(model.attributes, expected);
        assert_eq!(model.colors(), Some(vec![[255, 128, 0], [1, 2, 3]]));
        assert_eq!(model.to_points().0.attributes, expected);
        assert!(notes.is_empty());
    }
}

#[test]
fn doubles_far_from_the_origin_lose_nothing() {
    let positions = [
        DVec3::new(412_345.678_901_234, -4_234_567.123_456_7, 0.5),
        DVec3::new(412_445.1, -4_234_467.2, 100.25),
    ];
    let properties = ["double x", "double y", "float z"].map(String::from).to_vec();
    let rows = positions.iter().map(|p| p.to_array().to_vec()).collect();
    let elements = [Element { name: "vertex", properties, rows }];
    for encoding in ENCODINGS {
        let (model, _) = read(&encoded(encoding, &elements));
        assert_eq!(model.positions, positions);
        let (points, _) = model.to_points();
        assert_eq!(points.origin.z, 0.0);
        assert_eq!(points.positions.iter().map(|p| p.z).collect::<Vec<_>>(), [0.5, 100.25]);
        for (near, far) in points.positions.iter().zip(positions) {
            assert!(near.abs().max_element() < 200.0, "{near}");
            assert!((points.origin + near.as_dvec3()).distance(far) < 1e-5);
        }
    }
}

#[test]
fn floats_stay_bit_for_bit_with_origin_zero() {
    let floats = [Vec3::new(-0.0, 16_777_216.0, 1e-42), Vec3::new(0.1, 16_777_218.0, 1e15)];
    let positions = floats.iter().map(|p| p.as_dvec3()).collect();
    let (points, made) = Model { positions, ..Model::default() }.to_points();
    assert_eq!(points.origin, DVec3::ZERO);
    let bits = |v: &Vec3| v.to_array().map(f32::to_bits);
    assert!(points.positions.iter().map(bits).eq(floats.iter().map(bits)));
    // A cloud of bare points is drawn as dots.
    assert_eq!((points.normals, points.radii), (vec![Vec3::ZERO; 2], vec![0.0; 2]));
    assert_eq!(made, Default::default());
    let empty = Model::default().to_points();
    assert_eq!(empty, (PointSet::default(), Default::default()));
}

#[test]
fn what_read_takes_is_the_same_model() {
    let folder = tempfile::tempdir().unwrap();
    let mut points = shapes::sample(Shape::Torus, Sampling::Random, 50, 3);
    points.attributes = vec![Attribute::new("class", Values::U16((0..50).collect()))];
    let path = folder.path().join("points.ply");
    for encoding in ENCODINGS {
        ply::write(&path, &points, None, &ply::Source::default(), encoding).unwrap();
        let (model, notes) = ply::read_model(&path).unwrap();
        assert_eq!(model, Model::from(&points));
        assert!(notes.is_empty(), "{notes:?}");
        assert_eq!(model.to_points(), (points.clone(), Default::default()));
    }
}

#[test]
fn the_normals_of_a_cube_point_along_its_diagonals() {
    // Whichever way the sides are cut: the angle counts, not the number of triangles or their area.
    let other_way = CUBE_SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, d], [b, c, d]]);
    for triangles in [cube_triangles(), other_way.collect()] {
        let model = Model::mesh(cube_corners(), triangles);
        for (normal, corner) in model.vertex_normals().iter().zip(cube_corners()) {
            assert!(normal.distance(corner / 3f64.sqrt()) < 1e-15, "{normal} at {corner}");
        }
        let (points, made) = model.to_points();
        assert_eq!((made.made_normals, made.made_radii), (8, 8));
        assert!(points.normals[7].distance(Vec3::splat(3f32.sqrt().recip())) < 1e-7);
    }
}

/// A unit sphere of meridians and parallels around `center`.
fn sphere(center: DVec3, rings: u32, sectors: u32) -> Model {
    let mut positions = vec![center - DVec3::Z];
    let mut triangles = Vec::new();
    let index = |ring: u32, sector: u32| match ring {
        0 => 0,
        ring if ring == rings => (rings - 1) * sectors + 1,
        ring => (ring - 1) * sectors + sector % sectors + 1,
    };
    for ring in 1..rings {
        let (radius, z) = (std::f64::consts::PI / f64::from(rings) * f64::from(ring)).sin_cos();
        for sector in 0..sectors {
            let (y, x) = (std::f64::consts::TAU / f64::from(sectors) * f64::from(sector)).sin_cos();
            positions.push(center + DVec3::new(radius * x, radius * y, -z));
        }
    }
    positions.push(center + DVec3::Z);
    for (ring, sector) in (0..rings).flat_map(|r| (0..sectors).map(move |s| (r, s))) {
        let [a, b] = [index(ring, sector), index(ring, sector + 1)];
        let [c, d] = [index(ring + 1, sector + 1), index(ring + 1, sector)];
        triangles.extend([[a, b, c], [a, c, d]].iter().filter(|t| t[0] != t[1] && t[1] != t[2]));
    }
    Model::mesh(positions, triangles)
}

#[test]
fn the_normals_of_a_sphere_point_outward() {
    // Far away, where 32-bit coordinates would be off by half a unit.
    let center = DVec3::new(6_000_000.3, -5e6, 0.0);
    let model = sphere(center, 40, 80);
    for (normal, position) in model.vertex_normals().iter().zip(&model.positions) {
        assert!((normal.length() - 1.0).abs() < 1e-12);
        assert!(normal.distance(position - center) < 0.01, "{normal} at {}", position - center);
    }
    let (points, _) = model.to_points();
    assert_ne!(points.origin, DVec3::ZERO);
    for (p, n) in points.positions.iter().zip(&points.normals) {
        let outward = (points.origin - center).as_vec3() + *p;
        assert!(outward.distance(*n) < 0.01);
    }
}

#[test]
fn radii_of_a_mesh_reach_beyond_its_edges() {
    let positions = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [9.0; 3], [0.0, 0.0, 12.0]];
    let model = Model::mesh(positions.map(DVec3::from).to_vec(), vec![[0, 1, 2]]);
    let (points, made) = model.to_points();
    assert_eq!(points.radii, [5.0, 6.25, 6.25, 0.0, 0.0]);
    // Vertices that no triangle has stay as dots.
    assert_eq!(points.normals, [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::ZERO, Vec3::ZERO]);
    assert_eq!((made.made_radii, made.made_normals), (3, 3));
    let two = Model { triangles: vec![[0, 1, 2], [4, 2, 0]], ..model };
    assert_eq!(two.longest_edges(), [12.0, 5.0, 160f64.sqrt(), 0.0, 160f64.sqrt()]);
}

#[test]
fn normals_and_radii_of_the_file_are_mended() {
    let normals = vec![
        Vec3::new(0.0, 0.6, 0.8),
        Vec3::new(0.0, 3.0, 4.0),
        Vec3::ZERO,
        Vec3::new(f32::NAN, 0.0, 1.0),
        Vec3::new(0.0, f32::INFINITY, 0.0),
        Vec3::new(0.0, 0.0, -1e-40),
        Vec3::new(3e38, 0.0, 0.0),
    ];
    let radii = vec![0.5, 0.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38];
    let positions = cube_corners()[..7].to_vec();
    // The normals of the file win over those of the triangles.
    for triangles in [Vec::new(), vec![[0, 1, 2]]] {
        let (normals, radii) = (Some(normals.clone()), Some(radii.clone()));
        let model =
            Model { normals, radii, triangles, ..Model::mesh(positions.clone(), Vec::new()) };
        let (points, made) = model.to_points();
        let [a, b, up] = [Vec3::new(0.0, 0.6, 0.8), Vec3::ZERO, Vec3::NEG_Z];
        assert_eq!(points.normals, [a, a, b, b, b, up, Vec3::X]);
        assert_eq!(points.radii, [0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 3e38]);
        assert_eq!((made.scaled_normals, made.unusable_normals), (3, 3));
        assert_eq!((made.made_normals, made.made_radii, made.unusable_radii), (0, 0, 4));
    }
}

#[test]
fn radii_of_a_cloud_with_normals_are_natural() {
    let cloud = shapes::sample(Shape::Torus, Sampling::BlueNoise, 500, 1);
    let model = Model { radii: None, ..Model::from(&cloud) };
    let (points, made) = model.to_points();
    assert_eq!(points.radii, natural_radii(&cloud.positions, &cloud.normals));
    assert_eq!((made.made_radii, made.made_normals), (500, 0));
    assert_eq!(Model { normals: None, ..model }.to_points().0.radii, [0.0; 500]);
}

#[test]
fn doubles_of_a_point_change_no_radius() {
    // The first point's neighbour on the left is far beyond the spacing that doubles of the second would make.
    let places =
        [[0.0, 0.0], [1.0, 0.0], [1.5, 0.7], [1.5, -0.7], [2.0, 1.5], [2.0, -1.5], [2.5, 0.0]];
    let places = places.iter().chain(&[[-4.5, 0.0]]).map(|&[x, y]| Vec3::new(x, y, 0.0));
    let cloud = PointSet::new(places.collect(), vec![Vec3::Z; 8], vec![1.0; 8]);
    let mut model = Model { radii: None, ..Model::from(&cloud) };
    let natural = natural_radii(&cloud.positions, &cloud.normals);
    assert_eq!(natural[0], 1.25 * 4.5);
    model.positions.extend([DVec3::X; 30]);
    model.normals.as_mut().unwrap().extend([Vec3::Z; 30]);
    let radii = model.to_points().0.radii;
    assert_eq!(radii[..8], natural);
    assert_eq!(radii[8..], [natural[1]; 30]);
}

/// The files that the project is tried on, where they are at hand.
#[test]
fn the_test_data_can_be_looked_at() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    for sub in ["points", "analytic", "mesh"] {
        let Ok(entries) = fs::read_dir(data.join(sub)) else { continue };
        let paths = entries.map(|entry| entry.unwrap().path());
        for path in paths.filter(|path| path.extension().is_some_and(|e| e == "ply")) {
            let name = path.to_string_lossy();
            let (model, notes) = ply::read_model(&path).unwrap();
            assert!(notes.is_empty(), "{name}: {notes:?}");
            assert!(!model.is_empty(), "{name}");
            assert_eq!(model.is_mesh(), sub == "mesh", "{name}");
            if name.ends_with("igea.ply") {
                assert_eq!((model.len(), model.triangles.len()), (134_345, 268_686));
                let (points, made) = model.to_points();
                assert_eq!((made.made_normals, made.made_radii), (134_345, 134_345));
                assert!(points.validate().is_ok());
            }
        }
    }
}

#[test]
fn radii_are_made_in_any_unit() {
    let one = shapes::sample(Shape::Sphere, Sampling::BlueNoise, 200, 1);
    let radii = |scale: f64| {
        let positions = one.positions.iter().map(|p| scale * p.as_dvec3()).collect();
        let model = Model { positions, normals: Some(one.normals.clone()), ..Model::default() };
        model.to_points().0.radii
    };
    for scale in [1e-22, 1e-12, 1e15] {
        for (found, expected) in radii(scale).iter().zip(radii(1.0)) {
            let ratio = f64::from(*found) / scale / f64::from(expected);
            assert!((ratio - 1.0).abs() < 1e-5, "{scale}: {found} of {expected}");
        }
    }
}
