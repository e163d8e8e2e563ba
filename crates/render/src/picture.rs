//! Pixels, and files of them.

use crate::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Pixels of a row, and rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Pixels of a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// Pixels of 8 bits a channel: sRGB, and opacity that is not multiplied in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Its size.
    pub size: Size,
    /// Red, green, blue and opacity of each pixel, row by row from the top.
    pub pixels: Vec<[u8; 4]>,
}

impl Size {
    /// Width over height.
    pub fn aspect(self) -> f32 {
        self.width as f32 / self.height as f32
    }

    /// Checks a picture against the most subpixels along a side.
    pub(crate) fn check(self, supersampling: u32, limit: u32) -> Result<(), Error> {
        let fits = |side: u32| {
            side.checked_mul(supersampling).is_some_and(|side| (1..=limit).contains(&side))
        };
        if fits(self.width) && fits(self.height) && supersampling <= 8 {
            return Ok(());
        }
        let Self { width, height } = self;
        Err(Error::Size { width, height, supersampling, limit })
    }

    pub(crate) fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }
}

impl Picture {
    /// A picture of one colour.
    pub fn new(size: Size, color: [u8; 4]) -> Self {
        Self { size, pixels: vec![color; size.pixels()] }
    }

    /// Pictures of one height from left to right.
    ///
    /// # Panics
    /// If there are none, or their heights differ.
    pub fn side_by_side(pictures: &[Self]) -> Self {
        let height = pictures[0].size.height;
        assert!(pictures.iter().all(|p| p.size.height == height), "pictures of one height");
        let width = pictures.iter().map(|p| p.size.width).sum();
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for row in 0..height as usize {
            for picture in pictures {
                let width = picture.size.width as usize;
                pixels.extend_from_slice(&picture.pixels[row * width..][..width]);
            }
        }
        Self { size: Size { width, height }, pixels }
    }

    /// Writes a PNG file; it appears whole or not at all.
    ///
    /// # Errors
    /// The file can't be written.
    pub fn write_png(&self, path: &Path) -> Result<(), Error> {
        write_animation(path, std::slice::from_ref(self), 0)
    }
}

/// Writes pictures of one size as an animated PNG that repeats for ever, with this many pictures a second. A single
/// one makes a plain PNG.
///
/// # Errors
/// The file can't be written.
///
/// # Panics
/// If there are no pictures, or of different sizes.
pub fn write_animation(path: &Path, frames: &[Picture], per_second: u16) -> Result<(), Error> {
    let size = frames[0].size;
    assert!(frames.iter().all(|f| f.size == size), "frames of one size");
    let failed = |message: String| Error::Write { path: path.into(), message };
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any new file: the process's mask takes its share.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder).map_err(|e| failed(e.to_string()))?;
    encode(file.as_file(), frames, per_second).map_err(|e| failed(e.to_string()))?;
    file.persist(path).map_err(|e| failed(e.error.to_string()))?;
    Ok(())
}

fn encode(file: &File, frames: &[Picture], per_second: u16) -> Result<(), png::EncodingError> {
    let size = frames[0].size;
    let mut out = BufWriter::new(file);
    let mut encoder = png::Encoder::new(&mut out, size.width, size.height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::High);
    if frames.len() > 1 {
        encoder.set_animated(frames.len() as u32, 0)?;
        encoder.set_frame_delay(1, per_second)?;
    }
    let mut writer = encoder.write_header()?;
    for frame in frames {
        writer.write_image_data(frame.pixels.as_flattened())?;
    }
    writer.finish()?;
    out.flush()?;
    Ok(())
}
