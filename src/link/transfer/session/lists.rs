//! The lists in turn: sent or cleared, read back, compared, sent again.

use super::{MAX_TEXTS, ORDER, Session, Stage};
use crate::link::message::{
    AUTOPILOT_GENERIC, Address, Message, MissionResult, MissionType, Route,
};
use crate::link::texts::as_line;
use crate::link::time::Time;
use crate::link::transfer::clear::Clear;
use crate::link::transfer::download::DownloadError;
use crate::link::transfer::expected::Expected;
use crate::link::transfer::report::{Failure, Verdict};
use crate::link::transfer::state_machine::{Ended, Task};
use crate::link::transfer::upload::{Sent, Upload, UploadError};
use crate::mission::Item;
use crate::spec::Autopilot;

/// Pause before a list is sent again that had no space while the vehicle was starting, milliseconds.
const PAUSE_MS: u64 = 2000;
/// Confirmed uploads of one list that read back otherwise before it is given up.
const MAX_ROUNDS: u32 = 3;
/// The same of uploads that were not confirmed: messages that are lost may explain some of them.
const MAX_UNCONFIRMED: u32 = 6;
/// Wait for texts of PX4 after the last read-back, milliseconds: it checks a mission after
/// accepting it.
const LISTEN_MS: u64 = 1200;

/// First words of PX4 on a mission that is not feasible (`FeasibilityChecker`).
const REJECTED: &str = "Mission rejected";

impl<'a> Session<'a> {
    /// The expected lists, by the rules of the autopilot that answers, if it is a known one.
    pub(crate) fn expected(&self) -> Expected<'a> {
        let mission = self.order.mission;
        let autopilot = self
            .vehicle
            .and_then(|(_, heartbeat)| Autopilot::of_mavlink(heartbeat.autopilot))
            .unwrap_or(mission.autopilot);
        Expected { mission, autopilot }
    }

    pub(crate) fn route(&self) -> Option<Route> {
        let (vehicle, _) = self.vehicle?;
        Some(Route {
            us: self.us,
            vehicle,
            list: ORDER[self.at],
        })
    }

    /// Begins the list at `self.at`: sends it, or checks that it is empty.
    pub(crate) fn begin_list(&mut self, now: Time) {
        let Some(route) = self.route() else { return };
        self.complaint = None;
        if self.expected().items(route.list).is_empty() {
            self.work(Task::Download(self.download(route, now)));
        } else {
            // Several times the re-request period of the vehicle (1 s, 250 ms, MAVSDK
            // 500 ms): a longer silence means that it has given up or lost us.
            let (silence_ms, gap_ms) = match (self.expected().autopilot, self.vehicle) {
                (_, Some((_, heartbeat))) if heartbeat.autopilot == AUTOPILOT_GENERIC => {
                    (4000, 800)
                }
                (autopilot, _) => (autopilot.conventions().silence_ms, 0),
            };
            let rows = self.expected().rows(route.list);
            let upload = Upload::new(route, rows, silence_ms, self.deadline, now);
            let upload = upload.with_min_gap(gap_ms);
            self.work(Task::Upload(upload));
        }
    }

    pub(crate) fn work(&mut self, task: Task) {
        self.stage = Stage::Working(task);
    }

    /// Goes on when the machine at work has ended.
    pub(crate) fn advance(&mut self, now: Time) {
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
            Ended::Unchanged => self.next_list(now),
            Ended::Read(outcome, opaque_id) => {
                self.plan_ids[usize::from(list.mission_type())] = opaque_id;
                self.read(now, outcome);
            }
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
            self.work(Task::Download(self.download(route, now)));
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
        let expected = self.expected();
        let must_be_empty = expected.items(list).is_empty();
        let mut read = match outcome {
            Ok(read) => read,
            // A vehicle that knows no fence or rally holds none.
            Err(DownloadError::Refused {
                result: MissionResult::UNSUPPORTED,
            }) if list != MissionType::Mission && must_be_empty => Vec::new(),
            Err(error) => {
                self.end(now, Verdict::Failed(Failure::ReadBack { list, error }));
                return;
            }
        };
        let found = expected.compare(list, &mut read);
        if found.is_empty() {
            self.held[usize::from(list.mission_type())] = read;
            self.next_list(now);
        } else if self.is_last_look && self.changes >= MAX_ROUNDS {
            let times = self.changes;
            let failure = Failure::ChangedMeanwhile { list, times };
            self.differences = found;
            self.end(now, Verdict::Failed(failure));
        } else if self.rounds >= MAX_ROUNDS || self.unconfirmed >= MAX_UNCONFIRMED {
            let (count, times) = (found.len(), self.unconfirmed);
            self.differences = found;
            let complaint = self.complaint;
            let failure = match self.rounds >= MAX_ROUNDS {
                true => Failure::Different {
                    list,
                    count,
                    complaint,
                },
                false => Failure::NeverConfirmed { list, count, times },
            };
            self.end(now, Verdict::Failed(failure));
        } else {
            self.again(now, must_be_empty);
        }
    }

    /// The read-back differs: sends or clears the list once more.
    fn again(&mut self, now: Time, must_be_empty: bool) {
        self.changes += u32::from(self.is_last_look);
        self.is_last_look = false;
        let spoke = self.acknowledged || self.complaint == Some(MissionResult::ERROR);
        self.rounds += u32::from(spoke);
        self.unconfirmed += u32::from(!spoke);
        self.acknowledged = false;
        match self.route() {
            Some(route) if must_be_empty => {
                self.work(Task::Clear(Clear::new(route, self.deadline, now)));
            }
            _ => self.begin_list(now),
        }
    }

    fn next_list(&mut self, now: Time) {
        (self.rounds, self.unconfirmed, self.pauses) = (0, 0, 0);
        self.acknowledged = false;
        let is_last = self.at + 1 == ORDER.len();
        if is_last && self.is_last_look {
            self.conclude(now);
        } else if !is_last {
            self.at += 1;
            if self.is_last_look {
                self.look_at_list(now);
            } else {
                self.begin_list(now);
            }
        } else {
            let conventions = self.expected().autopilot.conventions();
            let listen_ms = if conventions.rejects_after_ack {
                LISTEN_MS
            } else {
                0
            };
            self.stage = Stage::Listening {
                until: now + listen_ms,
            };
        }
    }

    /// Takes in what the vehicle says.
    pub(crate) fn text(&mut self, from: Address, text: &str) {
        let text = as_line(text);
        self.look_for_rejection(from, &text);
        let is_new = self.texts.last().is_none_or(|last| *last != text);
        if self.is_of_autopilot(from) && is_new && self.texts.len() < MAX_TEXTS {
            self.texts.push(text);
        }
    }

    /// The same of texts that came in pieces.
    pub(crate) fn whole_texts(&mut self, now: Time) {
        while let Some((from, message)) = self.chunks.poll(now) {
            if let Message::StatusText { text, .. } = message {
                self.text(from, &text);
            }
        }
    }

    /// PX4 checks a mission after confirming it, and reports only as text that it will not
    /// fly it. Earlier texts are about the mission that it held before.
    fn look_for_rejection(&mut self, from: Address, text: &str) {
        // Its acknowledgement may be lost.
        let is_out = matches!(&self.stage, Stage::Working(task) if task.is_all_sent());
        let is_mission = ORDER.get(self.at) == Some(&MissionType::Mission);
        let is_sent = is_mission && (self.acknowledged || is_out);
        let is_held = is_sent || self.is_last_look || matches!(self.stage, Stage::Listening { .. });
        if is_held && self.is_of_autopilot(from) && text.starts_with(REJECTED) {
            self.rejection = Some(text.trim_end().to_owned());
        }
    }
}
