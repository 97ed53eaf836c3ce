//! `sortie replan`: new paths from where the vehicles are, around a threat that was not there.
//!
//! A vehicle goes on by its present mission while it is planned for and sent to. So its new
//! path begins on its present way, as far ahead as it gets until it has the new mission,
//! and the new mission holds the places before that too: wherever on that way the vehicle
//! takes it, it goes on.

mod course;
mod divert;
mod look;
mod popup;
mod present;
mod renewed;
mod situation;
mod told;

use super::args;
use super::fly::{self, Call, Said, Sorties};
use super::folder::runs;
use super::print::console::{Paint, note, out_lines};
use super::print::failure::Failure;
use super::print::table;
use super::transfer::delivery;
use super::transfer::upload;
use crate::flight::{Line, PopUp};
use crate::link::Links;
use crate::spec::{Airframe, Link, MissionSpec, SpecFile, Threat};

use course::{Course, Since};
use look::{Clock, Look, Sight};
use renewed::Replanned;
use situation::{Bound, GivenUp, Situation};

/// How long planning may take at first, on the wall's clock, seconds.
const PLANNING_S: f64 = 0.8;
/// Times that the reading of all lists took, that sending them may take; and what comes on top.
const SENDING: f64 = 2.0;
const SENDING_S: f64 = 0.2;
/// What a vehicle may be early or late on its way, seconds of its own time.
const SPARE_S: f64 = 3.0;
/// How often it is planned again because it took too long.
const TRIES: usize = 3;

/// What was decided, and from what.
struct Decision {
    courses: Vec<Course>,
    replanned: Replanned,
    /// Who flies through a threat all the same.
    bound: Vec<Bound>,
    /// Whether every limit is kept besides those that the bound break.
    is_sound: bool,
    sight: Sight,
    planned_s: f64,
}

pub(super) fn run(arguments: &args::Replan) -> Result<(), Failure> {
    are_led(&SpecFile::read(&arguments.spec)?.spec)?;
    let mut sorties = fly::read(&arguments.spec, arguments.dir.as_deref())?;
    let _held = runs::hold(&runs::folder(&sorties.folder), "replan").map_err(|busy| {
        let message = format!(
            "{}, and this threat is not recorded: tell it again",
            busy.message
        );
        Failure::new(busy.code, message)
    })?;
    let call = Call::heard(&sorties)?;
    let is_watched = runs::is_flown(&sorties.folder);
    if !is_watched {
        note(
            "no `sortie fly` watches this fleet: its flight is not recorded, nor held against the threat",
        );
    }
    let popups = call.as_ref().map(|(call, _)| call.popups());
    let mut popups = popups.unwrap_or_default();
    let threat = popup::threat(&sorties.file.spec, &popups, &arguments.threat)?;
    popups.push(threat.clone());
    popup::add(&mut sorties, &popups);
    let said = call
        .as_ref()
        .map(|(_, said)| said.clone())
        .unwrap_or_default();
    let told_ms = delivery::milliseconds_since_1970();
    let popup = PopUp {
        from_s: t_s(&said, told_ms),
        threat: threat.clone(),
    };
    // Whatever comes of it: the flight is held against the threat from now on.
    lay_down(call.as_ref(), &[Line::of_popup(&popup)])?;
    let since = Since {
        unix_ms: told_ms,
        pace: pace(&said),
    };
    let known = (popups.as_slice(), &said, since);
    let led = lead(&sorties, known, call.as_ref(), arguments);
    if let Err(failure) = &led {
        told::record_failure(&sorties, &threat, &failure.message)?;
    }
    let (decision, told) = led?;
    told::record(&sorties, &threat, &decision, &told)?;
    told::tell(&sorties, &decision, &told)?;
    answer(&decision, &sorties, &told)
}

/// Leads whoever meets a threat around it: what was decided, and how each took its new mission.
fn lead(
    sorties: &Sorties,
    (popups, said, since): (&[Threat], &Said, Since),
    call: Option<&(Call, Said)>,
    arguments: &args::Replan,
) -> Result<(Decision, told::Told), Failure> {
    let links = links(sorties, arguments, said)?;
    let fleet = &sorties.file.spec.vehicles;
    let systems: Vec<(u8, &Link)> = links
        .iter()
        .map(|(index, link)| (fleet[*index].sysid, link))
        .collect();
    let open = Links::open(&systems).map_err(|(link, error)| {
        // Only one can listen at a port.
        let is_watched = runs::is_flown(&sorties.folder);
        let hint = if is_watched && error.kind() == std::io::ErrorKind::AddrInUse {
            " (`sortie fly` listens there: reach the vehicle over another of its links, with --link)"
        } else {
            ""
        };
        failed(format!("{link}: {error}{hint}; nothing was sent"))
    })?;
    let clock = Clock::start();
    let mut look = Look::read(&open, &clock, sorties)?;
    let known = (popups, said, since);
    let decision = decide(sorties, known, &clock, &mut look, arguments.seed)?;
    if !decision.replanned.review.passes() {
        let clock = said.t0_unix_ms.map_or("now", |_| "T0");
        let review = &decision.replanned.review;
        out_lines(&table::failures_since(review, Paint::for_stdout(), clock))?;
    }
    if !decision.is_sound {
        let message = "no new paths that pass verification; nothing was sent";
        return Err(Failure::new(Failure::VERDICT, message));
    }
    let mut lines = Vec::new();
    let since_s = t_s(said, decision.sight.unix_ms);
    for renewed in &decision.replanned.renewed {
        let id = &fleet[renewed.vehicle].id;
        lines.push(Line::of_plan(id, since_s, &renewed.plan));
    }
    lay_down(call, &lines)?;
    let told = divert::divert(&open, &clock, sorties, &decision);
    Ok((decision, told))
}

/// How it went: who cannot avoid a threat is named whatever else went well.
fn answer(decision: &Decision, sorties: &Sorties, told: &told::Told) -> Result<(), Failure> {
    let is_told = told.values().all(Result::is_ok);
    let cannot = situation::sentence(&decision.bound, &sorties.file.spec.vehicles);
    let unjudged = "not all of who keeps its course can be judged (see above)";
    let is_unjudged = !decision.replanned.review.passes();
    let wrong = cannot.or_else(|| is_unjudged.then(|| unjudged.to_owned()));
    match (wrong, is_told) {
        (None, true) => Ok(()),
        (None, false) => Err(failed("not every vehicle is on its new path")),
        (Some(who), true) => {
            let others = if told.is_empty() {
                "nothing was sent"
            } else {
                "the others that meet a threat are on new paths"
            };
            Err(Failure::new(Failure::VERDICT, format!("{who}; {others}")))
        }
        (Some(who), false) => Err(failed(format!(
            "{who}; and not every other vehicle is on its new path"
        ))),
    }
}

/// Plans, and again with more time when it took more than was allowed for.
fn decide(
    sorties: &Sorties,
    (popups, said, since): (&[Threat], &Said, Since),
    clock: &Clock,
    look: &mut Look<'_>,
    seed: Option<u64>,
) -> Result<Decision, Failure> {
    let pace = pace(said);
    let mut planning_s = PLANNING_S;
    let mut given_up = GivenUp::new();
    for _ in 0..TRIES {
        let sight = look.sight()?;
        let sending_s = SENDING * sight.reading_s + SENDING_S;
        let lead_s = (planning_s + sending_s) * pace + SPARE_S;
        let courses = courses(sorties, &sight, &since)?;
        let now_s = t_s(said, sight.unix_ms);
        let mut situation = Situation {
            sorties,
            popups,
            others: Vec::new(),
            concerned: Vec::new(),
            bound: Vec::new(),
            now_s,
            seed,
        };
        situation.sort(&courses, lead_s, &given_up);
        let replanned = present::replan(&mut situation, &mut given_up);
        let planned_s = clock.seconds() - sight.at_s;
        let is_sound = situation.is_sound(&replanned.review);
        if planned_s <= planning_s || !is_sound || situation.concerned.is_empty() {
            return Ok(Decision {
                courses,
                replanned,
                bound: situation.bound,
                is_sound,
                sight,
                planned_s,
            });
        }
        planning_s = 1.5 * planned_s;
    }
    Err(Failure::new(
        Failure::VERDICT,
        format!(
            "planning takes too long here ({:.1} s); nothing was sent",
            planning_s / 1.5
        ),
    ))
}

/// How much faster than the clock the time of the vehicles goes.
fn pace(said: &Said) -> f64 {
    if said.speedup > 0.0 {
        said.speedup
    } else {
        1.0
    }
}

/// Seconds after T0, if that is known.
fn t_s(said: &Said, unix_ms: u64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "milliseconds of one flight")]
    let since = |t0_ms: u64| unix_ms.saturating_sub(t0_ms) as f64 / 1000.0 * said.speedup;
    said.t0_unix_ms.map_or(0.0, since)
}

fn lay_down(call: Option<&(Call, Said)>, lines: &[Line]) -> Result<(), Failure> {
    let Some((call, _)) = call else { return Ok(()) };
    call.lay_down(lines).map_err(|(path, error)| {
        failed(format!(
            "cannot write {}: {error}; nothing was sent, and what was to be recorded is not: tell the threat again",
            path.display()
        ))
    })
}

fn failed(message: impl Into<String>) -> Failure {
    Failure::new(Failure::TRANSFER, message)
}

/// To plan and verdict a way that begins in the air is one that a vehicle rises to. A plane cannot,
/// and what leads straight to an approach is not planned from there.
fn are_led(spec: &MissionSpec) -> Result<(), Failure> {
    for vehicle in &spec.vehicles {
        let why = match vehicle.airframe {
            Airframe::Plane => "is a plane: only copters and VTOL are led onto new paths",
            Airframe::Vtol if vehicle.wing.is_some_and(|wing| wing.landing.is_some()) => {
                "has an approach: only VTOL that land from anywhere are led onto new paths"
            }
            Airframe::Vtol | Airframe::Copter => continue,
        };
        let message = format!("{} {why}; hold it, or let it fly on", vehicle.id);
        return Err(Failure::new(Failure::VERDICT, message));
    }
    Ok(())
}

/// Where the vehicles are reached: as told, as the running `fly` says, or as the spec says.
fn links(
    sorties: &Sorties,
    arguments: &args::Replan,
    running: &Said,
) -> Result<Vec<(usize, Link)>, Failure> {
    let told = upload::links(&sorties.file, &arguments.link)?;
    let mut links = Vec::new();
    for (index, _) in &sorties.missions {
        let this = &sorties.file.spec.vehicles[*index];
        let said = running.links.get(&this.id);
        let said = said.and_then(|link| Link::parse(link));
        let is_told = told.iter().any(|(of, _)| of == index);
        let link = match said {
            Some(link) if !is_told => link,
            _ => upload::link_of(&sorties.file, *index, &told).clone(),
        };
        if link == Link::Sim {
            let message = format!(
                "{}: its simulated vehicle does not run (`sortie fly` starts it, or `sortie vehicles` with --link)",
                this.id
            );
            return Err(failed(message));
        }
        links.push((*index, link));
    }
    Ok(links)
}

/// What each vehicle in flight has before it.
fn courses(sorties: &Sorties, sight: &Sight, since: &Since) -> Result<Vec<Course>, Failure> {
    let mut courses = Vec::new();
    for (index, mission) in &sorties.missions {
        let id = &sorties.file.spec.vehicles[*index].id;
        let Some(seen) = sight
            .vehicles
            .get(index)
            .filter(|seen| seen.beat.is_armed())
        else {
            note(&format!("{id}: does not fly; it is left out"));
            continue;
        };
        let course = Course::new(sorties, *index, mission, seen, since);
        courses.push(course.map_err(|why| impossible(id, &why))?);
    }
    Ok(courses)
}

fn impossible(id: &str, why: &str) -> Failure {
    Failure::new(Failure::VERDICT, format!("{id}: {why}; nothing was sent"))
}
