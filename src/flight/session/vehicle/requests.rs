//! What is requested of a vehicle because it may not broadcast it.

use super::{FlightVehicle, Stage};
use crate::autopilot::Autopilot;
use crate::link::{Address, Command, FlightMessage, Message, Time};

/// Between two requests for what a vehicle does not broadcast, milliseconds.
const REQUEST_MS: u64 = 1000;
/// Messages that are requested: `GLOBAL_POSITION_INT` and `MISSION_CURRENT`.
const POSITION: f32 = 33.0;
const CURRENT_ITEM: f32 = 42.0;
/// Those in which it reports its health, and the time between two of each, microseconds: `SYS_STATUS`,
/// `GPS_RAW_INT`, `BATTERY_STATUS`, then of ArduPilot `FENCE_STATUS` and `EKF_STATUS_REPORT`, of PX4
/// `ESTIMATOR_STATUS`. A stock ArduPilot sends none of them unasked.
const SYS_STATUS: u32 = 1;
const HEALTH: [u32; 3] = [SYS_STATUS, 24, 147];
const ARDUPILOT_HEALTH: [u32; 2] = [162, 193];
const PX4_HEALTH: [u32; 1] = [230];
const HEALTH_US: f32 = 500_000.0;
/// A current item that was not said for this long is requested again, milliseconds.
const STALE_MS: u64 = 3000;
/// `EXTENDED_SYS_STATE`: whether it is on the ground.
const LANDED_STATE: f32 = 245.0;

impl FlightVehicle<'_> {
    /// Requests or sets the parameters that are due.
    pub(super) fn request_settings(&mut self, now: Time, target: Address) {
        let Some(settings) = &mut self.settings else {
            return;
        };
        settings.take_round_trip(self.checked.round_trip_ms);
        self.outbox.extend(settings.poll(now, target));
        self.outbox.extend(settings.poll_ahead(target));
        if matches!(self.stage, Stage::Starting | Stage::Flying) {
            self.outbox.extend(settings.look_again(now, target));
        }
    }

    /// Requests what it does not broadcast.
    pub(crate) fn request(&mut self, now: Time, target: Address, interval_us: f32) {
        if now - self.requested < REQUEST_MS || matches!(self.stage, Stage::Ended) {
            return;
        }
        self.requested = now;
        let question = self.time_question(now, target);
        self.outbox.push_back(question);
        let lacks_version = self.lacks_version();
        let (autopilot, landed_at) = (self.autopilot(), self.motors.height.landed_at());
        let mut ask = |order| {
            self.outbox
                .push_back(Message::Flight(FlightMessage::Command { target, order }));
        };
        let is_ready = matches!(self.stage, Stage::Ready);
        // Another station may move it.
        if self.home.is_none() || is_ready {
            ask(Command::new(Command::REQUEST_MESSAGE, [242.0]));
        }
        if lacks_version {
            ask(Command::request_version());
        }
        let streams = |id| Command::new(Command::SET_MESSAGE_INTERVAL, [id, interval_us]);
        let flies = matches!(self.stage, Stage::Starting | Stage::Flying);
        // A position may be the answer to somebody's single request, and no stream follows it.
        if !flies || self.position_at.is_none_or(|at| now - at > STALE_MS) {
            ask(streams(POSITION));
        }
        // A vehicle may stream positions already, and nothing about its mission.
        if self.item_at.is_none_or(|at| now - at > STALE_MS) {
            ask(streams(CURRENT_ITEM));
            ask(Command::new(Command::REQUEST_MESSAGE, [CURRENT_ITEM]));
        } else if is_ready {
            ask(streams(CURRENT_ITEM));
        }
        let is_old = |at: &Time| now - *at > STALE_MS;
        // The verdict on its landing relies on it; one that never said it may not have it.
        if is_ready || landed_at.map_or(!flies, |at| is_old(&at)) {
            ask(Command::new(
                Command::SET_MESSAGE_INTERVAL,
                [LANDED_STATE, HEALTH_US],
            ));
        }
        let own: &[u32] = match autopilot {
            Autopilot::ArduPilot => &ARDUPILOT_HEALTH,
            Autopilot::Px4 => &PX4_HEALTH,
        };
        let all = is_ready || self.health_at.get(&SYS_STATUS).is_none_or(is_old);
        for id in HEALTH.iter().chain(own) {
            // One that never came may be none that it has.
            if all || self.health_at.get(id).is_some_and(is_old) {
                #[expect(clippy::cast_precision_loss, reason = "ids of messages have 24 bits")]
                let id = *id as f32;
                ask(Command::new(Command::SET_MESSAGE_INTERVAL, [id, HEALTH_US]));
            }
        }
    }
}
