//! The driver of a fleet in flight: clock, links and record.

mod ends;
mod replan;

use std::path::Path;
use std::time::Duration;

use super::start::{BEGUN, Launch};
use super::{Event, Fleet, Intervention};
use crate::flight::clock::{Clock, unix_ms};
use crate::flight::conformance::judge;
use crate::flight::conformance::reference::ReferenceTrajectory;
use crate::flight::conformance::report::FlightReport;
use crate::flight::document::flight_json;
use crate::flight::error::FlightError;
use crate::flight::launch::plan::FlightPlan;
use crate::flight::page::flight_page;
use crate::flight::record::Plan;
use crate::flight::record::handoff::{FlightHandoff, T0};
use crate::flight::record::interrupted::Interrupted;
use crate::flight::record::journal::Journal;
use crate::flight::record::lines::Line;
use crate::flight::record::read::read_record;
use crate::formats::write_file;
use crate::link::{Arrival, Links, Time};
use crate::mission::VehicleMission;
use crate::report;
use replan::replan_lines;

/// Between two looks at where the record is, milliseconds.
const LOOK_MS: u64 = 250;
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
    handoff: &'a FlightHandoff,
    /// Everything that could not be written, each once.
    unwritten: Vec<String>,
    /// What was read of the lines of `replan`.
    read: String,
    /// T0, and the vehicles whose end was announced.
    t0: Option<T0>,
    ended: Vec<String>,
    look_due: Time,
    /// Between which times of the clock of the wall it may begin.
    launch_ms: Option<(u64, u64)>,
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
    pub fn new(links: &'a Links, handoff: &'a FlightHandoff, journal: Journal) -> Self {
        Self {
            links,
            clock: Clock::start(),
            journal,
            handoff,
            unwritten: Vec::new(),
            read: String::new(),
            t0: handoff.notice.t0(),
            ended: handoff.notice.ended.keys().cloned().collect(),
            look_due: Time(0),
            launch_ms: None,
        }
    }

    /// Goes on with the record of a flight that is taken over, after the lines of `replan` that it
    /// has already.
    #[must_use]
    pub fn resuming(mut self, flight: &Interrupted) -> Self {
        self.read = self.handoff.first(flight.replan_lines());
        self
    }

    /// Begins no flight but between two times of the clock of the wall, milliseconds since 1970.
    #[must_use]
    pub fn launching(mut self, between_ms: Option<(u64, u64)>) -> Self {
        self.launch_ms = between_ms;
        self
    }

    /// When the flight may begin, as the clock of the wall is now.
    #[must_use]
    pub fn launch(&self) -> Option<Launch> {
        let between_ms = self.launch_ms?;
        Some(Launch::between(between_ms, unix_ms(), self.now()))
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
        references: &[ReferenceTrajectory],
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
            self.clock.look();
            // Before alarms are looked for.
            self.read_replan(fleet, operator);
            let now = self.now();
            if let Some(launch) = self.launch() {
                fleet.retime_launch(launch);
            }
            fleet.handle_timeout(now);
            while let Some((system, message)) = fleet.poll_transmit() {
                self.links.send(system, message);
            }
            self.record(fleet, operator);
            self.look_at_record(fleet, operator, now);
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
                let t0 = T0::now();
                let t0_unix_s = t0.unix_ms / 1000;
                self.t0 = Some(t0);
                let announced = self.handoff.announce(self.t0.as_ref(), fleet.ended());
                self.note_unwritten(fleet, operator, announced);
                self.remove_newest();
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

    /// Looks whether the record is where it should be, and says at once if it is not.
    fn look_at_record(&mut self, fleet: &mut Fleet<'_>, operator: &mut dyn Operator, now: Time) {
        if now < self.look_due {
            return;
        }
        self.look_due = now + LOOK_MS;
        let looked = self.journal.look();
        let text = match looked {
            Ok(None) => return,
            Ok(Some(text)) => text,
            Err(error) => return self.note_unwritten(fleet, operator, Err(error)),
        };
        let event = Event::new(fleet.t_s(now), None, text);
        let written = self.journal.put(&[Line::of_event(&event).text()]);
        let shown = operator.event(&event);
        let announced = self.handoff.announce(self.t0.as_ref(), fleet.ended());
        let restored = self.handoff.restore(&self.read);
        for done in [written, shown, announced, restored] {
            self.note_unwritten(fleet, operator, done);
        }
    }

    /// Says who is down: neither `replan` nor one who takes the flight over waits for those, which may be switched off.
    fn announce_ends(&mut self, fleet: &mut Fleet<'_>, operator: &mut dyn Operator) {
        if self.t0.is_none() || fleet.down().eq(self.ended.iter().map(String::as_str)) {
            return;
        }
        self.ended = fleet.down().map(str::to_owned).collect();
        let announced = self.handoff.announce(self.t0.as_ref(), fleet.ended());
        self.note_unwritten(fleet, operator, announced);
    }

    /// Takes in the lines of `replan`. It writes them before it sends, so what a vehicle was heard to hold until now
    /// is in them, if `replan` sent it.
    fn read_replan(&mut self, fleet: &mut Fleet<'_>, operator: &mut dyn Operator) {
        let fresh = self.handoff.lines_after(self.read.len());
        let now = self.now();
        let lines = fresh
            .lines()
            .map(str::to_owned)
            .flat_map(|line| replan_lines(line, fleet, now, operator));
        let lines: Vec<String> = lines.collect();
        self.read += &fresh;
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
        self.unwritten
            .extend(self.journal.look().err().map(|error| error.to_string()));
        if self.journal.is_broken() {
            let why = self.unwritten.join("; ");
            let message = format!("{why}: the record breaks off, and the flight is not judged");
            return Err(FlightError::Record(message));
        }
        if let Some(why) = self.journal.spoilt() {
            let message = format!("{why}: the flight is not judged");
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
        let text = self.journal.text()?;
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
