//! The parameters that the verdict assumes, against those of the vehicle.

use std::collections::BTreeMap;

use crate::autopilot::{in_unit_of, other_name};
use crate::link::{Address, FlightMessage, Message, ParamValue, Time};
use crate::mission::{Parameter, is_lean_limit};

/// Between two requests for one parameter, milliseconds.
const REPEAT_MS: u64 = 400;
/// Requests before a parameter counts as unknown to the vehicle.
const MOST: u8 = 6;

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
    due: Time,
    requested: u8,
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
}

impl<'a> SettingsCheck<'a> {
    /// Begins with the first. PX4 sends whole numbers byte by byte (`bytewise`).
    pub(crate) fn new(planned: &'a [Parameter], set: bool, bytewise: bool, now: Time) -> Self {
        Self {
            planned,
            at: 0,
            due: now,
            requested: 0,
            set,
            is_changed: false,
            setting: None,
            bytewise,
            unknown: Vec::new(),
            differences: Vec::new(),
            accepted: BTreeMap::new(),
            others: BTreeMap::new(),
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
            return self.heard_again(now, name, value);
        };
        let planned_value = value_as(planned, name);
        if suffices(name, value, planned_value) {
            self.others.remove(&self.at);
            return self.next(now);
        }
        if self.set && self.setting.is_none() {
            self.setting = Some((name.to_owned(), held.with(planned_value, self.bytewise)));
            (self.due, self.requested, self.is_changed) = (now, 0, true);
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
        self.due = now + REPEAT_MS;
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
        }
        // The vehicle has it under another name.
        let at_work = self.planned.get(self.at);
        if at_work.is_some_and(|planned| self.unknown.contains(&planned.name.as_str())) {
            self.next(now);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks a vehicle that answers by name, and by the value that is set if one is; none where it does
    /// not know the name. The differences, and when all were read.
    fn checked(
        planned: &[(&str, f32)],
        set: bool,
        mut answer: impl FnMut(&str, Option<f32>) -> Option<f32>,
    ) -> (Vec<String>, Time) {
        let planned: Vec<Parameter> = (planned.iter())
            .map(|(name, value)| Parameter {
                name: (*name).to_owned(),
                value: *value,
                why: String::new(),
            })
            .collect();
        let mut now = Time(0);
        let mut check = SettingsCheck::new(&planned, set, false, now);
        let target = Address {
            system: 1,
            component: 1,
        };
        while check.outcome().is_none() {
            let asked = match check.poll(now, target) {
                Some(Message::Flight(FlightMessage::ParamRead { name, .. })) => Some((name, None)),
                Some(Message::Flight(FlightMessage::ParamSet { name, value, .. })) => {
                    Some((name, Some(value.value(false))))
                }
                _ => None,
            };
            let answered = asked.and_then(|(name, value)| Some((answer(&name, value)?, name)));
            if let Some((held, name)) = answered {
                check.heard(now, &name, ParamValue::float(held));
            }
            now = now + REPEAT_MS;
        }
        (check.outcome().unwrap_or_default().to_vec(), now)
    }

    /// The differences that a vehicle is found to have which knows these names alone.
    fn differences(known: &[&str]) -> Vec<String> {
        let planned = ["ALT_SLOPE_MIN", "GLIDE_SLOPE_MIN", "WP_RADIUS"].map(|name| (name, 1.0));
        checked(&planned, false, |name, _| {
            known.contains(&name).then_some(1.0)
        })
        .0
    }

    #[test]
    fn a_parameter_that_goes_back_after_it_was_set_is_a_difference() {
        let planned = [("MPC_Z_V_AUTO_UP", 4.0), ("MPC_Z_VEL_MAX_UP", 4.0)];
        let outcome = |planned: &[(&str, f32)]| {
            // As PX4 does it: a speed that was set is limited when the next message comes.
            let (mut speed, mut greatest) = (3.0, 3.0);
            let answer = |name: &str, set: Option<f32>| {
                speed = f32::min(speed, greatest);
                let held = match name {
                    "MPC_Z_V_AUTO_UP" => &mut speed,
                    _ => &mut greatest,
                };
                *held = set.unwrap_or(*held);
                Some(*held)
            };
            checked(planned, true, answer).0
        };
        let found = outcome(&planned);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].contains("MPC_Z_V_AUTO_UP is 3"), "{found:?}");
        let in_order = [planned[1], planned[0]];
        assert!(outcome(&in_order).is_empty());
    }

    #[test]
    fn a_vehicle_that_may_lean_further_than_the_plan_needs_is_as_good() {
        assert!(suffices("ANGLE_MAX", 4500.0, 3000.0) && suffices("MPC_TILTMAX_AIR", 50.0, 45.0));
        assert!(!suffices("ANGLE_MAX", 2000.0, 3000.0));
        assert!(!suffices("WPNAV_SPEED", 1100.0, 1000.0));
    }

    #[test]
    fn a_value_that_is_no_number_is_as_planned_of_nothing() {
        for held in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            for name in ["WPNAV_SPEED", "ANGLE_MAX", "FENCE_ENABLE"] {
                assert!(!suffices(name, held, 1000.0), "{name} {held}");
            }
            let found = checked(&[("RTL_ALT", 4000.0)], false, |_, _| Some(held)).0;
            assert_eq!(found.len(), 1, "{found:?}");
        }
    }

    #[test]
    fn a_parameter_that_is_said_to_be_another_one_after_it_was_read_is_named_until_it_is_as_planned()
     {
        let planned = [("WPNAV_SPEED", 1000.0), ("RTL_ALT", 10_600.0)];
        let planned: Vec<Parameter> = (planned.iter())
            .map(|(name, value)| Parameter {
                name: (*name).to_owned(),
                value: *value,
                why: String::new(),
            })
            .collect();
        let mut check = SettingsCheck::new(&planned, false, false, Time(0));
        let says = |check: &mut SettingsCheck<'_>, ms, name: &str, value: f32| {
            check.heard(Time(ms), name, ParamValue::float(value));
            let others = check.others(Time(ms), 0);
            others.iter().map(OtherSetting::words).collect::<Vec<_>>()
        };
        // Not read yet, and of no concern.
        assert!(says(&mut check, 0, "RTL_ALT", 1500.0).is_empty());
        assert!(says(&mut check, 0, "WPNAV_SPEED", 1000.0).is_empty());
        // Read, while another one is at work.
        let speed = says(&mut check, 10, "WPNAV_SPEED", 500.0);
        assert_eq!(speed, ["WPNAV_SPEED is 500, planned 1000"]);
        assert!(says(&mut check, 20, "WPNAV_SPEED", 1000.0).is_empty());
        assert!(says(&mut check, 30, "RTL_ALT", 10_600.0).is_empty());
        assert!(check.outcome().is_some_and(<[String]>::is_empty));
        assert_eq!(check.other_of_return(), None);
        let height = says(&mut check, 100, "RTL_ALT_M", 15.0);
        assert_eq!(height, ["RTL_ALT_M is 15, planned 106"]);
        assert!(check.other_of_return().is_some());
        assert!(check.others(Time(1000), 1000).is_empty());
        assert_eq!(check.others(Time(1100), 1000).len(), 1);
        let target = Address {
            system: 1,
            component: 1,
        };
        let asked = (0..100).filter_map(|n| check.poll(Time(100 + 100 * n), target));
        assert_eq!(asked.count(), usize::from(READ_AGAIN));
        assert!(says(&mut check, 9000, "RTL_ALT_M", 106.0).is_empty());
        assert_eq!(check.other_of_return(), None);
    }

    #[test]
    fn a_difference_that_is_flown_all_the_same_is_no_news_and_may_be_one_of_the_return() {
        let planned = [Parameter {
            name: "RTL_ALT".to_owned(),
            value: 4000.0,
            why: String::new(),
        }];
        let mut check = SettingsCheck::new(&planned, false, false, Time(0));
        check.heard(Time(0), "RTL_ALT", ParamValue::float(1500.0));
        assert_eq!(check.outcome().map(<[String]>::len), Some(1));
        check.heard(Time(10), "RTL_ALT", ParamValue::float(1500.0));
        assert!(check.others(Time(10), 0).is_empty());
        let of_return = check.other_of_return().map(OtherSetting::words);
        assert_eq!(of_return.as_deref(), Some("RTL_ALT is 1500, planned 4000"));
        check.heard(Time(20), "RTL_ALT", ParamValue::float(2000.0));
        assert_eq!(check.others(Time(20), 0).len(), 1);
    }

    /// A vehicle of ArduCopter 4.7, with these of its parameters: what differs, and what is set.
    fn of_4_7(own: &[(&str, f32)], set: bool) -> (Vec<String>, Vec<(String, f32)>, Time) {
        let planned = [
            ("WPNAV_SPEED", 1200.0),
            ("RTL_ALT", 4000.0),
            ("WPNAV_RADIUS", 500.0),
        ];
        let mut own = own.to_vec();
        let mut sets = Vec::new();
        let (differences, until) = checked(&planned, set, |name, value| {
            let held = own.iter_mut().find(|(known, _)| *known == name);
            if let Some(value) = value {
                sets.push((name.to_owned(), value));
                held?.1 = value;
                return Some(value);
            }
            held.map(|(_, value)| *value)
        });
        (differences, sets, until)
    }

    #[test]
    fn parameters_of_arducopter_4_7_are_compared_and_set_under_its_names_in_metres() {
        let as_planned = [("WP_SPD", 12.0), ("RTL_ALT_M", 40.0), ("WP_RADIUS_M", 5.0)];
        let (differences, _, until) = of_4_7(&as_planned, false);
        assert!(differences.is_empty(), "{differences:?}");
        // The second name is asked for after one turn, not after all.
        assert!(until <= Time(8 * REPEAT_MS), "{until:?}");
        let stock = [("WP_SPD", 10.0), ("RTL_ALT_M", 15.0), ("WP_RADIUS_M", 5.0)];
        let (differences, _, _) = of_4_7(&stock, false);
        assert_eq!(differences.len(), 2, "{differences:?}");
        assert!(differences[0].contains("WP_SPD is 10, the verdict assumes 12"));
        let (differences, sets, _) = of_4_7(&stock, true);
        assert!(differences.is_empty(), "{differences:?}");
        let expected = [("WP_SPD".to_owned(), 12.0), ("RTL_ALT_M".to_owned(), 40.0)];
        assert_eq!(sets, expected);
        let (differences, _, _) = of_4_7(&stock[..1], false);
        assert!(
            differences
                .iter()
                .any(|text| text.contains("RTL_ALT is not known"))
        );
    }

    #[test]
    fn a_parameter_with_two_names_is_found_under_either() {
        assert!(differences(&["ALT_SLOPE_MIN", "WP_RADIUS"]).is_empty());
        assert!(differences(&["GLIDE_SLOPE_MIN", "WP_RADIUS"]).is_empty());
        let neither = differences(&["WP_RADIUS"]);
        assert_eq!(neither.len(), 1, "{neither:?}");
        assert!(neither[0].contains("GLIDE_SLOPE_MIN is not known"));
        assert_eq!(differences(&["ALT_SLOPE_MIN", "GLIDE_SLOPE_MIN"]).len(), 1);
    }
}
