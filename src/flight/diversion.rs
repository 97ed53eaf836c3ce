//! A vehicle in flight is given another mission and goes on with it, without a stop.

use super::asking::{Answer, Asking};
use crate::link::{
    Address, Command, CommandResult, FlightMessage, Message, Order, Session, Time, Verdict,
};
use crate::mission::VehicleMission;
use crate::spec::Autopilot;

/// The transfer of a new mission to a vehicle in flight, and the command to go on with
/// its first item. Same driver contract as [`Session`].
///
/// ArduPilot replaces items under way and keeps its place in the list; PX4 takes the new
/// mission as a whole and begins it. Both are told where to go on.
#[derive(Debug)]
pub struct Diversion<'a> {
    session: Session<'a>,
    vehicle: Address,
    autopilot: Autopilot,
    asking: Option<Asking>,
    outcome: Option<Result<(), String>>,
}

impl<'a> Diversion<'a> {
    /// Begins the transfer in the name of `us`.
    #[must_use]
    pub fn new(
        (id, vehicle): (&'a str, Address),
        mission: &'a VehicleMission,
        others: Vec<u8>,
        us: Address,
        now: Time,
    ) -> Self {
        let order = Order {
            vehicle: id,
            sysid: vehicle.system,
            mission,
            // It is armed, and that is meant.
            force: true,
            others,
        };
        Self {
            session: Session::new(order, us, now),
            vehicle,
            autopilot: mission.autopilot,
            asking: None,
            outcome: None,
        }
    }

    /// Takes in a message, whoever sent it.
    pub fn handle(&mut self, now: Time, from: Address, message: &Message) {
        self.session.handle(now, from, message);
        if let (
            Some(asking),
            Message::Flight(FlightMessage::CommandAck {
                command, result, ..
            }),
        ) = (&mut self.asking, message)
            && from.system == self.vehicle.system
        {
            asking.answered(now, *command, *result);
        }
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Time) {
        self.session.handle_timeout(now);
        if self.outcome.is_some() {
            return;
        }
        match &self.asking {
            None => self.look_at_the_transfer(now),
            Some(asking) => {
                self.outcome = match asking.answer(now) {
                    Answer::None => None,
                    Answer::Result(CommandResult::ACCEPTED) => Some(Ok(())),
                    Answer::Result(result) => Some(Err(format!(
                        "holds the new mission, and refused to go on with its first item: {result}"
                    ))),
                    Answer::Silence => Some(Err(
                        "holds the new mission, and did not say that it goes on with it".to_owned(),
                    )),
                };
            }
        }
    }

    fn look_at_the_transfer(&mut self, now: Time) {
        let Some(report) = self.session.report() else {
            return;
        };
        match &report.verdict {
            Verdict::Verified => {
                let first = match self.autopilot {
                    Autopilot::ArduPilot => 1.0,
                    Autopilot::Px4 => 0.0,
                };
                let order = Command::new(Command::SET_MISSION_CURRENT, [first]);
                self.asking = Some(Asking::new(self.vehicle, order, now));
            }
            Verdict::Failed(failure) => self.outcome = Some(Err(failure.to_string())),
            Verdict::Refused(refusal) => self.outcome = Some(Err(refusal.to_string())),
        }
    }

    /// The next message to send at a time, if there is one.
    pub fn poll_transmit(&mut self, now: Time) -> Option<Message> {
        self.session
            .poll_transmit()
            .or_else(|| self.asking.as_mut()?.poll(now))
    }

    /// How it came out, once it is over: the vehicle goes on with its new mission, or
    /// what was not done.
    #[must_use]
    pub fn outcome(&self) -> Option<&Result<(), String>> {
        self.outcome.as_ref()
    }
}
