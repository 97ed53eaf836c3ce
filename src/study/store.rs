//! The folder of a study: what survives a kill, and how shards become one.
//!
//! `study.json` is the configuration. While runs are made, each finished one is
//! appended to `journal.jsonl` in one write; a line that a kill cut short was never
//! finished. When all are there, `runs.jsonl` has them in the order of the study, whole or
//! not at all, and the journal goes. `times.jsonl` has the seconds; `.lock` is locked
//! while a process writes.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

const CONFIG: &str = "study.json";
const JOURNAL: &str = "journal.jsonl";
const RUNS: &str = "runs.jsonl";
const TIMES: &str = "times.jsonl";
const LOCK: &str = ".lock";

/// What is wrong with a study's folder.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The file system refuses.
    #[error("cannot use {}: {source}", path.display())]
    Io {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file is not what it should be.
    #[error("{}:{line}: {what}", path.display())]
    Content {
        /// Which file.
        path: PathBuf,
        /// Which line, from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// Another process writes there.
    #[error("{} is being written by another process", .0.display())]
    Busy(PathBuf),
    /// There are results, and nothing says to go on with them.
    #[error("{} holds a study already (allowed: --resume, or another folder)", .0.display())]
    Occupied(PathBuf),
    /// Results of another configuration.
    #[error("{} is a study of another configuration ({theirs}, not {ours})", folder.display())]
    Different {
        /// Its folder.
        folder: PathBuf,
        /// Beginning of its hash.
        theirs: String,
        /// Beginning of the hash it should have.
        ours: String,
    },
    /// A run is in two shards.
    #[error("{}: {what} is in an earlier shard already", folder.display())]
    Twice {
        /// The later folder.
        folder: PathBuf,
        /// Which run.
        what: String,
    },
    /// Shards that do not make a whole study.
    #[error("{missing} of {all} runs are missing, the first is {first}")]
    Missing {
        /// How many.
        missing: usize,
        /// Of how many.
        all: usize,
        /// The first.
        first: String,
    },
    /// No shard.
    #[error("no shard to merge")]
    Nothing,
}

/// A study that a folder can keep: its configuration.
pub trait Study: Serialize + DeserializeOwned + Clone {
    /// What one run leaves.
    type Run: Serialize + DeserializeOwned + std::fmt::Debug;

    /// Hash of all that the results depend on; every run carries it.
    fn hash(&self) -> String;

    /// What the program brings of its own, a line each.
    fn choices(&self) -> Vec<String>;

    /// What tells each run from all others, in the order of the results.
    fn names(&self) -> Vec<String>;

    /// The same of a run that was made.
    fn name(run: &Self::Run) -> String;

    /// The hash that a run carries.
    fn hash_of(run: &Self::Run) -> &str;
}

/// Seconds of one run.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Time {
    run: String,
    seconds: f64,
}

/// The file `study.json`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Settled<S> {
    hash: String,
    config: S,
    choices: Vec<String>,
}

/// Finished runs, by their place in the study.
type Finished<S> = BTreeMap<usize, <S as Study>::Run>;

/// An open folder.
#[derive(Debug)]
pub struct Store<S: Study> {
    folder: PathBuf,
    places: BTreeMap<String, usize>,
    finished: Finished<S>,
    journal: File,
    times: File,
    /// Held while the folder is written; the system lets go of it when a process ends.
    _lock: File,
}

impl<S: Study> Store<S> {
    /// Opens a folder for a study, with what was finished there before if `resume`.
    ///
    /// # Errors
    /// A folder that cannot be used, holds another study, or holds this one without `resume`.
    pub fn open(folder: &Path, config: &S, resume: bool) -> Result<Self, StoreError> {
        fs::create_dir_all(folder).map_err(io_at(folder))?;
        let lock = locked(folder)?;
        let places = places(config);
        let mut finished = Finished::<S>::new();
        if folder.join(CONFIG).exists() {
            if !resume {
                return Err(StoreError::Occupied(folder.to_owned()));
            }
            same(folder, config)?;
            for name in [RUNS, JOURNAL] {
                finished.extend(records(&folder.join(name), config, &places)?);
            }
        } else {
            write_whole(&folder.join(CONFIG), &json(config)?)?;
        }
        let path = folder.join(JOURNAL);
        // Without the cut line, if there is one.
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
            places,
            finished,
        })
    }

    /// Whether the run at a place of the study is finished.
    #[must_use]
    pub fn has(&self, place: usize) -> bool {
        self.finished.contains_key(&place)
    }

    /// Keeps a finished run.
    ///
    /// # Errors
    /// A journal that cannot be written.
    pub fn keep(&mut self, record: S::Run, seconds: f64) -> Result<(), StoreError> {
        let path = self.folder.join(JOURNAL);
        let time = Time {
            run: S::name(&record),
            seconds,
        };
        let line = lines(std::iter::once(&record))?;
        self.journal
            .write_all(line.as_bytes())
            .and_then(|()| self.journal.sync_data())
            .map_err(io_at(&path))?;
        let time = lines(std::iter::once(&time))?;
        let path = self.folder.join(TIMES);
        self.times
            .write_all(time.as_bytes())
            .map_err(io_at(&path))?;
        if let Some(place) = self.places.get(&S::name(&record)) {
            self.finished.insert(*place, record);
        }
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

    /// Whether all runs of the study are finished, those of other shards too.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.finished.len() == self.places.len()
    }
}

/// Makes one study of shards: `study.json`, `runs.jsonl` and `times.jsonl` in `out`, the
/// first two byte for byte as one run without shards leaves them.
///
/// # Errors
/// Shards of different configurations, with a run twice or with runs missing; files.
pub fn merge<S: Study>(shards: &[PathBuf], out: &Path) -> Result<(S, Vec<S::Run>), StoreError> {
    let first = shards.first().ok_or(StoreError::Nothing)?;
    let config = read_study::<S>(first)?.config;
    let places = places(&config);
    let mut finished = Finished::<S>::new();
    let mut times = String::new();
    for shard in shards {
        same(shard, &config)?;
        for (place, record) in records(&shard.join(RUNS), &config, &places)? {
            let what = S::name(&record);
            if finished.insert(place, record).is_some() {
                let folder = shard.clone();
                return Err(StoreError::Twice { folder, what });
            }
        }
        times.push_str(&read(&shard.join(TIMES))?);
    }
    let mut missing = places
        .iter()
        .filter(|(_, place)| !finished.contains_key(place));
    if let Some((name, _)) = missing.next() {
        return Err(StoreError::Missing {
            missing: 1 + missing.count(),
            all: places.len(),
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

/// Takes the folder for this process alone.
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

/// The places of all runs of a study by their names.
fn places(config: &impl Study) -> BTreeMap<String, usize> {
    config.names().into_iter().zip(0..).collect()
}

fn read(path: &Path) -> Result<String, StoreError> {
    fs::read_to_string(path).map_err(io_at(path))
}

fn read_study<S: Study>(folder: &Path) -> Result<Settled<S>, StoreError> {
    let path = folder.join(CONFIG);
    let study = serde_json::from_str(&read(&path)?).map_err(|error| {
        let (line, what) = (error.line(), error.to_string());
        StoreError::Content { path, line, what }
    })?;
    Ok(study)
}

/// Whether a folder has this very study.
fn same<S: Study>(folder: &Path, config: &S) -> Result<(), StoreError> {
    let short = |hash: &str| hash.chars().take(12).collect();
    let (theirs, ours) = (read_study::<S>(folder)?.hash, config.hash());
    if theirs == ours {
        return Ok(());
    }
    Err(StoreError::Different {
        folder: folder.to_owned(),
        theirs: short(&theirs),
        ours: short(&ours),
    })
}

/// The records of a file, if it is there, without a last line that was cut.
fn records<S: Study>(
    path: &Path,
    config: &S,
    places: &BTreeMap<String, usize>,
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
        let bad = |what: String| StoreError::Content {
            path: path.to_owned(),
            line,
            what,
        };
        let record: S::Run =
            serde_json::from_str(text).map_err(|error| bad(format!("no record: {error}")))?;
        if S::hash_of(&record) != hash {
            return Err(bad("a record of another configuration".to_owned()));
        }
        let place = places
            .get(&S::name(&record))
            .ok_or_else(|| bad("a run that the study does not have".to_owned()))?;
        found.push((*place, record));
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
        what: error.to_string(),
    })
}

fn json(config: &impl Study) -> Result<String, StoreError> {
    let study = Settled {
        hash: config.hash(),
        choices: config.choices(),
        config: config.clone(),
    };
    Ok(one_line(&study)? + "\n")
}
