//! Configuration of the experiment: all that its results depend on, under one hash.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::contestants::{Contestant, Role, ablations, contestants, readings};
use super::record::Record;
use super::shipped_maps;
use crate::cost::PaperOptions;
use crate::spec::{Scenario, SpecError};
use crate::study::setting::Setting;
use crate::study::store::Study;

/// The configuration; with [`Config::choices`] it is the file `study.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Version of the program.
    pub version: String,
    /// Runs of each algorithm on each map.
    pub runs: usize,
    /// Population size M.
    pub population: usize,
    /// Iterations NC.
    pub iterations: usize,
    /// Seed of the first run; each later run has the next.
    pub seed: u64,
    /// Whether MSFOA also runs without its parts.
    pub ablations: bool,
    /// Whether other readings of what the paper leaves open also run.
    pub readings: bool,
    /// Whether the objective is searched as published, gaps and all. Paths are always judged
    /// by the objective whose gaps are closed.
    pub published_objective: bool,
    /// Free control points instead of the maps' own.
    pub control_points: Option<usize>,
    /// The maps.
    pub maps: Vec<MapText>,
}

/// A map as given.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapText {
    /// File name, for messages.
    pub file: String,
    /// The scenario, YAML.
    pub text: String,
}

/// An error of a configuration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConfigError {
    /// A map is no valid scenario.
    #[error(transparent)]
    Map(#[from] SpecError),
    /// A file or folder cannot be read.
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The cause.
        reason: String,
    },
    /// Two maps have one name.
    #[error("two maps are named `{0}`")]
    SameName(String),
    /// A number is out of range.
    #[error("{name} is {found} (allowed: {min} to {max})")]
    Number {
        /// Its name.
        name: &'static str,
        /// The value given.
        found: usize,
        /// The lowest allowed value.
        min: usize,
        /// The highest allowed value.
        max: usize,
    },
}

pub(in crate::study) fn unreadable(path: &Path) -> impl Fn(io::Error) -> ConfigError + '_ {
    |error| ConfigError::Unreadable {
        path: path.to_owned(),
        reason: error.to_string(),
    }
}

pub(in crate::study) fn read_text(path: &Path) -> Result<String, ConfigError> {
    fs::read_to_string(path).map_err(unreadable(path))
}

impl MapText {
    /// The maps of some files; the shipped maps without files.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(paths: &[PathBuf]) -> Result<Vec<Self>, ConfigError> {
        if paths.is_empty() {
            let map = |(file, text): (&str, &str)| Self {
                file: file.to_owned(),
                text: text.to_owned(),
            };
            return Ok(shipped_maps().map(map).into());
        }
        let map = |path: &PathBuf| {
            let file = path.file_name().unwrap_or(path.as_os_str());
            Ok(Self {
                file: file.to_string_lossy().into_owned(),
                text: read_text(path)?,
            })
        };
        paths.iter().map(map).collect()
    }
}

/// One run; jobs are in the order of the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Job {
    /// Index of the contestant.
    pub contestant: usize,
    /// Index of the map.
    pub map: usize,
    /// Number of the run, from 0.
    pub run: usize,
}

impl Job {
    /// All jobs of a study.
    #[must_use]
    pub fn all(config: &Config) -> Vec<Self> {
        let mut jobs = Vec::new();
        for (contestant, of) in config.contestants().iter().enumerate() {
            for map in 0..config.maps.len() {
                let runs = 0..of.runs(config.runs);
                jobs.extend(runs.map(|run| Self {
                    contestant,
                    map,
                    run,
                }));
            }
        }
        jobs
    }
}

impl Study for Config {
    type Run = Record;

    fn hash(&self) -> String {
        sha256(&(self, self.choices()))
    }

    /// The parameters of each contestant, and of the objective.
    fn choices(&self) -> Vec<String> {
        let contestants = self.contestants();
        let contestants = contestants.iter().map(|of| {
            let protocol = of.protocol.name();
            format!("{} (equal {protocol}): {:?}", of.name, of.method)
        });
        std::iter::once(format!("objective: {:?}", self.objective()))
            .chain(contestants)
            .collect()
    }

    fn names(&self) -> Vec<String> {
        let contestants = self.contestants();
        let maps: Vec<String> = self
            .scenarios()
            .unwrap_or_default()
            .into_iter()
            .map(|scenario| scenario.name)
            .collect();
        Job::all(self)
            .into_iter()
            .map(|job| {
                let contestant = &contestants[job.contestant];
                let map = maps.get(job.map).map_or("", String::as_str);
                name(&contestant.name, contestant.protocol.name(), map, job.run)
            })
            .collect()
    }

    fn name(run: &Record) -> String {
        name(&run.algorithm, &run.protocol, &run.scenario, run.run)
    }

    fn hash_of(run: &Record) -> &str {
        &run.config
    }
}

fn name(algorithm: &str, protocol: &str, scenario: &str, run: usize) -> String {
    format!("{algorithm} ({protocol}) on {scenario}, run {run}")
}

/// SHA-256 of a value as JSON, hexadecimal.
pub(in crate::study) fn sha256(of: &impl Serialize) -> String {
    let json = serde_json::to_vec(of).unwrap_or_default();
    Sha256::digest(&json)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

impl Config {
    /// The objective that is searched.
    #[must_use]
    pub fn objective(&self) -> PaperOptions {
        if self.published_objective {
            PaperOptions::literal()
        } else {
            PaperOptions::default()
        }
    }

    /// The contestants, in the order of the tables.
    #[must_use]
    pub fn contestants(&self) -> Vec<Contestant> {
        let mut all = contestants(self.population);
        if self.ablations {
            all.extend(ablations(self.population));
        }
        if self.readings {
            all.extend(readings(self.population));
        }
        // The planner searches only the objective whose gaps are closed.
        all.retain(|of| of.role != Role::Own || !self.published_objective);
        all
    }

    /// The maps, ready to be searched.
    ///
    /// # Errors
    /// As [`Self::scenarios`].
    pub fn settings(&self) -> Result<Vec<Setting>, ConfigError> {
        let scenarios = self.scenarios()?.into_iter();
        Ok(scenarios
            .map(|scenario| Setting::new(scenario, self.objective()))
            .collect())
    }

    /// The maps, checked.
    ///
    /// # Errors
    /// An invalid map, two maps of one name, a number out of range.
    pub fn scenarios(&self) -> Result<Vec<Scenario>, ConfigError> {
        let points = self.control_points.unwrap_or(2);
        for (name, found, min, max) in [
            ("runs", self.runs, 1, 10_000),
            ("population", self.population, 10, 10_000),
            ("iterations", self.iterations, 5, 100_000),
            ("control points", points, 2, 30),
        ] {
            if !(min..=max).contains(&found) {
                return Err(ConfigError::Number {
                    name,
                    found,
                    min,
                    max,
                });
            }
        }
        let mut scenarios: Vec<Scenario> = Vec::new();
        for map in &self.maps {
            let mut scenario = Scenario::parse(Path::new(&map.file), &map.text)?;
            if let Some(points) = self.control_points {
                scenario.planner.control_points = points;
            }
            if scenarios.iter().any(|other| other.name == scenario.name) {
                return Err(ConfigError::SameName(scenario.name));
            }
            scenarios.push(scenario);
        }
        Ok(scenarios)
    }
}
