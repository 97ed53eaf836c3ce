//! All or none: T0 when every vehicle is armed, else all are disarmed.

use super::vehicle::{ARMING_MS, FlightVehicle, Stage};
use super::{Fleet, Outcome, Phase};
use crate::link::Time;

/// After the time for arming heartbeats are waited for this long, milliseconds.
const CONFIRMING_MS: u64 = 10_000;

/// When a flight may begin whose limits hold at certain times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Launch {
    /// None is armed before.
    pub from: Time,
    /// T0 is no later.
    pub until: Time,
}

impl Fleet<'_> {
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
        self.outcome = Some(Outcome::NotStarted(why));
        self.phase = Phase::Ended;
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
        self.say(now, None, "all are ready".to_owned());
        self.vehicles
            .iter_mut()
            .for_each(|vehicle| vehicle.arm(now));
        let until = now + ARMING_MS + CONFIRMING_MS;
        self.phase = Phase::Arming { until };
    }

    /// T0 is when a fresh heartbeat of every vehicle shows it armed.
    pub(super) fn look_whether_all_are_armed(&mut self, now: Time, until: Time) {
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
        } else if waiting.is_empty() {
            let t0_ms = self.flight_ms(now);
            self.phase = Phase::Flying { t0_ms };
            self.say(now, None, "all are armed: T0".to_owned());
        } else if now >= until {
            let why = "no fresh heartbeat shows it armed";
            let refusals = waiting.into_iter().map(|id| (id, why.to_owned()));
            self.abandon(now, refusals.collect());
        }
    }
}
