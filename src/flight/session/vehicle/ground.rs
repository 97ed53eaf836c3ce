//! Whether a vehicle is on the ground or in the air: by its own word, else by its height and how it moves.

use super::arming::HEARTBEATS;
use super::ending::{HIGH_M, Motors};
use super::{AIRBORNE_M, FlightVehicle, Instruction, Stage};
use crate::flight::record::Fix;
use crate::flight::session::arrival;
use crate::flight::session::end::End;
use crate::link::{LandedState, Position};
use crate::mission::command;

/// A vehicle that has come to rest on the ground stops its motors within this time, seconds; slower than this
/// it rests, m/s, and moves up and down by less, metres.
const RUNS_ON_S: f64 = 30.0;
const RESTS_MPS: f64 = 0.5;
const RESTS_M: f64 = 1.0;
/// A vehicle that has flown and is lower than this over the ground, metres, and slower than this, m/s, is on it after
/// this time, seconds; but where it puts a load down. What lies there twitches.
const GROUND_M: f64 = 2.0;
const TWITCHES_MPS: f64 = 1.5;
const STANDS_S: f64 = 2.0;
/// One that says that it is in the air, or takes off, has risen by this at least, metres, where its height is known.
const LIFTED_M: f64 = 1.5;
/// An older position does not show that it has not taken off since, milliseconds.
const STANDS_MS: u64 = 1400;

impl FlightVehicle<'_> {
    /// Whether a position shows it in the air, or `is_away` does: heights drift while it stands.
    pub(super) fn heed_height(&mut self, position: &Position, is_away: bool) -> bool {
        self.heed_standing(position);
        let risen_m = self.motors.height.risen_m(position);
        let state = self.motors.height.landed_state(self.now);
        let says_up = [LandedState::IN_AIR, LandedState::TAKEOFF].map(Some);
        let has_lifted = says_up.contains(&state) && risen_m > LIFTED_M;
        self.motors.height.is_up = is_away || has_lifted || risen_m > AIRBORNE_M;
        self.motors.height.is_up
    }

    /// Takes in where it stands while its motors do.
    fn heed_standing(&mut self, position: &Position) {
        let is_safe = self
            .heartbeat_now()
            .is_some_and(|heartbeat| !heartbeat.is_armed());
        let above_m = position.above_home_m();
        let is_low = self.motors.agl_m.unwrap_or(above_m).abs() <= HIGH_M;
        let rests = is_low && position.ground_speed_mps() <= RESTS_MPS;
        if is_safe && rests {
            self.motors.height.stand(above_m);
        }
    }

    /// Whether its last word is that it is in the air.
    pub(super) fn says_in_air(&self) -> bool {
        self.motors.height.landed_state(self.now) == Some(LandedState::IN_AIR)
    }

    /// It says that it is in the air, or which item it has reached: where its height is not known that shows its takeoff.
    pub(super) fn heed_word(&mut self, reached: Option<usize>) {
        let flies = matches!(self.stage, Stage::Flying | Stage::Starting);
        let is_armed = self
            .heartbeat_now()
            .is_some_and(|heartbeat| heartbeat.is_armed());
        if !flies || !is_armed || self.airborne || self.is_positioned() {
            return;
        }
        let mut items = self.of.mission.items.iter();
        let takes_off = [command::NAV_TAKEOFF, command::NAV_VTOL_TAKEOFF];
        let takeoff = items.position(|item| takes_off.contains(&item.command));
        let is_past = |row: usize| takeoff.is_some_and(|index| row > index);
        if self.says_in_air() || reached.is_some_and(is_past) {
            self.airborne = true;
            self.news
                .push_back("took off by its own word: its position is not known".to_owned());
        }
    }

    /// It was taken for one on the ground, and flies: it is watched again.
    pub(super) fn flies_on(&mut self) {
        if !self.motors.ended || self.motors.run < HEARTBEATS || !self.motors.height.is_up {
            return;
        }
        self.news
            .push_back("its motors run, and it is in the air: it is watched again".to_owned());
        let ordered = self.motors.if_airborne;
        let (height, agl_m) = (self.motors.height, self.motors.agl_m);
        self.motors = Motors::default();
        (self.motors.height, self.motors.agl_m) = (height, agl_m);
        (self.flown.end, self.flown.until_s) = (End::default(), None);
        self.still_armed = None;
        self.airborne = true;
        self.stage = Stage::Flying;
        if let Some(instruction) = ordered {
            self.instruct(instruction);
        }
    }

    /// Says once that it has come to rest on the ground and its motors run on.
    pub(super) fn check_motors(&mut self, fix: Fix) {
        let is_low = self.motors.agl_m.is_some_and(|agl_m| agl_m <= HIGH_M);
        let may_be_down = is_low && fix.speed_mps <= RESTS_MPS && self.is_at_its_landing(fix);
        let amsl_m = fix.amsl.0;
        let is_still = |(_, at_m): &(f64, f64)| (amsl_m - at_m).abs() <= RESTS_M;
        let rests = self.motors.rests.filter(is_still);
        self.motors.rests = may_be_down.then(|| rests.unwrap_or((fix.t_s, amsl_m)));
        let puts_down = {
            let reference = &self.of.reference;
            reference.dips_at(fix.item, reference.frame().to_plan(fix.place))
        };
        self.motors.was_high |= self.motors.agl_m.is_some_and(|agl_m| agl_m > HIGH_M);
        let is_low = self.motors.agl_m.is_some_and(|agl_m| agl_m <= GROUND_M);
        let is_slow = fix.speed_mps <= TWITCHES_MPS;
        let is_grounded = is_low && is_slow && self.motors.was_high && !puts_down;
        let low = self.motors.low.filter(is_still);
        self.motors.low = is_grounded.then(|| low.unwrap_or((fix.t_s, amsl_m)));
        if self.motors.rests.is_none() {
            // Its motors may twitch, its positions drift.
            self.motors.rests = self.motors.low;
        }
        let since_s = self.motors.rests.map(|(since_s, _)| fix.t_s - since_s);
        let run_on = since_s.is_some_and(|since_s| since_s >= RUNS_ON_S);
        if run_on && !self.motors.run_on {
            let text = "is on the ground, and its motors run on: keep away from it";
            self.news.push_back(text.to_owned());
        }
        self.motors.run_on = run_on;
    }

    /// Whether a position of now shows where one stands that has not taken off.
    pub(super) fn is_known_to_stand(&self) -> bool {
        let is_new = |at| self.now - at <= STANDS_MS;
        self.position_at.is_some_and(is_new)
    }

    /// Whether it has come down and is on the ground: in doubt it is not, and gets its order.
    pub(crate) fn stands(&self) -> bool {
        let Some((_, fix)) = self.latest.filter(|_| self.airborne) else {
            return false;
        };
        let is_long = |(since_s, _): (f64, f64)| fix.t_s - since_s >= STANDS_S;
        let says_down = self.motors.height.landed_state(self.now) == Some(LandedState::ON_GROUND);
        let rests = says_down || !self.says_in_air() && fix.speed_mps <= RESTS_MPS;
        rests && self.motors.low.is_some_and(is_long)
    }

    /// Whether it is on the ground as far as is known, so that its motors are ordered to stop.
    pub(super) fn is_down(&self) -> bool {
        (self.motors.run_on || self.stands()) && !self.says_in_air()
    }

    /// Whether it is where it has come to rest while its motors run.
    pub(super) fn rests_on_ground(&self, fix: Fix) -> bool {
        let rests = self.motors.rests.filter(|_| self.motors.run_on);
        rests.is_some_and(|(_, at_m)| (fix.amsl.0 - at_m).abs() <= 3.0 * RESTS_M)
    }

    /// Whether it is where it lands: by its order, or at the end of its mission.
    fn is_at_its_landing(&self, fix: Fix) -> bool {
        let near_m = arrival::landing_m(self.of.mission.airframe);
        let (home_m, rally_m) = self.away_from_returns_m(fix);
        match self.instruction {
            Some(Instruction::Hold) => false,
            Some(Instruction::Land) => true,
            Some(Instruction::Return) => home_m.min(rally_m) <= near_m,
            None => {
                let reference = &self.of.reference;
                reference.lands && arrival::away_m(reference, fix.place) <= near_m
            }
        }
    }
}
