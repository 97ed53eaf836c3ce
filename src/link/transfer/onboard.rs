//! Reads everything that one vehicle holds: discovery, then fence, rally and mission, then whether they are so still.

mod reread;

use std::collections::VecDeque;

use super::discovery::{COMPANION_MS, is_ready};
use super::download::{Download, DownloadError};
use super::identity;
use super::report::Failure;
use crate::link::message::{Address, Heartbeat, Message, MissionResult, MissionType, Route};
use crate::link::time::Time;
use crate::mission::{Home, Item};
use crate::spec::Autopilot;

/// Wait for the first heartbeat, milliseconds.
const NOBODY_MS: u64 = 10_000;
/// Wait for other vehicles when no system id was given, milliseconds.
const OTHERS_MS: u64 = 1500;
/// Wait for a vehicle that is starting, milliseconds.
const STARTING_MS: u64 = 30_000;
/// The whole reading, milliseconds.
const READING_MS: u64 = 600_000;
/// Wait for `HOME_POSITION` after the lists, milliseconds; PX4 sends it every 2 s.
const HOME_MS: u64 = 3000;
/// Between two of our heartbeats, milliseconds.
const HEARTBEAT_MS: u64 = 1000;
/// The lists in the order of reading.
const ORDER: [MissionType; 3] = [MissionType::Fence, MissionType::Rally, MissionType::Mission];

/// The lists that a vehicle holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Onboard {
    /// Its system id.
    pub sysid: u8,
    /// Its autopilot, if it is a supported one.
    pub autopilot: Option<Autopilot>,
    /// Autopilot and type in words.
    pub description: String,
    /// Its home, if it reports one.
    pub home: Option<Home>,
    /// Mission items, without ArduPilot's home row.
    pub mission: Vec<Item>,
    /// Fence items.
    pub fence: Vec<Item>,
    /// Rally points.
    pub rally: Vec<Item>,
    /// Lists that the vehicle does not know.
    pub unknown: Vec<MissionType>,
}

/// The reading of one vehicle; see the [driver contract](crate::link#driver-contract).
#[derive(Debug)]
pub struct Reading {
    us: Address,
    /// Which system; absent: the only one on the link.
    sysid: Option<u8>,
    began: Time,
    heartbeat_due: Time,
    outbox: VecDeque<Message>,
    stage: Stage,
    heard: Vec<(Address, Heartbeat)>,
    /// When another component of the vehicle was first heard.
    companion: Option<Time>,
    vehicle: Option<(Address, Heartbeat)>,
    /// Index into [`ORDER`].
    at: usize,
    lists: Vec<Vec<Item>>,
    /// The vehicle's own ids of them; 0 of those that it gives none.
    ids: Vec<u32>,
    /// Whether the lists are looked at again in the end, and whether that has begun.
    looks_again: bool,
    is_last_look: bool,
    /// Who was heard to write to the vehicle since it began, and its list (none for all of them).
    foreign: Option<(u8, Option<MissionType>)>,
    /// How often it was begun anew.
    again: u32,
    unknown: Vec<MissionType>,
    home: Option<Home>,
    outcome: Option<Result<Onboard, Failure>>,
}

#[derive(Debug)]
enum Stage {
    /// Waits until the vehicle speaks and is ready.
    Discovery {
        until: Time,
    },
    Reading(Download),
    /// Waits until nobody writes to the vehicle, not for ever.
    Quiet {
        until: Time,
        latest: Time,
    },
    /// Waits for `HOME_POSITION`.
    AwaitingHome {
        until: Time,
    },
}

impl Reading {
    /// Begins to read a system, or the only one that is heard, in the name of `us`.
    #[must_use]
    pub fn new(sysid: Option<u8>, us: Address, now: Time) -> Self {
        Self {
            us,
            sysid,
            began: now,
            heartbeat_due: now,
            outbox: VecDeque::new(),
            stage: Stage::Discovery {
                until: now + NOBODY_MS,
            },
            heard: Vec::new(),
            companion: None,
            vehicle: None,
            at: 0,
            lists: Vec::new(),
            ids: Vec::new(),
            looks_again: true,
            is_last_look: false,
            foreign: None,
            again: 0,
            unknown: Vec::new(),
            home: None,
            outcome: None,
        }
    }

    /// Reads every list once: a vehicle in flight flies on meanwhile.
    pub(crate) fn in_the_air(mut self) -> Self {
        self.looks_again = false;
        self
    }

    /// Takes in a message of any sender.
    pub fn handle(&mut self, now: Time, from: Address, message: &Message) {
        match message {
            Message::Heartbeat(heartbeat) if identity::is_autopilot(from, heartbeat) => {
                self.heartbeat(now, from, *heartbeat);
            }
            &Message::HomePosition { x, y, amsl_mm }
                if self.vehicle.is_some_and(|(vehicle, _)| vehicle == from) =>
            {
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "float32 is what missions have"
                )]
                let amsl_m = (f64::from(amsl_mm) / 1000.0) as f32;
                self.home = Some(Home { x, y, amsl_m });
            }
            Message::Mission(mission) => {
                self.look_for_foreign(now, from, mission);
                if let Stage::Reading(download) = &mut self.stage {
                    download.handle(now, from, message);
                }
            }
            _ => {}
        }
        self.advance(now);
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Time) {
        if self.outcome.is_some() {
            return;
        }
        if now >= self.heartbeat_due {
            self.heartbeat_due = now + HEARTBEAT_MS;
            self.outbox.push_back(Message::Heartbeat(Heartbeat::OURS));
        }
        match &mut self.stage {
            Stage::Discovery { until } if now >= *until => self.discovery_timeout(now),
            Stage::Reading(download) => download.handle_timeout(now),
            Stage::AwaitingHome { until } if now >= *until => self.end(),
            Stage::Quiet { until, .. } if now >= *until => self.read_anew(now),
            Stage::Discovery { .. } | Stage::AwaitingHome { .. } | Stage::Quiet { .. } => {}
        }
        self.advance(now);
    }

    /// The next message to send, if there is one.
    pub fn poll_transmit(&mut self) -> Option<Message> {
        if let Some(message) = self.outbox.pop_front() {
            return Some(message);
        }
        match &mut self.stage {
            Stage::Reading(download) => download.poll_transmit(),
            Stage::Discovery { .. } | Stage::AwaitingHome { .. } | Stage::Quiet { .. } => None,
        }
    }

    /// When [`Reading::handle_timeout`] is due; `None` at the end.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Time> {
        if self.outcome.is_some() {
            return None;
        }
        let stage = match &self.stage {
            Stage::Discovery { until }
            | Stage::AwaitingHome { until }
            | Stage::Quiet { until, .. } => Some(*until),
            Stage::Reading(download) => download.poll_timeout(),
        };
        Some(stage.map_or(self.heartbeat_due, |due| due.min(self.heartbeat_due)))
    }

    /// The lists or the failure, once it is over.
    #[must_use]
    pub fn outcome(&self) -> Option<&Result<Onboard, Failure>> {
        self.outcome.as_ref()
    }

    /// The current list, and the number of its items read.
    #[must_use]
    pub fn progress(&self) -> Option<(MissionType, usize)> {
        match &self.stage {
            Stage::Reading(download) => Some((*ORDER.get(self.at)?, download.progress())),
            Stage::Discovery { .. } | Stage::AwaitingHome { .. } | Stage::Quiet { .. } => None,
        }
    }

    /// Ends the reading when the driver cannot go on.
    pub(crate) fn abort(&mut self, failure: Failure) {
        self.outcome.get_or_insert(Err(failure));
    }

    fn heartbeat(&mut self, now: Time, from: Address, heartbeat: Heartbeat) {
        let Stage::Discovery { until } = &mut self.stage else {
            return;
        };
        self.heard.retain(|(address, _)| *address != from);
        self.heard.push((from, heartbeat));
        match (self.vehicle, self.sysid) {
            (Some((vehicle, _)), _) if vehicle == from => self.vehicle = Some((from, heartbeat)),
            (Some((vehicle, _)), _)
                if vehicle.system == from.system && identity::is_first_choice(from) =>
            {
                self.vehicle = Some((from, heartbeat));
            }
            (Some(_), _) => return,
            (None, Some(sysid)) if sysid == from.system => {
                let since = *self.companion.get_or_insert(now);
                if !identity::is_first_choice(from) && now - since < COMPANION_MS {
                    return;
                }
                self.vehicle = Some((from, heartbeat));
                *until = now + STARTING_MS;
            }
            (None, Some(_)) => return,
            // The first of them: waits for others.
            (None, None) => {
                if self.heard.len() == 1 {
                    *until = (*until).min(now + OTHERS_MS);
                }
                return;
            }
        }
        if is_ready(&heartbeat) {
            self.read(now);
        }
    }

    /// No vehicle came, or it did not get ready. Without a system id, the only vehicle
    /// heard is read.
    fn discovery_timeout(&mut self, now: Time) {
        if let Some((_, heartbeat)) = self.vehicle {
            return self.fail(Failure::NotReady {
                status: heartbeat.system_status,
                after_s: STARTING_MS / 1000,
            });
        }
        let mut systems: Vec<u8> = self.heard.iter().map(|(from, _)| from.system).collect();
        systems.sort_unstable();
        systems.dedup();
        // The autopilot before other components of the vehicle.
        self.heard
            .sort_by_key(|(from, _)| !identity::is_first_choice(*from));
        match (self.sysid, &self.heard[..], &systems[..]) {
            (None, [(from, heartbeat), ..], [_]) => {
                let ready = is_ready(heartbeat);
                self.vehicle = Some((*from, *heartbeat));
                self.stage = Stage::Discovery {
                    until: now + STARTING_MS,
                };
                if ready {
                    self.read(now);
                }
            }
            (None, _, []) => self.fail(Failure::Nothing {
                after_s: NOBODY_MS / 1000,
            }),
            (None, ..) => self.fail(Failure::Several { heard: systems }),
            (Some(sysid), ..) => self.fail(Failure::Nobody {
                sysid,
                after_s: NOBODY_MS / 1000,
                heard: systems,
            }),
        }
    }

    /// Begins the next list, or the end.
    fn read(&mut self, now: Time) {
        let Some((vehicle, _)) = self.vehicle else {
            return;
        };
        match ORDER.get(self.at) {
            Some(&list) => {
                let us = self.us;
                let route = Route { us, vehicle, list };
                let deadline = self.began + READING_MS;
                let mut download = Download::new(route, deadline, now);
                if self.is_last_look || !self.looks_again {
                    let id = self.ids.get(self.at).copied().unwrap_or_default();
                    download = download.with_window(self.window()).unless_id(id);
                }
                self.stage = Stage::Reading(download);
            }
            None if self.foreign.is_some() => self.begin_anew(now),
            None if self.looks_again && !self.is_last_look => {
                (self.at, self.is_last_look) = (0, true);
                self.read(now);
            }
            None => {
                self.take_home_row();
                self.stage = Stage::AwaitingHome {
                    until: now + HOME_MS,
                };
            }
        }
    }

    fn advance(&mut self, now: Time) {
        if self.outcome.is_some() {
            return;
        }
        match &mut self.stage {
            Stage::AwaitingHome { .. } if self.home.is_some() => self.end(),
            Stage::Reading(download) => {
                let Some(ended) = download.outcome().cloned() else {
                    return;
                };
                let (id, is_unchanged) = (download.opaque_id(), download.is_unchanged());
                // The closing ACK is still in there.
                while let Some(message) = download.poll_transmit() {
                    self.outbox.push_back(message);
                }
                match self.is_last_look {
                    true if is_unchanged => self.next(now),
                    true => self.looked(now, ended),
                    false => self.listed(now, ended, id),
                }
            }
            Stage::Discovery { .. } | Stage::AwaitingHome { .. } | Stage::Quiet { .. } => {}
        }
    }

    fn next(&mut self, now: Time) {
        self.at += 1;
        self.read(now);
    }

    fn listed(&mut self, now: Time, ended: Result<Vec<Item>, DownloadError>, id: u32) {
        let Some(&list) = ORDER.get(self.at) else {
            return;
        };
        match ended {
            Ok(items) => self.lists.push(items),
            Err(DownloadError::Refused {
                result: MissionResult::UNSUPPORTED,
            }) if list != MissionType::Mission => {
                self.unknown.push(list);
                self.lists.push(Vec::new());
            }
            Err(error) => return self.fail(Failure::ReadBack { list, error }),
        }
        self.ids.push(id);
        self.next(now);
    }

    /// Whether the first row of the mission is its home.
    fn counts_home(&self) -> bool {
        self.vehicle.is_some_and(|(_, heartbeat)| {
            Autopilot::of_mavlink(heartbeat.autopilot)
                .is_some_and(|autopilot| autopilot.conventions().counts_home)
        })
    }

    /// ArduPilot's first row is its home, or zeros as long as it has none.
    fn take_home_row(&mut self) {
        let counts_home = self.counts_home();
        let Some(mission) = self.lists.last_mut().filter(|items| !items.is_empty()) else {
            return;
        };
        if counts_home {
            let row = mission.remove(0);
            if (row.x, row.y) != (0, 0) {
                self.home = Some(Home {
                    x: row.x,
                    y: row.y,
                    amsl_m: row.z,
                });
            }
        }
    }

    fn fail(&mut self, failure: Failure) {
        self.outcome = Some(Err(failure));
    }

    fn end(&mut self) {
        let Some((vehicle, heartbeat)) = self.vehicle else {
            return;
        };
        let mut lists = std::mem::take(&mut self.lists).into_iter();
        let [fence, rally, mission] = ORDER.map(|_| lists.next().unwrap_or_default());
        self.outcome = Some(Ok(Onboard {
            sysid: vehicle.system,
            autopilot: Autopilot::of_mavlink(heartbeat.autopilot),
            description: identity::describe(&heartbeat),
            home: self.home,
            mission,
            fence,
            rally,
            unknown: std::mem::take(&mut self.unknown),
        }));
    }
}
