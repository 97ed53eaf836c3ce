//! `DIR.runs/`: the records of uploads and flights beside a plan, and who is at work on it.

use std::ffi::OsStr;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use crate::cli::print::failure::Failure;
use crate::flight::{FlightHandoff, unix_ms};

/// The folder of the records of the plan in `out`.
pub(crate) fn folder(out: &Path) -> PathBuf {
    // A link leads to the same plan.
    let out = fs::canonicalize(out)
        .or_else(|_| std::path::absolute(out))
        .unwrap_or_else(|_| out.to_owned());
    let mut name = out.file_name().map(OsStr::to_owned).unwrap_or_default();
    name.push(".runs");
    out.with_file_name(name)
}

/// Makes the folder, before anything is done that shall be recorded there.
///
/// # Errors
/// Something else is in its place, or it cannot be made.
pub(crate) fn make(runs: &Path) -> Result<(), Failure> {
    if runs.exists() && !runs.is_dir() {
        let message = format!(
            "{} is no folder, and one goes there for the records of uploads and flights: move it away; nothing was sent or started",
            runs.display()
        );
        return Err(Failure::new(Failure::OUTPUT, message));
    }
    fs::create_dir_all(runs).map_err(|error| {
        let message = format!("cannot make the folder {}: {error}", runs.display());
        Failure::new(Failure::OUTPUT, message)
    })
}

pub(crate) fn seconds_since_1970() -> u64 {
    unix_ms() / 1000
}

/// A file for a new record, named after the time; with a number when that second has one already.
pub(crate) fn named(runs: &Path, what: &str, ending: &str) -> PathBuf {
    let seconds = seconds_since_1970();
    let first = runs.join(format!("{what}-{seconds}.{ending}"));
    let more = (2..).map(|n| runs.join(format!("{what}-{seconds}-{n}.{ending}")));
    let mut names = std::iter::once(first.clone()).chain(more);
    // A link counts, wherever it leads.
    let is_free = |path: &PathBuf| fs::symlink_metadata(path).is_err();
    names.find(is_free).unwrap_or(first)
}

/// Held while one command is at work on a plan; the system lets go of it when the command ends,
/// however it ends.
pub(crate) struct PlanLock {
    _file: File,
}

/// Holds a plan for one command, `fly` or `replan`.
///
/// # Errors
/// Another one has it, or its file cannot be written.
pub(crate) fn lock(runs: &Path, command: &str) -> Result<PlanLock, Failure> {
    try_lock(runs, command)?.ok_or_else(|| {
        let message = format!(
            "another `sortie {command}` is at work on this plan (it holds {}); nothing was started",
            lock_path(runs, command).display()
        );
        Failure::new(Failure::TRANSFER, message)
    })
}

/// Holds the plan in `out` for a flight that begins.
///
/// # Errors
/// It is flown, or a flight by it broke off.
pub(crate) fn lock_for_flight(out: &Path) -> Result<PlanLock, Failure> {
    let lock = lock(&folder(out), "fly")?;
    refuse_broken_off(out)?;
    Ok(lock)
}

/// The same as [`lock`]; none if another one has it.
///
/// # Errors
/// Its file cannot be written.
pub(crate) fn try_lock(runs: &Path, command: &str) -> Result<Option<PlanLock>, Failure> {
    let path = lock_path(runs, command);
    let unwritable = |error: std::io::Error| {
        let message = format!("cannot write {}: {error}", path.display());
        Failure::new(Failure::OUTPUT, message)
    };
    make(runs)?;
    let mut options = File::options();
    let file = options.create(true).truncate(false).write(true).open(&path);
    let file = file.map_err(unwritable)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(PlanLock { _file: file })),
        Err(TryLockError::WouldBlock) => Ok(None),
        // A file system without locks keeps nobody apart.
        Err(TryLockError::Error(error)) if error.kind() == std::io::ErrorKind::Unsupported => {
            Ok(Some(PlanLock { _file: file }))
        }
        Err(TryLockError::Error(error)) => Err(unwritable(error)),
    }
}

fn lock_path(runs: &Path, command: &str) -> PathBuf {
    runs.join(format!(".{command}.lock"))
}

/// Refuses to begin anything new on a plan whose flight broke off: its vehicles may be in the air.
///
/// # Errors
/// There is such a flight.
pub(crate) fn refuse_broken_off(out: &Path) -> Result<(), Failure> {
    let Some(record) = FlightHandoff::broken_off(&folder(out)) else {
        return Ok(());
    };
    let out = out.display();
    let message = format!(
        "a flight by this plan broke off (its record is {}), and its vehicles may be in the air: `sortie watch {out}` takes \
         it over. Where you know that all are down, Ctrl-C there and `q` end it; nothing was started",
        record.display()
    );
    Err(Failure::new(Failure::TRANSFER, message))
}

/// Whether a flight by the plan in `out` goes on.
pub(crate) fn is_in_flight(out: &Path) -> bool {
    let path = lock_path(&folder(out), "fly");
    let Ok(file) = File::options().write(true).open(path) else {
        return false;
    };
    matches!(file.try_lock(), Err(TryLockError::WouldBlock))
}
