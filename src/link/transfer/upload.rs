//! Sends one list to one vehicle (`MISSION_COUNT`, requests, items, `MISSION_ACK`).

mod error;

use std::collections::VecDeque;

use crate::link::message::{Body, Message, MissionResult, Route};
use crate::link::rtt::RttEstimator;
use crate::link::time::Time;
use crate::mission::Item;

pub use error::UploadError;

/// Wait for the answer to `MISSION_COUNT`, milliseconds (mission service guide).
const COUNT_MS: u64 = 1500;
/// `MISSION_COUNT`s without any answer before the vehicle counts as silent.
const MAX_COUNTS: u32 = 20;
/// An identical request within this time is the echo of one already answered, milliseconds.
const ECHO_MS: u64 = 100;
/// Silence after the final item before its `MISSION_ACK` counts as lost, milliseconds.
/// Several re-requests of ArduPilot (1 s) fit into it.
const ACK_MS: u64 = 4000;
/// Least time between two starts of a list that the vehicle asks for, milliseconds: a
/// vehicle that cancels each of them must not be answered as fast as it speaks.
const RESTART_MS: u64 = 250;
/// Starts without that pause.
const PROMPT_RUNS: u32 = 3;
/// First wait after `DENIED`, milliseconds; it doubles up to four times.
const DENIED_MS: u64 = 2000;
/// `ERROR`s for the same item before they count as a refusal of that item.
const MAX_ERRORS: u32 = 3;

/// An upload in progress; see the [driver contract](crate::link#driver-contract).
#[derive(Debug)]
pub struct Upload {
    route: Route,
    items: Vec<(Item, u8)>,
    silence_ms: u64,
    gap_ms: u64,
    deadline: Time,
    outbox: VecDeque<Body>,
    phase: Phase,
    /// Which items went out in this run.
    sent: Vec<bool>,
    rtt: RttEstimator,
    counts: u32,
    denials: u32,
    errors: (u16, u32),
    /// The last result that was not fatal when it came.
    complaint: Option<MissionResult>,
    runs: u32,
    /// When the current run started.
    started: Time,
    repeats: u32,
    outcome: Option<Result<Sent, UploadError>>,
}

#[derive(Clone, Copy, Debug)]
enum Phase {
    /// `MISSION_COUNT` went out; no request yet.
    Counting { again: Time },
    /// No message until then: after `DENIED`, or between two starts.
    Paused { until: Time },
    /// Items flow: the last one requested, when it was asked for and last sent,
    /// and when the vehicle was last heard.
    Sending {
        seq: u16,
        asked: Time,
        sent: Time,
        heard: Time,
        /// Sent before the vehicle asked for it.
        ahead: bool,
    },
}

/// Every item went out. Only a read-back shows whether the vehicle holds them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sent {
    /// Whether the vehicle confirmed; otherwise its `MISSION_ACK` was lost.
    pub acknowledged: bool,
    /// The id that the vehicle gave the list; 0 if it gives none.
    pub opaque_id: u32,
    /// The last code from the vehicle that was neither acceptance nor fatal.
    pub complaint: Option<MissionResult>,
}

impl Upload {
    /// Starts an upload. Each item comes with its `current` flag. When the vehicle
    /// has been silent for `silence_ms` in mid transfer, it is started over.
    #[must_use]
    pub fn new(
        route: Route,
        items: Vec<(Item, u8)>,
        silence_ms: u64,
        deadline: Time,
        now: Time,
    ) -> Self {
        let mut upload = Self {
            route,
            sent: vec![false; items.len()],
            silence_ms,
            gap_ms: 0,
            deadline,
            outbox: VecDeque::new(),
            phase: Phase::Counting { again: now },
            rtt: RttEstimator::default(),
            counts: 0,
            denials: 0,
            errors: (0, 0),
            complaint: None,
            runs: 0,
            started: now,
            repeats: 0,
            outcome: None,
            items,
        };
        if u16::try_from(upload.items.len()).is_err() {
            let items = upload.items.len();
            upload.outcome = Some(Err(UploadError::TooMany { items }));
        } else {
            upload.start(now, false);
        }
        upload
    }

    /// Sets the least time between two repetitions of one item, milliseconds. Each item
    /// that reaches MAVSDK, even a known one, delays its own request by 500 ms: repeated
    /// every 250 ms, it would never ask again for a lost item.
    #[must_use]
    pub fn with_min_gap(mut self, gap_ms: u64) -> Self {
        self.gap_ms = gap_ms;
        self
    }

    /// Takes in a message of any sender.
    pub fn handle(&mut self, now: Time, from: crate::link::Address, message: &Message) {
        if self.outcome.is_some() {
            return;
        }
        match self.route.accept(from, message) {
            Some(Body::Request { seq } | Body::RequestInt { seq }) => self.requested(now, seq),
            Some(Body::Ack { result, opaque_id }) => self.acknowledged(now, result, opaque_id),
            _ => {}
        }
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Time) {
        if self.outcome.is_some() || self.poll_timeout().is_none_or(|due| now < due) {
            return;
        }
        if now >= self.deadline {
            self.outcome = Some(Err(self.out_of_time()));
            return;
        }
        match self.phase {
            Phase::Counting { .. } if self.counts >= MAX_COUNTS => {
                self.outcome = Some(Err(UploadError::Silent {
                    counts: self.counts,
                }));
            }
            // A vehicle that answers ERROR still holds the transfer of an earlier run open.
            Phase::Counting { .. } => {
                self.repeats += 1;
                self.count(now, self.complaint == Some(MissionResult::ERROR));
            }
            Phase::Paused { .. } => self.start(now, self.complaint == Some(MissionResult::ERROR)),
            Phase::Sending { seq, heard, .. } if self.is_final(seq) => {
                if self.all_sent() && now >= heard + ACK_MS {
                    self.finish(false, 0);
                } else {
                    self.start(now, true);
                }
            }
            Phase::Sending { heard, .. } if now >= heard + self.silence_ms => {
                self.start(now, true);
            }
            Phase::Sending { seq, .. } => {
                self.repeats += 1;
                self.send(now, seq);
            }
        }
    }

    /// The next message to send, if there is one.
    pub fn poll_transmit(&mut self) -> Option<Message> {
        self.outbox.pop_front().map(|body| self.route.message(body))
    }

    /// When [`Upload::handle_timeout`] is due; `None` at the end.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Time> {
        if self.outcome.is_some() {
            return None;
        }
        let due = match self.phase {
            Phase::Counting { again } => again,
            Phase::Paused { until } => until,
            Phase::Sending { seq, heard, .. } if self.is_final(seq) => heard + ACK_MS,
            Phase::Sending {
                asked, sent, heard, ..
            } => {
                let gap_ms = if sent > asked { self.gap_ms } else { 0 };
                (sent + self.rtt.wait_ms().max(gap_ms)).min(heard + self.silence_ms)
            }
        };
        Some(due.min(self.deadline))
    }

    /// How it ended, once it has.
    #[must_use]
    pub fn outcome(&self) -> Option<Result<Sent, UploadError>> {
        self.outcome
    }

    /// Items that have gone out in this run.
    #[must_use]
    pub fn progress(&self) -> usize {
        self.sent.iter().filter(|sent| **sent).count()
    }

    /// How often the transfer was started, and how many messages were repeated.
    #[must_use]
    pub fn effort(&self) -> (u32, u32) {
        (self.runs, self.repeats)
    }

    fn is_final(&self, seq: u16) -> bool {
        usize::from(seq) + 1 == self.items.len()
    }

    /// Whether every item went out in this run.
    pub(crate) fn all_sent(&self) -> bool {
        self.sent.iter().all(|sent| *sent)
    }

    fn finish(&mut self, acknowledged: bool, opaque_id: u32) {
        self.outcome = Some(Ok(Sent {
            acknowledged,
            opaque_id,
            complaint: self.complaint,
        }));
    }

    fn out_of_time(&self) -> UploadError {
        match self.phase {
            Phase::Paused { .. } if self.complaint == Some(MissionResult::DENIED) => {
                UploadError::Denied {
                    denials: self.denials,
                }
            }
            Phase::Counting { .. } if self.runs == 1 => UploadError::Silent {
                counts: self.counts,
            },
            Phase::Counting { .. } | Phase::Paused { .. } => UploadError::OutOfTime {
                seq: self.errors.0,
                runs: self.runs,
                complaint: self.complaint,
            },
            Phase::Sending { seq, .. } => UploadError::OutOfTime {
                seq,
                runs: self.runs,
                complaint: self.complaint,
            },
        }
    }

    /// Starts a new run because of an answer: the first ones at once, later ones after a pause.
    fn restart(&mut self, now: Time, cancel: bool) {
        let until = self.started + RESTART_MS;
        if now < until && self.runs > PROMPT_RUNS {
            // An acceptance from now on is of the run before.
            self.sent.fill(false);
            self.phase = Phase::Paused { until };
        } else {
            self.start(now, cancel);
        }
    }

    /// Starts a run from the beginning.
    fn start(&mut self, now: Time, cancel: bool) {
        self.runs += 1;
        self.started = now;
        self.counts = 0;
        self.sent.fill(false);
        self.count(now, cancel);
    }

    /// Sends `MISSION_COUNT`. PX4 refuses it in mid transfer unless it was
    /// cancelled first; ArduPilot ignores the cancelling.
    fn count(&mut self, now: Time, cancel: bool) {
        if cancel {
            self.outbox.push_back(Body::Ack {
                result: MissionResult::OPERATION_CANCELLED,
                opaque_id: 0,
            });
        }
        let count = u16::try_from(self.items.len()).unwrap_or(u16::MAX);
        self.outbox.push_back(Body::Count {
            count,
            opaque_id: 0,
        });
        self.counts += 1;
        self.phase = Phase::Counting {
            again: now + COUNT_MS,
        };
    }

    /// Any item may be asked for at any time, also again after the last one.
    fn requested(&mut self, now: Time, seq: u16) {
        if usize::from(seq) >= self.items.len() || matches!(self.phase, Phase::Paused { .. }) {
            return;
        }
        match &mut self.phase {
            Phase::Sending {
                seq: last,
                heard,
                sent,
                ..
            } if *last == seq => {
                *heard = now;
                if now - *sent < ECHO_MS {
                    return;
                }
                self.repeats += 1;
            }
            Phase::Sending { asked, .. } => {
                let after_ms = now - *asked;
                self.rtt.sample(after_ms);
                self.begin(now, seq, false);
            }
            _ => self.begin(now, seq, false),
        }
        self.send(now, seq);
    }

    fn begin(&mut self, now: Time, seq: u16, ahead: bool) {
        self.phase = Phase::Sending {
            seq,
            asked: now,
            sent: now,
            heard: now,
            ahead,
        };
    }

    fn send(&mut self, now: Time, seq: u16) {
        let at = usize::from(seq);
        let Some(&(item, current)) = self.items.get(at) else {
            return;
        };
        self.outbox.push_back(Body::ItemInt { seq, current, item });
        if let Some(flag) = self.sent.get_mut(at) {
            *flag = true;
        }
        if let Phase::Sending { sent, .. } = &mut self.phase {
            *sent = now;
        }
    }

    fn acknowledged(&mut self, now: Time, result: MissionResult, opaque_id: u32) {
        match result {
            // Before every item of this run went out it is stale, or the vehicle is wrong.
            MissionResult::ACCEPTED => {
                if self.all_sent() {
                    self.finish(true, opaque_id);
                }
            }
            MissionResult::INVALID_SEQUENCE => self.out_of_step(now),
            MissionResult::DENIED => self.denied(now),
            // The vehicle gave up. While counting this is about an earlier run.
            MissionResult::OPERATION_CANCELLED => {
                self.complaint = Some(result);
                if matches!(self.phase, Phase::Sending { .. }) {
                    self.restart(now, false);
                }
            }
            MissionResult::ERROR => self.error(now),
            fatal => self.reject(fatal),
        }
    }

    /// ArduPilot says this for every item that it does not expect, and goes on. As the
    /// answer to a repetition it means that the item was there already and the request
    /// for the next one was lost. ArduPilot repeats that only after a second, so the next
    /// one goes out unasked: once, because a second guess could run away from the vehicle.
    fn out_of_step(&mut self, now: Time) {
        self.complaint = Some(MissionResult::INVALID_SEQUENCE);
        match self.phase {
            Phase::Sending {
                seq,
                asked,
                sent,
                ahead: false,
                ..
            } if sent > asked && !self.is_final(seq) => {
                self.begin(now, seq + 1, true);
                self.send(now, seq + 1);
            }
            _ => {}
        }
    }

    fn denied(&mut self, now: Time) {
        self.complaint = Some(MissionResult::DENIED);
        if matches!(self.phase, Phase::Counting { .. }) {
            let wait_ms = DENIED_MS << self.denials.min(2);
            self.denials += 1;
            self.phase = Phase::Paused {
                until: now + wait_ms,
            };
        }
    }

    /// ERROR has many meanings: ArduPilot is not receiving (it rebooted, gave up, or has
    /// everything already), PX4 is busy, or this item is bad. Starting over distinguishes them.
    fn error(&mut self, now: Time) {
        self.complaint = Some(MissionResult::ERROR);
        let Phase::Sending { seq, .. } = self.phase else {
            return;
        };
        let (at, times) = self.errors;
        self.errors = (seq, if at == seq { times + 1 } else { 1 });
        // A vehicle that has everything says so of the last item sent again: the read-back decides.
        if self.is_final(seq) && self.all_sent() {
            self.finish(false, 0);
        } else if self.errors.1 >= MAX_ERRORS {
            self.reject(MissionResult::ERROR);
        } else {
            self.restart(now, true);
        }
    }

    fn reject(&mut self, result: MissionResult) {
        let seq = match self.phase {
            Phase::Sending { seq, .. } => Some(seq),
            _ => None,
        };
        let item = seq
            .and_then(|seq| self.items.get(usize::from(seq)))
            .map(|(item, _)| *item);
        self.outcome = Some(Err(UploadError::Rejected { result, seq, item }));
    }
}
