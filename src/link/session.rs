//! Everything for one vehicle: wait for it, make sure that it is the right one,
//! then fence, rally and mission, each sent, read back and compared.
//!
//! Fence before mission, because PX4 checks a mission against the fence on board.
//! A list that is to be empty is read first and cleared if it is not: an old
//! fence must not stay silently.

use std::collections::VecDeque;

use super::clear::Clear;
use super::compare::{Difference, differences};
use super::download::{Download, DownloadError};
use super::identity;
use super::message::{
    AUTOPILOT_GENERIC, AUTOPILOT_INVALID, Address, Body, Heartbeat, List, Message, MissionResult,
    Route, STATE_ACTIVE, STATE_STANDBY, TYPE_GCS,
};
use super::report::{Failure, Refusal, TransferReport, Verdict, hash};
use super::time::Time;
use super::upload::{Upload, UploadError};
use crate::mission::{Item, VehicleMission, command, frame};
use crate::spec::Autopilot;

/// Between two of our heartbeats, milliseconds. MAVSDK forgets us after 3 s without.
const HEARTBEAT_MS: u64 = 1000;
/// Wait for the first heartbeat of the vehicle, milliseconds.
const NOBODY_MS: u64 = 10_000;
/// Wait for a vehicle that is starting, milliseconds.
const STARTING_MS: u64 = 30_000;
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
    vehicle: Option<(Address, Heartbeat)>,
    heard: Vec<(Address, Heartbeat)>,
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
    report: Option<TransferReport>,
}

#[derive(Debug)]
enum Stage {
    /// For the vehicle to speak, or to be ready.
    Waiting {
        until: Time,
    },
    Sending(Upload),
    Clearing(Clear),
    Reading(Download),
    /// Before a list is sent again.
    Pausing {
        until: Time,
    },
    /// After the last list, for what the vehicle has to say.
    Listening {
        until: Time,
    },
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
            stage: Stage::Waiting {
                until: now + NOBODY_MS,
            },
            vehicle: None,
            heard: Vec::new(),
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
            Message::MissionCurrent { .. } => {}
            Message::Mission(_) => match &mut self.stage {
                Stage::Sending(upload) => upload.handle(now, from, message),
                Stage::Clearing(clear) => clear.handle(now, from, message),
                Stage::Reading(download) => download.handle(now, from, message),
                Stage::Waiting { .. } | Stage::Pausing { .. } | Stage::Listening { .. } => {}
            },
        }
        self.advance(now);
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Time) {
        if self.report.is_some() {
            return;
        }
        if now >= self.heartbeat_due {
            self.heartbeat_due = now + HEARTBEAT_MS;
            self.outbox.push_back(Message::Heartbeat(Heartbeat {
                kind: TYPE_GCS,
                autopilot: AUTOPILOT_INVALID,
                base_mode: 0,
                custom_mode: 0,
                system_status: STATE_ACTIVE,
            }));
        }
        match &mut self.stage {
            Stage::Sending(upload) => upload.handle_timeout(now),
            Stage::Clearing(clear) => clear.handle_timeout(now),
            Stage::Reading(download) => download.handle_timeout(now),
            Stage::Waiting { until } if now >= *until => self.waited(now),
            Stage::Pausing { until } if now >= *until => self.begin_list(now),
            Stage::Listening { until } if now >= *until => self.end(now, Verdict::Verified),
            Stage::Waiting { .. } | Stage::Pausing { .. } | Stage::Listening { .. } => {}
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
            Stage::Sending(upload) => upload.poll_transmit(),
            Stage::Clearing(clear) => clear.poll_transmit(),
            Stage::Reading(download) => download.poll_transmit(),
            Stage::Waiting { .. } | Stage::Pausing { .. } | Stage::Listening { .. } => None,
        }
    }

    /// When [`Session::handle_timeout`] is due; `None` at the end.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Time> {
        if self.report.is_some() {
            return None;
        }
        let stage = match &self.stage {
            Stage::Sending(upload) => upload.poll_timeout(),
            Stage::Clearing(clear) => clear.poll_timeout(),
            Stage::Reading(download) => download.poll_timeout(),
            Stage::Waiting { until } | Stage::Pausing { until } | Stage::Listening { until } => {
                Some(*until)
            }
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
        let wanted = self.wanted(ORDER[self.at]).len();
        let (stage, done, total) = match &self.stage {
            _ if self.report.is_some() => ("done", 0, 0),
            Stage::Waiting { .. } | Stage::Pausing { .. } => ("waiting", 0, 0),
            Stage::Sending(upload) => ("sending", upload.progress(), wanted),
            Stage::Clearing(_) => ("clearing", 0, 0),
            Stage::Reading(download) => ("reading", download.progress(), wanted),
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
        let Some((vehicle, _)) = self.vehicle else {
            self.heard.retain(|(address, _)| *address != from);
            self.heard.push((from, heartbeat));
            if from.system == self.order.sysid {
                self.meet(now, from, heartbeat);
            }
            return;
        };
        if vehicle != from {
            return;
        }
        self.vehicle = Some((vehicle, heartbeat));
        if heartbeat.is_armed() && !self.order.force {
            self.end(now, Verdict::Failed(Failure::ArmedMeanwhile));
        } else if matches!(self.stage, Stage::Waiting { .. }) {
            if is_ready(&heartbeat) {
                self.at = 0;
                self.begin_list(now);
            }
        } else if !is_ready(&heartbeat) {
            // It was started again: what it confirmed before may be gone.
            self.stage = Stage::Waiting {
                until: now + STARTING_MS,
            };
        }
    }

    /// The vehicle has spoken for the first time.
    fn meet(&mut self, now: Time, from: Address, heartbeat: Heartbeat) {
        self.vehicle = Some((from, heartbeat));
        let mission = self.order.mission;
        let checked = identity::check(&heartbeat, mission.autopilot, mission.airframe);
        match checked {
            Err(refusal) if !self.order.force => self.end(now, Verdict::Refused(refusal)),
            _ if is_ready(&heartbeat) => self.begin_list(now),
            _ => {
                self.stage = Stage::Waiting {
                    until: now + STARTING_MS,
                };
            }
        }
    }

    /// Nobody came, or nobody got ready.
    fn waited(&mut self, now: Time) {
        if let Some((_, heartbeat)) = self.vehicle {
            let status = heartbeat.system_status;
            let after_s = STARTING_MS / 1000;
            self.end(now, Verdict::Failed(Failure::NotReady { status, after_s }));
            return;
        }
        let strangers: Vec<(Address, Heartbeat)> = self
            .heard
            .iter()
            .filter(|(address, _)| !self.order.others.contains(&address.system))
            .copied()
            .collect();
        let expected = self.order.sysid;
        match strangers.as_slice() {
            [(address, heartbeat)] if self.order.force => self.meet(now, *address, *heartbeat),
            [(address, _)] => {
                let found = address.system;
                self.end(now, Verdict::Refused(Refusal::System { expected, found }));
            }
            _ => {
                let mut heard: Vec<u8> = self.heard.iter().map(|(from, _)| from.system).collect();
                heard.sort_unstable();
                heard.dedup();
                let failure = Failure::Nobody {
                    sysid: expected,
                    after_s: NOBODY_MS / 1000,
                    heard,
                };
                self.end(now, Verdict::Failed(failure));
            }
        }
    }

    /// The rules that apply: those of the autopilot that answers, if it says which it is.
    fn autopilot(&self) -> Autopilot {
        self.vehicle
            .and_then(|(_, heartbeat)| identity::named(heartbeat.autopilot))
            .unwrap_or(self.order.mission.autopilot)
    }

    fn wanted(&self, list: List) -> &'a [Item] {
        let mission = self.order.mission;
        match list {
            List::Mission => &mission.items,
            List::Fence => &mission.fence,
            List::Rally => &mission.rally,
        }
    }

    /// The items as they are sent: with home in front for ArduPilot, and exactly one
    /// mission item marked as current (MAVSDK refuses a mission otherwise).
    fn rows(&self, list: List) -> Vec<(Item, u8)> {
        let mut rows: Vec<(Item, u8)> = Vec::new();
        if list == List::Mission && self.autopilot() == Autopilot::ArduPilot {
            rows.push((home_row(self.order.mission), 0));
        }
        rows.extend(self.wanted(list).iter().map(|item| (*item, 0)));
        if let (List::Mission, Some((_, current))) = (list, rows.first_mut()) {
            *current = 1;
        }
        rows
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
        if self.wanted(route.list).is_empty() {
            self.stage = Stage::Reading(Download::new(route, self.deadline, now));
        } else {
            // How long this vehicle may be silent before it has given up or lost us:
            // several times its own re-request period (1 s, 250 ms, MAVSDK 500 ms).
            let silence_ms = match (self.autopilot(), self.vehicle) {
                (_, Some((_, beat))) if beat.autopilot == AUTOPILOT_GENERIC => 4000,
                (Autopilot::ArduPilot, _) => 5000,
                (Autopilot::Px4, _) => 3000,
            };
            let rows = self.rows(route.list);
            self.stage = Stage::Sending(Upload::new(route, rows, silence_ms, self.deadline, now));
        }
    }

    /// Goes on when the machine at work has ended.
    fn advance(&mut self, now: Time) {
        if self.report.is_some() {
            return;
        }
        match &self.stage {
            Stage::Sending(upload) => {
                if let Some(outcome) = upload.outcome() {
                    let (runs, repeats) = upload.effort();
                    self.attempts += runs;
                    self.retries += repeats;
                    self.sent(now, outcome);
                }
            }
            Stage::Clearing(clear) => {
                if let Some(outcome) = clear.outcome() {
                    self.retries += clear.repeats();
                    match outcome {
                        Ok(cleared) => {
                            self.acknowledged = cleared.acknowledged;
                            self.read_back(now);
                        }
                        Err(result) => {
                            let list = ORDER[self.at];
                            self.end(now, Verdict::Failed(Failure::Clear { list, result }));
                        }
                    }
                }
            }
            Stage::Reading(download) => {
                if let Some(outcome) = download.outcome() {
                    let outcome = outcome.clone();
                    self.retries += download.repeats();
                    // The closing ACK is still in there.
                    while let Some(message) = self.poll_transmit_stage() {
                        self.outbox.push_back(message);
                    }
                    self.read(now, outcome);
                }
            }
            Stage::Waiting { .. } | Stage::Pausing { .. } | Stage::Listening { .. } => {}
        }
    }

    fn poll_transmit_stage(&mut self) -> Option<Message> {
        match &mut self.stage {
            Stage::Reading(download) => download.poll_transmit(),
            _ => None,
        }
    }

    fn read_back(&mut self, now: Time) {
        if let Some(route) = self.route() {
            self.stage = Stage::Reading(Download::new(route, self.deadline, now));
        }
    }

    fn sent(&mut self, now: Time, outcome: Result<super::upload::Sent, UploadError>) {
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
        let wanted = self.wanted(list);
        let mut read = match outcome {
            Ok(read) => read,
            // A vehicle that knows no fence or rally holds none.
            Err(DownloadError::Refused {
                result: MissionResult::UNSUPPORTED,
            }) if list != List::Mission && wanted.is_empty() => Vec::new(),
            Err(error) => {
                self.end(now, Verdict::Failed(Failure::ReadBack { list, error }));
                return;
            }
        };
        if list == List::Mission && self.autopilot() == Autopilot::ArduPilot && !read.is_empty() {
            read.remove(0);
        }
        let found = differences(self.autopilot(), list, wanted, &read);
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
            self.again(now, wanted.is_empty());
        }
    }

    /// The read-back was not what it should be: once more.
    fn again(&mut self, now: Time, shall_be_empty: bool) {
        // Without the vehicle's confirmation it was to be expected; the deadline bounds that.
        self.rounds += u32::from(self.acknowledged || self.complaint.is_some());
        self.acknowledged = false;
        match self.route() {
            Some(route) if shall_be_empty => {
                self.attempts += 1;
                self.stage = Stage::Clearing(Clear::new(route, self.deadline, now));
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
            let listen_ms = match self.autopilot() {
                Autopilot::Px4 => LISTEN_MS,
                Autopilot::ArduPilot => 0,
            };
            self.stage = Stage::Listening {
                until: now + listen_ms,
            };
        }
    }

    fn end(&mut self, now: Time, verdict: Verdict) {
        if let (Stage::Sending(_), Some(route)) = (&self.stage, self.route()) {
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
            autopilot: self
                .vehicle
                .map_or(String::new(), |(_, beat)| identity::describe(&beat)),
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

/// Whether a vehicle takes missions. A generic one need not say more than "state unknown" (0).
fn is_ready(heartbeat: &Heartbeat) -> bool {
    heartbeat.system_status >= STATE_STANDBY
        || (heartbeat.autopilot == AUTOPILOT_GENERIC && heartbeat.system_status == 0)
}

/// Sequence number 0 of an ArduPilot mission. The vehicle puts its own home there.
fn home_row(mission: &VehicleMission) -> Item {
    Item {
        command: command::NAV_WAYPOINT,
        frame: frame::GLOBAL,
        autocontinue: true,
        params: [0.0; 4],
        x: mission.home.x,
        y: mission.home.y,
        z: mission.home.amsl_m,
    }
}
