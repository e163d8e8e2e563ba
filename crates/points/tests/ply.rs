//! PLY files: round trips bit for bit, and files that mean harm.

use std::fs;
use std::path::{Path, PathBuf};
use surfine_points::ply::{self, Encoding, PlyError, Provenance, Source};
use surfine_points::{Attribute, DVec3, PointSet, Values, Vec3};
use tempfile::TempDir;

const ENCODINGS: [Encoding; 3] = [Encoding::Ascii, Encoding::Binary, Encoding::BinaryBigEndian];
const CORE: &str = "property float x\nproperty float y\nproperty float z\nproperty float nx\n\
    property float ny\nproperty float nz\nproperty float radius\n";

/// A folder for the files of one test.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path("input.ply");
        fs::write(&path, bytes).unwrap();
        path
    }

    /// What `read` makes of a file with these bytes.
    fn read(&self, bytes: impl AsRef<[u8]>) -> Result<(PointSet, Source), PlyError> {
        ply::read(&self.file(bytes))
    }

    fn write(&self, points: &PointSet, source: &Source, encoding: Encoding) -> Vec<u8> {
        let path = self.path("output.ply");
        ply::write(&path, points, None, source, encoding).unwrap();
        fs::read(path).unwrap()
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }
}

/// An ASCII file of points with the usual properties.
fn ascii(count: &str, rows: &str) -> String {
    format!("ply\nformat ascii 1.0\nelement vertex {count}\n{CORE}end_header\n{rows}")
}

/// A binary file with a body of one kind of scalar.
fn binary(header: &str, body: &[u8]) -> Vec<u8> {
    let mut bytes =
        format!("ply\nformat binary_little_endian 1.0\n{header}end_header\n").into_bytes();
    bytes.extend(body);
    bytes
}

const ROW: &str = "1 2 3 0 0 1 0.5\n";

fn row_bytes() -> Vec<u8> {
    [1.0f32, 2.0, 3.0, 0.0, 0.0, 1.0, 0.5].iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Points with every type of attribute and awkward values.
fn rich() -> PointSet {
    let mut points = PointSet::new(
        vec![Vec3::new(-0.0, 1e-42, 3.4e14), Vec3::new(0.1, -1e-7, 16_777_217.0), Vec3::ZERO],
        vec![Vec3::X, Vec3::new(-0.0, 0.6, -0.8), Vec3::new(1e-40, 0.0, 2.0)],
        vec![1e-9, 0.333_333_34, 7e14],
    );
    let columns = [
        ("red", Values::U8(vec![0, 255, 7])),
        ("a", Values::I8(vec![-128, 127, 0])),
        ("b", Values::I16(vec![i16::MIN, i16::MAX, -1])),
        ("c", Values::U16(vec![0, u16::MAX, 1])),
        ("d", Values::I32(vec![i32::MIN, i32::MAX, -1])),
        ("e", Values::U32(vec![0, u32::MAX, 1])),
        ("f", Values::F32(vec![-0.0, f32::MIN_POSITIVE / 8.0, f32::MAX])),
        ("g", Values::F64(vec![-0.0, 5e-324, f64::MIN])),
        ("h", Values::F64(vec![0.1, 1.0 / 3.0, 123_456_789.012_345_67])),
    ];
    points.attributes = columns.map(|(name, values)| Attribute::new(name, values)).into();
    points
}

/// Equality of bits: of zeros with their signs and of NaN.
fn assert_same_bits(a: &PointSet, b: &PointSet) {
    let bits = |v: &[Vec3]| v.iter().map(|v| v.to_array().map(f32::to_bits)).collect::<Vec<_>>();
    assert_eq!(bits(&a.positions), bits(&b.positions));
    assert_eq!(bits(&a.normals), bits(&b.normals));
    assert_eq!(a.radii, b.radii);
    assert_eq!(a.origin, b.origin);
    assert_eq!(a.attributes.len(), b.attributes.len());
    for (a, b) in a.attributes.iter().zip(&b.attributes) {
        assert_eq!((&a.name, a.interpolation), (&b.name, b.interpolation));
        match (&a.values, &b.values) {
            (Values::F32(a), Values::F32(b)) => {
                assert!(a.iter().map(|v| v.to_bits()).eq(b.iter().map(|v| v.to_bits())));
            }
            (Values::F64(a), Values::F64(b)) => {
                assert!(a.iter().map(|v| v.to_bits()).eq(b.iter().map(|v| v.to_bits())));
            }
            (a, b) => assert_eq!(a, b),
        }
    }
}

#[test]
fn every_type_survives_in_every_encoding() {
    let folder = Folder::new();
    let points = rich();
    for encoding in ENCODINGS {
        let bytes = folder.write(&points, &Source::default(), encoding);
        let (again, source) = folder.read(&bytes).unwrap();
        assert_same_bits(&points, &again);
        assert_eq!(source.encoding, encoding);
        assert!(source.notes.is_empty(), "{:?}", source.notes);
        // Through each other encoding and back to the same bytes.
        for other in ENCODINGS {
            let (there, source) = folder.read(folder.write(&again, &source, other)).unwrap();
            assert_eq!(folder.write(&there, &source, encoding), bytes, "{encoding:?} {other:?}");
        }
    }
}

#[test]
fn the_parser_of_the_crate_reads_what_we_write() {
    use ply_rs_bw::parser::Parser;
    use ply_rs_bw::ply::{DefaultElement, Property};
    let folder = Folder::new();
    for encoding in ENCODINGS {
        let bytes = folder.write(&rich(), &Source::default(), encoding);
        let file = Parser::<DefaultElement>::new().read_ply(&mut bytes.as_slice()).unwrap();
        let row = &file.payload["vertex"][1];
        assert_eq!(row["x"], Property::Float(0.1));
        assert_eq!(row["a"], Property::Char(127));
        assert_eq!(row["b"], Property::Short(i16::MAX));
        assert_eq!(row["e"], Property::UInt(u32::MAX));
        assert_eq!(row["g"], Property::Double(5e-324));
        assert_eq!(file.payload["vertex"].len(), 3);
    }
}

#[test]
fn nan_in_attributes_keeps_its_payload_in_binary() {
    let folder = Folder::new();
    let mut points = rich();
    let f = vec![f32::from_bits(0x7fc0_1234), f32::from_bits(0xffc0_0001), f32::NEG_INFINITY];
    let g = vec![f64::from_bits(0x7ff8_0000_dead_beef), f64::INFINITY, f64::from_bits(u64::MAX)];
    points.attributes[6].values = Values::F32(f);
    points.attributes[7].values = Values::F64(g);
    for encoding in [Encoding::Binary, Encoding::BinaryBigEndian] {
        let (again, _) = folder.read(folder.write(&points, &Source::default(), encoding)).unwrap();
        assert_same_bits(&points, &again);
    }
    let path = folder.path("nan.ply");
    let error = ply::write(&path, &points, None, &Source::default(), Encoding::Ascii).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("nan.ply") && text.contains("`f`") && text.contains("vertex 0"),
        "{text}"
    );
    assert!(!path.exists());
}

#[test]
fn decimals_are_as_short_as_they_can_be() {
    let folder = Folder::new();
    let mut points = PointSet::new(vec![Vec3::new(0.1, -0.0, 1e12)], vec![Vec3::Z], vec![0.25]);
    points.attributes = vec![Attribute::new("w", Values::F64(vec![f64::MAX]))];
    let bytes = folder.write(&points, &Source::default(), Encoding::Ascii);
    let text = String::from_utf8(bytes).unwrap();
    assert!(
        text.ends_with("end_header\n0.1 -0 1e12 0 0 1 0.25 1.7976931348623157e308\n"),
        "{text}"
    );
}

/// Large coordinates in double precision, properties in an unusual order, attributes between them.
fn surveyed() -> Vec<u8> {
    let header = "comment made by a survey\nobj_info zone 33N\nelement vertex 3\nproperty uchar class\n\
        property float radius\nproperty double y\nproperty double x\nproperty float z\n\
        property float nz\nproperty double ny\nproperty float nx\nproperty double time\n";
    let mut body = Vec::new();
    for i in 0..3u8 {
        let t = f64::from(i);
        body.push(i);
        body.extend((0.5f32 + f32::from(i)).to_le_bytes());
        body.extend((4_234_567.123_456_7 + t * 1.000_000_1).to_le_bytes());
        body.extend((412_345.678_901_2 - t / 3.0).to_le_bytes());
        body.extend((100.1f32 * f32::from(i)).to_le_bytes());
        body.extend(1.0f32.to_le_bytes());
        body.extend((1e-9 * t).to_le_bytes());
        body.extend((-0.0f32).to_le_bytes());
        body.extend((t * 0.1).to_le_bytes());
    }
    binary(header, &body)
}

#[test]
fn doubles_with_large_offsets_survive() {
    let folder = Folder::new();
    let bytes = surveyed();
    let (points, source) = folder.read(&bytes).unwrap();
    assert!(points.positions.iter().all(|p| p.abs().max_element() < 512.0));
    assert!((points.origin - DVec3::new(412_345.0, 4_234_567.0, 0.0)).abs().max_element() < 256.0);
    assert_eq!(points.origin, points.origin.round());
    assert_eq!(folder.write(&points, &source, Encoding::Binary), bytes);
    for encoding in [Encoding::Ascii, Encoding::BinaryBigEndian] {
        let (there, source) = folder.read(folder.write(&points, &source, encoding)).unwrap();
        assert_eq!(folder.write(&there, &source, Encoding::Binary), bytes, "{encoding:?}");
    }
}

#[test]
fn new_points_follow_the_old_ones() {
    let folder = Folder::new();
    let bytes = surveyed();
    let (mut points, source) = folder.read(&bytes).unwrap();
    let added = Vec3::new(1.5, 2.5, 7.0);
    points.positions.push(added);
    points.normals.push(Vec3::Z);
    points.radii.push(0.25);
    // The engine may change a radius of an old point.
    points.radii[1] = 9.0;
    points.extend_attributes(&[[0, 1, 2]]);
    let path = folder.path("refined.ply");
    let provenance = Provenance { levels: &[0, 0, 0, 1], parents: &[[0, 1, 2]] };
    ply::write(&path, &points, Some(provenance), &source, Encoding::Binary).unwrap();
    let (again, source) = ply::read(&path).unwrap();
    let parent = |name: &str| again.attribute(name).unwrap().values.clone();
    assert_eq!(parent("level"), Values::U8(vec![0, 0, 0, 1]));
    assert_eq!(parent("parent0"), Values::I32(vec![-1, -1, -1, 0]));
    assert_eq!(parent("parent2"), Values::I32(vec![-1, -1, -1, 2]));
    let place = again.origin + again.positions[3].as_dvec3();
    assert!((place - (points.origin + added.as_dvec3())).abs().max_element() < 1e-4);
    assert_eq!(again.radii, [0.5, 9.0, 2.5, 0.25]);
    assert_eq!(
        source.remarks().collect::<Vec<_>>(),
        ["comment made by a survey", "obj_info zone 33N"]
    );
    let text = fs::read(&path).unwrap();
    let text = String::from_utf8_lossy(&text);
    let order = "uchar class,float radius,double y,double x,float z,float nz,double ny,float nx,double time,\
        uchar level,int parent0,int parent1,int parent2";
    let properties = text.lines().filter_map(|line| line.strip_prefix("property "));
    assert_eq!(properties.collect::<Vec<_>>().join(","), order);

    let error = ply::write(&path, &again, Some(provenance), &source, Encoding::Binary).unwrap_err();
    assert!(error.to_string().contains("`level`, `parent0`, `parent1`, `parent2`"), "{error}");
}

#[test]
fn provenance_must_fit_the_points() {
    let folder = Folder::new();
    let path = folder.path("wrong.ply");
    let points = rich();
    let cases: [(&[u8], &[[u32; 3]]); 4] = [
        (&[0; 2], &[]),
        (&[0; 3], &[[0; 3]; 4]),
        (&[0, 0, 1], &[[0, 1, 2]]),
        (&[0, 0, 1], &[[0, 1, u32::MAX]]),
    ];
    for (levels, parents) in cases {
        let given = Some(Provenance { levels, parents });
        let error = ply::write(&path, &points, given, &Source::default(), Encoding::Binary);
        let text = error.unwrap_err().to_string();
        assert!(text.contains("wrong.ply") && !text.contains('\n'), "{text}");
        assert!(!path.exists());
    }
}

#[test]
fn integer_coordinates_are_written_as_doubles() {
    let folder = Folder::new();
    let header = CORE.replacen("float x", "int x", 1).replacen("float radius", "uchar radius", 1);
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex 2\n{header}end_header\n\
         2000000001 0 0 0 0 1 3\n2000000004 0 0 0 0 1 3\n"
    );
    let (points, source) = folder.read(&text).unwrap();
    assert_eq!(points.origin.x + f64::from(points.positions[0].x), 2_000_000_001.0);
    assert_eq!(points.radii, [3.0, 3.0]);
    assert_eq!(source.notes.len(), 2);
    assert!(source.notes[0].contains("`x`") && source.notes[0].contains("double"));
    let out = String::from_utf8(folder.write(&points, &source, Encoding::Ascii)).unwrap();
    assert!(out.contains("property double x\n") && out.contains("property double radius\n"));
    assert!(out.ends_with("2.000000001e9 0 0 0 0 1 3\n2.000000004e9 0 0 0 0 1 3\n"), "{out}");
}

#[test]
fn origins_are_round_and_only_where_needed() {
    let folder = Folder::new();
    let doubles = CORE.replace("float", "double");
    let read = |properties: &str, rows: &[&str]| {
        let count = rows.len();
        let rows: String = rows.iter().map(|r| format!("{r} 0 0 1 0.5\n")).collect();
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex {count}\n{properties}end_header\n{rows}"
        );
        folder.read(text).unwrap().0
    };
    assert_eq!(read(CORE, &["4000000 1 1"]).origin, DVec3::ZERO);
    assert_eq!(read(&doubles, &["-0.5 -0.5 -0.5", "0.5 0.5 0.5"]).origin, DVec3::ZERO);
    assert_eq!(read(&doubles, &["7.125 0 1e-300"]).origin, DVec3::new(7.125, 0.0, 1e-300));
    assert_eq!(read(&doubles, &["4000000.5 0 0", "4000300.5 0 0"]).origin.x, 4_000_256.0);
    assert_eq!(read(&doubles, &[]), PointSet::default());
}

#[test]
fn elements_and_lists_that_are_not_kept_are_noted() {
    let folder = Folder::new();
    let points = format!(
        "element vertex 2\n{}",
        CORE.replacen("property", "property list uchar short tags\nproperty", 1)
    );
    let header = format!(
        "element camera 1\nproperty float f\nproperty list int uchar name\n{points}\
         element face 1\nproperty list uchar int vertex_indices\nelement none 0\n"
    );
    let text = format!(
        "ply\nformat ascii 1.0\n{header}end_header\n0.5 2 65 66\n\n1 9 {ROW}2 8 9 {ROW}3 0 1 0\n\n"
    );
    let mut body = [0.5f32.to_le_bytes(), 2i32.to_le_bytes()].concat();
    body.extend([65, 66, 1, 9, 0]);
    body.extend(row_bytes());
    body.extend([2, 8, 0, 9, 0]);
    body.extend(row_bytes());
    body.push(3);
    body.extend([0u8; 12]);
    for bytes in [text.into_bytes(), binary(&header, &body)] {
        let (points, source) = folder.read(bytes).unwrap();
        assert_eq!(points.positions, [Vec3::new(1.0, 2.0, 3.0); 2]);
        assert!(points.attributes.is_empty());
        assert_eq!(source.notes.len(), 3, "{:?}", source.notes);
        assert!(source.notes[0].contains("`camera` element with 1 entries"));
        assert!(source.notes[1].contains("`face` element with 1 entries"));
        assert!(source.notes[2].contains("`tags` of 2 points"));
        let out = folder.write(&points, &source, Encoding::Ascii);
        assert_eq!(String::from_utf8(out).unwrap(), ascii("2", &ROW.repeat(2)));
    }
}

#[test]
fn many_properties_are_read_in_order() {
    let folder = Folder::new();
    let mut points = rich();
    for i in 0..40u16 {
        points.attributes.push(Attribute::new(format!("more{i}"), Values::U16(vec![i; 3])));
    }
    for encoding in ENCODINGS {
        let (again, _) = folder.read(folder.write(&points, &Source::default(), encoding)).unwrap();
        assert_same_bits(&points, &again);
    }
}

#[test]
fn headers_of_many_names_are_no_trouble() {
    let folder = Folder::new();
    let elements: String = (0..40_000).map(|i| format!("element e{i} 0\n")).collect();
    let properties: String = (0..40_000).map(|i| format!("property char p{i}\n")).collect();
    let points = format!("element vertex 1\n{CORE}");
    let (read, _) = folder.read(binary(&(elements + &points), &row_bytes())).unwrap();
    assert_eq!(read.len(), 1);
    let bytes = binary(&(points + &properties), &[row_bytes(), vec![7; 40_000]].concat());
    let (read, source) = folder.read(&bytes).unwrap();
    assert_eq!(read.attributes.len(), 40_000);
    assert_eq!(folder.write(&read, &source, Encoding::Binary), bytes);
}

#[test]
fn attributes_may_come_and_go_between_reading_and_writing() {
    let folder = Folder::new();
    let (mut points, source) = folder.read(surveyed()).unwrap();
    points.attributes.remove(0);
    points.attributes.push(Attribute::new("quality", Values::F32(vec![1.0; 3])));
    let (again, _) = folder.read(folder.write(&points, &source, Encoding::Binary)).unwrap();
    assert_same_bits(&points, &again);
}

#[test]
fn empty_sets_crlf_and_odd_comments_are_fine() {
    let folder = Folder::new();
    for encoding in ENCODINGS {
        let bytes = folder.write(&PointSet::default(), &Source::default(), encoding);
        assert!(folder.read(bytes).unwrap().0.is_empty());
    }
    let crlf = ascii("1", ROW).replace('\n', "\r\n");
    assert_eq!(folder.read(crlf).unwrap().0.len(), 1);
    let no_break = ascii("1", ROW.trim_end());
    assert_eq!(folder.read(no_break).unwrap().0.len(), 1);
    let spaced = ascii("1", "\n \t\n  1\t2 3  0 0 1 +0.5 \n\n\n");
    assert_eq!(folder.read(spaced).unwrap().0.len(), 1);

    let mut bytes = b"ply\nformat ascii 1.0\ncomment caf\xe9 \xff\n".to_vec();
    bytes.extend(ascii("1", ROW).strip_prefix("ply\nformat ascii 1.0\n").unwrap().bytes());
    let (points, mut source) = folder.read(&bytes).unwrap();
    assert_eq!(source.remarks().next().unwrap(), "comment caf\u{fffd} \u{fffd}");
    assert_eq!(folder.write(&points, &source, Encoding::Ascii), bytes);
    source.add_comment("refined\nend_header");
    let (_, source) = folder.read(folder.write(&points, &source, Encoding::Ascii)).unwrap();
    assert_eq!(source.remarks().last().unwrap(), "comment refined end_header");
}

/// A file that must be refused: what is wrong with it, its bytes, and words that the message must have.
type Hostile = (&'static str, Vec<u8>, &'static str);

fn hostile() -> Vec<Hostile> {
    let headers = [malformed_headers(), incomplete_headers(), endless_lines()];
    let bodies = [wrong_counts(), bad_values(), bad_lists()];
    headers.into_iter().chain(bodies).flatten().collect()
}

fn head(header: &str) -> Vec<u8> {
    format!("ply\nformat ascii 1.0\n{header}end_header\n").into()
}

/// The element of points with the usual properties.
fn core(count: &str) -> String {
    format!("element vertex {count}\n{CORE}")
}

/// One binary point and more.
fn with_bytes(tail: &[u8]) -> Vec<u8> {
    [row_bytes(), tail.to_vec()].concat()
}

/// Headers that are none.
fn malformed_headers() -> Vec<Hostile> {
    vec![
        ("empty", vec![], "line 1: the file is empty"),
        ("no PLY", b"solid cube\n".to_vec(), "line 1: the file does not begin"),
        ("old Mac line ends", ascii("1", ROW).replace('\n', "\r").into(), "LF or CRLF"),
        ("only the magic", b"ply\n".to_vec(), "line 2: the file ends before `end_header`"),
        ("no format", ascii("1", ROW).replace("format ascii 1.0\n", "").into(), "`format` line"),
        (
            "two formats",
            ascii("1", ROW).replace("element", "format ascii 1.0\nelement").into(),
            "line 3",
        ),
        (
            "unknown format",
            ascii("1", ROW).replace("ascii", "utf8").into(),
            "line 2: format `utf8 1.0`",
        ),
        ("unknown version", ascii("1", ROW).replace("1.0", "2.0").into(), "`ascii 2.0`"),
        ("cut header", ascii("1", "")[..60].into(), "ends before `end_header`"),
        ("cut end_header", ascii("0", "").trim_end().into(), "ends before `end_header`"),
        (
            "two x",
            ascii("1", ROW).replace("float y", "double x").into(),
            "line 5: a second property `x`",
        ),
        ("two vertex", head(&core("0").repeat(2)), "a second element `vertex`"),
        ("early property", head("property float x\n"), "before any element"),
        (
            "unknown type",
            ascii("1", ROW).replace("float y", "half y").into(),
            "line 5: type `half`",
        ),
        ("unknown word", head("elephant vertex 3\n"), "line 3: `elephant` is not understood"),
        ("float list", head("element vertex 1\nproperty list float int x\n"), "integer type"),
        (
            "header not UTF-8",
            b"ply\nelement \xff\xfe 1\n".to_vec(),
            "line 2: the line is not UTF-8",
        ),
        ("control characters", b"ply\nelement \x1b[31m 1\n".to_vec(), "\\u{1b}[31m"),
    ]
}

/// Headers that lack what every file must have.
fn incomplete_headers() -> Vec<Hostile> {
    vec![
        ("no points", head(""), "no element `vertex`"),
        ("no properties", head("element vertex 1\n"), "no properties"),
        ("4e9 points of nothing", head("element vertex 4000000000\n"), "no properties"),
        (
            "no normals",
            head(
                "element vertex 0\nproperty float x\nproperty float y\nproperty float z\nproperty float radius\n",
            ),
            "no `nx`, `ny`, `nz`: add normals nx ny nz, unit length, outward",
        ),
        (
            "no radius",
            ascii("1", ROW).replace("radius", "r").into(),
            "no `radius`: add a property `radius`, at least the distance to the farthest natural neighbor, about 1.25 times it",
        ),
        (
            "list for x",
            ascii("1", ROW).replace("float x", "list uchar float x").into(),
            "no `x` that is no list",
        ),
    ]
}

/// Counts that are none, or that the file does not keep.
fn wrong_counts() -> Vec<Hostile> {
    vec![
        ("1e23 points", ascii("1e23", ROW).into(), "line 3: `1e23` is no count"),
        ("1e23 in digits", ascii("100000000000000000000000", ROW).into(), "is no count"),
        ("2^64 - 1 points", ascii("18446744073709551615", ROW).into(), "file ends after 1 ("),
        ("negative count", ascii("-5", ROW).into(), "`-5` is no count"),
        (
            "2^64 - 1 binary points",
            binary(&core("18446744073709551615"), &row_bytes()),
            "ends after 1 (",
        ),
        (
            "cut binary body",
            binary(&core("1000"), &row_bytes()),
            "promises 1000 entries, the file ends after 1 (28 bytes",
        ),
        ("cut in a row", binary(&core("2"), &with_bytes(&[0; 27])), "ends after 1 (55 bytes"),
        (
            "cut ASCII body",
            ascii("3", &ROW.repeat(2)).into(),
            "promises 3 entries, the file ends after 2",
        ),
        (
            "cut ASCII row",
            ascii("2", "1 2 3 0 0 1 0.5\n1.25 2.25 3.25 0.25 0").into(),
            "vertex 1: line 13: the line has 5 values for 7",
        ),
        ("surplus values", ascii("1", "1 2 3 0 0 1 0.5 9\n").into(), "the line has 8 values for 7"),
        (
            "rows on one line",
            ascii("2", "1 2 3 0 0 1 0.5 1 2 3 0 0 1 0.5\n\n").into(),
            "the line has 14 values",
        ),
        ("trailing binary", binary(&core("1"), &with_bytes(b"more")), "4 bytes follow"),
        ("trailing ASCII", ascii("1", &ROW.repeat(2)).into(), "16 bytes follow"),
    ]
}

/// Lines without an end, and too many of them.
fn endless_lines() -> Vec<Hostile> {
    vec![
        ("endless first line", [b"ply".to_vec(), vec![b'x'; 50 << 20]].concat(), "line 1"),
        (
            "endless line",
            [b"ply\ncomment ".to_vec(), vec![b'x'; 50 << 20]].concat(),
            "line 2: the line is longer",
        ),
        (
            "millions of lines",
            [b"ply\n".to_vec(), b"comment\n".repeat(3 << 20)].concat(),
            "the header is longer",
        ),
        (
            "huge line",
            [ascii("1", "").into_bytes(), vec![b'1'; 1 << 20]].concat(),
            "line 12 is too long",
        ),
    ]
}

/// Values that are no numbers, or none for a point.
fn bad_values() -> Vec<Hostile> {
    vec![
        (
            "word",
            ascii("1", "1 2 three 0 0 1 0.5\n").into(),
            "vertex 0: line 12: property `z`: `three` is no number of type float",
        ),
        ("nan", ascii("1", "1 nan 3 0 0 1 0.5\n").into(), "property `y`: `nan`"),
        ("inf", ascii("1", "1 2 3 0 0 1 -inf\n").into(), "property `radius`: `-inf`"),
        (
            "overflow",
            ascii("1", "1e99 2 3 0 0 1 0.5\n").into(),
            "vertex 0: a coordinate is not finite",
        ),
        ("binary nan", binary(&core("1"), &[0xff; 28]), "vertex 0: a coordinate is not finite"),
        ("zero normal", ascii("1", "1 2 3 0 0 0 0.5\n").into(), "vertex 0: the normal has length"),
        (
            "zero radius",
            ascii("2", &format!("{ROW}1 2 3 0 0 1 0\n")).into(),
            "vertex 1: the radius is",
        ),
        ("not text", [ascii("1", "").into_bytes(), vec![0xff; 40]].concat(), "line 12 is not text"),
    ]
}

/// Lists that promise more than there is.
fn bad_lists() -> Vec<Hostile> {
    let faces = |kind: &str, count: &str| {
        format!("{}element face {count}\nproperty list {kind} int vertex_indices\n", core("1"))
    };
    let list = |count: &[u8]| [count, &[0; 8][..]].concat();
    let tags = CORE.replacen("property", "property list uint double tags\nproperty", 1);
    vec![
        (
            "huge face count",
            binary(&faces("uchar", "4000000000"), &row_bytes()),
            "element `face`: the header promises 4000000000",
        ),
        (
            "huge face list",
            binary(&faces("uint", "1"), &with_bytes(&list(&[0xff; 4]))),
            "element `face`",
        ),
        (
            "negative face list",
            binary(&faces("int", "1"), &with_bytes(&list(&[0xff; 4]))),
            "face 0: a list has a negative length",
        ),
        (
            "huge tag list",
            binary(&format!("element vertex 1\n{tags}"), &[0xff; 60]),
            "ends after 0",
        ),
        (
            "huge ASCII list",
            [head(&faces("uint", "1")), format!("{ROW}4000000000 1 2\n").into()].concat(),
            "face 0: line 15: the values do not fit the lists",
        ),
        (
            "cut faces",
            [head(&faces("uchar", "2")), format!("{ROW}3 0 0 0\n").into()].concat(),
            "element `face`: the header promises 2 entries, the file ends after 1",
        ),
    ]
}

#[test]
fn hostile_files_are_refused_in_one_line() {
    let folder = Folder::new();
    for (case, bytes, words) in hostile() {
        let text = folder.read(bytes).expect_err(case).to_string();
        assert!(text.contains("input.ply: "), "{case}: {text}");
        assert!(text.contains(words), "{case}: {text}");
        assert!(!text.contains(char::is_control) && text.len() < 700, "{case}: {text}");
    }
    assert_eq!(folder.names(), ["input.ply"]);
}

#[test]
fn hostile_files_are_no_models_either() {
    let folder = Folder::new();
    // What only the refinement minds.
    let fine = ["zero normal", "zero radius", "no normals", "no radius"];
    for (case, bytes, words) in hostile() {
        match ply::read_model(&folder.file(bytes)) {
            Ok(_) => assert!(fine.contains(&case), "{case}"),
            Err(error) => {
                assert!(!fine.contains(&case), "{case}: {error}");
                let text = error.to_string();
                assert!(text.contains("input.ply: ") && text.contains(words), "{case}: {text}");
                assert!(!text.contains(char::is_control) && text.len() < 700, "{case}: {text}");
            }
        }
    }
}

#[test]
fn what_is_no_file_is_refused() {
    let folder = Folder::new();
    let missing = ply::read(&folder.path("missing.ply")).unwrap_err().to_string();
    assert!(missing.contains("missing.ply: cannot be read"), "{missing}");
    let path = folder.path("folder.ply");
    fs::create_dir(&path).unwrap();
    let text = ply::read(&path).unwrap_err().to_string();
    assert!(text.contains("folder.ply: is not a regular file"), "{text}");
    let write = |path: &Path| {
        let result = ply::write(path, &rich(), None, &Source::default(), Encoding::Binary);
        result.unwrap_err().to_string()
    };
    assert!(write(&path).contains("folder.ply: is not a regular file"));
    let text = write(&folder.path("missing/out.ply"));
    assert!(text.contains("out.ply: cannot be written") && !text.contains('\n'), "{text}");
    assert!(write(Path::new("")).contains("cannot be written"));
    if cfg!(unix) {
        assert!(ply::read(Path::new("/dev/zero")).is_err());
        assert!(write(Path::new("/dev/null")).contains("/dev/null: is not a regular file"));
    }
    assert_eq!(folder.names(), ["folder.ply"]);
}

#[test]
fn points_that_cannot_be_written_leave_no_file() {
    let folder = Folder::new();
    let path = folder.path("out.ply");
    fs::write(&path, "old").unwrap();
    let refuse = |change: fn(&mut PointSet), words: &str| {
        let mut points = rich();
        change(&mut points);
        let error = ply::write(&path, &points, None, &Source::default(), Encoding::Binary);
        let text = error.unwrap_err().to_string();
        assert!(text.contains("out.ply: ") && text.contains(words), "{text}");
        assert!(!text.contains('\n'), "{text}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
    };
    refuse(|p| p.radii[1] = f32::NAN, "vertex 1: the radius is not finite");
    refuse(|p| p.normals.truncate(2), "normals has 2 entries for 3 points");
    refuse(|p| p.attributes[0].name = "two words".into(), "`two words`");
    refuse(|p| p.attributes[0].name = "line\nbreak".into(), "`line\\nbreak`");
    refuse(|p| p.attributes[0].name = String::new(), "one word");
    refuse(|p| p.attributes[0].name = "radius".into(), "`radius`");
    refuse(|p| p.attributes[0].name = "g".into(), "occurs twice");
    assert_eq!(folder.names(), ["out.ply"]);
}

#[cfg(unix)]
#[test]
fn files_get_the_usual_permissions_and_links_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = Folder::new();
    let usual = folder.path("usual");
    fs::write(&usual, "").unwrap();
    let out = folder.path("out.ply");
    let write = |path| ply::write(path, &rich(), None, &Source::default(), Encoding::Binary);
    write(&out).unwrap();
    let mode = |path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&out), mode(&usual));

    let link = folder.path("link.ply");
    symlink(&usual, &link).unwrap();
    write(&link).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&usual).unwrap(), fs::read(&out).unwrap());

    fs::set_permissions(&out, fs::Permissions::from_mode(0o444)).unwrap();
    assert!(write(&out).unwrap_err().to_string().contains("out.ply: cannot be written"));
}

#[test]
fn one_file_is_known_under_all_its_names() {
    let folder = Folder::new();
    let (a, b) = (folder.path("a.ply"), folder.path("b.ply"));
    fs::write(&a, "a").unwrap();
    assert!(!ply::same_file(&a, &b));
    assert!(!ply::same_file(&b, &b));
    fs::write(&b, "a").unwrap();
    assert!(!ply::same_file(&a, &b));
    fs::create_dir(folder.path("sub")).unwrap();
    assert!(ply::same_file(&a, &folder.path("sub/../a.ply")));
    #[cfg(unix)]
    {
        let (soft, hard) = (folder.path("soft.ply"), folder.path("hard.ply"));
        std::os::unix::fs::symlink(&a, &soft).unwrap();
        fs::hard_link(&a, &hard).unwrap();
        assert!(ply::same_file(&a, &soft) && ply::same_file(&a, &hard));
        assert!(!ply::same_file(&b, &soft) && !ply::same_file(&b, &hard));
    }
}

#[test]
fn damaged_files_never_panic() {
    let folder = Folder::new();
    let mut random = fastrand::Rng::with_seed(7);
    let mut seeds: Vec<Vec<u8>> =
        ENCODINGS.map(|e| folder.write(&rich(), &Source::default(), e)).into();
    seeds.push(surveyed());
    seeds.push(ascii("2", &ROW.repeat(2)).into_bytes());
    let (mut good, mut bad) = (0, 0);
    for round in 0..4000 {
        let mut bytes = seeds[round % seeds.len()].clone();
        for _ in 0..random.usize(1..4) {
            damage(&mut bytes, &mut random);
        }
        match folder.read(&bytes) {
            Ok((points, source)) => {
                good += 1;
                assert_eq!(
                    ply::read_model(&folder.path("input.ply")).unwrap().0.len(),
                    points.len()
                );
                // What can be read can be written, and comes back.
                let again = folder.read(folder.write(&points, &source, Encoding::Binary)).unwrap();
                assert_same_bits(&points, &again.0);
            }
            Err(error) => {
                bad += 1;
                let text = error.to_string();
                assert!(text.contains("input.ply") && !text.contains(char::is_control), "{text:?}");
            }
        }
    }
    assert!(good > 100 && bad > 1000, "{good} good, {bad} bad");
}

#[test]
fn damaged_meshes_never_panic() {
    let folder = Folder::new();
    let mut random = fastrand::Rng::with_seed(11);
    let header = "element vertex 4\nproperty float x\nproperty float y\nproperty double z\nelement face 3\n\
        property list uchar short vertex_index\n";
    let rows = "0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n3 0 1 2\n4 3 2 1 0\n3 0 2 3\n";
    let ascii = format!("ply\nformat ascii 1.0\n{header}end_header\n{rows}").into_bytes();
    let corners =
        [&[3, 0, 0, 1, 0, 2, 0][..], &[4, 3, 0, 2, 0, 1, 0, 0, 0], &[3, 0, 0, 2, 0, 3, 0]];
    let body = [vec![0; 64], corners.concat()].concat();
    let seeds = [ascii, binary(header, &body)];
    let (mut good, mut bad) = (0, 0);
    for round in 0..4000 {
        let mut bytes = seeds[round % seeds.len()].clone();
        for _ in 0..random.usize(1..4) {
            damage(&mut bytes, &mut random);
        }
        match ply::read_model(&folder.file(&bytes)) {
            Ok((model, _)) => {
                good += 1;
                assert!(model.triangles.iter().flatten().all(|&c| (c as usize) < model.len()));
                model.to_points().0.validate_numbers().unwrap();
            }
            Err(error) => {
                bad += 1;
                let text = error.to_string();
                assert!(text.contains("input.ply") && !text.contains(char::is_control), "{text:?}");
            }
        }
    }
    assert!(good > 100 && bad > 1000, "{good} good, {bad} bad");
}

fn damage(bytes: &mut Vec<u8>, random: &mut fastrand::Rng) {
    let at = random.usize(0..bytes.len());
    match random.u8(0..6) {
        0 => bytes.truncate(at.max(1)),
        1 => bytes[at] ^= 1 << random.u8(0..8),
        2 => bytes[at] = random.u8(..),
        3 => bytes.insert(at, random.u8(..)),
        4 => {
            let end = (at + random.usize(0..40)).min(bytes.len());
            let piece = bytes[at..end].to_vec();
            bytes.splice(at..at, piece);
        }
        _ => drop(bytes.remove(at)),
    }
    if bytes.is_empty() {
        bytes.push(b'p');
    }
}

/// The clouds that the project is tried on, where they are at hand.
#[test]
fn the_test_data_survives() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = Folder::new();
    for sub in ["points", "analytic", "mesh"] {
        let Ok(entries) = fs::read_dir(data.join(sub)) else { continue };
        for path in entries.map(|entry| entry.unwrap().path()) {
            if path.extension().is_none_or(|e| e != "ply")
                || fs::metadata(&path).unwrap().len() > 3 << 20
            {
                continue;
            }
            let name = path.to_string_lossy();
            match ply::read(&path) {
                Ok((points, source)) => {
                    let out = folder.write(&points, &source, Encoding::Binary);
                    assert!(out == fs::read(&path).unwrap(), "{name} has changed");
                    let text = folder.write(&points, &source, Encoding::Ascii);
                    assert_same_bits(&points, &folder.read(text).unwrap().0);
                }
                Err(error) => {
                    assert!(matches!(error, PlyError::Missing { .. }), "{error}");
                    assert!(sub == "mesh" || name.contains("-xyz"), "{error}");
                }
            }
        }
    }
}
