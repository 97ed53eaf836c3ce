//! Messages that command a vehicle and report its flight. Transfers use none of them.

use std::fmt;

use super::Address;
use super::health::Health;
use crate::geodesy::{Amsl, LatLon};

/// A command, its answer, or a report of a vehicle on its flight.
#[derive(Clone, Debug, PartialEq)]
pub enum FlightMessage {
    /// `COMMAND_LONG` (76), or `COMMAND_INT` (75) with its place in degrees.
    Command {
        /// The receiver.
        target: Address,
        /// The command.
        order: Command,
    },
    /// `COMMAND_ACK` (77).
    CommandAck {
        /// The sender of the command; 0 when the vehicle does not name it.
        target: Address,
        /// `MAV_CMD`.
        command: u16,
        /// The result.
        result: CommandResult,
    },
    /// `SET_MODE` (11), which `MAV_CMD_DO_SET_MODE` has replaced.
    SetMode {
        /// System id it is for.
        system: u8,
        /// `MAV_MODE_FLAG`s.
        base_mode: u8,
        /// Mode of the autopilot's own.
        custom_mode: u32,
    },
    /// `MISSION_SET_CURRENT` (41).
    SetCurrent {
        /// The receiver.
        target: Address,
        /// The item to go on with.
        seq: u16,
    },
    /// `MISSION_ITEM_REACHED` (46).
    ItemReached {
        /// Which.
        seq: u16,
    },
    /// `TIMESYNC` (111): a question, or the answer to it.
    TimeSync {
        /// The receiver.
        target: Address,
        /// The time of who answers, nanoseconds; 0 asks for it.
        answer_ns: i64,
        /// That of who asked.
        asked_ns: i64,
    },
    /// `CAMERA_TRIGGER` (112): PX4 has taken a picture.
    CameraTrigger {
        /// Its number.
        seq: u32,
    },
    /// `CAMERA_FEEDBACK` (180): ArduPilot has taken a picture.
    CameraFeedback {
        /// Its number.
        index: u16,
        /// Latitude, 1e-7 degrees.
        x: i32,
        /// Longitude, 1e-7 degrees.
        y: i32,
        /// Metres above mean sea level.
        amsl_m: f32,
    },
    /// `GLOBAL_POSITION_INT` (33).
    Position(Position),
    /// What a vehicle says of its own health.
    Health(Health),
    /// `EXTENDED_SYS_STATE` (245).
    Landed(LandedState),
    /// `PARAM_REQUEST_READ` (20), by name.
    ParamRead {
        /// The receiver.
        target: Address,
        /// At most 16 characters.
        name: String,
    },
    /// `PARAM_SET` (23).
    ParamSet {
        /// The receiver.
        target: Address,
        /// At most 16 characters.
        name: String,
        /// As it is on the wire: see [`ParamValue`].
        value: ParamValue,
    },
    /// `PARAM_VALUE` (22).
    Param {
        /// At most 16 characters.
        name: String,
        /// As it is on the wire.
        value: ParamValue,
    },
}

/// A command and its seven parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// `MAV_CMD`.
    pub command: u16,
    /// Number of earlier transmissions.
    pub confirmation: u8,
    /// `param1` to `param7`.
    pub params: [f32; 7],
}

impl Command {
    /// `MAV_CMD_NAV_LOITER_UNLIM`.
    pub const NAV_LOITER_UNLIM: u16 = 17;
    /// `MAV_CMD_NAV_RETURN_TO_LAUNCH`.
    pub const NAV_RETURN_TO_LAUNCH: u16 = 20;
    /// `MAV_CMD_NAV_LAND`.
    pub const NAV_LAND: u16 = 21;
    /// `MAV_CMD_DO_SET_MODE`.
    pub const DO_SET_MODE: u16 = 176;
    /// `MAV_CMD_DO_SET_MISSION_CURRENT`.
    pub const DO_SET_MISSION_CURRENT: u16 = 224;
    /// `MAV_CMD_MISSION_START`.
    pub const MISSION_START: u16 = 300;
    /// `MAV_CMD_COMPONENT_ARM_DISARM`.
    pub const COMPONENT_ARM_DISARM: u16 = 400;
    /// `MAV_CMD_GET_HOME_POSITION`.
    pub const GET_HOME_POSITION: u16 = 410;
    /// `MAV_CMD_SET_MESSAGE_INTERVAL`.
    pub const SET_MESSAGE_INTERVAL: u16 = 511;
    /// `MAV_CMD_REQUEST_MESSAGE`.
    pub const REQUEST_MESSAGE: u16 = 512;

    /// Asks for `AUTOPILOT_VERSION`.
    #[must_use]
    pub fn request_version() -> Self {
        Self::new(Self::REQUEST_MESSAGE, [148.0])
    }

    /// Asks for `GLOBAL_POSITION_INT`.
    #[must_use]
    pub fn request_position() -> Self {
        Self::new(Self::REQUEST_MESSAGE, [33.0])
    }

    /// A command with its first parameters; the others are 0.
    #[must_use]
    pub fn new<const N: usize>(command: u16, first: [f32; N]) -> Self {
        let mut params = [0.0; 7];
        params
            .iter_mut()
            .zip(first)
            .for_each(|(to, from)| *to = from);
        Self {
            command,
            confirmation: 0,
            params,
        }
    }
}

/// `MAV_RESULT`, known or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommandResult(pub u8);

impl CommandResult {
    /// Done, or begun.
    pub const ACCEPTED: Self = Self(0);
    /// Not now.
    pub const TEMPORARILY_REJECTED: Self = Self(1);
    /// Not with these parameters.
    pub const DENIED: Self = Self(2);
    /// The command is not known.
    pub const UNSUPPORTED: Self = Self(3);
    /// It was tried.
    pub const FAILED: Self = Self(4);
    /// Not ended yet; another answer follows.
    pub const IN_PROGRESS: Self = Self(5);
}

impl fmt::Display for CommandResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const NAMES: [&str; 6] = [
            "ACCEPTED",
            "TEMPORARILY_REJECTED",
            "DENIED",
            "UNSUPPORTED",
            "FAILED",
            "IN_PROGRESS",
        ];
        match NAMES.get(usize::from(self.0)) {
            Some(name) => f.write_str(name),
            None => write!(f, "result {}", self.0),
        }
    }
}

/// Position of a vehicle by its own estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Position {
    /// Since the vehicle was started, milliseconds.
    pub boot_ms: u32,
    /// Latitude, 1e-7 degrees.
    pub x: i32,
    /// Longitude, 1e-7 degrees.
    pub y: i32,
    /// Altitude above mean sea level, millimetres.
    pub amsl_mm: i32,
    /// Altitude above home, millimetres.
    pub above_home_mm: i32,
    /// Velocity north, east and down, cm/s.
    pub velocity_cmps: [i16; 3],
}

impl Position {
    /// Whether it is a position on earth. Vehicles send 0, 0 before they have one, and a
    /// faulty one may send coordinates beyond the poles.
    #[must_use]
    pub fn is_known(&self) -> bool {
        let place = self.place();
        (self.x, self.y) != (0, 0) && LatLon::new(place.lat_deg, place.lon_deg).is_ok()
    }

    /// Where.
    #[must_use]
    pub fn place(&self) -> LatLon {
        LatLon::of_e7(self.x, self.y)
    }

    /// How high.
    #[must_use]
    pub fn amsl(&self) -> Amsl {
        Amsl(f64::from(self.amsl_mm) / 1000.0)
    }

    /// Height above home, metres.
    #[must_use]
    pub fn above_home_m(&self) -> f64 {
        f64::from(self.above_home_mm) / 1000.0
    }

    /// Speed over the ground, m/s.
    #[must_use]
    pub fn ground_speed_mps(&self) -> f64 {
        let [north, east, _] = self.velocity_cmps.map(f64::from);
        north.hypot(east) / 100.0
    }
}

/// `MAV_LANDED_STATE`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LandedState(pub u8);

impl LandedState {
    /// On the ground.
    pub const ON_GROUND: Self = Self(1);
    /// In the air.
    pub const IN_AIR: Self = Self(2);
    /// Taking off.
    pub const TAKEOFF: Self = Self(3);
    /// Landing.
    pub const LANDING: Self = Self(4);
}

/// A parameter as it is on the wire: four bytes, and `MAV_PARAM_TYPE`.
///
/// ArduPilot sends every value as a float; PX4 puts the bytes of an integer into the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParamValue {
    /// The field `param_value`.
    pub bytes: [u8; 4],
    /// `MAV_PARAM_TYPE`.
    pub kind: u8,
}

/// `MAV_PARAM_TYPE_REAL32`.
const REAL_32: u8 = 9;

impl ParamValue {
    /// A float.
    #[must_use]
    pub fn float(value: f32) -> Self {
        Self {
            bytes: value.to_le_bytes(),
            kind: REAL_32,
        }
    }

    /// The value, for an autopilot that puts the bytes of an integer into the field (PX4)
    /// or not (ArduPilot).
    #[must_use]
    pub fn value(self, bytewise: bool) -> f32 {
        if bytewise && self.kind < REAL_32 {
            #[expect(
                clippy::cast_precision_loss,
                reason = "parameters are small whole numbers"
            )]
            let value = i32::from_le_bytes(self.bytes) as f32;
            value
        } else {
            f32::from_le_bytes(self.bytes)
        }
    }

    /// Another value of the same kind.
    #[must_use]
    pub fn with(self, value: f32, bytewise: bool) -> Self {
        let bytes = if bytewise && self.kind < REAL_32 {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "`as` saturates; the read-back shows it"
            )]
            let whole = value.round() as i32;
            whole.to_le_bytes()
        } else {
            value.to_le_bytes()
        };
        Self { bytes, ..self }
    }
}
