//! Files that hold pictures.

use std::fs::{self, File};
use std::io::{BufReader, Read};
use std::path::Path;
use surfine_render::{Animation, Error, Picture, Size};

/// A decoded file: its pictures and how they follow each other.
struct Decoded {
    frames: Vec<Picture>,
    animation: Option<png::AnimationControl>,
    /// Numerator and denominator of each frame's time in seconds.
    delays: Vec<[u16; 2]>,
}

fn decode(path: &Path) -> Decoded {
    let file = File::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().unwrap();
    let info = reader.info();
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgba, png::BitDepth::Eight));
    assert!(info.srgb.is_some(), "viewers must not guess the colours");
    let size = Size { width: info.width, height: info.height };
    let animation = info.animation_control;
    let count = animation.map_or(1, |animation| animation.num_frames);
    let (mut frames, mut delays) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        frames.push(Picture { size, pixels: bytes.as_chunks().0.to_vec() });
        delays.extend(reader.info().frame_control.map(|frame| [frame.delay_num, frame.delay_den]));
    }
    Decoded { frames, animation, delays }
}

/// The picture of a file.
pub(crate) fn read_png(path: &Path) -> Picture {
    decode(path).frames.remove(0)
}

fn write_animation(path: &Path, frames: &[Picture], per_second: u16) -> Result<(), Error> {
    let mut file = Animation::new(path, frames[0].size, frames.len() as u32, per_second)?;
    frames.iter().try_for_each(|frame| file.push(frame))?;
    file.finish()
}

/// Every byte in every channel, no two rows alike.
fn colorful(seed: usize) -> Picture {
    let size = Size { width: 37, height: 29 };
    let pixel = |i: usize| [i, i / 7, 3 * i, 255 - i / 5].map(|c| (c + seed) as u8);
    Picture { size, pixels: (0..37 * 29).map(pixel).collect() }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_picture_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    colorful(0).write_png(&path).unwrap();
    let decoded = decode(&path);
    assert_eq!(decoded.frames, [colorful(0)]);
    assert!(decoded.animation.is_none(), "a plain file");
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[test]
fn an_animation_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let frames = [0, 50, 100].map(colorful);
    write_animation(&path, &frames, 24).unwrap();
    let decoded = decode(&path);
    assert_eq!(decoded.frames, frames);
    assert_eq!(decoded.delays, [[1, 24]; 3]);
    let animation = decoded.animation.unwrap();
    assert_eq!((animation.num_frames, animation.num_plays), (3, 0), "0 plays: for ever");
    write_animation(&path, &frames[..1], 24).unwrap();
    assert!(decode(&path).animation.is_none(), "one picture is a plain file");
}

#[test]
fn a_missing_folder_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing/a.png");
    let error = colorful(0).write_png(&path).unwrap_err();
    assert!(matches!(error, Error::Write { path: ref named, .. } if *named == path), "{error}");
    assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn a_file_is_replaced_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    colorful(0).write_png(&path).unwrap();
    let before = fs::read(&path).unwrap();
    // Whoever reads the old file meanwhile reads it to its end.
    let mut open = File::open(&path).unwrap();
    colorful(1).write_png(&path).unwrap();
    assert_eq!(decode(&path).frames, [colorful(1)]);
    let mut read = Vec::new();
    open.read_to_end(&mut read).unwrap();
    assert!(read == before, "the old file was written into");
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[test]
fn a_failure_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    colorful(0).write_png(&path).unwrap();
    let before = fs::read(&path).unwrap();
    // Its first frame is written before the second turns out to lack pixels.
    let mut short = colorful(1);
    short.pixels.pop();
    let error = write_animation(&path, &[colorful(1), short], 10).unwrap_err();
    assert!(matches!(error, Error::Write { .. }), "{error}");
    assert!(fs::read(&path).unwrap() == before, "the old file is gone");
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[test]
fn missing_frames_are_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let mut file = Animation::new(&path, colorful(0).size, 3, 10).unwrap();
    file.push(&colorful(0)).unwrap();
    assert!(matches!(file.finish(), Err(Error::Write { .. })));
    assert_eq!(names(folder.path()), [""; 0]);
}

#[cfg(unix)]
#[test]
fn links_stay_and_protected_files_too() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let [path, link] = ["a.png", "link.png"].map(|name| folder.path().join(name));
    colorful(0).write_png(&path).unwrap();
    symlink(&path, &link).unwrap();
    colorful(1).write_png(&link).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(decode(&path).frames, [colorful(1)]);
    fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
    assert!(matches!(colorful(2).write_png(&path), Err(Error::Write { .. })));
    assert_eq!(decode(&path).frames, [colorful(1)]);
}

#[test]
fn a_folder_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    fs::create_dir(&path).unwrap();
    let error = colorful(0).write_png(&path).unwrap_err();
    assert!(matches!(error, Error::Write { .. }), "{error}");
    assert_eq!(names(folder.path()), ["a.png"]);
    assert_eq!(names(&path), [""; 0]);
}
