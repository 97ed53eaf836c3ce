//! What an autopilot takes as one item, whatever stands around it.

use super::{Finding, Profile};
use crate::mission::item::{Item, command};

pub(crate) fn known_command(profile: &Profile, item: &Item) -> Option<Finding> {
    profile.rule(item).is_none().then(|| {
        (
            format!("command {}", item.command),
            "the commands this autopilot knows".to_owned(),
        )
    })
}

pub(crate) fn allowed_frame(profile: &Profile, item: &Item) -> Option<Finding> {
    let allowed = if profile.has_place(item) {
        profile.place_frames
    } else {
        profile.rule(item)?;
        profile.command_frames?
    };
    (!allowed.contains(&item.frame)).then(|| (format!("frame {}", item.frame), list(allowed)))
}

pub(crate) fn finite_parameters(profile: &Profile, item: &Item) -> Option<Finding> {
    let nan_allowed = profile.rule(item).map_or([false; 4], |rule| rule.nan);
    (0..4).find_map(|index| {
        let value = item.params[index];
        let nan_allowed = profile.any_nan || nan_allowed[index];
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

pub(crate) fn latitude(profile: &Profile, item: &Item) -> Option<Finding> {
    (profile.has_place(item) && item.x.unsigned_abs() > 900_000_000)
        .then(|| (degrees(item.x), "-90 to 90 degrees".to_owned()))
}

pub(crate) fn longitude(profile: &Profile, item: &Item) -> Option<Finding> {
    (profile.has_place(item) && item.y.unsigned_abs() > 1_800_000_000)
        .then(|| (degrees(item.y), "-180 to 180 degrees".to_owned()))
}

/// ArduPilot takes 0, 0 for "here"; PX4 flies to the Gulf of Guinea.
pub(crate) fn real_place(profile: &Profile, item: &Item) -> Option<Finding> {
    let goes = profile.has_place(item) && !profile.here.contains(&item.command);
    (goes && (item.x, item.y) == (0, 0)).then(|| {
        (
            "latitude 0, longitude 0".to_owned(),
            "a place on purpose".to_owned(),
        )
    })
}

pub(crate) fn altitude(profile: &Profile, item: &Item) -> Option<Finding> {
    let limit_m = profile.max_altitude_m;
    let fits = item.z.is_finite() && item.z.abs() < limit_m;
    (profile.has_place(item) && !fits)
        .then(|| (format!("{} m", item.z), format!("within {limit_m} m")))
}

pub(crate) fn hold_time(profile: &Profile, item: &Item) -> Option<Finding> {
    let holds = [command::NAV_WAYPOINT, command::NAV_LOITER_TIME].contains(&item.command);
    let hold_s = item.params[0];
    (holds && hold_s.is_finite() && !(0.0..=profile.max_hold_s).contains(&hold_s)).then(|| {
        (
            format!("{hold_s} s"),
            format!("0 to {} s", profile.max_hold_s),
        )
    })
}

/// A precision landing leaves the place of the item for that of a beacon, after a search for it.
pub(crate) fn precision_landing(profile: &Profile, item: &Item) -> Option<Finding> {
    let mode = item.params[1];
    let looks = item.command == command::NAV_LAND && profile.lands_by_beacon;
    (looks && mode.is_finite() && mode.abs() > 0.0).then(|| {
        (
            format!("param2 is {mode}"),
            "0: a landing at its place".to_owned(),
        )
    })
}

fn degrees(e7: i32) -> String {
    format!("{}", f64::from(e7) / 1e7)
}

fn list(frames: &[u8]) -> String {
    let names: Vec<String> = frames.iter().map(u8::to_string).collect();
    format!("frame {}", names.join(", "))
}
