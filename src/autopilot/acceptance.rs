//! Rules of acceptance that hold for every command; those of one command are in
//! [`super::COMMANDS`].

use super::commands::ReadParameters;

/// Greatest number of items that a vehicle stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    /// Mission items, home not counted.
    pub items: usize,
    /// Fence items: corners and circles.
    pub fence: usize,
    /// Rally points.
    pub rally: usize,
    /// `DO_JUMP` items.
    pub jumps: usize,
    /// Jumps that it makes from one item to the next; with one more its mission is over.
    pub jumps_in_a_row: usize,
    /// Commands without motion that it obeys from one item with motion to the next, if they are limited.
    pub commands_in_a_row: Option<usize>,
}

/// Items that one autopilot accepts on one airframe.
#[derive(Clone, Copy, Debug)]
pub struct AcceptanceRules {
    /// Items with a location may have these frames.
    pub location_frames: &'static [u8],
    /// Items without a location may have these; absent: any.
    pub command_frames: Option<&'static [u8]>,
    /// Commands to which latitude 0, longitude 0 means the place where the vehicle is.
    /// Mission Planner writes takeoffs in this way.
    pub zero_is_here: &'static [u16],
    /// Commands to which it means no place. Mission Planner writes the starts of landings in this way.
    pub zero_is_no_place: &'static [u16],
    /// Whether NaN means "the default" in every parameter.
    pub any_nan: bool,
    /// The parameters that it reads, where it refuses numbers in others.
    pub reads: Option<&'static ReadParameters>,
    /// Altitudes from this on do not fit, metres.
    pub max_altitude_m: f32,
    /// Longest hold at a waypoint, seconds.
    pub max_hold_s: f32,
    /// Whether `param2` of a landing starts a search for a beacon.
    pub precision_landing: bool,
    /// The commands that start a mission from the ground.
    pub takeoffs: &'static [u16],
    /// Whether a mission from the ground must begin with one of them.
    pub needs_takeoff: bool,
    /// The commands that may come before the takeoff, where no others may.
    pub before_takeoff: Option<&'static [u16]>,
    /// Whether there may be at most one `DO_LAND_START`, only before a landing, and no return after it.
    pub one_land_start: bool,
    /// The commands that land the airframe as planned.
    pub landings: &'static [u16],
    /// Whether `NAV_DELAY` ends at once.
    pub never_waits: bool,
    /// Whether `NAV_WAYPOINT` and circles store whole numbers, and no hold.
    pub whole_numbers: bool,
    /// Whether the altitude of a takeoff is a height above the ground where the vehicle
    /// stands, in every frame.
    pub takeoff_above_home: bool,
    /// Whether a landing without an approach on a glide is rejected.
    pub needs_approach: bool,
}
