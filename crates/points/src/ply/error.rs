//! What can go wrong with a PLY file.

use crate::Invalid;
use std::io;
use std::path::PathBuf;

/// Why a file could not be read or written: one line with the file, the place in it and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what each variant and field is")]
pub enum PlyError {
    #[error("{}: cannot be read: {cause}: check its name and permissions", path.display())]
    Read { path: PathBuf, cause: io::Error },
    #[error("{}: is not a regular file: name a file", path.display())]
    NotAFile { path: PathBuf },
    #[error("{}: header line {line}: {problem}", path.display())]
    Header { path: PathBuf, line: usize, problem: String },
    #[error("{}: {problem}", path.display())]
    Missing { path: PathBuf, problem: String },
    #[error(
        "{}: element `{element}`: the header promises {promised} entries, the file ends after {found} ({bytes} bytes \
         of body): get the whole file or correct the count",
        path.display()
    )]
    Truncated { path: PathBuf, element: String, promised: usize, found: u64, bytes: u64 },
    #[error("{}: {element} {index}: {problem}", path.display())]
    Entry { path: PathBuf, element: String, index: usize, problem: String },
    #[error(
        "{}: {bytes} bytes follow the last entry: the counts or types in the header do not fit the body, correct them \
         or cut the rest off",
        path.display()
    )]
    Trailing { path: PathBuf, bytes: u64 },
    #[error("{}: {invalid}", path.display())]
    Invalid { path: PathBuf, invalid: Invalid },
    #[error("{}: cannot be written: {cause}: check the folder, its permissions and free space", path.display())]
    Write { path: PathBuf, cause: io::Error },
    #[error("{}: property `{name}` cannot be written: {problem}", path.display())]
    Property { path: PathBuf, name: String, problem: String },
    #[error("{}: the levels or parents do not fit the points: {problem}", path.display())]
    Provenance { path: PathBuf, problem: String },
}

/// A word from a file, fit for a message of one line.
pub(super) fn quoted(word: &str) -> String {
    const MAX: usize = 60;
    let mut text: String = word.chars().take(MAX).flat_map(char::escape_debug).collect();
    if word.chars().nth(MAX).is_some() {
        text.push_str("...");
    }
    format!("`{text}`")
}
