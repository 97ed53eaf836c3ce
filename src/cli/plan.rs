//! `sortie plan`: the main job.

mod notes;
mod rows;

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
use super::transfer::fleet_transfer::FleetTransfer;
use super::transfer::upload;
use super::usage;
use crate::dispatch::{self, Dispatched, Improved, Improving, Stage};
use crate::report::{TimingDocument, WrittenPlan, departures_that_pass, infeasibilities};
use crate::spec::{OnLinkLoss, SpecFile};
use crate::world::{self, World};

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
    rows::print_fleet(file, dispatched, transfer)?;
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
    for line in notes::all(file, planned_spec, dispatched) {
        out(&paint.dim(&format!("note: {line}")))?;
    }
    if spec.on_link_loss != OnLinkLoss::Continue {
        out(&paint
            .dim("note: on_link_loss applies when `sortie fly` flies the fleet; no mission file can hold it"))?;
    }
    Ok(())
}
