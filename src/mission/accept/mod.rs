//! What an autopilot takes: rules as one table of data per autopilot and airframe, and one
//! check for each.
//!
//! An upload that is acknowledged is not yet a mission that is accepted, and PX4
//! takes latitude 95 without a word; so everything is held against this table before
//! it is sent. Sources: ArduPilot `AP_Mission::mavlink_int_to_mission_cmd` and
//! `sanity_check_params`; PX4 `mavlink_mission.cpp` and `FeasibilityChecker`; and what
//! ArduCopter 4.6.3, ArduPlane 4.6.3 and PX4 1.18 did in simulation.

pub(super) mod differences;
pub(super) mod fence;
pub(super) mod item;
pub(super) mod wing;

use std::fmt;

use super::commands::{ARDUPILOT, CommandRule, PX4, Place};
use super::item::{Item, VehicleMission, command, frame};
use super::params::ACCEPTANCE_RADIUS;
use crate::spec::{Airframe, Autopilot};

/// One of the three lists of items that a vehicle holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum List {
    /// The mission proper.
    Mission,
    /// The fence.
    Fence,
    /// The rally points.
    Rally,
}

impl fmt::Display for List {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mission => "mission",
            Self::Fence => "fence",
            Self::Rally => "rally",
        })
    }
}

/// Something that the autopilot refuses, or would take for something else.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AcceptanceProblem {
    /// In which list.
    pub list: List,
    /// Which item, from 1 (in a mission the row of the `.waypoints` file); 0 for the list as a whole.
    pub item: usize,
    /// The rule, in a few words.
    pub rule: &'static str,
    /// What was found.
    pub found: String,
    /// What is allowed.
    pub allowed: String,
}

impl fmt::Display for AcceptanceProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.list)?;
        if self.item > 0 {
            write!(f, " item {}", self.item)?;
        }
        write!(
            f,
            ": {}: {} (allowed: {})",
            self.rule, self.found, self.allowed
        )
    }
}

/// How many items an autopilot holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Mission items, home not counted.
    pub items: usize,
    /// Fence items: corners and circles.
    pub fence: usize,
    /// Rally points.
    pub rally: usize,
}

/// What one autopilot takes on one kind of airframe.
pub(super) struct Profile {
    pub(super) limits: Limits,
    pub(super) commands: &'static [CommandRule],
    /// Commands to which latitude 0, longitude 0 means where the vehicle is: Mission
    /// Planner writes takeoffs so.
    pub(super) here: &'static [u16],
    /// Frames of items with a place.
    pub(super) place_frames: &'static [u8],
    /// Frames of items without one; any if absent.
    pub(super) command_frames: Option<&'static [u8]>,
    /// Whether a NaN is read as "default" in every parameter.
    pub(super) any_nan: bool,
    /// Altitudes beyond do not fit, metres.
    pub(super) max_altitude_m: f32,
    /// The first target of a jump: ArduPilot counts home as 0, PX4 does not count it.
    pub(super) first_jump: u16,
    /// Longest hold at a waypoint, seconds.
    pub(super) max_hold_s: f32,
    /// Whether a landing may look for a beacon, in its `param2`.
    pub(super) lands_by_beacon: bool,
    /// A takeoff must end this far above the acceptance radius.
    pub(super) takeoff_over_radius_m: Option<f32>,
    /// The command that takes this airframe off.
    pub(super) takeoff: u16,
    /// The command that lands it.
    pub(super) landing: u16,
    /// What is refused or misread on a wing alone.
    pub(super) wing: Wing,
}

/// What an autopilot refuses or misreads on a wing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wing {
    /// NAV_DELAY is over at once.
    pub(super) never_waits: bool,
    /// NAV_WAYPOINT and circles keep whole numbers, and no hold.
    pub(super) whole_numbers: bool,
    /// The altitude of a takeoff is a height above where the vehicle stands, whatever the frame.
    pub(super) takeoff_above_home: bool,
    /// A landing without an approach on a glide is refused.
    pub(super) needs_approach: bool,
}

/// A copter has none.
const NO_WING: Wing = Wing {
    never_waits: false,
    whole_numbers: false,
    takeoff_above_home: false,
    needs_approach: false,
};

/// ArduCopter: 650 with home; altitudes are 24 bit centimetres.
static ARDUPILOT_PROFILE: Profile = Profile {
    limits: Limits {
        items: 649,
        fence: 70,
        rally: 46,
    },
    commands: ARDUPILOT,
    here: &[command::NAV_TAKEOFF, command::NAV_LAND],
    place_frames: &[0, 3, 5, 6, 10, 11],
    command_frames: None,
    any_nan: false,
    max_altitude_m: 83_000.0,
    first_jump: 1,
    max_hold_s: 65_535.0,
    lands_by_beacon: false,
    takeoff_over_radius_m: None,
    takeoff: command::NAV_TAKEOFF,
    landing: command::NAV_LAND,
    wing: NO_WING,
};

/// ArduPlane: 655 with home. Its NAV_DELAY ends at once when armed
/// (`ModeAuto::verify_nav_delay`).
static ARDUPLANE_PROFILE: Profile = Profile {
    limits: Limits {
        items: 654,
        ..ARDUPILOT_PROFILE.limits
    },
    wing: Wing {
        never_waits: true,
        whole_numbers: true,
        ..NO_WING
    },
    ..ARDUPILOT_PROFILE
};

/// ArduPlane on a QuadPlane: unless `Q_OPTIONS` says otherwise, a takeoff climbs by its
/// altitude (`QuadPlane::do_vtol_takeoff`).
static QUADPLANE_PROFILE: Profile = Profile {
    takeoff: command::NAV_VTOL_TAKEOFF,
    landing: command::NAV_VTOL_LAND,
    wing: Wing {
        takeoff_above_home: true,
        ..ARDUPLANE_PROFILE.wing
    },
    ..ARDUPLANE_PROFILE
};

/// PX4: `dataman.h` holds 64 fence and 32 rally points.
static PX4_PROFILE: Profile = Profile {
    limits: Limits {
        items: 10_000,
        fence: 64,
        rally: 32,
    },
    commands: PX4,
    here: &[],
    place_frames: &[0, 3, 5, 6],
    command_frames: Some(&[frame::MISSION]),
    any_nan: true,
    max_altitude_m: 83_000.0,
    first_jump: 0,
    max_hold_s: 65_535.0,
    lands_by_beacon: true,
    takeoff_over_radius_m: Some(1.0),
    takeoff: command::NAV_TAKEOFF,
    landing: command::NAV_LAND,
    wing: NO_WING,
};

/// PX4 on a fixed wing (`FeasibilityChecker::checkFixedWindLandApproach`).
static PX4_PLANE_PROFILE: Profile = Profile {
    wing: Wing {
        needs_approach: true,
        ..NO_WING
    },
    ..PX4_PROFILE
};

/// PX4 on a VTOL.
static PX4_VTOL_PROFILE: Profile = Profile {
    takeoff: command::NAV_VTOL_TAKEOFF,
    landing: command::NAV_VTOL_LAND,
    ..PX4_PROFILE
};

/// PX4's acceptance radius where the mission's parameters do not state it, metres.
const DEFAULT_ACCEPTANCE_RADIUS_M: f32 = 10.0;

fn profile(autopilot: Autopilot, airframe: Airframe) -> &'static Profile {
    match (autopilot, airframe) {
        (Autopilot::ArduPilot, Airframe::Copter) => &ARDUPILOT_PROFILE,
        (Autopilot::ArduPilot, Airframe::Plane) => &ARDUPLANE_PROFILE,
        (Autopilot::ArduPilot, Airframe::Vtol) => &QUADPLANE_PROFILE,
        (Autopilot::Px4, Airframe::Copter) => &PX4_PROFILE,
        (Autopilot::Px4, Airframe::Plane) => &PX4_PLANE_PROFILE,
        (Autopilot::Px4, Airframe::Vtol) => &PX4_VTOL_PROFILE,
    }
}

/// How many items an autopilot holds, on any airframe.
#[must_use]
pub fn limits(autopilot: Autopilot) -> Limits {
    profile(autopilot, Airframe::Copter).limits
}

/// What was found and what is allowed.
pub(super) type Finding = (String, String);

/// One rule, for every item or for the mission as a whole.
enum Check {
    Item(fn(&Profile, &Item) -> Option<Finding>),
    Mission(fn(&Profile, &VehicleMission) -> Option<(usize, Finding)>),
}

/// The one rule that does not hold in the air.
const TAKEOFF_FIRST: &str = "takeoff first";

/// The rules, in the order in which problems of one item are told.
static RULES: &[(&str, Check)] = &[
    ("something to fly", Check::Mission(something_to_fly)),
    ("item count", Check::Mission(item_count)),
    ("known command", Check::Item(item::known_command)),
    ("frame", Check::Item(item::allowed_frame)),
    ("finite parameters", Check::Item(item::finite_parameters)),
    ("latitude", Check::Item(item::latitude)),
    ("longitude", Check::Item(item::longitude)),
    ("a real place", Check::Item(item::real_place)),
    ("altitude", Check::Item(item::altitude)),
    ("hold time", Check::Item(item::hold_time)),
    ("precision landing", Check::Item(item::precision_landing)),
    ("jump target", Check::Mission(jump_target)),
    (TAKEOFF_FIRST, Check::Mission(takeoff_first)),
    ("takeoff altitude", Check::Mission(takeoff_altitude)),
    ("takeoff frame", Check::Item(wing::takeoff_frame)),
    ("kind of landing", Check::Item(wing::kind_of_landing)),
    ("departure delay", Check::Item(wing::departure_delay)),
    ("whole numbers", Check::Item(wing::whole_numbers)),
    ("landing approach", Check::Mission(wing::landing_approach)),
];

/// Everything in a mission, its fence and its rally points that the autopilot
/// would refuse or misread.
#[must_use]
pub fn problems(mission: &VehicleMission) -> Vec<AcceptanceProblem> {
    let profile = profile(mission.autopilot, mission.airframe);
    let mut found = Vec::new();
    for (rule, check) in RULES {
        let mut tell = |item, (found_text, allowed): Finding| {
            found.push(AcceptanceProblem {
                list: List::Mission,
                item,
                rule,
                found: found_text,
                allowed,
            });
        };
        match check {
            Check::Mission(check) => {
                if let Some((item, finding)) = check(profile, mission) {
                    tell(item, finding);
                }
            }
            Check::Item(check) => {
                for (index, item) in mission.items.iter().enumerate() {
                    if let Some(finding) = check(profile, item) {
                        tell(index + 1, finding);
                    }
                }
            }
        }
    }
    found.sort_by_key(|problem| problem.item);
    found.extend(fence::problems(mission, profile.limits));
    found
}

/// The same for a mission that a vehicle is given in the air, where it needs no takeoff.
#[must_use]
pub fn problems_in_flight(mission: &VehicleMission) -> Vec<AcceptanceProblem> {
    let mut found = problems(mission);
    found.retain(|problem| problem.rule != TAKEOFF_FIRST);
    found
}

impl Profile {
    pub(super) fn rule(&self, item: &Item) -> Option<&'static CommandRule> {
        self.commands
            .iter()
            .find(|rule| rule.command == item.command)
    }

    /// Whether the item goes somewhere: its command has a place and its frame is not that of commands.
    pub(super) fn has_place(&self, item: &Item) -> bool {
        match self.rule(item).map(|rule| rule.place) {
            Some(Place::Needed) => true,
            Some(Place::Optional) => item.frame != frame::MISSION,
            Some(Place::None) | None => false,
        }
    }
}

fn something_to_fly(_: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    mission
        .items
        .is_empty()
        .then(|| (0, ("no items".to_owned(), "at least one".to_owned())))
}

fn item_count(profile: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    let (count, limit) = (mission.items.len(), profile.limits.items);
    (count > limit).then(|| {
        (
            0,
            (format!("{count} items"), format!("{limit}, home aside")),
        )
    })
}

fn jump_target(profile: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    let first = usize::from(profile.first_jump);
    let last = (mission.items.len() + first).saturating_sub(1);
    let bad = |item: &Item| {
        item.command == command::DO_JUMP && !(first..=last).any(|target| is(item.params[0], target))
    };
    let index = mission.items.iter().position(bad)?;
    let target = mission.items[index].params[0];
    Some((
        index + 1,
        (format!("item {target}"), format!("{first} to {last}")),
    ))
}

/// Whether a parameter is exactly this whole number.
fn is(value: f32, whole: usize) -> bool {
    u16::try_from(whole).is_ok_and(|whole| value.to_bits() == f32::from(whole).to_bits())
}

fn takeoff_first(profile: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    let first = mission.items.iter().position(|item| {
        profile.has_place(item) || item.command == command::NAV_RETURN_TO_LAUNCH
    })?;
    let found = mission.items[first].command;
    (found != profile.takeoff).then(|| {
        (
            first + 1,
            (
                format!("command {found} before any takeoff"),
                format!("command {} (takeoff)", profile.takeoff),
            ),
        )
    })
}

fn takeoff_altitude(profile: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    let index = mission
        .items
        .iter()
        .position(|item| item.command == profile.takeoff)?;
    let item = &mission.items[index];
    let climb_m = match frame::canonical(item.frame) {
        frame::GLOBAL => item.z - mission.home.amsl_m,
        _ => item.z,
    };
    let least_m = profile.takeoff_over_radius_m.map_or(0.0, |over_m| {
        let radius_m = mission
            .params
            .iter()
            .find(|parameter| parameter.name == ACCEPTANCE_RADIUS)
            .map_or(DEFAULT_ACCEPTANCE_RADIUS_M, |parameter| parameter.value);
        radius_m + over_m
    });
    // A NaN is told by the rule of altitudes.
    (climb_m <= least_m).then(|| {
        (
            index + 1,
            (
                format!("{climb_m} m above home"),
                format!("more than {least_m} m"),
            ),
        )
    })
}
