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
    /// What the colours mean.
    pub scale: Option<Scale>,
}

/// What the colours of a picture mean.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Scale {
    /// What is shown. It stands before the value at the low end, or in the line of text where there is no room.
    pub what: String,
    /// The values at both ends of the ramp; `..` where there is no room for one.
    pub ends: [String; 2],
}

impl Picture {
    /// The picture with a strip below it.
    #[must_use]
    pub fn with_caption(mut self, caption: &Caption) -> Self {
        let letters =
            if self.size.width < WIDE { RasterHeight::Size16 } else { RasterHeight::Size24 };
        let line = letters.val() as u32 + 2 * MARGIN;
        let lines = 1 + u32::from(caption.scale.is_some());
        let top = self.size.height;
        let size = Size { height: top + lines * line, ..self.size };
        self.pixels.resize(size.pixels(), [255; 4]);
        self.size = size;
        let columns = (size.width as usize / get_raster_width(FontWeight::Regular, letters)).max(1);
        let third = columns / 3;
        let (text, ends) = caption.lines(third);
        self.write(&shorten(&text, columns), 0.5, top + MARGIN, letters);
        if let Some([low, high]) = ends {
            let row = top + line + MARGIN;
            self.draw_ramp(size.width / 3, size.width * 2 / 3, row, letters.val() as u32);
            self.write(&shorten(&low, third), 1.0 / 6.0, row, letters);
            self.write(&shorten(&high, third), 5.0 / 6.0, row, letters);
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

impl Caption {
    /// The line of text, and what stands at both ends of the ramp, where there is room for so many letters.
    fn lines(&self, room: usize) -> (String, Option<[String; 2]>) {
        let Some(Scale { what, ends: [low, high] }) = &self.scale else {
            return (self.text.clone(), None);
        };
        // Part of a number would be another number.
        let whole = |value: &String| if value.len() <= room { value.clone() } else { "..".into() };
        let named = format!("{what} {low}");
        if named.len() <= room {
            return (self.text.clone(), Some([named, whole(high)]));
        }
        let parts = [self.text.as_str(), what].into_iter().filter(|part| !part.is_empty());
        (parts.collect::<Vec<_>>().join(", "), Some([low, high].map(whole)))
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

    fn scale(what: &str, low: &str, high: &str) -> Scale {
        Scale { what: what.into(), ends: [low.into(), high.into()] }
    }

    #[test]
    fn values_are_never_cut() {
        let caption = |text: &str| Caption {
            text: text.into(),
            scale: Some(scale("radius", "1.234e-1", "5.678e-1")),
        };
        let lines = |text, room| {
            let (text, ends) = caption(text).lines(room);
            let [low, high] = ends.unwrap();
            [text, low, high]
        };
        assert_eq!(lines("a", 15), ["a", "radius 1.234e-1", "5.678e-1"]);
        assert_eq!(lines("a", 14), ["a, radius", "1.234e-1", "5.678e-1"]);
        assert_eq!(lines("", 8), ["radius", "1.234e-1", "5.678e-1"]);
        assert_eq!(lines("a", 7), ["a, radius", "..", ".."]);
    }

    #[test]
    fn captions_add_rows_with_ink() {
        let size = Size { width: 120, height: 10 };
        let caption = Caption { text: "sphere".into(), scale: Some(scale("r", "0", "1")) };
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
