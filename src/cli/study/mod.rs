//! `sortie study`: the experiments, whole or in shards.

pub(super) mod fleet;
mod planner;

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressStyle};

use super::args;
use super::print::console::{out, out_json, out_text};
use super::print::failure::Failure;
use crate::spec::SpecError;
use crate::study::{
    BestKnown, Config, ConfigError, Job, MapText, PlannerStudy, Results, Store, StoreError, Study,
    merge, read_kind, run, scenario, shipped_maps, speed, write_results,
};

pub(super) fn run_study(arguments: &args::Study) -> Result<(), Failure> {
    match arguments {
        args::Study::Paper(arguments) => paper(arguments),
        args::Study::Speed(arguments) => measured(arguments),
        args::Study::Fleet(arguments) => fleet::run(arguments),
        args::Study::Scenario(arguments) => made(arguments),
        args::Study::Planner(arguments) => planner::run(arguments),
        args::Study::Merge(arguments) => merged(arguments),
    }
}

fn merged(arguments: &args::Merge) -> Result<(), Failure> {
    let told = |runs: usize, study: String| {
        out(&format!(
            "{runs} runs of {study} in {}",
            arguments.out.display()
        ))
    };
    if read_kind::<PlannerStudy>(&arguments.shards) {
        let (study, runs) = merge::<PlannerStudy>(&arguments.shards, &arguments.out)?;
        let best = BestKnown::read(&arguments.best_known)?;
        planner::write_table(&arguments.out, &study, &runs, &best)?;
        return told(runs.len(), short(&study));
    }
    let (config, records) = merge::<Config>(&arguments.shards, &arguments.out)?;
    write_results(
        &arguments.out,
        &Results::new(&config, &records)?,
        &config.settings()?,
    )?;
    told(records.len(), short(&config))
}

fn measured(arguments: &args::Speed) -> Result<(), Failure> {
    let of = speed(arguments.seconds)?;
    if arguments.json {
        let document = serde_json::to_value(&of).unwrap_or_default();
        return out_json(&document);
    }
    out_text(&format!(
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
        return out_text(&text);
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
        published_objective: arguments.published_objective,
        control_points: arguments.control_points,
        maps: maps(&arguments.maps)?,
    };
    let settings = config.settings()?;
    let (part, parts) = arguments.shard.unwrap_or((1, 1));
    let mut store = Store::open(&arguments.out, &config, arguments.resume)?;
    let jobs = Job::all(&config);
    let mine = (0..jobs.len()).filter(|place| place % parts == part - 1);
    let count = make(&mut store, mine, |open, done| {
        let open: Vec<Job> = open.iter().map(|place| jobs[*place]).collect();
        run(&config, &settings, &open, done);
    })?;
    let is_whole = store.is_whole();
    let records = store.finish()?;
    if is_whole {
        write_results(&arguments.out, &Results::new(&config, &records)?, &settings)?;
    }
    out(&format!(
        "{count} runs made, {} of {} of {} in {}",
        records.len(),
        jobs.len(),
        short(&config),
        arguments.out.display()
    ))?;
    Ok(())
}

/// Takes what a run left and the seconds it took; false when no more should be made.
type Done<'a, R> = &'a (dyn Fn(R, f64) -> bool + Sync);

/// Makes those of some runs, given by their places in the study, that are not finished,
/// and keeps them; returns how many these were.
fn make<S: Study>(
    store: &mut Store<S>,
    mine: impl Iterator<Item = usize>,
    run: impl FnOnce(&[usize], Done<'_, S::Run>),
) -> Result<usize, Failure>
where
    Store<S>: Send,
{
    let mine: Vec<usize> = mine.collect();
    let open: Vec<usize> = mine
        .iter()
        .copied()
        .filter(|place| !store.has(*place))
        .collect();
    let bar = progress(mine.len(), mine.len() - open.len());
    let failed = {
        let state = Mutex::new((store, None));
        run(&open, &|record, seconds| {
            bar.set_message(S::name(&record));
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
    match failed {
        Some(error) => Err(error.into()),
        None => Ok(open.len()),
    }
}

/// The beginning of a study's hash, enough for people.
fn short(config: &impl Study) -> String {
    format!(
        "study {}",
        config.hash().chars().take(12).collect::<String>()
    )
}

/// What a file holds.
fn read_text(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| {
        let message = format!("{}: cannot be read: {error}", path.display());
        Failure::new(Failure::INPUT, message)
    })
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
            let text = read_text(path)?;
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

/// `FIRST-LAST`, or one number.
pub(super) fn parse_range(text: &str) -> Result<std::ops::RangeInclusive<u64>, String> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    let ends = first.parse().ok().zip(last.parse().ok());
    ends.filter(|(first, last)| first <= last && last - first < 10_000)
        .map(|(first, last)| first..=last)
        .ok_or_else(|| "not FIRST-LAST, such as 101-120".to_owned())
}

/// A number of runs.
pub(super) fn parse_count(text: &str) -> Result<usize, String> {
    number(text, 1..=10_000)
}

/// Evaluations, as many as a spec allows.
pub(super) fn parse_budget(text: &str) -> Result<usize, String> {
    number(text, 100..=100_000_000)
}

fn number(text: &str, range: std::ops::RangeInclusive<usize>) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|number| range.contains(number))
        .ok_or_else(|| format!("not a number from {} to {}", range.start(), range.end()))
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
