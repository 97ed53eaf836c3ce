//! A vehicle whose flight is taken over from its record: by its heartbeat and a position of now it
//! flies on, has landed meanwhile, or never took off.

use super::arming::HEARTBEATS;
use super::{AIRBORNE_M, FlightVehicle, Instruction, Stage};
use crate::flight::itinerary::progress::Progress;
use crate::flight::launch::parameters::SettingsCheck;
use crate::flight::record::Flight;
use crate::flight::record::handoff::Ended;
use crate::flight::session::end::End;
use crate::flight::session::modes;

impl FlightVehicle<'_> {
    /// Takes over everything that was recorded of it; `t0_ms` is T0 on the fleet's clock.
    pub(in crate::flight::session) fn take_over(&mut self, recorded: &Flight, t0_ms: f64) {
        let flown = recorded.flown.clone();
        self.progress = Progress::recorded(recorded, self.of.mission.airframe);
        self.progress.forget_news();
        let home_m = f64::from(self.of.mission.home.amsl_m);
        let was_up = |last: &crate::flight::record::Fix| last.amsl.0 - home_m > AIRBORNE_M;
        self.airborne = flown.fixes.iter().any(was_up);
        let last = flown.fixes.last();
        self.latest = last.map(|fix| (t0_ms + 1000.0 * fix.t_s, *fix));
        self.item = last.map_or(0, |fix| fix.item);
        self.total.ready = last.map(|fix| fix.items).filter(|items| *items > 0);
        let known = flown.fixes.len();
        self.flown = flown;
        let bytewise = self.autopilot().conventions().bytewise_parameters;
        let mission = self.of.mission;
        self.settings = Some(SettingsCheck::of_flight(mission, bytewise, self.now));
        let ordered = None;
        self.stage = Stage::Rejoining { known, ordered };
    }

    /// Its flight was over before it was taken over. One of the record has its last line there.
    pub(in crate::flight::session) fn take_over_ended(
        &mut self,
        (ended, is_recorded): (Ended, bool),
    ) {
        self.flown.end = End::of_words(&ended.end);
        self.flown.until_s = ended.t_s;
        (self.motors.ended, self.motors.is_recorded) = (!is_recorded, is_recorded);
        self.news
            .push_back(format!("its flight is over: {}", self.flown.end.sentence()));
        self.stage = Stage::Ended;
    }

    /// It was not heard since its flight was taken over: nothing is recorded of its end.
    pub(in crate::flight::session) fn give_up_unheard(&mut self) {
        let text =
            "was not heard since the flight was taken over: whether it is in the air is not known";
        self.news.push_back(text.to_owned());
        self.motors.is_unheard = true;
        self.stage = Stage::Ended;
    }

    pub(in crate::flight::session) fn is_unheard(&self) -> bool {
        self.motors.is_unheard
    }

    /// Whether its end is in the record that was taken over.
    pub(in crate::flight::session) fn has_recorded_end(&self) -> bool {
        self.motors.is_recorded
    }

    /// Whether it is in the air at the end, and a heartbeat shows it.
    pub(in crate::flight::session) fn is_left_up(&self) -> bool {
        let is_armed = self
            .heartbeat_now()
            .is_some_and(|heartbeat| heartbeat.is_armed());
        let is_failed = matches!(self.flown.end, End::Failed(_));
        matches!(self.stage, Stage::Ended)
            && is_failed
            && is_armed
            && self.airborne
            && !self.is_down()
    }

    /// Whether its flight is over and its motors were seen to stand.
    pub(in crate::flight::session) fn is_known_down(&self) -> bool {
        let is_safe = self
            .heartbeat_now()
            .is_some_and(|heartbeat| !heartbeat.is_armed());
        let is_over = matches!(self.stage, Stage::Ended) && self.flown.end != End::NotFlown;
        is_over && self.still_armed.is_none() && (self.motors.ended || is_safe)
    }

    /// Decides where it is on its flight, once it was heard: by a position, or by heartbeats that show it armed.
    pub(in crate::flight::session) fn check_rejoin(&mut self) {
        let Stage::Rejoining { known, ordered } = self.stage else {
            return;
        };
        let is_placed = self.flown.fixes.len() > known;
        let runs = self.motors.run >= HEARTBEATS;
        let Some((_, heartbeat)) = self.vehicle.filter(|_| is_placed || runs) else {
            return;
        };
        match (heartbeat.is_armed(), self.airborne) {
            (true, is_up) if is_up || self.in_mission || !is_placed => {
                self.rejoin_in_the_air(heartbeat.custom_mode);
                if let Some(instruction) = ordered {
                    self.instruct(instruction);
                }
            }
            (true, _) => {
                self.news.push_back("is armed on the ground".to_owned());
                self.stage = Stage::Armed;
                if ordered.is_some() {
                    self.disarm(None);
                }
            }
            (false, true) => {
                let end = self.landing();
                self.news
                    .push_back("came down while nobody watched".to_owned());
                self.end(end);
            }
            (false, false) => {
                let why = "has not taken off, and is disarmed";
                self.end(End::Failed(why.to_owned()));
            }
        }
    }

    /// Whether its mode may be that of an order.
    fn may_obey(&self, order: Instruction, custom_mode: u32) -> bool {
        let mission = self.of.mission;
        let lands = modes::is_land(mission, custom_mode);
        match order {
            Instruction::Hold => modes::is_hold(mission, custom_mode),
            Instruction::Land => lands,
            Instruction::Return => lands || modes::is_return(mission, custom_mode),
        }
    }

    /// An order of the record that its mode does not show is given again, except a return: its way was judged from where
    /// it was then.
    fn repeat(&mut self, order: Instruction) {
        let (verb, is_return) = (order.verb(), order == Instruction::Return);
        let what = match is_return {
            true => "is not ordered again: hold or land it",
            false => "is ordered again",
        };
        self.news.push_back(format!(
            "is watched again: it flies its mission although it was ordered to {verb}, which {what}"
        ));
        if !is_return {
            self.instruct(order);
        }
    }

    /// An order of before is known by the record, or by its mode.
    fn rejoin_in_the_air(&mut self, custom_mode: u32) {
        self.stage = Stage::Flying;
        let mode = modes::name(self.of.mission, custom_mode);
        let ordered = Instruction::of_action(self.flown.ordered);
        let text = if let Some(order) = ordered.filter(|of| self.may_obey(*of, custom_mode)) {
            self.begin_instruction(order);
            format!("was ordered to {}, and is in {mode}", order.verb())
        } else if let Some(order) = ordered.filter(|_| self.in_mission) {
            // It stands: had somebody sent the vehicle on its mission again, the record would say so.
            return self.repeat(order);
        } else if self.in_mission {
            "flies its mission".to_owned()
        } else if modes::is_hold(self.of.mission, custom_mode) {
            self.begin_instruction(Instruction::Hold);
            "is in the mode of a hold; who ordered it is not known".to_owned()
        } else if modes::is_land(self.of.mission, custom_mode) {
            self.begin_instruction(Instruction::Land);
            self.hold.is_of_others = true;
            "lands where it is; who ordered it is not known".to_owned()
        } else {
            self.left = true;
            format!("is off its mission, in {mode}")
        };
        self.news.push_back(format!("is watched again: it {text}"));
    }
}
