//! `sortie replan`: new paths from where the vehicles are, around a threat that comes up.

use std::path::Path;

use super::args;
use super::fly;
use super::folder::{claim, runs};
use super::links;
use super::print::console::{Paint, note, out, out_lines};
use super::print::failure::Failure;
use super::print::table::{self, Rows};
use crate::flight::replan::{self, Decision, Outcomes, Replanner, VehicleState};
use crate::flight::{
    FlightError, FlightHandoff, FlightPlan, Line, Notice, PopUp, count_words, steady_ms,
};
use crate::formats::write_file;
use crate::geodesy::LatLon;
use crate::spec::{Area, Link, MissionSpec, THREAT_RADIUS_M, Threat};

pub(super) fn run(arguments: &args::Replan) -> Result<(), Failure> {
    let mut plan = fly::read(&arguments.spec, arguments.dir.as_deref())?;
    let folder = runs::folder(&plan.folder);
    let _lock = runs::lock(&folder, "replan").map_err(|busy| {
        let message = format!(
            "{}, and this threat is not recorded: give it again",
            busy.message
        );
        Failure::new(busy.code, message)
    })?;
    let handoff = FlightHandoff::find(folder.clone())?;
    refuse_copy(&folder, handoff.as_ref())?;
    if !runs::is_in_flight(&plan.folder) {
        note(
            "no `sortie fly` monitors this fleet: its flight is not recorded, nor judged against the threat",
        );
    }
    let mut popups = handoff
        .as_ref()
        .map(FlightHandoff::popups)
        .unwrap_or_default();
    let threat = parse_threat(plan.spec(), &popups, &arguments.threat)?;
    popups.push(threat.clone());
    replan::add_threats(&mut plan, &popups);
    let notice = handoff.as_ref().map(|of| of.notice.clone());
    let notice = notice.unwrap_or_default();
    let threat_ms = steady_ms();
    let popup = PopUp {
        from_s: notice.t_s(threat_ms),
        threat: threat.clone(),
    };
    let supported = replan::refuse_unsupported(plan.spec()).map_err(Failure::from);
    let linked = supported.and_then(|()| links::under_way(&plan, &arguments.link, &notice));
    if let Ok(links) = &linked {
        refuse_taken_ports(&plan, links)?;
    }
    // Whatever comes of it: the flight is judged against the threat from now on.
    append(handoff.as_ref(), &[Line::of_popup(&popup)])?;
    let led = linked.and_then(|links| {
        let replanner = Replanner::open(&plan, &links, &popups, &notice, threat_ms)
            .map_err(|failed| unreachable_link(&plan, &failed))?;
        lead(&replanner, handoff.as_ref(), &notice, arguments.seed)
    });
    let write = |text: String| -> Result<(), Failure> {
        write_file(&runs::named(&folder, "replan", "json"), text.as_bytes())?;
        write_file(&folder.join("replan.json"), text.as_bytes())?;
        Ok(())
    };
    if let Err(failure) = &led {
        write(replan::failure_document(&threat, &failure.message))?;
    }
    let (decision, outcomes) = led?;
    write(replan::document(plan.spec(), &threat, &decision, &outcomes))?;
    print(plan.spec(), &decision, &outcomes)?;
    verdict(plan.spec(), &decision, &outcomes)
}

/// Refuses a copy of the folder of a flight: the process that flies the fleet reads nothing of it.
fn refuse_copy(folder: &Path, handoff: Option<&FlightHandoff>) -> Result<(), Failure> {
    let flight = handoff.map_or("", |of| of.notice.flight.as_str());
    let holder = claim::holder_of(flight).filter(|holder| holder.runs != folder);
    holder.map_or(Ok(()), |holder| {
        Err(failed(format!(
            "{} is a copy: `sortie` flies this fleet from {}; replan there. This threat is not recorded, and nothing was sent",
            folder.display(),
            holder.runs.display()
        )))
    })
}

/// Plans, and sends the new missions if they pass.
fn lead(
    replanner: &Replanner<'_>,
    handoff: Option<&FlightHandoff>,
    notice: &Notice,
    seed: Option<u64>,
) -> Result<(Decision, Outcomes), Failure> {
    let decision = replanner.decide(seed, &|remark| note(remark))?;
    if !decision.review.passes() {
        let clock = notice.t0_unix_ms.map_or("now", |_| "T0");
        let paint = Paint::for_stdout();
        out_lines(&table::failures_since(&decision.review, paint, clock))?;
    }
    if !decision.is_sound {
        let message = "no new paths that pass verification; nothing was sent";
        return Err(Failure::new(Failure::VERDICT, message));
    }
    if !decision.has_buffers && !decision.missions.is_empty() {
        note(
            "WARNING: no new path keeps the buffers of the spec: the new paths keep its limits alone, by which a flight is judged",
        );
    }
    append(handoff, &replanner.record_lines(&decision))?;
    let outcomes = replanner.send(&decision);
    // What comes of them is known here first.
    if let Err(error) = append(handoff, &replanner.outcome_lines(&outcomes)) {
        note(&error.to_string());
    }
    Ok((decision, outcomes))
}

fn append(handoff: Option<&FlightHandoff>, lines: &[Line]) -> Result<(), FlightError> {
    handoff.map_or(Ok(()), |handoff| handoff.append(lines))
}

/// Refuses to begin where the port of a vehicle is taken: `fly` holds those that it listens at, and
/// nothing could be sent. The threat is not recorded then.
fn refuse_taken_ports(plan: &FlightPlan, links: &[(usize, Link)]) -> Result<(), Failure> {
    for (index, link) in links {
        let Link::UdpIn(address) = link else { continue };
        let taken = std::net::UdpSocket::bind(address.as_str()).err();
        if let Some(error) = taken.filter(|of| of.kind() == std::io::ErrorKind::AddrInUse) {
            let id = &plan.vehicle(*index).id;
            let message = format!(
                "{link}: {error}: `sortie fly` or another program listens there. Reach {id} over another of its links, \
                 with --link {id}=ADDRESS; the threat was not recorded, and nothing was sent"
            );
            return Err(failed(message));
        }
    }
    Ok(())
}

fn unreachable_link(plan: &FlightPlan, (link, error): &(String, std::io::Error)) -> Failure {
    // Only one process can listen at a port.
    let is_taken = error.kind() == std::io::ErrorKind::AddrInUse;
    let hint = if is_taken && runs::is_in_flight(&plan.folder) {
        " (`sortie fly` listens there: reach the vehicle over another of its links, with --link)"
    } else {
        ""
    };
    failed(format!("{link}: {error}{hint}; nothing was sent"))
}

fn failed(message: impl Into<String>) -> Failure {
    Failure::new(Failure::TRANSFER, message)
}

/// `LAT,LON,RADIUS` as a threat with an id of its own.
fn parse_threat(spec: &MissionSpec, earlier: &[Threat], text: &str) -> Result<Threat, Failure> {
    let usage = |why: String| Failure::new(Failure::USAGE, format!("--threat {text}: {why}"));
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [lat, lon, radius] = parts[..] else {
        return Err(usage("not of the form LAT,LON,RADIUS_M".to_owned()));
    };
    let number = |name: &str, text: &str, least: f64, most: f64| {
        let found = text.parse().ok();
        let found = found.filter(|n: &f64| (least..=most).contains(n));
        found.ok_or_else(|| usage(format!("{name} {text:?} (allowed: {least} to {most})")))
    };
    let place = LatLon {
        lat_deg: number("latitude", lat, -90.0, 90.0)?,
        lon_deg: number("longitude", lon, -180.0, 180.0)?,
    };
    let (least, most) = (*THREAT_RADIUS_M.start(), *THREAT_RADIUS_M.end());
    let radius_m = number("radius in metres", radius, least, most)?;
    if !touches(&spec.area, place, radius_m) {
        let (from, to) = (spec.area.south_west, spec.area.north_east);
        return Err(usage(format!(
            "lies outside of the area of the mission (latitude {} to {}, longitude {} to {}); nothing was sent",
            from.lat_deg, to.lat_deg, from.lon_deg, to.lon_deg
        )));
    }
    let taken = |id: &str| spec.threats.iter().chain(earlier).any(|t| t.id == id);
    let id = (1..).map(|n| format!("popup-{n}")).find(|id| !taken(id));
    Ok(Threat {
        id: id.unwrap_or_default(),
        kind: "popup".to_owned(),
        place,
        radius_m,
    })
}

/// Whether a circle overlaps the area. One that does not has its numbers swapped.
fn touches(area: &Area, place: LatLon, radius_m: f64) -> bool {
    let (from, to) = (area.south_west, area.north_east);
    let nearest = LatLon {
        lat_deg: place.lat_deg.clamp(from.lat_deg, to.lat_deg),
        lon_deg: place.lon_deg.clamp(from.lon_deg, to.lon_deg),
    };
    place.chord_m(nearest) < radius_m
}

fn print(spec: &MissionSpec, decision: &Decision, outcomes: &Outcomes) -> Result<(), Failure> {
    let mut rows = Rows::new(&["vehicle", "on its way", "items", "left", ""]);
    for state in &decision.states {
        let index = state.vehicle;
        let mut missions = decision.missions.iter();
        let mission = missions.find(|of| of.vehicle == index);
        let mut unavoidable = decision.unavoidable.iter();
        let (what, result) = match (
            outcomes.get(&index),
            unavoidable.find(|of| of.vehicle == index),
        ) {
            (_, Some(of)) => (of.cannot(), "KEEPS ITS COURSE".to_owned()),
            (None, None) => unconcerned(state, decision),
            (Some(Ok(())), None) => ("meets a threat".to_owned(), "on its new path".to_owned()),
            (Some(Err(why)), None) => ("meets a threat".to_owned(), why.clone()),
        };
        rows.add([
            spec.vehicles[index].id.clone(),
            what,
            mission.map_or_else(|| "-".to_owned(), |of| of.mission.items.len().to_string()),
            count_words(&state.left),
            result,
        ]);
    }
    rows.print()?;
    out(&format!(
        "planned and verified in {:.2} s",
        decision.planned_s
    ))
}

/// What is said of a vehicle whose way keeps clear of every threat.
fn unconcerned(state: &VehicleState, decision: &Decision) -> (String, String) {
    let not_touched = "not touched".to_owned();
    match state.doing.word().filter(|_| !state.stands) {
        None => ("is not concerned".to_owned(), not_touched),
        Some(word) if decision.not_to_resume.contains(&state.vehicle) => (
            format!("{word}: is not concerned"),
            "not touched: its mission meets a threat, do not resume it".to_owned(),
        ),
        Some(word) => (format!("{word}: is not concerned"), not_touched),
    }
}

/// A vehicle that cannot avoid a threat is named whatever else went well.
fn verdict(spec: &MissionSpec, decision: &Decision, outcomes: &Outcomes) -> Result<(), Failure> {
    let is_taken = outcomes.values().all(Result::is_ok);
    let unjudged = "not every vehicle that keeps its course can be judged (see above)";
    let is_unjudged = !decision.review.passes();
    let wrong = replan::sentence(&decision.unavoidable, &spec.vehicles)
        .or_else(|| is_unjudged.then(|| unjudged.to_owned()));
    match (wrong, is_taken) {
        (None, true) => Ok(()),
        (None, false) => Err(failed("not every vehicle is on its new path")),
        (Some(who), true) => {
            let others = if outcomes.is_empty() {
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
