//! The whole fleet: none starts unless all are ready; then each at its time, watched to the end.

mod answer;
pub(super) mod arrival;
pub(super) mod clock;
pub(super) mod command;
pub(super) mod diversion;
pub(super) mod driver;
pub(super) mod end;
pub(super) mod modes;
mod monitor;
pub(super) mod orbit;
pub(super) mod start;
pub(super) mod status;
mod takeover;
pub(super) mod vehicle;

use std::collections::VecDeque;

use super::alarms::Alarms;
use super::event::Event;
use super::record::Flown;
use crate::link::{Address, Heartbeat, Message, Time};
use crate::spec::{Action, OnAlarm};
use end::End;
use vehicle::{Assignment, FlightVehicle, Instruction, Stage};

/// Between two looks at everything, milliseconds.
const TICK_MS: u64 = 20;
/// Between two of our heartbeats, milliseconds.
const HEARTBEAT_MS: u64 = 1000;
/// How a fleet is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How much faster than the wall's clock the vehicles' time goes; 1 for real ones.
    pub speedup: f64,
    /// Whether parameters that differ are set.
    pub set_params: bool,
    /// Whether it is flown although parameters, home or place differ.
    pub force: bool,
    /// What is done at alarms.
    pub on_alarm: OnAlarm,
    /// Between two positions of a vehicle in flight, seconds.
    pub position_s: f64,
    /// When it may begin; absent: as soon as all are ready.
    pub launch: Option<start::Launch>,
}

/// What an operator may want in flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Intervention {
    /// Everyone stays where it is.
    Hold,
    /// Everyone lands where it is.
    Land,
    /// Everyone is left to fly on, unwatched.
    Leave,
}

/// How it came out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// None was started; each vehicle that was not ready, and why.
    NotStarted(Vec<(String, String)>),
    /// It was flown: how, the record says.
    Flown,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Checking,
    Arming {
        until: Time,
        /// How often vehicles were armed again because others took longer.
        again: u8,
    },
    /// Nothing is started, and armed vehicles are disarmed.
    Abandoning,
    Flying {
        t0_ms: f64,
    },
    Ended,
}

/// A fleet on its way. Times are milliseconds of the wall's clock.
#[derive(Debug)]
pub struct Fleet<'a> {
    pub(super) vehicles: Vec<FlightVehicle<'a>>,
    pub(super) lost: Vec<bool>,
    pub(super) options: Options,
    phase: Phase,
    heartbeat_due: Time,
    due: Time,
    outbox: VecDeque<(u8, Message)>,
    events: VecDeque<Event>,
    outcome: Option<Outcome>,
    /// Whether all are ready before they may be armed.
    waits: bool,
    /// Why nothing is started.
    refusals: Vec<(String, String)>,
    /// When [`Fleet::handle_timeout`] was last called.
    last: Time,
    /// When vehicles that are not ready are named next.
    awaited_due: Time,
    /// When the flight was taken over, seconds after T0; 0 of one that was not.
    since_s: f64,
    /// The times that this program was stopped for, seconds after T0.
    stops: VecDeque<(f64, f64)>,
    /// Orders that are not recorded yet.
    orders: VecDeque<(f64, String, Action)>,
    us: Address,
    /// What was wrong with the links, and of whom.
    troubles: Vec<(Option<String>, String)>,
    alarms: Option<Alarms<'a>>,
    /// Orders that wait until their way is clear.
    waiting: Vec<answer::Waiting>,
    /// The last order that each vehicle was given at an alarm.
    given: Vec<answer::Waiting>,
}

impl<'a> Fleet<'a> {
    /// Begins to check every vehicle, in the name of `us`.
    #[must_use]
    pub fn new(assignments: Vec<Assignment<'a>>, options: Options, us: Address, now: Time) -> Self {
        let systems: Vec<u8> = assignments.iter().map(|of| of.sysid).collect();
        let vehicles: Vec<FlightVehicle<'a>> = assignments
            .into_iter()
            .map(|of| {
                let others = systems.iter().copied().filter(|id| *id != of.sysid);
                let others = others.collect();
                FlightVehicle::new(of, others, us, (options.set_params, options.force), now)
            })
            .collect();
        Self {
            lost: vec![false; vehicles.len()],
            vehicles,
            options,
            phase: Phase::Checking,
            heartbeat_due: now,
            due: now,
            outbox: VecDeque::new(),
            events: VecDeque::new(),
            outcome: None,
            waits: false,
            refusals: Vec::new(),
            last: now,
            awaited_due: now + start::FIRST_MS,
            since_s: 0.0,
            stops: VecDeque::new(),
            orders: VecDeque::new(),
            troubles: Vec::new(),
            us,
            alarms: None,
            waiting: Vec::new(),
            given: Vec::new(),
        }
    }

    /// Takes in a message that came over a link, from any sender.
    pub fn handle(&mut self, now: Time, (link, from): (usize, Address), message: &Message) {
        for index in 0..self.vehicles.len() {
            if self.vehicles[index].of.link == link {
                self.take(now, index, (from, message));
                self.take_whole_texts(now, index);
            }
        }
    }

    /// Takes in a message that came over the link of a vehicle.
    fn take(&mut self, now: Time, index: usize, (from, message): (Address, &Message)) {
        let clock = (now, self.flight_ms(now), self.t0_ms());
        let vehicle = &mut self.vehicles[index];
        vehicle.handle(clock, from, message);
        if vehicle.is_of_autopilot(from, message) {
            self.hand_over(now, index, message);
        }
    }

    /// The same of its texts that came in pieces.
    fn take_whole_texts(&mut self, now: Time, index: usize) {
        while let Some((from, text)) = self.vehicles[index].texts.chunks.poll(now) {
            self.take(now, index, (from, &text));
        }
    }

    /// Says that something about the links is wrong. On the ground that ends it.
    pub fn trouble(&mut self, now: Time, system: Option<u8>, what: &str) {
        let of =
            |vehicle: &&FlightVehicle<'_>| system.is_none_or(|system| vehicle.of.sysid == system);
        let vehicle = match system {
            Some(_) => self
                .vehicles
                .iter()
                .find(of)
                .map(|c| c.of.vehicle.to_owned()),
            None => None,
        };
        if matches!(self.phase, Phase::Checking | Phase::Arming { .. }) {
            let who = vehicle.clone().unwrap_or_default();
            self.abandon(now, vec![(who, what.to_owned())]);
        }
        // What a system goes on to do is said once: it would hide all else.
        let trouble = (vehicle, what.to_owned());
        if system.is_none() || !self.troubles.contains(&trouble) {
            self.troubles.push(trouble.clone());
            self.say(now, trouble.0, trouble.1);
        }
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Time) {
        self.due = now + TICK_MS;
        self.look_for_a_stop(now);
        if now >= self.heartbeat_due {
            self.heartbeat_due = now + HEARTBEAT_MS;
            for vehicle in &self.vehicles {
                let heartbeat = Message::Heartbeat(Heartbeat::OURS);
                self.outbox.push_back((vehicle.of.sysid, heartbeat));
            }
        }
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a few hundred thousand microseconds"
        )]
        let interval_us = (self.options.position_s * 1e6) as f32;
        for index in 0..self.vehicles.len() {
            self.take_whole_texts(now, index);
        }
        // Before an order is repeated.
        self.judge_returns_again(now);
        for vehicle in &mut self.vehicles {
            vehicle.tick(now, interval_us);
        }
        match self.phase {
            Phase::Checking => {
                self.say_who_is_awaited(now);
                self.look_whether_all_are_ready(now);
            }
            Phase::Arming { until, again } => self.look_whether_all_are_armed(now, until, again),
            Phase::Abandoning => self.look_whether_all_are_disarmed(),
            Phase::Flying { t0_ms } => self.watch(now, t0_ms),
            Phase::Ended => {}
        }
        self.gather(now);
    }

    /// The next message to send, and to which system.
    pub fn poll_transmit(&mut self) -> Option<(u8, Message)> {
        self.outbox.pop_front()
    }

    /// When [`Fleet::handle_timeout`] is due.
    #[must_use]
    pub fn poll_timeout(&self) -> Time {
        self.due
    }

    /// The next thing to read.
    pub fn poll_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// How it came out, once it is over.
    #[must_use]
    pub fn outcome(&self) -> Option<&Outcome> {
        self.outcome.as_ref()
    }

    /// What each vehicle has flown so far, in the order of the assignments.
    pub fn flown(&self) -> impl Iterator<Item = (&str, &Flown)> {
        let of = |vehicle: &'_ FlightVehicle<'a>| vehicle.of.vehicle;
        self.vehicles.iter().map(move |c| (of(c), &c.flown))
    }

    /// Seconds after T0, once there is one.
    #[must_use]
    pub fn t_s(&self, now: Time) -> Option<f64> {
        self.t0_ms().map(|t0| (self.flight_ms(now) - t0) / 1000.0)
    }

    /// Passes an intervention to every vehicle in flight.
    pub fn intervene(&mut self, now: Time, what: Intervention) {
        let instruction = match what {
            Intervention::Hold => Instruction::Hold,
            Intervention::Land => Instruction::Land,
            Intervention::Leave => {
                if matches!(self.phase, Phase::Abandoning) {
                    let vehicles = self.vehicles.iter_mut();
                    return vehicles.for_each(FlightVehicle::stop_disarming);
                }
                if !matches!(self.phase, Phase::Flying { .. }) {
                    return self.abandon(now, Vec::new());
                }
                for (vehicle, is_lost) in self.vehicles.iter_mut().zip(&self.lost) {
                    if !matches!(vehicle.stage, Stage::Ended) {
                        vehicle.watch_no_more(End::LeftFlying, *is_lost);
                    }
                }
                return;
            }
        };
        if !matches!(self.phase, Phase::Flying { .. }) {
            return self.abandon(now, Vec::new());
        }
        self.waiting.clear();
        self.instruct_all(now, instruction);
    }

    /// Orders every vehicle in flight to hold or to land, whatever it was ordered before.
    fn instruct_all(&mut self, now: Time, instruction: Instruction) {
        self.say(now, None, format!("all {}", instruction.verb()));
        for vehicle in &mut self.vehicles {
            // A vehicle that has not taken off stays on the ground.
            if matches!(vehicle.stage, Stage::Armed) {
                vehicle.disarm(None);
            }
            if !vehicle.stays_on_ground(instruction) {
                vehicle.instruct(instruction);
            }
        }
        for (vehicle, why) in self.circles_not_clear(now, instruction) {
            let text = format!("is ordered to hold although {why}");
            self.say(now, Some(vehicle), text);
        }
    }

    fn flight_ms(&self, now: Time) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "milliseconds of one flight")]
        let wall_ms = now.0 as f64;
        wall_ms * self.options.speedup
    }

    fn t0_ms(&self) -> Option<f64> {
        match self.phase {
            Phase::Flying { t0_ms } => Some(t0_ms),
            _ => None,
        }
    }

    fn say(&mut self, now: Time, vehicle: Option<String>, text: String) {
        let t_s = self.t_s(now);
        self.events.push_back(Event::new(t_s, vehicle, text));
    }

    /// What the vehicles have to send and to say.
    fn gather(&mut self, now: Time) {
        let (t_s, flight_ms, t0_ms) = (self.t_s(now), self.flight_ms(now), self.t0_ms());
        for vehicle in &mut self.vehicles {
            while let Some(message) = vehicle.poll_transmit() {
                self.outbox.push_back((vehicle.of.sysid, message));
            }
            let ordered = vehicle
                .instruction
                .map_or(Action::Continue, Instruction::action);
            if let Some(t_s) = t_s.filter(|_| vehicle.is_watched())
                && vehicle.flown.ordered != ordered
            {
                let id = vehicle.of.vehicle.to_owned();
                vehicle.flown.take_order(ordered, t_s);
                self.orders.push_back((t_s, id, ordered));
            }
            if matches!(vehicle.stage, Stage::Ended) {
                let ended_s = t0_ms.map(|_| vehicle.sent_s(flight_ms, t0_ms));
                vehicle.flown.until_s = vehicle.flown.until_s.or(ended_s);
            }
            if let Some(text) = vehicle
                .still_armed
                .as_ref()
                .filter(|_| !vehicle.motors.is_warned)
            {
                vehicle.motors.is_warned = true;
                let (vehicle, text) = (None, text.clone());
                self.events.push_back(Event::new(t_s, vehicle, text));
            }
            while let Some(text) = vehicle.poll_news() {
                let vehicle = Some(vehicle.of.vehicle.to_owned());
                self.events.push_back(Event::new(t_s, vehicle, text));
            }
        }
    }

    /// The next order, for the record.
    pub(super) fn poll_order(&mut self) -> Option<(f64, String, Action)> {
        self.orders.pop_front()
    }

    /// The next time that this program was stopped for: from, until, seconds after T0.
    pub(super) fn poll_stop(&mut self) -> Option<(f64, f64)> {
        self.stops.pop_front()
    }
}
