//! The table of a planned fleet.

use std::collections::BTreeMap;

use super::super::print::console::out;
use super::super::print::failure::Failure;
use super::super::print::table;
use super::super::print::table::Rows;
use super::super::transfer::fleet_transfer;
use super::super::transfer::fleet_transfer::FleetTransfer;
use crate::dispatch::Dispatched;
use crate::link::TransferReport;
use crate::report::worst_first;
use crate::spec::{MissionSpec, SpecFile};
use crate::tasks::AssignedTask;
use crate::verify::{Margin, Review, Topic};

/// Vehicles that the table lists: of a larger fleet, those with the tightest margins.
const MAX_LISTED: usize = 40;

/// Tasks of a vehicle that the table names.
const MAX_TASKS_LISTED: usize = 6;

/// Columns of limits that few specs have, with their topics.
fn more_columns(review: &Review) -> Vec<(&'static str, Topic)> {
    let margins = &review.margins;
    [
        ("height limit", Topic::Height),
        ("endurance", Topic::Endurance),
    ]
    .into_iter()
    .filter(|(_, topic)| (margins.iter()).any(|margin| margin.limit.topic() == *topic))
    .collect()
}

/// Prints a row for each vehicle: its path, mission, tightest margins and transfer.
pub(super) fn print_fleet(
    file: &SpecFile,
    dispatched: &Dispatched,
    transfer: Option<&FleetTransfer>,
) -> Result<(), Failure> {
    let (spec, review) = (&file.spec, &dispatched.review);
    let more = more_columns(review);
    let mut heads = vec![
        "vehicle",
        "autopilot",
        "cost",
        "length",
        "time",
        "items",
        "above ground",
        "threats and zones",
        "separation",
    ];
    heads.extend(more.iter().map(|(head, _)| head));
    if dispatched.tasks.is_some() {
        heads.push("tasks");
    }
    heads.push("on board");
    let mut rows = Rows::new(&heads);
    let shown = tightest_first(spec, review);
    for &index in &shown {
        let vehicle = &spec.vehicles[index];
        let id = vehicle.id.as_str();
        let plan = &dispatched.plan.vehicles[index];
        let items = dispatched
            .missions
            .iter()
            .find(|(of, _)| *of == index)
            .map(|(_, mission)| mission.items.len());
        let report = transfer
            .and_then(|transfer| transfer.reports.iter().find(|report| report.vehicle == id));
        let mut cells = vec![
            id.to_owned(),
            table::autopilot(vehicle.autopilot).to_owned(),
            format!("{:.3}", plan.terms.total()),
            format!("{:.1} km", plan.length_m() / 1000.0),
            table::clock(plan.duration_s()),
            items.map_or("-".to_owned(), |items| items.to_string()),
            table::tightest(review, id, &[Topic::Clearance]),
            table::tightest(review, id, &[Topic::Threat, Topic::Zone]),
            table::separation(review, id, spec.vehicles.len()),
        ];
        cells.extend((more.iter()).map(|(_, topic)| table::tightest(review, id, &[*topic])));
        cells.extend((dispatched.tasks.iter()).map(|tasks| tasks_of(&tasks.done[index])));
        cells.push(on_board(review.accepts(id), report));
        rows.add(cells);
    }
    rows.print()?;
    print_unlisted(spec.vehicles.len(), shown.len())?;
    print_fleet_cost(dispatched)?;
    table::print_no_buffers(spec)
}

/// Prints what a fleet costs together, and how near that is to the proven bound.
fn print_fleet_cost(dispatched: &Dispatched) -> Result<(), Failure> {
    let plan = &dispatched.plan;
    if plan.vehicles.len() < 2 {
        return Ok(());
    }
    let above = match plan.gap() {
        Some(gap) => format!("{:.1} % above the proven bound", 100.0 * gap.max(0.0)),
        None => "limits are violated; the proven bound is".to_owned(),
    };
    let (cost, bound) = (plan.cost(), plan.bound());
    out(&format!("the fleet: cost {cost:.3}, {above} {bound:.3}"))
}

/// Prints how many vehicles the table leaves out.
fn print_unlisted(vehicles: usize, shown: usize) -> Result<(), Failure> {
    if shown < vehicles {
        let left = vehicles - shown;
        out(&format!(
            "the {shown} vehicles with the tightest margins; {left} more keep every limit and are in review.html"
        ))?;
    }
    Ok(())
}

/// The tasks of a vehicle, in the order in which it begins them; of many the first.
fn tasks_of(done: &[AssignedTask]) -> String {
    let shown = done.iter().take(MAX_TASKS_LISTED);
    let name = |task: &AssignedTask| match task.lines.len() {
        0 => task.id.clone(),
        1 => format!("{} (1 line)", task.id),
        lines => format!("{} ({lines} lines)", task.id),
    };
    let mut ids: Vec<String> = shown.map(name).collect();
    if done.len() > MAX_TASKS_LISTED {
        ids.push("...".to_owned());
    }
    match done {
        [] => "-".to_owned(),
        _ => format!("{}: {}", done.len(), ids.join(", ")),
    }
}

/// Whether the table of the fleet has a column for a topic.
fn has_column(topic: Topic) -> bool {
    match topic {
        Topic::Clearance
        | Topic::Height
        | Topic::Threat
        | Topic::Zone
        | Topic::Endurance
        | Topic::Separation => true,
        Topic::Other => false,
    }
}

/// The vehicles of the table: all, in order of priority, or of a large fleet those that are
/// nearest to a limit of its columns, the worst first; vehicles that break a limit come first.
fn tightest_first(spec: &MissionSpec, review: &Review) -> Vec<usize> {
    let count = spec.vehicles.len();
    if count <= MAX_LISTED {
        return (0..count).collect();
    }
    let ids = spec.vehicles.iter().map(|vehicle| vehicle.id.as_str());
    let mut indices: BTreeMap<&str, usize> = ids.zip(0..).collect();
    let mut shown = Vec::new();
    let counts = |margin: &&Margin| !margin.ok || has_column(margin.limit.topic());
    for margin in worst_first(review).into_iter().filter(counts) {
        for id in std::iter::once(&margin.vehicle).chain(&margin.other) {
            if margin.ok && shown.len() >= MAX_LISTED {
                return shown;
            }
            shown.extend(indices.remove(id.as_str()));
        }
    }
    shown.extend(indices.into_values());
    shown
}

fn on_board(accepted: bool, report: Option<&TransferReport>) -> String {
    match report {
        Some(report) => fleet_transfer::state(report),
        None if accepted => "not sent".to_owned(),
        None => "rejected".to_owned(),
    }
}
