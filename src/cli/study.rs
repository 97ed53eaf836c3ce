//! `sortie study`: the paper's experiment, whole or in shards.

use std::path::PathBuf;
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressStyle};

use super::args;
use super::console::out;
use super::failure::Failure;
use super::study_fleet;
use crate::report::json_text;
use crate::spec::SpecError;
use crate::study::{
    Config, ConfigError, Job, MapText, Results, Store, StoreError, merge, run, scenario,
    shipped_maps, speed, write_results,
};

pub(super) fn run_study(arguments: &args::Study) -> Result<(), Failure> {
    match arguments {
        args::Study::Paper(arguments) => paper(arguments),
        args::Study::Speed(arguments) => measured(arguments),
        args::Study::Fleet(arguments) => study_fleet::run(arguments),
        args::Study::Scenario(arguments) => made(arguments),
        args::Study::Merge(arguments) => {
            let (config, records) = merge(&arguments.shards, &arguments.out)?;
            write_results(
                &arguments.out,
                &Results::new(&config, &records)?,
                &config.settings()?,
            )?;
            out(&format!(
                "{} runs of {} in {}",
                records.len(),
                short(&config),
                arguments.out.display()
            ))?;
            Ok(())
        }
    }
}

fn measured(arguments: &args::Speed) -> Result<(), Failure> {
    let of = speed(arguments.seconds)?;
    if arguments.json {
        let document = serde_json::to_value(&of).unwrap_or_default();
        return out(json_text(&document).trim_end());
    }
    out(&format!(
        "{}, {}, costs a second:\n\
         one thread, local candidates {:.0}, global {:.0}; plain reference {:.0}\n\
         {} threads {:.0}; with a cutoff {:.0}; among two earlier vehicles {:.0}\n\
         by the paper's objective: local {:.0}, global {:.0}, among two earlier vehicles {:.0}; \
         plain reference {:.0}",
        of.cpu,
        of.dispatch,
        of.fast_one_thread,
        of.fast_global_one_thread,
        of.reference_one_thread,
        of.threads,
        of.fast_all_threads,
        of.fast_cutoff_one_thread,
        of.fast_traffic_one_thread,
        of.paper.fast_one_thread,
        of.paper.fast_global_one_thread,
        of.paper.fast_traffic_one_thread,
        of.paper.reference_one_thread,
    ))
}

fn made(arguments: &args::Scenario) -> Result<(), Failure> {
    let text = scenario(arguments.seed, arguments.difficulty);
    let Some(path) = &arguments.output else {
        return out(text.trim_end());
    };
    std::fs::write(path, text).map_err(|error| {
        let message = format!("{}: cannot be written: {error}", path.display());
        Failure::new(Failure::OUTPUT, message)
    })
}

fn paper(arguments: &args::Paper) -> Result<(), Failure> {
    let config = Config {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        runs: arguments.runs,
        population: arguments.population,
        iterations: arguments.iterations,
        seed: arguments.seed,
        ablations: arguments.ablations,
        readings: arguments.readings,
        printed_objective: arguments.printed_objective,
        control_points: arguments.control_points,
        maps: maps(&arguments.maps)?,
    };
    let settings = config.settings()?;
    let (part, parts) = arguments.shard.unwrap_or((1, 1));
    let mut store = Store::open(&arguments.out, &config, arguments.resume)?;
    let mine: Vec<Job> = Job::all(&config)
        .into_iter()
        .enumerate()
        .filter(|(index, _)| index % parts == part - 1)
        .map(|(_, job)| job)
        .collect();
    let open: Vec<Job> = mine.iter().copied().filter(|job| !store.has(job)).collect();
    let bar = progress(mine.len(), mine.len() - open.len());
    let failed = {
        let state = Mutex::new((&mut store, None));
        run(&config, &settings, &open, &|record, seconds| {
            bar.set_message(format!("{} on {}", record.algorithm, record.scenario));
            bar.inc(1);
            let Ok(mut state) = state.lock() else {
                return false;
            };
            if let Err(error) = state.0.keep(record, seconds) {
                state.1 = Some(error);
            }
            state.1.is_none()
        });
        state.into_inner().ok().and_then(|state| state.1)
    };
    bar.finish_and_clear();
    if let Some(error) = failed {
        return Err(error.into());
    }
    let count = open.len();
    let is_whole = store.is_whole();
    let records = store.finish()?;
    if is_whole {
        write_results(&arguments.out, &Results::new(&config, &records)?, &settings)?;
    }
    out(&format!(
        "{count} runs made, {} of {} of {} in {}",
        records.len(),
        Job::all(&config).len(),
        short(&config),
        arguments.out.display()
    ))?;
    Ok(())
}

/// The beginning of a study's hash, enough for people.
fn short(config: &Config) -> String {
    format!(
        "study {}",
        config.hash().chars().take(12).collect::<String>()
    )
}

/// The maps that were named, or those that come with the program.
fn maps(named: &[PathBuf]) -> Result<Vec<MapText>, Failure> {
    if named.is_empty() {
        return Ok(shipped_maps()
            .into_iter()
            .map(|(file, text)| MapText {
                file: file.to_owned(),
                text: text.to_owned(),
            })
            .collect());
    }
    named
        .iter()
        .map(|path| {
            let text = std::fs::read_to_string(path).map_err(|error| {
                let message = format!("{}: cannot be read: {error}", path.display());
                Failure::new(Failure::INPUT, message)
            })?;
            let file = path.file_name().unwrap_or(path.as_os_str());
            let file = file.to_string_lossy().into_owned();
            Ok(MapText { file, text })
        })
        .collect()
}

/// A bar on stderr; none when that is no terminal.
fn progress(all: usize, done: usize) -> ProgressBar {
    let count = |number: usize| u64::try_from(number).unwrap_or(u64::MAX);
    let bar = ProgressBar::new(count(all)).with_position(count(done));
    if let Ok(style) =
        ProgressStyle::with_template("{wide_bar} {pos}/{len} runs, {elapsed}, {eta} left: {msg}")
    {
        bar.set_style(style);
    }
    bar
}

/// `I/N` with I from 1 to N.
pub(super) fn parse_shard(text: &str) -> Result<(usize, usize), String> {
    let parts = text
        .split_once('/')
        .and_then(|(part, parts)| Some((part.parse().ok()?, parts.parse().ok()?)));
    parts
        .filter(|&(part, parts)| (1..=parts).contains(&part))
        .ok_or_else(|| "not I/N with I from 1 to N, such as 1/4".to_owned())
}

impl From<ConfigError> for Failure {
    fn from(error: ConfigError) -> Self {
        let code = match error {
            ConfigError::Number { .. } => Self::USAGE,
            ConfigError::Map(SpecError { .. }) | ConfigError::SameName(_) => Self::INPUT,
        };
        Self::new(code, error.to_string())
    }
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        let code = match error {
            StoreError::Io { .. } | StoreError::Busy(_) => Self::OUTPUT,
            StoreError::Occupied(_) | StoreError::Nothing => Self::USAGE,
            StoreError::Content { .. }
            | StoreError::Different { .. }
            | StoreError::Twice { .. }
            | StoreError::Missing { .. } => Self::INPUT,
        };
        Self::new(code, error.to_string())
    }
}
