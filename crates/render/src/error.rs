//! What can go wrong on the way to a picture.

use std::path::PathBuf;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The device fails, or is too small.
    #[error(transparent)]
    Device(#[from] surfine::Error),
    /// No pixels, or more than the device or a PNG file can hold.
    #[error(
        "a picture of {width} x {height} pixels with {supersampling} x {supersampling} subpixels each can't be drawn: \
         the sides in subpixels must be 1 to {limit}, so make it smaller or take fewer subpixels"
    )]
    Size {
        /// Pixels of a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Subpixels along a pixel's side.
        supersampling: u32,
        /// Most subpixels along a side.
        limit: u32,
    },
    /// Subpixels that no picture has.
    #[error(
        "{supersampling} x {supersampling} subpixels a pixel can't be drawn: take 1 to 8 along a side"
    )]
    Supersampling {
        /// Subpixels along a pixel's side.
        supersampling: u32,
    },
    /// A file could not be written.
    #[error("{}: the picture can't be written: {message}: check the folder, its permissions and free space", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        message: String,
    },
}
