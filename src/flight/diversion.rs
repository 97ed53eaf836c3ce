//! A vehicle in flight is given another mission and goes on with it, without a stop.

use super::asking::{Answer, Asking};
use super::reference::to_segment;
use crate::geodesy::{Amsl, LatLon, LocalFrame, PlanPoint};
use crate::link::{
    Address, Command, CommandResult, FlightMessage, Message, Order, Session, Time, Verdict,
};
use crate::mission::VehicleMission;
use crate::spec::Autopilot;

/// The transfer of a new mission to a vehicle in flight, and the command to go on with
/// it where the vehicle is. Same driver contract as [`Session`].
///
/// ArduPilot replaces items under way and keeps its place in the list; PX4 takes the new
/// mission as a whole and begins it. Both are told where to go on.
#[derive(Debug)]
pub struct Diversion<'a> {
    session: Session<'a>,
    vehicle: Address,
    mission: &'a VehicleMission,
    /// Where the vehicle was last heard to be.
    here: Option<LatLon>,
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
            mission,
            here: None,
            asking: None,
            outcome: None,
        }
    }

    /// Takes in a message, whoever sent it.
    pub fn handle(&mut self, now: Time, from: Address, message: &Message) {
        self.session.handle(now, from, message);
        if let Message::Flight(FlightMessage::Position(position)) = message
            && from.system == self.vehicle.system
        {
            self.here = Some(LatLon {
                lat_deg: f64::from(position.x) / 1e7,
                lon_deg: f64::from(position.y) / 1e7,
            });
        }
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
                        "holds the new mission, and refused to go on with it: {result}"
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
                let order = Command::new(Command::SET_MISSION_CURRENT, [self.next_seq()]);
                self.asking = Some(Asking::new(self.vehicle, order, now));
            }
            Verdict::Failed(failure) => self.outcome = Some(Err(failure.to_string())),
            Verdict::Refused(refusal) => self.outcome = Some(Err(refusal.to_string())),
        }
    }

    /// The item to go on with: the end of the leg that the vehicle is nearest to, so that
    /// it never turns back to a place that it has passed meanwhile.
    fn next_seq(&self) -> f32 {
        let first = match self.mission.autopilot {
            Autopilot::ArduPilot => 1,
            Autopilot::Px4 => 0,
        };
        let index = self.here.map_or(0, |here| self.next_item(here));
        f32::from(u16::try_from(index + first).unwrap_or(0))
    }

    fn next_item(&self, here: LatLon) -> usize {
        let frame = LocalFrame::new(here);
        let at = |place| PlanPoint {
            at: frame.to_plan(place),
            amsl: Amsl(0.0),
        };
        let items = self.mission.items.iter().enumerate();
        let places: Vec<(usize, PlanPoint)> = items
            .filter_map(|(index, item)| Some((index, at(item.place()?))))
            .collect();
        let nearest = places
            .windows(2)
            .map(|pair| {
                let (distance_m, share) = to_segment(at(here), pair[0].1, pair[1].1);
                // Before the first place the vehicle goes there.
                let next = if share > 0.0 { pair[1].0 } else { pair[0].0 };
                (distance_m, next)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or(0, |(_, next)| next)
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
