//! Everything for one vehicle: wait for it, make sure that it is the right one,
//! then fence, rally and mission, each sent, read back and compared.
//!
//! Fence before mission, because PX4 checks a mission against the fence on board.
//! A list that is to be empty is read first and cleared if it is not: an old
//! fence must not stay silently.

use std::collections::VecDeque;

use super::clear::Clear;
use super::codec::Version;
use super::compare::Difference;
use super::download::{Download, DownloadError};
use super::identity;
use super::meeting::{Encounter, Meeting, is_ready};
use super::message::{
    AUTOPILOT_GENERIC, Address, Body, Heartbeat, List, Message, MissionResult, Route,
};
use super::report::{Failure, TransferReport, Verdict, hash};
use super::task::{Ended, Task};
use super::time::Time;
use super::upload::{Sent, Upload, UploadError};
use super::wanted::Wanted;
use crate::mission::{Item, VehicleMission};
use crate::spec::Autopilot;

/// Between two of our heartbeats, milliseconds. MAVSDK forgets us after 3 s without.
const HEARTBEAT_MS: u64 = 1000;
/// The whole transfer: this and [`ITEM_MS`] for each item, milliseconds.
const TRANSFER_MS: u64 = 120_000;
/// What each item adds to the time allowed, milliseconds.
const ITEM_MS: u64 = 5000;
/// Pause before a list is sent again that had no space while the vehicle was starting, milliseconds.
const PAUSE_MS: u64 = 2000;
/// Confirmed uploads of one list that read back otherwise before it is given up.
const MOST_ROUNDS: u32 = 3;
/// How long PX4 is listened to after the last read-back, milliseconds: it judges a mission after accepting it.
const LISTEN_MS: u64 = 1000;
/// Answers in MAVLink 1 for so long, milliseconds, mean that the vehicle speaks no other:
/// two of our heartbeats, in MAVLink 2, have gone out by then.
const OLD_MS: u64 = 2500;
/// Most texts of the vehicle that are kept.
const MOST_TEXTS: usize = 50;
/// The lists in the order of transfer.
const ORDER: [List; 3] = [List::Fence, List::Rally, List::Mission];

/// What is to be transferred, and to whom.
#[derive(Clone, Debug)]
pub struct Order<'a> {
    /// Id in the spec.
    pub vehicle: &'a str,
    /// System id in the spec.
    pub sysid: u8,
    /// What it shall hold.
    pub mission: &'a VehicleMission,
    /// Whether refusals are overridden.
    pub force: bool,
    /// System ids that others expect on the same link.
    pub others: Vec<u8>,
}

/// Where a transfer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Lists done, of three.
    pub lists: usize,
    /// What is going on: `waiting`, `sending`, `clearing`, `reading`, `done`.
    pub stage: &'static str,
    /// Items done in this stage.
    pub done: usize,
    /// Items in this stage.
    pub total: usize,
}

/// The transfer to one vehicle. Same driver contract as [`Upload`].
#[derive(Debug)]
pub struct Session<'a> {
    order: Order<'a>,
    us: Address,
    began: Time,
    deadline: Time,
    heartbeat_due: Time,
    outbox: VecDeque<Message>,
    stage: Stage,
    /// The vehicle and what it last said, once it has been met.
    vehicle: Option<(Address, Heartbeat)>,
    /// Index into [`ORDER`].
    at: usize,
    rounds: u32,
    pauses: u32,
    complaint: Option<MissionResult>,
    acknowledged: bool,
    attempts: u32,
    retries: u32,
    held: [Vec<Item>; 3],
    differences: Vec<Difference>,
    texts: Vec<String>,
    /// Since when the vehicle has been answering our MAVLink 2 in MAVLink 1.
    old_since: Option<Time>,
    version: Version,
    report: Option<TransferReport>,
}

#[derive(Debug)]
enum Stage {
    /// For the vehicle to speak, or to be ready.
    Meeting(Meeting),
    /// A list is sent, cleared or read.
    Working(Task),
    /// Before a list is sent again.
    Pausing { until: Time },
    /// After the last list, for what the vehicle has to say.
    Listening { until: Time },
}

impl<'a> Session<'a> {
    /// Begins a transfer in the name of `us`.
    #[must_use]
    pub fn new(order: Order<'a>, us: Address, now: Time) -> Self {
        let mission = order.mission;
        let items = mission.items.len() + mission.fence.len() + mission.rally.len();
        let items = u64::try_from(items).unwrap_or(u64::MAX);
        Self {
            deadline: now + TRANSFER_MS.saturating_add(items.saturating_mul(ITEM_MS)),
            order,
            us,
            began: now,
            heartbeat_due: now,
            outbox: VecDeque::new(),
            stage: Stage::Meeting(Meeting::first(now)),
            vehicle: None,
            at: 0,
            rounds: 0,
            pauses: 0,
            complaint: None,
            acknowledged: false,
            attempts: 0,
            retries: 0,
            held: [Vec::new(), Vec::new(), Vec::new()],
            differences: Vec::new(),
            texts: Vec::new(),
            old_since: None,
            version: Version::Two,
            report: None,
        }
    }

    /// Takes in a message, whoever sent it.
    pub fn handle(&mut self, now: Time, from: Address, message: &Message) {
        if self.report.is_some() {
            return;
        }
        match message {
            Message::Heartbeat(heartbeat) => self.heartbeat(now, from, *heartbeat),
            Message::StatusText { text, .. } => {
                let is_ours = self
                    .vehicle
                    .is_some_and(|(vehicle, _)| vehicle.system == from.system);
                if is_ours && self.texts.last() != Some(text) && self.texts.len() < MOST_TEXTS {
                    self.texts.push(text.clone());
                }
            }
            Message::MissionCurrent { .. } | Message::HomePosition { .. } | Message::Flight(_) => {}
            Message::Mission(_) => {
                if let Stage::Working(task) = &mut self.stage {
                    task.handle(now, from, message);
                }
            }
        }
        self.advance(now);
    }

    /// Takes in which MAVLink a sender used, before its message is handed in.
    ///
    /// Autopilots begin in MAVLink 1 until they hear MAVLink 2, and our heartbeats are
    /// in MAVLink 2: only who stays with the old one for long speaks nothing else.
    pub fn hear_version(&mut self, now: Time, from: Address, version: Version) {
        let system = self
            .vehicle
            .map_or(self.order.sysid, |(vehicle, _)| vehicle.system);
        if from.system != system || !matches!(self.stage, Stage::Meeting(_)) {
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

    /// In which MAVLink the vehicle is to be spoken to.
    #[must_use]
    pub fn version(&self) -> Version {
        self.version
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Time) {
        if self.report.is_some() {
            return;
        }
        if now >= self.heartbeat_due {
            self.heartbeat_due = now + HEARTBEAT_MS;
            self.outbox.push_back(Message::Heartbeat(Heartbeat::OURS));
        }
        match &mut self.stage {
            Stage::Working(task) => task.handle_timeout(now),
            Stage::Meeting(meeting) if now >= meeting.until() => {
                let encounter = meeting.timeout(&self.order, now);
                self.meet(now, encounter);
            }
            Stage::Pausing { until } if now >= *until => self.begin_list(now),
            Stage::Listening { until } if now >= *until => self.end(now, Verdict::Verified),
            Stage::Meeting(_) | Stage::Pausing { .. } | Stage::Listening { .. } => {}
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
            Stage::Meeting(_) | Stage::Pausing { .. } | Stage::Listening { .. } => None,
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
            Stage::Meeting(meeting) => Some(meeting.until()),
            Stage::Pausing { until } | Stage::Listening { until } => Some(*until),
        };
        let due = self.heartbeat_due.min(self.deadline);
        Some(stage.map_or(due, |stage| stage.min(due)))
    }

    /// What it came to, once it is over.
    #[must_use]
    pub fn report(&self) -> Option<&TransferReport> {
        self.report.as_ref()
    }

    /// Where it is.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let total = self.wanted().items(ORDER[self.at]).len();
        let (stage, done, total) = match &self.stage {
            _ if self.report.is_some() => ("done", 0, 0),
            Stage::Working(task) => {
                let (stage, done) = task.progress();
                (stage, done, total)
            }
            Stage::Meeting(_) | Stage::Pausing { .. } => ("waiting", 0, 0),
            Stage::Listening { .. } => ("done", 0, 0),
        };
        Progress {
            lists: self.at,
            stage,
            done,
            total,
        }
    }

    /// The last word, when the driver cannot go on.
    pub(super) fn abort(&mut self, now: Time, failure: Failure) {
        if self.report.is_none() {
            self.end(now, Verdict::Failed(failure));
        }
    }

    fn heartbeat(&mut self, now: Time, from: Address, heartbeat: Heartbeat) {
        if !identity::is_vehicle(&heartbeat) {
            return;
        }
        let is_undecided = self.old_since.is_some() && self.version == Version::Two;
        if let Stage::Meeting(meeting) = &mut self.stage {
            if is_undecided {
                return;
            }
            let encounter = meeting.heartbeat(&self.order, now, from, heartbeat);
            self.vehicle = meeting.vehicle();
            self.meet(now, encounter);
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
        } else if !is_ready(&heartbeat) && !matches!(self.stage, Stage::Meeting(_)) {
            // It was started again: what it confirmed before may be gone.
            self.stage = Stage::Meeting(Meeting::again((from, heartbeat), now));
        }
    }

    fn meet(&mut self, now: Time, encounter: Encounter) {
        match encounter {
            Encounter::Nobody => {}
            Encounter::Met(address, heartbeat) => {
                self.vehicle = Some((address, heartbeat));
                (self.at, self.rounds, self.pauses) = (0, 0, 0);
                if self.version == Version::One {
                    let (fence, rally) = (
                        self.order.mission.fence.len(),
                        self.order.mission.rally.len(),
                    );
                    if fence + rally > 0 {
                        let failure = Failure::OnlyMavlink1 { fence, rally };
                        return self.end(now, Verdict::Failed(failure));
                    }
                    self.at = ORDER.len() - 1;
                }
                self.begin_list(now);
            }
            Encounter::Over(verdict) => self.end(now, verdict),
        }
    }

    /// What is wanted, by the rules of the autopilot that answers, if it says which it is.
    fn wanted(&self) -> Wanted<'a> {
        let mission = self.order.mission;
        let autopilot = self
            .vehicle
            .and_then(|(_, heartbeat)| identity::named(heartbeat.autopilot))
            .unwrap_or(mission.autopilot);
        Wanted { mission, autopilot }
    }

    fn route(&self) -> Option<Route> {
        let (vehicle, _) = self.vehicle?;
        Some(Route {
            us: self.us,
            vehicle,
            list: ORDER[self.at],
        })
    }

    /// Begins the list at `self.at`: sends it, or looks whether it is empty.
    fn begin_list(&mut self, now: Time) {
        let Some(route) = self.route() else { return };
        self.complaint = None;
        if self.wanted().items(route.list).is_empty() {
            self.work(Task::Download(Download::new(route, self.deadline, now)));
        } else {
            // How long this vehicle may be silent before it has given up or lost us:
            // several times its own re-request period (1 s, 250 ms, MAVSDK 500 ms).
            let (silence_ms, room_ms) = match (self.wanted().autopilot, self.vehicle) {
                (_, Some((_, beat))) if beat.autopilot == AUTOPILOT_GENERIC => (4000, 800),
                (Autopilot::ArduPilot, _) => (5000, 0),
                (Autopilot::Px4, _) => (3000, 0),
            };
            let rows = self.wanted().rows(route.list);
            let upload = Upload::new(route, rows, silence_ms, self.deadline, now);
            let upload = upload.leaving_room(room_ms);
            self.work(Task::Upload(upload));
        }
    }

    fn work(&mut self, task: Task) {
        self.stage = Stage::Working(task);
    }

    /// Goes on when the machine at work has ended.
    fn advance(&mut self, now: Time) {
        let Stage::Working(task) = &mut self.stage else {
            return;
        };
        let Some(ended) = task.ended() else { return };
        if self.report.is_some() {
            return;
        }
        let (attempts, repeats) = task.effort();
        self.attempts += attempts;
        self.retries += repeats;
        // The closing ACK of a download is still in there.
        while let Some(message) = task.poll_transmit() {
            self.outbox.push_back(message);
        }
        let list = ORDER[self.at];
        match ended {
            Ended::Sent(outcome) => self.sent(now, outcome),
            Ended::Read(outcome) => self.read(now, outcome),
            Ended::Cleared(Ok(cleared)) => {
                self.acknowledged = cleared.acknowledged;
                self.read_back(now);
            }
            Ended::Cleared(Err(result)) => {
                self.end(now, Verdict::Failed(Failure::Clear { list, result }));
            }
        }
    }

    fn read_back(&mut self, now: Time) {
        if let Some(route) = self.route() {
            self.work(Task::Download(Download::new(route, self.deadline, now)));
        }
    }

    fn sent(&mut self, now: Time, outcome: Result<Sent, UploadError>) {
        match outcome {
            Ok(sent) => {
                self.acknowledged = sent.acknowledged;
                self.complaint = sent.complaint;
                self.read_back(now);
            }
            // ArduPilot says NO_SPACE for a moment after its start.
            Err(UploadError::Rejected {
                result: MissionResult::NO_SPACE,
                ..
            }) if self.pauses < 2 => {
                self.pauses += 1;
                self.stage = Stage::Pausing {
                    until: now + PAUSE_MS,
                };
            }
            Err(error) => {
                let list = ORDER[self.at];
                self.end(now, Verdict::Failed(Failure::Upload { list, error }));
            }
        }
    }

    fn read(&mut self, now: Time, outcome: Result<Vec<Item>, DownloadError>) {
        let list = ORDER[self.at];
        let wanted = self.wanted();
        let shall_be_empty = wanted.items(list).is_empty();
        let mut read = match outcome {
            Ok(read) => read,
            // A vehicle that knows no fence or rally holds none.
            Err(DownloadError::Refused {
                result: MissionResult::UNSUPPORTED,
            }) if list != List::Mission && shall_be_empty => Vec::new(),
            Err(error) => {
                self.end(now, Verdict::Failed(Failure::ReadBack { list, error }));
                return;
            }
        };
        let found = wanted.compare(list, &mut read);
        if found.is_empty() {
            self.held[usize::from(list.mission_type())] = read;
            self.next_list(now);
        } else if self.rounds >= MOST_ROUNDS {
            let count = found.len();
            self.differences = found;
            let complaint = self.complaint;
            let failure = Failure::Different {
                list,
                count,
                complaint,
            };
            self.end(now, Verdict::Failed(failure));
        } else {
            self.again(now, shall_be_empty);
        }
    }

    /// The read-back was not what it should be: once more.
    fn again(&mut self, now: Time, shall_be_empty: bool) {
        // Without the vehicle's confirmation it was to be expected; the deadline bounds that.
        let spoke = self.acknowledged || self.complaint == Some(MissionResult::ERROR);
        self.rounds += u32::from(spoke);
        self.acknowledged = false;
        match self.route() {
            Some(route) if shall_be_empty => {
                self.work(Task::Clear(Clear::new(route, self.deadline, now)));
            }
            _ => self.begin_list(now),
        }
    }

    fn next_list(&mut self, now: Time) {
        (self.rounds, self.pauses, self.acknowledged) = (0, 0, false);
        if self.at + 1 < ORDER.len() {
            self.at += 1;
            self.begin_list(now);
        } else {
            let listen_ms = match self.wanted().autopilot {
                Autopilot::Px4 => LISTEN_MS,
                Autopilot::ArduPilot => 0,
            };
            self.stage = Stage::Listening {
                until: now + listen_ms,
            };
        }
    }

    fn description(&self) -> String {
        let Some((_, beat)) = self.vehicle else {
            return String::new();
        };
        let description = identity::describe(&beat);
        match self.version {
            Version::One => format!("{description}, MAVLink 1: fence and rally cannot be asked"),
            Version::Two => description,
        }
    }

    fn end(&mut self, now: Time, verdict: Verdict) {
        if let (Stage::Working(Task::Upload(_)), Some(route)) = (&self.stage, self.route()) {
            // Lets PX4 go, instead of leaving it waiting for 5 s.
            self.outbox.push_back(route.message(Body::Ack {
                result: MissionResult::OPERATION_CANCELLED,
                opaque_id: 0,
            }));
        }
        let [mission, fence, rally] = &self.held;
        let verified = verdict == Verdict::Verified;
        #[expect(
            clippy::cast_precision_loss,
            reason = "milliseconds of one transfer fit into f64"
        )]
        let seconds = (now - self.began) as f64 / 1000.0;
        self.report = Some(TransferReport {
            autopilot: self.description(),
            items: mission.len(),
            fence: fence.len(),
            rally: rally.len(),
            attempts: self.attempts,
            retries: self.retries,
            seconds,
            hash: if verified {
                hash(mission, fence, rally)
            } else {
                String::new()
            },
            differences: std::mem::take(&mut self.differences),
            statustexts: std::mem::take(&mut self.texts),
            ..TransferReport::nothing(
                self.order.vehicle,
                self.vehicle
                    .map_or(self.order.sysid, |(address, _)| address.system),
                verdict,
            )
        });
    }
}
