//! `sortie study planner`: how near the default planner comes to the best paths known.

use std::path::{Path, PathBuf};

use super::{make, short};
use crate::cli::args;
use crate::cli::print::console::{out, out_json, out_text};
use crate::cli::print::failure::Failure;
use crate::study::{
    BestKnown, MissionText, PlannerRun, PlannerStudy, Store, planner_json, planner_md, run_planner,
    write_whole,
};

/// Seeds of the generated missions that no planner was tuned on.
const UNSEEN: std::ops::RangeInclusive<u64> = 101..=120;

/// Shipped missions of more vehicles are left to `study fleet`.
const LARGE: usize = 10;

pub(super) fn run(arguments: &args::Planner) -> Result<(), Failure> {
    let study = PlannerStudy {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        seeds: arguments.seeds,
        seed: arguments.seed,
        evaluations: arguments.evaluations.clone(),
        ablations: arguments.ablations,
        missions: missions(arguments)?,
    };
    let arenas = study.arenas()?;
    let jobs = study.jobs();
    let mut store = Store::open(&arguments.out, &study, arguments.resume)?;
    let (part, parts) = arguments.shard.unwrap_or((1, 1));
    let mine = (0..jobs.len()).filter(|place| place % parts == part - 1);
    let count = make(&mut store, mine, |open, done| {
        let open: Vec<_> = open.iter().map(|place| jobs[*place]).collect();
        run_planner(&study, &arenas, &open, done);
    })?;
    let is_whole = store.is_whole();
    let runs = store.finish()?;
    if is_whole {
        tell(arguments, &study, &runs)?;
    }
    if !arguments.json {
        out(&format!(
            "{count} runs made, {} of {} of {} in {}",
            runs.len(),
            jobs.len(),
            short(&study),
            arguments.out.display()
        ))?;
    }
    Ok(())
}

/// Writes the table into the folder and prints it; tells what costs less than the best
/// known, and keeps it if that was asked for.
fn tell(
    arguments: &args::Planner,
    study: &PlannerStudy,
    runs: &[PlannerRun],
) -> Result<(), Failure> {
    let path = &arguments.best_known;
    let mut best = BestKnown::read(path)?;
    let known = best.clone();
    let lowered = best.lower(runs.iter());
    if arguments.update && !lowered.is_empty() {
        best.write(path)?;
    }
    write_table(&arguments.out, study, runs, &best)?;
    if arguments.json {
        let mut document = planner_json(study, runs, &best);
        document["below_best_known"] = serde_json::json!(lowered);
        return out_json(&document);
    }
    out_text(&planner_md(study, runs, &best))?;
    let kept = if arguments.update {
        "kept"
    } else {
        "--update keeps it"
    };
    let (below, new): (Vec<String>, Vec<String>) = lowered
        .into_iter()
        .partition(|mission| known.0.contains_key(mission));
    let path = path.display();
    if !below.is_empty() {
        let below = below.join(", ");
        out(&format!("below the best known of {path}: {below} ({kept})"))?;
    }
    if !new.is_empty() {
        let new = new.join(", ");
        out(&format!(
            "not in {path}, held against the best of these runs: {new} ({kept})"
        ))?;
    }
    Ok(())
}

/// The table as a file of the study's folder.
pub(super) fn write_table(
    folder: &Path,
    study: &PlannerStudy,
    runs: &[PlannerRun],
    best: &BestKnown,
) -> Result<(), Failure> {
    write_whole(&folder.join("RESULTS.md"), &planner_md(study, runs, best))?;
    Ok(())
}

/// The missions that were named and generated; or else the paper's, all in the folder of
/// shipped missions, and the generated ones that nothing was tuned on.
fn missions(arguments: &args::Planner) -> Result<Vec<MissionText>, Failure> {
    let generated = |range: std::ops::RangeInclusive<u64>| -> Result<Vec<MissionText>, Failure> {
        range
            .map(|seed| Ok(MissionText::generated(seed)?))
            .collect()
    };
    if !arguments.specs.is_empty() || arguments.generated.is_some() {
        let mut all = read(&arguments.specs)?;
        if let Some(range) = arguments.generated.clone() {
            all.extend(generated(range)?);
        }
        return Ok(all);
    }
    let mut all: Vec<MissionText> = MissionText::paper()?;
    let folder = &arguments.missions;
    let unreadable = |error: std::io::Error| {
        let message = format!("{}: cannot be read: {error}", folder.display());
        Failure::new(Failure::INPUT, message)
    };
    let mut shipped: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.extension().is_some_and(|end| end == "yaml") {
            shipped.push(path);
        }
    }
    shipped.sort();
    let fits = |mission: &MissionText| mission.vehicles <= LARGE;
    all.extend(read(&shipped)?.into_iter().filter(fits));
    all.extend(generated(UNSEEN)?);
    Ok(all)
}

fn read(paths: &[PathBuf]) -> Result<Vec<MissionText>, Failure> {
    paths
        .iter()
        .map(|path| Ok(MissionText::parse(path, super::read_text(path)?)?))
        .collect()
}
