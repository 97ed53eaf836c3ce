//! Changes of speed beyond the limits that the parameters of an autopilot have by default.

use crate::autopilot::{Airframe, Autopilot, parameter};
use crate::mission::{Item, Parameter, VehicleMission, command};
use crate::verify::{Limit, Margin};

/// The changes of speed that count in flight, with their places among the items: those before the
/// takeoff of a VTOL of PX4 are for its rotors.
pub(super) fn changes(
    items: &[Item],
    who: (Autopilot, Airframe),
) -> impl Iterator<Item = (usize, &Item)> {
    let takes_off = |item: &Item| item.command == command::NAV_VTOL_TAKEOFF;
    let first = match who {
        (Autopilot::Px4, Airframe::Vtol) => items.iter().position(takes_off).unwrap_or(0),
        _ => 0,
    };
    let later = items.iter().enumerate().skip(first);
    later.filter(|(_, item)| item.command == command::DO_CHANGE_SPEED)
}

/// A parameter that limits the speed and that nothing next to the mission says, with its default, m/s.
fn default_mps(
    mission: &VehicleMission,
    name: Option<&'static str>,
) -> Option<(&'static str, f64)> {
    let name = name.filter(|name| mission.param(name).is_none())?;
    Some((name, parameter(name)?.default_si()))
}

/// Limits the speed of a copter to the default of its autopilot where the mission asks for more.
pub(super) fn limit(mission: &mut VehicleMission, id: &str, assumed: &mut Vec<String>) {
    let [_, most] = mission.facts().defaults.speed_parameters;
    let Some((name, max_mps)) = default_mps(mission, most) else {
        return;
    };
    let mut changes = changes(&mission.items, (mission.autopilot, mission.airframe));
    let cruise_mps = mission.param_si(mission.facts().defaults.cruise_parameter);
    let is_above = changes.any(|(_, item)| f64::from(item.params[1]) > max_mps)
        || cruise_mps.is_some_and(|mps| mps > max_mps);
    if mission.airframe.has_wing() || !is_above {
        return;
    }
    assumed.push(format!(
        "{id}: flies no faster than {name} {max_mps}, the default of {}",
        mission.autopilot.name()
    ));
    #[expect(clippy::cast_possible_truncation, reason = "parameters are float32")]
    let value = max_mps as f32;
    mission.params.push(Parameter {
        name: name.to_owned(),
        value,
        why: "the default of the autopilot".to_owned(),
    });
}

/// The margin that fails for the first airspeed that a wing flies only if its parameters have other
/// limits than by default: ArduPlane ignores it (`Plane::do_change_speed`), PX4 flies the limit.
pub(super) fn beyond_limits(mission: &VehicleMission, id: &str) -> Option<Margin> {
    if !mission.airframe.has_wing() {
        return None;
    }
    let [least, most] = mission.facts().defaults.speed_parameters;
    let [least, most] = [least, most].map(|name| default_mps(mission, name));
    let beyond = |item: &Item| {
        let mps = f64::from(item.params[1]);
        let is_less = least.filter(|(_, limit_mps)| mps > 0.0 && mps < *limit_mps);
        is_less.or(most.filter(|(_, limit_mps)| mps > *limit_mps))
    };
    let sets_airspeed =
        |item: &Item| mission.autopilot == Autopilot::Px4 || item.params[0].trunc().abs() < 0.5;
    let mut changes = changes(&mission.items, (mission.autopilot, mission.airframe));
    let (index, item, (name, limit_mps)) = changes.find_map(|(index, item)| {
        let limit = beyond(item).filter(|_| sets_airspeed(item))?;
        Some((index, item, limit))
    })?;
    let does = match mission.autopilot {
        Autopilot::ArduPilot => "ignores it",
        Autopilot::Px4 => "flies that",
    };
    let why = format!(
        "mission item {}: airspeed: {} m/s, and {name} is {limit_mps} by default: {} {does} (allowed: within the \
         limits, or those of the aircraft in parameters next to the mission); judged as obeyed",
        index + 1,
        item.params[1],
        mission.autopilot.name()
    );
    Some(Margin::unjudged(id, Limit::Acceptance, why))
}
