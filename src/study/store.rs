//! The folder of a study: finished runs survive a kill, and shards become one study.
//!
//! - `study.json`: the configuration.
//! - `journal.jsonl`: finished runs, each appended in one write; a last line without its end is
//!   an unfinished run.
//! - `runs.jsonl`: all runs in the order of the study. It appears whole when the runs are
//!   finished, and the journal is removed.
//! - `times.jsonl`: wall times in seconds.
//! - `.lock`: locked while a process writes.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::workers::Done;

const CONFIG: &str = "study.json";
const JOURNAL: &str = "journal.jsonl";
const RUNS: &str = "runs.jsonl";
const TIMES: &str = "times.jsonl";
const LOCK: &str = ".lock";

/// An error of a study's folder.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A file or folder cannot be used.
    #[error("cannot use {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A file has invalid content.
    #[error("{}:{line}: {reason}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The cause.
        reason: String,
    },
    /// Another process writes to the folder.
    #[error("{} is being written by another process", .0.display())]
    Busy(PathBuf),
    /// The folder has results, and resuming was not requested.
    #[error("{} already holds a study; use --resume or another folder", .0.display())]
    Occupied(PathBuf),
    /// Results of another configuration.
    #[error("{} is a study of another configuration ({found}, expected {expected})", folder.display())]
    Different {
        /// The folder.
        folder: PathBuf,
        /// Beginning of the hash found.
        found: String,
        /// Beginning of the hash expected.
        expected: String,
    },
    /// Two shards have the same run.
    #[error("{}: {run} is already in an earlier shard", folder.display())]
    Twice {
        /// The later folder.
        folder: PathBuf,
        /// Name of the run.
        run: String,
    },
    /// Shards that are not a whole study.
    #[error("{missing} of {all} runs are missing, the first is {first}")]
    Missing {
        /// Number of missing runs.
        missing: usize,
        /// Number of runs of the study.
        all: usize,
        /// Name of the first missing run.
        first: String,
    },
    /// No shard.
    #[error("no shard to merge")]
    Nothing,
}

/// A study that a [`Store`] keeps in a folder: its configuration.
pub trait Study: Serialize + DeserializeOwned + Clone {
    /// Result of one run.
    type Run: Serialize + DeserializeOwned + std::fmt::Debug + Send;

    /// Hash of everything that the results depend on; every run carries it.
    fn hash(&self) -> String;

    /// Parameters that come with the program, one line each.
    fn choices(&self) -> Vec<String>;

    /// Unique names of all runs, in the order of the results.
    fn names(&self) -> Vec<String>;

    /// Name of a finished run.
    fn name(run: &Self::Run) -> String;

    /// The hash that a run carries.
    fn hash_of(run: &Self::Run) -> &str;

    /// Beginning of the hash, to print.
    fn short_hash(&self) -> String {
        short(&self.hash())
    }
}

fn short(hash: &str) -> String {
    hash.chars().take(12).collect()
}

/// Wall time of one run.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Time {
    run: String,
    seconds: f64,
}

/// The file `study.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StudyFile<S> {
    hash: String,
    config: S,
    choices: Vec<String>,
}

/// Finished runs by their index in the study.
type Finished<S> = BTreeMap<usize, <S as Study>::Run>;

/// Runs of a shard so far.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Finished runs.
    pub finished: usize,
    /// All runs of the shard.
    pub all: usize,
    /// Name of the last finished run; empty at the beginning.
    pub last: &'a str,
}

/// An open folder.
#[derive(Debug)]
pub struct Store<S: Study> {
    folder: PathBuf,
    /// Index of each run in the study by its name.
    indices: BTreeMap<String, usize>,
    finished: Finished<S>,
    journal: File,
    times: File,
    /// Locked while the folder is written; the system releases it when the process ends.
    _lock: File,
}

impl<S: Study> Store<S> {
    /// Opens a folder for a study, with the runs finished there before if `resume`.
    ///
    /// # Errors
    /// A folder that cannot be used, holds another study, or holds this one without `resume`.
    pub fn open(folder: &Path, config: &S, resume: bool) -> Result<Self, StoreError> {
        fs::create_dir_all(folder).map_err(io_at(folder))?;
        let lock = locked(folder)?;
        let indices = indices(config);
        let mut finished = Finished::<S>::new();
        if folder.join(CONFIG).exists() {
            if !resume {
                return Err(StoreError::Occupied(folder.to_owned()));
            }
            same(folder, config)?;
            for name in [RUNS, JOURNAL] {
                finished.extend(records(&folder.join(name), config, &indices)?);
            }
        } else {
            write_whole(&folder.join(CONFIG), &json(config)?)?;
        }
        let path = folder.join(JOURNAL);
        // Drops an unfinished last line.
        write_whole(&path, &lines(finished.values())?)?;
        let append = |path: &Path| {
            OpenOptions::new()
                .append(true)
                .create(true)
                .open(path)
                .map_err(io_at(path))
        };
        Ok(Self {
            _lock: lock,
            journal: append(&path)?,
            times: append(&folder.join(TIMES))?,
            folder: folder.to_owned(),
            indices,
            finished,
        })
    }

    /// Makes the unfinished runs of a shard, `(1, 1)` for all, and returns their number. `make`
    /// takes their indices in the study.
    ///
    /// # Errors
    /// A journal that cannot be written; no further run starts then.
    pub fn fill(
        &mut self,
        (part, parts): (usize, usize),
        make: impl FnOnce(&[usize], Done<'_, S::Run>),
        progress: &(dyn Fn(Progress<'_>) + Sync),
    ) -> Result<usize, StoreError> {
        let shard = (0..self.indices.len()).filter(|index| index % parts == part - 1);
        let (finished, open): (Vec<usize>, Vec<usize>) =
            shard.partition(|index| self.finished.contains_key(index));
        let all = finished.len() + open.len();
        let report = |finished, last: &str| {
            progress(Progress {
                finished,
                all,
                last,
            });
        };
        report(finished.len(), "");
        let state = Mutex::new((self, finished.len(), Ok(())));
        make(&open, &|run, seconds| {
            let name = S::name(&run);
            let Ok(mut state) = state.lock() else {
                return false;
            };
            let (store, finished, result) = &mut *state;
            if result.is_ok() {
                *result = store.add(run, seconds);
                *finished += 1;
                report(*finished, &name);
            }
            result.is_ok()
        });
        let result = state.into_inner().map_or(Ok(()), |(.., result)| result);
        result.map(|()| open.len())
    }

    fn add(&mut self, record: S::Run, seconds: f64) -> Result<(), StoreError> {
        let run = S::name(&record);
        let index = self.indices.get(&run).copied();
        let line = lines(std::iter::once(&record))?;
        self.journal
            .write_all(line.as_bytes())
            .and_then(|()| self.journal.sync_data())
            .map_err(io_at(&self.folder.join(JOURNAL)))?;
        let time = lines(std::iter::once(&Time { run, seconds }))?;
        self.times
            .write_all(time.as_bytes())
            .map_err(io_at(&self.folder.join(TIMES)))?;
        self.finished.extend(index.map(|index| (index, record)));
        Ok(())
    }

    /// Writes `runs.jsonl` and removes the journal; returns the runs in order.
    ///
    /// # Errors
    /// Files that cannot be written.
    pub fn finish(self) -> Result<Vec<S::Run>, StoreError> {
        write_whole(&self.folder.join(RUNS), &lines(self.finished.values())?)?;
        let path = self.folder.join(JOURNAL);
        fs::remove_file(&path).map_err(io_at(&path))?;
        Ok(self.finished.into_values().collect())
    }

    /// Whether all runs of the study are finished, including those of other shards.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.finished.len() == self.indices.len()
    }
}

/// Merges shards into one study: `study.json`, `runs.jsonl` and `times.jsonl` in `out`. The
/// first two are byte for byte those of a study without shards.
///
/// # Errors
/// Shards of different configurations, a run in two shards, missing runs, unusable files.
pub fn merge<S: Study>(shards: &[PathBuf], out: &Path) -> Result<(S, Vec<S::Run>), StoreError> {
    let first = shards.first().ok_or(StoreError::Nothing)?;
    let config = read_study::<S>(first)?.config;
    let indices = indices(&config);
    let mut finished = Finished::<S>::new();
    let mut times = String::new();
    for shard in shards {
        same(shard, &config)?;
        for (index, record) in records(&shard.join(RUNS), &config, &indices)? {
            let run = S::name(&record);
            if finished.insert(index, record).is_some() {
                let folder = shard.clone();
                return Err(StoreError::Twice { folder, run });
            }
        }
        times.push_str(&read(&shard.join(TIMES))?);
    }
    let mut missing = indices
        .iter()
        .filter(|(_, index)| !finished.contains_key(index));
    if let Some((name, _)) = missing.next() {
        return Err(StoreError::Missing {
            missing: 1 + missing.count(),
            all: indices.len(),
            first: name.clone(),
        });
    }
    if out.join(CONFIG).exists() {
        return Err(StoreError::Occupied(out.to_owned()));
    }
    fs::create_dir_all(out).map_err(io_at(out))?;
    write_whole(&out.join(RUNS), &lines(finished.values())?)?;
    write_whole(&out.join(TIMES), &times)?;
    write_whole(&out.join(CONFIG), &json(&config)?)?;
    Ok((config, finished.into_values().collect()))
}

/// Whether the first shard is a study of the kind `S`.
#[must_use]
pub fn read_kind<S: Study>(shards: &[PathBuf]) -> bool {
    shards
        .first()
        .is_some_and(|first| read_study::<S>(first).is_ok())
}

/// Writes a file so that it appears whole or not at all.
///
/// # Errors
/// A file that cannot be written.
pub fn write_whole(path: &Path, text: &str) -> Result<(), StoreError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    let building = path.with_file_name(name);
    let write = || {
        let mut file = File::create(&building)?;
        file.write_all(text.as_bytes())?;
        file.sync_data()?;
        fs::rename(&building, path)
    };
    write().map_err(io_at(path))
}

/// Locks the folder for this process.
fn locked(folder: &Path) -> Result<File, StoreError> {
    let path = folder.join(LOCK);
    let file = File::create(&path).map_err(io_at(&path))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(StoreError::Busy(folder.to_owned())),
        Err(TryLockError::Error(source)) => Err(io_at(&path)(source)),
    }
}

pub(super) fn io_at(path: &Path) -> impl FnOnce(io::Error) -> StoreError + '_ {
    move |source| StoreError::Io {
        path: path.to_owned(),
        source,
    }
}

/// Indices of all runs of a study by their names.
fn indices(config: &impl Study) -> BTreeMap<String, usize> {
    config.names().into_iter().zip(0..).collect()
}

fn read(path: &Path) -> Result<String, StoreError> {
    fs::read_to_string(path).map_err(io_at(path))
}

fn read_study<S: Study>(folder: &Path) -> Result<StudyFile<S>, StoreError> {
    let path = folder.join(CONFIG);
    let study = serde_json::from_str(&read(&path)?).map_err(|error| {
        let (line, reason) = (error.line(), error.to_string());
        StoreError::Content { path, line, reason }
    })?;
    Ok(study)
}

/// Checks that a folder has this study.
fn same<S: Study>(folder: &Path, config: &S) -> Result<(), StoreError> {
    let (found, expected) = (read_study::<S>(folder)?.hash, config.hash());
    if found == expected {
        return Ok(());
    }
    Err(StoreError::Different {
        folder: folder.to_owned(),
        found: short(&found),
        expected: short(&expected),
    })
}

/// The records of a file, without an unfinished last line; none without the file.
fn records<S: Study>(
    path: &Path,
    config: &S,
    indices: &BTreeMap<String, usize>,
) -> Result<Vec<(usize, S::Run)>, StoreError> {
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(io_at(path)(error)),
    };
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    let hash = config.hash();
    let mut found = Vec::new();
    for (line, text) in (1..).zip(whole.lines()) {
        let bad = |reason: String| StoreError::Content {
            path: path.to_owned(),
            line,
            reason,
        };
        let record: S::Run =
            serde_json::from_str(text).map_err(|error| bad(format!("not a record: {error}")))?;
        if S::hash_of(&record) != hash {
            return Err(bad("a record of another configuration".to_owned()));
        }
        let index = indices
            .get(&S::name(&record))
            .ok_or_else(|| bad("a run that the study does not have".to_owned()))?;
        found.push((*index, record));
    }
    Ok(found)
}

fn lines<'a, T: Serialize + 'a>(all: impl Iterator<Item = &'a T>) -> Result<String, StoreError> {
    let mut text = String::new();
    for one in all {
        text.push_str(&one_line(one)?);
        text.push('\n');
    }
    Ok(text)
}

fn one_line(value: &impl Serialize) -> Result<String, StoreError> {
    serde_json::to_string(value).map_err(|error| StoreError::Content {
        path: PathBuf::new(),
        line: 0,
        reason: error.to_string(),
    })
}

fn json(config: &impl Study) -> Result<String, StoreError> {
    let study = StudyFile {
        hash: config.hash(),
        choices: config.choices(),
        config: config.clone(),
    };
    Ok(one_line(&study)? + "\n")
}
