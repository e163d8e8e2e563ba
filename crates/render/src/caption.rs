//! Words and scales under a picture.

use crate::{Picture, Size, ramp};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Pixels above and below the letters.
const MARGIN: u32 = 6;
/// Pictures from this width on get the larger letters.
const WIDE: u32 = 1000;

/// What stands under a picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Caption {
    /// A line of text; characters beyond ASCII show as `?`, and a line that is too long loses its middle.
    pub text: String,
    /// The values at both ends of the ramp.
    pub ramp: Option<[String; 2]>,
}

impl Picture {
    /// The picture with a strip below it.
    #[must_use]
    pub fn with_caption(mut self, caption: &Caption) -> Self {
        let letters =
            if self.size.width < WIDE { RasterHeight::Size16 } else { RasterHeight::Size24 };
        let line = letters.val() as u32 + 2 * MARGIN;
        let lines = 1 + u32::from(caption.ramp.is_some());
        let top = self.size.height;
        let size = Size { height: top + lines * line, ..self.size };
        self.pixels.resize(size.pixels(), [255; 4]);
        self.size = size;
        let columns = (size.width as usize / get_raster_width(FontWeight::Regular, letters)).max(1);
        self.write(&shorten(&caption.text, columns), 0.5, top + MARGIN, letters);
        if let Some([low, high]) = &caption.ramp {
            let row = top + line + MARGIN;
            let third = columns / 3;
            self.draw_ramp(size.width / 3, size.width * 2 / 3, row, letters.val() as u32);
            self.write(&shorten(low, third), 1.0 / 6.0, row, letters);
            self.write(&shorten(high, third), 5.0 / 6.0, row, letters);
        }
        self
    }

    /// Writes text around a place from 0, the left edge, to 1.
    fn write(&mut self, text: &str, place: f32, row: u32, letters: RasterHeight) {
        let width = get_raster_width(FontWeight::Regular, letters);
        let middle = (place * self.size.width as f32) as usize;
        let first = middle.saturating_sub(text.len() * width / 2);
        for (i, letter) in text.chars().enumerate() {
            let Some(raster) = get_raster(letter, FontWeight::Regular, letters) else { continue };
            for (y, line) in raster.rows().enumerate() {
                for (x, &ink) in line.iter().enumerate() {
                    let column = first + i * width + x;
                    if column < self.size.width as usize {
                        let i = (row as usize + y) * self.size.width as usize + column;
                        self.pixels[i] = [255 - ink, 255 - ink, 255 - ink, 255];
                    }
                }
            }
        }
    }

    fn draw_ramp(&mut self, left: u32, right: u32, top: u32, height: u32) {
        for column in left..right {
            let place = f64::from(column - left) / f64::from((right - left).max(2) - 1);
            let [r, g, b] = ramp(place);
            for row in top..top + height {
                self.pixels[(row * self.size.width + column) as usize] = [r, g, b, 255];
            }
        }
    }
}

/// At most so many letters, ASCII only.
fn shorten(text: &str, columns: usize) -> String {
    let ascii = |c: char| if c == ' ' || c.is_ascii_graphic() { c } else { '?' };
    let letters: Vec<char> = text.chars().map(ascii).collect();
    if letters.len() <= columns {
        return letters.into_iter().collect();
    }
    let kept = columns.saturating_sub(2);
    let (head, tail) = (kept.div_ceil(2), kept / 2);
    let tail = &letters[letters.len() - tail..];
    letters[..head].iter().chain(&['.', '.']).chain(tail).take(columns).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_lose_their_middle() {
        assert_eq!(shorten("abcdefghij", 10), "abcdefghij");
        assert_eq!(shorten("abcdefghijk", 10), "abcd..hijk");
        assert_eq!(shorten("abc", 1), ".");
        assert_eq!(shorten("größe\n", 10), "gr??e?");
    }

    #[test]
    fn captions_add_rows_with_ink() {
        let size = Size { width: 120, height: 10 };
        let caption = Caption { text: "sphere".into(), ramp: Some(["0".into(), "1".into()]) };
        let picture = Picture::new(size, [9; 4]).with_caption(&caption);
        assert_eq!(picture.size, Size { width: 120, height: 10 + 2 * 28 });
        assert_eq!(picture.pixels.len(), 120 * 66);
        let ink = |rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| {
            rows.flat_map(|y| columns.clone().map(move |x| y * 120 + x))
                .filter(|&i| picture.pixels[i] != [255; 4])
                .count()
        };
        assert_eq!(ink(0..10, 0..120), 1200, "the picture stays");
        assert!(ink(10..38, 30..90) > 50, "the text stands in the middle");
        assert!(ink(38..66, 40..80) == 16 * 40, "the ramp is between the values");
        assert!(ink(38..66, 0..40) > 5 && ink(38..66, 80..120) > 5, "both values are there");
    }
}
