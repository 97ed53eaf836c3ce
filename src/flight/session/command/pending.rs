//! One command, sent until it is answered.

use crate::link::{Address, Command, CommandResult, FlightMessage, Message, Time};

/// Between two sendings, milliseconds.
const REPEAT_MS: u64 = 500;
/// Sendings without an answer before it is given up.
const MAX: u8 = 12;

/// A command on its way.
#[derive(Clone, Debug)]
pub(crate) struct PendingCommand {
    target: Address,
    order: Command,
    due: Time,
    sent: u8,
    result: Option<CommandResult>,
}

/// Where a command is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// Not answered yet.
    None,
    /// Answered.
    Result(CommandResult),
    /// Never answered.
    Silence,
}

impl PendingCommand {
    pub(crate) fn new(target: Address, order: Command, now: Time) -> Self {
        Self {
            target,
            order,
            due: now,
            sent: 0,
            result: None,
        }
    }

    pub(crate) fn command(&self) -> u16 {
        self.order.command
    }

    /// Takes in an answer to some command.
    pub(crate) fn answered(&mut self, now: Time, command: u16, result: CommandResult) {
        if command != self.order.command {
            return;
        }
        if result == CommandResult::IN_PROGRESS {
            // It lives: the wait begins anew.
            (self.due, self.sent) = (now + 4 * REPEAT_MS, 1);
        } else {
            self.result = Some(result);
        }
    }

    /// The message that is due, if any.
    pub(crate) fn poll(&mut self, now: Time) -> Option<Message> {
        if self.result.is_some() || self.sent >= MAX || now < self.due {
            return None;
        }
        let order = Command {
            confirmation: self.sent,
            ..self.order
        };
        self.sent += 1;
        self.due = now + REPEAT_MS;
        let target = self.target;
        Some(Message::Flight(FlightMessage::Command { target, order }))
    }

    pub(crate) fn answer(&self, now: Time) -> Answer {
        match self.result {
            Some(result) => Answer::Result(result),
            None if self.sent >= MAX && now >= self.due => Answer::Silence,
            None => Answer::None,
        }
    }
}
