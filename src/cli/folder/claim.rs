//! What a flight holds outside of its folder: a copy of that is the same flight, and vehicles have one commander.

use std::fs::{self, File, TryLockError};
use std::io::{ErrorKind, Write};
use std::net::ToSocketAddrs;
use std::path::{Path, PathBuf};

use crate::cli::folder::sha256;
use crate::cli::print::console::note;
use crate::cli::print::failure::Failure;
use crate::spec::Link;

/// Held as long as it exists; the system lets go of it when the process ends, however it ends.
pub(crate) struct Claims {
    _files: Vec<File>,
}

/// The holder of a claim.
pub(crate) struct Holder {
    process: String,
    /// Its folder of records.
    pub(crate) runs: PathBuf,
}

/// Claims a flight, by its name among all of this computer, and the vehicles on their links, for the process that
/// records in `runs`.
///
/// # Errors
/// Another process of this computer has one of them.
pub(crate) fn claim(flight: &str, systems: &[(u8, &Link)], runs: &Path) -> Result<Claims, Failure> {
    let flight = (!flight.is_empty()).then(|| key_of_flight(flight));
    let links = systems
        .iter()
        .map(|(system, link)| key_of_link(*system, link));
    let mut files = Vec::new();
    for key in flight.into_iter().chain(links) {
        match try_claim(&key, runs) {
            Ok(Ok(file)) => files.push(file),
            Ok(Err(holder)) => return Err(refusal(holder)),
            Err(error) => {
                note(&format!(
                    "WARNING: nothing keeps a copy of this flight from being taken over beside it: {}: {error}",
                    folder().display()
                ));
                break;
            }
        }
    }
    Ok(Claims { _files: files })
}

/// Who flies a flight, if a process does and it says so.
pub(crate) fn holder_of(flight: &str) -> Option<Holder> {
    if flight.is_empty() {
        return None;
    }
    let path = path_of(&key_of_flight(flight));
    let file = File::open(&path).ok()?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => read_holder(&path),
        _ => None,
    }
}

fn refusal(holder: Option<Holder>) -> Failure {
    let who = holder.map_or_else(
        || "another `sortie`".to_owned(),
        |Holder { process, runs }| {
            let name = runs.to_string_lossy().into_owned();
            let plan = name.strip_suffix(".runs").unwrap_or(&name);
            format!(
                "`sortie` as process {process}, which records in {name}: `sortie watch {plan}` attaches to it"
            )
        },
    );
    let message = format!(
        "this flight, or one of its vehicles, is flown by {who}; a vehicle has one commander, and nothing was started or taken over"
    );
    Failure::new(Failure::TRANSFER, message)
}

fn key_of_flight(flight: &str) -> String {
    format!("flight {flight}")
}

/// Names of one address are the same link.
fn key_of_link(system: u8, link: &Link) -> String {
    let address = match link {
        Link::UdpOut(address) | Link::UdpIn(address) | Link::Tcp(address) => {
            let first = |mut all: std::vec::IntoIter<_>| all.next();
            let found = address.to_socket_addrs().ok().and_then(first);
            found.map_or_else(
                || address.clone(),
                |found: std::net::SocketAddr| found.to_string(),
            )
        }
        other => other.to_string(),
    };
    format!("system {system} at {address}")
}

/// One place for all users of the computer.
fn folder() -> PathBuf {
    let shared = Path::new("/tmp");
    let base = match cfg!(unix) && shared.is_dir() {
        true => shared.to_owned(),
        false => std::env::temp_dir(),
    };
    base.join("sortie-flights")
}

fn path_of(key: &str) -> PathBuf {
    folder().join(sha256(key)).with_extension("lock")
}

/// The lock, or who has it.
fn try_claim(key: &str, runs: &Path) -> std::io::Result<Result<File, Option<Holder>>> {
    make_folder()?;
    let path = path_of(key);
    let mut options = File::options();
    let opened = options
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(&path);
    let file = match opened {
        // That of another user can be locked all the same.
        Err(error) if error.kind() == ErrorKind::PermissionDenied => File::open(&path)?,
        opened => opened?,
    };
    match file.try_lock() {
        Ok(()) => {
            write_holder(&path, runs);
            Ok(Ok(file))
        }
        Err(TryLockError::WouldBlock) => Ok(Err(read_holder(&path))),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// A hint alone: one that another user left cannot be replaced.
fn write_holder(path: &Path, runs: &Path) {
    let hint = path.with_extension("holder");
    let _ = fs::remove_file(&hint);
    // No link is followed to another file.
    if let Ok(mut file) = File::create_new(&hint) {
        let _ = writeln!(file, "{}\n{}", std::process::id(), runs.display());
    }
}

fn read_holder(path: &Path) -> Option<Holder> {
    let text = fs::read_to_string(path.with_extension("holder")).ok()?;
    let (process, runs) = text.trim_end().split_once('\n')?;
    Some(Holder {
        process: process.to_owned(),
        runs: PathBuf::from(runs),
    })
}

fn make_folder() -> std::io::Result<()> {
    let folder = folder();
    if folder.is_dir() {
        return Ok(());
    }
    fs::create_dir_all(&folder)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As the folder that it is in: everybody may add, nobody removes what is not his.
        fs::set_permissions(&folder, fs::Permissions::from_mode(0o1777))?;
    }
    Ok(())
}
