//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that is written beside the one it will replace.
#[derive(Debug)]
pub struct Replacement {
    file: NamedTempFile,
    target: PathBuf,
}

/// Writes a file with `fill`; it appears whole or not at all. A link stays: the file behind it is replaced.
///
/// # Errors
/// The path names something other than a file, or one that must not be written to; what `fill` or the system complains of.
pub fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let replacement = Replacement::new(path)?;
    let mut out = replacement.writer()?;
    fill(&mut out)?;
    out.flush()?;
    replacement.finish()
}

impl Replacement {
    /// Opens a temporary file in the folder of `path`. It vanishes unless it is finished.
    ///
    /// # Errors
    /// The path names something other than a file, or one that must not be written to; the folder can't be written to.
    pub fn new(path: &Path) -> io::Result<Self> {
        let target = destination(path)?;
        let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty());
        let mut builder = tempfile::Builder::new();
        builder.prefix(".surfine-").suffix(".tmp");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // As for any new file; the umask takes its share.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let file = builder.tempfile_in(folder.unwrap_or(Path::new(".")))?;
        Ok(Self { file, target })
    }

    /// Where to write. Flush it before [`Replacement::finish`].
    ///
    /// # Errors
    /// What the system complains of.
    pub fn writer(&self) -> io::Result<BufWriter<File>> {
        Ok(BufWriter::with_capacity(1 << 16, self.file.as_file().try_clone()?))
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// What the system complains of.
    pub fn finish(self) -> io::Result<()> {
        self.file.persist(&self.target).map_err(|error| error.error)?;
        Ok(())
    }
}

/// The file to replace: the target of a link, so that the link stays.
fn destination(path: &Path) -> io::Result<PathBuf> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.into());
    match fs::metadata(&target) {
        // A rename would put a file in place of the device or pipe.
        Ok(metadata) if !metadata.is_file() => {
            Err(io::Error::new(ErrorKind::InvalidInput, "it is not a regular file"))
        }
        // A rename would ignore the protection.
        Ok(metadata) if metadata.permissions().readonly() => {
            Err(ErrorKind::PermissionDenied.into())
        }
        _ => Ok(target),
    }
}
