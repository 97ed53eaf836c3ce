//! The parameters that the verdict assumes, against those of the vehicle.

use crate::autopilot::other_name;
use crate::link::{Address, FlightMessage, Message, ParamValue, Time};
use crate::mission::{Parameter, is_lean_limit};

/// Between two requests for one parameter, milliseconds.
const REPEAT_MS: u64 = 400;
/// Requests before a parameter counts as unknown to the vehicle.
const MOST: u8 = 6;

/// One parameter after the other, read and, if requested, set.
#[derive(Clone, Debug)]
pub(crate) struct SettingsCheck<'a> {
    planned: &'a [Parameter],
    at: usize,
    due: Time,
    requested: u8,
    /// Whether a difference is set right.
    set: bool,
    /// What is being set.
    setting: Option<ParamValue>,
    bytewise: bool,
    /// Names that the vehicle does not tell.
    unknown: Vec<&'a str>,
    differences: Vec<String>,
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
            setting: None,
            bytewise,
            unknown: Vec::new(),
            differences: Vec::new(),
        }
    }

    /// Every difference in a sentence, once all were read.
    pub(crate) fn outcome(&self) -> Option<&[String]> {
        (self.at >= self.planned.len()).then_some(&self.differences)
    }

    /// Takes in a parameter of the vehicle.
    pub(crate) fn heard(&mut self, now: Time, name: &str, held: ParamValue) {
        let Some(planned) = self.planned.get(self.at).filter(|w| w.name == name) else {
            return;
        };
        let value = held.value(self.bytewise);
        if suffices(name, value, planned.value) {
            return self.next(now);
        }
        if self.set && self.setting.is_none() {
            self.setting = Some(held.with(planned.value, self.bytewise));
            (self.due, self.requested) = (now, 0);
        } else if !self.set {
            self.differences.push(format!(
                "parameter {name} is {value}, the verdict assumes {} ({})",
                planned.value, planned.why
            ));
            self.next(now);
        }
    }

    /// The message that is due, if any.
    pub(crate) fn poll(&mut self, now: Time, target: Address) -> Option<Message> {
        let planned = self.planned.get(self.at)?;
        if now < self.due {
            return None;
        }
        if self.requested >= MOST {
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
        self.requested += 1;
        self.due = now + REPEAT_MS;
        let name = planned.name.clone();
        Some(Message::Flight(match self.setting {
            Some(value) => FlightMessage::ParamSet {
                target,
                name,
                value,
            },
            None => FlightMessage::ParamRead { target, name },
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
    }
}

/// As the verdict assumes it; a greater lean angle is as good.
fn suffices(name: &str, held: f32, planned: f32) -> bool {
    is_same(held, planned) || is_lean_limit(name) && held > planned
}

/// Equal as far as a float32 that went through centimetres can be.
fn is_same(a: f32, b: f32) -> bool {
    (a - b).abs() <= 1e-4 * a.abs().max(b.abs()).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The differences that a vehicle is found to have which knows these names alone.
    fn differences(known: &[&str]) -> Vec<String> {
        let planned = ["ALT_SLOPE_MIN", "GLIDE_SLOPE_MIN", "WP_RADIUS"].map(|name| Parameter {
            name: name.to_owned(),
            value: 1.0,
            why: String::new(),
        });
        let mut now = Time(0);
        let mut check = SettingsCheck::new(&planned, false, false, now);
        let target = Address {
            system: 1,
            component: 1,
        };
        while check.outcome().is_none() {
            if let Some(Message::Flight(FlightMessage::ParamRead { name, .. })) =
                check.poll(now, target)
                && known.contains(&name.as_str())
            {
                check.heard(now, &name, ParamValue::float(1.0));
            }
            now = now + REPEAT_MS;
        }
        check.outcome().unwrap_or_default().to_vec()
    }

    #[test]
    fn a_vehicle_that_may_lean_further_than_the_plan_needs_is_as_good() {
        assert!(suffices("ANGLE_MAX", 4500.0, 3000.0) && suffices("MPC_TILTMAX_AIR", 50.0, 45.0));
        assert!(!suffices("ANGLE_MAX", 2000.0, 3000.0));
        assert!(!suffices("WPNAV_SPEED", 1100.0, 1000.0));
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
