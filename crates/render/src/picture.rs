//! Pixels, and files of them.

use crate::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use surfine_points::files::Replacement;

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
        if !(1..=8).contains(&supersampling) {
            return Err(Error::Supersampling { supersampling });
        }
        let fits = |side: u32| {
            side.checked_mul(supersampling).is_some_and(|side| (1..=limit).contains(&side))
        };
        if fits(self.width) && fits(self.height) {
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
        let mut file = Animation::new(path, self.size, 1, 1)?;
        file.push(self)?;
        file.finish()
    }
}

/// An animated PNG file that is written picture by picture and repeats for ever; it appears whole or not at all. One
/// picture makes a plain PNG.
pub struct Animation {
    path: PathBuf,
    size: Size,
    file: Replacement,
    writer: png::Writer<BufWriter<File>>,
}

impl Animation {
    /// Begins a file of so many pictures, of which so many are shown a second.
    ///
    /// # Errors
    /// The file can't be written.
    pub fn new(path: &Path, size: Size, frames: u32, per_second: u16) -> Result<Self, Error> {
        let begin = || {
            let file = Replacement::new(path)?;
            let mut encoder = png::Encoder::new(file.writer()?, size.width, size.height);
            encoder.set_color(png::ColorType::Rgba);
            encoder.set_depth(png::BitDepth::Eight);
            encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
            encoder.validate_sequence(true);
            // A third of the time of `High` for files that are 5 to 10 % larger.
            encoder.set_compression(png::Compression::Balanced);
            if frames > 1 {
                encoder.set_animated(frames, 0)?;
                encoder.set_frame_delay(1, per_second)?;
            }
            Ok((file, encoder.write_header()?))
        };
        let (file, writer) = begin().map_err(|e| failed(path, &e))?;
        Ok(Self { path: path.into(), size, file, writer })
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// The file can't be written.
    ///
    /// # Panics
    /// If the picture has another size.
    pub fn push(&mut self, frame: &Picture) -> Result<(), Error> {
        assert_eq!(frame.size, self.size, "frames of one size");
        let written = self.writer.write_image_data(frame.pixels.as_flattened());
        written.map_err(|e| failed(&self.path, &e))
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// The file can't be written, or pictures are missing.
    pub fn finish(self) -> Result<(), Error> {
        let Self { path, file, writer, .. } = self;
        let finished = writer.finish().and_then(|()| Ok(file.finish()?));
        finished.map_err(|e| failed(&path, &e))
    }
}

fn failed(path: &Path, cause: &png::EncodingError) -> Error {
    Error::Write { path: path.into(), message: cause.to_string() }
}
