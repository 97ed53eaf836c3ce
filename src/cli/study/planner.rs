//! `sortie study planner`.

use std::ops::RangeInclusive;

use super::{complete, write_planner_table};
use crate::cli::args;
use crate::cli::print::console::{out, out_json, out_text};
use crate::cli::print::failure::Failure;
use crate::study::{
    BestKnown, MissionText, PlannerRun, PlannerStudy, planner_json, planner_md, run_planner,
};

/// Seeds of the generated missions that no planner was tuned on.
const UNSEEN: RangeInclusive<u64> = 101..=120;

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
    let (summary, whole) = complete(&study, &arguments.folder, |open, done| {
        let open: Vec<_> = open.iter().map(|index| jobs[*index]).collect();
        run_planner(&study, &arenas, &open, done);
    })?;
    if let Some(runs) = whole {
        print_results(arguments, &study, &runs)?;
    }
    if arguments.json {
        return Ok(());
    }
    out(&summary)
}

/// Writes the table into the folder and prints it. Prints the missions whose cost is below the
/// best known, and updates the best known if requested.
fn print_results(
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
    write_planner_table(&arguments.folder.out, study, runs, &best)?;
    if arguments.json {
        let mut document = planner_json(study, runs, &best);
        document["below_best_known"] = serde_json::json!(lowered);
        return out_json(&document);
    }
    out_text(&planner_md(study, runs, &best))?;
    let state = if arguments.update {
        "updated"
    } else {
        "--update saves it"
    };
    let (below, new): (Vec<String>, Vec<String>) = lowered
        .into_iter()
        .partition(|mission| known.0.contains_key(mission));
    let path = path.display();
    if !below.is_empty() {
        let below = below.join(", ");
        out(&format!(
            "below the best known of {path}: {below} ({state})"
        ))?;
    }
    if !new.is_empty() {
        let new = new.join(", ");
        out(&format!(
            "not in {path}, compared with the best of these runs: {new} ({state})"
        ))?;
    }
    Ok(())
}

/// The requested missions; by default the paper's, the shipped and the unseen generated ones.
fn missions(arguments: &args::Planner) -> Result<Vec<MissionText>, Failure> {
    let is_default = arguments.specs.is_empty()
        && arguments.generated.is_none()
        && arguments.families.is_empty();
    let (mut all, generated) = if is_default {
        let mut all = MissionText::paper()?;
        all.extend(MissionText::shipped(&arguments.missions)?);
        (all, Some(UNSEEN))
    } else {
        let specs = MissionText::read(&arguments.specs)?;
        (specs, arguments.generated.clone())
    };
    for seed in generated.into_iter().flatten() {
        all.push(MissionText::generated(seed)?);
    }
    for (family, seeds) in &arguments.families {
        for seed in seeds.clone() {
            all.push(MissionText::of_family(*family, seed)?);
        }
    }
    Ok(all)
}
