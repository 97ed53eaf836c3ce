//! The driver of a fleet in flight: clock, links and record.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use super::end::End;
use super::start::BEGUN;
use super::{Event, Fleet, Intervention};
use crate::flight::clock::{Clock, unix_ms};
use crate::flight::conformance::judge;
use crate::flight::conformance::reference::Reference;
use crate::flight::conformance::report::FlightReport;
use crate::flight::document::flight_json;
use crate::flight::error::FlightError;
use crate::flight::launch::plan::FlightPlan;
use crate::flight::page::flight_page;
use crate::flight::record::interrupted::Interrupted;
use crate::flight::record::journal::Journal;
use crate::flight::record::lines::Line;
use crate::flight::record::read::read_record;
use crate::flight::record::underway::{Ended, Underway};
use crate::flight::record::{Flown, Plan};
use crate::formats::write_file;
use crate::link::{Arrival, Links, Time};
use crate::mission::VehicleMission;
use crate::report;

/// Messages that are handled before the fleet has its turn again.
const BURST: usize = 1000;

/// The operator at the screen.
pub trait Operator {
    /// Shows an event. No call waits for the screen.
    ///
    /// # Errors
    /// [`FlightError::Record`]: it, or one before it, cannot be shown.
    fn event(&mut self, event: &Event) -> Result<(), FlightError>;
    /// Shows the state of the fleet.
    ///
    /// # Errors
    /// [`FlightError::Record`]: something before it could not be shown.
    fn update(&mut self, fleet: &Fleet<'_>, now: Time) -> Result<(), FlightError>;
    /// Shows a problem of the driver itself.
    fn warn(&mut self, text: &str);
    /// What the operator wants now, if anything.
    fn intervention(&mut self) -> Option<Intervention>;
}

/// Drives a fleet: hands messages and the time to it, sends its messages, writes its record.
#[derive(Debug)]
pub struct Driver<'a> {
    links: &'a Links,
    clock: Clock,
    journal: Journal,
    underway: &'a Underway,
    /// Everything that could not be written, each once.
    unwritten: Vec<String>,
    /// Bytes read from the lines of `replan`.
    read: usize,
    /// T0, milliseconds since 1970, and the vehicles whose end was announced.
    t0_unix_ms: Option<u64>,
    ended: Vec<String>,
}

/// The verdict on a flight, by its record.
#[derive(Debug)]
pub struct Judged {
    /// The verdict.
    pub report: FlightReport,
    /// `flight.json`
    pub json: String,
    /// Whether the documents of the flight were written.
    pub written: Result<(), FlightError>,
}

impl<'a> Driver<'a> {
    /// Starts the clock.
    #[must_use]
    pub fn new(links: &'a Links, underway: &'a Underway, journal: Journal) -> Self {
        Self {
            links,
            clock: Clock::start(),
            journal,
            underway,
            unwritten: Vec::new(),
            read: 0,
            t0_unix_ms: underway.notice.t0_unix_ms,
            ended: underway.notice.ended.keys().cloned().collect(),
        }
    }

    /// Goes on with the record of a flight that is taken over, after the lines of `replan` that it
    /// has already.
    #[must_use]
    pub fn resuming(mut self, flight: &Interrupted) -> Self {
        self.read = self.underway.length_of(flight.replan_lines());
        self
    }

    /// Time since the driver was made.
    #[must_use]
    pub fn now(&self) -> Time {
        self.clock.now()
    }

    /// The record of the flight.
    #[must_use]
    pub fn record_path(&self) -> &Path {
        self.journal.path()
    }

    /// Everything that could not be written, in words.
    #[must_use]
    pub fn unwritten(&self) -> &[String] {
        &self.unwritten
    }

    /// Records the plans that the vehicles take off with.
    ///
    /// # Errors
    /// [`FlightError::Record`]
    pub fn record_plans(
        &mut self,
        plan: &FlightPlan,
        references: &[Reference],
    ) -> Result<(), FlightError> {
        let missions = plan.missions.iter().zip(references);
        let lines = missions.map(|((index, mission), reference)| {
            let of = Plan {
                items: mission.items.len(),
                reference: reference.clone(),
                from_s: 0.0,
            };
            Line::of_plan(&plan.vehicle(*index).id, 0.0, &of).text()
        });
        let itineraries = plan.missions.iter().filter_map(|(index, _)| {
            let itinerary = plan.itineraries.get(*index)?;
            let vehicle = plan.vehicle(*index).id.clone();
            let itinerary = itinerary.clone();
            let line = Line::Itinerary { vehicle, itinerary };
            (!plan.itineraries[*index].stops.is_empty()).then(|| line.text())
        });
        let lines: Vec<String> = lines.chain(itineraries).collect();
        self.journal.put(&lines)
    }

    /// Flies until the flight is over, or was not begun. A line that cannot be written does not
    /// end it: vehicles in the air are monitored to the ground.
    pub fn fly(&mut self, fleet: &mut Fleet<'_>, operator: &mut dyn Operator) {
        loop {
            // Before alarms are looked for.
            self.read_replan(fleet, operator);
            let now = self.now();
            fleet.handle_timeout(now);
            while let Some((system, message)) = fleet.poll_transmit() {
                self.links.send(system, message);
            }
            self.record(fleet, operator);
            if let Some(intervention) = operator.intervention() {
                fleet.intervene(now, intervention);
            }
            let shown = operator.update(fleet, now);
            self.note_unwritten(fleet, operator, shown);
            if fleet.outcome().is_some() {
                self.read_replan(fleet, operator);
                return self.record(fleet, operator);
            }
            self.listen(fleet);
        }
    }

    fn listen(&self, fleet: &mut Fleet<'_>) {
        let wait = Duration::from_millis(fleet.poll_timeout() - self.now());
        let mut arrival = self.links.receive(wait.max(Duration::from_millis(1)));
        for _ in 0..BURST {
            let Some(arrived) = arrival else { return };
            let now = self.now();
            match arrived {
                Arrival::Message(link, from, message) => {
                    fleet.handle(now, (link, from), &message);
                }
                Arrival::DuplicateSystem(system, what) => fleet.trouble(now, Some(system), what),
                Arrival::Failed(link, why) => {
                    fleet.trouble(now, None, &format!("the link {link} has failed: {why}"));
                }
            }
            arrival = self.links.receive(Duration::ZERO);
        }
    }

    /// Shows events, and writes everything that happened to the record.
    fn record(&mut self, fleet: &mut Fleet<'_>, operator: &mut dyn Operator) {
        let mut lines: Vec<String> = Vec::new();
        while let Some(event) = fleet.poll_event() {
            if event.vehicle.is_none() && event.text == BEGUN {
                let t0_unix_ms = unix_ms();
                self.t0_unix_ms = Some(t0_unix_ms);
                let announced = self.underway.announce(self.t0_unix_ms, fleet.ended());
                self.note_unwritten(fleet, operator, announced);
                self.remove_newest();
                let t0_unix_s = t0_unix_ms / 1000;
                lines.push(Line::Start { t0_unix_s }.text());
            }
            lines.push(Line::of_event(&event).text());
            let shown = operator.event(&event);
            self.note_unwritten(fleet, operator, shown);
        }
        while let Some((from_s, t_s)) = fleet.poll_stop() {
            let stopped_s = t_s - from_s;
            lines.push(Line::Stop { t_s, stopped_s }.text());
        }
        while let Some((t_s, vehicle, order)) = fleet.poll_order() {
            lines.push(
                Line::Order {
                    t_s,
                    vehicle,
                    order,
                }
                .text(),
            );
        }
        lines.extend(self.journal.fresh(fleet.flown()));
        let written = self.journal.put(&lines);
        self.note_unwritten(fleet, operator, written);
        self.announce_ends(fleet, operator);
    }

    /// Says who is down: neither `replan` nor one who takes the flight over waits for those, which may be switched off.
    fn announce_ends(&mut self, fleet: &mut Fleet<'_>, operator: &mut dyn Operator) {
        if self.t0_unix_ms.is_none() || fleet.down().eq(self.ended.iter().map(String::as_str)) {
            return;
        }
        self.ended = fleet.down().map(str::to_owned).collect();
        let announced = self.underway.announce(self.t0_unix_ms, fleet.ended());
        self.note_unwritten(fleet, operator, announced);
    }

    /// Takes in the lines of `replan`. It writes them before it sends, so what a vehicle was heard to hold until now
    /// is in them, if `replan` sent it.
    fn read_replan(&mut self, fleet: &mut Fleet<'_>, operator: &mut dyn Operator) {
        let (fresh, read) = self.underway.lines_after(self.read);
        let now = self.now();
        let lines = fresh
            .into_iter()
            .flat_map(|line| replan_lines(line, fleet, now, operator));
        let lines: Vec<String> = lines.collect();
        self.read = read;
        let written = self.journal.put(&lines);
        self.note_unwritten(fleet, operator, written);
    }

    /// Removes the documents of the newest flight: from now on that is this one, however it ends.
    fn remove_newest(&self) {
        for ending in ["json", "html", "jsonl"] {
            // A file that is not there is as good.
            let _ = std::fs::remove_file(self.newest(ending));
        }
    }

    fn newest(&self, ending: &str) -> std::path::PathBuf {
        let name = Path::new("flight").with_extension(ending);
        self.journal.path().with_file_name(name)
    }

    /// Reports once what cannot be written. On the ground that ends the flight, in the air it
    /// does not.
    fn note_unwritten(
        &mut self,
        fleet: &mut Fleet<'_>,
        operator: &mut dyn Operator,
        written: Result<(), FlightError>,
    ) {
        let Err(error) = written else { return };
        let message = error.to_string();
        if self.unwritten.contains(&message) {
            return;
        }
        if fleet.t_s(self.now()).is_some() {
            operator.warn(&format!("{message}; the vehicles are still monitored"));
        } else {
            fleet.trouble(self.now(), None, &message);
        }
        self.unwritten.push(message);
    }

    /// Records how each flight ended.
    ///
    /// # Errors
    /// [`FlightError::Record`]: the record breaks off, so that it cannot be judged.
    pub fn record_ends(&mut self, fleet: &Fleet<'_>) -> Result<(), FlightError> {
        // One that was not heard can be taken over later, and one of an earlier record has its end in it.
        let ends = fleet.unrecorded_ends();
        let ends = ends.map(|(vehicle, flown)| Line::of_end(vehicle, flown).text());
        let ends: Vec<String> = ends.collect();
        let ended = self.journal.put(&ends);
        self.unwritten
            .extend(ended.err().map(|error| error.to_string()));
        if self.journal.is_broken() {
            let why = self.unwritten.join("; ");
            let message = format!("{why}: the record breaks off, and the flight is not judged");
            return Err(FlightError::Record(message));
        }
        Ok(())
    }

    /// Judges the flight by its record, as written, and writes its documents: with the name of the
    /// record and as those of the newest flight.
    ///
    /// # Errors
    /// [`FlightError::Record`]: the record cannot be read.
    pub fn judge(&self, plan: &FlightPlan) -> Result<Judged, FlightError> {
        let path = self.journal.path();
        let text = std::fs::read_to_string(path).map_err(|error| {
            FlightError::Record(format!("cannot read {}: {error}", path.display()))
        })?;
        let (spec, world) = (plan.spec(), &plan.world);
        let record = read_record(&text, world.frame)
            .map_err(|error| FlightError::Record(error.to_string()))?;
        let report = judge(spec, world, &record);
        let json = report::json_text(&flight_json(&record, &report));
        let missions: Vec<(usize, &VehicleMission)> =
            plan.missions.iter().map(|(v, m)| (*v, m)).collect();
        let page = flight_page(spec, world, &record, &report, &missions);
        let written = self.write([("jsonl", &text), ("html", &page), ("json", &json)]);
        Ok(Judged {
            report,
            json,
            written,
        })
    }

    fn write(&self, documents: [(&str, &String); 3]) -> Result<(), FlightError> {
        for (ending, text) in documents {
            let named = self.journal.path().with_extension(ending);
            if named != self.journal.path() {
                write_file(&named, text.as_bytes())?;
            }
            write_file(&self.newest(ending), text.as_bytes())?;
        }
        Ok(())
    }
}

impl Fleet<'_> {
    /// The vehicles that are in the air when the monitoring ends.
    #[must_use]
    pub fn in_the_air(&self) -> Vec<&str> {
        let stays = |end: &End| matches!(end, End::Held | End::LeftFlying | End::Loitering);
        let vehicles = self.vehicles.iter();
        let up = vehicles.filter(|of| stays(&of.flown.end) || of.is_left_up());
        up.map(|of| of.of.vehicle).collect()
    }

    /// Those that were not heard since their flight was taken over.
    #[must_use]
    pub fn unheard(&self) -> Vec<&str> {
        let vehicles = self.vehicles.iter();
        let unheard = vehicles.filter(|of| of.is_unheard());
        unheard.map(|of| of.of.vehicle).collect()
    }

    /// The vehicles whose flight is over and whose motors stand.
    fn down(&self) -> impl Iterator<Item = &str> {
        let vehicles = self.vehicles.iter();
        vehicles
            .filter(|of| of.is_known_down())
            .map(|of| of.of.vehicle)
    }

    /// How the flights of those ended, by id.
    #[must_use]
    pub fn ended(&self) -> BTreeMap<String, Ended> {
        let vehicles = self.vehicles.iter().filter(|of| of.is_known_down());
        let ended = vehicles.map(|of| {
            let (end, t_s) = (of.flown.end.words().to_owned(), of.flown.until_s);
            (of.of.vehicle.to_owned(), Ended { end, t_s })
        });
        ended.collect()
    }

    fn unrecorded_ends(&self) -> impl Iterator<Item = (&str, &Flown)> {
        let vehicles = self.vehicles.iter();
        let due = vehicles.filter(|of| !of.is_unheard() && !of.has_recorded_end());
        due.map(|of| (of.of.vehicle, &of.flown))
    }
}

/// The lines of the record for a line of `replan`. A threat counts from now on at the latest,
/// whatever time it was given.
fn replan_lines(
    line: String,
    fleet: &mut Fleet<'_>,
    now: Time,
    operator: &mut dyn Operator,
) -> Vec<String> {
    let t_s = fleet.t_s(now);
    let (line, vehicle, text) = match serde_json::from_str(&line) {
        Ok(Line::Threat {
            t_s: given_s,
            threat,
        }) => {
            let t_s = t_s.map_or(given_s, |now_s| given_s.min(now_s));
            let text = format!("replan reports a threat, {}", threat.words());
            fleet.heed_threat(threat.clone(), t_s);
            (Line::Threat { t_s, threat }.text(), None, text)
        }
        Ok(Line::Plan {
            t_s: given_s,
            vehicle,
            plan,
        }) => {
            fleet.heed_plan(now, &vehicle, (given_s, plan));
            let text = "is sent another plan by replan".to_owned();
            (line, Some(vehicle), text)
        }
        Ok(Line::Event { vehicle, event, .. }) => {
            let event = Event::new(t_s, vehicle, event);
            let _ = operator.event(&event);
            return vec![Line::of_event(&event).text()];
        }
        _ => return vec![line],
    };
    let event = Event {
        t_s,
        vehicle,
        text,
        alarm: None,
    };
    // A screen that takes nothing is reported with the next event.
    let _ = operator.event(&event);
    vec![line, Line::of_event(&event).text()]
}
