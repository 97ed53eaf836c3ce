//! One vehicle of the fleet, from the first heartbeat to the end of its flight.

mod arming;
mod checks;
mod ending;
mod ground;
mod height;
mod hold;
mod messages;
mod obeying;
mod orders;
mod rejoin;
mod requests;
mod texts;

use std::collections::{BTreeMap, VecDeque};

use super::clock::Offset;
use super::command::pending::{Answer, PendingCommand};
use super::end::End;
use super::orbit::Orbit;
use crate::autopilot::{Autopilot, Version};
use crate::flight::conformance::reference::ReferenceTrajectory;
use crate::flight::itinerary::progress::Progress;
use crate::flight::itinerary::stops::Itinerary;
use crate::flight::launch::parameters::SettingsCheck;
use crate::flight::record::{Fix, Flown, Plan};
use crate::link::{
    Address, Command, CommandResult, Heartbeat, Message, Order, Reading, Session, Time,
};
use crate::mission::{Home, VehicleMission};
use crate::spec::Action;
pub(super) use arming::ARMING_MS;
use arming::{Arming, Disarming, SeenDisarmed};
use checks::Checked;
use ending::Motors;
use hold::HoldWatch;
use texts::Texts;

/// Higher than where it stood by this much a vehicle is in the air, metres: heights drift.
const AIRBORNE_M: f64 = 3.0;

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
    pub reference: ReferenceTrajectory,
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
    /// Its flight is taken over from a record with this number of its positions; what it was ordered to do
    /// before it was heard.
    Rejoining {
        known: usize,
        ordered: Option<Instruction>,
    },
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

    /// As the record has it.
    pub(crate) fn action(self) -> Action {
        match self {
            Self::Hold => Action::Hold,
            Self::Return => Action::Return,
            Self::Land => Action::Land,
        }
    }

    /// Out of a record.
    pub(crate) fn of_action(action: Action) -> Option<Self> {
        let all = [Self::Hold, Self::Return, Self::Land];
        all.into_iter().find(|of| of.action() == action)
    }
}

/// How many items it said to hold: last, and when all was as planned.
#[derive(Clone, Debug, Default)]
pub(crate) struct Totals {
    pub(crate) now: Option<usize>,
    pub(crate) ready: Option<usize>,
    /// The plan that it is sent in flight, and its number of items: it flies it from when it holds as many.
    pub(crate) next: Option<(usize, ReferenceTrajectory)>,
    /// When it was sent, seconds after T0; none once it was said that it does not hold it.
    pub(crate) sent_s: Option<f64>,
}

/// Whether it stays in the air at the end of its mission. It is monitored as long as others fly.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stay {
    pub(crate) loiters: bool,
    /// Whether its last position shows that: positions have noise.
    pub(crate) is_shown: bool,
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
    pub(crate) heartbeat_at: Time,
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
    /// When each report of its own health last came, by the id of the message.
    health_at: BTreeMap<u32, Time>,
    /// Positions that are none on earth.
    invalid_positions: usize,
    pub(crate) texts: Texts,
    /// Items on board without home, as the vehicle says.
    pub(crate) total: Totals,
    checked: Checked,
    airborne: bool,
    /// Heartbeats in a row that show its motors to stand, and to run, while it flies or after that.
    pub(crate) motors: Motors,
    pub(crate) instruction: Option<Instruction>,
    /// Whether it is seen to hold as ordered. It is still monitored: somebody may bring it down.
    pub(crate) holds: bool,
    hold: HoldWatch,
    pub(crate) in_mission: bool,
    /// Whether an event has reported that it left its mission.
    left: bool,
    /// What it was ordered to do when it went on with its mission by itself, or by somebody else's order.
    pub(crate) taken_back: Option<Instruction>,
    orbit: Orbit,
    pub(crate) stay: Stay,
    pub(crate) flown: Flown,
    outbox: VecDeque<Message>,
    news: VecDeque<String>,
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

/// Nothing is done yet of what it shall do.
fn progress_of(of: &Assignment<'_>) -> Progress {
    let mut progress = Progress::new(of.itinerary.clone(), of.mission.airframe);
    progress.add_mission(&Plan {
        items: of.mission.items.len(),
        reference: of.reference.clone(),
        from_s: 0.0,
    });
    progress
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
        let progress = progress_of(&of);
        Self {
            of,
            us,
            now,
            stage,
            vehicle: None,
            heard: now,
            heartbeat_at: now,
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
            requested: Time(0),
            offset: Offset::default(),
            latest: None,
            is_fresh: false,
            item: 0,
            position_at: None,
            item_at: None,
            health_at: BTreeMap::new(),
            invalid_positions: 0,
            texts: Texts::default(),
            total: Totals::default(),
            checked: Checked::default(),
            airborne: false,
            motors: Motors::default(),
            instruction: None,
            holds: false,
            hold: HoldWatch::default(),
            in_mission: false,
            left: false,
            taken_back: None,
            orbit: Orbit::default(),
            stay: Stay::default(),
            flown: Flown::default(),
            outbox: VecDeque::new(),
            news: VecDeque::new(),
            pictures: None,
            progress,
            set_params,
            force,
        }
    }

    /// Whether a message comes from its autopilot. A gimbal or a camera may use the same component id: its
    /// heartbeats have another autopilot, or none.
    pub(crate) fn is_of_autopilot(&self, from: Address, message: &Message) -> bool {
        self.vehicle.is_some_and(|(autopilot, known)| {
            let is_other = |heartbeat: &Heartbeat| heartbeat.autopilot != known.autopilot;
            autopilot == from
                && !matches!(message, Message::Heartbeat(heartbeat) if is_other(heartbeat))
        })
    }

    /// The last heartbeat of its autopilot.
    pub(crate) fn heartbeat_now(&self) -> Option<Heartbeat> {
        self.vehicle.map(|(_, heartbeat)| heartbeat)
    }

    /// Whether it is in flight, and known where on it.
    pub(crate) fn is_watched(&self) -> bool {
        matches!(self.stage, Stage::Starting | Stage::Flying)
    }

    /// Whether it took off.
    pub(crate) fn has_taken_off(&self) -> bool {
        self.airborne
    }

    fn autopilot(&self) -> Autopilot {
        self.of.mission.autopilot
    }

    /// Does what is due; requests a position every `interval_us` microseconds.
    pub(crate) fn tick(&mut self, now: Time, interval_us: f32) {
        self.now = now;
        self.work(now);
        self.order_motors();
        let counted = self.texts.poll(now);
        self.news.extend(counted);
        if let Some((address, _)) = self.vehicle {
            self.request(now, address, interval_us);
            self.request_settings(now, address);
            if self.pending.is_none()
                && let Some(order) = self.orders.pop_front()
            {
                self.pending = Some(PendingCommand::new(address, order, now));
            }
        }
        let may_be_sent = !self.is_to_return() || self.is_placed();
        if let Some(pending) = &mut self.pending {
            let message = may_be_sent.then(|| pending.poll(now)).flatten();
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
        self.news.push_back(end.sentence());
        self.flown.end = end;
        self.stage = Stage::Ended;
    }

    pub(crate) fn poll_transmit(&mut self) -> Option<Message> {
        self.outbox.pop_front()
    }

    pub(crate) fn poll_news(&mut self) -> Option<String> {
        let news = self.news.pop_front();
        news.or_else(|| self.progress.poll_news())
    }
}
