//! The parameters that the verdict assumes, against those of the vehicle.

mod assumed;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

pub(in crate::flight) use assumed::ParameterMismatch;
use assumed::{Assumed, is_same};

use crate::autopilot::other_name;
use crate::link::{Address, FlightMessage, Message, ParamValue, Time};
use crate::mission::VehicleMission;

/// Time between two requests for one parameter, milliseconds. On a slow link its round trip is added, and counts up to
/// the second figure.
const REPEAT_MS: u64 = 400;
const LONGEST_MS: u64 = 15_000;
/// Requests before a parameter counts as unknown to the vehicle.
const MAX: u8 = 6;

/// Parameters that are requested ahead of the one that is awaited: over a slow link one after the other takes long.
const AHEAD: usize = 8;
/// In flight one parameter after the other is read again, each after this time, milliseconds: not every autopilot says
/// that one was set.
const IN_FLIGHT_MS: u64 = 2000;

/// A parameter that the vehicle says to be another one is read again as often, after it was checked.
const READ_AGAIN: u8 = 3;

/// One parameter after the other, read and, if requested, set.
#[derive(Clone, Debug)]
pub(crate) struct SettingsCheck<'a> {
    /// Those of the plan come last: a vehicle may not have others, and they are read meanwhile.
    assumed: Vec<Assumed<'a>>,
    at: usize,
    /// The first that was not requested ahead, and what came of those that were, by the place in `assumed`.
    ahead: usize,
    early: BTreeMap<usize, (String, ParamValue)>,
    due: Time,
    requested: u8,
    /// Between two requests, milliseconds.
    repeat_ms: u64,
    /// Whether a difference is set right.
    set: bool,
    /// Whether one was: then all are read again, because an autopilot may limit one by another.
    is_changed: bool,
    /// What is being set, under the name that the vehicle has for it.
    setting: Option<(String, ParamValue)>,
    bytewise: bool,
    /// Names that the vehicle does not have.
    unknown: Vec<&'a str>,
    /// Whether one that a vehicle may not have did not come, and those after it were requested as often.
    none_comes: bool,
    differences: Vec<String>,
    /// What differed when it was read, by the place in `assumed`.
    accepted: BTreeMap<usize, ParameterMismatch>,
    /// What the vehicle says to be other than when it was read.
    others: BTreeMap<usize, ParameterMismatch>,
    /// What was sent to be set: its name, and the values before and after, in its unit.
    sent: Vec<(String, f32, f32)>,
    /// The one that is read again next in flight, and when.
    looked: usize,
    look_due: Time,
}

impl<'a> SettingsCheck<'a> {
    /// Begins with the first. PX4 sends whole numbers byte by byte (`bytewise`).
    pub(crate) fn new(mission: &'a VehicleMission, set: bool, bytewise: bool, now: Time) -> Self {
        Self::of(Assumed::all_of(mission), set, bytewise, now)
    }

    fn of(assumed: Vec<Assumed<'a>>, set: bool, bytewise: bool, now: Time) -> Self {
        Self {
            assumed,
            at: 0,
            ahead: 0,
            early: BTreeMap::new(),
            due: now,
            requested: 0,
            repeat_ms: REPEAT_MS,
            set,
            is_changed: false,
            setting: None,
            bytewise,
            unknown: Vec::new(),
            none_comes: false,
            differences: Vec::new(),
            accepted: BTreeMap::new(),
            others: BTreeMap::new(),
            sent: Vec::new(),
            looked: 0,
            look_due: now,
        }
    }

    /// Of a vehicle in flight, which was checked before.
    pub(crate) fn of_flight(mission: &'a VehicleMission, bytewise: bool, now: Time) -> Self {
        let all = Self::new(mission, false, bytewise, now);
        let at = all.assumed.len();
        Self { at, ..all }
    }

    /// Takes in the round trip of the link, milliseconds.
    pub(crate) fn take_round_trip(&mut self, round_trip_ms: u64) {
        self.repeat_ms = match round_trip_ms > REPEAT_MS {
            true => REPEAT_MS + round_trip_ms.min(LONGEST_MS),
            false => REPEAT_MS,
        };
    }

    /// The parameter that is awaited, and how far the reading has come.
    pub(crate) fn awaited(&self) -> Option<String> {
        let name = self.assumed.get(self.at)?.name();
        let (at, all) = (self.at, self.assumed.len());
        Some(format!("parameter {name} ({at} of {all} are read)"))
    }

    /// Nothing more is read or set.
    pub(crate) fn stop(&mut self) {
        (self.at, self.setting) = (self.assumed.len(), None);
    }

    /// What was sent to be set, in words; nothing where nothing was.
    pub(crate) fn was_set(&self) -> Option<String> {
        let words = |(name, from, to): &(String, f32, f32)| format!("{name} from {from} to {to}");
        let all: Vec<String> = self.sent.iter().map(words).collect();
        (!all.is_empty()).then(|| format!("was set, and stays so: {}", all.join(", ")))
    }

    /// What the vehicle has said to be other than when it was read, for as long as this, milliseconds.
    pub(in crate::flight) fn others(&self, now: Time, for_ms: u64) -> Vec<ParameterMismatch> {
        let lasting = |of: &&ParameterMismatch| now - of.since >= for_ms;
        self.others.values().filter(lasting).cloned().collect()
    }

    /// What of the return differs, or did when it was read.
    pub(in crate::flight) fn other_of_return(&self) -> Option<&ParameterMismatch> {
        let mut all = self.others.values().chain(self.accepted.values());
        all.find(|of| of.is_of_return())
    }

    /// Takes in a parameter that was read before.
    fn heard_again(&mut self, now: Time, name: &str, value: f32) {
        let place = |is: &dyn Fn(&Assumed<'_>) -> bool| self.assumed.iter().position(is);
        let by_name = place(&|assumed| assumed.name() == name);
        let found = by_name.or_else(|| place(&|assumed| assumed.is_named(name)));
        let Some(at) = found.filter(|at| *at < self.at) else {
            return;
        };
        let assumed = self.assumed[at];
        let accepted = self.accepted.get(&at);
        let is_known = accepted.is_some_and(|of| of.name == name && is_same(value, of.value));
        if is_known || assumed.suffices(name, value) {
            self.others.remove(&at);
            return;
        }
        let new = || ParameterMismatch::new(assumed, name, value, now);
        let other = self.others.entry(at).or_insert_with(new);
        (other.name, other.value, other.assumed) = (name.to_owned(), value, assumed.value(name));
    }

    /// Reads again what was said to be another one: an old answer may have come late.
    fn read_again(&mut self, now: Time, target: Address) -> Option<Message> {
        let is_due = |of: &&mut ParameterMismatch| of.read < READ_AGAIN && now >= of.due;
        let other = self.others.values_mut().find(is_due)?;
        (other.read, other.due) = (other.read + 1, now + REPEAT_MS);
        Some(read(target, &other.name))
    }

    /// Every difference in a sentence, once all were read.
    pub(crate) fn outcome(&self) -> Option<&[String]> {
        (self.at >= self.assumed.len()).then_some(&self.differences)
    }

    /// Takes in a parameter of the vehicle.
    pub(crate) fn heard(&mut self, now: Time, name: &str, held: ParamValue) {
        let value = held.value(self.bytewise);
        let at_work = self.assumed.get(self.at).copied();
        let Some(assumed) = at_work.filter(|assumed| assumed.is_named(name)) else {
            self.heard_early(name, held);
            return self.heard_again(now, name, value);
        };
        if assumed.suffices(name, value) {
            self.others.remove(&self.at);
            return self.next(now);
        }
        match assumed.planned(name).filter(|_| self.set) {
            Some(planned) if self.setting.is_none() => {
                self.setting = Some((name.to_owned(), held.with(planned, self.bytewise)));
                self.sent.push((name.to_owned(), value, planned));
                (self.due, self.requested, self.is_changed) = (now, 0, true);
                self.early.clear();
            }
            Some(_) => {}
            None => {
                self.differences.push(assumed.difference(name, value));
                let read = ParameterMismatch {
                    read: READ_AGAIN,
                    ..ParameterMismatch::new(assumed, name, value, now)
                };
                self.accepted.insert(self.at, read);
                self.next(now);
            }
        }
    }

    /// Takes in one that was requested ahead.
    fn heard_early(&mut self, name: &str, held: ParamValue) {
        if self.is_changed {
            return;
        }
        let range = (self.at + 1).min(self.ahead)..self.ahead;
        let mut awaited = range.filter(|at| self.assumed[*at].is_named(name));
        if let Some(at) = awaited.next() {
            self.early.insert(at, (name.to_owned(), held));
        }
    }

    /// Requests those that come next, under each of their names, once.
    pub(crate) fn poll_ahead(&mut self, target: Address) -> Vec<Message> {
        let until = (self.at + AHEAD).min(self.assumed.len());
        // The first is requested in its turn, and again until it comes.
        let from = self.ahead.max(self.at + 1).min(until);
        // What is set may change others.
        if self.at >= self.assumed.len() || self.is_changed {
            return Vec::new();
        }
        self.ahead = until.max(self.ahead);
        let range = from..until;
        let missing = range.filter(|at| !self.early.contains_key(at));
        let names = missing.flat_map(|at| self.assumed[at].names());
        names.map(|name| read(target, name)).collect()
    }

    /// Reads the next one again in flight.
    pub(crate) fn look_again(&mut self, now: Time, target: Address) -> Vec<Message> {
        if now < self.look_due || self.at < self.assumed.len() || self.assumed.is_empty() {
            return Vec::new();
        }
        self.look_due = now + IN_FLIGHT_MS;
        self.looked = (self.looked + 1) % self.assumed.len();
        // A vehicle knows one of the names.
        let names = self.assumed[self.looked].names();
        names.map(|name| read(target, name)).collect()
    }

    /// The message that is due, if any.
    pub(crate) fn poll(&mut self, now: Time, target: Address) -> Option<Message> {
        let Some(assumed) = self.assumed.get(self.at).copied() else {
            return self.read_again(now, target);
        };
        if now < self.due {
            return None;
        }
        let other = other_name(assumed.name());
        let names = 1 + u8::from(other.is_some());
        let is_over = self.none_comes && assumed.is_optional();
        if is_over || self.requested >= MAX * names {
            self.give_up(assumed);
            self.next(now);
            return self.poll(now, target);
        }
        // A vehicle knows one of the names, by its version: they take turns.
        let turn = other.filter(|_| self.requested % 2 == 1);
        self.requested += 1;
        self.due = now + self.repeat_ms;
        if assumed.is_optional() {
            // Those that come next are requested as often: a vehicle may have none of them.
            self.ahead = self.at + 1;
        }
        Some(match self.setting.clone() {
            Some((name, value)) => Message::Flight(FlightMessage::ParamSet {
                target,
                name,
                value,
            }),
            None => read(target, turn.unwrap_or(assumed.name())),
        })
    }

    /// The vehicle does not have the parameter at work, or does not take it.
    fn give_up(&mut self, assumed: Assumed<'a>) {
        let Assumed::Planned(planned) = assumed else {
            self.none_comes = true;
            self.unknown.push(assumed.name());
            return;
        };
        if let Some((set, _)) = &self.setting {
            // As far as it says, nothing was set.
            self.sent.retain(|(name, ..)| name != set);
            self.differences.push(format!(
                "parameter {} does not take {}",
                planned.name, planned.value
            ));
            return;
        }
        if !self.has_another_name(&planned.name) {
            self.differences.push(format!(
                "parameter {} is not known to the vehicle, the verdict assumes {} ({})",
                planned.name, planned.value, planned.why
            ));
        }
        self.unknown.push(&planned.name);
    }

    /// Whether the vehicle reported, or will be asked for, the same parameter under its other name.
    fn has_another_name(&self, name: &str) -> bool {
        other_name(name).is_some_and(|other| {
            self.assumed.iter().any(|assumed| assumed.name() == other)
                && !self.unknown.contains(&other)
        })
    }

    fn next(&mut self, now: Time) {
        self.at += 1;
        (self.requested, self.due, self.setting) = (0, now, None);
        if self.at == self.assumed.len() && self.is_changed && self.differences.is_empty() {
            (self.at, self.set, self.is_changed) = (0, false, false);
            self.ahead = 0;
            self.early.clear();
        }
        // The vehicle has it under another name.
        let at_work = self.assumed.get(self.at);
        if at_work.is_some_and(|assumed| self.unknown.contains(&assumed.name())) {
            return self.next(now);
        }
        if let Some((name, held)) = self.early.remove(&self.at) {
            self.heard(now, &name, held);
        }
    }
}

/// A request for one parameter.
fn read(target: Address, name: &str) -> Message {
    let name = name.to_owned();
    Message::Flight(FlightMessage::ParamRead { target, name })
}
