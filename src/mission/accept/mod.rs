//! Acceptance of a mission: the rules of [`crate::autopilot`] applied to its items.
//!
//! An acknowledged upload is not yet an accepted mission, and PX4 acknowledges latitude 95. So
//! every mission is checked before it is sent. Sources: ArduPilot
//! `AP_Mission::mavlink_int_to_mission_cmd` and `sanity_check_params`; PX4 `mavlink_mission.cpp`
//! and `FeasibilityChecker`; ArduCopter 4.6.3, ArduPlane 4.6.3 and PX4 1.18 in simulation.

pub(super) mod differences;
pub(super) mod fence;
pub(super) mod item;
pub(super) mod param_fence;
pub(super) mod stored;
pub(super) mod whole;
pub(super) mod wing;

use std::fmt;

use super::item::{Item, VehicleMission};
use crate::autopilot::{Autopilot, CommandRule, Facts, Version, command_row, facts};

/// One of the three lists of items that a vehicle stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissionType {
    /// The mission proper.
    Mission,
    /// The fence.
    Fence,
    /// The rally points.
    Rally,
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

/// Something that the autopilot rejects, or reads as something else.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AcceptanceProblem {
    /// In which list.
    pub list: MissionType,
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

/// The tables that apply to one mission.
pub(super) struct Profile {
    autopilot: Autopilot,
    facts: &'static Facts,
    /// The versions that must accept it.
    versions: Vec<Version>,
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

/// The rules, in the order in which problems of one item are reported.
static RULES: &[(&str, Check)] = &[
    ("something to fly", Check::Mission(whole::something_to_fly)),
    ("item count", Check::Mission(whole::item_count)),
    ("jump count", Check::Mission(whole::jump_count)),
    ("known command", Check::Item(item::known_command)),
    ("frame", Check::Item(item::allowed_frame)),
    ("finite parameters", Check::Item(item::finite_parameters)),
    ("parameter value", Check::Item(item::parameter_values)),
    ("unread parameter", Check::Item(item::unread_parameters)),
    ("latitude", Check::Item(item::latitude)),
    ("longitude", Check::Item(item::longitude)),
    ("a real place", Check::Item(item::real_place)),
    ("altitude", Check::Item(item::altitude)),
    ("hold time", Check::Item(item::hold_time)),
    ("precision landing", Check::Item(item::precision_landing)),
    ("jump target", Check::Mission(whole::jump_target)),
    (TAKEOFF_FIRST, Check::Mission(whole::takeoff_first)),
    (
        "takeoff first of all",
        Check::Mission(whole::nothing_before_takeoff),
    ),
    ("takeoff altitude", Check::Mission(whole::takeoff_altitude)),
    ("takeoff frame", Check::Item(wing::takeoff_frame)),
    ("kind of landing", Check::Item(item::kind_of_landing)),
    ("departure delay", Check::Item(wing::departure_delay)),
    ("whole numbers", Check::Item(wing::whole_numbers)),
    ("landing approach", Check::Mission(wing::landing_approach)),
    ("stopping distance", Check::Mission(wing::stopping_distance)),
    ("start of the landing", Check::Mission(wing::land_start)),
    (param_fence::RULE, Check::Mission(param_fence::inside)),
];

/// Everything in a mission, its fence and its rally points that the autopilot would reject or
/// misinterpret.
#[must_use]
pub fn problems(mission: &VehicleMission) -> Vec<AcceptanceProblem> {
    let autopilot = mission.autopilot;
    let profile = Profile {
        autopilot,
        facts: facts(autopilot, mission.airframe),
        versions: autopilot.versions(mission.autopilot_version),
    };
    let mut found = Vec::new();
    for (rule, check) in RULES {
        let mut add = |item, (found_text, allowed): Finding| {
            found.push(AcceptanceProblem {
                list: MissionType::Mission,
                item,
                rule,
                found: found_text,
                allowed,
            });
        };
        match check {
            Check::Mission(check) => {
                if let Some((item, finding)) = check(&profile, mission) {
                    add(item, finding);
                }
            }
            Check::Item(check) => {
                for (index, item) in mission.items.iter().enumerate() {
                    if let Some(finding) = check(&profile, item) {
                        add(index + 1, finding);
                    }
                }
            }
        }
    }
    found.sort_by_key(|problem| problem.item);
    found.extend(fence::problems(mission, profile.facts.capacity));
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
    /// The rule of the item's command; none if the autopilot rejects it.
    fn rule(&self, item: &Item) -> Option<&'static CommandRule> {
        let rule = command_row(item.command)?.rule(self.autopilot)?;
        let accepts = |version: &Version| rule.versions.contains(*version);
        self.versions.iter().all(accepts).then_some(rule)
    }

    /// Whether the item has a location: its command reads one, and its frame is not that of
    /// commands.
    fn has_location(&self, item: &Item) -> bool {
        self.rule(item)
            .is_some_and(|rule| rule.has_location(item.frame))
    }

    /// Whether the autopilot checks latitude, longitude and altitude of the item.
    fn checks_location(&self, item: &Item) -> bool {
        self.rule(item)
            .is_some_and(|rule| rule.checks_location(item.frame))
    }
}
