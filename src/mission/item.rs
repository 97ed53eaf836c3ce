//! The mission of one vehicle, in the integers and floats that go over the wire.

use std::fmt;

use crate::autopilot::{
    Airframe, Autopilot, Facts, ParameterRow, Version, facts, frame, in_unit_of, other_name,
    parameter,
};
use crate::geodesy::{Amsl, EastNorth, LatLon, LocalFrame, PlanPoint};

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

/// In degrees and metres, for messages.
impl fmt::Display for Home {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LatLon { lat_deg, lon_deg } = LatLon::of_e7(self.x, self.y);
        let amsl_m = self.amsl_m;
        write!(
            f,
            "latitude {lat_deg}, longitude {lon_deg} degrees, {amsl_m} m above sea level"
        )
    }
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
    /// The version of its firmware; absent: every supported one.
    pub autopilot_version: Option<Version>,
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

impl VehicleMission {
    /// The same mission for one version of the firmware; absent: for every supported one.
    #[must_use]
    pub fn for_version(self, autopilot_version: Option<Version>) -> Self {
        Self {
            autopilot_version,
            ..self
        }
    }

    /// Where its home is, in the plane of a frame.
    pub(crate) fn home_point(&self, frame: &LocalFrame) -> PlanPoint {
        let Home { x, y, amsl_m } = self.home;
        PlanPoint {
            at: frame.to_plan(LatLon::of_e7(x, y)),
            amsl: Amsl(f64::from(amsl_m)),
        }
    }

    /// Where its rally points are, in the plane of a frame.
    pub(crate) fn rally_points(&self, frame: &LocalFrame) -> impl Iterator<Item = EastNorth> {
        let all = self.rally.iter().filter_map(Item::place);
        all.map(|place| frame.to_plan(place))
    }

    /// The value of a parameter in the unit of that name, if the mission has it: under the name, or
    /// under the one that another version of the firmware has for it.
    #[must_use]
    pub fn param(&self, name: &str) -> Option<f64> {
        value_of(&self.params, name)
    }

    /// The same in SI units (angles in degrees), if it is finite.
    #[must_use]
    pub fn param_si(&self, name: &str) -> Option<f64> {
        value_si_of(&self.params, name)
    }

    /// The same, or the default of the parameter; none where its name is not known.
    #[must_use]
    pub fn param_or_default_si(&self, name: &str) -> Option<f64> {
        let default = || parameter(name).map(ParameterRow::default_si);
        self.param_si(name).or_else(default)
    }

    /// What its autopilot does on its airframe.
    #[must_use]
    pub fn facts(&self) -> &'static Facts {
        facts(self.autopilot, self.airframe)
    }
}

/// The value of a parameter among others, as of [`VehicleMission::param`].
fn value_of(params: &[Parameter], name: &str) -> Option<f64> {
    let held = |name: &str| {
        let found = params.iter().find(|param| param.name == name);
        found.map(|param| f64::from(param.value))
    };
    held(name).or_else(|| {
        let other = other_name(name)?;
        Some(in_unit_of(held(other)?, other, name))
    })
}

/// The same in SI units, as of [`VehicleMission::param_si`].
pub(crate) fn value_si_of(params: &[Parameter], name: &str) -> Option<f64> {
    let value = value_of(params, name)? / parameter(name)?.unit.per_si();
    value.is_finite().then_some(value)
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
