//! One vehicle of the fleet, from the first heartbeat to the end of its flight.

mod arming;
mod checks;
mod ending;
mod hold;
mod orders;
mod rejoin;
mod texts;

use std::collections::VecDeque;

use super::clock::Offset;
use super::command::pending::{Answer, PendingCommand, is_for};
use super::end::End;
use super::modes;
use super::orbit::Orbit;
use crate::autopilot::{Autopilot, Version};
use crate::flight::conformance::reference::Reference;
use crate::flight::itinerary::progress::Progress;
use crate::flight::itinerary::stops::Itinerary;
use crate::flight::launch::parameters::SettingsCheck;
use crate::flight::record::{Fix, Flown};
use crate::link::{
    AUTOPILOT_INVALID, Address, Command, CommandResult, FlightMessage, Health, Heartbeat, Message,
    Order, Position, Reading, Session, Time,
};
use crate::mission::{Home, VehicleMission};
pub(super) use arming::ARMING_MS;
use arming::{Arming, Disarming, SeenDisarmed};
use hold::HoldWatch;
use texts::TextLimit;

/// Above home by this much a vehicle is in the air, metres.
const AIRBORNE_M: f64 = 1.5;

/// What one vehicle shall do.
#[derive(Clone, Debug)]
pub struct Assignment<'a> {
    /// Id in the spec.
    pub vehicle: &'a str,
    /// Its system id.
    pub sysid: u8,
    /// Number of the link that it is on: what comes over others is not from it.
    pub link: usize,
    /// What it shall hold.
    pub mission: &'a VehicleMission,
    /// The planned flight.
    pub reference: Reference,
    /// When its mission is started, seconds after T0; a delay that is encoded in the
    /// mission is none of it.
    pub start_s: f64,
    /// Whether its mission is transferred first, instead of only read.
    pub upload: bool,
    /// Its stops, and what they are for.
    pub itinerary: Itinerary,
}

/// Where it is on the way to its flight, and in it.
#[derive(Debug)]
pub(crate) enum Stage<'a> {
    /// Its mission is sent.
    Sending(Box<Session<'a>>),
    /// Its mission is read.
    Reading(Box<Reading>),
    /// Home, position and parameters.
    Checking { until: Time },
    /// All is as planned.
    Ready,
    /// It is not; in sentences.
    Refused(Vec<String>),
    /// Commands until the heartbeat shows that the motors run.
    Arming,
    /// The motors run.
    Armed,
    /// Commands until the heartbeat shows that the motors stand.
    Disarming(Disarming),
    /// Its flight is taken over from a record with this number of its positions.
    Rejoining { known: usize },
    /// The mission was ordered to start.
    Starting,
    /// The mission is flown.
    Flying,
    /// It is over.
    Ended,
}

/// An order of the fleet to a vehicle in flight.
/// A later one is the stronger.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Instruction {
    Hold,
    Return,
    Land,
}

impl Instruction {
    pub(crate) fn verb(self) -> &'static str {
        match self {
            Self::Hold => "hold",
            Self::Return => "return",
            Self::Land => "land",
        }
    }
}

#[derive(Debug)]
pub(crate) struct FlightVehicle<'a> {
    pub(crate) of: Assignment<'a>,
    us: Address,
    /// Time of the last call.
    now: Time,
    pub(crate) stage: Stage<'a>,
    /// The autopilot: its address and its last heartbeat.
    pub(crate) vehicle: Option<(Address, Heartbeat)>,
    /// When anything was heard of the autopilot, and when its last heartbeat.
    pub(crate) heard: Time,
    beat_at: Time,
    pub(crate) home: Option<Home>,
    /// The version of its firmware.
    version: Option<Version>,
    settings: Option<SettingsCheck<'a>>,
    problems: Vec<String>,
    /// What it said while it was to be armed.
    warnings: Vec<String>,
    pending: Option<PendingCommand>,
    orders: VecDeque<Command>,
    /// Set from the first order to arm on.
    arming: Option<Arming>,
    /// When it was last seen disarmed.
    seen_disarmed: Option<SeenDisarmed>,
    /// Its own clock, milliseconds, and the fleet's when it said that.
    own_clock: Option<(u32, f64)>,
    /// After how long on the ground it disarms itself, seconds, by its own word.
    disarm_s: Option<f64>,
    /// Why it may be armed on the ground at the end, as a whole sentence.
    pub(crate) still_armed: Option<String>,
    /// Whether that was reported.
    pub(crate) is_warned: bool,
    requested: Time,
    offset: Offset,
    /// The last position on the fleet's clock, milliseconds of flight time.
    pub(crate) latest: Option<(f64, Fix)>,
    /// Whether it came with the last message.
    pub(crate) is_fresh: bool,
    pub(crate) item: usize,
    /// When its last position came.
    position_at: Option<Time>,
    /// When it last said which item is its current one.
    item_at: Option<Time>,
    /// When it last reported its own health.
    health_at: Option<Time>,
    /// Positions that are none on earth.
    invalid_positions: usize,
    texts: TextLimit,
    /// Items on board without home, as the vehicle says.
    total: Option<usize>,
    airborne: bool,
    pub(crate) instruction: Option<Instruction>,
    /// Whether it is seen to hold as ordered. It is still monitored: somebody may bring it down.
    pub(crate) holds: bool,
    hold: HoldWatch,
    pub(crate) in_mission: bool,
    /// Whether an event has reported that it left its mission.
    left: bool,
    orbit: Orbit,
    pub(crate) flown: Flown,
    outbox: VecDeque<Message>,
    said: VecDeque<String>,
    /// The number of its last picture.
    pictures: Option<u32>,
    /// What it was seen to do of its itinerary.
    pub(crate) progress: Progress,
    set_params: bool,
    force: bool,
}

impl<'a> Stage<'a> {
    /// The transfer of its mission, or its reading.
    fn begin(of: &Assignment<'a>, others: Vec<u8>, us: Address, now: Time) -> Self {
        if of.upload {
            let order = Order {
                vehicle: of.vehicle,
                sysid: of.sysid,
                mission: of.mission,
                force: false,
                others,
            };
            Self::Sending(Box::new(Session::new(order, us, now)))
        } else {
            Self::Reading(Box::new(Reading::new(Some(of.sysid), us, now)))
        }
    }
}

impl<'a> FlightVehicle<'a> {
    pub(crate) fn new(
        of: Assignment<'a>,
        others: Vec<u8>,
        us: Address,
        (set_params, force): (bool, bool),
        now: Time,
    ) -> Self {
        let stage = Stage::begin(&of, others, us, now);
        let mut progress = Progress::new(of.itinerary.clone(), of.mission.airframe);
        progress.add_mission(of.mission.items.len(), &of.reference);
        Self {
            of,
            us,
            now,
            stage,
            vehicle: None,
            heard: now,
            beat_at: now,
            home: None,
            version: None,
            settings: None,
            problems: Vec::new(),
            warnings: Vec::new(),
            pending: None,
            orders: VecDeque::new(),
            arming: None,
            seen_disarmed: None,
            own_clock: None,
            disarm_s: None,
            still_armed: None,
            is_warned: false,
            requested: Time(0),
            offset: Offset::default(),
            latest: None,
            is_fresh: false,
            item: 0,
            position_at: None,
            item_at: None,
            health_at: None,
            invalid_positions: 0,
            texts: TextLimit::default(),
            total: None,
            airborne: false,
            instruction: None,
            holds: false,
            hold: HoldWatch::default(),
            in_mission: false,
            left: false,
            orbit: Orbit::default(),
            flown: Flown::default(),
            outbox: VecDeque::new(),
            said: VecDeque::new(),
            pictures: None,
            progress,
            set_params,
            force,
        }
    }

    /// Whether a message comes from its autopilot.
    pub(crate) fn is_from_autopilot(&self, from: Address) -> bool {
        self.vehicle.is_some_and(|(autopilot, _)| autopilot == from)
    }

    /// The last heartbeat of its autopilot.
    pub(crate) fn heartbeat_now(&self) -> Option<Heartbeat> {
        self.vehicle.map(|(_, beat)| beat)
    }

    /// Whether it took off.
    pub(crate) fn has_taken_off(&self) -> bool {
        self.airborne
    }

    fn autopilot(&self) -> Autopilot {
        self.of.mission.autopilot
    }

    /// Takes in a message of this vehicle. `flight_ms` is the fleet's clock, `t0_ms` its T0.
    pub(crate) fn handle(
        &mut self,
        (now, flight_ms, t0_ms): (Time, f64, Option<f64>),
        from: Address,
        message: &Message,
    ) {
        match &mut self.stage {
            Stage::Sending(session) => session.handle(now, from, message),
            Stage::Reading(reading) => reading.handle(now, from, message),
            _ => {}
        }
        if from.system != self.of.sysid {
            return;
        }
        self.now = now;
        if let Message::Heartbeat(beat) = message
            && self.is_autopilot(from, *beat)
        {
            self.vehicle = Some((from, *beat));
        }
        if self.vehicle.is_none_or(|(autopilot, _)| autopilot != from) {
            if let Message::StatusText { severity, text } = message
                && t0_ms.is_some()
            {
                self.take_text(
                    *severity,
                    &format!("component {} says: {text}", from.component),
                );
            }
            return;
        }
        self.heard = now;
        self.autopilot_message((now, flight_ms, t0_ms), message);
    }

    fn autopilot_message(
        &mut self,
        (now, flight_ms, t0_ms): (Time, f64, Option<f64>),
        message: &Message,
    ) {
        let t_s = (flight_ms - t0_ms.unwrap_or(flight_ms)) / 1000.0;
        match message {
            Message::Heartbeat(beat) => {
                self.beat_at = now;
                self.heed_motors(*beat, flight_ms, t0_ms.is_some());
                self.heartbeat(*beat);
            }
            Message::HomePosition { x, y, amsl_mm } => {
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "float32 is what missions have"
                )]
                let amsl_m = (f64::from(*amsl_mm) / 1000.0) as f32;
                let (x, y) = (*x, *y);
                self.home = Some(Home { x, y, amsl_m });
            }
            Message::AutopilotVersion {
                flight_software, ..
            } => self.version = Version::of_flight_software(*flight_software).or(self.version),
            Message::MissionCurrent { seq, total, .. } => {
                (self.item, self.item_at) = (self.row(*seq), Some(now));
                let is_known = (1..u16::MAX).contains(total);
                self.total = is_known.then_some(usize::from(*total));
            }
            Message::StatusText { text, .. } if matches!(self.stage, Stage::Arming) => {
                self.warn(text);
            }
            Message::StatusText { severity, text } if t0_ms.is_some() => {
                self.take_text(*severity, &format!("says: {text}"));
            }
            Message::Flight(FlightMessage::Health(Health::System(_))) => {
                self.health_at = Some(now);
            }
            Message::Flight(message) => self.flight_message(now, flight_ms, t0_ms, t_s, message),
            _ => {}
        }
    }

    /// Whether a heartbeat is of the autopilot, and not of another component of the vehicle.
    fn is_autopilot(&self, from: Address, beat: Heartbeat) -> bool {
        let is_same = |(autopilot, _)| autopilot == from || from.component == 1;
        beat.autopilot != AUTOPILOT_INVALID && self.vehicle.is_none_or(is_same)
    }

    fn flight_message(
        &mut self,
        now: Time,
        flight_ms: f64,
        t0_ms: Option<f64>,
        t_s: f64,
        message: &FlightMessage,
    ) {
        match message {
            FlightMessage::Position(position) => {
                self.position_at = Some(now);
                self.position(flight_ms, t0_ms, position);
            }
            FlightMessage::ItemReached { seq } => {
                let row = self.row(*seq);
                let flies = matches!(self.stage, Stage::Flying | Stage::Starting);
                if flies && self.flown.reach(row, t_s) {
                    let at = self
                        .stop_here()
                        .map_or_else(String::new, |id| format!(" (stop {id})"));
                    self.said.push_back(format!("item {row} reached{at}"));
                    self.progress.take_reached(row, t_s);
                }
            }
            FlightMessage::CameraTrigger { seq } => self.pictured(*seq),
            FlightMessage::CameraFeedback { index, .. } => self.pictured(u32::from(*index)),
            FlightMessage::CommandAck {
                target,
                command,
                result,
            } if is_for(self.us, *target) => {
                if let Some(pending) = &mut self.pending {
                    pending.answered(now, *command, *result);
                }
            }
            FlightMessage::Param { name, value } => {
                if self.disarm_parameter() == Some(name.as_str()) {
                    let bytewise = self.autopilot().conventions().bytewise_parameters;
                    self.disarm_s = Some(f64::from(value.value(bytewise)));
                }
                if let Some(settings) = &mut self.settings {
                    settings.heard(now, name, *value);
                }
            }
            _ => {}
        }
    }

    /// It has taken a picture; of many along the way every tenth is said.
    fn pictured(&mut self, number: u32) {
        let is_new = self.pictures != Some(number);
        self.pictures = Some(number);
        if is_new && (number <= 3 || number.is_multiple_of(10)) {
            let at = self
                .stop_here()
                .map_or_else(String::new, |id| format!(" (stop {id})"));
            self.said.push_back(format!("picture {number}{at}"));
        }
    }

    /// The stop that it is at.
    fn stop_here(&self) -> Option<&str> {
        let (_, fix) = self.latest?;
        self.progress.stop_at(fix.place)
    }

    /// The row of a sequence number.
    fn row(&self, seq: u16) -> usize {
        usize::from(seq) + usize::from(self.autopilot().first_row())
    }

    fn position(&mut self, flight_ms: f64, t0_ms: Option<f64>, position: &Position) {
        if !position.is_known() {
            return self.note_invalid(position);
        }
        self.own_clock = Some((position.boot_ms, flight_ms));
        let at_ms = self.offset.align(f64::from(position.boot_ms), flight_ms);
        let fix = Fix {
            t_s: (at_ms - t0_ms.unwrap_or(at_ms)) / 1000.0,
            place: position.place(),
            amsl: position.amsl(),
            speed_mps: position.ground_speed_mps(),
            item: self.item,
            items: self.total.unwrap_or(0),
            boot_ms: Some(position.boot_ms),
        };
        let is_later = self.latest.is_none_or(|(before, _)| at_ms > before);
        if !is_later {
            return;
        }
        self.latest = Some((at_ms, fix));
        self.is_fresh = true;
        let is_up = position.above_home_m() > AIRBORNE_M;
        if is_up {
            self.heed_takeoff();
        }
        if matches!(
            self.stage,
            Stage::Flying | Stage::Starting | Stage::Rejoining { .. }
        ) {
            if is_up && !self.airborne {
                self.airborne = true;
                self.said.push_back("took off".to_owned());
            }
            if fix.t_s >= 0.0 {
                self.flown.fixes.push(fix);
                self.progress.take(&fix);
            }
        }
    }

    fn heartbeat(&mut self, beat: Heartbeat) {
        let was = self.in_mission;
        self.in_mission = modes::is_mission(self.of.mission, beat.custom_mode);
        match self.stage {
            Stage::Flying if !beat.is_armed() => {
                let end = match (self.airborne, self.instruction) {
                    (false, _) => End::Failed("stopped its motors before it took off".to_owned()),
                    (true, Some(Instruction::Hold)) if self.hold.was_in_mode() => {
                        End::StoppedAfterHold
                    }
                    (true, Some(Instruction::Land))
                        if self.hold.was_in_mode()
                            || modes::is_land(self.of.mission, beat.custom_mode) =>
                    {
                        End::LandedEarly
                    }
                    (true, Some(Instruction::Return)) if self.hold.was_in_mode() => self.returned(),
                    (true, _) => self.landing(),
                };
                self.end(end);
            }
            Stage::Flying if was && !self.in_mission && self.instruction.is_none() => {
                // The alarm says by whom.
                self.left = true;
            }
            Stage::Flying
                if !was && self.in_mission && (self.left || self.instruction.is_some()) =>
            {
                self.left = false;
                self.said.push_back("is on its mission again".to_owned());
                if self.is_taken_back() {
                    (self.instruction, self.holds) = (None, false);
                }
            }
            _ => {}
        }
    }

    /// Does what is due; requests a position every `interval_us` microseconds.
    pub(crate) fn tick(&mut self, now: Time, interval_us: f32) {
        self.now = now;
        self.work(now);
        self.order_motors();
        let dropped = self.texts.poll(now);
        self.said.extend(dropped);
        if let Some((address, _)) = self.vehicle {
            self.request(now, address, interval_us);
            if let Some(settings) = &mut self.settings {
                let message = settings.poll(now, address);
                self.outbox.extend(message);
            }
            if self.pending.is_none()
                && let Some(order) = self.orders.pop_front()
            {
                self.pending = Some(PendingCommand::new(address, order, now));
            }
        }
        if let Some(pending) = &mut self.pending {
            let message = pending.poll(now);
            self.outbox.extend(message);
            match pending.answer(now) {
                Answer::None => {}
                Answer::Result(CommandResult::ACCEPTED) => {
                    self.pending = None;
                    self.obeyed();
                }
                Answer::Result(result) => {
                    let command = pending.command();
                    // Refused or not, a hold or a landing is ordered again.
                    self.holds = false;
                    self.disobeyed(&format!("refused command {command} with {result}"));
                }
                Answer::Silence => {
                    let command = pending.command();
                    self.disobeyed(&format!("did not answer command {command}"));
                }
            }
        }
    }

    pub(crate) fn end(&mut self, end: End) {
        self.say_what_was_dropped();
        self.said.push_back(end.sentence());
        self.flown.end = end;
        self.stage = Stage::Ended;
    }

    pub(crate) fn poll_transmit(&mut self) -> Option<Message> {
        self.outbox.pop_front()
    }

    pub(crate) fn poll_said(&mut self) -> Option<String> {
        let said = self.said.pop_front();
        said.or_else(|| self.progress.poll_news())
    }
}
