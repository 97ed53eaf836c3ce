//! What is on board of every vehicle, and where it is. Vehicles are only asked: nothing on board changes.

use std::collections::BTreeMap;
use std::time::Duration;

use crate::flight::clock::{Clock, unix_ms};
use crate::flight::error::FlightError;
use crate::flight::launch::plan::FlightPlan;
use crate::link::{
    AUTOPILOT_INVALID, Address, Arrival, Command, FlightMessage, Heartbeat, Links, Message,
    Onboard, Position, Reading, Time,
};

/// Vehicles that stay silent for this long are given up, milliseconds.
const LISTENING_MS: u64 = 10_000;
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
    pub(super) beat: Heartbeat,
    pub(super) position: Position,
    /// Its positions since the command began, each with its time, milliseconds since 1970.
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
    /// The time, milliseconds since 1970.
    pub(super) unix_ms: u64,
    /// The same on the clock of the command, seconds.
    pub(super) at_s: f64,
    /// Time that reading all lists took, seconds.
    pub(super) reading_s: f64,
}

/// What is known of one vehicle so far.
struct Known {
    reading: Reading,
    beat: Option<(Address, Heartbeat)>,
    position: Option<Position>,
    flown: Vec<(u64, Position)>,
    /// Its current item, and how many it says to hold.
    current: Option<(u16, u16)>,
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
    pub(super) fn read(
        links: &'a Links,
        clock: &'a Clock,
        plan: &'a FlightPlan,
    ) -> Result<Self, FlightError> {
        let missions = plan.missions.iter();
        let vehicles = missions.map(|(index, _)| {
            let sysid = plan.vehicle(*index).sysid;
            let known = Known {
                reading: Reading::new(Some(sysid), links.us(), clock.now()).in_the_air(),
                beat: None,
                position: None,
                flown: Vec::new(),
                current: None,
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
        observer.listen_until(|of| of.reading.outcome().is_some() && of.beat.is_some())?;
        observer.reading_s = clock.seconds() - began_s;
        Ok(observer)
    }

    /// Observes where every vehicle is now.
    pub(super) fn observe(&mut self) -> Result<Observation, FlightError> {
        for of in self.vehicles.values_mut() {
            (of.position, of.current) = (None, None);
        }
        self.listen_until(|of| of.position.is_some() && of.current.is_some())?;
        let mut observation = Observation {
            vehicles: BTreeMap::new(),
            unix_ms: unix_ms(),
            at_s: self.clock.seconds(),
            reading_s: self.reading_s,
        };
        for (index, of) in &self.vehicles {
            let (Some((address, beat)), Some(position), Some((seq, total)), Some(Ok(onboard))) =
                (of.beat, of.position, of.current, of.reading.outcome())
            else {
                return Err(self.silent(*index));
            };
            let observed = ObservedVehicle {
                address,
                beat,
                position,
                flown: of.flown.clone(),
                seq,
                total,
                onboard: onboard.clone(),
            };
            observation.vehicles.insert(*index, observed);
        }
        Ok(observation)
    }

    fn silent(&self, index: usize) -> FlightError {
        let id = &self.plan.vehicle(index).id;
        FlightError::Transfer(format!("{id}: does not say where it is; nothing was sent"))
    }

    fn listen_until(&mut self, is_known: fn(&Known) -> bool) -> Result<(), FlightError> {
        let began = self.clock.now();
        let mut requested: Option<Time> = None;
        while let Some((late, _)) = self.vehicles.iter().find(|(_, of)| !is_known(of)) {
            let now = self.clock.now();
            if now - began > LISTENING_MS {
                return Err(self.silent(*late));
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
            let Some((target, _)) = of.beat else { continue };
            for id in REQUESTED {
                let order = Command::new(Command::REQUEST_MESSAGE, [id]);
                let message = FlightMessage::Command { target, order };
                self.links.send(target.system, Message::Flight(message));
            }
        }
    }

    fn transfer(&mut self, now: Time) -> Result<(), FlightError> {
        for (index, of) in &mut self.vehicles {
            let vehicle = self.plan.vehicle(*index);
            of.reading.handle_timeout(now);
            while let Some(message) = of.reading.poll_transmit() {
                self.links.send(vehicle.sysid, message);
            }
            if let Some(Err(failure)) = of.reading.outcome() {
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
            let may_be = from.component == 1 || of.beat.is_none_or(is_known);
            match message {
                Message::Heartbeat(beat) if may_be && beat.autopilot != AUTOPILOT_INVALID => {
                    of.beat = Some((from, *beat));
                }
                _ if !of.beat.is_some_and(is_known) => {}
                Message::MissionCurrent { seq, total, .. } => {
                    of.current = Some((*seq, *total));
                }
                Message::Flight(FlightMessage::Position(position)) => {
                    of.position = Some(*position);
                    if position.is_known() {
                        of.flown.push((unix_ms(), *position));
                    }
                }
                _ => {}
            }
        }
    }
}
