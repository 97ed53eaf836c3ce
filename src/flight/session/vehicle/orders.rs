//! What a vehicle is ordered to do, and what it answers.

use super::{FlightVehicle, Instruction, Stage};
use crate::flight::session::end::End;
use crate::flight::session::modes;
use crate::link::{Command, Time};

/// How long arming is tried, milliseconds: position estimates settle after a start.
const ARMING_MS: u64 = 20_000;
/// Between two tries, milliseconds.
const AGAIN_MS: u64 = 1000;
/// Texts that are remembered while it is armed, at most.
const MOST_WARNINGS: usize = 5;

impl FlightVehicle<'_> {
    pub(in crate::flight) fn arm(&mut self, now: Time) {
        self.stage = Stage::Arming;
        self.arming = Some((now + ARMING_MS, Time(u64::MAX)));
        self.command(modes::arm(self.of.mission));
    }

    pub(in crate::flight) fn start(&mut self) {
        self.stage = Stage::Starting;
        self.command([modes::start(self.of.mission)]);
    }

    pub(in crate::flight) fn disarm(&mut self) {
        self.stage = Stage::Ended;
        self.command([modes::disarm()]);
    }

    /// Orders it to hold or to land, if it flies.
    pub(in crate::flight) fn instruct(&mut self, instruction: Instruction) {
        if !matches!(self.stage, Stage::Flying | Stage::Starting) {
            return;
        }
        let order = match instruction {
            Instruction::Hold => Some(modes::hold(self.of.mission)),
            Instruction::Land => modes::land(self.of.mission),
        };
        match order {
            Some(order) => {
                (self.instruction, self.holds) = (Some(instruction), false);
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
            Stage::Arming => self.stage = Stage::Armed,
            Stage::Starting => self.stage = Stage::Flying,
            _ => {}
        }
    }

    pub(crate) fn disobeyed(&mut self, now: Time, what: &str) {
        self.pending = None;
        self.orders.clear();
        match self.stage {
            Stage::Arming => match &mut self.arming {
                Some((until, again)) if now < *until => *again = now + AGAIN_MS,
                _ => self.refuse_to_arm(what),
            },
            Stage::Starting => self.end(End::Failed(what.to_owned())),
            _ => self.said.push_back(what.to_owned()),
        }
    }

    /// Remembers a text that it sent while it was armed.
    pub(crate) fn warn(&mut self, text: &str) {
        let is_known = self.warnings.iter().any(|known| known == text);
        if !is_known && self.warnings.len() < MOST_WARNINGS {
            self.warnings.push(text.to_owned());
        }
    }

    /// What it says of it stands beside the answer.
    fn refuse_to_arm(&mut self, what: &str) {
        let said = std::mem::take(&mut self.warnings);
        let why = std::iter::once(what.to_owned()).chain(said);
        self.stage = Stage::Refused(vec![why.collect::<Vec<_>>().join("; ")]);
    }
}
