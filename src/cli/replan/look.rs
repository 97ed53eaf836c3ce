//! What every vehicle holds, and where it is. Only asked for: nothing on board is changed.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use super::failed;
use crate::cli::fly::Sorties;
use crate::cli::print::failure::Failure;
use crate::cli::transfer::delivery;
use crate::link::{
    Address, Arrival, Command, FlightMessage, Heartbeat, Links, Message, Onboard, Position,
    Reading, Time,
};

/// How long the vehicles are listened to before it is given up, milliseconds.
const LISTENING_MS: u64 = 10_000;
/// Between two requests for position and item at work, milliseconds.
const REQUEST_MS: u64 = 100;
/// Messages that are asked for: `GLOBAL_POSITION_INT` and `MISSION_CURRENT`.
const WANTED: [f32; 2] = [33.0, 42.0];

/// One vehicle as it is now.
pub(super) struct Seen {
    pub(super) address: Address,
    pub(super) beat: Heartbeat,
    pub(super) position: Position,
    /// Where it said to be since the command began, and when, milliseconds since 1970.
    pub(super) flown: Vec<(u64, Position)>,
    /// Sequence number of the item it flies to.
    pub(super) seq: u16,
    pub(super) onboard: Onboard,
}

/// All of them at one time.
pub(super) struct Sight {
    pub(super) vehicles: BTreeMap<usize, Seen>,
    /// When, milliseconds since 1970.
    pub(super) unix_ms: u64,
    /// Since when, on the command's own clock, seconds.
    pub(super) at_s: f64,
    /// How long it took to read what they hold, seconds.
    pub(super) reading_s: f64,
}

/// Since the command began.
pub(super) struct Clock(Instant);

impl Clock {
    pub(super) fn start() -> Self {
        #[allow(
            clippy::disallowed_methods,
            reason = "vehicles fly in real time; the machines get it as a value"
        )]
        let began = Instant::now();
        Self(began)
    }

    pub(super) fn now(&self) -> Time {
        Time(u64::try_from(self.0.elapsed().as_millis()).unwrap_or(u64::MAX))
    }

    pub(super) fn seconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
}

/// What is known of one vehicle so far.
struct Looking {
    reading: Reading,
    beat: Option<(Address, Heartbeat)>,
    position: Option<Position>,
    flown: Vec<(u64, Position)>,
    seq: Option<u16>,
}

/// Everything of every vehicle.
pub(super) struct Look<'a> {
    open: &'a Links,
    clock: &'a Clock,
    sorties: &'a Sorties,
    vehicles: BTreeMap<usize, Looking>,
    reading_s: f64,
}

impl<'a> Look<'a> {
    /// Reads what every vehicle holds.
    pub(super) fn read(
        open: &'a Links,
        clock: &'a Clock,
        sorties: &'a Sorties,
    ) -> Result<Self, Failure> {
        let fleet = &sorties.file.spec.vehicles;
        let missions = sorties.missions.iter();
        let vehicles = missions.map(|(index, _)| {
            let reading = Reading::new(Some(fleet[*index].sysid), open.us(), clock.now());
            let found = Looking {
                reading,
                beat: None,
                position: None,
                flown: Vec::new(),
                seq: None,
            };
            (*index, found)
        });
        let mut look = Self {
            open,
            clock,
            sorties,
            vehicles: vehicles.collect(),
            reading_s: 0.0,
        };
        let began_s = clock.seconds();
        look.listen_until(|of| of.reading.outcome().is_some() && of.beat.is_some())?;
        look.reading_s = clock.seconds() - began_s;
        Ok(look)
    }

    /// Where every vehicle is now.
    pub(super) fn sight(&mut self) -> Result<Sight, Failure> {
        for of in self.vehicles.values_mut() {
            (of.position, of.seq) = (None, None);
        }
        self.listen_until(|of| of.position.is_some() && of.seq.is_some())?;
        let (unix_ms, at_s) = (delivery::milliseconds_since_1970(), self.clock.seconds());
        let mut vehicles = BTreeMap::new();
        for (index, of) in &self.vehicles {
            let (address, beat) = of.beat.ok_or_else(|| self.silent(*index))?;
            let Some(Ok(onboard)) = of.reading.outcome() else {
                return Err(self.silent(*index));
            };
            let seen = Seen {
                address,
                beat,
                position: of.position.ok_or_else(|| self.silent(*index))?,
                flown: of.flown.clone(),
                seq: of.seq.ok_or_else(|| self.silent(*index))?,
                onboard: onboard.clone(),
            };
            vehicles.insert(*index, seen);
        }
        Ok(Sight {
            vehicles,
            unix_ms,
            at_s,
            reading_s: self.reading_s,
        })
    }

    fn id(&self, index: usize) -> &str {
        &self.sorties.file.spec.vehicles[index].id
    }

    fn silent(&self, index: usize) -> Failure {
        let id = self.id(index);
        failed(format!("{id}: does not say where it is; nothing was sent"))
    }

    fn listen_until(&mut self, is_known: fn(&Looking) -> bool) -> Result<(), Failure> {
        let began = self.clock.now();
        let mut requested: Option<Time> = None;
        while !self.vehicles.values().all(is_known) {
            let now = self.clock.now();
            if now - began > LISTENING_MS {
                let mut late = self.vehicles.iter().filter(|(_, of)| !is_known(of));
                return Err(late.next().map_or_else(
                    || failed("nobody was heard; nothing was sent"),
                    |(index, _)| self.silent(*index),
                ));
            }
            if requested.is_none_or(|at| now - at >= REQUEST_MS) {
                requested = Some(now);
                self.request();
            }
            self.work(now)?;
            let mut arrival = self.open.receive(Duration::from_millis(5));
            for _ in 0..1000 {
                let Some(Arrival::Message(link, from, message)) = arrival else {
                    break;
                };
                self.hear((link, from), &message);
                arrival = self.open.receive(Duration::ZERO);
            }
        }
        Ok(())
    }

    /// Asks once for what an autopilot does not tell everybody by itself.
    fn request(&self) {
        for of in self.vehicles.values() {
            let Some((target, _)) = of.beat else { continue };
            for id in WANTED {
                let order = Command::new(Command::REQUEST_MESSAGE, [id]);
                let message = FlightMessage::Command { target, order };
                self.open.send(target.system, Message::Flight(message));
            }
        }
    }

    fn work(&mut self, now: Time) -> Result<(), Failure> {
        let fleet = &self.sorties.file.spec.vehicles;
        for (index, of) in &mut self.vehicles {
            of.reading.handle_timeout(now);
            while let Some(message) = of.reading.poll_transmit() {
                self.open.send(fleet[*index].sysid, message);
            }
            if let Some(Err(failure)) = of.reading.outcome() {
                let message = format!("{}: {failure}; nothing was sent", fleet[*index].id);
                return Err(failed(message));
            }
        }
        Ok(())
    }

    fn hear(&mut self, (link, from): (usize, Address), message: &Message) {
        let now = self.clock.now();
        for (index, of) in &mut self.vehicles {
            let system = self.sorties.file.spec.vehicles[*index].sysid;
            if self.open.number(system) != Some(link) {
                continue;
            }
            of.reading.handle(now, from, message);
            if from.system != system {
                continue;
            }
            match message {
                Message::Heartbeat(beat) if from.component == 1 || of.beat.is_none() => {
                    of.beat = Some((from, *beat));
                }
                Message::MissionCurrent { seq, .. } => of.seq = Some(*seq),
                Message::Flight(FlightMessage::Position(position)) => {
                    of.position = Some(*position);
                    if position.is_known() {
                        of.flown
                            .push((delivery::milliseconds_since_1970(), *position));
                    }
                }
                _ => {}
            }
        }
    }
}
