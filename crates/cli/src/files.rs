//! Output files, checked before the long computation.

use crate::Failure;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use surfine_points::ply::{self, Encoding, PlyError};

pub(crate) fn encoding(ascii: bool) -> Encoding {
    if ascii { Encoding::Ascii } else { Encoding::Binary }
}

/// Refuses an output that [`surfine_points::ply::write`] would refuse at the end.
pub(crate) fn check_output(output: &Path) -> Result<(), Failure> {
    let failed = |cause| PlyError::Write { path: output.into(), cause };
    // A link stays; the file behind it is written.
    let target = fs::canonicalize(output).unwrap_or_else(|_| output.into());
    if names_folder(&target) {
        return Err(PlyError::NotAFile { path: output.into() }.into());
    }
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    if !folder.is_dir() {
        let (output, folder) = (output.display(), folder.display());
        return Err(Failure(format!(
            "{output}: cannot be written: {folder} is no folder: make it"
        )));
    }
    match fs::metadata(&target) {
        Ok(metadata) if !metadata.is_file() => {
            return Err(PlyError::NotAFile { path: output.into() }.into());
        }
        Ok(metadata) if metadata.permissions().readonly() => {
            return Err(failed(ErrorKind::PermissionDenied.into()).into());
        }
        // Such as a name that is too long, or a link to itself.
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(failed(error).into()),
        _ => {}
    }
    // Permissions say too little: try. This file has no name, so that nothing can stay behind.
    tempfile::tempfile_in(folder).map_err(failed)?;
    Ok(())
}

/// Refuses a cloud that could not be written at the end, or would take the place of the input.
pub(crate) fn check_cloud(output: &Path, input: &Path) -> Result<(), Failure> {
    if ply::same_file(input, output) {
        let output = output.display();
        return Err(Failure(format!("{output}: is the input too: give the output another name")));
    }
    check_output(output)
}

/// Refuses a picture that could not be written at the end, or would take the place of an input.
pub(crate) fn check_picture<'a>(
    output: &Path,
    inputs: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<(), Failure> {
    let refused = |why: &str| Err(Failure(format!("{}: {why}", output.display())));
    if inputs.into_iter().any(|input| ply::same_file(input, output)) {
        return refused("is an input too: give the output another name");
    }
    if output.extension().is_none_or(|e| !e.eq_ignore_ascii_case("png")) {
        return refused("pictures are PNG: let the name end in .png");
    }
    check_output(output)
}

/// Whether the path can't name a file: it is empty, or ends with `..` or a slash.
fn names_folder(path: &Path) -> bool {
    let slash = path.to_string_lossy().ends_with(std::path::is_separator);
    slash || path.file_name().is_none()
}
