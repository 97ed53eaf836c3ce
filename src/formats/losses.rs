//! Content that a format cannot hold.

use crate::mission::{Item, VehicleMission, frame};
use crate::numeric::digits::count;

/// A mission file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// `QGC WPL 110`.
    Waypoints,
    /// QGroundControl's `.plan`.
    Plan,
}

/// Content that a file of this format never holds, as a note for reviews.
#[must_use]
pub fn known_losses(format: Format) -> &'static str {
    match format {
        Format::Waypoints => {
            "a .waypoints file holds no fence, no rally points and no parameters: they are not judged"
        }
        Format::Plan => "a .plan file holds no parameters: they are not judged",
    }
}

/// Content lost when a mission is written in a format, one sentence each; empty when
/// everything reads back.
///
/// | | `.waypoints` | `.plan` |
/// |---|---|---|
/// | NaN ("the vehicle's default") | written as 0 | written as `null` |
/// | infinite numbers | written as 0 | written as `null` |
/// | fence, rally | not written | written |
/// | order of a fence | - | return point, polygons, circles |
/// | `param2` to `param4`, altitude, frame, autocontinue of a fence item | - | dropped |
/// | `param1` to `param4`, autocontinue of a rally point | - | dropped |
/// | autopilot, airframe | dropped | written |
/// | parameters, notes | dropped | dropped |
#[must_use]
pub fn losses(mission: &VehicleMission, format: Format) -> Vec<String> {
    let mut lost = Vec::new();
    match format {
        Format::Waypoints => {
            let numbers = |item: &Item| item.params.iter().chain([&item.z]).all(|v| v.is_finite());
            let open = mission.items.iter().filter(|item| !numbers(item)).count();
            if open > 0 {
                lost.push(format!(
                    "NaN (\"the vehicle's default\") is written as 0 in {}",
                    count(open, "item")
                ));
            }
            if !mission.fence.is_empty() {
                lost.push(format!(
                    "the fence ({}) is not in it",
                    count(mission.fence.len(), "item")
                ));
            }
            if !mission.rally.is_empty() {
                let verb = if mission.rally.len() == 1 {
                    "is"
                } else {
                    "are"
                };
                let points = count(mission.rally.len(), "rally point");
                lost.push(format!("{points} {verb} not in it"));
            }
            lost.push("it does not say for which autopilot it is".to_owned());
        }
        Format::Plan => {
            if mission
                .items
                .iter()
                .any(|item| item.params.iter().chain([&item.z]).any(|v| v.is_infinite()))
            {
                lost.push("infinite numbers are written as null".to_owned());
            }
            let plain = |item: &Item| {
                item.params[1..]
                    .iter()
                    .chain([&item.z])
                    .all(|v| v.to_bits() == 0)
            };
            let is_written =
                |item: &Item| item.frame == frame::GLOBAL && plain(item) && !item.autocontinue;
            if !mission.fence.iter().all(is_written) {
                lost.push(
                    "frame, altitude and param2 to param4 of fence items are dropped".to_owned(),
                );
            }
        }
    }
    if !mission.params.is_empty() {
        lost.push("parameters are not in it".to_owned());
    }
    lost
}
