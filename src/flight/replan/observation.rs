//! What is on board of every vehicle, and where it is. Vehicles are only asked: nothing on board changes.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use crate::flight::clock::{Clock, steady_ms};
use crate::flight::error::FlightError;
use crate::flight::launch::plan::FlightPlan;
use crate::flight::record::handoff::Ended;
use crate::link::{
    AUTOPILOT_INVALID, Address, Arrival, Command, FlightMessage, Heartbeat, Links, Message,
    Onboard, Position, Reading, Time,
};

/// One that is heard, and says nothing more of what it is asked for, is waited for no longer than this, milliseconds.
const LISTENING_MS: u64 = 10_000;
/// One that is not heard at all is left out after this time, milliseconds: the others are led.
const SILENT_MS: u64 = 5_000;
/// Between two requests for position and current item, milliseconds.
const REQUEST_MS: u64 = 100;
/// Requested messages: `GLOBAL_POSITION_INT` and `MISSION_CURRENT`.
const REQUESTED: [f32; 2] = [33.0, 42.0];
/// Messages that are handled before requests and transfers have their turn again.
const BURST: usize = 1000;

/// One vehicle as it is now.
#[derive(Debug)]
pub(super) struct ObservedVehicle {
    pub(super) address: Address,
    pub(super) heartbeat: Heartbeat,
    pub(super) position: Position,
    /// Its positions since the command began, each with its time on the steady clock, milliseconds.
    pub(super) flown: Vec<(u64, Position)>,
    /// Sequence number of its current item.
    pub(super) seq: u16,
    /// Items that it says to hold, as it was sent.
    pub(super) total: u16,
    pub(super) onboard: Onboard,
}

/// All vehicles at one time.
#[derive(Debug)]
pub(super) struct Observation {
    /// By index in the spec.
    pub(super) vehicles: BTreeMap<usize, ObservedVehicle>,
    /// Those that were not heard.
    pub(super) silent: BTreeSet<usize>,
    /// The time on the steady clock, milliseconds.
    pub(super) steady_ms: u64,
    /// The same on the clock of the command, seconds.
    pub(super) at_s: f64,
    /// Time that reading all lists took, seconds.
    pub(super) reading_s: f64,
}

/// What is known of one vehicle so far.
struct Known {
    reading: Reading,
    heartbeat: Option<(Address, Heartbeat)>,
    position: Option<Position>,
    flown: Vec<(u64, Position)>,
    /// Its current item, and how many it says to hold.
    current: Option<(u16, u16)>,
    /// When anything came that was waited for.
    moved: Time,
    is_silent: bool,
}

impl Known {
    /// Something came: what came before is no news, and one that sends that alone is not waited for without end.
    fn move_on(&mut self, now: Time, is_news: bool) {
        if is_news {
            self.moved = now;
        }
    }

    /// What it has not sent in time.
    fn missing(&self) -> &'static str {
        match self.reading.outcome() {
            _ if self.heartbeat.is_none() => "sends no heartbeat",
            None => "does not send all of its mission, fence and rally points",
            Some(_) if self.position.is_none() => "does not say where it is",
            Some(_) => "does not say which item it flies to",
        }
    }
}

/// Reads the lists of every vehicle once, and observes the fleet as often as needed.
pub(super) struct Observer<'a> {
    links: &'a Links,
    clock: &'a Clock,
    plan: &'a FlightPlan,
    vehicles: BTreeMap<usize, Known>,
    reading_s: f64,
}

impl<'a> Observer<'a> {
    /// Reads what every vehicle holds.
    /// Those whose flight is over (`ended`) may be switched off.
    pub(super) fn read(
        links: &'a Links,
        clock: &'a Clock,
        plan: &'a FlightPlan,
        ended: &BTreeMap<String, Ended>,
    ) -> Result<Self, FlightError> {
        let missions = plan.missions.iter();
        let missions = missions.filter(|(index, _)| !ended.contains_key(&plan.vehicle(*index).id));
        let vehicles = missions.map(|(index, _)| {
            let sysid = plan.vehicle(*index).sysid;
            let known = Known {
                reading: Reading::new(Some(sysid), links.us(), clock.now()).in_the_air(),
                heartbeat: None,
                position: None,
                flown: Vec::new(),
                current: None,
                moved: clock.now(),
                is_silent: false,
            };
            (*index, known)
        });
        let mut observer = Self {
            links,
            clock,
            plan,
            vehicles: vehicles.collect(),
            reading_s: 0.0,
        };
        let began_s = clock.seconds();
        observer.listen_until(|of| of.reading.outcome().is_some() && of.heartbeat.is_some())?;
        observer.reading_s = clock.seconds() - began_s;
        Ok(observer)
    }

    /// Observes where every vehicle is now.
    pub(super) fn observe(&mut self) -> Result<Observation, FlightError> {
        let now = self.clock.now();
        for of in self.vehicles.values_mut() {
            (of.position, of.current, of.moved) = (None, None, now);
        }
        self.listen_until(|of| of.position.is_some() && of.current.is_some())?;
        let mut observation = Observation {
            vehicles: BTreeMap::new(),
            silent: BTreeSet::new(),
            steady_ms: steady_ms(),
            at_s: self.clock.seconds(),
            reading_s: self.reading_s,
        };
        for (index, of) in self.vehicles.iter().filter(|(_, of)| !of.is_silent) {
            let (Some((address, heartbeat)), Some(position), Some((seq, total)), Some(Ok(onboard))) =
                (of.heartbeat, of.position, of.current, of.reading.outcome())
            else {
                return Err(self.incomplete(*index));
            };
            let observed = ObservedVehicle {
                address,
                heartbeat,
                position,
                flown: of.flown.clone(),
                seq,
                total,
                onboard: onboard.clone(),
            };
            observation.vehicles.insert(*index, observed);
        }
        let silent = self.vehicles.iter().filter(|(_, of)| of.is_silent);
        observation.silent = silent.map(|(index, _)| *index).collect();
        Ok(observation)
    }

    fn incomplete(&self, index: usize) -> FlightError {
        let id = &self.plan.vehicle(index).id;
        let missing = self.vehicles.get(&index).map_or("", Known::missing);
        FlightError::Transfer(format!("{id}: {missing}; nothing was sent"))
    }

    /// Those that are heard are waited for as long as they send something of it.
    fn listen_until(&mut self, is_known: fn(&Known) -> bool) -> Result<(), FlightError> {
        let mut requested: Option<Time> = None;
        let is_waited_for = |of: &Known| !of.is_silent && !is_known(of);
        while self.vehicles.values().any(is_waited_for) {
            let now = self.clock.now();
            for of in self.vehicles.values_mut() {
                of.is_silent |= of.heartbeat.is_none() && now - of.moved > SILENT_MS;
            }
            if self.vehicles.values().all(|of| of.is_silent) {
                let message = "no vehicle is heard; nothing was sent";
                return Err(FlightError::Transfer(message.to_owned()));
            }
            let is_late = |of: &Known| is_waited_for(of) && now - of.moved > LISTENING_MS;
            let late = self.vehicles.iter().find(|(_, of)| is_late(of));
            if let Some((index, _)) = late {
                return Err(self.incomplete(*index));
            }
            if requested.is_none_or(|at| now - at >= REQUEST_MS) {
                requested = Some(now);
                self.request();
            }
            self.transfer(now)?;
            let mut arrival = self.links.receive(Duration::from_millis(5));
            for _ in 0..BURST {
                let Some(Arrival::Message(link, from, message)) = arrival else {
                    break;
                };
                self.handle((link, from), &message);
                arrival = self.links.receive(Duration::ZERO);
            }
        }
        Ok(())
    }

    /// Requests what an autopilot does not broadcast.
    fn request(&self) {
        for of in self.vehicles.values() {
            let Some((target, _)) = of.heartbeat else {
                continue;
            };
            for id in REQUESTED {
                let order = Command::new(Command::REQUEST_MESSAGE, [id]);
                let message = FlightMessage::Command { target, order };
                self.links.send(target.system, Message::Flight(message));
            }
        }
    }

    fn transfer(&mut self, now: Time) -> Result<(), FlightError> {
        for (index, of) in self.vehicles.iter_mut().filter(|(_, of)| !of.is_silent) {
            let vehicle = self.plan.vehicle(*index);
            of.reading.handle_timeout(now);
            while let Some(message) = of.reading.poll_transmit() {
                self.links.send(vehicle.sysid, message);
            }
            if let Some(Err(failure)) = of.reading.outcome() {
                if of.heartbeat.is_none() {
                    of.is_silent = true;
                    continue;
                }
                let message = format!("{}: {failure}; nothing was sent", vehicle.id);
                return Err(FlightError::Transfer(message));
            }
        }
        Ok(())
    }

    fn handle(&mut self, (link, from): (usize, Address), message: &Message) {
        let now = self.clock.now();
        for (index, of) in &mut self.vehicles {
            let system = self.plan.vehicle(*index).sysid;
            if self.links.number(system) != Some(link) {
                continue;
            }
            of.reading.handle(now, from, message);
            if from.system != system {
                continue;
            }
            // Other components of the vehicle may have positions of their own.
            let is_known = |(autopilot, _)| autopilot == from;
            let may_be = from.component == 1 || of.heartbeat.is_none_or(is_known);
            match message {
                Message::Heartbeat(heartbeat)
                    if may_be && heartbeat.autopilot != AUTOPILOT_INVALID =>
                {
                    of.heartbeat = Some((from, *heartbeat));
                }
                _ if !of.heartbeat.is_some_and(is_known) => {}
                Message::MissionCurrent { seq, total, .. } => {
                    of.move_on(now, of.current.is_none());
                    of.current = Some((*seq, *total));
                }
                // One without a fix says 0, 0.
                Message::Flight(FlightMessage::Position(position)) if position.is_known() => {
                    of.move_on(now, of.position.is_none());
                    of.position = Some(*position);
                    of.flown.push((steady_ms(), *position));
                }
                Message::Mission(_) => of.moved = now,
                _ => {}
            }
        }
    }
}
