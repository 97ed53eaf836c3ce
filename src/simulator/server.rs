//! A simulated vehicle as its radio hears it, sans-IO: missions, commands, telemetry.

mod command;
mod download;
mod receive;
mod telemetry;

use std::collections::{BTreeMap, VecDeque};

use super::environment::Surroundings;
use super::faults::{Fault, Faults};
use super::mode::Mode;
use super::pilot::Pilot;
use super::profile::Profile;
use crate::link::{
    Address, Body, MISSION_TYPE_ALL, Message, MissionMessage, MissionResult, MissionType, Position,
    Time,
};
use crate::mission::{Home, Item};
use crate::spec::Airframe;

/// Between two heartbeats, milliseconds.
const HEARTBEAT_MS: u64 = 1000;
/// After a start: nothing is heard or said, milliseconds.
const DARK_MS: u64 = 800;
/// After a start: heartbeats say BOOT, milliseconds.
const BOOT_MS: u64 = 3000;
/// Between two reports of its health, milliseconds.
const HEALTH_MS: u64 = 500;
/// Between two positions in flight, milliseconds.
const POSITION_MS: u64 = 250;
/// `MAV_STATE_BOOT`.
const STATE_BOOT: u8 = 1;

/// A simulated vehicle.
#[derive(Clone, Debug)]
pub struct Vehicle {
    profile: Profile,
    airframe: Airframe,
    fence_points: Option<usize>,
    us: Address,
    home: Option<Home>,
    lists: BTreeMap<MissionType, Vec<Item>>,
    transfer: Transfer,
    /// Whom the last item of a completed upload came from.
    last: Option<(Address, MissionType, u16)>,
    outbox: VecDeque<Message>,
    heartbeat_due: Time,
    started: Time,
    /// Who flies it; a generic one, and one without a home, does not fly.
    pilot: Option<Pilot>,
    position_due: Time,
    /// Between two positions in flight; the greatest number for none.
    position_ms: u64,
    /// An item that is still being said to be reached, and how often.
    reached: Option<(u16, u8)>,
    armed: bool,
    faults: Faults,
    /// The position that it sends for ever.
    frozen: Option<Position>,
    /// When its health was last reported, and is next.
    health_at: Time,
    health_due: Time,
    /// Whether it reports its health: ArduPilot does not unasked.
    reports_health: bool,
}

#[derive(Clone, Debug)]
enum Transfer {
    Idle,
    /// Items come in.
    Receiving {
        partner: Address,
        list: MissionType,
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
        list: MissionType,
        next: u16,
        heard: Time,
    },
}

impl Vehicle {
    /// A copter with component id 1 that has been running for a while.
    #[must_use]
    pub fn new(profile: Profile, sysid: u8, home: Option<Home>, now: Time) -> Self {
        Self::within(profile, sysid, home, Surroundings::default(), now)
    }

    /// The same in other surroundings.
    #[must_use]
    pub fn within(
        profile: Profile,
        sysid: u8,
        home: Option<Home>,
        surroundings: Surroundings,
        now: Time,
    ) -> Self {
        let pilot = match profile {
            Profile::ArduPilot | Profile::Px4 => {
                home.map(|home| Pilot::new(profile, sysid, home, surroundings, now))
            }
            Profile::Generic => None,
        };
        Self {
            profile,
            airframe: Airframe::Copter,
            fence_points: None,
            us: Address {
                system: sysid,
                component: 1,
            },
            home,
            lists: MissionType::ALL.map(|list| (list, Vec::new())).into(),
            transfer: Transfer::Idle,
            last: None,
            outbox: VecDeque::new(),
            heartbeat_due: now,
            started: Time(0),
            pilot,
            position_due: now,
            position_ms: POSITION_MS,
            reached: None,
            armed: false,
            faults: Faults::new(),
            frozen: None,
            health_at: now,
            health_due: now,
            reports_health: profile != Profile::ArduPilot,
        }
    }

    /// Something goes wrong with it from now on.
    pub fn fail(&mut self, fault: Fault) {
        self.faults.take(fault);
        if let (Fault::Wind { wind, airspeed_mps }, Some(pilot)) = (fault, &mut self.pilot) {
            pilot.blow(wind, airspeed_mps);
        }
    }

    /// The same with space for this number of fence items; none: for those of its autopilot.
    #[must_use]
    pub fn keeps(self, fence_points: Option<usize>) -> Self {
        Self {
            fence_points,
            ..self
        }
    }

    /// The same on another airframe.
    #[must_use]
    pub fn on(mut self, airframe: Airframe) -> Self {
        self.airframe = airframe;
        self.pilot = self.pilot.map(|pilot| pilot.on(airframe));
        self
    }

    /// Its system and component id.
    #[must_use]
    pub fn address(&self) -> Address {
        self.us
    }

    /// What it holds, without home.
    #[must_use]
    pub fn items(&self, list: MissionType) -> &[Item] {
        let rows = self.rows(list);
        match (self.profile, list) {
            (Profile::ArduPilot, MissionType::Mission) => rows.get(1..).unwrap_or_default(),
            _ => rows,
        }
    }

    /// Whether its motors run.
    #[must_use]
    pub fn is_armed(&self) -> bool {
        self.armed || self.pilot.as_ref().is_some_and(|pilot| pilot.armed)
    }

    /// Starts the motors, or stops them, without the consent of the autopilot.
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

    /// Handles a message of any sender.
    pub fn handle(&mut self, now: Time, from: Address, message: &Message) {
        let mission = match message {
            Message::Mission(mission) => mission,
            Message::Flight(message) if !self.is_dark(now) => {
                return self.flight(now, from, message);
            }
            _ => return,
        };
        if self.is_dark(now) || ![self.us.system, 0].contains(&mission.target.system) {
            return;
        }
        let Some(list) = MissionType::of(mission.mission_type) else {
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
        self.fly(now);
        if now >= self.heartbeat_due && !self.is_dark(now) {
            self.heartbeat_due = now + HEARTBEAT_MS;
            self.heartbeat_is_due(now);
        }
        if now >= self.health_due && !self.is_dark(now) {
            self.health_is_due(now);
        }
        if now >= self.position_due && !self.is_dark(now) {
            self.position_is_due(now);
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
        let flight = self.pilot.as_ref().and_then(Pilot::due);
        transfer
            .min(self.heartbeat_due)
            .min(self.position_due)
            .min(self.health_due)
            .min(flight.unwrap_or(self.heartbeat_due))
    }

    /// Flies up to now by the mission on board.
    fn fly(&mut self, now: Time) {
        let Some(mut pilot) = self.pilot.take() else {
            return;
        };
        pilot.advance(now, self.items(MissionType::Mission));
        self.pilot = Some(pilot);
        self.report();
    }

    /// Whether it is armed in the mode that flies the mission.
    fn is_flying_mission(&self) -> bool {
        let pilot = self.pilot.as_ref();
        pilot.is_some_and(|pilot| pilot.armed && pilot.mode() == Mode::Mission)
    }

    /// The mission on board is another one.
    fn mission_replaced(&mut self) {
        let items = self.items(MissionType::Mission).to_vec();
        if let Some(pilot) = &mut self.pilot {
            pilot.mission_replaced(&items);
        }
    }

    fn rows(&self, list: MissionType) -> &[Item] {
        self.lists.get(&list).map_or(&[], Vec::as_slice)
    }

    fn is_dark(&self, now: Time) -> bool {
        self.started - now > BOOT_MS - DARK_MS
    }

    fn is_booting(&self, now: Time) -> bool {
        now < self.started
    }

    fn say(&mut self, to: Address, mission_type: u8, body: Body) {
        self.outbox.push_back(Message::Mission(MissionMessage {
            target: to,
            mission_type,
            body,
        }));
    }

    fn acknowledge(&mut self, to: Address, list: MissionType, result: MissionResult) {
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
