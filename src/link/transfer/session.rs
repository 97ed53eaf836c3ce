//! The whole transfer to one vehicle: discovery, identification, then fence, rally and
//! mission, each sent, read back and compared.
//!
//! Fence before mission, because PX4 checks a mission against the fence on board. A list
//! that must be empty is read first and cleared if it is not, so that no old fence stays.
//! At the end all lists are looked at once more: another station, or a restart of the
//! vehicle, may have changed one while the next was transferred.

mod ending;
mod last_look;
mod lists;

use std::collections::VecDeque;

use last_look::{Boot, Foreign};

use super::compare::Difference;
use super::discovery::{Discovered, Discovery, is_ready};
use super::identity;
use super::order::Order;
use super::report::{Failure, TransferReport, Verdict};
use super::state_machine::Task;
use crate::geodesy::LatLon;
use crate::link::codec::Version;
use crate::link::message::flight::{Command, FlightMessage};
use crate::link::message::{Address, Heartbeat, Message, MissionResult, MissionType};
use crate::link::texts::TextChunks;
use crate::link::time::Time;
use crate::mission::Item;

/// Between two of our heartbeats, milliseconds. MAVSDK forgets us after 3 s without.
const HEARTBEAT_MS: u64 = 1000;
/// The whole transfer: this and [`ITEM_MS`] for each item, milliseconds.
const TRANSFER_MS: u64 = 120_000;
/// Time allowed for each item, milliseconds.
const ITEM_MS: u64 = 5000;
/// The same to a vehicle in the air: a transfer that does not end is worse than none.
const AIR_TRANSFER_MS: u64 = 30_000;
const AIR_ITEM_MS: u64 = 2000;
/// Most requests for the version of the vehicle, a heartbeat apart.
const MAX_VERSION_REQUESTS: u32 = 5;
/// A vehicle that answers in MAVLink 1 for this long speaks no other version,
/// milliseconds: two of our heartbeats, in MAVLink 2, have gone out by then.
const OLD_MS: u64 = 2500;
/// Most texts of the vehicle in a report.
const MAX_TEXTS: usize = 50;
/// The lists in the order of transfer.
const ORDER: [MissionType; 3] = [MissionType::Fence, MissionType::Rally, MissionType::Mission];

/// Progress of a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Progress {
    /// Lists done, of three.
    pub lists: usize,
    /// Current stage: `waiting`, `sending`, `clearing`, `reading`, `done`.
    pub stage: &'static str,
    /// Items done in this stage.
    pub done: usize,
    /// Items in this stage.
    pub total: usize,
}

/// The transfer to one vehicle; see the driver contract of the module `transfer`.
#[derive(Debug)]
pub struct Session<'a> {
    order: Order<'a>,
    us: Address,
    began: Time,
    deadline: Time,
    heartbeat_due: Time,
    outbox: VecDeque<Message>,
    stage: Stage,
    /// The vehicle and its last heartbeat, once it has been discovered.
    vehicle: Option<(Address, Heartbeat)>,
    /// Index into [`ORDER`].
    at: usize,
    rounds: u32,
    /// Uploads of it that were never confirmed and read back otherwise.
    unconfirmed: u32,
    pauses: u32,
    complaint: Option<MissionResult>,
    acknowledged: bool,
    attempts: u32,
    retries: u32,
    held: [Vec<Item>; 3],
    /// The vehicle's own ids of the lists read back, in the order of their numbers.
    plan_ids: [u32; 3],
    /// Whether the lists are looked at for the last time.
    is_last_look: bool,
    /// How often the last look found a list that had changed.
    changes: u32,
    foreign: Foreign,
    boot: Boot,
    software: String,
    version_requests: u32,
    /// Where the vehicle last said that it is.
    place: Option<LatLon>,
    differences: Vec<Difference>,
    texts: Vec<String>,
    /// Texts that come in pieces.
    chunks: TextChunks,
    /// Text of the vehicle on a mission that it holds and will not fly.
    rejection: Option<String>,
    /// Since when the vehicle has been answering our MAVLink 2 in MAVLink 1.
    old_since: Option<Time>,
    version: Version,
    report: Option<TransferReport>,
}

#[derive(Debug)]
enum Stage {
    /// Waits until the vehicle speaks and is ready.
    Discovery(Discovery),
    /// Sends, clears or reads a list.
    Working(Task),
    /// Waits before a list is sent again.
    Pausing { until: Time },
    /// Waits for texts of the vehicle after the last list.
    Listening { until: Time },
}

/// When a transfer is given up that may take so long, and so long for each item, milliseconds.
fn deadline(order: &Order<'_>, now: Time, (whole_ms, item_ms): (u64, u64)) -> Time {
    let mission = order.mission;
    let items = mission.items.len() + mission.fence.len() + mission.rally.len();
    let items = u64::try_from(items).unwrap_or(u64::MAX);
    now + whole_ms.saturating_add(items.saturating_mul(item_ms))
}

impl<'a> Session<'a> {
    /// The same to a vehicle in the air.
    #[must_use]
    pub fn in_the_air(mut self) -> Self {
        self.deadline = deadline(&self.order, self.began, (AIR_TRANSFER_MS, AIR_ITEM_MS));
        self
    }

    /// Begins a transfer in the name of `us`.
    #[must_use]
    pub fn new(order: Order<'a>, us: Address, now: Time) -> Self {
        Self {
            deadline: deadline(&order, now, (TRANSFER_MS, ITEM_MS)),
            order,
            us,
            began: now,
            heartbeat_due: now,
            outbox: VecDeque::new(),
            stage: Stage::Discovery(Discovery::first(now)),
            vehicle: None,
            at: 0,
            rounds: 0,
            unconfirmed: 0,
            pauses: 0,
            complaint: None,
            acknowledged: false,
            attempts: 0,
            retries: 0,
            held: [Vec::new(), Vec::new(), Vec::new()],
            plan_ids: [0; 3],
            is_last_look: false,
            changes: 0,
            foreign: Foreign::default(),
            boot: Boot::default(),
            software: String::new(),
            version_requests: 0,
            place: None,
            differences: Vec::new(),
            texts: Vec::new(),
            chunks: TextChunks::default(),
            rejection: None,
            old_since: None,
            version: Version::Two,
            report: None,
        }
    }

    /// Takes in a message of any sender.
    pub fn handle(&mut self, now: Time, from: Address, message: &Message) {
        if self.report.is_some() {
            return;
        }
        match message {
            Message::Heartbeat(heartbeat) => self.heartbeat(now, from, *heartbeat),
            Message::StatusText { text, .. } => self.text(from, text),
            Message::TextChunk(chunk) if self.is_of_autopilot(from) => {
                self.chunks.take(now, from, chunk);
                self.whole_texts(now);
            }
            Message::AutopilotVersion {
                flight_software, ..
            } if self.is_of_autopilot(from) => {
                self.software = identity::version(*flight_software);
                self.version_requests = MAX_VERSION_REQUESTS;
            }
            Message::Flight(FlightMessage::Position(position)) if self.is_of_autopilot(from) => {
                if position.is_known() {
                    self.place = Some(position.place());
                }
                if self.boot.is_restart(position.boot_ms) {
                    self.restarted(now);
                }
            }
            Message::AutopilotVersion { .. }
            | Message::TextChunk(_)
            | Message::MissionCurrent { .. }
            | Message::HomePosition { .. }
            | Message::Flight(_) => {}
            Message::Mission(mission) => {
                self.look_for_foreign(from, mission);
                if let Stage::Working(task) = &mut self.stage {
                    task.handle(now, from, message);
                }
            }
        }
        self.advance(now);
    }

    /// Takes in the MAVLink version of a sender, before its message.
    ///
    /// Autopilots begin in MAVLink 1 until they hear MAVLink 2, and our heartbeats are in
    /// MAVLink 2: a vehicle that stays with the old version for long has no other.
    pub fn hear_version(&mut self, now: Time, from: Address, version: Version) {
        let system = self
            .vehicle
            .map_or(self.order.sysid, |(vehicle, _)| vehicle.system);
        if from.system != system || !matches!(self.stage, Stage::Discovery(_)) {
            return;
        }
        self.old_since = match version {
            Version::One => self.old_since.or(Some(now)),
            Version::Two => None,
        };
        self.version = match self.old_since {
            Some(since) if now - since >= OLD_MS => Version::One,
            _ => Version::Two,
        };
    }

    /// The MAVLink version for messages to the vehicle.
    #[must_use]
    pub fn version(&self) -> Version {
        self.version
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Time) {
        if self.report.is_some() {
            return;
        }
        self.whole_texts(now);
        if now >= self.heartbeat_due {
            self.heartbeat_due = now + HEARTBEAT_MS;
            self.outbox.push_back(Message::Heartbeat(Heartbeat::OURS));
            self.request_version();
        }
        match &mut self.stage {
            Stage::Working(task) => task.handle_timeout(now),
            Stage::Discovery(discovery) if now >= discovery.until() => {
                let discovered = discovery.timeout(&self.order, now);
                self.discovered(now, discovered);
            }
            Stage::Pausing { until } if now >= *until => self.begin_list(now),
            Stage::Listening { until } if now >= *until => self.look_again(now),
            Stage::Discovery(_) | Stage::Pausing { .. } | Stage::Listening { .. } => {}
        }
        self.advance(now);
        if self.report.is_none() && now >= self.deadline {
            let after_s = (self.deadline - self.began) / 1000;
            self.end(now, Verdict::Failed(Failure::OutOfTime { after_s }));
        }
    }

    /// The next message to send, if there is one.
    pub fn poll_transmit(&mut self) -> Option<Message> {
        if let Some(message) = self.outbox.pop_front() {
            return Some(message);
        }
        match &mut self.stage {
            Stage::Working(task) => task.poll_transmit(),
            Stage::Discovery(_) | Stage::Pausing { .. } | Stage::Listening { .. } => None,
        }
    }

    /// When [`Session::handle_timeout`] is due; `None` at the end.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Time> {
        if self.report.is_some() {
            return None;
        }
        let stage = match &self.stage {
            Stage::Working(task) => task.poll_timeout(),
            Stage::Discovery(discovery) => Some(discovery.until()),
            Stage::Pausing { until } | Stage::Listening { until } => Some(*until),
        };
        let due = self.heartbeat_due.min(self.deadline);
        Some(stage.map_or(due, |stage| stage.min(due)))
    }

    /// The report, once the transfer is over.
    #[must_use]
    pub fn report(&self) -> Option<&TransferReport> {
        self.report.as_ref()
    }

    /// The progress.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let total = self.expected().row_count(ORDER[self.at]);
        let (stage, done, total) = match &self.stage {
            _ if self.report.is_some() => ("done", 0, 0),
            Stage::Working(task) => {
                let (stage, done) = task.progress();
                // It may hold more than it shall.
                (stage, done, total.max(done))
            }
            Stage::Discovery(_) | Stage::Pausing { .. } => ("waiting", 0, 0),
            Stage::Listening { .. } => ("done", 0, 0),
        };
        let is_last_look = self.is_last_look;
        Progress {
            lists: if is_last_look { ORDER.len() } else { self.at },
            stage,
            done,
            total,
        }
    }

    /// Ends the transfer when the driver cannot go on.
    pub(crate) fn abort(&mut self, now: Time, failure: Failure) {
        if self.report.is_none() {
            self.end(now, Verdict::Failed(failure));
        }
    }

    /// Whether a message comes from the autopilot, and not from another component.
    fn is_of_autopilot(&self, from: Address) -> bool {
        self.vehicle.is_some_and(|(vehicle, _)| vehicle == from)
    }

    /// Requests the software version of the vehicle, and where it is. Nothing waits for the answers.
    fn request_version(&mut self) {
        if let (Some((target, _)), true) =
            (self.vehicle, self.version_requests < MAX_VERSION_REQUESTS)
        {
            self.version_requests += 1;
            for order in [Command::request_version(), Command::request_position()] {
                let request = FlightMessage::Command { target, order };
                self.outbox.push_back(Message::Flight(request));
            }
        }
    }

    fn heartbeat(&mut self, now: Time, from: Address, heartbeat: Heartbeat) {
        if !identity::is_autopilot(from, &heartbeat) {
            return;
        }
        let is_undecided = self.old_since.is_some() && self.version == Version::Two;
        if let Stage::Discovery(discovery) = &mut self.stage {
            if is_undecided {
                return;
            }
            let discovered = discovery.heartbeat(&self.order, now, from, heartbeat);
            self.vehicle = discovery.vehicle();
            self.discovered(now, discovered);
        }
        let Some((vehicle, last)) = &mut self.vehicle else {
            return;
        };
        if *vehicle != from || self.report.is_some() {
            return;
        }
        *last = heartbeat;
        if heartbeat.is_armed() && !self.order.force {
            self.end(now, Verdict::Failed(Failure::ArmedMeanwhile));
        } else if !is_ready(&heartbeat) && !matches!(self.stage, Stage::Discovery(_)) {
            self.restarted(now);
        }
    }

    fn discovered(&mut self, now: Time, discovered: Discovered) {
        match discovered {
            Discovered::Pending => {}
            Discovered::Ready(address, heartbeat) => {
                self.vehicle = Some((address, heartbeat));
                (self.at, self.rounds, self.pauses) = (0, 0, 0);
                self.unconfirmed = 0;
                self.is_last_look = false;
                self.request_version();
                if self.version == Version::One {
                    let (fence, rally) = (
                        self.order.mission.fence.len(),
                        self.order.mission.rally.len(),
                    );
                    if fence + rally > 0 {
                        let failure = Failure::OnlyMavlink1 { fence, rally };
                        return self.end(now, Verdict::Failed(failure));
                    }
                }
                self.at = self.first_list();
                self.begin_list(now);
            }
            Discovered::Failed(verdict) => self.end(now, verdict),
        }
    }
}
