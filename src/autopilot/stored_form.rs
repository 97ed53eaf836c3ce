//! Stored form of parameters: the value that reads back for a value that was sent.
//!
//! Measured on ArduCopter and ArduPlane 4.6.3 and PX4 1.18 with their simulators, and read from
//! `AP_Mission::mavlink_int_to_mission_cmd` and PX4's `parse_mavlink_mission_item`. A command
//! without a row is expected back unchanged: then a lossy autopilot is reported as different,
//! never the other way round.

use super::command;

/// How an autopilot stores one parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stored {
    /// As sent.
    Same,
    /// Not at all: it reads back as 0.
    Zero,
    /// Truncated to a whole number.
    Whole,
    /// Truncated and wrapped into 16 bits: -1 becomes 65535, 70000 becomes 4464.
    U16,
    /// The same, and at most 255.
    U8,
    /// A radius in steps of 1 m up to 255 m, of 10 m above.
    Radius,
    /// Its sign: -1 or 1.
    Sign,
    /// Whether it is positive: 0 or 1.
    Flag,
    /// An angle wrapped to 0 up to 360 degrees; NaN stays.
    Heading,
}

impl Stored {
    /// The value that reads back.
    #[must_use]
    pub fn apply(self, value: f32) -> f32 {
        match self {
            Self::Same => value,
            Self::Zero => 0.0,
            Self::Whole => value.trunc(),
            Self::U16 if value.is_finite() => value.trunc().rem_euclid(65536.0),
            Self::U16 => 0.0,
            Self::U8 => Self::U16.apply(value).min(255.0),
            Self::Radius if value.abs() > 255.0 => (value / 10.0).trunc() * 10.0,
            Self::Radius => value.trunc(),
            Self::Sign if value < 0.0 => -1.0,
            Self::Sign => 1.0,
            Self::Flag => f32::from(u8::from(value > 0.0)),
            Self::Heading => value.rem_euclid(360.0),
        }
    }
}

/// Stored form of `param1` to `param4` of one command.
pub type StoredRow = (u16, [Stored; 4]);

use Stored::{Flag, Heading, Radius, Same, Sign, U8, U16, Whole, Zero};

/// ArduCopter, and ArduPlane but for [`ARDUPLANE`].
pub(super) const ARDUPILOT: &[StoredRow] = &[
    (command::NAV_WAYPOINT, [U16, Zero, Zero, Zero]),
    (command::NAV_TAKEOFF, [U16, Zero, Zero, Zero]),
    (command::NAV_LOITER_UNLIM, [Zero, Zero, Whole, Zero]),
    (command::NAV_LOITER_TURNS, [Whole, Zero, Radius, Flag]),
    (command::NAV_LOITER_TIME, [U16, Zero, Sign, Flag]),
    (command::NAV_LAND, [U16, Zero, Zero, Sign]),
    (command::NAV_RETURN_TO_LAUNCH, [Zero; 4]),
    (command::NAV_DELAY, [Same, Whole, Whole, Whole]),
    (command::DO_JUMP, [Whole, Whole, Zero, Zero]),
    (command::DO_CHANGE_SPEED, [Whole, Same, Same, Zero]),
];

/// ArduPlane, and so a QuadPlane: acceptance radius and pass-by distance, no hold.
pub(super) const ARDUPLANE: &[StoredRow] = &[(command::NAV_WAYPOINT, [Zero, U8, U8, Zero])];

/// PX4.
pub(super) const PX4: &[StoredRow] = &[
    (command::NAV_WAYPOINT, [Same, Same, Zero, Heading]),
    (command::NAV_TAKEOFF, [Same, Zero, Zero, Heading]),
    (command::NAV_LAND, [Zero, Same, Zero, Heading]),
    (command::NAV_LOITER_UNLIM, [Zero, Zero, Same, Heading]),
];
