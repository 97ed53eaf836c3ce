//! The fleet in flight: started in turn, watched to the end, and who is lost meanwhile.

use super::end::may_last_s;
use super::vehicle::{FlightVehicle, Stage};
use super::{Fleet, Outcome, Phase};
use crate::flight::alarms::{Alarm, Alarms};
use crate::link::Time;
use crate::spec::AlarmKind;

/// A vehicle that was silent for so long is lost: seconds of flight, and of the wall's clock.
const LOST_FLIGHT_S: f64 = 5.0;
/// One that is heard without a heartbeat for so long, as well, seconds of flight: some of them may be lost.
const NO_HEARTBEAT_S: f64 = 10.0;
const LOST_WALL_MS: f64 = 2500.0;
/// A vehicle that could not be started at its departure, because this program was stopped, is not started
/// later than the times between vehicles allow and by more than this: seconds of flight, and of the wall's
/// clock.
const LATE_START_S: f64 = 3.0;
const LATE_START_WALL_MS: f64 = 2500.0;
/// A longer time between two steps of the driver is a stop of this program, milliseconds.
const STOPPED_MS: u64 = 2000;

impl Fleet<'_> {
    pub(super) fn watch(&mut self, now: Time, t0_ms: f64) {
        let t_s = (self.flight_ms(now) - t0_ms) / 1000.0;
        let slack_s = self.alarms.as_ref().map_or(0.0, Alarms::slack_s);
        let mut ends_s = 0.0_f64;
        for vehicle in &mut self.vehicles {
            vehicle.check_rejoin();
            let after_s = t_s - vehicle.of.start_s;
            if matches!(vehicle.stage, Stage::Armed) && after_s >= 0.0 {
                let is_held_up = 1000.0 * after_s > LATE_START_WALL_MS * self.options.speedup;
                match is_held_up && after_s > slack_s + LATE_START_S {
                    true => vehicle.stays_behind(after_s),
                    false => vehicle.start(),
                }
            }
            vehicle.check_ending(t_s);
            ends_s = ends_s.max(vehicle.of.reference.end_s);
        }
        self.look_for_the_lost(now, t_s);
        self.look_for_alarms(now);
        self.look_for_plans(now, t_s);
        self.give_up_the_late(t_s, ends_s);
        self.end_those_that_loiter();
        self.gather(now);
        let is_over = |of: &FlightVehicle<'_>| matches!(of.stage, Stage::Ended);
        if self.vehicles.iter().all(is_over) {
            self.outcome = Some(Outcome::Flown);
            self.phase = Phase::Ended;
        }
    }

    /// Gives up who has not ended its flight in time; `ends_s` is when that of the fleet ends.
    fn give_up_the_late(&mut self, t_s: f64, ends_s: f64) {
        for (vehicle, is_lost) in self.vehicles.iter_mut().zip(&self.lost) {
            // One that is taken over late has the same time from then on: it was not heard yet.
            if t_s - self.since_s <= may_last_s(ends_s, vehicle.flown.slipped_s()) {
                continue;
            }
            if matches!(vehicle.stage, Stage::Rejoining { .. }) {
                vehicle.give_up_unheard();
            } else if !matches!(vehicle.stage, Stage::Ended | Stage::Disarming(_)) {
                let why = format!("has not ended its flight {t_s:.0} s after T0");
                vehicle.give_up(why, *is_lost);
            }
        }
    }

    /// When no vehicle flies to its end any more, the flights of those that stay at theirs are over.
    fn end_those_that_loiter(&mut self) {
        let is_done = |of: &FlightVehicle<'_>| of.stay.loiters || matches!(of.stage, Stage::Ended);
        if self.vehicles.iter().all(is_done) {
            let shows =
                |of: &&mut FlightVehicle<'_>| matches!(of.stage, Stage::Flying) && of.stay.is_shown;
            let loiter = self.vehicles.iter_mut().filter(shows);
            loiter.for_each(FlightVehicle::end_loitering);
        }
    }

    /// Who is lost, and who is back.
    fn look_for_the_lost(&mut self, now: Time, t_s: f64) {
        let speedup = self.options.speedup;
        let mut changed = Vec::new();
        let vehicles = self.vehicles.iter().zip(&mut self.lost);
        for (index, (vehicle, lost)) in vehicles.enumerate() {
            if matches!(vehicle.stage, Stage::Ended) {
                continue;
            }
            let silent_s = silence_s(vehicle, now, speedup);
            if silent_s.is_some() != *lost {
                *lost = silent_s.is_some();
                changed.push((index, silent_s));
            }
        }
        for (vehicle, silent_s) in changed {
            let is_heard = heard_s(&self.vehicles[vehicle], now, speedup) <= LOST_FLIGHT_S;
            let text = match silent_s {
                Some(silent_s) if is_heard => format!(
                    "no heartbeat for {silent_s:.0} s: its mode and its motors are not known"
                ),
                Some(silent_s) => format!("link lost, nothing was heard for {silent_s:.0} s"),
                None => "link is back".to_owned(),
            };
            let alarm = Alarm {
                t_s,
                vehicle,
                other: None,
                kind: AlarmKind::Link,
                cause: "",
                is_raised: silent_s.is_some(),
                text,
            };
            self.announce(now, &alarm);
        }
    }

    /// Between two calls this program may be stopped, and hears nobody: no vehicle is silent
    /// for that.
    pub(super) fn look_for_a_stop(&mut self, now: Time) {
        let stopped_ms = now - self.last;
        self.last = now;
        if stopped_ms < STOPPED_MS {
            return;
        }
        if let Phase::Arming { until, .. } = &mut self.phase {
            *until = *until + stopped_ms;
        }
        for vehicle in &mut self.vehicles {
            vehicle.postpone(now, stopped_ms);
        }
        #[expect(clippy::cast_precision_loss, reason = "milliseconds of one flight")]
        let stopped_s = stopped_ms as f64 / 1000.0;
        if let Some(t_s) = self.t_s(now) {
            let since_s = t_s - stopped_s * self.options.speedup;
            self.stops.push_back((since_s.max(0.0), t_s));
        }
        let text = format!(
            "this program was stopped for {stopped_s:.0} s: nothing was heard or ordered meanwhile"
        );
        self.say(now, None, text);
    }
}

/// For how long nothing was heard of a vehicle, seconds of flight.
fn heard_s(vehicle: &FlightVehicle<'_>, now: Time, speedup: f64) -> f64 {
    seconds(now - vehicle.heard) * speedup
}

/// For how long a vehicle has been silent, or sent no heartbeat, seconds of flight, if that is too long.
pub(in crate::flight::session) fn silence_s(
    vehicle: &FlightVehicle<'_>,
    now: Time,
    speedup: f64,
) -> Option<f64> {
    let is_long = |since: Time, max_s: f64| {
        let silent_ms = now - since;
        let silent_s = seconds(silent_ms) * speedup;
        (silent_s > max_s && seconds(silent_ms) * 1000.0 > LOST_WALL_MS).then_some(silent_s)
    };
    let is_watched = vehicle.is_watched();
    let heartbeats = || is_long(vehicle.heartbeat_at, NO_HEARTBEAT_S).filter(|_| is_watched);
    is_long(vehicle.heard, LOST_FLIGHT_S).or_else(heartbeats)
}

#[expect(clippy::cast_precision_loss, reason = "milliseconds of one flight")]
fn seconds(ms: u64) -> f64 {
    ms as f64 / 1000.0
}
