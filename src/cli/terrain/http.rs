//! One file over HTTP: resumed, checked, whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use ureq::Agent;
use ureq::http::Response;

use crate::cli::print::failure::Failure;

/// Largest file taken: ten SRTM tiles of one arc-second.
const MAX_BYTES: u64 = 256 << 20;
/// How often a transfer that breaks off is gone on with.
const ATTEMPTS: u32 = 4;
/// How long a server may be silent.
const PATIENCE: Duration = Duration::from_secs(20);

/// What became of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// It is there.
    Written {
        /// Its size.
        bytes: u64,
        /// Whether a part of it was there from before.
        resumed: bool,
    },
    /// The server has none.
    NotThere,
}

/// Why one attempt did not bring the file.
enum Broken {
    /// Trying again may help.
    Again(String),
    /// It does not.
    Final(Failure),
}

pub(crate) struct Client {
    agent: Agent,
}

/// A file on its way: what has arrived, and which version of the file that was.
struct Partial {
    bytes: PathBuf,
    version: PathBuf,
}

impl Client {
    pub(crate) fn new() -> Self {
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .timeout_connect(Some(PATIENCE))
            .timeout_recv_response(Some(PATIENCE))
            .timeout_per_read(Some(PATIENCE))
            .build();
        Self {
            agent: config.into(),
        }
    }

    /// Gets a file to a path, if `check` finds it good.
    pub(crate) fn get(
        &self,
        url: &str,
        path: &Path,
        check: impl Fn(&Path) -> Result<(), Failure>,
    ) -> Result<Outcome, Failure> {
        let partial = Partial::of(path)?;
        let mut why = String::new();
        for _ in 0..ATTEMPTS {
            match self.attempt(url, &partial) {
                Ok(None) => {
                    partial.remove();
                    return Ok(Outcome::NotThere);
                }
                Ok(Some(arrived)) => match partial.finish(path, &check) {
                    Ok(()) => return Ok(arrived),
                    // Parts that do not fit together; then the whole at once.
                    Err(failure) if matches!(arrived, Outcome::Written { resumed: true, .. }) => {
                        why = failure.message;
                        fs::create_dir_all(partial.bytes.parent().unwrap_or(Path::new("")))
                            .map_err(|error| unwritable(&partial.bytes, &error))?;
                    }
                    Err(failure) => return Err(failure),
                },
                Err(Broken::Again(reason)) => why = reason,
                Err(Broken::Final(failure)) => return Err(failure),
            }
        }
        let message = format!("{url}: {why}; what arrived is kept, and gone on with next time");
        Err(Failure::new(Failure::TRANSFER, message))
    }

    /// Appends what is missing; `None` if the server has no such file.
    fn attempt(&self, url: &str, partial: &Partial) -> Result<Option<Outcome>, Broken> {
        let have = partial.length();
        let mut request = self.agent.get(url);
        if have > 0 {
            let version = partial.version().unwrap_or_default();
            request = request
                .header("Range", format!("bytes={have}-"))
                .header("If-Range", version);
        }
        let mut response = request.call().map_err(|error| again(&error))?;
        let start = match response.status().as_u16() {
            200 => 0,
            206 if range_start(&response) == Some(have) => have,
            404 | 410 => return Ok(None),
            // The part was the whole, or of another file: begin again.
            206 | 416 => {
                let _ = fs::remove_file(&partial.version);
                return Err(Broken::Again("the server has no such part".to_owned()));
            }
            status @ (408 | 429 | 500..=599) => {
                return Err(Broken::Again(format!("the server answers {status}")));
            }
            status => {
                let message = format!("{url}: the server answers {status}");
                return Err(Broken::Final(Failure::new(Failure::TRANSFER, message)));
            }
        };
        let rest = response.body().content_length();
        if start + rest.unwrap_or(0) > MAX_BYTES {
            return Err(too_large(url));
        }
        let version = header(&response, "etag")
            .filter(|tag| !tag.starts_with("W/"))
            .or_else(|| header(&response, "last-modified"));
        let disk = |error: io::Error| Broken::Final(unwritable(&partial.bytes, &error));
        let mut file = partial.open(start, version).map_err(disk)?;
        let arrived = append(
            response.body_mut().as_reader(),
            &mut file,
            MAX_BYTES - start,
        )
        .map_err(|error| match error {
            Stopped::Network(error) => Broken::Again(format!("the transfer broke off: {error}")),
            Stopped::Disk(error) => disk(error),
            Stopped::Limit => too_large(url),
        })?;
        file.sync_all().map_err(disk)?;
        match rest {
            Some(rest) if arrived < rest => Err(Broken::Again(format!(
                "the transfer broke off after {} of {} bytes",
                start + arrived,
                start + rest
            ))),
            _ => Ok(Some(Outcome::Written {
                bytes: start + arrived,
                resumed: start > 0,
            })),
        }
    }
}

fn again(error: &dyn std::fmt::Display) -> Broken {
    Broken::Again(error.to_string())
}

fn too_large(url: &str) -> Broken {
    let message = format!("{url}: too large (allowed: {} MiB)", MAX_BYTES >> 20);
    Broken::Final(Failure::new(Failure::TRANSFER, message))
}

fn header<T>(response: &Response<T>, name: &str) -> Option<String> {
    let value = response.headers().get(name)?.to_str().ok()?;
    Some(value.to_owned())
}

/// Where a partial answer begins: `Content-Range: bytes 100-199/200`.
fn range_start<T>(response: &Response<T>) -> Option<u64> {
    let range = header(response, "content-range")?;
    let (first, _) = range.strip_prefix("bytes ")?.split_once('-')?;
    first.parse().ok()
}

enum Stopped {
    Network(io::Error),
    Disk(io::Error),
    Limit,
}

/// Writes all that comes at once, so that nothing is lost when it breaks off.
fn append(mut from: impl Read, to: &mut File, limit: u64) -> Result<u64, Stopped> {
    let mut buffer = vec![0; 1 << 16];
    let mut arrived = 0;
    loop {
        let count = match from.read(&mut buffer) {
            Ok(0) => return Ok(arrived),
            Ok(count) => count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(Stopped::Network(error)),
        };
        arrived += count as u64;
        if arrived > limit {
            return Err(Stopped::Limit);
        }
        to.write_all(&buffer[..count]).map_err(Stopped::Disk)?;
    }
}

impl Partial {
    /// In a folder beside the final place, under the final name, which a tile needs.
    fn of(path: &Path) -> Result<Self, Failure> {
        let folder = path.with_file_name(".fetch");
        fs::create_dir_all(&folder).map_err(|error| unwritable(&folder, &error))?;
        let name = path.file_name().unwrap_or_default();
        let bytes = folder.join(name);
        let mut version = name.to_owned();
        version.push(".version");
        Ok(Self {
            version: folder.join(version),
            bytes,
        })
    }

    /// The part to resume; none if its version is not known.
    fn length(&self) -> u64 {
        match self.version() {
            Some(_) => fs::metadata(&self.bytes).map_or(0, |data| data.len()),
            None => 0,
        }
    }

    fn version(&self) -> Option<String> {
        fs::read_to_string(&self.version).ok()
    }

    /// Opens it for appending from `start`; from 0 it is another version.
    fn open(&self, start: u64, version: Option<String>) -> io::Result<File> {
        if start > 0 {
            return OpenOptions::new().append(true).open(&self.bytes);
        }
        let file = File::create(&self.bytes)?;
        match version {
            Some(version) => fs::write(&self.version, version)?,
            None if self.version.exists() => fs::remove_file(&self.version)?,
            None => {}
        }
        Ok(file)
    }

    /// Puts it in its place if it is good. Bad or good, there is nothing to go on with.
    fn finish(
        &self,
        path: &Path,
        check: &impl Fn(&Path) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let put = || fs::rename(&self.bytes, path).map_err(|error| unwritable(path, &error));
        let done = check(&self.bytes).and_then(|()| put());
        self.remove();
        done
    }

    fn remove(&self) {
        let _ = fs::remove_file(&self.version);
        let _ = fs::remove_file(&self.bytes);
        // Gone only when nothing else is on its way.
        let _ = self.bytes.parent().map(fs::remove_dir);
    }
}

fn unwritable(path: &Path, error: &io::Error) -> Failure {
    let message = format!("cannot write {}: {error}", path.display());
    Failure::new(Failure::OUTPUT, message)
}
