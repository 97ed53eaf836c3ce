//! The MAVLink messages that transfers and flights use, with plain integers, so that
//! enum values of newer autopilots survive.

mod fields;
pub(super) mod flight;
pub(super) mod health;
pub(super) mod id;
mod layout;
pub(super) mod payload;
#[cfg(test)]
mod tests;

use std::fmt;

use crate::mission::Item;
use flight::FlightMessage;

/// System and component id of a sender or receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Address {
    /// System id; 0 as a target means every system.
    pub system: u8,
    /// Component id; 0 as a target means every component.
    pub component: u8,
}

impl Address {
    /// Whether a message to this target is meant for `us`.
    #[must_use]
    pub fn reaches(self, us: Self) -> bool {
        (self.system == us.system || self.system == 0)
            && (self.component == us.component || self.component == 0)
    }
}

/// Bytes of the text of a `STATUSTEXT`.
pub const TEXT_BYTES: usize = 50;

/// A piece of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextChunk {
    /// 0 emergency to 7 debug.
    pub severity: u8,
    /// Its part of the text; one that is shorter ends with 0, and is the last.
    pub bytes: [u8; TEXT_BYTES],
    /// Which text.
    pub id: u16,
    /// Its place in it, from 0 on.
    pub seq: u8,
}

impl TextChunk {
    /// Its part of the text alone.
    #[must_use]
    pub fn text(&self) -> &[u8] {
        self.bytes
            .split(|&byte| byte == 0)
            .next()
            .unwrap_or_default()
    }
}

impl Message {
    /// A whole text, from its bytes.
    #[must_use]
    pub fn of_text(severity: u8, bytes: &[u8]) -> Self {
        let text = fields::text_of(bytes);
        Self::StatusText { severity, text }
    }
}

/// One message, without its sender.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// `HEARTBEAT` (0).
    Heartbeat(Heartbeat),
    /// `STATUSTEXT` (253): `MAV_SEVERITY` and a whole text.
    StatusText {
        /// 0 emergency to 7 debug.
        severity: u8,
        /// The text.
        text: String,
    },
    /// `STATUSTEXT` with an id: a piece of a longer text.
    TextChunk(TextChunk),
    /// `MISSION_CURRENT` (42).
    MissionCurrent {
        /// Where the mission is.
        seq: u16,
        /// Items without home; 65535 if not known.
        total: u16,
        /// Opaque ids of mission, fence, rally; 0 if the autopilot has none.
        opaque_ids: [u32; 3],
    },
    /// `HOME_POSITION` (242), the place alone.
    HomePosition {
        /// Latitude, 1e-7 degrees.
        x: i32,
        /// Longitude, 1e-7 degrees.
        y: i32,
        /// Altitude above mean sea level, millimetres.
        amsl_mm: i32,
    },
    /// `AUTOPILOT_VERSION` (148): capabilities and flight software.
    AutopilotVersion {
        /// `MAV_PROTOCOL_CAPABILITY` flags. Ground stations send nothing to a vehicle without `MISSION_INT`.
        capabilities: u64,
        /// Major, minor, patch and `FIRMWARE_VERSION_TYPE`, from the highest byte down; 0 if unknown.
        flight_software: u32,
    },
    /// One of the messages of the mission protocol.
    Mission(MissionMessage),
    /// A command, or the state of a flight.
    Flight(FlightMessage),
}

/// `HEARTBEAT` without its MAVLink version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heartbeat {
    /// `MAV_TYPE`.
    pub kind: u8,
    /// `MAV_AUTOPILOT`.
    pub autopilot: u8,
    /// `MAV_MODE_FLAG`s.
    pub base_mode: u8,
    /// Mode of the autopilot's own.
    pub custom_mode: u32,
    /// `MAV_STATE`.
    pub system_status: u8,
}

/// `MAV_TYPE_GCS`.
pub const TYPE_GCS: u8 = 6;
/// `MAV_AUTOPILOT_GENERIC`: an autopilot that does not say which.
pub const AUTOPILOT_GENERIC: u8 = 0;
/// `MAV_AUTOPILOT_INVALID`: a component that is no autopilot.
pub const AUTOPILOT_INVALID: u8 = 8;
/// `MAV_STATE_STANDBY`.
pub const STATE_STANDBY: u8 = 3;
/// `MAV_STATE_ACTIVE`.
pub const STATE_ACTIVE: u8 = 4;
/// `MAV_MODE_FLAG_SAFETY_ARMED`.
pub const MODE_ARMED: u8 = 128;
/// `MAV_MISSION_TYPE_ALL`, only for clearing.
pub const MISSION_TYPE_ALL: u8 = 255;

impl Heartbeat {
    /// That of a ground station.
    pub const OURS: Self = Self {
        kind: TYPE_GCS,
        autopilot: AUTOPILOT_INVALID,
        base_mode: 0,
        custom_mode: 0,
        system_status: STATE_ACTIVE,
    };

    /// Whether the motors may run.
    #[must_use]
    pub fn is_armed(&self) -> bool {
        self.base_mode & MODE_ARMED != 0
    }
}

/// A message of the mission protocol.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MissionMessage {
    /// The receiver.
    pub target: Address,
    /// `MAV_MISSION_TYPE` as it came; see [`MissionType`].
    pub mission_type: u8,
    /// Its content.
    pub body: Body,
}

impl MissionMessage {
    /// The system of another station whose list, or order to clear one, it acknowledges: somebody has changed what is
    /// on board.
    #[must_use]
    pub fn accepted_from_other(&self, us: Address) -> Option<u8> {
        let accepted = MissionResult::ACCEPTED;
        let is_accepted = matches!(self.body, Body::Ack { result, .. } if result == accepted);
        let system = self.target.system;
        (is_accepted && system != 0 && !self.target.reaches(us)).then_some(system)
    }

    /// Whether a message that came `from` somebody is between the vehicle and a station that is not us.
    pub(crate) fn is_of_stranger(
        &self,
        station: Address,
        (from, vehicle): (Address, Address),
        us: Address,
    ) -> bool {
        let is_stranger = station != vehicle && station.system != 0 && !station.reaches(us);
        is_stranger && (from == vehicle || self.target.reaches(vehicle))
    }
}

/// Content of a message of the mission protocol.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Body {
    /// `MISSION_COUNT` (44).
    Count {
        /// Number of items.
        count: u16,
        /// Id of the whole list; 0 if there is none.
        opaque_id: u32,
    },
    /// `MISSION_REQUEST` (40): asks for an item, formerly in floats.
    Request {
        /// Which.
        seq: u16,
    },
    /// `MISSION_REQUEST_INT` (51).
    RequestInt {
        /// Which.
        seq: u16,
    },
    /// `MISSION_ITEM` (39): an item whose place went over the wire in float degrees.
    Item {
        /// Which.
        seq: u16,
        /// Whether it is the current one.
        current: u8,
        /// The item; its place carries the rounding of the floats.
        item: Item,
    },
    /// `MISSION_ITEM_INT` (73).
    ItemInt {
        /// Which.
        seq: u16,
        /// Whether it is the current one.
        current: u8,
        /// The item, exact.
        item: Item,
    },
    /// `MISSION_ACK` (47).
    Ack {
        /// `MAV_MISSION_RESULT`.
        result: MissionResult,
        /// Id of the whole list; 0 if there is none.
        opaque_id: u32,
    },
    /// `MISSION_REQUEST_LIST` (43).
    RequestList,
    /// `MISSION_CLEAR_ALL` (45).
    ClearAll,
}

/// The three lists a vehicle holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MissionType {
    /// `MAV_MISSION_TYPE_MISSION`.
    Mission,
    /// `MAV_MISSION_TYPE_FENCE`.
    Fence,
    /// `MAV_MISSION_TYPE_RALLY`.
    Rally,
}

impl MissionType {
    /// All three, in the order of their numbers.
    pub const ALL: [Self; 3] = [Self::Mission, Self::Fence, Self::Rally];

    /// `MAV_MISSION_TYPE`.
    #[must_use]
    pub fn mission_type(self) -> u8 {
        match self {
            Self::Mission => 0,
            Self::Fence => 1,
            Self::Rally => 2,
        }
    }

    /// The list of a `MAV_MISSION_TYPE`, if it is one.
    #[must_use]
    pub fn of(mission_type: u8) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|list| list.mission_type() == mission_type)
    }
}

impl fmt::Display for MissionType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mission => "mission",
            Self::Fence => "fence",
            Self::Rally => "rally",
        })
    }
}

/// `MAV_MISSION_RESULT`, known or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MissionResult(pub u8);

impl MissionResult {
    /// All is well.
    pub const ACCEPTED: Self = Self(0);
    /// An error without a code of its own.
    pub const ERROR: Self = Self(1);
    /// The frame is not supported.
    pub const UNSUPPORTED_FRAME: Self = Self(2);
    /// The command is not supported.
    pub const UNSUPPORTED: Self = Self(3);
    /// The list does not fit.
    pub const NO_SPACE: Self = Self(4);
    /// A parameter is invalid; the next four name `param1` to `param4`.
    pub const INVALID: Self = Self(5);
    /// Latitude is invalid.
    pub const INVALID_PARAM5_X: Self = Self(10);
    /// Longitude is invalid.
    pub const INVALID_PARAM6_Y: Self = Self(11);
    /// Altitude is invalid.
    pub const INVALID_PARAM7: Self = Self(12);
    /// An item came out of order.
    pub const INVALID_SEQUENCE: Self = Self(13);
    /// The vehicle does not accept this partner.
    pub const DENIED: Self = Self(14);
    /// The transfer is cancelled.
    pub const OPERATION_CANCELLED: Self = Self(15);

    /// The parameter (1 to 7) that the result complains about.
    #[must_use]
    pub fn parameter(self) -> Option<u8> {
        (6..=12).contains(&self.0).then(|| self.0 - 5)
    }
}

impl fmt::Display for MissionResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const NAMES: [&str; 16] = [
            "ACCEPTED",
            "ERROR",
            "UNSUPPORTED_FRAME",
            "UNSUPPORTED",
            "NO_SPACE",
            "INVALID",
            "INVALID_PARAM1",
            "INVALID_PARAM2",
            "INVALID_PARAM3",
            "INVALID_PARAM4",
            "INVALID_PARAM5_X",
            "INVALID_PARAM6_Y",
            "INVALID_PARAM7",
            "INVALID_SEQUENCE",
            "DENIED",
            "OPERATION_CANCELLED",
        ];
        match NAMES.get(usize::from(self.0)) {
            Some(name) => f.write_str(name),
            None => write!(f, "result {}", self.0),
        }
    }
}

/// Both ends of one transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Route {
    /// Our address.
    pub us: Address,
    /// The vehicle.
    pub vehicle: Address,
    /// Which of its lists.
    pub list: MissionType,
}

impl Route {
    /// A message to the vehicle about this list.
    #[must_use]
    pub fn message(&self, body: Body) -> Message {
        Message::Mission(MissionMessage {
            target: self.vehicle,
            mission_type: self.list.mission_type(),
            body,
        })
    }

    /// The content of a message from this vehicle, to us, about this list.
    #[must_use]
    pub fn accept(&self, from: Address, message: &Message) -> Option<Body> {
        match message {
            Message::Mission(mission)
                if from == self.vehicle
                    && mission.target.reaches(self.us)
                    && mission.mission_type == self.list.mission_type() =>
            {
                Some(mission.body)
            }
            _ => None,
        }
    }
}
