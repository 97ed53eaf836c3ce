//! Rules for one item, whatever the others are.

use super::whole::commands;
use super::{Finding, Profile};
use crate::autopilot::{command, command_row, frame};
use crate::mission::item::Item;

pub(crate) fn known_command(profile: &Profile, item: &Item) -> Option<Finding> {
    if profile.rule(item).is_some() {
        return None;
    }
    let row = command_row(item.command);
    let allowed = match row.and_then(|row| row.rule(profile.autopilot)) {
        Some(rule) => format!("in {} {}", profile.autopilot.name(), rule.versions),
        None => "the commands this autopilot knows".to_owned(),
    };
    let name = row.map_or_else(String::new, |row| format!(" ({})", row.name));
    Some((format!("command {}{name}", item.command), allowed))
}

pub(crate) fn allowed_frame(profile: &Profile, item: &Item) -> Option<Finding> {
    let rules = &profile.facts.acceptance;
    let allowed = if profile.has_location(item) {
        rules.location_frames
    } else {
        profile.rule(item)?;
        rules.command_frames?
    };
    (!allowed.contains(&item.frame)).then(|| (format!("frame {}", item.frame), list(allowed)))
}

pub(crate) fn finite_parameters(profile: &Profile, item: &Item) -> Option<Finding> {
    let nan_allowed = profile.rule(item).map_or([false; 4], |rule| rule.nan);
    (0..4).find_map(|index| {
        let value = item.params[index];
        let nan_allowed = profile.facts.acceptance.any_nan || nan_allowed[index];
        if value.is_finite() || (value.is_nan() && nan_allowed) {
            return None;
        }
        let allowed = if nan_allowed {
            "a number or NaN"
        } else {
            "a number"
        };
        Some((format!("param{} is {value}", index + 1), allowed.to_owned()))
    })
}

/// A number in a parameter that the autopilot does not read. `i32::MAX` is none in latitude and longitude, and in
/// frames with a location 0 is a number there. Nothing more is said of an item in a wrong frame.
pub(crate) fn unread_parameters(profile: &Profile, item: &Item) -> Option<Finding> {
    let reads = profile.facts.acceptance.reads?;
    let is_refused = [known_command, allowed_frame, parameter_values]
        .iter()
        .any(|check| check(profile, item).is_some());
    let mut versions = profile.versions.iter();
    if is_refused || !versions.any(|version| reads.versions.contains(*version)) {
        return None;
    }
    let is_placed = item.frame != frame::MISSION;
    let given = |e7: i32| (e7 != i32::MAX && (is_placed || e7 != 0)).then(|| degrees(e7));
    let written = |value: f32| (value.abs() > 0.0).then(|| value.to_string());
    let [p1, p2, p3, p4] = item.params.map(written);
    let values = [
        p1,
        p2,
        p3,
        p4,
        given(item.x),
        given(item.y),
        written(item.z),
    ];
    (1..).zip(values).find_map(|(param, value)| {
        let found = format!("param{param} is {}", value?);
        let allowed = || (found, format!("0 or NaN: {}", reads.source));
        reads.refuses(item.command, param).then(allowed)
    })
}

/// Values that the row of the command rejects in one of the versions.
pub(crate) fn parameter_values(profile: &Profile, item: &Item) -> Option<Finding> {
    let [p1, p2, p3, p4] = item.params;
    profile.rule(item)?.params.iter().find_map(|rule| {
        let value = match rule.param {
            1 => p1,
            2 => p2,
            3 => p3,
            4 => p4,
            _ => item.z,
        };
        let versions = &mut profile.versions.iter();
        let applies = rule.frame.is_none_or(|frame| frame == item.frame)
            && versions.any(|version| rule.versions.contains(*version));
        (applies && rule.rejected.holds(value)).then(|| {
            let found = format!("param{} is {value}", rule.param);
            (
                found,
                format!("{}: {}", rule.rejected.allowed(), rule.source),
            )
        })
    })
}

pub(crate) fn latitude(profile: &Profile, item: &Item) -> Option<Finding> {
    (profile.checks_location(item) && item.x.unsigned_abs() > 900_000_000)
        .then(|| (degrees(item.x), "-90 to 90 degrees".to_owned()))
}

pub(crate) fn longitude(profile: &Profile, item: &Item) -> Option<Finding> {
    (profile.checks_location(item) && item.y.unsigned_abs() > 1_800_000_000)
        .then(|| (degrees(item.y), "-180 to 180 degrees".to_owned()))
}

/// ArduPilot reads 0, 0 as the present place, or as none; PX4 flies to the Gulf of Guinea.
pub(crate) fn real_place(profile: &Profile, item: &Item) -> Option<Finding> {
    let acceptance = &profile.facts.acceptance;
    let means_it = |commands: &[u16]| commands.contains(&item.command);
    let may_be_zero = means_it(acceptance.zero_is_here) || means_it(acceptance.zero_is_no_place);
    let is_zero = (item.x, item.y) == (0, 0);
    (is_zero && profile.has_location(item) && !may_be_zero).then(|| {
        (
            "latitude 0, longitude 0".to_owned(),
            "a location other than 0, 0".to_owned(),
        )
    })
}

pub(crate) fn altitude(profile: &Profile, item: &Item) -> Option<Finding> {
    let limit_m = profile.facts.acceptance.max_altitude_m;
    let fits = item.z.is_finite() && item.z.abs() < limit_m;
    (profile.checks_location(item) && !fits)
        .then(|| (format!("{} m", item.z), format!("within {limit_m} m")))
}

pub(crate) fn hold_time(profile: &Profile, item: &Item) -> Option<Finding> {
    let holds = [command::NAV_WAYPOINT, command::NAV_LOITER_TIME].contains(&item.command);
    let (hold_s, max_s) = (item.params[0], profile.facts.acceptance.max_hold_s);
    (holds && hold_s.is_finite() && !(0.0..=max_s).contains(&hold_s))
        .then(|| (format!("{hold_s} s"), format!("0 to {max_s} s")))
}

/// A precision landing goes from the place of the item to that of a beacon, after a search for it.
pub(crate) fn precision_landing(profile: &Profile, item: &Item) -> Option<Finding> {
    let mode = item.params[1];
    let searches = item.command == command::NAV_LAND && profile.facts.acceptance.precision_landing;
    (searches && mode.is_finite() && mode.abs() > 0.0).then(|| {
        (
            format!("param2 is {mode}"),
            "0: a landing at its place".to_owned(),
        )
    })
}

/// With another command for landing the vehicle skips the item, or flies it as if it were of
/// another kind.
pub(crate) fn kind_of_landing(profile: &Profile, item: &Item) -> Option<Finding> {
    let landings = profile.facts.acceptance.landings;
    let lands = [command::NAV_LAND, command::NAV_VTOL_LAND].contains(&item.command);
    (lands && !landings.contains(&item.command)).then(|| {
        let allowed = format!("{} for this airframe", commands(landings));
        (format!("command {}", item.command), allowed)
    })
}

fn degrees(e7: i32) -> String {
    format!("{}", f64::from(e7) / 1e7)
}

fn list(frames: &[u8]) -> String {
    let names: Vec<String> = frames.iter().map(u8::to_string).collect();
    format!("frame {}", names.join(", "))
}
