//! All or none: T0 when every vehicle is armed, else all are disarmed.

use super::vehicle::{ARMING_MS, FlightVehicle, Stage};
use super::{Fleet, Outcome, Phase};
use crate::link::Time;

/// After the time for arming heartbeats are waited for this long, milliseconds.
const CONFIRMING_MS: u64 = 10_000;

/// From T0 until a vehicle has left the ground, by its own clock, seconds: the order to start, the
/// spin-up and the ramp of the thrust of PX4 (`COM_SPOOLUP_TIME`, `MPC_TKO_RAMP_T`: 1 and 3 s).
const LIFTOFF_S: f64 = 5.0;
/// Vehicles are armed again this often before nothing is started.
const MAX_AGAIN: u8 = 6;

/// Vehicles that are not ready are named after this time, then again after each interval, milliseconds.
pub(super) const FIRST_MS: u64 = 10_000;
const EVERY_MS: u64 = 30_000;

/// The event of T0: of no vehicle, whatever texts those send.
pub(super) const BEGUN: &str = "all are armed: T0";

/// When a flight may begin whose limits hold at certain times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Launch {
    /// None is armed before.
    pub from: Time,
    /// T0 is no later.
    pub until: Time,
}

impl Launch {
    /// Between two times of the clock of the wall, milliseconds since 1970, where it is `unix_ms` now.
    #[must_use]
    pub fn between((from_ms, until_ms): (u64, u64), unix_ms: u64, now: Time) -> Self {
        let at = |wall_ms: u64| {
            let is_over_ms = unix_ms.saturating_sub(wall_ms);
            Time(now.0.saturating_sub(is_over_ms)) + wall_ms.saturating_sub(unix_ms)
        };
        Self {
            from: at(from_ms),
            until: at(until_ms),
        }
    }
}

impl Fleet<'_> {
    /// Changes when it may begin: the clock of the wall may be set while it waits.
    pub fn retime_launch(&mut self, launch: Launch) {
        self.options.launch = Some(launch);
    }

    fn refusals(&self) -> Vec<(String, String)> {
        self.vehicles
            .iter()
            .flat_map(|vehicle| match &vehicle.stage {
                Stage::Refused(problems) => problems
                    .iter()
                    .map(|problem| (vehicle.of.vehicle.to_owned(), problem.clone()))
                    .collect(),
                _ => Vec::new(),
            })
            .collect()
    }

    /// None is started; whichever vehicle may be armed is disarmed first.
    pub(super) fn abandon(&mut self, now: Time, why: Vec<(String, String)>) {
        if matches!(self.phase, Phase::Abandoning | Phase::Ended) {
            return;
        }
        self.refusals = why;
        for vehicle in self.vehicles.iter_mut().filter(|c| c.may_be_armed()) {
            vehicle.disarm(None);
        }
        self.phase = Phase::Abandoning;
        self.gather(now);
        self.look_whether_all_are_disarmed();
    }

    pub(super) fn look_whether_all_are_disarmed(&mut self) {
        let disarms = |c: &FlightVehicle<'_>| matches!(c.stage, Stage::Disarming(_));
        if self.vehicles.iter().any(disarms) {
            return;
        }
        let mut why = std::mem::take(&mut self.refusals);
        let armed = self.vehicles.iter().filter_map(|c| c.still_armed.clone());
        why.extend(armed.map(|text| (String::new(), text)));
        let set = self.vehicles.iter();
        why.extend(set.filter_map(|c| Some((c.of.vehicle.to_owned(), c.was_set()?))));
        self.outcome = Some(Outcome::NotStarted(why));
        self.phase = Phase::Ended;
    }

    /// Names the vehicles that are not ready, and what is awaited of each.
    pub(super) fn say_who_is_awaited(&mut self, now: Time) {
        if now < self.awaited_due {
            return;
        }
        self.awaited_due = now + EVERY_MS;
        let vehicles = self.vehicles.iter();
        let awaited = vehicles.filter_map(|of| Some((of.of.vehicle.to_owned(), of.awaited()?)));
        let awaited: Vec<(String, String)> = awaited.collect();
        for (vehicle, what) in awaited {
            self.say(now, Some(vehicle), format!("is waited for: {what}"));
        }
    }

    pub(super) fn look_whether_all_are_ready(&mut self, now: Time) {
        let is_checked =
            |vehicle: &FlightVehicle<'_>| matches!(vehicle.stage, Stage::Ready | Stage::Refused(_));
        if !self.vehicles.iter().all(is_checked) {
            return;
        }
        let refusals = self.refusals();
        if !refusals.is_empty() {
            return self.abandon(now, refusals);
        }
        if let Some(launch) = self.options.launch.filter(|launch| now < launch.from) {
            if !std::mem::replace(&mut self.waits, true) {
                let wait_s = (launch.from - now).div_ceil(1000);
                self.say(now, None, format!("all are ready; t0 is in {wait_s} s"));
            }
            return;
        }
        if self.waits_for_controls(now) {
            return;
        }
        let changed = self.changed_since_checked();
        if !changed.is_empty() {
            return self.abandon(now, changed);
        }
        self.say(now, None, "all are ready".to_owned());
        self.vehicles
            .iter_mut()
            .for_each(|vehicle| vehicle.arm(now));
        let until = now + ARMING_MS + CONFIRMING_MS;
        self.phase = Phase::Arming { until, again: 0 };
    }

    /// What has changed of vehicles since each was checked: some wait long for others.
    fn changed_since_checked(&self) -> Vec<(String, String)> {
        let vehicles = self.vehicles.iter().enumerate();
        let changed = vehicles.flat_map(|(index, vehicle)| {
            let alarms = self.alarms.as_ref();
            let battery = alarms.and_then(|alarms| alarms.battery_problem(index));
            let problems = vehicle.changed_since_checked(battery).into_iter();
            problems.map(|problem| (vehicle.of.vehicle.to_owned(), problem))
        });
        changed.collect()
    }

    /// Whether a vehicle must run for longer before it may take off; of each that is said once.
    fn waits_for_controls(&mut self, now: Time) -> bool {
        let flight_ms = self.flight_ms(now);
        let vehicles = self.vehicles.iter().enumerate();
        let waits = vehicles.filter_map(|(index, of)| Some((index, of.needs_more_s(flight_ms)?)));
        let waits: Vec<(usize, f64)> = waits.collect();
        for (index, left_s) in &waits {
            let vehicle = &mut self.vehicles[*index];
            if !std::mem::replace(&mut vehicle.motors.is_awaited, true) {
                let id = vehicle.of.vehicle.to_owned();
                let text = format!(
                    "was started too short a time ago, and would sink after its takeoff: waiting {left_s:.0} s more"
                );
                self.say(now, Some(id), text);
            }
        }
        !waits.is_empty()
    }

    /// Arms those again that may disarm themselves before they have left the ground, because others took
    /// longer. Whether there are any.
    fn arm_again(&mut self, now: Time, (until, again): (Time, u8)) -> bool {
        let flight_ms = self.flight_ms(now);
        // The time of simulated vehicles may go on faster than they are answered.
        let is_hurried = self.options.speedup > 1.0 && again >= MAX_AGAIN / 2;
        let for_s = if is_hurried {
            0.2 * LIFTOFF_S
        } else {
            LIFTOFF_S
        };
        let vehicles = self.vehicles.iter().enumerate();
        let old = vehicles.filter(|(_, of)| !of.stays_armed(flight_ms, for_s));
        let old: Vec<usize> = old.map(|(index, _)| index).collect();
        if old.is_empty() {
            return false;
        }
        let words = |vehicle: &FlightVehicle<'_>| {
            let armed_s = vehicle.armed_for_s(flight_ms);
            let after_s = vehicle.disarms_after_s().unwrap_or(f64::INFINITY);
            format!(
                "was armed for {armed_s:.0} s when the last one was, and disarms itself after {after_s:.0} s"
            )
        };
        let old_ones = old.iter().map(|index| &self.vehicles[*index]);
        let why: Vec<(String, String)> = old_ones
            .map(|of| (of.of.vehicle.to_owned(), words(of)))
            .collect();
        if again >= MAX_AGAIN {
            self.abandon(now, why);
            return true;
        }
        for (index, (vehicle, text)) in old.into_iter().zip(why) {
            self.vehicles[index].arm_again(now);
            self.say(now, Some(vehicle), format!("{text}: it is armed again"));
        }
        self.phase = Phase::Arming {
            until: until.max(now + CONFIRMING_MS),
            again: again + 1,
        };
        true
    }

    /// T0 is when a fresh heartbeat of every vehicle shows it armed.
    pub(super) fn look_whether_all_are_armed(&mut self, now: Time, until: Time, again: u8) {
        let refusals = self.refusals();
        if !refusals.is_empty() {
            return self.abandon(now, refusals);
        }
        let speedup = self.options.speedup;
        let waits = |c: &&FlightVehicle<'_>| !c.is_armed_now(now, speedup);
        let waiting = self.vehicles.iter().filter(waits);
        let waiting: Vec<String> = waiting.map(|c| c.of.vehicle.to_owned()).collect();
        let is_late = |launch: Launch| now > launch.until;
        if waiting.is_empty() && self.options.launch.is_some_and(is_late) {
            let why = "all are armed too late for the times of the zones, which are those after t0";
            self.abandon(now, vec![(String::new(), why.to_owned())]);
        } else if waiting.is_empty() && self.arm_again(now, (until, again)) {
            // T0 is when those are armed again.
        } else if waiting.is_empty() {
            let changed = self.changed_since_checked();
            if !changed.is_empty() {
                return self.abandon(now, changed);
            }
            let t0_ms = self.flight_ms(now);
            if let Some(alarms) = &mut self.alarms {
                for (index, vehicle) in self.vehicles.iter().enumerate() {
                    alarms.set_checked(index, vehicle.checked());
                }
            }
            self.phase = Phase::Flying { t0_ms };
            self.say(now, None, BEGUN.to_owned());
            self.say_unreported(now);
        } else if now >= until {
            let why = "no fresh heartbeat shows it armed";
            let refusals = waiting.into_iter().map(|id| (id, why.to_owned()));
            self.abandon(now, refusals.collect());
        }
    }

    /// Which alarms cannot come, for want of reports.
    fn say_unreported(&mut self, now: Time) {
        for index in 0..self.vehicles.len() {
            let alarms = self.alarms.as_ref();
            if let Some(text) = alarms.and_then(|alarms| alarms.unreported(index)) {
                let id = self.vehicles[index].of.vehicle.to_owned();
                self.say(now, Some(id), text);
            }
        }
    }
}
