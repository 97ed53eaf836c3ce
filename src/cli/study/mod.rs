//! `sortie study`: the experiments, whole or in shards.

mod fleet;
mod planner;

use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};

use super::args;
use super::print::console::{out, out_json, out_text};
use super::print::failure::Failure;
use crate::study::{
    BestKnown, Config, ConfigError, Job, MapText, PlannerRun, PlannerStudy, Progress, Results,
    Store, StoreError, Study, merge, planner_md, read_kind, run, scenario, speed, write_results,
    write_whole,
};

pub(super) fn run_study(arguments: &args::Study) -> Result<(), Failure> {
    match arguments {
        args::Study::Paper(arguments) => run_paper(arguments),
        args::Study::Speed(arguments) => print_speed(arguments),
        args::Study::Fleet(arguments) => fleet::run(arguments),
        args::Study::Scenario(arguments) => write_scenario(arguments),
        args::Study::Planner(arguments) => planner::run(arguments),
        args::Study::Merge(arguments) => merge_shards(arguments),
    }
}

fn merge_shards(arguments: &args::Merge) -> Result<(), Failure> {
    let folder = &arguments.out;
    let (runs, hash) = if read_kind::<PlannerStudy>(&arguments.shards) {
        let (study, runs) = merge::<PlannerStudy>(&arguments.shards, folder)?;
        let best = BestKnown::read(&arguments.best_known)?;
        write_planner_table(folder, &study, &runs, &best)?;
        (runs.len(), study.short_hash())
    } else {
        let (config, records) = merge::<Config>(&arguments.shards, folder)?;
        let results = Results::new(&config, &records)?;
        write_results(folder, &results, &config.settings()?)?;
        (records.len(), config.short_hash())
    };
    out(&format!(
        "{runs} runs of study {hash} in {}",
        folder.display()
    ))
}

/// The table of a study of the planner as a file of its folder.
fn write_planner_table(
    folder: &Path,
    study: &PlannerStudy,
    runs: &[PlannerRun],
    best: &BestKnown,
) -> Result<(), StoreError> {
    write_whole(&folder.join("RESULTS.md"), &planner_md(study, runs, best))
}

fn print_speed(arguments: &args::Speed) -> Result<(), Failure> {
    let of = speed(arguments.seconds)?;
    if arguments.json {
        let document = serde_json::to_value(&of).unwrap_or_default();
        return out_json(&document);
    }
    out_text(&of.table())
}

fn write_scenario(arguments: &args::Scenario) -> Result<(), Failure> {
    let text = match (arguments.family, arguments.difficulty) {
        (Some(family), _) => family.problem(arguments.seed),
        (None, difficulty) => scenario(arguments.seed, difficulty.unwrap_or(1)),
    };
    let Some(path) = &arguments.output else {
        return out_text(&text);
    };
    std::fs::write(path, text).map_err(|error| {
        let message = format!("{}: cannot be written: {error}", path.display());
        Failure::new(Failure::OUTPUT, message)
    })
}

fn run_paper(arguments: &args::Paper) -> Result<(), Failure> {
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
        maps: MapText::read(&arguments.maps)?,
    };
    let settings = config.settings()?;
    let jobs = Job::all(&config);
    let (summary, whole) = complete(&config, &arguments.folder, |open, done| {
        let open: Vec<Job> = open.iter().map(|index| jobs[*index]).collect();
        run(&config, &settings, &open, done);
    })?;
    if let Some(records) = whole {
        let results = Results::new(&config, &records)?;
        write_results(&arguments.folder.out, &results, &settings)?;
    }
    out(&summary)
}

/// A summary and, once the study is whole, all its runs.
type Completed<S> = (String, Option<Vec<<S as Study>::Run>>);

/// Makes the unfinished runs of a shard.
fn complete<S: Study>(
    study: &S,
    folder: &args::StudyFolder,
    make: impl FnOnce(&[usize], &(dyn Fn(S::Run, f64) -> bool + Sync)),
) -> Result<Completed<S>, Failure> {
    let mut store = Store::open(&folder.out, study, folder.resume)?;
    let bar = progress_bar();
    let count = |number: usize| u64::try_from(number).unwrap_or(u64::MAX);
    let show = |progress: Progress<'_>| {
        bar.set_length(count(progress.all));
        bar.set_position(count(progress.finished));
        bar.set_message(progress.last.to_owned());
    };
    let made = store.fill(folder.shard.unwrap_or((1, 1)), make, &show);
    bar.finish_and_clear();
    let (made, is_whole) = (made?, store.is_whole());
    let runs = store.finish()?;
    let summary = format!(
        "{made} runs made, {} of {} of study {} in {}",
        runs.len(),
        study.names().len(),
        study.short_hash(),
        folder.out.display()
    );
    Ok((summary, is_whole.then_some(runs)))
}

/// A bar on stderr, hidden unless stderr is a terminal.
fn progress_bar() -> ProgressBar {
    let bar = ProgressBar::new(0);
    if let Ok(style) =
        ProgressStyle::with_template("{wide_bar} {pos}/{len} runs, {elapsed}, {eta} left: {msg}")
    {
        bar.set_style(style);
    }
    bar
}

impl From<ConfigError> for Failure {
    fn from(error: ConfigError) -> Self {
        let code = match error {
            ConfigError::Number { .. } => Self::USAGE,
            ConfigError::Map(_) | ConfigError::SameName(_) | ConfigError::Unreadable { .. } => {
                Self::INPUT
            }
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
