//! The mission of one vehicle, in the integers and floats that go over the wire.

use crate::geodesy::LatLon;
use crate::spec::{Airframe, Autopilot};

/// Commands (`MAV_CMD`) that Sortie writes or understands.
pub mod command {
    /// Fly to a place.
    pub const NAV_WAYPOINT: u16 = 16;
    /// Loiter for ever.
    pub const NAV_LOITER_UNLIM: u16 = 17;
    /// Loiter for a number of turns.
    pub const NAV_LOITER_TURNS: u16 = 18;
    /// Loiter for a time.
    pub const NAV_LOITER_TIME: u16 = 19;
    /// Return to the launch place.
    pub const NAV_RETURN_TO_LAUNCH: u16 = 20;
    /// Land.
    pub const NAV_LAND: u16 = 21;
    /// Take off.
    pub const NAV_TAKEOFF: u16 = 22;
    /// Climb vertically, then fly on the wing.
    pub const NAV_VTOL_TAKEOFF: u16 = 84;
    /// Stop flying on the wing, and land vertically.
    pub const NAV_VTOL_LAND: u16 = 85;
    /// Wait, on the ground or in the air.
    pub const NAV_DELAY: u16 = 93;
    /// Jump to another item.
    pub const DO_JUMP: u16 = 177;
    /// Change the speed.
    pub const DO_CHANGE_SPEED: u16 = 178;
    /// Fence: where to return to.
    pub const FENCE_RETURN_POINT: u16 = 5000;
    /// Fence: a corner of a polygon to stay in.
    pub const FENCE_POLYGON_INCLUSION: u16 = 5001;
    /// Fence: a corner of a polygon to stay out of.
    pub const FENCE_POLYGON_EXCLUSION: u16 = 5002;
    /// Fence: a circle to stay in.
    pub const FENCE_CIRCLE_INCLUSION: u16 = 5003;
    /// Fence: a circle to stay out of.
    pub const FENCE_CIRCLE_EXCLUSION: u16 = 5004;
    /// A rally point.
    pub const RALLY_POINT: u16 = 5100;
}

/// Frames (`MAV_FRAME`) of mission items. 5, 6 and 11 are synonyms of 0, 3 and 10.
pub mod frame {
    /// Latitude, longitude, altitude above mean sea level.
    pub const GLOBAL: u8 = 0;
    /// No place at all: the item is a command.
    pub const MISSION: u8 = 2;
    /// Latitude, longitude, altitude above home.
    pub const GLOBAL_RELATIVE_ALT: u8 = 3;
    /// Latitude, longitude, altitude above terrain.
    pub const GLOBAL_TERRAIN_ALT: u8 = 10;

    /// The frame with synonyms (5, 6, 11) folded into 0, 3, 10.
    #[must_use]
    pub fn canonical(frame: u8) -> u8 {
        match frame {
            5 => GLOBAL,
            6 => GLOBAL_RELATIVE_ALT,
            11 => GLOBAL_TERRAIN_ALT,
            other => other,
        }
    }
}

/// One item, field by field as in `MISSION_ITEM_INT`. Its sequence number is its
/// place in the list; `current` belongs to the transfer, not to the item.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    /// `MAV_CMD`.
    pub command: u16,
    /// `MAV_FRAME`.
    pub frame: u8,
    /// Whether the vehicle goes on to the next item by itself.
    pub autocontinue: bool,
    /// `param1` to `param4`; NaN means "the vehicle's default".
    pub params: [f32; 4],
    /// Latitude in 1e-7 degrees, or `param5` of a command without a place.
    pub x: i32,
    /// Longitude in 1e-7 degrees, or `param6`.
    pub y: i32,
    /// Altitude in metres in the frame's reference, or `param7`.
    pub z: f32,
}

/// Equal bit by bit in the floats, so that NaN equals NaN: what a transfer must keep.
impl PartialEq for Item {
    fn eq(&self, other: &Self) -> bool {
        self.command == other.command
            && self.frame == other.frame
            && self.autocontinue == other.autocontinue
            && self.params.map(f32::to_bits) == other.params.map(f32::to_bits)
            && (self.x, self.y, self.z.to_bits()) == (other.x, other.y, other.z.to_bits())
    }
}

/// Where the vehicle stands when the mission begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Home {
    /// Latitude, 1e-7 degrees.
    pub x: i32,
    /// Longitude, 1e-7 degrees.
    pub y: i32,
    /// Altitude above mean sea level, metres.
    pub amsl_m: f32,
}

/// An autopilot parameter that the verdict assumes.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name in the autopilot.
    pub name: String,
    /// Value.
    pub value: f32,
    /// Why it matters, in a few words.
    pub why: String,
}

/// Everything one vehicle gets.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleMission {
    /// Who reads it.
    pub autopilot: Autopilot,
    /// What flies it.
    pub airframe: Airframe,
    /// Where it starts from. Not among `items`: the ArduPilot home row (sequence
    /// number 0) is added where a format or a transfer wants it.
    pub home: Home,
    /// Mission items in order; the first is the first real item.
    pub items: Vec<Item>,
    /// Fence items (`MAV_MISSION_TYPE_FENCE`).
    pub fence: Vec<Item>,
    /// Whether an empty fence means that there is none: false where the mission
    /// comes from a file that cannot hold one.
    pub is_fence_known: bool,
    /// Rally items (`MAV_MISSION_TYPE_RALLY`).
    pub rally: Vec<Item>,
    /// Parameters the verdict assumes.
    pub params: Vec<Parameter>,
    /// What the spec asks for and the items cannot say, in sentences.
    pub notes: Vec<String>,
}

impl Item {
    /// A command without a place, in `MAV_FRAME_MISSION`.
    #[must_use]
    pub fn without_place(command: u16, params: [f32; 4]) -> Self {
        Self {
            command,
            frame: frame::MISSION,
            autocontinue: true,
            params,
            x: 0,
            y: 0,
            z: 0.0,
        }
    }

    /// The place, if the frame is global.
    #[must_use]
    pub fn place(&self) -> Option<LatLon> {
        match frame::canonical(self.frame) {
            frame::GLOBAL | frame::GLOBAL_RELATIVE_ALT | frame::GLOBAL_TERRAIN_ALT => {
                LatLon::new(f64::from(self.x) / 1e7, f64::from(self.y) / 1e7).ok()
            }
            _ => None,
        }
    }
}
