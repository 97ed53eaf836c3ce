//! Files that appear whole or not at all.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file was not written, and which.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}", path.display())]
pub struct OutputError {
    /// The file or folder.
    pub path: PathBuf,
    /// The cause.
    pub source: io::Error,
}

/// Writes one file so that it appears whole or not at all; makes its folder where there is none.
///
/// # Errors
/// [`OutputError`]; what was there before stays.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let at = |path: &Path| {
        let path = path.to_owned();
        move |source| OutputError { path, source }
    };
    if fs::metadata(path).is_ok_and(|data| !data.is_file()) {
        let source = io::Error::new(io::ErrorKind::AlreadyExists, "it is no regular file");
        return Err(at(path)(source));
    }
    if let Some(parent) = path
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty())
    {
        fs::create_dir_all(parent).map_err(at(parent))?;
    }
    let building = sibling(path, "new");
    let written = fs::write(&building, bytes).and_then(|()| fs::rename(&building, path));
    written.map_err(|source| {
        let _ = fs::remove_file(&building);
        at(path)(source)
    })
}

/// `.name.tag.PID` in the folder of `path`: the process id keeps two runs apart.
#[must_use]
pub fn sibling(path: &Path, tag: &str) -> PathBuf {
    let name = path.file_name().map_or_else(
        || "sortie".into(),
        |name| name.to_string_lossy().into_owned(),
    );
    path.with_file_name(format!(".{name}.{tag}.{}", std::process::id()))
}
