//! The ceiling and the circle around home that parameters set: a vehicle that comes to them leaves
//! its mission.

use super::{Finding, Profile};
use crate::autopilot::frame;
use crate::geodesy::LatLon;
use crate::mission::item::{Item, VehicleMission};

/// What the parameters of a mission set: metres above home, metres around it.
pub(crate) struct Fence {
    /// Whether more comes of it than a report.
    acts: bool,
    pub(crate) ceiling_m: Option<f64>,
    radius_m: Option<f64>,
}

/// The first item that lies beyond the fence of the mission's parameters.
pub(crate) fn inside(profile: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    let names = profile.facts.param_fence;
    let fence = Fence::of(mission).filter(|fence| fence.acts)?;
    let home = place(mission.home.x, mission.home.y);
    mission.items.iter().enumerate().find_map(|(index, item)| {
        let at = place(item.x, item.y).filter(|_| profile.has_location(item))?;
        let row = index + 1;
        let above_m = above_home_m(item, mission);
        if let (Some(ceiling_m), Some(above_m)) = (fence.ceiling_m, above_m)
            && above_m > ceiling_m
        {
            let allowed = format!("below {ceiling_m} m ({})", names.ceiling.1);
            return Some((row, (format!("{above_m:.1} m above home"), allowed)));
        }
        let away_m = home?.chord_m(at);
        let radius_m = fence.radius_m.filter(|radius_m| away_m > *radius_m)?;
        let allowed = format!("within {radius_m} m ({})", names.circle.1);
        Some((row, (format!("{away_m:.0} m from home"), allowed)))
    })
}

impl Fence {
    /// The fence of a mission's parameters, if it is on.
    pub(crate) fn of(mission: &VehicleMission) -> Option<Self> {
        let names = mission.facts().param_fence;
        let is_set = |name: &&str| mission.param(name).is_some_and(|value| value.abs() > 0.0);
        if !(names.switches.is_empty() || names.switches.iter().any(is_set)) {
            return None;
        }
        let kinds = names.kinds.map_or(u8::MAX.into(), |(name, default)| {
            mission.param(name).unwrap_or(default.into())
        });
        let limit_m = |(bit, name): (u8, &str)| {
            let bit = f64::from(bit);
            let limit_m = mission.param_or_default_si(name)?;
            (kinds.rem_euclid(2.0 * bit) >= bit && limit_m > 0.0).then_some(limit_m)
        };
        Some(Self {
            acts: mission
                .param(names.action)
                .is_none_or(|value| value.abs() > 0.0),
            ceiling_m: limit_m(names.ceiling),
            radius_m: limit_m(names.circle),
        })
    }
}

/// The place of 1e-7 degrees; 0, 0 is none.
fn place(x: i32, y: i32) -> Option<LatLon> {
    let place = LatLon::new(f64::from(x) / 1e7, f64::from(y) / 1e7).ok()?;
    ((x, y) != (0, 0)).then_some(place)
}

/// The height of an item above home, metres; none where that depends on the ground.
fn above_home_m(item: &Item, mission: &VehicleMission) -> Option<f64> {
    match frame::canonical(item.frame) {
        frame::GLOBAL_RELATIVE_ALT => Some(f64::from(item.z)),
        frame::GLOBAL => Some(f64::from(item.z) - f64::from(mission.home.amsl_m)),
        _ => None,
    }
}
