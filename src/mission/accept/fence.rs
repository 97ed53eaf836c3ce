//! Rules for the fence and the rally points.

use super::{AcceptanceProblem, MissionType};
use crate::autopilot::{Capacity, command, frame};
use crate::mission::item::{Item, VehicleMission};

/// Problems of the fence and the rally points.
pub(crate) fn problems(mission: &VehicleMission, capacity: Capacity) -> Vec<AcceptanceProblem> {
    let mut found = Vec::new();
    found.extend(AcceptanceProblem::fence_count(mission, capacity.fence));
    found.extend(count(MissionType::Rally, &mission.rally, capacity.rally));
    for (list, items) in [
        (MissionType::Fence, &mission.fence),
        (MissionType::Rally, &mission.rally),
    ] {
        for (index, item) in items.iter().enumerate() {
            found.extend(place(list, index + 1, item));
        }
    }
    found.extend(polygons(&mission.fence));
    found.extend(kinds(mission));
    found
}

const ITEM_COUNT: &str = "item count";

impl AcceptanceProblem {
    /// Whether it is that of [`Self::fence_count`].
    pub(crate) fn is_fence_count(&self) -> bool {
        self.list == MissionType::Fence && self.rule == ITEM_COUNT
    }

    /// That a fence has more items than a vehicle keeps.
    pub(crate) fn fence_count(mission: &VehicleMission, capacity: usize) -> Option<Self> {
        count(MissionType::Fence, &mission.fence, capacity)
    }
}

/// That a list has more items than a vehicle keeps.
fn count(list: MissionType, items: &[Item], capacity: usize) -> Option<AcceptanceProblem> {
    (items.len() > capacity).then(|| AcceptanceProblem {
        list,
        item: 0,
        rule: ITEM_COUNT,
        found: format!("{} items", items.len()),
        allowed: capacity.to_string(),
    })
}

/// Checks that the item is at a place on earth, in a frame with latitude and longitude.
fn place(list: MissionType, number: usize, item: &Item) -> Option<AcceptanceProblem> {
    let problem = |rule, found: String, allowed: &str| {
        Some(AcceptanceProblem {
            list,
            item: number,
            rule,
            found,
            allowed: allowed.to_owned(),
        })
    };
    if ![frame::GLOBAL, frame::GLOBAL_RELATIVE_ALT].contains(&frame::canonical(item.frame)) {
        return problem("frame", format!("frame {}", item.frame), "frame 0, 3, 5, 6");
    }
    if item.place().is_none() || (item.x, item.y) == (0, 0) {
        let (lat_deg, lon_deg) = (f64::from(item.x) / 1e7, f64::from(item.y) / 1e7);
        return problem(
            "a real place",
            format!("latitude {lat_deg}, longitude {lon_deg}"),
            "-90 to 90, -180 to 180, not 0, 0",
        );
    }
    if !item.z.is_finite() {
        return problem("altitude", format!("{} m", item.z), "a number");
    }
    None
}

/// Checks that each polygon has as many corners as its items state, and each circle a radius.
fn polygons(fence: &[Item]) -> Vec<AcceptanceProblem> {
    let mut found = Vec::new();
    let mut index = 0;
    while let Some(item) = fence.get(index) {
        let problem = |rule, found: String, allowed: String| AcceptanceProblem {
            list: MissionType::Fence,
            item: index + 1,
            rule,
            found,
            allowed,
        };
        match item.command {
            command::NAV_FENCE_POLYGON_VERTEX_INCLUSION
            | command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION => {
                let run = fence[index..]
                    .iter()
                    .take_while(|next| {
                        next.command == item.command
                            && next.params[0].to_bits() == item.params[0].to_bits()
                    })
                    .count();
                let corners = (3..=run).find(|&corners| {
                    u16::try_from(corners)
                        .is_ok_and(|count| f32::from(count).to_bits() == item.params[0].to_bits())
                });
                if corners.is_none() {
                    found.push(problem(
                        "polygon corners",
                        format!("param1 {} before {run} such corners", item.params[0]),
                        "param1 is the number of corners that follow, at least 3".to_owned(),
                    ));
                }
                index += corners.unwrap_or(run);
            }
            command::NAV_FENCE_CIRCLE_INCLUSION | command::NAV_FENCE_CIRCLE_EXCLUSION => {
                let radius_m = item.params[0];
                if !(radius_m.is_finite() && radius_m > 0.0) {
                    found.push(problem(
                        "circle radius",
                        format!("{radius_m} m"),
                        "more than 0 m".to_owned(),
                    ));
                }
                index += 1;
            }
            _ => index += 1,
        }
    }
    found
}

/// Checks that each list has its own commands only.
fn kinds(mission: &VehicleMission) -> Vec<AcceptanceProblem> {
    let fence = command::NAV_FENCE_RETURN_POINT..=command::NAV_FENCE_CIRCLE_EXCLUSION;
    let rally = command::NAV_RALLY_POINT..=command::NAV_RALLY_POINT;
    let mut found = Vec::new();
    for (list, items, allowed) in [
        (MissionType::Fence, &mission.fence, fence),
        (MissionType::Rally, &mission.rally, rally),
    ] {
        for (index, item) in items.iter().enumerate() {
            if !allowed.contains(&item.command) {
                found.push(AcceptanceProblem {
                    list,
                    item: index + 1,
                    rule: "known command",
                    found: format!("command {}", item.command),
                    allowed: format!("{} to {}", allowed.start(), allowed.end()),
                });
            }
        }
    }
    found
}
