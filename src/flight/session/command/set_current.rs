//! The item that a vehicle flies to is set by message, where the autopilot knows no command for it.

use crate::link::{Address, FlightMessage, Message, Time};

/// Between two sendings, milliseconds: while items are transferred PX4 does not listen.
const REPEAT_MS: u64 = 250;
/// Sendings without an answer before it is given up.
const MAX: u8 = 40;

/// `MISSION_SET_CURRENT`, sent until `MISSION_CURRENT` has it. PX4 of December 2024 answers
/// `MAV_CMD_DO_SET_MISSION_CURRENT` with "unsupported" (seen in its simulator).
#[derive(Clone, Debug)]
pub(crate) struct Setting {
    target: Address,
    seq: u16,
    /// Items of the mission that is meant: a vehicle may still speak of another.
    total: u16,
    due: Time,
    sent: u8,
    is_there: bool,
}

impl Setting {
    pub(crate) fn new(target: Address, seq: u16, total: u16, now: Time) -> Self {
        Self {
            target,
            seq,
            total,
            due: now,
            sent: 0,
            is_there: false,
        }
    }

    /// Takes in what the vehicle says of its mission.
    pub(crate) fn heard(&mut self, seq: u16, total: u16) {
        self.is_there |= self.sent > 0 && total == self.total && seq >= self.seq;
    }

    /// The message that is due, if any.
    pub(crate) fn poll(&mut self, now: Time) -> Option<Message> {
        if self.is_there || self.sent >= MAX || now < self.due {
            return None;
        }
        self.sent += 1;
        self.due = now + REPEAT_MS;
        let (target, seq) = (self.target, self.seq);
        Some(Message::Flight(FlightMessage::SetCurrent { target, seq }))
    }

    /// Whether it flies there; none while that is not known.
    pub(crate) fn outcome(&self, now: Time) -> Option<bool> {
        let is_silent = self.sent >= MAX && now >= self.due;
        (self.is_there || is_silent).then_some(self.is_there)
    }
}
