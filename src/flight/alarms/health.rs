//! What a vehicle reports of itself: battery, position estimate, fence, texts.

use std::collections::VecDeque;

use super::reports::{Age, Reported, take};
use crate::flight::event::says;
use crate::link::{FlightMessage, Health, Message, SystemStatus};
use crate::spec::Vehicle;

/// `MAV_SEVERITY_CRITICAL`: texts up to this are alarms.
const CRITICAL: u8 = 2;
/// Texts of one vehicle that are alarms within a period, and the period, seconds.
const MAX_TEXTS: usize = 5;
const TEXTS_S: f64 = 10.0;
/// Share of the battery that must be left where the spec does not say.
const RESERVE: f64 = 0.2;
/// `MAV_BATTERY_CHARGE_STATE_CRITICAL`: from here on the battery itself asks for a landing.
const CHARGE_CRITICAL: u8 = 3;
const CHARGE_UNHEALTHY: u8 = 6;
/// `GPS_FIX_TYPE_3D_FIX`.
const FIX_3D: u8 = 3;
/// Reports of a bad estimate in a row that make an alarm.
const BAD_REPORTS: u8 = 2;
/// `FS_EKF_THRESH` of ArduPilot, and the limit of PX4's filter.
const EKF_VARIANCE: f32 = 0.8;
const ESTIMATOR_RATIO: f32 = 1.0;
/// What was bad is good again below this share of its limit: a variance near it would raise one alarm after the other.
const GOOD_SHARE: f32 = 0.6;
/// Flags of both: absolute horizontal position known; a constant position is assumed.
const POSITION_KNOWN: u16 = 16;
const POSITION_CONSTANT: u16 = 128;
/// `ESTIMATOR_GPS_GLITCH`, `ESTIMATOR_ACCEL_ERROR`.
const GPS_GLITCH: u16 = 1024;
const ACCEL_ERROR: u16 = 2048;
/// The number under which the battery of `SYS_STATUS` is remembered: it is the first one.
const SYSTEM: u8 = u8::MAX;

/// The last reports of one vehicle.
#[derive(Debug, Default)]
pub(super) struct HealthState {
    /// Share of the battery that must be left, where the spec says so.
    reserve: Option<f64>,
    /// Time since anything was heard, seconds, and what makes a report an old one.
    quiet_s: f64,
    max_s: f64,
    /// Percent left of each battery.
    batteries: Vec<Reported<i8>>,
    /// `MAV_BATTERY_CHARGE_STATE` of each that says so.
    charges: Vec<Reported<u8>>,
    /// What is wrong with the estimate, and how many reports in a row say so.
    estimate: Option<(String, u8)>,
    /// When its estimate was reported last.
    estimate_age: Option<Age>,
    is_breached: bool,
    /// Whether `SYS_STATUS` has the fence as not healthy.
    is_fence_bad: bool,
    breach: u8,
    fix: Option<(u8, Age)>,
    /// Critical texts that are alarms, and when there were some.
    texts: VecDeque<String>,
    texts_s: VecDeque<f64>,
}

impl HealthState {
    /// Of a vehicle that has said nothing yet.
    pub(super) fn of(vehicle: &Vehicle) -> Self {
        Self {
            reserve: vehicle
                .endurance
                .as_ref()
                .map(|endurance| endurance.reserve),
            ..Self::default()
        }
    }

    /// Time passes in which somebody listened. The vehicle is heard unless it was silent for `quiet_s`; a
    /// report is old after `max_s`.
    pub(super) fn listen(&mut self, listened_s: f64, quiet_s: f64, max_s: f64) {
        self.max_s = max_s;
        self.quiet_s += listened_s;
        if self.quiet_s > quiet_s {
            // Nothing at all is heard: that is an alarm of its own.
            return;
        }
        let batteries = self.batteries.iter_mut().map(|of| &mut of.age);
        let charges = self.charges.iter_mut().map(|of| &mut of.age);
        let others = self.fix.iter_mut().map(|(_, age)| age);
        let others = others.chain(&mut self.estimate_age);
        for age in batteries.chain(charges).chain(others) {
            age.grow(listened_s);
        }
    }

    pub(super) fn handle(&mut self, t_s: f64, message: &Message) {
        self.quiet_s = 0.0;
        match message {
            Message::StatusText { severity, text }
                if *severity <= CRITICAL && !is_before_arming(text) =>
            {
                while self.texts_s.front().is_some_and(|at| t_s - at > TEXTS_S) {
                    self.texts_s.pop_front();
                }
                if self.texts_s.len() < MAX_TEXTS {
                    self.texts_s.push_back(t_s);
                    self.texts.push_back(says(text));
                }
            }
            Message::Flight(FlightMessage::Health(health)) => self.report(health),
            _ => {}
        }
    }

    fn report(&mut self, health: &Health) {
        match health {
            Health::System(status) => {
                self.is_fence_bad = status.is_bad(SystemStatus::GEOFENCE);
                // A vehicle without a battery monitor sends zeros.
                let is_known = status.voltage_mv > 0 || status.remaining > 0;
                if is_known && status.remaining >= 0 {
                    take(&mut self.batteries, SYSTEM, status.remaining);
                }
            }
            Health::Battery {
                id,
                remaining,
                charge,
            } => {
                if *charge > 0 {
                    take(&mut self.charges, *id, *charge);
                } else {
                    self.charges.retain(|of| of.id != *id);
                }
                if *remaining >= 0 {
                    take(&mut self.batteries, *id, *remaining);
                }
            }
            Health::Gps { fix, .. } => self.fix = Some((*fix, Age::default())),
            Health::Fence {
                is_breached, kind, ..
            } => (self.is_breached, self.breach) = (*is_breached, *kind),
            Health::Ekf { variances, flags } => {
                let wrong = |limit: f32| wrong(variances, limit, *flags);
                self.take_estimate(wrong(EKF_VARIANCE), wrong(GOOD_SHARE * EKF_VARIANCE));
            }
            Health::Estimator { ratios, flags } => {
                // PX4 has no number for a compass that it does not use at the moment.
                let [velocity, position, altitude, compass] = *ratios;
                let compass = if compass.is_nan() { 0.0 } else { compass };
                let used = [velocity, position, altitude, compass];
                let wrong = |limit: f32| {
                    let has = |flag: u16| flags & flag != 0;
                    let glitch = has(GPS_GLITCH).then_some("the GPS jumps");
                    let why = glitch.or(has(ACCEL_ERROR).then_some("the accelerometer is bad"));
                    wrong(&used, limit, *flags).or(why.map(str::to_owned))
                };
                let still = wrong(GOOD_SHARE * ESTIMATOR_RATIO);
                self.take_estimate(wrong(ESTIMATOR_RATIO), still);
            }
        }
    }

    /// Takes in what is wrong with its estimate, and what keeps one that was wrong from being good again.
    fn take_estimate(&mut self, why: Option<String>, still: Option<String>) {
        let (before, count) = self.estimate.take().unwrap_or_default();
        let is_still_bad = count >= BAD_REPORTS && still.is_some();
        let why = why.or(is_still_bad.then_some(before));
        self.estimate = why.map(|why| (why, count.saturating_add(1)));
        self.estimate_age = Some(Age::default());
    }

    /// Percent of the battery left, of the emptiest that still says so.
    pub(super) fn remaining(&self) -> Option<i8> {
        let all = self.batteries.iter();
        let fresh = all.filter(|of| of.age.beyond(self.max_s).is_none());
        fresh.map(|of| of.value).min()
    }

    /// `GPS_FIX_TYPE`, as long as it says so.
    pub(super) fn fix(&self) -> Option<u8> {
        let fresh = self.fix.filter(|(_, age)| age.beyond(self.max_s).is_none());
        fresh.map(|(fix, _)| fix)
    }

    /// Whether a battery that was reported is not any more, in words.
    pub(super) fn battery_silence(&self) -> Option<String> {
        let first = |id: u8| if id == SYSTEM { 0 } else { id };
        let percents = self.batteries.iter().map(|of| (first(of.id), of.age));
        // One that knows no percentage may report its state alone.
        let is_known = |id: u8| self.batteries.iter().any(|of| first(of.id) == id);
        let charges = self.charges.iter().filter(|of| !is_known(of.id));
        let all: Vec<(u8, Age)> = percents.chain(charges.map(|of| (of.id, of.age))).collect();
        let latest = |id: u8| {
            let own = all.iter().filter(|of| of.0 == id).map(|of| of.1);
            own.reduce(Age::or_later)
        };
        let (id, silent_s) = all
            .iter()
            .find_map(|(id, _)| Some((*id, latest(*id)?.beyond(self.max_s)?)))?;
        let of = self.batteries.iter().filter(|of| first(of.id) == id);
        let then = of.map(|of| of.value).min();
        let then = then.map_or_else(String::new, |left| format!(" ({left} % left then)"));
        let what = match id {
            0 => "no battery report".to_owned(),
            _ => format!("no report of battery {id}"),
        };
        Some(format!("{what} for {silent_s:.0} s{then}"))
    }

    /// The same of its position estimate.
    pub(super) fn estimate_silence(&self) -> Option<String> {
        let silent_s = self.estimate_age?.beyond(self.max_s)?;
        Some(format!(
            "no report of its position estimate for {silent_s:.0} s"
        ))
    }

    /// And of its GPS.
    pub(super) fn gps_silence(&self) -> Option<String> {
        let (_, age) = self.fix?;
        let silent_s = age.beyond(self.max_s)?;
        Some(format!("no GPS report for {silent_s:.0} s"))
    }

    /// What it has never reported, so that no alarm will come of it.
    pub(super) fn unreported(&self) -> Vec<&'static str> {
        let has_battery = !self.batteries.is_empty() || !self.charges.is_empty();
        [
            (has_battery, "the charge of its battery"),
            (self.fix.is_some(), "its GPS fix"),
            (self.estimate_age.is_some(), "its position estimate"),
        ]
        .into_iter()
        .filter_map(|(is_reported, what)| (!is_reported).then_some(what))
        .collect()
    }

    pub(super) fn battery(&self) -> Option<String> {
        let reserve = 100.0 * self.reserve.unwrap_or(RESERVE);
        // What was low is low as long as nothing else is reported.
        let least = self.batteries.iter().map(|of| of.value).min();
        let low = least.filter(|left| f64::from(*left) < reserve);
        let low = low.map(|left| format!("{left} % left, reserve {reserve:.0} %"));
        let critical = CHARGE_CRITICAL..=CHARGE_UNHEALTHY;
        let says = self.charges.iter().any(|of| critical.contains(&of.value));
        low.or_else(|| says.then(|| "the battery reports that it is critical".to_owned()))
    }

    pub(super) fn estimate(&self) -> Option<String> {
        let bad = self.estimate.as_ref();
        let bad = bad.filter(|(_, count)| *count >= BAD_REPORTS);
        bad.map(|(why, _)| format!("position estimate: {why}"))
    }

    pub(super) fn fence(&self) -> Option<String> {
        let kind = match self.breach {
            1 => " (too low)",
            2 => " (too high)",
            3 => " (its edge)",
            _ => "",
        };
        if self.is_breached {
            return Some(format!("fence breached{kind}"));
        }
        self.is_fence_bad.then(|| "fence breached".to_owned())
    }

    pub(super) fn gps(&self) -> Option<String> {
        let fix = self.fix.filter(|(fix, _)| *fix < FIX_3D);
        fix.map(|(fix, _)| format!("no GPS fix ({})", fix_word(fix)))
    }

    /// The next critical text.
    pub(super) fn take_text(&mut self) -> Option<String> {
        self.texts.pop_front()
    }
}

/// Whether a text says why a vehicle cannot be armed: an autopilot looks for that only while its motors stand.
fn is_before_arming(text: &str) -> bool {
    let begins = ["PreArm:", "Arm:", "Preflight Fail"];
    begins.iter().any(|begin| text.starts_with(begin))
}

/// `GPS_FIX_TYPE` in words.
pub(super) fn fix_word(fix: u8) -> &'static str {
    match fix {
        0 => "no GPS",
        1 => "no fix",
        2 => "2D",
        3 => "3D",
        4 => "DGPS",
        5 => "RTK float",
        6 => "RTK",
        _ => "fix",
    }
}

/// What is wrong with an estimate; of velocity, horizontal position, altitude, compass.
fn wrong(values: &[f32; 4], limit: f32, flags: u16) -> Option<String> {
    let names = ["velocity", "position", "altitude", "compass"];
    let mut bad = names.iter().zip(values);
    // What is no number is bad.
    let bad = bad.find(|(_, value)| value.is_nan() || **value > limit);
    if let Some((name, value)) = bad {
        return Some(format!("{name} variance {value:.1} (at most {limit})"));
    }
    if flags & POSITION_KNOWN == 0 || flags & POSITION_CONSTANT != 0 {
        return Some("it has no absolute position".to_owned());
    }
    None
}

#[cfg(test)]
mod tests {
    use super::{BAD_REPORTS, HealthState};
    use crate::link::Health;

    fn alarm_of(ratios: [f32; 4]) -> Option<String> {
        let mut state = HealthState::default();
        for _ in 0..BAD_REPORTS {
            let flags = super::POSITION_KNOWN;
            state.report(&Health::Estimator { ratios, flags });
        }
        state.estimate()
    }

    #[test]
    fn a_variance_near_its_limit_is_bad_until_it_is_well_below_it() {
        let mut state = HealthState::default();
        let flags = super::POSITION_KNOWN;
        let mut bad_after = |position: f32| {
            let variances = [0.1, position, 0.1, 0.1];
            state.report(&Health::Ekf { variances, flags });
            state.estimate().is_some()
        };
        let found = [0.7, 0.9, 0.7, 0.9, 0.9, 0.7, 0.5, 0.7, 0.4, 0.7].map(&mut bad_after);
        let expected = [
            false, false, false, false, true, true, true, true, false, false,
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn a_compass_that_px4_does_not_use_is_no_alarm() {
        assert_eq!(alarm_of([0.1, 0.1, 0.1, f32::NAN]), None);
        let position = alarm_of([0.1, f32::NAN, 0.1, 0.1]);
        assert!(position.is_some_and(|text| text.contains("position variance NaN")));
        let compass = alarm_of([0.1, 0.1, 0.1, 1.5]);
        assert!(compass.is_some_and(|text| text.contains("compass variance 1.5")));
    }
}
