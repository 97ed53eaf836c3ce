//! The mission server of a simulated vehicle, sans-IO.

use std::collections::{BTreeMap, VecDeque};

use super::profile::Profile;
use super::rules;
use crate::link::{
    Address, Body, Heartbeat, List, MISSION_TYPE_ALL, MODE_ARMED, Message, MissionMessage,
    MissionResult, STATE_ACTIVE, STATE_STANDBY, Time, kept,
};
use crate::mission::{Home, Item, command, frame};

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

    /// Asks for the item that is next.
    fn ask(&mut self, now: Time) {
        let Transfer::Receiving {
            partner,
            list,
            next: seq,
            ref mut asked,
            ..
        } = self.transfer
        else {
            return;
        };
        *asked = now;
        // ArduPilot asks with the old message, and means MISSION_ITEM_INT nevertheless.
        let body = match self.profile {
            Profile::ArduPilot => Body::Request { seq },
            Profile::Px4 | Profile::Generic => Body::RequestInt { seq },
        };
        self.say(partner, list.mission_type(), body);
    }

    fn give_up(&mut self, partner: Address, list: List) {
        self.transfer = Transfer::Idle;
        match self.profile {
            Profile::ArduPilot => {
                self.warn("Mission upload timeout");
                self.acknowledge(partner, list, MissionResult::OPERATION_CANCELLED);
            }
            Profile::Px4 => self.warn("Operation timeout"),
            Profile::Generic => {}
        }
    }

    fn count(&mut self, now: Time, from: Address, list: List, count: u16) {
        let busy_with = match self.transfer {
            Transfer::Idle => None,
            Transfer::Receiving { partner, next, .. } => Some((partner, next)),
            Transfer::Giving { partner, .. } => match self.profile {
                Profile::Px4 => Some((partner, 1)),
                Profile::ArduPilot | Profile::Generic => None,
            },
        };
        match (self.profile, busy_with) {
            (Profile::ArduPilot, Some((partner, _))) if partner != from => {
                return self.acknowledge(from, list, MissionResult::DENIED);
            }
            (Profile::Px4, Some((partner, 0))) if partner == from => return self.ask(now),
            (Profile::Px4, Some(_)) => {
                return self.acknowledge(from, list, MissionResult::ERROR);
            }
            (Profile::Generic, Some(_)) => return,
            (Profile::ArduPilot, Some(_)) | (_, None) => {}
        }
        let is_starting = self.profile == Profile::ArduPilot && self.is_booting(now);
        if usize::from(count) > self.profile.capacity(list) || is_starting {
            return self.acknowledge(from, list, MissionResult::NO_SPACE);
        }
        if let (Profile::ArduPilot, List::Mission, Some(rows)) =
            (self.profile, list, self.lists.get_mut(&list))
        {
            rows.truncate(usize::from(count));
        }
        self.last = None;
        self.transfer = Transfer::Receiving {
            partner: from,
            list,
            count,
            staged: Vec::new(),
            next: 0,
            asked: now,
            heard: now,
        };
        if count == 0 {
            self.complete();
        } else {
            self.ask(now);
        }
    }

    fn item(&mut self, now: Time, from: Address, list: List, seq: u16, item: Item) {
        let Transfer::Receiving {
            partner,
            list: expected_list,
            count,
            next,
            ..
        } = self.transfer
        else {
            return self.uninvited(from, list, seq);
        };
        if partner != from || list != expected_list {
            return;
        }
        if seq != next {
            match self.profile {
                Profile::ArduPilot => {
                    self.acknowledge(from, list, MissionResult::INVALID_SEQUENCE);
                }
                Profile::Px4 if seq < next => self.ask(now),
                Profile::Px4 | Profile::Generic => {}
            }
            return;
        }
        let checked = match self.profile {
            Profile::ArduPilot => rules::ardupilot(list, &item, seq, count),
            Profile::Px4 => rules::px4(list, &item),
            Profile::Generic => Ok(()),
        };
        if let Err(result) = checked {
            self.transfer = Transfer::Idle;
            return self.acknowledge(from, list, result);
        }
        self.store(now, list, seq, item);
        if seq + 1 == count {
            self.complete();
        } else {
            self.ask(now);
        }
    }

    /// Takes the item that was asked for.
    fn store(&mut self, now: Time, list: List, seq: u16, item: Item) {
        let item = match self.profile.keeps() {
            Some(autopilot) => kept(autopilot, list, &item),
            None => item,
        };
        let Transfer::Receiving {
            staged,
            next,
            heard,
            ..
        } = &mut self.transfer
        else {
            return;
        };
        (*next, *heard) = (seq + 1, now);
        match (self.profile, list, self.lists.get_mut(&list)) {
            (Profile::ArduPilot, List::Mission, Some(rows)) => {
                match rows.get_mut(usize::from(seq)) {
                    Some(row) => *row = item,
                    None => rows.push(item),
                }
            }
            _ => staged.push(item),
        }
    }

    /// The last item is here.
    fn complete(&mut self) {
        let Transfer::Receiving {
            partner,
            list,
            count,
            staged,
            ..
        } = std::mem::replace(&mut self.transfer, Transfer::Idle)
        else {
            return;
        };
        if !(self.profile == Profile::ArduPilot && list == List::Mission) {
            if self.profile == Profile::ArduPilot
                && list == List::Fence
                && !rules::fence_is_consistent(&staged)
            {
                return self.acknowledge(partner, list, MissionResult::ERROR);
            }
            self.lists.insert(list, staged);
        }
        self.last = count.checked_sub(1).map(|seq| (partner, list, seq));
        self.acknowledge(partner, list, MissionResult::ACCEPTED);
    }

    /// An item while none is expected: ArduPilot complains, PX4 confirms its last one again.
    fn uninvited(&mut self, from: Address, list: List, seq: u16) {
        match self.profile {
            Profile::ArduPilot => self.acknowledge(from, list, MissionResult::ERROR),
            Profile::Px4 if self.last == Some((from, list, seq)) => {
                self.acknowledge(from, list, MissionResult::ACCEPTED);
            }
            Profile::Px4 | Profile::Generic => {}
        }
    }

    fn request_list(&mut self, now: Time, from: Address, list: List) {
        if matches!(self.transfer, Transfer::Receiving { .. }) {
            match self.profile {
                Profile::ArduPilot => self.acknowledge(from, list, MissionResult::DENIED),
                Profile::Px4 => self.warn("Mission download request ignored, already active"),
                Profile::Generic => {}
            }
            return;
        }
        let count = u16::try_from(self.rows(list).len()).unwrap_or(u16::MAX);
        if self.profile != Profile::ArduPilot && count > 0 {
            self.transfer = Transfer::Giving {
                partner: from,
                list,
                next: 0,
                heard: now,
            };
        }
        let opaque_id = self.opaque_id(list);
        self.say(from, list.mission_type(), Body::Count { count, opaque_id });
    }

    fn request(&mut self, now: Time, from: Address, list: List, seq: u16, integer: bool) {
        if self.profile == Profile::Generic && !integer {
            return self.acknowledge(from, list, MissionResult::UNSUPPORTED);
        }
        if self.profile != Profile::ArduPilot {
            match &mut self.transfer {
                Transfer::Giving {
                    partner,
                    list: given,
                    next,
                    heard,
                } if *partner == from && *given == list => {
                    let is_in_step = seq == *next || seq + 1 == *next;
                    if self.profile == Profile::Px4 && !is_in_step {
                        self.transfer = Transfer::Idle;
                        return self.acknowledge(from, list, MissionResult::ERROR);
                    }
                    if seq > *next {
                        return;
                    }
                    (*next, *heard) = ((*next).max(seq + 1), now);
                }
                _ => return,
            }
        }
        let Some(item) = self.row(list, seq) else {
            return self.acknowledge(from, list, MissionResult::ERROR);
        };
        let current = u8::from(list == List::Mission && seq == 0);
        let body = if integer {
            Body::ItemInt { seq, current, item }
        } else {
            Body::Item { seq, current, item }
        };
        self.say(from, list.mission_type(), body);
    }

    /// One stored row as it is given out: ArduPilot's first is always its own home.
    fn row(&self, list: List, seq: u16) -> Option<Item> {
        let row = *self.rows(list).get(usize::from(seq))?;
        if (self.profile, list, seq) != (Profile::ArduPilot, List::Mission, 0) {
            return Some(row);
        }
        let home = self.home.unwrap_or(Home {
            x: 0,
            y: 0,
            amsl_m: 0.0,
        });
        Some(Item {
            command: command::NAV_WAYPOINT,
            frame: frame::GLOBAL,
            autocontinue: true,
            params: [0.0; 4],
            x: home.x,
            y: home.y,
            z: home.amsl_m,
        })
    }

    fn acknowledged(&mut self, from: Address, about: List, result: MissionResult) {
        match self.transfer {
            Transfer::Giving { partner, list, .. } if partner == from && list == about => {
                self.transfer = Transfer::Idle;
            }
            Transfer::Receiving { partner, .. }
                if self.profile == Profile::Px4
                    && partner == from
                    && result == MissionResult::OPERATION_CANCELLED =>
            {
                self.transfer = Transfer::Idle;
            }
            _ => {}
        }
    }

    fn clear(&mut self, from: Address, list: List) {
        match (self.profile, &self.transfer) {
            (Profile::ArduPilot, Transfer::Receiving { .. }) => {
                return self.acknowledge(from, list, MissionResult::ERROR);
            }
            (Profile::Px4, Transfer::Receiving { .. } | Transfer::Giving { .. }) => {
                return self.warn("Mission clear ignored, busy");
            }
            (Profile::Generic, Transfer::Receiving { .. }) => return,
            _ => {}
        }
        self.lists.insert(list, Vec::new());
        self.acknowledge(from, list, MissionResult::ACCEPTED);
    }

    fn clear_all(&mut self, from: Address) {
        let result = match (self.profile, &self.transfer) {
            (Profile::ArduPilot, _) => MissionResult::UNSUPPORTED,
            (Profile::Px4 | Profile::Generic, Transfer::Idle) => {
                self.lists.values_mut().for_each(Vec::clear);
                MissionResult::ACCEPTED
            }
            _ => return,
        };
        let opaque_id = 0;
        self.say(from, MISSION_TYPE_ALL, Body::Ack { result, opaque_id });
    }
}
