//! The parameters that the verdict assumes, against those of the vehicle.

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use crate::autopilot::{in_unit_of, other_name};
use crate::link::{Address, FlightMessage, Message, ParamValue, Time};
use crate::mission::{Parameter, is_lean_limit};

/// Time between two requests for one parameter, milliseconds. On a slow link its round trip is added, and counts up to
/// the second figure.
const REPEAT_MS: u64 = 400;
const LONGEST_MS: u64 = 15_000;
/// Requests before a parameter counts as unknown to the vehicle.
const MOST: u8 = 6;

/// Parameters that are requested ahead of the one that is awaited: over a slow link one after the other takes long.
const AHEAD: usize = 8;
/// In flight one parameter after the other is read again, each after this time, milliseconds: not every autopilot says
/// that one was set.
const IN_FLIGHT_MS: u64 = 2000;

/// A parameter that the vehicle says to be another one is read again as often, after it was checked.
const READ_AGAIN: u8 = 3;

/// A parameter that the vehicle says to have another value than the verdict assumes.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::flight) struct OtherSetting {
    /// As the vehicle names it.
    pub(in crate::flight) name: String,
    /// In its unit.
    pub(in crate::flight) value: f32,
    pub(in crate::flight) planned: f32,
    /// When it was first said to be another one.
    since: Time,
    /// How often it was read again since then, and when it is next.
    read: u8,
    due: Time,
}

/// One parameter after the other, read and, if requested, set.
#[derive(Clone, Debug)]
pub(crate) struct SettingsCheck<'a> {
    planned: &'a [Parameter],
    at: usize,
    /// The first that was not requested ahead, and what came of those that were, by the place in `planned`.
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
    differences: Vec<String>,
    /// What differed when it was read, by the place in `planned`.
    accepted: BTreeMap<usize, OtherSetting>,
    /// What the vehicle says to be other than when it was read.
    others: BTreeMap<usize, OtherSetting>,
    /// What was sent to be set: its name, and the values before and after, in its unit.
    sent: Vec<(String, f32, f32)>,
    /// The one that is read again next in flight, and when.
    looked: usize,
    look_due: Time,
}

impl<'a> SettingsCheck<'a> {
    /// Begins with the first. PX4 sends whole numbers byte by byte (`bytewise`).
    pub(crate) fn new(planned: &'a [Parameter], set: bool, bytewise: bool, now: Time) -> Self {
        Self {
            planned,
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
            differences: Vec::new(),
            accepted: BTreeMap::new(),
            others: BTreeMap::new(),
            sent: Vec::new(),
            looked: 0,
            look_due: now,
        }
    }

    /// Of a vehicle in flight, which was checked before.
    pub(crate) fn of_flight(planned: &'a [Parameter], bytewise: bool, now: Time) -> Self {
        let at = planned.len();
        Self {
            at,
            ..Self::new(planned, false, bytewise, now)
        }
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
        let name = &self.planned.get(self.at)?.name;
        let (at, all) = (self.at, self.planned.len());
        Some(format!("parameter {name} ({at} of {all} are read)"))
    }

    /// Nothing more is read or set.
    pub(crate) fn stop(&mut self) {
        (self.at, self.setting) = (self.planned.len(), None);
    }

    /// What was sent to be set, in words; nothing where nothing was.
    pub(crate) fn was_set(&self) -> Option<String> {
        let words = |(name, from, to): &(String, f32, f32)| format!("{name} from {from} to {to}");
        let all: Vec<String> = self.sent.iter().map(words).collect();
        (!all.is_empty()).then(|| format!("was set, and stays so: {}", all.join(", ")))
    }

    /// What the vehicle has said to be other than when it was read, for as long as this, milliseconds.
    pub(in crate::flight) fn others(&self, now: Time, for_ms: u64) -> Vec<OtherSetting> {
        let lasting = |of: &&OtherSetting| now - of.since >= for_ms;
        self.others.values().filter(lasting).cloned().collect()
    }

    /// What of the return differs, or did when it was read.
    pub(in crate::flight) fn other_of_return(&self) -> Option<&OtherSetting> {
        let mut all = self.others.values().chain(self.accepted.values());
        all.find(|of| of.is_of_return())
    }

    /// Takes in a parameter that was read before.
    fn heard_again(&mut self, now: Time, name: &str, value: f32) {
        let place = |is: &dyn Fn(&Parameter) -> bool| self.planned.iter().position(is);
        let by_name = place(&|planned| planned.name == name);
        let found = by_name.or_else(|| place(&|planned| is_name_of(name, planned)));
        let Some(at) = found.filter(|at| *at < self.at) else {
            return;
        };
        let planned = value_as(&self.planned[at], name);
        let accepted = self.accepted.get(&at);
        let is_known = accepted.is_some_and(|of| of.name == name && is_same(value, of.value));
        if is_known || suffices(name, value, planned) {
            self.others.remove(&at);
            return;
        }
        let other = self.others.entry(at).or_insert_with(|| OtherSetting {
            name: name.to_owned(),
            value,
            planned,
            since: now,
            read: 0,
            due: now,
        });
        (other.name, other.value, other.planned) = (name.to_owned(), value, planned);
    }

    /// Reads again what was said to be another one: an old answer may have come late.
    fn read_again(&mut self, now: Time, target: Address) -> Option<Message> {
        let is_due = |of: &&mut OtherSetting| of.read < READ_AGAIN && now >= of.due;
        let other = self.others.values_mut().find(is_due)?;
        (other.read, other.due) = (other.read + 1, now + REPEAT_MS);
        let name = other.name.clone();
        Some(Message::Flight(FlightMessage::ParamRead { target, name }))
    }

    /// Every difference in a sentence, once all were read.
    pub(crate) fn outcome(&self) -> Option<&[String]> {
        (self.at >= self.planned.len()).then_some(&self.differences)
    }

    /// Takes in a parameter of the vehicle.
    pub(crate) fn heard(&mut self, now: Time, name: &str, held: ParamValue) {
        let value = held.value(self.bytewise);
        let at_work = self.planned.get(self.at);
        let Some(planned) = at_work.filter(|planned| is_name_of(name, planned)) else {
            self.heard_early(name, held);
            return self.heard_again(now, name, value);
        };
        let planned_value = value_as(planned, name);
        if suffices(name, value, planned_value) {
            self.others.remove(&self.at);
            return self.next(now);
        }
        if self.set && self.setting.is_none() {
            self.setting = Some((name.to_owned(), held.with(planned_value, self.bytewise)));
            self.sent.push((name.to_owned(), value, planned_value));
            (self.due, self.requested, self.is_changed) = (now, 0, true);
            self.early.clear();
        } else if !self.set {
            self.differences.push(format!(
                "parameter {name} is {value}, the verdict assumes {planned_value} ({})",
                planned.why
            ));
            let other = OtherSetting {
                name: name.to_owned(),
                value,
                planned: planned_value,
                since: now,
                read: READ_AGAIN,
                due: now,
            };
            self.accepted.insert(self.at, other);
            self.next(now);
        }
    }

    /// Takes in one that was requested ahead.
    fn heard_early(&mut self, name: &str, held: ParamValue) {
        if self.is_changed {
            return;
        }
        let range = (self.at + 1).min(self.ahead)..self.ahead;
        let mut awaited = range.filter(|at| is_name_of(name, &self.planned[*at]));
        if let Some(at) = awaited.next() {
            self.early.insert(at, (name.to_owned(), held));
        }
    }

    /// Requests those that come next, under each of their names, once.
    pub(crate) fn poll_ahead(&mut self, target: Address) -> Vec<Message> {
        let until = (self.at + AHEAD).min(self.planned.len());
        // The first is requested in its turn, and again until it comes.
        let from = self.ahead.max(self.at + 1).min(until);
        // What is set may change others.
        if self.at >= self.planned.len() || self.is_changed {
            return Vec::new();
        }
        self.ahead = until.max(self.ahead);
        let names = self.planned[from..until].iter().flat_map(|planned| {
            let other = other_name(&planned.name).map(str::to_owned);
            std::iter::once(planned.name.clone()).chain(other)
        });
        let read = |name| Message::Flight(FlightMessage::ParamRead { target, name });
        names.map(read).collect()
    }

    /// Reads the next one again in flight.
    pub(crate) fn look_again(&mut self, now: Time, target: Address) -> Vec<Message> {
        if now < self.look_due || self.at < self.planned.len() || self.planned.is_empty() {
            return Vec::new();
        }
        self.look_due = now + IN_FLIGHT_MS;
        self.looked = (self.looked + 1) % self.planned.len();
        let planned = &self.planned[self.looked].name;
        // A vehicle knows one of the names.
        let names = std::iter::once(planned.as_str()).chain(other_name(planned));
        let read = |name: &str| {
            let name = name.to_owned();
            Message::Flight(FlightMessage::ParamRead { target, name })
        };
        names.map(read).collect()
    }

    /// The message that is due, if any.
    pub(crate) fn poll(&mut self, now: Time, target: Address) -> Option<Message> {
        let Some(planned) = self.planned.get(self.at) else {
            return self.read_again(now, target);
        };
        if now < self.due {
            return None;
        }
        let other = other_name(&planned.name);
        let names = 1 + u8::from(other.is_some());
        if self.requested >= MOST * names {
            if self.setting.is_some() {
                self.differences.push(format!(
                    "parameter {} does not take {}",
                    planned.name, planned.value
                ));
            } else if !self.has_another_name(&planned.name) {
                self.differences.push(format!(
                    "parameter {} is not known to the vehicle, the verdict assumes {} ({})",
                    planned.name, planned.value, planned.why
                ));
            }
            if self.setting.is_none() {
                self.unknown.push(&planned.name);
            }
            self.next(now);
            return self.poll(now, target);
        }
        // A vehicle knows one of the names, by its version: they take turns.
        let turn = other.filter(|_| self.requested % 2 == 1);
        self.requested += 1;
        self.due = now + self.repeat_ms;
        Some(Message::Flight(match self.setting.clone() {
            Some((name, value)) => FlightMessage::ParamSet {
                target,
                name,
                value,
            },
            None => FlightMessage::ParamRead {
                target,
                name: turn.unwrap_or(&planned.name).to_owned(),
            },
        }))
    }

    /// Whether the vehicle reported, or will be asked for, the same parameter under its other name.
    fn has_another_name(&self, name: &str) -> bool {
        other_name(name).is_some_and(|other| {
            self.planned.iter().any(|planned| planned.name == other)
                && !self.unknown.contains(&other)
        })
    }

    fn next(&mut self, now: Time) {
        self.at += 1;
        (self.requested, self.due, self.setting) = (0, now, None);
        if self.at == self.planned.len() && self.is_changed && self.differences.is_empty() {
            (self.at, self.set, self.is_changed) = (0, false, false);
            self.ahead = 0;
            self.early.clear();
        }
        // The vehicle has it under another name.
        let at_work = self.planned.get(self.at);
        if at_work.is_some_and(|planned| self.unknown.contains(&planned.name.as_str())) {
            return self.next(now);
        }
        if let Some((name, held)) = self.early.remove(&self.at) {
            self.heard(now, &name, held);
        }
    }
}

impl OtherSetting {
    /// Whether it says how high a vehicle returns, how, or where to.
    fn is_of_return(&self) -> bool {
        self.name.contains("RTL_") || self.name.starts_with("RALLY_")
    }

    /// What an operator reads of it.
    pub(in crate::flight) fn words(&self) -> String {
        format!("{} is {}, planned {}", self.name, self.value, self.planned)
    }

    /// What one who waits for T0 reads of it.
    pub(in crate::flight) fn changed(&self) -> String {
        format!(
            "it says that {} is {} and not {}, after it was checked",
            self.name, self.value, self.planned
        )
    }
}

/// Whether a vehicle has a planned parameter under this name, in whichever version.
fn is_name_of(name: &str, planned: &Parameter) -> bool {
    planned.name == name || other_name(&planned.name) == Some(name)
}

/// The planned value in the unit that the parameter has under this name.
#[expect(
    clippy::cast_possible_truncation,
    reason = "parameters are float32 on the wire"
)]
fn value_as(planned: &Parameter, name: &str) -> f32 {
    match planned.name == name {
        true => planned.value,
        false => in_unit_of(f64::from(planned.value), &planned.name, name) as f32,
    }
}

/// As the verdict assumes it; a greater lean angle is as good.
fn suffices(name: &str, held: f32, planned: f32) -> bool {
    is_same(held, planned) || is_lean_limit(name) && held.is_finite() && held > planned
}

/// Equal as far as a float32 that went through centimetres can be.
fn is_same(a: f32, b: f32) -> bool {
    a.is_finite() && b.is_finite() && (a - b).abs() <= 1e-4 * a.abs().max(b.abs()).max(1.0)
}
