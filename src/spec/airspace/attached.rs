//! Files that a spec names beside its terrain and its table: airspace and obstacles.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::spec::positions::Positions;
use crate::spec::{Issue, check, keys};

/// Largest file of airspace. A national feed has a few MiB.
const MAX_BYTES: u64 = 64 << 20;

/// A file that a spec names, byte for byte.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AttachedFile {
    /// Its path relative to the spec.
    pub name: PathBuf,
    /// What it holds.
    pub bytes: Vec<u8>,
}

/// What became of a file of airspace or obstacles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AirspaceImport {
    /// The file, as the spec names it.
    pub file: String,
    /// Ids of its zones, in file order.
    pub zones: Vec<String>,
    /// Shapes that no vehicle can reach: beside the area, or above its ceiling.
    pub out_of_reach: usize,
    /// Those of them that would be in the area if latitude and longitude were exchanged.
    pub axes_swapped: usize,
    /// Shapes of a class that `only` does not name, or that `skip` names.
    pub left_out: usize,
    /// Shapes that forbid nothing.
    pub unrestricted: usize,
    /// Lines and points, which enclose nothing.
    pub without_area: usize,
    /// Names of `skip` and classes of `only` that nothing in the file has, each with what was meant, if
    /// anything in it is like it.
    pub unmatched: Vec<(String, Option<String>)>,
}

/// The files of all keys, in their order, and what is wrong with those that cannot be read: they are empty.
pub(in crate::spec) fn read(
    spec: &Path,
    keys: &keys::Spec,
    positions: &Positions,
) -> (Vec<AttachedFile>, Vec<Issue>) {
    let airspace = keys.airspace.iter().enumerate();
    let airspace = airspace.map(|(index, of)| (format!("airspace[{index}].file"), &of.file));
    let obstacles = keys.obstacles.iter().enumerate();
    let obstacles = obstacles.map(|(index, of)| (format!("obstacles[{index}].file"), &of.file));
    let (mut files, mut issues) = (Vec::new(), Vec::new());
    for (path, name) in airspace.chain(obstacles) {
        let mut report = |found: String, allowed: String| {
            issues.push(Issue {
                position: positions.find(&path),
                path: path.clone(),
                table: None,
                found,
                allowed,
            });
        };
        let Some(relative) = check::relative(name) else {
            let allowed = "a path relative to the spec, with /, without .. and drive letters";
            report(format!("`{}`", name.escape_debug()), allowed.to_owned());
            files.push(AttachedFile::default());
            continue;
        };
        let file = spec.parent().unwrap_or(Path::new("")).join(&relative);
        let mut bytes = Vec::new();
        let read = File::open(&file).and_then(|of| of.take(MAX_BYTES + 1).read_to_end(&mut bytes));
        let is_large = u64::try_from(bytes.len()).is_ok_and(|length| length > MAX_BYTES);
        if let Err(error) = &read {
            report(
                format!("{}: cannot be read: {error}", file.display()),
                "a file beside the spec".to_owned(),
            );
        } else if is_large {
            report(
                format!("{}: too large", file.display()),
                format!("at most {} MiB", MAX_BYTES >> 20),
            );
        }
        if read.is_err() || is_large {
            bytes.clear();
        }
        files.push(AttachedFile {
            name: relative,
            bytes,
        });
    }
    (files, issues)
}
