//! Which items an autopilot takes, at upload.

use crate::link::{List, MissionResult};
use crate::mission::{Item, command, frame};

/// Latitude and longitude in 1e-7 degrees.
const MOST_LATITUDE: i32 = 900_000_000;
const MOST_LONGITUDE: i32 = 1_800_000_000;
/// ArduPilot refuses altitudes from here on, metres.
const MOST_ALTITUDE_M: f32 = 83_000.0;

/// `MAV_CMD`s that the simulated autopilots know as mission items.
fn is_known(number: u16) -> bool {
    matches!(number,
        16..=22 | 30 | 31 | 82..=85 | 92..=94 | 112..=115 | 176..=223 | 2000..=2003 | 3000)
}

/// Commands that go to a place.
fn has_place(number: u16) -> bool {
    matches!(number, 16..=19 | 21 | 22 | 31 | 82 | 84 | 85 | 195 | 201)
}

/// ArduPilot: frame, then parameters, then place.
pub(crate) fn ardupilot(
    list: List,
    item: &Item,
    seq: u16,
    count: u16,
) -> Result<(), MissionResult> {
    let known = match list {
        List::Mission => is_known(item.command),
        List::Fence => (5000..=5004).contains(&item.command),
        List::Rally => item.command == command::RALLY_POINT,
    };
    if !known {
        return Err(MissionResult::UNSUPPORTED);
    }
    let is_placed = list != List::Mission || has_place(item.command);
    let canonical = frame::canonical(item.frame);
    if is_placed && ![0, 2, 3, 10].contains(&canonical)
        || (list != List::Mission && canonical == frame::MISSION)
    {
        return Err(MissionResult::UNSUPPORTED_FRAME);
    }
    let yaw_may_be_nan = matches!(item.command, 16 | 21 | 22 | 84);
    for (index, code) in [6, 7, 8, 9].into_iter().enumerate() {
        if item.params[index].is_nan() && !(index == 3 && yaw_may_be_nan) {
            return Err(MissionResult(code));
        }
    }
    if is_placed {
        if item.x.abs() > MOST_LATITUDE {
            return Err(MissionResult::INVALID_PARAM5_X);
        }
        if item.y.abs() > MOST_LONGITUDE {
            return Err(MissionResult::INVALID_PARAM6_Y);
        }
        if item.z.is_nan() || item.z.abs() >= MOST_ALTITUDE_M {
            return Err(MissionResult::INVALID_PARAM7);
        }
    }
    let target = item.params[0];
    if item.command == command::DO_JUMP && seq > 0 && !(1.0..f32::from(count)).contains(&target) {
        return Err(MissionResult::ERROR);
    }
    Ok(())
}

/// PX4 looks at command and frame only: NaN altitudes and impossible places pass.
pub(crate) fn px4(list: List, item: &Item) -> Result<(), MissionResult> {
    let global = matches!(item.frame, 0 | 3 | 5 | 6);
    match list {
        List::Mission if !is_known(item.command) => Err(MissionResult::UNSUPPORTED),
        List::Mission if has_place(item.command) && !global => {
            Err(MissionResult::UNSUPPORTED_FRAME)
        }
        List::Mission if !has_place(item.command) && item.frame != frame::MISSION => {
            Err(MissionResult::UNSUPPORTED)
        }
        List::Fence | List::Rally if !global => Err(MissionResult::UNSUPPORTED_FRAME),
        List::Fence if !(5000..=5004).contains(&item.command) => Err(MissionResult::UNSUPPORTED),
        List::Rally if item.command != command::RALLY_POINT => Err(MissionResult::UNSUPPORTED),
        _ => Ok(()),
    }
}

/// The corners of each polygon stand together, and each says how many they are.
pub(crate) fn fence_is_consistent(items: &[Item]) -> bool {
    let mut rest = items;
    while let Some(first) = rest.first() {
        let corners = match first.command {
            command::FENCE_POLYGON_INCLUSION | command::FENCE_POLYGON_EXCLUSION => {
                match whole(first.params[0]) {
                    Some(corners @ 3..) => corners,
                    _ => return false,
                }
            }
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
