//! Rules for planes and vtol alone.

use super::whole::commands;
use super::{Finding, Profile};
use crate::autopilot::{command, frame};
use crate::mission::item::{Item, VehicleMission};
use crate::mission::params::STEEPEST_GLIDE;

/// PX4 accepts a glide that is steeper than its limit by this, for rounding, degrees.
const GLIDE_SLACK_DEG: f64 = 0.1;
/// ArduPlane stores the second and third parameter of a waypoint in a byte each.
const MAX_BYTE: f32 = 255.0;

/// A QuadPlane climbs by the altitude of its takeoff: with an altitude above the sea it would
/// climb by the height of the place above the sea as well.
pub(crate) fn takeoff_frame(profile: &Profile, item: &Item) -> Option<Finding> {
    let is_above_home = frame::canonical(item.frame) == frame::GLOBAL_RELATIVE_ALT;
    let climbs =
        profile.facts.acceptance.takeoff_above_home && item.command == command::NAV_VTOL_TAKEOFF;
    (climbs && !is_above_home).then(|| {
        (
            format!("frame {}, read as a height above home", item.frame),
            "frame 3, 6".to_owned(),
        )
    })
}

/// ArduPlane continues at once: the start of the mission must be delayed instead.
pub(crate) fn departure_delay(profile: &Profile, item: &Item) -> Option<Finding> {
    (profile.facts.acceptance.never_waits && item.command == command::NAV_DELAY).then(|| {
        (
            "NAV_DELAY, which is over at once".to_owned(),
            "a start of the mission at the departure".to_owned(),
        )
    })
}

/// ArduPlane drops the hold of a waypoint and truncates radii to whole metres.
pub(crate) fn whole_numbers(profile: &Profile, item: &Item) -> Option<Finding> {
    if !profile.facts.acceptance.whole_numbers {
        return None;
    }
    let [hold_s, radius_m, pass_m, _] = item.params;
    let is_whole = |value: f32| value.fract().abs() <= 0.0;
    let in_byte = |value: f32| is_whole(value) && (0.0..=MAX_BYTE).contains(&value);
    let finding = |index: usize, allowed: &str| {
        Some((
            format!("param{} is {}", index + 1, item.params[index]),
            allowed.to_owned(),
        ))
    };
    match item.command {
        command::NAV_WAYPOINT if hold_s.abs() > 0.0 => finding(0, "0: a plane does not hold"),
        command::NAV_WAYPOINT if radius_m.is_finite() && !in_byte(radius_m) => {
            finding(1, "a whole number from 0 to 255")
        }
        command::NAV_WAYPOINT if pass_m.is_finite() && !in_byte(pass_m) => {
            finding(2, "a whole number from 0 to 255")
        }
        command::NAV_LOITER_UNLIM if pass_m.is_finite() && !is_whole(pass_m) => {
            finding(2, "a whole number")
        }
        _ => None,
    }
}

/// A QuadPlane is not armed where a landing comes too soon behind a waypoint for it to slow down ("VTOL land too short",
/// `AP_Arming_Plane::mission_checks`): three quarters of what it needs from its landing or cruise speed to rest.
pub(crate) fn stopping_distance(
    profile: &Profile,
    mission: &VehicleMission,
) -> Option<(usize, Finding)> {
    const SHARE: f64 = 0.75;
    let decel = profile.facts.parameter("Q_TRANS_DECEL")?;
    let decel_mps2 = mission.param_si(decel.name).unwrap_or(decel.default_si());
    let landing_mps = mission
        .param("TECS_LAND_ARSPD")
        .filter(|speed_mps| *speed_mps > 0.0);
    let speed_mps = landing_mps.or_else(|| mission.param_or_default_si("AIRSPEED_CRUISE"))?;
    let min_m = SHARE * speed_mps * speed_mps / (2.0 * decel_mps2);
    let lands = |item: &Item| {
        let landings = [
            command::NAV_VTOL_LAND,
            command::NAV_LAND,
            command::NAV_PAYLOAD_PLACE,
        ];
        landings.contains(&item.command)
    };
    let mut pairs = mission.items.windows(2).zip(2..);
    pairs.find_map(|(pair, row)| {
        if pair[0].command != command::NAV_WAYPOINT || !lands(&pair[1]) {
            return None;
        }
        let away_m = pair[0].place()?.chord_m(pair[1].place()?);
        (away_m < min_m).then(|| {
            let found = format!("a landing {away_m:.1} m behind the waypoint before it");
            let allowed = format!(
                "at least {min_m:.1} m, to slow down from {speed_mps} m/s with {} {decel_mps2}: ArduPlane is not armed otherwise",
                decel.name
            );
            (row, (found, allowed))
        })
    })
}

/// PX4 rejects a second start of a landing, one after the last landing, and a return after it.
pub(crate) fn land_start(profile: &Profile, mission: &VehicleMission) -> Option<(usize, Finding)> {
    if !profile.facts.acceptance.one_land_start {
        return None;
    }
    let at = |is_it: fn(u16) -> bool| {
        let items = mission.items.iter().enumerate();
        items
            .filter(move |(_, item)| is_it(item.command))
            .map(|(index, _)| index)
    };
    let mut starts = at(|of| of == command::DO_LAND_START);
    let start = starts.next()?;
    let finding = |index: usize, found: &str, allowed: &str| {
        Some((index + 1, (found.to_owned(), allowed.to_owned())))
    };
    if let Some(second) = starts.next() {
        return finding(second, "a second DO_LAND_START", "one");
    }
    if let Some(index) = at(|of| of == command::NAV_RETURN_TO_LAUNCH).find(|of| *of > start) {
        return finding(index, "a return after DO_LAND_START", "none");
    }
    let lands = |of: u16| [command::NAV_LAND, command::NAV_VTOL_LAND].contains(&of);
    match at(lands).any(|index| index > start) {
        true => None,
        false => finding(
            start,
            "DO_LAND_START and no landing after it",
            "a landing after it",
        ),
    }
}

/// PX4 rejects a fixed-wing landing unless the item before it is a waypoint (or a circle
/// to an altitude) above it, no steeper than its parameter allows.
pub(crate) fn landing_approach(
    profile: &Profile,
    mission: &VehicleMission,
) -> Option<(usize, Finding)> {
    if !profile.facts.acceptance.needs_approach {
        return None;
    }
    let is_landing = |item: &Item| item.command == command::NAV_LAND;
    let index = mission.items.iter().position(is_landing)?;
    let finding = |found: String, allowed: String| Some((index + 1, (found, allowed)));
    let Some(before) = index.checked_sub(1).map(|before| mission.items[before]) else {
        return finding(
            "a landing and nothing before it".to_owned(),
            "a waypoint before it".to_owned(),
        );
    };
    if ![command::NAV_WAYPOINT, command::NAV_LOITER_TO_ALT].contains(&before.command) {
        return finding(
            format!("command {} before the landing", before.command),
            commands(&[command::NAV_WAYPOINT, command::NAV_LOITER_TO_ALT]),
        );
    }
    let landing = mission.items[index];
    let amsl_m = |item: &Item| match frame::canonical(item.frame) {
        frame::GLOBAL => f64::from(item.z),
        _ => f64::from(item.z) + f64::from(mission.home.amsl_m),
    };
    let height_m = amsl_m(&before) - amsl_m(&landing);
    if height_m <= 0.0 {
        return finding(
            format!("an approach from {height_m:.1} m above the landing"),
            "from above".to_owned(),
        );
    }
    // Without the parameters the limit is not known.
    let steepest_deg = mission.param(STEEPEST_GLIDE)?;
    let length_m = before.place()?.chord_m(landing.place()?);
    let glide_deg = height_m.atan2(length_m).to_degrees();
    if before.command == command::NAV_WAYPOINT && glide_deg > steepest_deg + GLIDE_SLACK_DEG {
        return finding(
            format!("a glide of {glide_deg:.1} degrees"),
            format!("at most {steepest_deg:.1} degrees ({STEEPEST_GLIDE})"),
        );
    }
    None
}
