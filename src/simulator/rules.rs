//! Acceptance of items at upload.

use crate::autopilot::{
    Airframe, Autopilot, CommandRule, Location, command, command_row, facts, frame,
};
use crate::link::{MissionResult, MissionType};
use crate::mission::Item;

/// Latitude and longitude in 1e-7 degrees.
const MAX_LATITUDE: i32 = 900_000_000;
const MAX_LONGITUDE: i32 = 1_800_000_000;

/// The rule for a mission item in the version that the simulated vehicle plays.
fn rule(autopilot: Autopilot, item: &Item) -> Option<&'static CommandRule> {
    let rule = command_row(item.command)?.rule(autopilot)?;
    let version = autopilot.conventions().measured;
    rule.versions.contains(version).then_some(rule)
}

/// Whether a fence or rally item is of its list.
fn is_of(list: MissionType, number: u16) -> bool {
    match list {
        MissionType::Mission => false,
        MissionType::Fence => (command::NAV_FENCE_RETURN_POINT
            ..=command::NAV_FENCE_CIRCLE_EXCLUSION)
            .contains(&number),
        MissionType::Rally => number == command::NAV_RALLY_POINT,
    }
}

/// ArduPilot: frame, then parameters, then place.
pub(crate) fn ardupilot(
    list: MissionType,
    item: &Item,
    seq: u16,
    count: u16,
) -> Result<(), MissionResult> {
    let rule = rule(Autopilot::ArduPilot, item).filter(|_| list == MissionType::Mission);
    if rule.is_none() && !is_of(list, item.command) {
        return Err(MissionResult::UNSUPPORTED);
    }
    let is_placed = rule.is_none_or(|rule| rule.location != Location::None);
    let canonical = frame::canonical(item.frame);
    if is_placed && ![0, 2, 3, 10].contains(&canonical)
        || (list != MissionType::Mission && canonical == frame::MISSION)
    {
        return Err(MissionResult::UNSUPPORTED_FRAME);
    }
    let may_be_nan = rule.map_or([false; 4], |rule| rule.nan);
    for ((code, value), may_be_nan) in (6..).zip(item.params).zip(may_be_nan) {
        if value.is_nan() && !may_be_nan {
            return Err(MissionResult(code));
        }
    }
    if is_placed {
        if item.x.abs() > MAX_LATITUDE {
            return Err(MissionResult::INVALID_PARAM5_X);
        }
        if item.y.abs() > MAX_LONGITUDE {
            return Err(MissionResult::INVALID_PARAM6_Y);
        }
        let acceptance = facts(Autopilot::ArduPilot, Airframe::Copter).acceptance;
        if item.z.is_nan() || item.z.abs() >= acceptance.max_altitude_m {
            return Err(MissionResult::INVALID_PARAM7);
        }
    }
    let target = item.params[0];
    if item.command == command::DO_JUMP && seq > 0 && !(1.0..f32::from(count)).contains(&target) {
        return Err(MissionResult::ERROR);
    }
    Ok(())
}

/// PX4 looks at command and frame only: NaN altitudes and impossible locations pass.
pub(crate) fn px4(list: MissionType, item: &Item) -> Result<(), MissionResult> {
    let acceptance = facts(Autopilot::Px4, Airframe::Copter).acceptance;
    let is_global = acceptance.location_frames.contains(&item.frame);
    if list != MissionType::Mission {
        return match (is_global, is_of(list, item.command)) {
            (false, _) => Err(MissionResult::UNSUPPORTED_FRAME),
            (true, false) => Err(MissionResult::UNSUPPORTED),
            (true, true) => Ok(()),
        };
    }
    match rule(Autopilot::Px4, item) {
        Some(rule) if rule.has_location(item.frame) && !is_global => {
            Err(MissionResult::UNSUPPORTED_FRAME)
        }
        Some(rule) if !rule.has_location(item.frame) && item.frame != frame::MISSION => {
            Err(MissionResult::UNSUPPORTED)
        }
        Some(_) => Ok(()),
        None => Err(MissionResult::UNSUPPORTED),
    }
}

/// Whether the corners of each polygon follow each other, and each states their number.
pub(crate) fn fence_is_consistent(items: &[Item]) -> bool {
    let mut rest = items;
    while let Some(first) = rest.first() {
        let corners = match first.command {
            command::NAV_FENCE_POLYGON_VERTEX_INCLUSION
            | command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION => match whole(first.params[0]) {
                Some(corners @ 3..) => corners,
                _ => return false,
            },
            _ => 1,
        };
        let same = |item: &Item| {
            item.command == first.command
                && (corners == 1 || whole(item.params[0]) == Some(corners))
        };
        match rest.split_at_checked(corners) {
            Some((polygon, after)) if polygon.iter().all(same) => rest = after,
            _ => return false,
        }
    }
    true
}

fn whole(value: f32) -> Option<usize> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to be a small whole number"
    )]
    (value.fract().abs() <= 0.0 && (0.0..65536.0).contains(&value)).then_some(value as usize)
}

/// CRC-32 (IEEE 802.3) over the items, PX4's id for a list; 0 is taken for "no list".
pub(crate) fn opaque_id(items: &[Item]) -> u32 {
    if items.is_empty() {
        return 0;
    }
    let mut crc = u32::MAX;
    let mut digest = |bytes: &[u8]| {
        for byte in bytes {
            crc ^= u32::from(*byte);
            for _ in 0..8 {
                let carry = crc & 1;
                crc = (crc >> 1) ^ (0xEDB8_8320 * carry);
            }
        }
    };
    for item in items {
        digest(&item.command.to_le_bytes());
        digest(&[item.frame, u8::from(item.autocontinue)]);
        item.params
            .iter()
            .for_each(|param| digest(&param.to_le_bytes()));
        digest(&item.x.to_le_bytes());
        digest(&item.y.to_le_bytes());
        digest(&item.z.to_le_bytes());
    }
    !crc
}
