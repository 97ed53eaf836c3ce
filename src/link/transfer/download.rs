//! Reads one list from one vehicle (`MISSION_REQUEST_LIST`, one request at a time,
//! closing `MISSION_ACK`).

use std::collections::{BTreeMap, VecDeque};

use crate::link::message::{Address, Body, Message, MissionResult, Route};
use crate::link::rtt::RttEstimator;
use crate::link::time::Time;
use crate::mission::Item;

/// Wait for `MISSION_COUNT`, milliseconds (mission service guide).
const LIST_MS: u64 = 1500;
/// `MISSION_REQUEST_LIST`s without any answer before the vehicle counts as silent.
const MAX_LISTS: u32 = 20;
/// Silence in mid transfer before it is started over, milliseconds. PX4 forgets after 5 s.
const SILENCE_MS: u64 = 6000;
/// Items in float degrees, and none in integers, before a vehicle counts as one that knows no others.
const MAX_FLOATS: u32 = 3;
/// Runs in a row in which the list is counted and no item comes. One takes [`SILENCE_MS`].
const MAX_EMPTY_RUNS: u32 = 10;
/// Wait after `DENIED` or `ERROR` before asking again, milliseconds.
const BUSY_MS: u64 = 1500;

/// A download in progress; see the [driver contract](crate::link#driver-contract).
#[derive(Debug)]
pub struct Download {
    route: Route,
    deadline: Time,
    outbox: VecDeque<Body>,
    phase: Phase,
    items: Vec<Item>,
    /// Items that came before one with a lower number.
    early: BTreeMap<u16, Item>,
    /// The first item that was never requested.
    next: u16,
    /// Most items that are requested at once.
    window: usize,
    opaque_id: u32,
    /// A list with this id is not read; 0 for none.
    known_id: u32,
    is_unchanged: bool,
    rtt: RttEstimator,
    lists: u32,
    /// Items that came in float degrees, and runs in a row without an item.
    floats: u32,
    empty_runs: u32,
    complaint: Option<MissionResult>,
    repeats: u32,
    outcome: Option<Result<Vec<Item>, DownloadError>>,
}

#[derive(Clone, Copy, Debug)]
enum Phase {
    /// The list was requested, or will be at that time.
    Listing { again: Time },
    /// The item after those held was asked for first, last, and the vehicle last gave one then.
    Reading {
        count: u16,
        asked: Time,
        sent: Time,
        heard: Time,
    },
}

/// Why a download ended without the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DownloadError {
    /// Nothing came back.
    #[error("no answer to {lists} MISSION_REQUEST_LIST messages")]
    Silent {
        /// How many were sent.
        lists: u32,
    },
    /// The vehicle refused.
    #[error("refused with {result}")]
    Refused {
        /// Its code.
        result: MissionResult,
    },
    /// Items came in the old form alone, in which places are float degrees.
    #[error(
        "it answers MISSION_REQUEST_INT with MISSION_ITEM, whose places are up to a metre off: a vehicle without \
         MISSION_ITEM_INT is not supported"
    )]
    FloatDegrees,
    /// The list was counted, and no item came.
    #[error("it counts the items of its list, and answered no MISSION_REQUEST_INT in {lists} runs")]
    NoItems {
        /// How often the list was requested and counted.
        lists: u32,
    },
    /// Time ran out.
    #[error("not finished in time, {held} items were read")]
    OutOfTime {
        /// How many items had come.
        held: usize,
    },
}

impl Download {
    /// Starts a download.
    #[must_use]
    pub fn new(route: Route, deadline: Time, now: Time) -> Self {
        let mut download = Self {
            route,
            deadline,
            outbox: VecDeque::new(),
            phase: Phase::Listing { again: now },
            items: Vec::new(),
            early: BTreeMap::new(),
            next: 0,
            window: 1,
            opaque_id: 0,
            known_id: 0,
            is_unchanged: false,
            rtt: RttEstimator::default(),
            lists: 0,
            floats: 0,
            empty_runs: 0,
            complaint: None,
            repeats: 0,
            outcome: None,
        };
        download.list(now);
        download
    }

    /// Requests up to `window` items at once, of a vehicle that gives them in any order.
    #[must_use]
    pub(crate) fn with_window(mut self, window: usize) -> Self {
        self.window = window.max(1);
        self
    }

    /// Ends as unchanged, without an item, if the vehicle gives the list this id; 0 is none.
    #[must_use]
    pub(crate) fn unless_id(mut self, known_id: u32) -> Self {
        self.known_id = known_id;
        self
    }

    /// Whether it ended because the list still has the known id.
    pub(crate) fn is_unchanged(&self) -> bool {
        self.is_unchanged
    }

    /// Takes in a message of any sender.
    pub fn handle(&mut self, now: Time, from: Address, message: &Message) {
        if self.outcome.is_some() {
            return;
        }
        match self.route.accept(from, message) {
            Some(Body::Count { count, opaque_id }) => self.counted(now, count, opaque_id),
            Some(Body::ItemInt { seq, item, .. }) => self.received(now, seq, item),
            Some(Body::Item { .. }) => self.received_float(),
            Some(Body::Ack { result, .. }) => self.answered(now, result),
            _ => {}
        }
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Time) {
        if self.outcome.is_some() || self.poll_timeout().is_none_or(|due| now < due) {
            return;
        }
        if now >= self.deadline {
            self.outcome = Some(Err(match self.complaint {
                Some(result) => DownloadError::Refused { result },
                None => DownloadError::OutOfTime {
                    held: self.items.len(),
                },
            }));
            return;
        }
        match self.phase {
            Phase::Listing { .. } if self.lists >= MAX_LISTS => {
                self.outcome = Some(Err(match self.complaint {
                    Some(result) => DownloadError::Refused { result },
                    None => DownloadError::Silent { lists: self.lists },
                }));
            }
            Phase::Listing { .. } => {
                self.repeats += u32::from(self.lists > 0);
                self.list(now);
            }
            Phase::Reading { heard, .. } if now >= heard + SILENCE_MS => self.run_again(now),
            Phase::Reading { .. } => {
                self.repeats += 1;
                self.request_missing(now);
            }
        }
    }

    /// The next message to send, if there is one.
    pub fn poll_transmit(&mut self) -> Option<Message> {
        self.outbox.pop_front().map(|body| self.route.message(body))
    }

    /// When [`Download::handle_timeout`] is due; `None` at the end.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Time> {
        if self.outcome.is_some() {
            return None;
        }
        let due = match self.phase {
            Phase::Listing { again } => again,
            Phase::Reading { sent, heard, .. } => {
                (sent + self.rtt.wait_ms()).min(heard + SILENCE_MS)
            }
        };
        Some(due.min(self.deadline))
    }

    /// How it ended, once it has: the items in order, home row included if the vehicle keeps one.
    #[must_use]
    pub fn outcome(&self) -> Option<&Result<Vec<Item>, DownloadError>> {
        self.outcome.as_ref()
    }

    /// The vehicle's own id of the list; 0 if it gives none.
    #[must_use]
    pub fn opaque_id(&self) -> u32 {
        self.opaque_id
    }

    /// Items read so far.
    #[must_use]
    pub fn progress(&self) -> usize {
        self.items.len() + self.early.len()
    }

    /// How many messages were repeated.
    #[must_use]
    pub fn repeats(&self) -> u32 {
        self.repeats
    }

    /// Nothing more comes of the list: it is begun anew, but not for ever where it never gives an item.
    fn run_again(&mut self, now: Time) {
        self.empty_runs += 1;
        if self.empty_runs >= MAX_EMPTY_RUNS {
            let lists = self.empty_runs;
            self.outcome = Some(Err(DownloadError::NoItems { lists }));
        } else {
            self.list(now);
        }
    }

    /// An answer to another station may be one of these, too.
    fn received_float(&mut self) {
        if matches!(self.phase, Phase::Reading { .. }) {
            self.floats += 1;
            if self.floats >= MAX_FLOATS {
                self.outcome = Some(Err(DownloadError::FloatDegrees));
            }
        }
    }

    fn list(&mut self, now: Time) {
        self.lists += 1;
        self.forget_items();
        self.outbox.push_back(Body::RequestList);
        self.phase = Phase::Listing {
            again: now + LIST_MS,
        };
    }

    fn counted(&mut self, now: Time, count: u16, opaque_id: u32) {
        match self.phase {
            // The echo of a repeated MISSION_REQUEST_LIST.
            Phase::Reading { count: known, .. }
                if (known, self.opaque_id) == (count, opaque_id) =>
            {
                return;
            }
            _ => self.forget_items(),
        }
        self.opaque_id = opaque_id;
        if opaque_id != 0 && opaque_id == self.known_id {
            self.is_unchanged = true;
            return self.close(MissionResult::OPERATION_CANCELLED);
        }
        self.lists = 0;
        self.complaint = None;
        self.phase = Phase::Reading {
            count,
            asked: now,
            sent: now,
            heard: now,
        };
        self.advance(now);
    }

    fn received(&mut self, now: Time, seq: u16, item: Item) {
        let is_news = usize::from(seq) >= self.items.len() && !self.early.contains_key(&seq);
        let is_asked = seq < self.next && is_news;
        let is_first = self.items.is_empty() && self.early.is_empty();
        let Phase::Reading { asked, heard, .. } = &mut self.phase else {
            return;
        };
        if !is_asked {
            return;
        }
        (self.floats, self.empty_runs) = (0, 0);
        // Of several requests only the first answer shows how long one takes.
        if self.window == 1 || is_first {
            self.rtt.sample(now - *asked);
        }
        *asked = now;
        *heard = now;
        self.early.insert(seq, item);
        while let Some(item) = self.early.remove(&next_of(&self.items)) {
            self.items.push(item);
        }
        self.advance(now);
    }

    fn forget_items(&mut self) {
        self.items.clear();
        self.early.clear();
        self.next = 0;
    }

    /// Requests more items, or ends when there is none.
    fn advance(&mut self, now: Time) {
        let Phase::Reading { count, .. } = self.phase else {
            return;
        };
        if self.items.len() < usize::from(count) {
            self.request(now, count);
        } else {
            self.close(MissionResult::ACCEPTED);
        }
    }

    /// Ends with an ACK that frees the vehicle: PX4 and MAVSDK stay busy for seconds without it.
    fn close(&mut self, result: MissionResult) {
        self.outbox.push_back(Body::Ack {
            result,
            opaque_id: 0,
        });
        self.outcome = Some(Ok(std::mem::take(&mut self.items)));
    }

    /// Requests items that were never requested, as many as the window allows.
    fn request(&mut self, now: Time, count: u16) {
        let received = self.items.len() + self.early.len();
        while self.next < count && usize::from(self.next) < received + self.window {
            self.outbox.push_back(Body::RequestInt { seq: self.next });
            self.next += 1;
        }
        self.note_request(now);
    }

    /// Requests again everything that did not come.
    fn request_missing(&mut self, now: Time) {
        let missing = next_of(&self.items)..self.next;
        let missing = missing.filter(|seq| !self.early.contains_key(seq));
        let requests = missing.map(|seq| Body::RequestInt { seq });
        self.outbox.extend(requests);
        self.note_request(now);
    }

    fn note_request(&mut self, now: Time) {
        if let Phase::Reading { sent, .. } = &mut self.phase {
            *sent = now;
        }
    }

    /// A vehicle that is still receiving, or lost our transfer, gets the request again later.
    fn answered(&mut self, now: Time, result: MissionResult) {
        match result {
            MissionResult::ACCEPTED
            | MissionResult::INVALID_SEQUENCE
            | MissionResult::OPERATION_CANCELLED => {}
            // PX4 answers ERROR, and drops the transfer, when an old copy of a request
            // overtakes newer ones.
            MissionResult::DENIED | MissionResult::ERROR => {
                if matches!(self.phase, Phase::Reading { .. }) {
                    self.rtt.back_off();
                }
                self.complaint = Some(result);
                self.phase = Phase::Listing {
                    again: now + BUSY_MS,
                };
            }
            fatal => self.outcome = Some(Err(DownloadError::Refused { result: fatal })),
        }
    }
}

/// The number of the item after these.
fn next_of(items: &[Item]) -> u16 {
    u16::try_from(items.len()).unwrap_or(u16::MAX)
}
