//! What is made sure of before a vehicle flies.

use super::{FlightVehicle, Stage};
use crate::autopilot::Autopilot;
use crate::flight::launch::parameters::{OtherSetting, SettingsCheck};
use crate::flight::launch::readiness;
use crate::flight::launch::readiness::STANDS_M;
use crate::link::{Address, Command, FlightMessage, Message, MissionMessage, Time};

/// How long position and home are waited for, milliseconds.
const REPORTING_MS: u64 = 60_000;
/// Between two requests for what a vehicle does not broadcast, milliseconds.
const REQUEST_MS: u64 = 1000;
/// A parameter that is said to be another one is read again for this long, milliseconds.
const OTHER_MS: u64 = 1000;
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

impl FlightVehicle<'_> {
    /// Goes on with the transfer or the checks.
    pub(crate) fn work(&mut self, now: Time) {
        match &mut self.stage {
            Stage::Sending(session) => {
                session.handle_timeout(now);
                self.outbox
                    .extend(std::iter::from_fn(|| session.poll_transmit()));
                let Some(report) = session.report() else {
                    return;
                };
                if !report.is_verified() {
                    let why = match &report.verdict {
                        crate::link::Verdict::Refused(refusal) => refusal.to_string(),
                        crate::link::Verdict::Failed(failure) => failure.to_string(),
                        crate::link::Verdict::Verified => String::new(),
                    };
                    self.problems.push(why);
                }
                self.check(now);
            }
            Stage::Reading(reading) => {
                reading.handle_timeout(now);
                self.outbox
                    .extend(std::iter::from_fn(|| reading.poll_transmit()));
                let Some(outcome) = reading.outcome() else {
                    return;
                };
                match outcome {
                    Ok(onboard) => {
                        self.problems
                            .extend(readiness::list_problems(self.of.mission, onboard));
                        self.home = self.home.or(onboard.home);
                    }
                    Err(failure) => self.problems.push(failure.to_string()),
                }
                self.check(now);
            }
            Stage::Checking { until } => {
                let until = *until;
                let outcome = self.settings.as_ref().and_then(SettingsCheck::outcome);
                let is_known =
                    self.home.is_some() && self.latest.is_some() && !self.lacks_version();
                if let Some(differences) = outcome
                    && (is_known || now >= until)
                {
                    let differences = differences.to_vec();
                    self.conclude(differences);
                }
            }
            _ => {}
        }
    }

    fn check(&mut self, now: Time) {
        if !self.problems.is_empty() {
            self.stage = Stage::Refused(std::mem::take(&mut self.problems));
            return;
        }
        // What it said while its mission was sent does not count.
        self.total.now = None;
        let bytewise = self.autopilot().conventions().bytewise_parameters;
        let planned = &self.of.mission.params;
        self.request_disarm_parameter();
        self.settings = Some(SettingsCheck::new(planned, self.set_params, bytewise, now));
        self.stage = Stage::Checking {
            until: now + REPORTING_MS,
        };
    }

    /// Whether its version matters and is not known yet.
    fn lacks_version(&self) -> bool {
        let mission = self.of.mission;
        let matters =
            mission.autopilot_version.is_some() || mission.facts().heights_at_once.is_some();
        matters && self.version.is_none()
    }

    /// Decides by everything that the vehicle has reported.
    fn conclude(&mut self, differences: Vec<String>) {
        let mut soft = differences;
        soft.extend(self.changed_settings());
        match &self.home {
            None => soft.push("it does not say where its home is".to_owned()),
            Some(home) => soft.extend(readiness::home_problem(&self.of.mission.home, home)),
        }
        soft.extend(readiness::version_problem(self.of.mission, self.version));
        let unknown = readiness::unknown_version(self.of.mission, self.version);
        self.said.extend(unknown);
        let mut hard = Vec::new();
        if self.latest.is_none() {
            hard.push("it does not say where it is".to_owned());
        }
        soft.extend(self.place_problems());
        if self.vehicle.is_some_and(|(_, beat)| beat.is_armed()) {
            hard.push("it is armed".to_owned());
        }
        if self.force {
            self.said.extend(
                soft.drain(..)
                    .map(|text| format!("flies all the same: {text}")),
            );
        }
        hard.extend(soft);
        self.total.ready = self.total.now;
        self.stage = if hard.is_empty() {
            Stage::Ready
        } else {
            Stage::Refused(hard)
        };
    }

    /// That it is not where its mission begins.
    fn place_problems(&self) -> Vec<String> {
        let Some((_, fix)) = self.latest else {
            return Vec::new();
        };
        let mut problems = Vec::new();
        let away_m = readiness::place(&self.of.mission.home).chord_m(fix.place);
        if away_m > STANDS_M {
            problems.push(format!(
                "it stands {away_m:.0} m from its home (allowed: {STANDS_M:.0} m)"
            ));
        }
        let above_m = fix.amsl.0 - f64::from(self.of.mission.home.amsl_m);
        if above_m.abs() > STANDS_M {
            let side = if above_m > 0.0 { "above" } else { "below" };
            let off_m = above_m.abs();
            problems.push(format!(
                "it is {off_m:.0} m {side} its home by its position (allowed: {STANDS_M:.0} m)"
            ));
        }
        problems
    }

    /// What has changed since it was checked, while others were not ready: nobody starts then. `battery` is what is
    /// wrong with its battery.
    pub(in crate::flight) fn changed_since_checked(&self, battery: Option<String>) -> Vec<String> {
        let mut problems = Vec::new();
        let is_armed = self.heartbeat_now().is_some_and(|beat| beat.is_armed());
        if is_armed && matches!(self.stage, Stage::Ready) {
            problems.push("it was armed after it was checked, and not from here".to_owned());
        }
        if !self.force {
            problems.extend(self.place_problems());
            problems.extend(battery);
            problems.extend(self.changed_settings());
        }
        problems
    }

    /// Parameters that it says to be others than when they were read.
    fn changed_settings(&self) -> Vec<String> {
        let settings = self.settings.as_ref();
        let others = settings.map_or_else(Vec::new, |of| of.others(self.now, 0));
        others.iter().map(OtherSetting::changed).collect()
    }

    /// The same in flight, where an old answer that came late is not meant; and one of the return.
    pub(in crate::flight) fn other_settings(&self) -> (Vec<OtherSetting>, Option<&OtherSetting>) {
        let Some(settings) = &self.settings else {
            return (Vec::new(), None);
        };
        let others = settings.others(self.now, OTHER_MS);
        (others, settings.other_of_return())
    }

    /// Another station writes to it after it was read.
    pub(super) fn heed_writer(&mut self, list: &MissionMessage) {
        let is_read = match &self.stage {
            // What they hear until then is theirs.
            Stage::Sending(session) => session.report().is_some(),
            Stage::Reading(reading) => reading.outcome().is_some(),
            Stage::Checking { .. } | Stage::Ready | Stage::Arming | Stage::Armed => true,
            _ => false,
        };
        if let Some(system) = list.accepted_from_other(self.us).filter(|_| is_read) {
            let why = format!(
                "it acknowledged a mission, a fence or rally points to system {system} after they were read: run `sortie fly` again"
            );
            self.stage = Stage::Refused(vec![why]);
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
        let autopilot = self.autopilot();
        let mut ask = |order| {
            self.outbox
                .push_back(Message::Flight(FlightMessage::Command { target, order }));
        };
        if self.home.is_none() {
            ask(Command::new(Command::REQUEST_MESSAGE, [242.0]));
        }
        if lacks_version {
            ask(Command::request_version());
        }
        let streams = |id| Command::new(Command::SET_MESSAGE_INTERVAL, [id, interval_us]);
        let is_ready = matches!(self.stage, Stage::Ready);
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
        let own: &[u32] = match autopilot {
            Autopilot::ArduPilot => &ARDUPILOT_HEALTH,
            Autopilot::Px4 => &PX4_HEALTH,
        };
        let is_old = |at: &Time| now - *at > STALE_MS;
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
