//! What a format cannot keep, in one place.

use crate::mission::{Item, VehicleMission, frame};

/// A mission file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `QGC WPL 110`.
    Waypoints,
    /// QGroundControl's `.plan`.
    Plan,
}

/// What a file of this format never tells, for whoever judges it alone.
#[must_use]
pub fn known_losses(format: Format) -> &'static str {
    match format {
        Format::Waypoints => {
            "a .waypoints file holds no fence, no rally points and no parameters: they are not judged"
        }
        Format::Plan => "a .plan file holds no parameters: they are not judged",
    }
}

/// What is lost when a mission is written in a format, one sentence each; empty
/// when everything comes back.
///
/// | | `.waypoints` | `.plan` |
/// |---|---|---|
/// | NaN ("the vehicle's default") | written as 0 | kept as `null` |
/// | other numbers beside finite ones | written as 0 | written as `null` |
/// | fence, rally | no place | kept |
/// | order of a fence | - | return point, polygons, circles |
/// | `param2` to `param4`, altitude, frame, autocontinue of a fence item | - | dropped |
/// | `param1` to `param4`, autocontinue of a rally point | - | dropped |
/// | autopilot, airframe | dropped | kept |
/// | parameters, notes | dropped | dropped |
#[must_use]
pub fn losses(mission: &VehicleMission, format: Format) -> Vec<String> {
    let mut told = Vec::new();
    match format {
        Format::Waypoints => {
            let numbers = |item: &Item| item.params.iter().chain([&item.z]).all(|v| v.is_finite());
            let lost = mission.items.iter().filter(|item| !numbers(item)).count();
            if lost > 0 {
                told.push(format!(
                    "NaN (\"the vehicle's default\") is written as 0 in {lost} items"
                ));
            }
            if !mission.fence.is_empty() {
                told.push(format!(
                    "the fence ({} items) is not in it",
                    mission.fence.len()
                ));
            }
            if !mission.rally.is_empty() {
                told.push(format!(
                    "{} rally points are not in it",
                    mission.rally.len()
                ));
            }
            told.push("it does not say for which autopilot it is".to_owned());
        }
        Format::Plan => {
            if mission
                .items
                .iter()
                .any(|item| item.params.iter().chain([&item.z]).any(|v| v.is_infinite()))
            {
                told.push("infinite numbers are written as null".to_owned());
            }
            let plain = |item: &Item| {
                item.params[1..]
                    .iter()
                    .chain([&item.z])
                    .all(|v| v.to_bits() == 0)
            };
            let places =
                |item: &Item, expected| item.frame == expected && plain(item) && !item.autocontinue;
            if !mission.fence.iter().all(|item| places(item, frame::GLOBAL)) {
                told.push(
                    "frame, altitude and param2 to param4 of fence items are dropped".to_owned(),
                );
            }
        }
    }
    if !mission.params.is_empty() {
        told.push("parameters are not in it".to_owned());
    }
    told
}
