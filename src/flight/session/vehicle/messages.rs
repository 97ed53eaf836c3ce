//! What a vehicle says: heartbeats, positions, items, texts.

use super::{FlightVehicle, Stage};
use crate::autopilot::Version;
use crate::flight::event::says;
use crate::flight::launch::readiness::{self, STANDS_M};
use crate::flight::record::Fix;
use crate::flight::session::modes;
use crate::geodesy::LatLon;
use crate::link::{
    AUTOPILOT_INVALID, Address, CommandResult, FlightMessage, Heartbeat, Message, Position, Time,
};
use crate::mission::Home;

/// A vehicle that is so much higher than its home by its altitude, or so far from it, has taken off, metres:
/// more than positions, homes and a takeoff run may be off.
const UP_M: f64 = 15.0;
const AWAY_M: f64 = 150.0;
/// One that waits for its start has taken off if it is so much higher than its home, by its height above it and
/// by its altitude, metres: both drift on the ground.
const STARTED_M: f64 = 5.0;

/// A place nearer to 0, 0 than this is none, metres.
const NO_FIX_M: f64 = 1000.0;
/// An altitude nearer to 0 than this is none, metres.
const NO_ALTITUDE_M: f64 = 1.0;

/// Nanoseconds in a millisecond. Questions for the time are in whole ones, and our component id.
const NS_IN_MS: i64 = 1_000_000;

impl FlightVehicle<'_> {
    /// Asks for its time.
    pub(super) fn time_question(&self, now: Time, target: Address) -> Message {
        let now_ms = i64::try_from(now.0).unwrap_or_default();
        Message::Flight(FlightMessage::TimeSync {
            target,
            answer_ns: 0,
            asked_ns: now_ms.saturating_mul(NS_IN_MS) + i64::from(self.us.component),
        })
    }

    /// Takes in a message of this vehicle. `flight_ms` is the fleet's clock, `t0_ms` its T0.
    pub(crate) fn handle(
        &mut self,
        (now, flight_ms, t0_ms): (Time, f64, Option<f64>),
        from: Address,
        message: &Message,
    ) {
        match &mut self.stage {
            Stage::Sending(session) => session.handle(now, from, message),
            Stage::Reading(reading) => reading.handle(now, from, message),
            _ => {}
        }
        if from.system != self.of.sysid {
            return;
        }
        self.now = now;
        if let Message::TextChunk(chunk) = message {
            self.texts.chunks.take(now, from, chunk);
        }
        if let Message::Heartbeat(heartbeat) = message
            && self.is_autopilot(from, *heartbeat)
        {
            self.vehicle = Some((from, *heartbeat));
        }
        if !self.is_of_autopilot(from, message) {
            if let Message::StatusText { severity, text } = message
                && t0_ms.is_some()
            {
                self.take_text(
                    *severity,
                    &format!("component {} {}", from.component, says(text)),
                );
            }
            return;
        }
        self.heard = now;
        self.autopilot_message((now, flight_ms, t0_ms), message);
    }

    fn autopilot_message(
        &mut self,
        (now, flight_ms, t0_ms): (Time, f64, Option<f64>),
        message: &Message,
    ) {
        let t_s = self.sent_s(flight_ms, t0_ms);
        match message {
            Message::Heartbeat(heartbeat) => {
                self.heartbeat_at = now;
                self.heed_motors(*heartbeat, flight_ms, t0_ms.is_some());
                self.heartbeat(*heartbeat, t_s);
                if heartbeat.is_armed() && matches!(self.stage, Stage::Ended) && t0_ms.is_some() {
                    self.flies_on();
                }
            }
            Message::HomePosition { x, y, amsl_mm } => {
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "float32 is what missions have"
                )]
                let amsl_m = (f64::from(*amsl_mm) / 1000.0) as f32;
                let (x, y) = (*x, *y);
                self.home = Some(Home { x, y, amsl_m });
            }
            Message::AutopilotVersion {
                flight_software, ..
            } => self.version = Version::of_flight_software(*flight_software).or(self.version),
            Message::MissionCurrent {
                seq,
                total,
                opaque_ids,
                ..
            } => {
                (self.item, self.item_at) = (self.row(*seq), Some(now));
                let is_known = (1..u16::MAX).contains(total);
                self.total.now = is_known.then_some(usize::from(*total));
                self.heed_total(t0_ms.is_some());
                self.heed_ids(*opaque_ids, t0_ms.is_some());
                let now = self.total.now;
                let taken = self.total.next.take_if(|(items, _)| Some(*items) == now);
                if let Some((_, reference)) = taken {
                    self.of.reference = reference;
                }
            }
            Message::Mission(list) if t0_ms.is_none() => self.heed_writer(list),
            Message::StatusText { text, .. } if matches!(self.stage, Stage::Arming) => {
                self.warn(text);
            }
            Message::StatusText { severity, text } if t0_ms.is_some() => {
                self.take_text(*severity, &says(text));
            }
            Message::Flight(FlightMessage::Health(health)) => {
                self.health_at.insert(health.id(), now);
            }
            Message::Flight(message) => self.flight_message(now, flight_ms, t0_ms, t_s, message),
            _ => {}
        }
    }

    /// When a message was sent that came at `flight_ms`, seconds after T0: positions are dated by the clock of the
    /// vehicle, and everything else by how late they come.
    pub(in crate::flight::session) fn sent_s(&self, flight_ms: f64, t0_ms: Option<f64>) -> f64 {
        let last_ms = self.latest.map_or(f64::NEG_INFINITY, |(at_ms, _)| at_ms);
        let sent_ms = self.offset.sent_ms(flight_ms).max(last_ms).min(flight_ms);
        t0_ms.map_or(0.0, |t0_ms| (sent_ms - t0_ms).max(0.0) / 1000.0)
    }

    /// Whether a heartbeat is of the autopilot, and not of another component of the vehicle.
    fn is_autopilot(&self, from: Address, heartbeat: Heartbeat) -> bool {
        let is_same = |(autopilot, _)| autopilot == from || from.component == 1;
        heartbeat.autopilot != AUTOPILOT_INVALID && self.vehicle.is_none_or(is_same)
    }

    fn flight_message(
        &mut self,
        now: Time,
        flight_ms: f64,
        t0_ms: Option<f64>,
        t_s: f64,
        message: &FlightMessage,
    ) {
        match message {
            FlightMessage::Position(position) => {
                self.position_at = Some(now);
                if self.airborne || !self.has_no_fix_yet(position) {
                    self.position(flight_ms, t0_ms, position);
                }
            }
            FlightMessage::ItemReached { seq } => {
                let row = self.row(*seq);
                self.heed_word(Some(row));
                let flies = matches!(self.stage, Stage::Flying | Stage::Starting);
                if flies && self.flown.reach(row, t_s) {
                    let stop = self.progress.stop_of(row);
                    let of = stop.map_or_else(String::new, |id| format!(" (stop {id})"));
                    self.news.push_back(format!("item {row} reached{of}"));
                    self.progress.take_reached(row, t_s);
                }
            }
            FlightMessage::Landed(state) => {
                self.motors.height.take_landed(*state, now);
                self.heed_word(None);
            }
            FlightMessage::TimeSync { .. } => self.take_time((now, flight_ms), message),
            FlightMessage::CameraTrigger { seq } => self.pictured(*seq),
            FlightMessage::CameraFeedback { index, .. } => self.pictured(u32::from(*index)),
            FlightMessage::CommandAck {
                target,
                command,
                result,
            } if target.reaches(self.us) => {
                if *result == CommandResult::ACCEPTED {
                    self.heed_accepted(*command);
                }
                if let Some(pending) = &mut self.pending {
                    pending.answered(now, *command, *result);
                }
            }
            FlightMessage::Param { name, value } => {
                if self.disarm_parameter() == Some(name.as_str()) {
                    let bytewise = self.autopilot().conventions().bytewise_parameters;
                    self.disarm_s = Some(f64::from(value.value(bytewise)));
                }
                if let Some(settings) = &mut self.settings {
                    settings.heard(now, name, *value);
                }
            }
            _ => {}
        }
    }

    /// It has answered what its time was after we asked for it.
    fn take_time(&mut self, (now, flight_ms): (Time, f64), message: &FlightMessage) {
        let FlightMessage::TimeSync {
            target,
            answer_ns,
            asked_ns,
        } = message
        else {
            return;
        };
        let is_ours = asked_ns.rem_euclid(NS_IN_MS) == i64::from(self.us.component);
        let now_ms = i64::try_from(now.0).unwrap_or(i64::MAX);
        let asked_ms = asked_ns.div_euclid(NS_IN_MS);
        if *answer_ns == 0
            || !target.reaches(self.us)
            || !is_ours
            || !(1..=now_ms).contains(&asked_ms)
        {
            return;
        }
        let round_trip_ms = (now_ms - asked_ms).unsigned_abs();
        #[expect(
            clippy::cast_precision_loss,
            reason = "milliseconds of one flight, and since boot"
        )]
        let [asked_ms, now_ms, boot_ms] = [
            asked_ms as f64,
            now_ms as f64,
            *answer_ns as f64 / NS_IN_MS as f64,
        ];
        // The fleet's clock goes evenly.
        let sent_ms = flight_ms * (asked_ms / now_ms);
        self.offset.answered(boot_ms, sent_ms, flight_ms);
        self.checked.round_trip_ms = round_trip_ms;
    }

    /// It has taken a picture; of many along the way every tenth is said.
    fn pictured(&mut self, number: u32) {
        let is_new = self.pictures != Some(number);
        self.pictures = Some(number);
        if is_new && (number <= 3 || number.is_multiple_of(10)) {
            let at = self
                .stop_here()
                .map_or_else(String::new, |id| format!(" (stop {id})"));
            self.say_often(format!("picture {number}{at}"));
        }
    }

    /// The stop that it is at.
    fn stop_here(&self) -> Option<&str> {
        let (_, fix) = self.latest?;
        self.progress.stop_at(fix.place)
    }

    /// The row of a sequence number.
    fn row(&self, seq: u16) -> usize {
        usize::from(seq) + usize::from(self.autopilot().first_row())
    }

    fn position(&mut self, flight_ms: f64, t0_ms: Option<f64>, position: &Position) {
        if !position.is_known() {
            if (position.x, position.y) == (0, 0) && self.airborne {
                // It has lost its place, and still says how high it is.
                let t_s = (flight_ms - t0_ms.unwrap_or(flight_ms)) / 1000.0;
                self.take_placeless(t_s, position);
            }
            return self.note_invalid(position);
        }
        if t0_ms.is_none() {
            self.heed_restart(position.boot_ms);
        }
        self.own_clock = Some((position.boot_ms, flight_ms));
        let Some(aligned) = self.offset.align(f64::from(position.boot_ms), flight_ms) else {
            return;
        };
        if let Some(jump_s) = aligned.jump_s.filter(|_| t0_ms.is_some()) {
            self.say_often(clock_jumped(jump_s));
        }
        let at_ms = aligned.at_ms;
        let t_s = (at_ms - t0_ms.unwrap_or(at_ms)) / 1000.0;
        let fix = Fix {
            t_s,
            place: position.place(),
            amsl: self.motors.height.take(position, t_s),
            speed_mps: position.ground_speed_mps(),
            item: self.item,
            items: self.total.now.unwrap_or(0),
            boot_ms: Some(position.boot_ms),
        };
        let is_later = |(before_ms, _): (f64, Fix)| aligned.is_after(before_ms);
        if !self.latest.is_none_or(is_later) {
            return;
        }
        self.latest = Some((at_ms, fix));
        self.is_fresh = true;
        let is_away = !self.airborne && self.is_away(&fix);
        let is_up = self.heed_height(position, is_away);
        if is_up && !self.rests_on_ground(fix) {
            self.heed_takeoff();
        }
        if t0_ms.is_some() {
            self.heed_early_start(position.above_home_m(), &fix);
        }
        if matches!(
            self.stage,
            Stage::Flying | Stage::Starting | Stage::Rejoining { .. }
        ) {
            if is_up && !self.airborne {
                self.airborne = true;
                self.news.push_back("took off".to_owned());
            }
            if fix.t_s >= 0.0 {
                self.record_fix(fix);
            }
        } else if matches!(self.stage, Stage::Disarming(_)) && !self.flown.fixes.is_empty() {
            // Its flight is not over before its motors stand, or are left running.
            self.record_fix(fix);
        }
    }

    /// Whether it says a place near 0, 0 or an altitude of 0, and its home is elsewhere: an ArduPlane whose GPS has no fix
    /// yet does, tens of metres off in wind.
    fn has_no_fix_yet(&self, position: &Position) -> bool {
        let (nowhere, home) = (LatLon::of_e7(0, 0), &self.of.mission.home);
        let is_near = |place: LatLon, m: f64| place.chord_m(nowhere) < m;
        let is_level = |amsl_m: f64, m: f64| amsl_m.abs() < m;
        is_near(position.place(), NO_FIX_M) && !is_near(readiness::place(home), 2.0 * NO_FIX_M)
            || is_level(f64::from(position.amsl_mm) / 1000.0, NO_ALTITUDE_M)
                && !is_level(f64::from(home.amsl_m), 2.0 * STANDS_M)
    }

    /// Whether it did not wait for its start: from then on it is one that flies.
    fn heed_early_start(&mut self, above_home_m: f64, fix: &Fix) {
        let home_m = f64::from(self.of.mission.home.amsl_m);
        let up_m = above_home_m.min(fix.amsl.0 - home_m);
        if matches!(self.stage, Stage::Armed) && up_m > STARTED_M {
            self.stage = Stage::Flying;
        }
    }

    /// Whether it is in the air although its height above home, which may be wrong, does not show it.
    fn is_away(&self, fix: &Fix) -> bool {
        let up_m = fix.amsl.0 - f64::from(self.of.mission.home.amsl_m);
        let (home_m, _) = self.away_from_returns_m(*fix);
        up_m > UP_M || home_m > AWAY_M
    }

    fn heartbeat(&mut self, heartbeat: Heartbeat, t_s: f64) {
        let was = self.in_mission;
        // PX4 goes back to its last mode when its motors stop.
        if heartbeat.is_armed() || !matches!(self.stage, Stage::Flying) {
            self.in_mission = modes::is_mission(self.of.mission, heartbeat.custom_mode);
        }
        let has_stopped = self.has_stopped(heartbeat.is_armed(), t_s);
        match self.stage {
            Stage::Flying if has_stopped => self.stopped(heartbeat.custom_mode),
            Stage::Flying if was && !self.in_mission && self.instruction.is_none() => {
                // The alarm says by whom.
                self.left = true;
            }
            Stage::Flying
                if !was && self.in_mission && (self.left || self.instruction.is_some()) =>
            {
                self.left = false;
                if self.is_taken_back() {
                    self.taken_back = self.instruction.take();
                    self.holds = false;
                }
                if self.taken_back.is_none() {
                    self.say_mode("is on its mission again");
                }
            }
            _ => {}
        }
    }
}

/// What an operator reads of a clock that jumped, seconds.
fn clock_jumped(jump_s: f64) -> String {
    match jump_s < 0.0 {
        true => format!(
            "its clock went back by {:.0} s: its autopilot may have been started again",
            -jump_s
        ),
        false => format!("its clock went on by {jump_s:.0} s more than it should"),
    }
}
