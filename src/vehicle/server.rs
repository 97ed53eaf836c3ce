//! The mission server of a simulated vehicle, sans-IO.

mod give;
mod receive;

use std::collections::{BTreeMap, VecDeque};

use super::profile::Profile;
use super::rules;
use crate::link::{
    Address, Body, Heartbeat, List, MISSION_TYPE_ALL, MODE_ARMED, Message, MissionMessage,
    MissionResult, STATE_ACTIVE, STATE_STANDBY, Time,
};
use crate::mission::{Home, Item};

/// Between two heartbeats, milliseconds.
const HEARTBEAT_MS: u64 = 1000;
/// After a start: nothing is heard or said, milliseconds.
const DARK_MS: u64 = 800;
/// After a start: heartbeats say BOOT, milliseconds.
const BOOT_MS: u64 = 3000;
/// `MAV_STATE_BOOT`.
const STATE_BOOT: u8 = 1;

/// A simulated vehicle.
#[derive(Clone, Debug)]
pub struct Vehicle {
    profile: Profile,
    us: Address,
    home: Option<Home>,
    lists: BTreeMap<List, Vec<Item>>,
    transfer: Transfer,
    /// Whom the last item of a completed upload came from.
    last: Option<(Address, List, u16)>,
    outbox: VecDeque<Message>,
    heartbeat_due: Time,
    started: Time,
    armed: bool,
}

#[derive(Clone, Debug)]
enum Transfer {
    Idle,
    /// Items come in.
    Receiving {
        partner: Address,
        list: List,
        count: u16,
        /// What came so far. ArduPilot writes each mission item at once instead.
        staged: Vec<Item>,
        next: u16,
        asked: Time,
        heard: Time,
    },
    /// Items go out (PX4 and generic keep count of it).
    Giving {
        partner: Address,
        list: List,
        next: u16,
        heard: Time,
    },
}

impl Vehicle {
    /// A vehicle with component id 1 that has been running for a while.
    #[must_use]
    pub fn new(profile: Profile, sysid: u8, home: Option<Home>, now: Time) -> Self {
        Self {
            profile,
            us: Address {
                system: sysid,
                component: 1,
            },
            home,
            lists: List::ALL.map(|list| (list, Vec::new())).into(),
            transfer: Transfer::Idle,
            last: None,
            outbox: VecDeque::new(),
            heartbeat_due: now,
            started: Time(0),
            armed: false,
        }
    }

    /// Its system and component id.
    #[must_use]
    pub fn address(&self) -> Address {
        self.us
    }

    /// What it holds, without home.
    #[must_use]
    pub fn items(&self, list: List) -> &[Item] {
        let rows = self.rows(list);
        match (self.profile, list) {
            (Profile::ArduPilot, List::Mission) => rows.get(1..).unwrap_or_default(),
            _ => rows,
        }
    }

    /// Starts the motors, or stops them.
    pub fn set_armed(&mut self, armed: bool) {
        self.armed = armed;
    }

    /// Starts the autopilot again. Lists are stored; a transfer is not.
    pub fn reboot(&mut self, now: Time) {
        self.transfer = Transfer::Idle;
        self.last = None;
        self.outbox.clear();
        self.started = now + BOOT_MS;
        self.heartbeat_due = now + DARK_MS;
    }

    /// Takes in a message, whoever sent it.
    pub fn handle(&mut self, now: Time, from: Address, message: &Message) {
        let Message::Mission(mission) = message else {
            return;
        };
        if self.is_dark(now) || ![self.us.system, 0].contains(&mission.target.system) {
            return;
        }
        let Some(list) = List::of(mission.mission_type) else {
            if mission.body == Body::ClearAll && mission.mission_type == MISSION_TYPE_ALL {
                self.clear_all(from);
            }
            return;
        };
        match mission.body {
            Body::Count { count, .. } => self.count(now, from, list, count),
            Body::ItemInt { seq, item, .. } | Body::Item { seq, item, .. } => {
                self.item(now, from, list, seq, item);
            }
            Body::RequestList => self.request_list(now, from, list),
            Body::RequestInt { seq } => self.request(now, from, list, seq, true),
            Body::Request { seq } => self.request(now, from, list, seq, false),
            Body::Ack { result, .. } => self.acknowledged(from, list, result),
            Body::ClearAll => self.clear(from, list),
        }
    }

    /// Does what is due.
    pub fn handle_timeout(&mut self, now: Time) {
        if now >= self.heartbeat_due && !self.is_dark(now) {
            self.heartbeat_due = now + HEARTBEAT_MS;
            self.beat(now);
        }
        match self.transfer {
            Transfer::Receiving {
                partner,
                list,
                heard,
                ..
            } if now >= heard + self.profile.give_up_ms() => self.give_up(partner, list),
            Transfer::Receiving { asked, .. } if now >= asked + self.profile.repeat_ms() => {
                self.ask(now);
            }
            Transfer::Giving { heard, .. } if now >= heard + self.profile.give_up_ms() => {
                self.transfer = Transfer::Idle;
            }
            _ => {}
        }
    }

    /// The next message to send, if there is one.
    pub fn poll_transmit(&mut self) -> Option<Message> {
        self.outbox.pop_front()
    }

    /// When [`Vehicle::handle_timeout`] is due.
    #[must_use]
    pub fn poll_timeout(&self) -> Time {
        let transfer = match self.transfer {
            Transfer::Idle => self.heartbeat_due,
            Transfer::Receiving { asked, heard, .. } => {
                (asked + self.profile.repeat_ms()).min(heard + self.profile.give_up_ms())
            }
            Transfer::Giving { heard, .. } => heard + self.profile.give_up_ms(),
        };
        transfer.min(self.heartbeat_due)
    }

    fn rows(&self, list: List) -> &[Item] {
        self.lists.get(&list).map_or(&[], Vec::as_slice)
    }

    fn is_dark(&self, now: Time) -> bool {
        self.started - now > BOOT_MS - DARK_MS
    }

    fn is_booting(&self, now: Time) -> bool {
        now < self.started
    }

    fn beat(&mut self, now: Time) {
        let system_status = match (self.profile, self.armed) {
            (Profile::Generic, _) => 0,
            _ if self.is_booting(now) => STATE_BOOT,
            (_, true) => STATE_ACTIVE,
            (_, false) => STATE_STANDBY,
        };
        self.outbox.push_back(Message::Heartbeat(Heartbeat {
            kind: self.profile.kind(),
            autopilot: self.profile.autopilot(),
            base_mode: if self.armed { MODE_ARMED } else { 0 },
            custom_mode: 0,
            system_status,
        }));
        let total = u16::try_from(self.items(List::Mission).len()).unwrap_or(u16::MAX);
        self.outbox.push_back(Message::MissionCurrent {
            seq: 0,
            total,
            opaque_ids: List::ALL.map(|list| self.opaque_id(list)),
        });
        // A generic one, as MAVSDK's mission server, says nothing about its place.
        if let (Some(home), Profile::ArduPilot | Profile::Px4) = (self.home, self.profile) {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "`as` saturates, two thousand kilometres up"
            )]
            let amsl_mm = (f64::from(home.amsl_m) * 1000.0).round() as i32;
            self.outbox.push_back(Message::HomePosition {
                x: home.x,
                y: home.y,
                amsl_mm,
            });
        }
    }

    fn opaque_id(&self, list: List) -> u32 {
        match self.profile {
            Profile::Px4 => rules::opaque_id(self.rows(list)),
            Profile::ArduPilot | Profile::Generic => 0,
        }
    }

    fn say(&mut self, to: Address, mission_type: u8, body: Body) {
        self.outbox.push_back(Message::Mission(MissionMessage {
            target: to,
            mission_type,
            body,
        }));
    }

    fn acknowledge(&mut self, to: Address, list: List, result: MissionResult) {
        let opaque_id = match result {
            MissionResult::ACCEPTED => self.opaque_id(list),
            _ => 0,
        };
        self.say(to, list.mission_type(), Body::Ack { result, opaque_id });
    }

    fn warn(&mut self, text: &str) {
        self.outbox.push_back(Message::StatusText {
            severity: 4,
            text: text.to_owned(),
        });
    }
}
