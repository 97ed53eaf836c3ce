//! What autopilots do, as data: by autopilot, airframe and version.
//!
//! | question | answer |
//! |---|---|
//! | What does ArduPlane do? | `ARDUPLANE` in `ardupilot/plane.rs`: capacity, acceptance, modes, parameters, behaviour |
//! | Which items does an autopilot accept? | the row of the command in [`COMMANDS`] (`commands.rs`), with the airframe's [`AcceptanceRules`] (`ardupilot/`, `px4.rs`) and, of PX4, [`ReadParameters`]; applied by `mission/accept/` |
//! | What reads back after an upload? | [`Stored`] (`stored_form.rs`), [`Conventions::packs_items`] |
//! | How many items fit? | [`Facts::capacity`] |
//! | Which figures does the verdict assume for a PX4 copter? | `px4.rs`: `COPTER.defaults` (speeds, acceleration) and `COPTER_BEHAVIOUR` (lateness, lean; the rest is ArduCopter's), each with version, samples and source ([`Measured`]); corners in `corner.rs` |
//! | How does a copter fly a corner, and where does it stop? | [`Cornering`], [`Stops`] (`corner.rs`) |
//! | Which parameters and defaults? | `parameters.rs` ([`ParameterRow`]) |
//! | Which mode numbers? | [`Modes`] |
//! | Which versions? | [`Conventions::versions`] |
//! | What is supported, on which evidence? | [`Support`], [`support_table`] |
//!
//! [`facts`] returns the table of one autopilot on one airframe. The verdict and the simulated
//! vehicle fly with separate code, and read the same table.

mod acceptance;
mod ardupilot;
mod behaviour;
mod commands;
mod corner;
mod mavlink;
mod modes;
mod parameters;
mod px4;
mod stored_form;
mod support;
mod version;

use serde::{Deserialize, Serialize};

pub use acceptance::{AcceptanceRules, Capacity};
pub use behaviour::{Behaviour, Figure, MAX_LEAN_DEG, Measured};
pub use commands::{
    COMMANDS, CommandRow, CommandRule, Location, Motion, ParamRule, ReadParameters, Rejected,
    command_name, command_named, command_row,
};
pub use corner::{CornerLaw, Cornering, Skips, Stops, Turn};
pub use mavlink::{command, frame};
pub use modes::{Mode, Modes, mode_name};
pub use parameters::{
    COPTER_LEAN, Judged, LandingParameters, PX4_LEAN, ParamFence, ParameterRow, SLOPE_MIN, Unit,
    in_unit_of, name_in, other_name, parameter,
};
pub use stored_form::{Stored, StoredRow};
pub use support::{Evidence, Support, behaviour_table, support_table};
pub use version::{InvalidVersion, Version, VersionRange};

/// Which autopilot reads the mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Autopilot {
    /// ArduPilot.
    ArduPilot,
    /// PX4.
    Px4,
}

impl Autopilot {
    /// The radius of the sphere on which it counts metres from degrees (ArduPilot: `LOCATION_SCALING_FACTOR`; PX4:
    /// `CONSTANTS_RADIUS_OF_EARTH`).
    #[must_use]
    pub const fn earth_radius_m(self) -> f64 {
        match self {
            Self::ArduPilot => 6_378_100.0,
            Self::Px4 => 6_371_000.0,
        }
    }
}

/// What flies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Airframe {
    /// Multicopter.
    #[default]
    Copter,
    /// Fixed wing: takes off along a course and lands on a glide.
    Plane,
    /// Takes off and lands vertically, flies on its wing between.
    Vtol,
}

/// Below this height a landing on rotors is slow, metres. Every plan sets it: `LAND_ALT_LOW`,
/// `Q_LAND_FINAL_ALT`, `MPC_LAND_ALT2`.
pub const SLOW_LANDING_M: f64 = 10.0;

/// What one autopilot does on every airframe.
#[derive(Clone, Copy, Debug)]
pub struct Conventions {
    /// Its name as its developers write it.
    pub name: &'static str,
    /// Its key in specs and flags.
    pub key: &'static str,
    /// `MAV_AUTOPILOT`.
    pub mav_autopilot: u8,
    /// The versions whose rules are in the tables, oldest first.
    pub versions: &'static [Version],
    /// The version that the simulated vehicle plays.
    pub measured: Version,
    /// Whether sequence number 0 of a mission is home: `DO_JUMP` and `MISSION_CURRENT` count it.
    pub counts_home: bool,
    /// Whether items are packed: `autocontinue` is lost, altitudes are truncated to centimetres,
    /// rally altitudes to metres, items without a location read back in frame 0 with zeros.
    pub packs_items: bool,
    /// A parameter may read back off by this.
    pub param_tolerance: f32,
    /// Greatest `SYSID_THISMAV`, `MAV_SYS_ID`.
    pub max_system_id: u8,
    /// `param4` of an item that leaves the heading to the autopilot.
    pub no_heading: f32,
    /// Whether `DO_CHANGE_SPEED` sets the speed of a mission. With the item a PX4 copter was seen
    /// to stick or to drift off: there a parameter sets it.
    pub speed_in_mission: bool,
    /// Whether the vehicle waits for a command at an item without `autocontinue`.
    pub waits_without_autocontinue: bool,
    /// Whether a takeoff goes to the location of its item; if not, it climbs where it stands.
    pub reads_takeoff_location: bool,
    /// Whether altitude 0 keeps the altitude before it, and 0, 0 means the present place
    /// (`ModeAuto::loc_from_cmd`).
    pub zero_is_unset: bool,
    /// Whether parameters of whole numbers travel as the bytes of an `int32` (`PARAM_VALUE`).
    pub bytewise_parameters: bool,
    /// Whether items are given in any order: several may be requested at once.
    pub gives_any_order: bool,
    /// Time between two requests for the same item, milliseconds.
    pub request_ms: u64,
    /// Time without the item until the vehicle gives up a transfer, milliseconds.
    pub give_up_ms: u64,
    /// Silence of the vehicle in a transfer after which an upload starts again, milliseconds:
    /// several times `request_ms`.
    pub silence_ms: u64,
    /// Whether it may reject a mission by a text after it has acknowledged the upload.
    pub rejects_after_ack: bool,
}

/// What a vehicle flies with where a spec says nothing.
#[derive(Clone, Copy, Debug)]
pub struct Defaults {
    /// The parameter that sets the cruise speed.
    pub cruise_parameter: &'static str,
    /// The parameters of the least and the greatest speed, which hold whatever is commanded.
    pub speed_parameters: [Option<&'static str>; 2],
    /// The parameters of the greatest climb and descent on a wing; the least of them holds.
    pub rate_parameters: Option<[&'static [&'static str]; 2]>,
    /// The parameters that set climb, descent and acceleration, in this order: not of a wing, where
    /// they are limits.
    pub motion_parameters: Option<[&'static str; 3]>,
    /// The parameters that set climb and descent on the rotors of a vehicle with a wing.
    pub rotor_parameters: Option<[&'static str; 2]>,
    /// The parameters that keep climb and descent on rotors down, whatever those say.
    pub max_rotor_parameters: Option<[&'static str; 2]>,
    /// The parameter of the greatest bank of a wing.
    pub bank_parameter: Option<&'static str>,
    /// Climb, m/s.
    pub climb_mps: f64,
    /// Descent, m/s, positive.
    pub descent_mps: f64,
    /// Acceleration, m/s^2.
    pub accel_mps2: f64,
}

impl Defaults {
    /// The cruise speed that a vehicle comes with, m/s.
    #[must_use]
    pub fn cruise_mps(&self) -> f64 {
        parameter(self.cruise_parameter).map_or(0.0, ParameterRow::default_si)
    }
}

/// Everything known of one autopilot on one airframe.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// The firmware, for people.
    pub firmware: &'static str,
    /// What is supported, and on which evidence.
    pub support: Support,
    /// How many items it stores.
    pub capacity: Capacity,
    /// Which items it accepts, besides the rules of [`COMMANDS`].
    pub acceptance: AcceptanceRules,
    /// Stored form of parameters; the first row of a command counts.
    pub stored: &'static [&'static [StoredRow]],
    /// Flight modes.
    pub modes: Modes,
    /// Parameters that a vehicle comes with.
    pub parameters: &'static [&'static [ParameterRow]],
    /// The fence of its parameters.
    pub param_fence: ParamFence,
    /// The parameters of a landing on rotors, if it has any.
    pub landing: Option<LandingParameters>,
    /// Parameters that lead a return elsewhere than the verdict flies it, with the value of those
    /// that do not.
    pub returns_with: &'static [(&'static str, f64)],
    /// Parameters that change how all of a mission is flown, with the values that the verdict knows.
    pub judged_with: &'static [&'static [(&'static str, Judged)]],
    /// What it flies with unless the spec says otherwise.
    pub defaults: Defaults,
    /// How it flies around a waypoint where it slows down for one: not on a wing.
    pub corners: Option<CornerLaw>,
    /// Where it stops.
    pub stops: Stops,
    /// What it stores and never starts.
    pub skips: Skips,
    /// The versions in which a copter is at the altitude of the end of a leg soon after its beginning: a mission must
    /// name such a version to be judged and flown by it.
    pub heights_at_once: Option<VersionRange>,
    /// The altitude that its control follows rises from 0 at its boot, by this parameter, m/s: before it has come to that of
    /// its home it sinks behind its takeoff.
    pub rises_from_boot: Option<&'static str>,
    /// How it deviates from straight legs flown on time.
    pub behaviour: Behaviour,
    /// Buffer to every limit unless the spec says otherwise, metres: for errors of position and
    /// control that the verdict does not model.
    pub buffer_m: f64,
}

/// The table of one autopilot on one airframe.
#[must_use]
pub fn facts(autopilot: Autopilot, airframe: Airframe) -> &'static Facts {
    match (autopilot, airframe) {
        (Autopilot::ArduPilot, Airframe::Copter) => &ardupilot::ARDUCOPTER,
        (Autopilot::ArduPilot, Airframe::Plane) => &ardupilot::ARDUPLANE,
        (Autopilot::ArduPilot, Airframe::Vtol) => &ardupilot::QUADPLANE,
        (Autopilot::Px4, Airframe::Copter) => &px4::COPTER,
        (Autopilot::Px4, Airframe::Plane) => &px4::PLANE,
        (Autopilot::Px4, Airframe::Vtol) => &px4::VTOL,
    }
}

impl Facts {
    /// The row of a parameter that a vehicle of this kind has, in whichever version.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<&'static ParameterRow> {
        let mut rows = self.parameters.iter().copied().flatten();
        rows.find(|row| row.name == name)
    }

    /// The parameter that has after how long it disarms itself before a takeoff, if it does; 0 and below: never.
    #[must_use]
    pub fn disarms_after(&self) -> Option<&'static ParameterRow> {
        let names = ["DISARM_DELAY", "COM_DISARM_PRFLT"];
        names.into_iter().find_map(|name| self.parameter(name))
    }

    /// Whether a version is at the altitude of the end of a leg soon after its beginning. Without one it is taken not to
    /// be: `fly` refuses a vehicle that is, then.
    #[must_use]
    pub fn has_heights_at_once(&self, version: Option<Version>) -> bool {
        let range = self.heights_at_once;
        range.is_some_and(|range| version.is_some_and(|of| range.contains(of)))
    }

    /// Stored form of `param1` to `param4` of a command.
    #[must_use]
    pub fn stored_params(&self, command: u16) -> [Stored; 4] {
        let mut rows = self.stored.iter().copied().flatten();
        let row = rows.find(|(known, _)| *known == command);
        row.map_or([Stored::Same; 4], |&(_, params)| params)
    }
}

impl Autopilot {
    /// Both, in the order of documents.
    pub const ALL: [Self; 2] = [Self::ArduPilot, Self::Px4];

    /// What it does on every airframe.
    #[must_use]
    pub fn conventions(self) -> &'static Conventions {
        match self {
            Self::ArduPilot => &ardupilot::CONVENTIONS,
            Self::Px4 => &px4::CONVENTIONS,
        }
    }

    /// The autopilot of a `MAV_AUTOPILOT`, if it is in the tables.
    #[must_use]
    pub fn of_mavlink(mav_autopilot: u8) -> Option<Self> {
        let is_it = |known: &Self| known.conventions().mav_autopilot == mav_autopilot;
        Self::ALL.into_iter().find(is_it)
    }

    /// Its name as its developers write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.conventions().name
    }

    /// Rows are counted with home as 0, as in a `.waypoints` file: the row of sequence number 0.
    #[must_use]
    pub fn first_row(self) -> u8 {
        u8::from(!self.conventions().counts_home)
    }

    /// The versions that a mission must suit: the one that is known, or all that are supported.
    #[must_use]
    pub fn versions(self, version: Option<Version>) -> Vec<Version> {
        match version {
            Some(version) => vec![version],
            None => self.conventions().versions.to_vec(),
        }
    }
}

impl Airframe {
    /// All of them, in the order of documents.
    pub const ALL: [Self; 3] = [Self::Copter, Self::Plane, Self::Vtol];

    /// Its name, for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Copter => "copter",
            Self::Plane => "plane",
            Self::Vtol => "VTOL",
        }
    }

    /// Whether it flies on a wing between takeoff and landing: it cannot stop, and circles where
    /// a copter hovers.
    #[must_use]
    pub fn has_wing(self) -> bool {
        match self {
            Self::Copter => false,
            Self::Plane | Self::Vtol => true,
        }
    }

    /// Whether it takes off and lands on rotors.
    #[must_use]
    pub fn has_rotors(self) -> bool {
        match self {
            Self::Copter | Self::Vtol => true,
            Self::Plane => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_those_of_the_parameters() {
        let si = |name: &str| parameter(name).map(ParameterRow::default_si);
        for (facts, [climb, descent]) in [
            (&ardupilot::ARDUCOPTER, ["WPNAV_SPEED_UP", "WPNAV_SPEED_DN"]),
            (&ardupilot::ARDUPLANE, ["TECS_CLMB_MAX", "TECS_SINK_MAX"]),
            (&ardupilot::QUADPLANE, ["Q_WP_SPEED_UP", "Q_WP_SPEED_DN"]),
            (&px4::COPTER, ["MPC_Z_V_AUTO_UP", "MPC_Z_V_AUTO_DN"]),
            (&px4::PLANE, ["FW_T_CLMB_MAX", "FW_T_SINK_MAX"]),
            (&px4::VTOL, ["MPC_Z_V_AUTO_UP", "MPC_Z_V_AUTO_DN"]),
        ] {
            let defaults = facts.defaults;
            assert_eq!(Some(defaults.climb_mps), si(climb), "{}", facts.firmware);
            assert_eq!(
                Some(defaults.descent_mps),
                si(descent),
                "{}",
                facts.firmware
            );
            assert!(defaults.cruise_mps() > 0.0, "{}", facts.firmware);
        }
    }

    #[test]
    fn every_figure_names_its_source() {
        for autopilot in Autopilot::ALL {
            for airframe in Airframe::ALL {
                for (name, figure) in facts(autopilot, airframe).behaviour.figures() {
                    for measured in figure.rows {
                        assert!(!measured.source.is_empty(), "{name}");
                        assert!(measured.value > 0.0, "{name}");
                    }
                }
            }
        }
    }
}
