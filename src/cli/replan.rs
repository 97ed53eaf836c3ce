//! `sortie replan`: new paths from where the vehicles are, around a threat that was not there.

mod course;

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::args;
use super::console::{Paint, note, out};
use super::failure::Failure;
use super::fly::{self, Sorties};
use super::folder;
use super::output;
use super::table::{self, Rows};
use super::upload;
use crate::flight::Diversion;
use crate::geodesy::{Amsl, EastNorth, LatLon, PlanPoint};
use crate::link::{
    Address, Arrival, Command, FlightMessage, Heartbeat, Links, Message, Onboard, Position,
    Reading, Time,
};
use crate::report;
use crate::spec::{Link, Threat};

use course::{Course, Replanned};

/// How long the vehicles are listened to before it is given up, milliseconds.
const LISTENING_MS: u64 = 10_000;
/// Between two requests for positions and the item at work, milliseconds.
const REQUEST_MS: u64 = 1000;
/// Messages that are asked for, `GLOBAL_POSITION_INT` and `MISSION_CURRENT`, and how often, microseconds.
const WANTED: [f32; 2] = [33.0, 42.0];
const INTERVAL_US: f32 = 200_000.0;
/// How long planning and transfer may take on the wall's clock, seconds: the new path
/// begins where the vehicle is after that, and a little more of its own time.
const PLANNING_S: f64 = 1.2;
const SPARE_S: f64 = 2.0;

/// One vehicle as it is now.
struct Seen {
    address: Address,
    armed: bool,
    position: Position,
    /// Sequence number of the item it flies to.
    seq: u16,
    onboard: Onboard,
}

pub(super) fn run(arguments: &args::Replan) -> Result<(), Failure> {
    let sorties = fly::read(&arguments.spec, arguments.dir.as_deref())?;
    let threat = threat(&sorties, &arguments.threat)?;
    let (links, speedup) = links(&sorties, arguments)?;
    let fleet = &sorties.file.spec.vehicles;
    let systems: Vec<(u8, &Link)> = links
        .iter()
        .map(|(index, link)| (fleet[*index].sysid, link))
        .collect();
    let open = Links::open(&systems)
        .map_err(|(link, error)| failed(format!("{link}: {error}; nothing was sent")))?;
    let clock = Clock::start();
    let seen = look(&open, &clock, &sorties)?;
    let planning = Clock::start();
    let lead_s = PLANNING_S * speedup + SPARE_S;
    let courses = courses(&sorties, &seen, &threat, lead_s);
    let replanned = course::replan(&sorties, &threat, &courses, arguments.seed);
    let planned_s = planning.seconds();
    if !replanned.review.passes() {
        out(&table::failures(&replanned.review, Paint::for_stdout()))?;
        let message = "no new paths that pass verification; nothing was sent";
        return Err(Failure::new(Failure::VERDICT, message));
    }
    let told = divert(&open, &clock, &sorties, &seen, &replanned);
    record(&sorties, &threat, &replanned, &told, planned_s)?;
    tell(&sorties, &courses, &replanned, &told, planned_s)?;
    if told.values().all(Result::is_ok) {
        Ok(())
    } else {
        Err(failed("not every vehicle is on its new path"))
    }
}

fn failed(message: impl Into<String>) -> Failure {
    Failure::new(Failure::TRANSFER, message)
}

/// `LAT,LON,RADIUS` as a threat with a name of its own.
fn threat(sorties: &Sorties, text: &str) -> Result<Threat, Failure> {
    let usage = || {
        let message = format!("--threat {text}: not of the form LAT,LON,RADIUS_M");
        Failure::new(Failure::USAGE, message)
    };
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse().ok().filter(|n: &f64| n.is_finite()))
        .collect::<Option<_>>()
        .ok_or_else(usage)?;
    let [lat_deg, lon_deg, radius_m] = numbers[..] else {
        return Err(usage());
    };
    let place = LatLon::new(lat_deg, lon_deg).map_err(|_| usage())?;
    if radius_m <= 0.0 {
        return Err(usage());
    }
    let taken = |id: &str| sorties.file.spec.threats.iter().any(|t| t.id == id);
    let id = (1..).map(|n| format!("popup-{n}")).find(|id| !taken(id));
    Ok(Threat {
        id: id.unwrap_or_default(),
        kind: "popup".to_owned(),
        place,
        radius_m,
    })
}

/// Where the vehicles are reached: as told, as the running `fly` says, or as the spec says.
fn links(
    sorties: &Sorties,
    arguments: &args::Replan,
) -> Result<(Vec<(usize, Link)>, f64), Failure> {
    let told = upload::links(&sorties.file, &arguments.link)?;
    let path = folder::runs_folder(&sorties.folder).join("links.json");
    let running: Value = std::fs::read(&path)
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok())
        .unwrap_or_default();
    let speedup = running["speedup"].as_f64().unwrap_or(1.0);
    let mut links = Vec::new();
    for (index, _) in &sorties.missions {
        let this = &sorties.file.spec.vehicles[*index];
        let said = running["links"][&this.id].as_str().and_then(Link::parse);
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
    Ok((links, speedup))
}

/// Since the command began.
struct Clock(Instant);

impl Clock {
    fn start() -> Self {
        #[allow(
            clippy::disallowed_methods,
            reason = "vehicles fly in real time; the machines get it as a value"
        )]
        let began = Instant::now();
        Self(began)
    }

    fn now(&self) -> Time {
        Time(u64::try_from(self.0.elapsed().as_millis()).unwrap_or(u64::MAX))
    }

    fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

/// Reads what every vehicle holds, then where it is.
fn look(open: &Links, clock: &Clock, sorties: &Sorties) -> Result<BTreeMap<usize, Seen>, Failure> {
    struct Looking {
        reading: Reading,
        beat: Option<(Address, Heartbeat)>,
        position: Option<Position>,
        seq: Option<u16>,
    }
    let fleet = &sorties.file.spec.vehicles;
    let mut looking: BTreeMap<usize, Looking> = sorties
        .missions
        .iter()
        .map(|(index, _)| {
            let reading = Reading::new(Some(fleet[*index].sysid), open.us(), clock.now());
            let found = Looking {
                reading,
                beat: None,
                position: None,
                seq: None,
            };
            (*index, found)
        })
        .collect();
    let mut requested: Option<Time> = None;
    loop {
        let now = clock.now();
        if requested.is_none_or(|at| now - at >= REQUEST_MS) {
            requested = Some(now);
            for index in looking.keys() {
                request(open, fleet[*index].sysid);
            }
        }
        for (index, of) in &mut looking {
            of.reading.handle_timeout(now);
            while let Some(message) = of.reading.poll_transmit() {
                open.send(fleet[*index].sysid, message);
            }
            if let Some(Err(failure)) = of.reading.outcome() {
                let message = format!("{}: {failure}; nothing was sent", fleet[*index].id);
                return Err(failed(message));
            }
        }
        if let Some(Arrival::Message(from, message)) = open.receive(Duration::from_millis(5)) {
            for (index, of) in &mut looking {
                of.reading.handle(clock.now(), from, &message);
                if from.system != fleet[*index].sysid {
                    continue;
                }
                match &message {
                    Message::Heartbeat(beat) => of.beat = Some((from, *beat)),
                    Message::MissionCurrent { seq, .. } => of.seq = Some(*seq),
                    Message::Flight(FlightMessage::Position(position)) => {
                        of.position = Some(*position);
                    }
                    _ => {}
                }
            }
        }
        let is_whole = |of: &Looking| {
            of.reading.outcome().is_some()
                && of.beat.is_some()
                && of.position.is_some()
                && of.seq.is_some()
        };
        let late = clock.now().0 > LISTENING_MS;
        if looking.values().all(is_whole) || late {
            break;
        }
    }
    let mut seen = BTreeMap::new();
    for (index, of) in looking {
        let silent = || {
            failed(format!(
                "{}: does not say where it is; nothing was sent",
                fleet[index].id
            ))
        };
        let (address, beat) = of.beat.ok_or_else(silent)?;
        let Some(Ok(onboard)) = of.reading.outcome() else {
            return Err(silent());
        };
        let found = Seen {
            address,
            armed: beat.is_armed(),
            position: of.position.ok_or_else(silent)?,
            seq: of.seq.ok_or_else(silent)?,
            onboard: onboard.clone(),
        };
        seen.insert(index, found);
    }
    Ok(seen)
}

/// Asks for what an autopilot does not tell everybody by itself.
fn request(open: &Links, system: u8) {
    let target = Address {
        system,
        component: 1,
    };
    for id in WANTED {
        let order = Command::new(Command::SET_MESSAGE_INTERVAL, [id, INTERVAL_US]);
        let message = FlightMessage::Command { target, order };
        open.send(system, Message::Flight(message));
    }
}

/// What each vehicle in flight has before it.
fn courses(
    sorties: &Sorties,
    seen: &BTreeMap<usize, Seen>,
    threat: &Threat,
    lead_s: f64,
) -> Vec<Course> {
    let mut courses = Vec::new();
    for (index, mission) in &sorties.missions {
        let Some(seen) = seen.get(index).filter(|seen| seen.armed) else {
            note(&format!(
                "{}: does not fly; it is left out",
                sorties.file.spec.vehicles[*index].id
            ));
            continue;
        };
        let place = LatLon {
            lat_deg: f64::from(seen.position.x) / 1e7,
            lon_deg: f64::from(seen.position.y) / 1e7,
        };
        let here = PlanPoint {
            at: sorties.world.frame.to_plan(place),
            amsl: Amsl(f64::from(seen.position.amsl_mm) / 1000.0),
        };
        let disc: (EastNorth, f64) = (sorties.world.frame.to_plan(threat.place), threat.radius_m);
        let found = Course::new(
            sorties,
            *index,
            mission,
            (&seen.onboard, seen.seq),
            here,
            lead_s,
            disc,
        );
        match found {
            Some(course) => courses.push(course),
            None => note(&format!(
                "{}: is at the end of its mission; it is left out",
                sorties.file.spec.vehicles[*index].id
            )),
        }
    }
    courses
}

/// Transfers the new missions, and has the vehicles go on with them.
fn divert(
    open: &Links,
    clock: &Clock,
    sorties: &Sorties,
    seen: &BTreeMap<usize, Seen>,
    replanned: &Replanned,
) -> BTreeMap<usize, Result<(), String>> {
    let fleet = &sorties.file.spec.vehicles;
    let systems: Vec<u8> = fleet.iter().map(|vehicle| vehicle.sysid).collect();
    let mut diversions: BTreeMap<usize, Diversion<'_>> = replanned
        .missions
        .iter()
        .filter_map(|(index, mission)| {
            let this = &fleet[*index];
            let others = systems.iter().copied().filter(|id| *id != this.sysid);
            let vehicle = (this.id.as_str(), seen.get(index)?.address);
            let (us, now) = (open.us(), clock.now());
            Some((
                *index,
                Diversion::new(vehicle, mission, others.collect(), us, now),
            ))
        })
        .collect();
    while diversions
        .values()
        .any(|diversion| diversion.outcome().is_none())
    {
        for (index, diversion) in &mut diversions {
            diversion.handle_timeout(clock.now());
            while let Some(message) = diversion.poll_transmit(clock.now()) {
                open.send(fleet[*index].sysid, message);
            }
        }
        let mut arrival = open.receive(Duration::from_millis(5));
        for _ in 0..1000 {
            let Some(Arrival::Message(from, message)) = arrival else {
                break;
            };
            for diversion in diversions.values_mut() {
                diversion.handle(clock.now(), from, &message);
            }
            arrival = open.receive(Duration::ZERO);
        }
    }
    diversions
        .into_iter()
        .map(|(index, of)| (index, of.outcome().cloned().unwrap_or(Ok(()))))
        .collect()
}

/// Writes what was done beside the record of the flight.
fn record(
    sorties: &Sorties,
    threat: &Threat,
    replanned: &Replanned,
    told: &BTreeMap<usize, Result<(), String>>,
    planned_s: f64,
) -> Result<(), Failure> {
    let fleet = &sorties.file.spec.vehicles;
    let vehicles: Vec<Value> = replanned
        .missions
        .iter()
        .map(|(index, mission)| {
            let outcome = told.get(index);
            let items: Vec<Value> = mission
                .items
                .iter()
                .filter_map(|item| {
                    let place = item.place()?;
                    Some(json!({"lat_deg": place.lat_deg, "lon_deg": place.lon_deg, "amsl_m": item.z}))
                })
                .collect();
            json!({
                "id": fleet[*index].id,
                "on_new_path": outcome.is_some_and(Result::is_ok),
                "reason": outcome.and_then(|outcome| outcome.as_ref().err()),
                "items": items,
            })
        })
        .collect();
    let document = json!({
        "sortie": env!("CARGO_PKG_VERSION"),
        "threat": {
            "id": threat.id,
            "lat_deg": threat.place.lat_deg,
            "lon_deg": threat.place.lon_deg,
            "radius_m": threat.radius_m,
        },
        "planning_s": planned_s,
        "vehicles": vehicles,
    });
    let runs = folder::runs_folder(&sorties.folder);
    let text = report::json_text(&document);
    let named = format!("replan-{}.json", super::delivery::seconds_since_1970());
    output::write_file(&runs.join(named), text.as_bytes())?;
    output::write_file(&runs.join("replan.json"), text.as_bytes())?;
    Ok(())
}

fn tell(
    sorties: &Sorties,
    courses: &[Course],
    replanned: &Replanned,
    told: &BTreeMap<usize, Result<(), String>>,
    planned_s: f64,
) -> Result<(), Failure> {
    let mut rows = Rows::new(&["vehicle", "on its way", "items", ""]);
    for course in courses {
        let index = course.vehicle;
        let mission = replanned.missions.iter().find(|(of, _)| *of == index);
        let (what, result) = match told.get(&index) {
            None => ("is not concerned", "not touched".to_owned()),
            Some(Ok(())) => ("meets the threat", "on its new path".to_owned()),
            Some(Err(why)) => ("meets the threat", why.clone()),
        };
        rows.add([
            sorties.file.spec.vehicles[index].id.clone(),
            what.to_owned(),
            mission.map_or_else(|| "-".to_owned(), |(_, m)| m.items.len().to_string()),
            result,
        ]);
    }
    out(&rows.to_string())?;
    out(&format!("planned and verified in {planned_s:.2} s"))
}
