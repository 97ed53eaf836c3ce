//! The ceiling, the floor and the circle around home that parameters set: a vehicle that comes to them
//! leaves its mission.

use super::{AcceptanceProblem, Finding, MissionType, Profile};
use crate::autopilot::{self, frame};
use crate::geodesy::LatLon;
use crate::mission::item::{Item, VehicleMission};
use crate::numeric::digits::float32;

/// The rule, in a few words.
pub(super) const RULE: &str = "fence of the parameters";
/// What is at the fence is beyond it (`AC_Fence::check_fence_alt_max`); altitudes are whole centimetres.
const AT_FENCE_M: f64 = 0.01;

/// What the parameters of a mission set: metres above home, metres around it.
pub(crate) struct Fence {
    names: autopilot::ParamFence,
    /// Whether more comes of it than a report.
    pub(crate) acts: bool,
    pub(crate) ceiling_m: Option<f64>,
    radius_m: Option<f64>,
    /// The floor, and from which height on it counts.
    floor_m: Option<(f64, f64)>,
}

/// The first item that lies beyond the fence of the mission's parameters.
pub(crate) fn inside(profile: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    let fence = Fence::of(mission).filter(|fence| fence.acts)?;
    let home = place(mission.home.x, mission.home.y);
    mission.items.iter().enumerate().find_map(|(index, item)| {
        let at = place(item.x, item.y).filter(|_| profile.has_location(item))?;
        let away_m = home.map(|home| home.chord_m(at));
        let found = fence.beyond(above_home_m(item, mission), away_m)?;
        Some((index + 1, found))
    })
}

impl AcceptanceProblem {
    /// That a vehicle comes to the fence of its parameters on its way to an item.
    pub(crate) fn param_fence(item: usize, (found, allowed): Finding) -> Self {
        Self {
            list: MissionType::Mission,
            item,
            rule: RULE,
            found,
            allowed,
        }
    }

    /// Whether it is that of [`Self::param_fence`].
    pub(crate) fn is_param_fence(&self) -> bool {
        self.rule == RULE
    }
}

impl Fence {
    /// The fence of a mission's parameters, if it is on, or an item of the mission switches it on.
    pub(crate) fn of(mission: &VehicleMission) -> Option<Self> {
        let names = mission.facts().param_fence;
        let is_set = |name: &&str| mission.param(name).is_some_and(|value| value.abs() > 0.0);
        let switches_on = |item: &Item| {
            names.command.is_some_and(|(command, value)| {
                item.command == command && (item.params[0].trunc() - value).abs() < 0.5
            })
        };
        let is_on = names.switches.is_empty()
            || names.switches.iter().any(is_set)
            || mission.items.iter().any(switches_on);
        if !is_on {
            return None;
        }
        let kinds = names.kinds.map_or(u8::MAX.into(), |(name, default)| {
            mission.param(name).unwrap_or(default.into())
        });
        let limit_m = |(bit, name): (u8, &str)| {
            let bit = f64::from(bit);
            let limit_m = mission.param_or_default_si(name)?;
            (kinds.rem_euclid(2.0 * bit) >= bit).then_some(limit_m)
        };
        let some_m = |kind| limit_m(kind).filter(|limit_m| *limit_m > 0.0);
        let margin_m = mission.param_or_default_si("FENCE_MARGIN").unwrap_or(0.0);
        Some(Self {
            names,
            acts: mission
                .param(names.action)
                .is_none_or(|value| value.abs() > 0.0),
            ceiling_m: some_m(names.ceiling),
            radius_m: some_m(names.circle),
            floor_m: (names.floor.and_then(limit_m)).map(|floor_m| (floor_m, floor_m + margin_m)),
        })
    }

    /// What of a height above home and a distance from it, metres, is not inside, and what is allowed.
    pub(crate) fn beyond(&self, above_m: Option<f64>, away_m: Option<f64>) -> Option<Finding> {
        if let (Some(ceiling_m), Some(above_m)) = (self.ceiling_m, above_m)
            && above_m > ceiling_m - AT_FENCE_M
        {
            let allowed = format!("below {} m ({})", float32(ceiling_m), self.names.ceiling.1);
            return Some((format!("{above_m:.1} m above home"), allowed));
        }
        let (radius_m, away_m) = (self.radius_m?, away_m?);
        (away_m > radius_m - AT_FENCE_M).then(|| {
            let allowed = format!("within {} m ({})", float32(radius_m), self.names.circle.1);
            (format!("{away_m:.0} m from home"), allowed)
        })
    }

    /// Whether a floor counts from this height above home on, metres (`AC_Fence::auto_enable_fence_floor`).
    pub(crate) fn floor_counts_from(&self, above_m: f64) -> bool {
        self.floor_m.is_some_and(|(_, from_m)| above_m >= from_m)
    }

    /// That a height above home, metres, is not above the floor, and what is allowed.
    pub(crate) fn below(&self, above_m: f64) -> Option<Finding> {
        let (floor_m, _) = self.floor_m?;
        let name = self.names.floor?.1;
        (above_m < floor_m + AT_FENCE_M).then(|| {
            let allowed = format!("above {} m ({name})", float32(floor_m));
            (format!("{above_m:.1} m above home"), allowed)
        })
    }
}

/// The place of 1e-7 degrees; 0, 0 is none.
fn place(x: i32, y: i32) -> Option<LatLon> {
    let place = LatLon::new(f64::from(x) / 1e7, f64::from(y) / 1e7).ok()?;
    ((x, y) != (0, 0)).then_some(place)
}

/// The height of an item above home, metres; none where that depends on the ground.
pub(crate) fn above_home_m(item: &Item, mission: &VehicleMission) -> Option<f64> {
    match frame::canonical(item.frame) {
        frame::GLOBAL_RELATIVE_ALT => Some(f64::from(item.z)),
        frame::GLOBAL => Some(f64::from(item.z) - f64::from(mission.home.amsl_m)),
        _ => None,
    }
}
