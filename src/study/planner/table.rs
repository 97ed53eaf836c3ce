//! Results of a study of the planner as Markdown tables and as JSON.

use std::fmt::Write;

use serde_json::{Value, json};

use super::{BestKnown, PlannerRun, PlannerStudy, variants};
use crate::numeric::as_f64;
use crate::study::document::Table;
use crate::study::stats::Summary;

/// Runs of one variant with one budget on one mission.
struct Cell {
    runs: usize,
    /// Number of runs that keep every limit.
    clean: usize,
    best_known: f64,
    /// Costs above the best known, percent.
    above: Summary,
    /// Share of the runs within 1 %.
    near: f64,
}

fn cell(
    study: &PlannerStudy,
    runs: &[PlannerRun],
    best: &BestKnown,
    (variant, evaluations, mission): (&str, usize, usize),
) -> Option<Cell> {
    let mission = &study.missions[mission].name;
    let mine: Vec<&PlannerRun> = runs
        .iter()
        .filter(|run| {
            run.variant == variant && run.evaluations == evaluations && run.mission == *mission
        })
        .collect();
    let best_known = best.0.get(mission)?.total;
    let above: Vec<f64> = mine
        .iter()
        .map(|run| match run.clean {
            true => 100.0 * (run.total / best_known - 1.0),
            false => f64::INFINITY,
        })
        .collect();
    let near = above.iter().filter(|above| **above <= 1.0).count();
    Some(Cell {
        runs: mine.len(),
        clean: mine.iter().filter(|run| run.clean).count(),
        best_known,
        above: Summary::of(&above)?,
        near: as_f64(near) / as_f64(mine.len()),
    })
}

/// Markdown tables: the planner by mission and budget; and each variant over all missions.
#[must_use]
pub fn planner_md(study: &PlannerStudy, runs: &[PlannerRun], best: &BestKnown) -> String {
    let mut head = "mission | vehicles | best known".to_owned();
    for evaluations in &study.evaluations {
        let _ = write!(
            head,
            " | {evaluations}: median | worst | within 1 % | clean"
        );
    }
    let mut table = Table::new("", head);
    for (index, mission) in study.missions.iter().enumerate() {
        let known = best.0.get(&mission.name);
        let known = known.map_or("-".to_owned(), |known| format!("{:.4}", known.total));
        let mut row = format!("{} | {} | {known}", mission.name, mission.vehicles);
        for &evaluations in &study.evaluations {
            let _ = match cell(study, runs, best, ("planner", evaluations, index)) {
                Some(cell) => write!(
                    row,
                    " | {} | {} | {:.0} % | {}/{}",
                    percent(cell.above.median),
                    percent(cell.above.worst),
                    100.0 * cell.near,
                    cell.clean,
                    cell.runs
                ),
                None => write!(row, " | - | - | - | -"),
            };
        }
        table.row(row);
    }
    let ablations = study
        .ablations
        .then(|| ablations(study, runs, best).markdown());
    format!(
        "{}\nMedian and worst of {} seeds, percent above the best known; a run that violates a \
         limit fails, and is worse than all that keep them.\n{}",
        table.markdown(),
        study.seeds,
        ablations.map_or_else(String::new, |table| format!("\n{table}"))
    )
}

/// Percent, or `fails` for a run that violates a limit.
fn percent(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.2}")
    } else {
        "fails".to_owned()
    }
}

/// A row for each variant: mean of the medians, highest median, mean and highest of the worst
/// runs, over all missions.
fn ablations(study: &PlannerStudy, runs: &[PlannerRun], best: &BestKnown) -> Table {
    let mut head = "planner".to_owned();
    for evaluations in &study.evaluations {
        let _ = write!(
            head,
            " | {evaluations}: mean median | greatest median | mean worst | worst | clean"
        );
    }
    let mut table = Table::new("", head);
    for (name, _) in variants(true) {
        let mut row = name.to_owned();
        for &evaluations in &study.evaluations {
            let cells: Vec<Cell> = (0..study.missions.len())
                .filter_map(|mission| cell(study, runs, best, (name, evaluations, mission)))
                .collect();
            let summary =
                |of: fn(&Cell) -> f64| Summary::of(&cells.iter().map(of).collect::<Vec<_>>());
            let total = |of: fn(&Cell) -> usize| as_f64(cells.iter().map(of).sum());
            let (medians, worst) = (summary(|c| c.above.median), summary(|c| c.above.worst));
            if let Some((medians, worst)) = medians.zip(worst) {
                let _ = write!(
                    row,
                    " | {} | {} | {} | {} | {:.1} %",
                    percent(medians.average),
                    percent(medians.worst),
                    percent(worst.average),
                    percent(worst.worst),
                    100.0 * total(|c| c.clean) / total(|c| c.runs)
                );
            }
        }
        table.row(row);
    }
    table
}

/// The same numbers as one document.
#[must_use]
pub fn planner_json(study: &PlannerStudy, runs: &[PlannerRun], best: &BestKnown) -> Value {
    let mut rows = Vec::new();
    for (variant, _) in variants(study.ablations) {
        for &evaluations in &study.evaluations {
            for (index, mission) in study.missions.iter().enumerate() {
                let Some(cell) = cell(study, runs, best, (variant, evaluations, index)) else {
                    continue;
                };
                rows.push(json!({
                    "planner": variant,
                    "evaluations": evaluations,
                    "mission": mission.name,
                    "best_known": cell.best_known,
                    "runs": cell.runs,
                    "clean": cell.clean,
                    "median_percent": cell.above.median,
                    "worst_percent": cell.above.worst,
                    "best_percent": cell.above.best,
                    "within_1_percent": cell.near,
                }));
            }
        }
    }
    json!({"seeds": study.seeds, "rows": rows})
}
