//! A vehicle in flight is given another mission and goes on with it, without a stop.

use super::command::pending::{Answer, PendingCommand};
use super::command::set_current::Setting;
use super::modes;
use crate::flight::conformance::leg::leg_at;
use crate::flight::conformance::proof::CROSS_TRACK_M;
use crate::geodesy::{Amsl, LatLon, LocalFrame, PlanPoint};
use crate::link::{
    Address, Body, Command, CommandResult, FlightMessage, Heartbeat, Message, MissionMessage,
    MissionResult, Order, Session, Time, Verdict,
};
use crate::mission::{VehicleMission, command};
use crate::spec::Autopilot;

/// `MAV_MISSION_TYPE_MISSION`.
const MISSION: u8 = 0;

/// A vehicle is at a stop within this, metres, and rests there below this speed, m/s.
const AT_STOP_M: f64 = 10.0;
const RESTS_MPS: f64 = 1.0;

/// How long the item that it flies to is waited for, once it has the new mission, milliseconds.
const CURRENT_MS: u64 = 2000;

/// The problem of a vehicle that does not answer any more.
const UNSAID: &str = "holds the new mission, and did not say that it goes on with it";

/// What a vehicle in flight shall go on with.
#[derive(Clone, Copy, Debug)]
pub struct Onward<'a> {
    /// Id in the spec.
    pub vehicle: &'a str,
    /// The new mission.
    pub mission: &'a VehicleMission,
    /// Where the leg to the first item ahead begins.
    pub origin: LatLon,
    /// Indices of items: the first ahead, and the first that was not in the mission before
    /// (`ahead..new` lie on the present way).
    pub ahead: usize,
    /// See `ahead`.
    pub new: usize,
    /// Items of the mission before, and the index of the first of them in the new one.
    pub held: (usize, usize),
}

/// The transfer of a new mission to a vehicle in flight, and the command to go on with
/// it where the vehicle is. Same driver contract as [`Session`].
///
/// ArduPilot replaces items under way and keeps its place in the list: as long as it flies
/// to an item that both missions have it needs no command. Where it is does not say so: at a
/// waypoint it may fly on to the next one already, and where that is new, to the old place. So
/// what it says of its current item after it took the mission decides. PX4 takes the new mission as a
/// whole and begins it, so the current item is set as soon as it has it, before
/// the mission is read back.
#[derive(Debug)]
pub struct Diversion<'a> {
    session: Session<'a>,
    us: Address,
    vehicle: Address,
    onward: Onward<'a>,
    /// Where the vehicle was last heard to be, and how fast it flew to the east and the north, m/s.
    here: Option<(LatLon, (f64, f64))>,
    /// The last mode that it was heard in.
    mode: Option<u32>,
    /// Index in the new mission of the item that it flew to by its mission before.
    current: Option<usize>,
    /// Until when it may say to which item of the new mission it flies.
    says_by: Option<Time>,
    pending: Option<PendingCommand>,
    /// The same by message.
    setting: Option<Setting>,
    /// Whether the vehicle has the new mission and goes on with it; or what is wrong.
    going: Option<Result<(), String>>,
    outcome: Option<Result<(), String>>,
}

impl<'a> Diversion<'a> {
    /// Begins the transfer in the name of `us`, to a vehicle that was heard already.
    #[must_use]
    pub fn new(
        onward: Onward<'a>,
        (vehicle, heartbeat): (Address, Heartbeat),
        others: Vec<u8>,
        us: Address,
        now: Time,
    ) -> Self {
        let order = Order {
            vehicle: onward.vehicle,
            sysid: vehicle.system,
            mission: onward.mission,
            // It is armed, and that is meant.
            force: true,
            others,
        };
        let mut session = Session::new(order, us, now).in_the_air();
        session.handle(now, vehicle, &Message::Heartbeat(heartbeat));
        Self {
            session,
            us,
            vehicle,
            onward,
            here: None,
            mode: None,
            current: None,
            says_by: None,
            pending: None,
            setting: None,
            going: None,
            outcome: None,
        }
    }

    /// Takes in a message from any sender.
    pub fn handle(&mut self, now: Time, from: Address, message: &Message) {
        self.session.handle(now, from, message);
        if from != self.vehicle {
            return;
        }
        match message {
            Message::Heartbeat(heartbeat) => self.mode = Some(heartbeat.custom_mode),
            Message::Flight(FlightMessage::Position(position)) if position.is_known() => {
                let [north, east, _] = position.velocity_cmps.map(|cmps| f64::from(cmps) / 100.0);
                self.here = Some((position.place(), (east, north)));
            }
            Message::Flight(FlightMessage::CommandAck {
                target,
                command,
                result,
            }) if target.reaches(self.us) => {
                if let Some(pending) = &mut self.pending {
                    pending.answered(now, *command, *result);
                }
            }
            Message::MissionCurrent { seq, total, .. } => {
                self.heed_current(now, usize::from(*seq), *total);
                if let Some(setting) = &mut self.setting {
                    setting.heard(*seq, *total);
                }
            }
            Message::Mission(MissionMessage {
                mission_type: MISSION,
                target,
                body:
                    Body::Ack {
                        result: MissionResult::ACCEPTED,
                        ..
                    },
            }) if target.reaches(self.us) => self.has_the_mission(now),
            _ => {}
        }
    }

    /// The item that it flies to: of the mission that it had before, or of the new one.
    fn heed_current(&mut self, now: Time, seq: usize, total: u16) {
        let (held, begin) = self.onward.held;
        let (total, is_known) = (usize::from(total), (1..u16::MAX).contains(&total));
        let first = usize::from(self.onward.mission.autopilot.first_row());
        let row = (seq + first).checked_sub(1);
        if self.says_by.is_some() {
            if !is_known || total == self.onward.mission.items.len() {
                self.goes_to(row, now);
            }
        } else if !self.has_new() && total == held {
            let index = row.and_then(|row| row.checked_sub(begin));
            self.current = index.filter(|index| *index < self.onward.new);
        }
    }

    /// Whether it has the new mission, by its own word.
    fn has_new(&self) -> bool {
        let is_ordered = self.pending.is_some() || self.setting.is_some();
        self.says_by.is_some() || is_ordered || self.going.is_some()
    }

    /// It flies to an item of the new mission, or is not heard to. One that both missions have is
    /// left to it; to a new one it would fly where the old one was.
    fn goes_to(&mut self, index: Option<usize>, now: Time) {
        self.says_by = None;
        match index {
            Some(index) if index < self.onward.new => self.going = Some(Ok(())),
            _ => self.order(self.onward.new, now),
        }
    }

    /// The item of a stop that a vehicle at a place and with a speed is making: going on with another
    /// would leave something out there, or do it twice.
    fn stays_at(&self, (here, (east_mps, north_mps)): (LatLon, (f64, f64))) -> Option<usize> {
        let index = self.current?;
        let item = self.onward.mission.items.get(index)?;
        let stays = match item.command {
            command::NAV_WAYPOINT => item.params[0] > 0.0,
            other => other == command::NAV_PAYLOAD_PLACE,
        };
        let is_at = item.place()?.chord_m(here) < AT_STOP_M;
        let rests = east_mps.hypot(north_mps) < RESTS_MPS;
        (stays && is_at && rests).then_some(index)
    }

    /// The vehicle holds the new mission, by its own word.
    fn has_the_mission(&mut self, now: Time) {
        if self.has_new() {
            return;
        }
        let on = self.here.map(|here| {
            let (cross_track_m, next) = self.on(here);
            (cross_track_m, self.stays_at(here).unwrap_or(next))
        });
        let Some((cross_track_m, next)) = on else {
            self.going = Some(Err(
                "took its new mission, and does not say where".to_owned()
            ));
            return;
        };
        if cross_track_m > CROSS_TRACK_M {
            self.going = Some(Err(format!(
                "took its new mission too late, {cross_track_m:.0} m from the new path: hold or land it"
            )));
        }
        let goes_on = self.onward.mission.autopilot == Autopilot::ArduPilot;
        if goes_on && next < self.onward.new && cross_track_m <= CROSS_TRACK_M {
            self.says_by = Some(now + CURRENT_MS);
            return;
        }
        self.order(next, now);
    }

    /// Orders it to go on with an item of the new mission.
    fn order(&mut self, next: usize, now: Time) {
        let whole = |count: usize| u16::try_from(count).unwrap_or(0);
        match self.onward.mission.autopilot {
            // It counts home.
            Autopilot::ArduPilot => {
                let seq = f32::from(whole(next + 1));
                let order = Command::new(Command::DO_SET_MISSION_CURRENT, [seq]);
                self.pending = Some(PendingCommand::new(self.vehicle, order, now));
            }
            Autopilot::Px4 => {
                let total = whole(self.onward.mission.items.len());
                self.setting = Some(Setting::new(self.vehicle, whole(next), total, now));
            }
        }
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Time) {
        self.session.handle_timeout(now);
        if self.outcome.is_some() {
            return;
        }
        if self.says_by.is_some_and(|until| now >= until) {
            self.goes_to(None, now);
        }
        if let (Some(pending), None) = (&self.pending, &self.going) {
            self.going = match pending.answer(now) {
                Answer::None => None,
                Answer::Result(CommandResult::ACCEPTED) => Some(Ok(())),
                Answer::Result(result) => Some(Err(format!(
                    "holds the new mission, and refused to go on with it: {result}"
                ))),
                Answer::Silence => Some(Err(UNSAID.to_owned())),
            };
        }
        if let (Some(setting), None) = (&self.setting, &self.going) {
            let there = |is_there: bool| is_there.then_some(()).ok_or(UNSAID.to_owned());
            self.going = setting.outcome(now).map(there);
        }
        let Some(report) = self.session.report() else {
            return;
        };
        match &report.verdict {
            Verdict::Verified => {
                // An acknowledgement that was lost is found out by reading back.
                self.has_the_mission(now);
                self.outcome = self
                    .going
                    .clone()
                    .map(|going| going.and_then(|()| self.flies_it()));
            }
            Verdict::Failed(failure) => self.outcome = Some(Err(failure.to_string())),
            Verdict::Refused(refusal) => self.outcome = Some(Err(refusal.to_string())),
        }
    }

    /// Whether it flies its mission, as far as it was heard: somebody may have taken it over meanwhile.
    fn flies_it(&self) -> Result<(), String> {
        let mission = self.onward.mission;
        let other = self.mode.filter(|mode| !modes::is_mission(mission, *mode));
        match other {
            None => Ok(()),
            Some(mode) => Err(format!(
                "holds the new mission, and does not fly it: it is in {}",
                modes::name(mission, mode)
            )),
        }
    }

    /// How far a place is from the way ahead, metres, and the item at the end of the leg that
    /// the vehicle is on: so it never turns back to a place that it has passed meanwhile.
    fn on(&self, (here, velocity_mps): (LatLon, (f64, f64))) -> (f64, usize) {
        let frame = LocalFrame::new(here);
        let at = |place| PlanPoint {
            at: frame.to_plan(place),
            amsl: Amsl(0.0),
        };
        let items = self.onward.mission.items.iter().enumerate();
        let ahead = items.skip(self.onward.ahead);
        let (numbers, points): (Vec<usize>, Vec<PlanPoint>) = ahead
            .filter_map(|(index, item)| Some((index, at(item.place()?))))
            .unzip();
        let way: Vec<PlanPoint> = std::iter::once(at(self.onward.origin))
            .chain(points)
            .collect();
        let on = leg_at(&way, at(here), velocity_mps);
        on.and_then(|(leg, cross_track_m)| Some((cross_track_m, *numbers.get(leg)?)))
            .unwrap_or((f64::INFINITY, self.onward.ahead))
    }

    /// The next message to send at a time, if there is one.
    pub fn poll_transmit(&mut self, now: Time) -> Option<Message> {
        // First where to go on: PX4 does not listen to that while it is read.
        let setting = self.setting.as_mut().and_then(|setting| setting.poll(now));
        setting
            .or_else(|| self.session.poll_transmit())
            .or_else(|| self.pending.as_mut()?.poll(now))
    }

    /// How it came out, once it is over: the vehicle goes on with its new mission, or
    /// what was not done.
    #[must_use]
    pub fn outcome(&self) -> Option<&Result<(), String>> {
        self.outcome.as_ref()
    }
}
