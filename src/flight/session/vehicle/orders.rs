//! What a vehicle is ordered to do, and what it answers.

use super::{FlightVehicle, Instruction, Stage};
use crate::flight::session::end::End;
use crate::flight::session::modes;
use crate::link::Command;

impl FlightVehicle<'_> {
    pub(in crate::flight) fn start(&mut self) {
        self.stage = Stage::Starting;
        self.command([modes::start(self.of.mission)]);
    }

    /// It could not be started at its departure: others are not where the verdict has them by now.
    pub(in crate::flight) fn stays_behind(&mut self, after_s: f64) {
        let why = format!("was not started: its departure was {after_s:.0} s ago");
        self.news
            .push_back(format!("{why}, and it stays on the ground"));
        self.disarm(Some(End::Failed(why)));
    }

    /// Says that it is on its mission again, although it was ordered to leave it.
    pub(in crate::flight) fn say_taken_back(&mut self) {
        if self.taken_back.take().is_some() {
            self.news.push_back("is on its mission again".to_owned());
        }
    }

    /// Stops the motors of a vehicle whose mission was started and which has not taken off, instead of an
    /// order that it would take on the ground. Whether it is such a one: without a position that is not known.
    pub(in crate::flight) fn stays_on_ground(&mut self, instruction: Instruction) -> bool {
        let was_started = matches!(self.stage, Stage::Flying | Stage::Starting);
        if !was_started || self.airborne || !self.is_known_to_stand() {
            return false;
        }
        let why = format!("was ordered to {} before it took off", instruction.verb());
        self.disarm(Some(End::Failed(why)));
        if let Stage::Disarming(disarming) = &mut self.stage {
            disarming.if_airborne = Some(instruction);
        }
        true
    }

    /// Orders it to hold or to land, if it flies, or once it is known that it does.
    pub(in crate::flight) fn instruct(&mut self, instruction: Instruction) {
        match &mut self.stage {
            Stage::Flying | Stage::Starting => {}
            Stage::Rejoining { ordered, .. } => {
                *ordered = Some(instruction);
                return;
            }
            _ => return,
        }
        let order = match instruction {
            Instruction::Hold => Some(modes::hold(self.of.mission)),
            Instruction::Land => modes::land(self.of.mission),
            Instruction::Return => Some(modes::return_to_launch(self.of.mission)),
        };
        match order {
            Some(order) => {
                self.begin_instruction(instruction);
                self.command([order]);
            }
            None => self.land_by_mission(),
        }
    }

    /// Gives commands, one after the other, each when the one before it was accepted.
    pub(crate) fn command(&mut self, orders: impl IntoIterator<Item = Command>) {
        self.pending = None;
        self.orders = orders.into_iter().collect();
    }

    pub(crate) fn obeyed(&mut self) {
        if !self.orders.is_empty() {
            return;
        }
        match self.stage {
            Stage::Arming => self.accept_arming(),
            Stage::Starting => self.stage = Stage::Flying,
            _ => {}
        }
    }

    pub(crate) fn disobeyed(&mut self, what: &str) {
        self.pending = None;
        self.orders.clear();
        let is_armed = self
            .vehicle
            .is_some_and(|(_, heartbeat)| heartbeat.is_armed());
        match self.stage {
            Stage::Arming => self.retry_arming(what),
            Stage::Disarming(_) => self.refuse_to_disarm(what),
            Stage::Starting if self.airborne || (self.in_mission && is_armed) => {
                self.news
                    .push_back(format!("{what}, and flies all the same"));
                self.stage = Stage::Flying;
            }
            Stage::Starting => self.disarm(Some(End::Failed(what.to_owned()))),
            _ if self.instruction.is_some() && !self.hold.is_news(what) => {}
            _ => self.news.push_back(what.to_owned()),
        }
    }
}
