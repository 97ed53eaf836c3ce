//! Clears one list of one vehicle (`MISSION_CLEAR_ALL`, `MISSION_ACK`).

use std::collections::VecDeque;

use crate::link::message::{Address, Body, Message, MissionResult, Route};
use crate::link::time::Time;

/// Wait for the `MISSION_ACK`, milliseconds (mission service guide).
const CLEAR_MS: u64 = 1500;
/// Repetitions before the vehicle counts as silent. PX4 is silent while it is busy, up to 5 s.
const MAX_CLEARS: u32 = 8;

/// A clearing in progress; see the [driver contract](crate::link#driver-contract).
#[derive(Debug)]
pub struct Clear {
    route: Route,
    deadline: Time,
    outbox: VecDeque<Body>,
    again: Time,
    sent: u32,
    complaint: Option<MissionResult>,
    outcome: Option<Result<Cleared, MissionResult>>,
}

/// Clearing was requested. Only a read-back shows whether the list is empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cleared {
    /// Whether the vehicle confirmed; otherwise its `MISSION_ACK` was lost, or it is silent.
    pub acknowledged: bool,
}

impl Clear {
    /// Starts a clearing.
    #[must_use]
    pub fn new(route: Route, deadline: Time, now: Time) -> Self {
        let mut clear = Self {
            route,
            deadline,
            outbox: VecDeque::new(),
            again: now,
            sent: 0,
            complaint: None,
            outcome: None,
        };
        clear.ask(now);
        clear
    }

    /// Takes in a message of any sender. Busy vehicles answer ERROR or DENIED and get
    /// the request again; every other refusal is final.
    pub fn handle(&mut self, _now: Time, from: Address, message: &Message) {
        let Some(Body::Ack { result, .. }) = self.route.accept(from, message) else {
            return;
        };
        if self.outcome.is_some() {
            return;
        }
        match result {
            MissionResult::ACCEPTED => self.outcome = Some(Ok(Cleared { acknowledged: true })),
            MissionResult::ERROR
            | MissionResult::DENIED
            | MissionResult::INVALID_SEQUENCE
            | MissionResult::OPERATION_CANCELLED => self.complaint = Some(result),
            fatal => self.outcome = Some(Err(fatal)),
        }
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Time) {
        if self.outcome.is_some() || self.poll_timeout().is_none_or(|due| now < due) {
            return;
        }
        if now >= self.deadline || self.sent >= MAX_CLEARS {
            let unconfirmed = Cleared {
                acknowledged: false,
            };
            self.outcome = Some(self.complaint.map_or(Ok(unconfirmed), Err));
        } else {
            self.ask(now);
        }
    }

    /// The next message to send, if there is one.
    pub fn poll_transmit(&mut self) -> Option<Message> {
        self.outbox.pop_front().map(|body| self.route.message(body))
    }

    /// When [`Clear::handle_timeout`] is due; `None` at the end.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Time> {
        self.outcome
            .is_none()
            .then(|| self.again.min(self.deadline))
    }

    /// How it ended, once it has.
    #[must_use]
    pub fn outcome(&self) -> Option<Result<Cleared, MissionResult>> {
        self.outcome
    }

    /// How many messages were repeated.
    #[must_use]
    pub fn repeats(&self) -> u32 {
        self.sent - 1
    }

    fn ask(&mut self, now: Time) {
        self.outbox.push_back(Body::ClearAll);
        self.sent += 1;
        self.again = now + CLEAR_MS;
    }
}
