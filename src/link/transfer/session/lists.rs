//! The lists one after the other: sent or cleared, read back, compared, sent again.

use super::{ORDER, Session, Stage};
use crate::link::message::{AUTOPILOT_GENERIC, Address, List, MissionResult, Route};
use crate::link::time::Time;
use crate::link::transfer::clear::Clear;
use crate::link::transfer::download::{Download, DownloadError};
use crate::link::transfer::report::{Failure, Verdict};
use crate::link::transfer::target::Wanted;
use crate::link::transfer::task::{Ended, Task};
use crate::link::transfer::upload::{Sent, Upload, UploadError};
use crate::mission::Item;
use crate::spec::Autopilot;

/// Pause before a list is sent again that had no space while the vehicle was starting, milliseconds.
const PAUSE_MS: u64 = 2000;
/// Confirmed uploads of one list that read back otherwise before it is given up.
const MOST_ROUNDS: u32 = 3;
/// How long PX4 is listened to after the last read-back, milliseconds: it judges a mission
/// after accepting it, and says once a second what it holds.
const LISTEN_MS: u64 = 1200;

/// How PX4 begins to say that a mission is not feasible (`FeasibilityChecker`).
const REJECTED: &str = "Mission rejected";

impl<'a> Session<'a> {
    /// What is wanted, by the rules of the autopilot that answers, if it says which it is.
    pub(crate) fn wanted(&self) -> Wanted<'a> {
        let mission = self.order.mission;
        let autopilot = self
            .vehicle
            .and_then(|(_, heartbeat)| Autopilot::of_mavlink(heartbeat.autopilot))
            .unwrap_or(mission.autopilot);
        Wanted { mission, autopilot }
    }

    pub(crate) fn route(&self) -> Option<Route> {
        let (vehicle, _) = self.vehicle?;
        Some(Route {
            us: self.us,
            vehicle,
            list: ORDER[self.at],
        })
    }

    /// Begins the list at `self.at`: sends it, or looks whether it is empty.
    pub(crate) fn begin_list(&mut self, now: Time) {
        let Some(route) = self.route() else { return };
        self.complaint = None;
        if self.wanted().items(route.list).is_empty() {
            self.work(Task::Download(Download::new(route, self.deadline, now)));
        } else {
            // How long this vehicle may be silent before it has given up or lost us:
            // several times its own re-request period (1 s, 250 ms, MAVSDK 500 ms).
            let (silence_ms, room_ms) = match (self.wanted().autopilot, self.vehicle) {
                (_, Some((_, beat))) if beat.autopilot == AUTOPILOT_GENERIC => (4000, 800),
                (autopilot, _) => (autopilot.conventions().silence_ms, 0),
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
            let conventions = self.wanted().autopilot.conventions();
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

    /// PX4 judges a mission once it has confirmed it, and then says alone in words that it will not
    /// fly it. What it says before that is of the mission that it held.
    pub(crate) fn look_for_rejection(&mut self, from: Address, text: &str) {
        let is_sent = ORDER.get(self.at) == Some(&List::Mission) && self.acknowledged;
        let is_held = is_sent || matches!(self.stage, Stage::Listening { .. });
        if is_held && self.is_of_vehicle(from) && text.starts_with(REJECTED) {
            self.rejection = Some(text.trim_end().to_owned());
        }
    }

    /// A vehicle that gives its lists ids says with them when one has changed since it
    /// was read back: somebody else is at work. Then it is read once more; what is read
    /// decides, because an id may also be old or still in the making.
    pub(crate) fn compare_ids(&mut self, now: Time, ids: [u32; 3]) {
        let keeps_ids = self.plan_ids != [0; 3];
        if !matches!(self.stage, Stage::Listening { .. }) || !keeps_ids || self.reread {
            return;
        }
        let changed = |list: &List| {
            let at = usize::from(list.mission_type());
            ids.get(at) != self.plan_ids.get(at)
        };
        if let Some(at) = ORDER.iter().position(changed) {
            self.reread = true;
            self.at = at;
            self.read_back(now);
        }
    }
}
