//! `surfine render`.

use crate::folder::{Folder, text};
use std::fs::File;
use std::io::BufReader;

/// A tetrahedron with outward faces.
pub(crate) const MESH: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n\
    1 1 1\n1 -1 -1\n-1 1 -1\n-1 -1 1\n3 0 1 2\n3 0 3 1\n3 0 2 3\n3 1 3 2\n";

/// Width, height, and the pixels of the first frame.
fn picture(folder: &Folder, name: &str) -> (u32, u32, Vec<[u8; 4]>) {
    let file = BufReader::new(File::open(folder.path(name)).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(frame.color_type, png::ColorType::Rgba);
    bytes.truncate(frame.buffer_size());
    (frame.width, frame.height, bytes.as_chunks().0.to_vec())
}

fn render(folder: &Folder, more: &[&str]) -> String {
    folder.succeed(&[&["render", "--backend", "cpu", "--size", "60x50"], more].concat())
}

/// Whether a pixel shows the back of a disc.
fn is_back([r, g, b, _]: [u8; 4]) -> bool {
    u32::from(r) > 2 * u32::from(g) && g > b
}

#[test]
fn sphere_is_a_grey_disc_on_white() {
    let folder = Folder::with_sample("sphere", "500");
    let summary = render(&folder, &["in.ply", "-o", "out.png"]);
    assert!(summary.starts_with("out.png: 60 x 50 pixels, 1 frame, 500 splats"), "{summary}");
    let (width, height, pixels) = picture(&folder, "out.png");
    assert_eq!((width, height), (60, 50), "one input has no caption");
    assert_eq!(pixels[0], [255; 4]);
    let [r, g, b, a] = pixels[25 * 60 + 30];
    assert!(r < 250 && r.abs_diff(g) < 20 && g.abs_diff(b) < 20 && a == 255, "{r} {g} {b} {a}");
    assert!(!pixels.iter().any(|&p| is_back(p)));
    assert_eq!(folder.names(), ["in.ply", "out.png"]);
}

#[test]
fn inputs_stand_side_by_side_with_captions() {
    let folder = Folder::with_sample("torus", "300");
    folder.refine(&[]);
    render(&folder, &["in.ply", "out.ply", "-o", "both.png"]);
    let (width, height, captioned) = picture(&folder, "both.png");
    assert_eq!((width, height), (120, 50 + 28));
    render(&folder, &["in.ply", "out.ply", "-o", "plain.png", "--no-captions"]);
    let (width, height, plain) = picture(&folder, "plain.png");
    assert_eq!((width, height), (120, 50));
    assert_eq!(captioned[..plain.len()], plain);
    render(&folder, &["in.ply", "out.ply", "-o", "c.png", "--caption", "a", "--caption", "b"]);
    assert_ne!(picture(&folder, "c.png").2, captioned);
    folder.fail(
        &["render", "in.ply", "out.ply", "-o", "d.png", "--caption", "a"],
        "1 captions for 2",
    );
}

#[test]
fn flipped_normals_are_orange() {
    let folder = Folder::with_sample("sphere", "400");
    let mut points = folder.points("in.ply");
    points.normals.iter_mut().for_each(|n| *n = -*n);
    let (path, source) = (folder.path("flipped.ply"), surfine_points::ply::Source::default());
    surfine_points::ply::write(&path, &points, None, &source, Default::default()).unwrap();
    render(&folder, &["flipped.ply", "-o", "out.png"]);
    let (_, _, pixels) = picture(&folder, "out.png");
    assert!(is_back(pixels[25 * 60 + 30]), "{:?}", pixels[25 * 60 + 30]);
}

#[test]
fn views_and_cameras_differ() {
    let folder = Folder::new();
    // Without symmetry, so that no two sides are alike.
    folder.succeed(&["sample", "saddle", "-n", "40", "--random", "-o", "in.ply"]);
    let mut seen = Vec::new();
    let views =
        ["front", "back", "left", "right", "top", "bottom", "iso"].map(|v| vec!["--view", v]);
    let cameras = [
        vec!["--eye", "-3,0.5,9"],
        vec!["--eye=-3,0.5,9", "--fit"],
        vec!["--eye", "-3,0.5,9", "--target", "0,1,0"],
        vec!["--eye", "-3,0.5,9", "--up", "1,0,0"],
        vec!["--z-up", "--view", "iso"],
        vec!["--splat-scale", "0.5"],
        vec!["--points", "--point-size", "3"],
        vec!["--background", "102030"],
        vec!["--background", "none"],
        vec!["--color", "normal"],
        vec!["--color", "radius"],
        vec!["--supersampling", "1"],
    ];
    for options in views.into_iter().chain(cameras) {
        render(&folder, &[&["in.ply", "-o", "out.png"], &options[..]].concat());
        let bytes = folder.bytes("out.png");
        assert!(!seen.contains(&bytes), "{options:?} changes nothing");
        seen.push(bytes);
    }
}

#[test]
fn turntables_are_animations_or_sequences() {
    let folder = Folder::with_sample("torus", "200");
    let turn = ["in.ply", "--turntable", "4", "--eye", "0,3,4", "--fit"];
    render(&folder, &[&turn[..], &["-o", "turn.png", "--fps", "5"]].concat());
    let file = BufReader::new(File::open(folder.path("turn.png")).unwrap());
    let reader = png::Decoder::new(file).read_info().unwrap();
    let control = reader.info().animation_control().expect("it is animated");
    assert_eq!((control.num_frames, control.num_plays), (4, 0));
    let frame = reader.info().frame_control().expect("the first frame is part of it");
    assert_eq!((frame.delay_num, frame.delay_den), (1, 5));
    render(&folder, &[&turn[..], &["-o", "turn-##.png"]].concat());
    let names = ["in.ply", "turn-00.png", "turn-01.png", "turn-02.png", "turn-03.png", "turn.png"];
    assert_eq!(folder.names(), names);
    assert_ne!(folder.bytes("turn-00.png"), folder.bytes("turn-01.png"));
    assert_eq!(picture(&folder, "turn-00.png"), picture(&folder, "turn.png"));
}

#[test]
fn colors_come_from_properties_and_from_the_truth() {
    let folder = Folder::with_sample("sphere", "200");
    folder.refine(&["--provenance"]);
    for (color, file) in [("level", "out.ply"), ("radius", "in.ply"), ("normal", "in.ply")] {
        render(&folder, &[file, "-o", "a.png", "--color", color]);
    }
    render(&folder, &["in.ply", "-o", "b.png", "--color", "error", "--truth", "out.ply"]);
    let (_, height, _) = picture(&folder, "b.png");
    assert_eq!(height, 50 + 2 * 28, "the scale has a line of its own");
    let fail = |color: &str, part: &str| {
        folder.fail(&["render", "in.ply", "-o", "c.png", "--color", color], part);
    };
    fail("rgb", "in.ply: there are no properties red, green and blue");
    fail("level", "--provenance");
    fail("error", "--truth");
}

#[test]
fn any_ply_file_can_be_looked_at() {
    let positions = "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n\
        property double z\nend_header\n1e6 0 0\n1000001 1 0\n";
    let folder = Folder::with_input(positions);
    let noted = |folder: &Folder, note: &str| {
        let output = folder.run(&["render", "in.ply", "-o", "out.png", "--size", "60x50"]);
        assert!(output.status.success());
        assert_eq!(text(&output.stderr), format!("surfine: in.ply: {note}\n"));
    };
    noted(&folder, "there are no normals nx ny nz: points are drawn as dots");
    let (_, _, pixels) = picture(&folder, "out.png");
    assert!(pixels.iter().any(|p| *p != [255; 4]), "points without normals are dots");
    let empty = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n\
        property float z\nend_header\n";
    let folder = Folder::with_input(empty);
    noted(&folder, "there are no points: its picture is empty");
    assert!(picture(&folder, "out.png").2.iter().all(|p| *p == [255; 4]));
}

#[test]
fn pictures_that_cannot_be_are_refused() {
    let folder = Folder::with_sample("sphere", "50");
    folder.fail(&["render", "in.ply", "-o", "out.jpg"], "out.jpg: pictures are PNG");
    folder.fail(&["render", "in.ply", "-o", "no/out.png"], "no");
    folder.fail(&["render", "none.ply", "-o", "out.png"], "none.ply");
    folder.fail(
        &["render", "in.ply", "-o", "out.png", "--size", "32768x9", "--supersampling", "8"],
        "32768",
    );
    // Before anything is read.
    folder.fail(&["render", "none.ply", "-o", "out.png", "--size", "32768x9"], "32768");
    std::fs::copy(folder.path("in.ply"), folder.path("in.png")).unwrap();
    folder.fail(&["render", "in.png", "-o", "in.png"], "an input too");
    let error = ["--color", "error", "--truth", "in.png"];
    folder.fail(&[&["render", "in.ply", "-o", "in.png"], &error[..]].concat(), "an input too");
    for wrong in [
        &["--size", "0x5"][..],
        &["--size", "5"],
        &["--eye", "1,2"],
        &["--eye", "1,2,inf"],
        &["--view", "up"],
        &["--background", "12345"],
        &["--background", "+1234567"],
        &["--splat-scale", "0"],
        &["--target", "0,0,0"],
        &["--fps", "3"],
        &["--view", "top", "--eye", "0,0,1"],
        &["--eye", "1e16,0,0"],
        &["--truth", "in.png"],
        &["--max", "3"],
        &["--color", "rgb", "--max", "3"],
        &["--point-size", "3"],
        &["--points", "--splat-scale", "2"],
        &["--backend", "cpu", "--adapter", "llvm"],
        &["--up", "0,0,0"],
        &["--splat-scale", "1e4"],
        &["--points", "--point-size", "1e-4"],
    ] {
        let output = folder.run(&[&["render", "in.png", "-o", "out.png"], wrong].concat());
        assert_eq!(output.status.code(), Some(2), "{wrong:?}: {}", text(&output.stderr));
    }
}

/// Where the system tells how much memory there is.
#[cfg(target_os = "linux")]
#[test]
fn pictures_that_memory_cannot_hold_are_refused() {
    let folder = Folder::with_sample("sphere", "50");
    let large = ["-o", "out.png", "--size", "32768x32768", "--supersampling", "1"];
    let many = [&["render"], &["in.ply"; 2000][..], &large].concat();
    folder.fail(&many, "2000 pictures of 32768 x 32768 pixels need 17.2 TB of memory at least");
}

#[test]
fn cameras_without_a_direction_are_refused() {
    let folder = Folder::with_sample("sphere", "50");
    let fail = |options: &[&str], part: &str| {
        folder.fail(&[&["render", "in.ply", "-o", "out.png"], options].concat(), part);
    };
    fail(&["--eye", "1,2,3", "--target", "1,2,3"], "give another --target");
    fail(&["--view", "top", "--up", "0,-1,0"], "--up");
    fail(&["--eye", "0,9,0", "--target", "0,0,0"], "--up");
}

#[test]
fn turntables_turn_about_the_upright_axis() {
    let folder = Folder::with_sample("torus", "200");
    // The axis of the torus is z: about it every frame is nearly alike.
    let turn = ["in.ply", "--turntable", "2", "-o", "turn-#.png"];
    let frames = |options: &[&str]| {
        render(&folder, &[&turn[..], options].concat());
        ["turn-0.png", "turn-1.png"].map(|name| picture(&folder, name).2)
    };
    let ink = |pixels: &[[u8; 4]]| pixels.iter().filter(|p| **p != [255; 4]).count();
    let [a, b] = frames(&["--z-up", "--view", "left"]);
    assert!(ink(&a).abs_diff(ink(&b)) < 20 && a != b);
    // From above and turned by half: the picture stands on its head.
    let [a, mut b] = frames(&["--view", "top", "--color", "normal"]);
    b.reverse();
    let far = a.iter().zip(&b).filter(|(a, b)| (0..3).any(|c| a[c].abs_diff(b[c]) > 60)).count();
    assert!(far < 40, "{far}");
}

#[test]
fn what_was_made_up_is_noted() {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty float nx\nproperty float ny\nproperty float nz\n";
    let radius = format!(
        "{header}property float radius\nend_header\n0 0 0 0 0 1 -2\n1 0 0 0 0 1 -1\n0 1 0 0 0 0 1\n"
    );
    let notes = |folder: &Folder| {
        let output = folder.run(&["render", "in.ply", "-o", "out.png", "--size", "60x50"]);
        assert!(output.status.success());
        text(&output.stderr)
    };
    let found = notes(&Folder::with_input(radius));
    assert!(found.contains("2 of 3 radii are negative or not finite"), "{found}");
    assert!(found.contains("1 of 3 normals are zero or not finite"), "{found}");
    let none = format!("{header}end_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n");
    let found = notes(&Folder::with_input(none));
    assert!(found.contains("there is no radius: 3 were made from the neighbors"), "{found}");
}

#[test]
fn radius_needs_radii() {
    let bare = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
        property float z\nend_header\n0 0 0\n";
    let folder = Folder::with_input(bare);
    let output = folder.run(&["render", "in.ply", "-o", "out.png", "--color", "radius"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("there is no usable radius"));
}

#[test]
fn a_given_largest_value_begins_the_scale_at_zero() {
    let folder = Folder::with_sample("sphere", "200");
    let dark = |max: &[&str]| {
        render(&folder, &[&["in.ply", "-o", "a.png", "--color", "radius"], max].concat());
        let [r, g, b, _] = picture(&folder, "a.png").2[25 * 60 + 30];
        r < 100 && g < 80 && b < 120
    };
    // All radii are beyond the small maximum: bright. Far below the large one: dark.
    assert!(!dark(&["--max", "1e-3"]) && dark(&["--max", "100"]));
}

#[test]
fn frame_numbers_are_in_the_name_of_the_file() {
    let folder = Folder::with_sample("sphere", "50");
    std::fs::create_dir(folder.path("d#1")).unwrap();
    render(&folder, &["in.ply", "-o", "d#1/turn.png", "--turntable", "2"]);
    assert_eq!(folder.names(), ["d#1", "in.ply"]);
    assert!(folder.path("d#1/turn.png").exists());
}

#[cfg(unix)]
#[test]
fn names_that_take_no_number_are_refused() {
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::with_sample("sphere", "50");
    let name = std::ffi::OsStr::from_bytes(b"n\xff-#.png");
    let mut command = folder.command(&["render", "in.ply", "--turntable", "2", "-o"]);
    let output = command.arg(name).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("must be UTF-8"));
}

#[test]
fn adapter_that_the_environment_names_must_be_there() {
    let folder = Folder::with_sample("sphere", "50");
    let args = ["render", "in.ply", "-o", "out.png"];
    let output = folder.command(&args).env("WGPU_ADAPTER_NAME", "no such thing").output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let complaint = text(&output.stderr);
    assert!(complaint.starts_with("surfine: error: no GPU adapter"), "{complaint}");
}

#[test]
fn auto_draws_on_the_cpu_what_the_gpu_refuses() {
    let folder = Folder::with_sample("sphere", "50");
    // Wider than software drivers draw, not than the CPU does.
    let args = ["render", "in.ply", "-o", "out.png", "--size", "16000x2", "--supersampling", "2"];
    let output = folder.command(&args).env("WGPU_ADAPTER_NAME", "llvmpipe").output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
    let found = text(&output.stderr);
    assert!(
        found.starts_with("surfine: drawing on the CPU: the GPU failed: a picture of"),
        "{found}"
    );
    assert!(text(&output.stdout).contains("on the CPU"));
}
