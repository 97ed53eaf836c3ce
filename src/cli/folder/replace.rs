//! Output folders appear whole or not at all.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::Serialize;

use crate::formats::{OutputError, sibling};
use crate::numeric::text::JsonWriter;

pub(crate) use crate::formats::write_file;

fn at(path: &Path) -> impl FnOnce(io::Error) -> OutputError + '_ {
    move |source| OutputError {
        path: path.to_owned(),
        source,
    }
}

/// A folder under construction beside its final place. Dropped before
/// [`Self::publish`], it leaves nothing behind.
pub(crate) struct NewFolder {
    target: PathBuf,
    building: PathBuf,
    published: bool,
}

impl NewFolder {
    /// Starts a folder that is to appear as `target`, unless what is there is in the
    /// way. A link is followed, so that it still is one afterwards.
    pub(crate) fn next_to(
        target: &Path,
        reason_not_to_replace: impl Fn(&Path) -> Option<String>,
    ) -> Result<Self, OutputError> {
        let target = &replaceable(target, reason_not_to_replace)?;
        if let Some(parent) = target.parent() {
            fs::create_dir_all(parent).map_err(at(parent))?;
        }
        remove_leftovers(target);
        let building = sibling(target, "new");
        if building.exists() {
            fs::remove_dir_all(&building).map_err(at(&building))?;
        }
        fs::create_dir(&building).map_err(at(&building))?;
        Ok(Self {
            target: target.to_owned(),
            building,
            published: false,
        })
    }

    /// Writes one file; `name` may contain folders.
    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        let path = self.building.join(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(at(parent))?;
        }
        fs::write(&path, bytes).map_err(at(&path))
    }

    /// Writes a document as [`crate::report::json_text`] has it, piece by piece.
    pub(crate) fn write_json(
        &self,
        name: &str,
        document: &impl Serialize,
    ) -> Result<(), OutputError> {
        let path = self.building.join(name);
        let mut file = BufWriter::new(fs::File::create(&path).map_err(at(&path))?);
        serde_json::to_writer_pretty(JsonWriter(&mut file), document)
            .map_err(io::Error::from)
            .and_then(|()| file.write_all(b"\n"))
            .and_then(|()| file.flush())
            .map_err(at(&path))
    }

    /// Copies a file of any size; `name` may contain folders.
    pub(crate) fn copy(&self, from: &Path, name: &str) -> Result<(), OutputError> {
        let path = self.building.join(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(at(parent))?;
        }
        let mut source = fs::File::open(from).map_err(at(from))?;
        let mut target = fs::File::create(&path).map_err(at(&path))?;
        io::copy(&mut source, &mut target).map_err(at(&path))?;
        Ok(())
    }

    /// Puts the folder in its place: old aside, new in, old removed.
    pub(crate) fn publish(mut self) -> Result<(), OutputError> {
        let old = sibling(&self.target, "old");
        if old.exists() {
            fs::remove_dir_all(&old).map_err(at(&old))?;
        }
        let replaces = self.target.exists();
        if replaces {
            fs::rename(&self.target, &old).map_err(at(&self.target))?;
        }
        if let Err(error) = fs::rename(&self.building, &self.target) {
            if replaces {
                // Give back what was there; if even that fails, it is still under its other name.
                let _ = fs::rename(&old, &self.target);
            }
            return Err(at(&self.target)(error));
        }
        self.published = true;
        if replaces {
            fs::remove_dir_all(&old).map_err(at(&old))?;
        }
        Ok(())
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        if !self.published {
            let _ = fs::remove_dir_all(&self.building);
        }
    }
}

/// Checks that [`NewFolder`] can appear as `target`, before the work whose result goes there.
/// Leaves nothing behind.
///
/// # Errors
/// What is there must stay, or the deepest folder of its path that exists cannot be written.
pub(crate) fn check(
    target: &Path,
    reason_not_to_replace: impl Fn(&Path) -> Option<String>,
) -> Result<(), OutputError> {
    let target = replaceable(target, reason_not_to_replace)?;
    let mut above = target.ancestors().skip(1);
    let Some(parent) = above.find(|path| path.symlink_metadata().is_ok()) else {
        return Ok(());
    };
    if !parent.is_dir() {
        let source = io::Error::new(
            io::ErrorKind::NotADirectory,
            format!("{} is no folder", parent.display()),
        );
        return Err(at(&target)(source));
    }
    let probe = sibling(&parent.join("sortie"), "probe");
    fs::create_dir(&probe)
        .and_then(|()| fs::remove_dir(&probe))
        .map_err(|error| {
            let why = format!("{}: {error}", parent.display());
            at(&target)(io::Error::new(error.kind(), why))
        })
}

/// The absolute path of `target`, links followed, unless what is there must stay.
fn replaceable(
    target: &Path,
    reason_not_to_replace: impl Fn(&Path) -> Option<String>,
) -> Result<PathBuf, OutputError> {
    let target = fs::canonicalize(target)
        .or_else(|_| std::path::absolute(target))
        .map_err(at(target))?;
    match reason_not_to_replace(&target) {
        Some(reason) => Err(at(&target)(io::Error::new(
            io::ErrorKind::AlreadyExists,
            reason,
        ))),
        None => Ok(target),
    }
}

/// A folder under construction is done within a second. One that was left an hour
/// ago belongs to a run that was killed.
const LEFTOVER: Duration = Duration::from_secs(3600);

/// Removes what killed runs have left beside `target`, as far as that is possible.
fn remove_leftovers(target: &Path) {
    let Some((parent, name)) = target.parent().zip(target.file_name()) else {
        return;
    };
    let ours = ["new", "old"].map(|tag| format!(".{}.{tag}.", name.to_string_lossy()));
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let is_ours = ours
            .iter()
            .any(|start| entry.file_name().to_string_lossy().starts_with(start));
        let age = entry
            .metadata()
            .and_then(|data| data.modified())
            .map(|time| time.elapsed());
        if is_ours && matches!(age, Ok(Ok(age)) if age > LEFTOVER) {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::folder::reason_not_to_replace;

    #[test]
    fn a_folder_replaces_the_old_one_as_a_whole() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("out");
        for round in ["one", "two"] {
            let folder = NewFolder::next_to(&target, |_| None).unwrap();
            for name in [&format!("{round}/file"), "spec.yaml", "plan.json"] {
                folder.write(name, round.as_bytes()).unwrap();
            }
            folder.publish().unwrap();
        }
        assert!(!target.join("one").exists());
        assert_eq!(fs::read(target.join("two/file")).unwrap(), b"two");
        assert_eq!(
            fs::read_dir(home.path()).unwrap().count(),
            1,
            "nothing is left beside it"
        );
    }

    #[test]
    fn a_folder_that_is_never_published_leaves_nothing_and_keeps_the_old_one() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("out");
        fs::create_dir(&target).unwrap();
        for name in ["kept", "spec.yaml", "plan.json"] {
            fs::write(target.join(name), b"").unwrap();
        }
        drop(NewFolder::next_to(&target, |_| None).unwrap());
        assert!(target.join("kept").exists());
        assert_eq!(fs::read_dir(home.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_a_killed_run_left_is_removed_after_an_hour_and_not_before() {
        let home = tempfile::tempdir().unwrap();
        let (stale, fresh) = (
            home.path().join(".out.new.1"),
            home.path().join(".out.new.2"),
        );
        for folder in [&stale, &fresh] {
            fs::create_dir(folder).unwrap();
        }
        let then = std::time::SystemTime::UNIX_EPOCH;
        fs::File::open(&stale).unwrap().set_modified(then).unwrap();
        drop(NewFolder::next_to(&home.path().join("out"), |_| None).unwrap());
        assert!(!stale.exists() && fresh.exists());
    }

    #[test]
    fn a_folder_that_is_not_an_earlier_plan_is_never_replaced() {
        let home = tempfile::tempdir().unwrap();
        fs::write(home.path().join("thesis.tex"), b"").unwrap();
        let message = NewFolder::next_to(home.path(), reason_not_to_replace)
            .err()
            .unwrap()
            .to_string();
        assert!(message.contains("not replaced"), "{message}");
        assert!(home.path().join("thesis.tex").exists());
    }

    /// A plan folder with other files in it.
    fn planned_with(others: &[&str]) -> tempfile::TempDir {
        let home = tempfile::tempdir().unwrap();
        let spec = "sortie: 2\n";
        let hash = crate::cli::folder::sha256(spec);
        let plan = format!(r#"{{"sortie": "1", "spec_sha256": "{hash}"}}"#);
        let files = [("spec.yaml", spec), ("plan.json", &plan)];
        let others = others.iter().map(|name| (*name, "{}"));
        for (name, text) in files.into_iter().chain(others) {
            fs::write(home.path().join(name), text).unwrap();
        }
        home
    }

    #[test]
    fn a_certified_plan_is_replaced_with_its_certificate() {
        let home = planned_with(&["certificate.json"]);
        let folder = NewFolder::next_to(home.path(), reason_not_to_replace).unwrap();
        folder.write("plan.json", b"{}").unwrap();
        folder.publish().unwrap();
        assert!(home.path().join("plan.json").exists());
        assert!(
            !home.path().join("certificate.json").exists(),
            "it is of the old plan"
        );
        let foreign = planned_with(&["certificate.json", "thesis.json"]);
        let reason = reason_not_to_replace(foreign.path()).unwrap();
        assert!(reason.contains("thesis.json"), "{reason}");
    }

    #[test]
    fn a_file_in_the_way_is_an_error_that_names_it() {
        let home = tempfile::tempdir().unwrap();
        let target = home.path().join("out");
        fs::write(&target, b"").unwrap();
        let message = NewFolder::next_to(&target, reason_not_to_replace)
            .err()
            .unwrap()
            .to_string();
        assert!(
            message.contains("out") && message.contains("in the way"),
            "{message}"
        );
    }
}
