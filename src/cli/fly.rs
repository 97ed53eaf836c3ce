//! `sortie fly`: launch the fleet, monitor it, judge what it flew.

#[cfg(unix)]
mod attach;
#[cfg(not(unix))]
mod no_session;
mod resume;
mod screen;
mod show;
#[cfg(unix)]
mod socket;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::args;
use super::folder::{self, claim, missions, runs};
use super::links;
use super::print::console::{Paint, note, note_lines, out, out_json_text, warn_of_parked};
use super::print::failure::Failure;
use super::print::flight::report;
use super::print::printer::Printer;
use super::print::table;
use crate::flight::{
    self, Driver, Fleet, FlightError, FlightHandoff, FlightPlan, Journal, Judged, Line, Options,
    Outcome,
};
use crate::link::Links;
use crate::spec::{Link, SpecFile};
use crate::world;

#[cfg(unix)]
pub(super) use attach::attach;
#[cfg(not(unix))]
use no_session::Socket;
#[cfg(not(unix))]
pub(super) use no_session::attach;
use resume::take_over;
pub(super) use resume::watch;
use screen::Screen;
#[cfg(unix)]
use socket::Socket;

/// Between two positions of a vehicle, seconds of its own time.
const POSITION_S: f64 = 0.2;

pub(super) fn run(arguments: &args::Fly) -> Result<(), Failure> {
    let plan = read(&arguments.spec, arguments.dir.as_deref())?;
    if arguments.resume {
        let lock = runs::lock(&runs::folder(&plan.folder), "fly")?;
        return take_over(&plan, &arguments.link, arguments.json, lock);
    }
    let folder = runs::folder(&plan.folder);
    let _lock = runs::lock_for_flight(&plan.folder)?;
    let given = links::given(&plan.file, &arguments.link)?;
    let missions = plan.missions.iter();
    let mut links: Vec<Link> = missions
        .map(|(index, _)| links::link_of(&plan.file, *index, &given).clone())
        .collect();
    let seed = arguments.seed.unwrap_or(plan.spec().planner.seed);
    let simulated = plan.simulate(&mut links, (arguments.noise, seed), arguments.speedup)?;
    let vehicles = plan.missions.iter().map(|(index, _)| plan.vehicle(*index));
    let systems: Vec<(u8, &Link)> = vehicles.clone().map(|v| v.sysid).zip(&links).collect();
    let flight = format!("{:x}-{:x}", flight::unix_ms(), std::process::id());
    let _claims = claim::claim(&flight, &systems, &folder)?;
    let open = Links::open(&systems)
        .map_err(|(link, error)| Failure::new(Failure::TRANSFER, format!("{link}: {error}")))?;
    let addresses = links.iter().map(ToString::to_string);
    let addresses = vehicles.clone().map(|v| v.id.clone()).zip(addresses);
    let mut handoff = FlightHandoff::new(folder.clone(), addresses.collect(), arguments.speedup);
    let record = runs::named(&folder, "flight", "jsonl");
    handoff.notice.flight = flight;
    handoff.notice.record = file_name(&record);
    handoff.notice.is_simulated = simulated.len() == plan.missions.len();
    let header = Line::Head {
        sortie: env!("CARGO_PKG_VERSION").to_owned(),
        spec_sha256: folder::sha256(&plan.file.text),
        speedup: arguments.speedup,
        vehicles: vehicles.map(|vehicle| vehicle.id.clone()).collect(),
    };
    let journal = Journal::begin(record, &header)?;
    let mut screen = Screen::begin(arguments.json, !simulated.is_empty(), &folder)?;
    let launch = launch(&plan.file, simulated.len() == plan.missions.len())?;
    let mut driver = Driver::new(&open, &handoff, journal).launching(launch);
    let references = plan.references();
    let is_uploaded = |index| arguments.upload || simulated.contains_key(&index);
    let options = Options {
        speedup: arguments.speedup,
        set_params: arguments.set_params,
        force: arguments.force,
        on_alarm: plan.spec().answers(),
        position_s: POSITION_S,
        launch: driver.launch(),
    };
    let assignments = plan.assignments(&references, &open, is_uploaded);
    let fleet = Fleet::new(assignments, options, open.us(), driver.now());
    let mut fleet = fleet.watched(plan.spec(), &plan.world);
    driver.record_plans(&plan, &references)?;
    handoff.announce(None, BTreeMap::new())?;
    driver.fly(&mut fleet, &mut screen);
    handoff.withdraw(fleet.outcome() == Some(&Outcome::Flown));
    let output = Output::of(screen, arguments.json, !simulated.is_empty());
    end(driver, &fleet, &plan, output)
}

fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// Where the outcome of a flight goes.
struct Output {
    session: Option<Socket>,
    printer: Printer,
    /// Whether stdout belongs to a document.
    json: bool,
    has_simulated: bool,
}

impl Output {
    fn of(screen: Screen, json: bool, has_simulated: bool) -> Self {
        let (session, printer) = screen.into_parts();
        Self {
            session,
            printer,
            json,
            has_simulated,
        }
    }

    /// Other terminals get the outcome before the own one, which may take nothing.
    fn finish_session(&mut self, ended: &Result<(), Failure>) {
        let Some(session) = self.session.take() else {
            return;
        };
        match ended {
            Ok(()) => session.finish(0, "the flight kept its limits and ended as planned"),
            Err(failure) => session.finish(failure.code.number(), &failure.message),
        }
    }
}

/// The plan in its folder, of the spec that was named, verified again.
pub(super) fn read(spec: &Path, dir: Option<&Path>) -> Result<FlightPlan, Failure> {
    let named = SpecFile::read_known(spec).map_err(world::with_ground)?;
    let folder = match dir {
        Some(dir) => dir.to_owned(),
        None => Path::new("out").join(&named.spec.name),
    };
    if !folder.is_dir() {
        let message = format!(
            "{}: no plan there; make it first: sortie plan {}",
            folder.display(),
            spec.display()
        );
        return Err(Failure::new(Failure::INPUT, message));
    }
    let plan = read_folder(folder)?;
    let is_same = plan.file.text == named.text
        && plan.file.table == named.table
        && plan.file.attached == named.attached;
    if !is_same {
        let message = format!(
            "{} was planned from another spec than {}; nothing was started",
            plan.folder.display(),
            spec.display()
        );
        return Err(Failure::new(Failure::VERDICT, message));
    }
    Ok(plan)
}

/// The plan in a folder, verified again.
pub(super) fn read_folder(folder: PathBuf) -> Result<FlightPlan, Failure> {
    let (file, files, folder) = missions::from_folder(&[folder], false)?;
    flight::refuse_shared_sysids(&file.spec)?;
    let world = world::load(&file)?;
    let missions = missions::read(&file, &files)?;
    let plan = FlightPlan::verify(file, folder, world, missions);
    if let Err(FlightError::Rejected(review)) = &plan {
        note_lines(&table::failures(review, Paint::for_stdout()));
    }
    let plan = plan?;
    warn_of_parked(&plan.review);
    Ok(plan)
}

/// When a plan may be launched whose zones have times: at `t0` of its spec, and no later than
/// departures may be shifted, milliseconds since 1970. Simulated vehicles begin at once, as if it were then.
fn launch(file: &SpecFile, is_simulated: bool) -> Result<Option<(u64, u64)>, Failure> {
    let mut zones = file.spec.no_fly.iter();
    let timed = zones.find(|zone| zone.active_s.is_some());
    let Some((zone, t0_ms)) = timed.zip(file.t0_unix_ms).filter(|_| !is_simulated) else {
        return Ok(None);
    };
    let (unix_ms, slack_ms) = (
        flight::unix_ms(),
        1000.0 * file.spec.separation.time_slack_s,
    );
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked with the spec: not negative, and small"
    )]
    let until_ms = t0_ms + slack_ms as u64;
    if unix_ms > until_ms {
        let ago_s = (unix_ms - t0_ms) / 1000;
        let message = format!(
            "t0 was {ago_s} s ago, and zone {} is closed {zone} only: the plan does not hold any more; plan with another t0, or without, so that zones are always active; nothing was started",
            zone.id
        );
        return Err(Failure::new(Failure::INPUT, message));
    }
    Ok(Some((t0_ms, until_ms)))
}

/// Prints the verdict on what was flown. Its documents are written, and other terminals have it, first: the screen may
/// take nothing.
fn end(
    mut driver: Driver<'_>,
    fleet: &Fleet<'_>,
    plan: &FlightPlan,
    mut output: Output,
) -> Result<(), Failure> {
    if let Some(Outcome::NotStarted(why)) = fleet.outcome() {
        let ended = Err(not_started(why, !driver.unwritten().is_empty()));
        output.finish_session(&ended);
        drop(output);
        for (vehicle, problem) in why {
            let colon = if vehicle.is_empty() { "" } else { ": " };
            note(&format!("{vehicle}{colon}{problem}"));
        }
        return ended;
    }
    let recorded = driver.record_ends(fleet);
    let judged = recorded.and_then(|()| driver.judge(plan));
    let ended = verdict(&judged, &driver);
    output.finish_session(&ended);
    let shown = output.printer.finish();
    let unknown = fleet.unheard();
    if !unknown.is_empty() {
        note(&format!(
            "not heard, so that nothing is known of their landing: {}; `sortie watch` takes them over again",
            unknown.join(", ")
        ));
    }
    let in_the_air = fleet.in_the_air();
    if !in_the_air.is_empty() && !output.has_simulated {
        note(&format!(
            "still in the air, and not monitored any more: {}",
            in_the_air.join(", ")
        ));
    }
    // The operator sees the verdict whether or not its documents could be written.
    if let Ok(judged) = &judged {
        if output.json {
            out_json_text(&judged.json)?;
        } else {
            report(&judged.report)?;
            let document = driver.record_path().with_extension("json");
            out(&document.display().to_string())?;
        }
    }
    ended?;
    shown
}

/// The outcome of a flight that was begun.
fn verdict(judged: &Result<Judged, FlightError>, driver: &Driver<'_>) -> Result<(), Failure> {
    let unwritten = |message: String| Err(Failure::new(Failure::OUTPUT, message));
    let judged = match judged {
        Ok(judged) => judged,
        Err(error) => return unwritten(error.to_string()),
    };
    if let Err(error) = &judged.written {
        return unwritten(error.to_string());
    }
    if let Some(message) = driver.unwritten().first() {
        return unwritten(message.clone());
    }
    if judged.report.passes() {
        return Ok(());
    }
    let message = "the flight did not keep its limits, or did not end as planned";
    Err(Failure::new(Failure::TRANSFER, message))
}

fn not_started(why: &[(String, String)], is_unwritten: bool) -> Failure {
    let mut problems = why.iter().map(|(_, problem)| problem);
    let hint = if problems.any(|problem| problem.starts_with("parameter")) {
        " (--set-params sets parameters, --force flies all the same)"
    } else {
        ""
    };
    let code = if is_unwritten {
        Failure::OUTPUT
    } else {
        Failure::TRANSFER
    };
    Failure::new(code, format!("none was started{hint}"))
}
