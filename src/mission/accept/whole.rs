//! Rules for a mission as a whole.

use super::{Finding, Profile};
use crate::autopilot::{command, frame};
use crate::mission::item::{Item, VehicleMission};

pub(crate) fn something_to_fly(_: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    let finding = || (0, ("no items".to_owned(), "at least one".to_owned()));
    mission.items.is_empty().then(finding)
}

pub(crate) fn item_count(profile: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    let (count, limit) = (mission.items.len(), profile.facts.capacity.items);
    let finding = || {
        (
            format!("{count} items"),
            format!("{limit}, not counting home"),
        )
    };
    (count > limit).then(|| (0, finding()))
}

pub(crate) fn jump_count(profile: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    // A jump to a tag takes a place of storage as well.
    let counts = |item: &&Item| is_jump(item) || item.command == command::DO_JUMP_TAG;
    let jumps = mission.items.iter().filter(counts);
    let (count, limit) = (jumps.count(), profile.facts.capacity.jumps);
    let finding = || (format!("{count} DO_JUMP items"), limit.to_string());
    (count > limit).then(|| (0, finding()))
}

fn is_jump(item: &Item) -> bool {
    item.command == command::DO_JUMP
}

pub(crate) fn jump_target(profile: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    let first = usize::from(1 - profile.autopilot.first_row());
    let last = (mission.items.len() + first).saturating_sub(1);
    let is_wrong =
        |item: &Item| is_jump(item) && !(first..=last).any(|target| is(item.params[0], target));
    let index = mission.items.iter().position(is_wrong)?;
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

pub(crate) fn takeoff_first(
    profile: &Profile,
    mission: &VehicleMission,
) -> Option<(usize, Finding)> {
    let rules = &profile.facts.acceptance;
    let first = mission.items.iter().position(|item| {
        profile.has_location(item) || item.command == command::NAV_RETURN_TO_LAUNCH
    })?;
    let found = mission.items[first].command;
    let starts =
        rules.takeoffs.contains(&found) || !rules.needs_takeoff && found == command::NAV_WAYPOINT;
    let finding = || {
        let allowed = format!("{} (takeoff)", commands(rules.takeoffs));
        (format!("command {found} before any takeoff"), allowed)
    };
    (!starts).then(|| (first + 1, finding()))
}

/// PX4 rejects a takeoff after an item that counts as one with a position.
pub(crate) fn nothing_before_takeoff(
    profile: &Profile,
    mission: &VehicleMission,
) -> Option<(usize, Finding)> {
    let rules = &profile.facts.acceptance;
    let may_precede = rules.before_takeoff?;
    let first = mission
        .items
        .iter()
        .position(|item| !may_precede.contains(&item.command))?;
    let mut later = mission.items.iter().enumerate().skip(first + 1);
    let (index, _) = later.find(|(_, item)| rules.takeoffs.contains(&item.command))?;
    let found = mission.items[first].command;
    let finding = (
        format!("a takeoff after command {found}"),
        "a takeoff before it".to_owned(),
    );
    Some((index + 1, finding))
}

pub(crate) fn takeoff_altitude(
    profile: &Profile,
    mission: &VehicleMission,
) -> Option<(usize, Finding)> {
    let takeoffs = profile.facts.acceptance.takeoffs;
    let is_takeoff = |item: &Item| takeoffs.contains(&item.command);
    let index = mission.items.iter().position(is_takeoff)?;
    let item = &mission.items[index];
    let climb_m = match frame::canonical(item.frame) {
        frame::GLOBAL => item.z - mission.home.amsl_m,
        _ => item.z,
    };
    // The rule of altitudes reports NaN.
    let finding = || {
        let found = format!("{climb_m} m above home");
        (found, "more than 0 m".to_owned())
    };
    (climb_m <= 0.0).then(|| (index + 1, finding()))
}

/// Numbers of commands for a message.
pub(super) fn commands(numbers: &[u16]) -> String {
    let numbers: Vec<String> = numbers.iter().map(u16::to_string).collect();
    format!("command {}", numbers.join(", "))
}
