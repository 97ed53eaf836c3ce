//! `sortie plan`: the main job.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use super::args;
use super::check;
use super::folder;
use super::folder::runs;
use super::print::console::{Paint, note, out, out_json, out_lines, warn_of_parked};
use super::print::failure::Failure;
use super::print::progress::Progress;
use super::print::table;
use super::print::table::Rows;
use super::transfer::fleet_transfer;
use super::transfer::fleet_transfer::FleetTransfer;
use super::transfer::upload;
use super::usage;
use crate::dispatch::{self, Dispatched, Improved, Improving, Stage};
use crate::link::TransferReport;
use crate::report::{
    TimingDocument, WrittenPlan, departures_that_pass, infeasibilities, worst_first,
};
use crate::spec::{Arrival, MissionSpec, OnLinkLoss, SpecFile};
use crate::tasks::AssignedTask;
use crate::verify::{Margin, Review, Topic};
use crate::world::{self, World};

/// Vehicles that the table lists: of a larger fleet, those with the tightest margins.
const MAX_LISTED: usize = 40;

/// Tasks of a vehicle that the table names.
const MAX_TASKS_LISTED: usize = 6;

/// Seconds spent in each stage: printed and written to `timing.json`, never to a result.
struct Stopwatch {
    started: Instant,
    stages: Vec<(&'static str, f64)>,
}

impl Stopwatch {
    #[expect(
        clippy::disallowed_methods,
        reason = "wall times are shown, they decide nothing"
    )]
    fn start() -> Self {
        Self {
            started: Instant::now(),
            stages: Vec::new(),
        }
    }

    fn split(&mut self, stage: &'static str) {
        let before: f64 = self.stages.iter().map(|(_, seconds)| seconds).sum();
        self.stages
            .push((stage, self.started.elapsed().as_secs_f64() - before));
    }

    /// Reading and planning, processor time and memory.
    fn document(&self, seed: u64) -> TimingDocument {
        let spent_s = |stage: &str| {
            let mut stages = self.stages.iter();
            let found = stages.find(|(name, _)| *name == stage);
            found.map_or(0.0, |(_, seconds)| *seconds)
        };
        TimingDocument {
            seed,
            read_s: spent_s("read_s"),
            plan_s: spent_s("plan_s"),
            cpu_s: usage::cpu_s(),
            memory_mib: usage::peak_memory_mib(),
        }
    }

    fn total_s(&self) -> f64 {
        self.stages.iter().map(|(_, seconds)| seconds).sum()
    }
}

pub(super) fn run(arguments: &args::Plan) -> Result<(), Failure> {
    let mut watch = Stopwatch::start();
    let file = read_spec(arguments)?;
    let default = || PathBuf::from("out").join(&file.spec.name);
    let target = arguments.out.clone().unwrap_or_else(default);
    if runs::is_in_flight(&target) {
        let message = format!("{} is being flown, and not replaced", target.display());
        return Err(Failure::new(Failure::OUTPUT, message));
    }
    runs::refuse_broken_off(&target)?;
    folder::check_output(&target)?;
    let world = world::load(&file)?;
    check::warn(&file, &world);
    watch.split("read_s");
    let seed = arguments.seed.unwrap_or(file.spec.planner.seed);
    let dispatched = match arguments.within {
        Some(within_s) => plan_within(&file, &world, seed, within_s)?,
        None => plan(&file, &world, seed),
    };
    watch.split("plan_s");
    folder::write(&target, &file, &world, &dispatched, &|| {
        watch.document(seed)
    })?;
    watch.split("write_s");

    let passes = dispatched.review.passes();
    let transfer = match arguments.upload && passes {
        true => Some(transfer_to_fleet(&file, &dispatched, &target)?),
        false => None,
    };
    if transfer.is_some() {
        watch.split("upload_s");
    }
    if arguments.json {
        let mut document = folder::plan_document(&file, &world, &dispatched);
        document.written = Some(WrittenPlan {
            out: target.display().to_string(),
            upload: transfer.as_ref().map(FleetTransfer::document),
        });
        out_json(&document)?;
    } else {
        print_result(&file, &world, &dispatched, transfer.as_ref(), &watch)?;
        out(&format!("files in {}", target.display()))?;
    }
    if !passes {
        let unsent = ["", "; nothing was sent"][usize::from(arguments.upload)];
        let message = format!("the fleet does not pass verification{unsent}");
        return Err(Failure::new(Failure::VERDICT, message));
    }
    match transfer {
        Some(transfer) => transfer.verdict(),
        None => Ok(()),
    }
}

/// Uploads the missions of a fleet and records how that ended.
fn transfer_to_fleet(
    file: &SpecFile,
    dispatched: &Dispatched,
    target: &Path,
) -> Result<FleetTransfer, Failure> {
    runs::make(&runs::folder(target))?;
    let missions = dispatched.missions.iter();
    let missions: Vec<_> = missions
        .map(|(vehicle, mission)| (*vehicle, mission))
        .collect();
    upload::warn_of_versions(file, &missions);
    let transfer = upload::upload_fleet(file, missions, &[], false, None)?;
    transfer.record(target)?;
    Ok(transfer)
}

/// The spec, with the evaluations of the command line.
fn read_spec(arguments: &args::Plan) -> Result<SpecFile, Failure> {
    let mut file = SpecFile::read_known(&arguments.spec).map_err(world::with_ground)?;
    if let Some(evaluations) = arguments.evaluations {
        file.spec.planner.evaluations = usize::try_from(evaluations).unwrap_or(usize::MAX);
    }
    Ok(file)
}

/// Plans with more and more evaluations until time is up, or Ctrl-C; the first plan is always made.
/// Prints the evaluations of the best.
fn plan_within(
    file: &SpecFile,
    world: &World,
    seed: u64,
    within_s: f64,
) -> Result<Dispatched, Failure> {
    let within = Duration::from_secs_f64(within_s);
    #[expect(
        clippy::disallowed_methods,
        reason = "the operator asks for a time; the printed evaluations give the same plan again"
    )]
    let started = Instant::now();
    let progress = Progress::start();
    let cancel = Arc::new(AtomicBool::new(false));
    let mut plans = Improving::new(&file.spec, world, seed, &cancel).without_end();
    let show = |plan: &Improved| {
        progress.say(&format!(
            "cost {:.3} with {} evaluations for each vehicle",
            plan.dispatched.plan.cost(),
            plan.evaluations
        ));
    };
    let mut best = plans.next();
    // There is a plan now: Ctrl-C takes it instead of ending without any.
    let (interrupt, ended) = mpsc::channel::<()>();
    ctrlc::set_handler(move || {
        // The receiver is gone if time is up already.
        let _ = interrupt.send(());
    })
    .map_err(|error| Failure::new(Failure::OUTPUT, format!("Ctrl-C: {error}")))?;
    let left = within.saturating_sub(started.elapsed());
    let at_end = Arc::clone(&cancel);
    thread::spawn(move || {
        let _ = ended.recv_timeout(left);
        at_end.store(true, Ordering::Relaxed);
    });
    note("there is a plan: Ctrl-C takes the best so far");
    best.iter().for_each(&show);
    for plan in plans {
        show(&plan);
        best = Some(plan);
    }
    drop(progress);
    let best = best.ok_or_else(|| Failure::new(Failure::OUTPUT, "no plan was made"))?;
    note(&format!(
        "{0} evaluations for each vehicle; `--evaluations {0}` gives the same plan",
        best.evaluations
    ));
    Ok(best.dispatched)
}

/// Plans with a progress line.
fn plan(file: &SpecFile, world: &World, seed: u64) -> Dispatched {
    let progress = Mutex::new(Progress::start());
    dispatch::dispatch(&file.spec, world, seed, &|stage| {
        let message = match stage {
            Stage::Planning(round, at) => {
                let again = if round > 1 {
                    format!(", round {round}")
                } else {
                    String::new()
                };
                let id = &file.spec.vehicles[at.vehicle].id;
                format!(
                    "planning {id} ({} of {}{again}): cost {:.3} after {} of {} evaluations",
                    at.vehicle + 1,
                    at.vehicles,
                    at.best,
                    at.evaluations,
                    at.budget
                )
            }
            Stage::Verifying(_) => "verifying the encoded missions".to_owned(),
        };
        if let Ok(progress) = progress.lock() {
            progress.say(&message);
        }
    })
}

/// Prints the verdict, the table of the fleet, failures and notes.
fn print_result(
    file: &SpecFile,
    world: &World,
    dispatched: &Dispatched,
    transfer: Option<&FleetTransfer>,
    watch: &Stopwatch,
) -> Result<(), Failure> {
    let (spec, review, paint) = (&file.spec, &dispatched.review, Paint::for_stdout());
    let verdict = if review.passes() {
        paint.good("pass")
    } else {
        paint.bad("FAIL")
    };
    out(&format!(
        "{}: {verdict}, seed {}, {} {} in {:.1} s",
        spec.name,
        dispatched.plan.seed,
        dispatched.rounds,
        if dispatched.rounds == 1 {
            "round"
        } else {
            "rounds"
        },
        watch.total_s()
    ))?;
    print_fleet(file, dispatched, transfer)?;
    let (planned_spec, planned_world) = dispatched.planned_spec(spec, world);
    if !review.passes() {
        for reason in infeasibilities(planned_spec, planned_world, &dispatched.plan) {
            out(&format!("{} {reason}", paint.bad("FAIL")))?;
        }
        out_lines(&table::failures(review, paint))?;
        if let Some(helps) = departures_that_pass(planned_spec, &dispatched.plan) {
            out(&format!("note: {helps}"))?;
        }
    }
    if let Some(transfer) = transfer {
        transfer.print_failures()?;
        transfer.warn();
    }
    warn_of_parked(review);
    for line in given_way(file, dispatched) {
        out(&paint.dim(&format!("note: {line}")))?;
    }
    for line in resting(planned_spec) {
        out(&paint.dim(&format!("note: {line}")))?;
    }
    for (note, ids) in notes(file, dispatched) {
        out(&paint.dim(&format!("note: {}: {note}", ids.join(", "))))?;
    }
    if spec.on_link_loss != OnLinkLoss::Continue {
        out(&paint
            .dim("note: on_link_loss applies when `sortie fly` flies the fleet; no mission file can hold it"))?;
    }
    Ok(())
}

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
fn print_fleet(
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

/// The vehicles that rest on their way where they have no space to turn, and how often.
fn resting(planned: &MissionSpec) -> Vec<String> {
    let vehicles = planned.vehicles.iter();
    vehicles
        .filter_map(|vehicle| {
            let stops = vehicle.stops.iter();
            let rests = stops.filter(|stop| stop.arrives == Arrival::Exact).count();
            let times = if rests == 1 { "time" } else { "times" };
            (rests > 0).then(|| {
                format!(
                    "{} rests for 1 s {rests} {times} on its way, to turn on the spot (`stops` of plan.json)",
                    vehicle.id
                )
            })
        })
        .collect()
}

/// The vehicles with another departure or speed than the spec has, and to which they give way.
fn given_way(file: &SpecFile, dispatched: &Dispatched) -> Vec<String> {
    let vehicles = &file.spec.vehicles;
    let planned = vehicles.iter().zip(&dispatched.plan.vehicles);
    planned
        .filter_map(|(vehicle, plan)| {
            let others = plan.gives_way_to(vehicle);
            let (first, rest) = others.split_first()?;
            let mut past = vehicles.get(*first)?.id.clone();
            if !rest.is_empty() {
                past += &format!(" and {} more", rest.len());
            }
            Some(format!(
                "{}: takes off at {} s and flies {} m/s (spec: {} s, {} m/s), to give way to {past}",
                vehicle.id, plan.depart_s, plan.speed_mps, vehicle.depart_s, vehicle.speed_mps
            ))
        })
        .collect()
}

/// The notes on missions, each once, with its vehicles.
fn notes<'a>(file: &'a SpecFile, dispatched: &'a Dispatched) -> Vec<(&'a str, Vec<&'a str>)> {
    let mut notes: Vec<(&str, Vec<&str>)> = Vec::new();
    for (vehicle, mission) in &dispatched.missions {
        let id = file.spec.vehicles[*vehicle].id.as_str();
        for note in &mission.notes {
            match notes.iter_mut().find(|(known, _)| known == note) {
                Some((_, ids)) => ids.push(id),
                None => notes.push((note, vec![id])),
            }
        }
    }
    notes
}

fn on_board(accepted: bool, report: Option<&TransferReport>) -> String {
    match report {
        Some(report) => fleet_transfer::state(report),
        None if accepted => "not sent".to_owned(),
        None => "rejected".to_owned(),
    }
}
