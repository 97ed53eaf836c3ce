//! Writes `.plan` files.

use serde_json::{Map, Value, json};

use super::{FIRMWARE, altitude_mode};
use crate::formats::document::rows;
use crate::formats::text::number::{scale, shortest};
use crate::mission::{Item, VehicleMission, command, frame};
use crate::spec::Airframe;

/// The mission, its fence and its rally points as JSON text.
///
/// NaN is `null`; numbers that are whole are written so (some readers have integers
/// there); `geoFence` and `rallyPoints` are always present (MAVSDK fails without).
#[must_use]
pub fn write(mission: &VehicleMission) -> String {
    let plan = json!({
        "fileType": "Plan",
        "version": 1,
        "groundStation": "Sortie",
        "mission": mission_part(mission),
        "geoFence": fence(&mission.fence),
        "rallyPoints": {
            "version": 2,
            "points": mission.rally.iter().map(place_and_height).collect::<Vec<_>>(),
        },
    });
    format!("{plan:#}\n")
}

fn mission_part(mission: &VehicleMission) -> Value {
    let firmware = FIRMWARE
        .iter()
        .find(|(_, autopilot)| *autopilot == mission.autopilot)
        .map_or(0, |&(firmware, _)| firmware);
    let speed_mps = cruise_mps(mission);
    json!({
        "version": 2,
        "firmwareType": firmware,
        "vehicleType": vehicle_type(mission.airframe),
        "cruiseSpeed": speed_mps,
        "hoverSpeed": speed_mps,
        "globalPlanAltitudeMode": overall_mode(&mission.items),
        "plannedHomePosition": [
            degrees(mission.home.x),
            degrees(mission.home.y),
            number(mission.home.amsl_m),
        ],
        "items": rows(mission).enumerate().map(|(index, item)| simple_item(index + 1, &item)).collect::<Vec<_>>(),
    })
}

/// `MAV_TYPE`: one quadrotor, fixed wing or quad-VTOL stands for all of its kind.
fn vehicle_type(airframe: Airframe) -> u8 {
    match airframe {
        Airframe::Copter => 2,
        Airframe::Plane => 1,
        Airframe::Vtol => 20,
    }
}

/// The ground speed that the mission states, or a copter's default: for the
/// ground station's estimate of duration only.
fn cruise_mps(mission: &VehicleMission) -> Value {
    let item = mission
        .items
        .iter()
        .find(|item| item.command == command::DO_CHANGE_SPEED)
        .map(|item| item.params[1]);
    let parameter = mission
        .params
        .iter()
        .find(|parameter| ["MPC_XY_CRUISE", "FW_AIRSPD_TRIM"].contains(&parameter.name.as_str()))
        .map(|parameter| parameter.value);
    number(item.or(parameter).unwrap_or(5.0))
}

fn simple_item(row: usize, item: &Item) -> Value {
    let scaled = |value: i32| whole_if_possible(f64::from(value) / scale(item.frame));
    let mut params: Vec<Value> = item.params.iter().map(|&value| number(value)).collect();
    params.extend([scaled(item.x), scaled(item.y), number(item.z)]);
    let mut object = Map::new();
    if let Some(mode) = mode(item.frame) {
        object.insert("AMSLAltAboveTerrain".to_owned(), Value::Null);
        object.insert("Altitude".to_owned(), number(item.z));
        object.insert("AltitudeMode".to_owned(), mode.into());
    }
    object.insert("autoContinue".to_owned(), item.autocontinue.into());
    object.insert("command".to_owned(), item.command.into());
    object.insert("doJumpId".to_owned(), row.into());
    object.insert("frame".to_owned(), item.frame.into());
    object.insert("params".to_owned(), params.into());
    object.insert("type".to_owned(), "SimpleItem".into());
    Value::Object(object)
}

fn mode(item_frame: u8) -> Option<u64> {
    match frame::canonical(item_frame) {
        frame::GLOBAL => Some(altitude_mode::ABSOLUTE),
        frame::GLOBAL_RELATIVE_ALT => Some(altitude_mode::RELATIVE),
        frame::GLOBAL_TERRAIN_ALT => Some(altitude_mode::TERRAIN),
        _ => None,
    }
}

/// The mode of all items with a place, or "mixed".
fn overall_mode(items: &[Item]) -> u64 {
    let mut modes = items.iter().filter_map(|item| mode(item.frame));
    let first = modes.next().unwrap_or(altitude_mode::NONE);
    if modes.all(|mode| mode == first) {
        first
    } else {
        altitude_mode::NONE
    }
}

fn fence(items: &[Item]) -> Value {
    let mut polygons = Vec::new();
    let mut circles = Vec::new();
    let mut object = Map::new();
    let mut rest = items;
    while let Some((first, others)) = rest.split_first() {
        rest = others;
        match first.command {
            command::NAV_FENCE_POLYGON_VERTEX_INCLUSION
            | command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION => {
                let corners = corner_count(first, others);
                let (corners, after) = others.split_at(corners - 1);
                rest = after;
                let outline: Vec<Value> =
                    std::iter::once(first).chain(corners).map(place).collect();
                polygons.push(json!({
                    "inclusion": first.command == command::NAV_FENCE_POLYGON_VERTEX_INCLUSION,
                    "polygon": outline,
                    "version": 1,
                }));
            }
            command::NAV_FENCE_CIRCLE_INCLUSION | command::NAV_FENCE_CIRCLE_EXCLUSION => {
                circles.push(json!({
                    "circle": { "center": place(first), "radius": number(first.params[0]) },
                    "inclusion": first.command == command::NAV_FENCE_CIRCLE_INCLUSION,
                    "version": 1,
                }));
            }
            command::NAV_FENCE_RETURN_POINT => {
                object.insert("breachReturn".to_owned(), place_and_height(first));
            }
            _ => {}
        }
    }
    object.insert("circles".to_owned(), circles.into());
    object.insert("polygons".to_owned(), polygons.into());
    object.insert("version".to_owned(), 2.into());
    Value::Object(object)
}

/// Corners of the polygon that begins here: as many as it says, if that many follow.
pub(in crate::formats) fn corner_count(first: &Item, others: &[Item]) -> usize {
    let run = 1 + others
        .iter()
        .take_while(|item| item.command == first.command)
        .count();
    (1..=run)
        .find(|&count| {
            u16::try_from(count)
                .is_ok_and(|count| f32::from(count).to_bits() == first.params[0].to_bits())
        })
        .unwrap_or(run)
}

fn place(item: &Item) -> Value {
    json!([degrees(item.x), degrees(item.y)])
}

fn place_and_height(item: &Item) -> Value {
    json!([degrees(item.x), degrees(item.y), number(item.z)])
}

fn degrees(e7: i32) -> Value {
    whole_if_possible(f64::from(e7) / 1e7)
}

fn number(value: f32) -> Value {
    whole_if_possible(shortest(value))
}

/// `null` for what is no number.
fn whole_if_possible(value: f64) -> Value {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "compared with the original"
    )]
    let whole = value as i64;
    #[expect(
        clippy::cast_precision_loss,
        reason = "compared with the original, bit by bit: minus zero stays a float"
    )]
    let same = (whole as f64).to_bits() == value.to_bits();
    if same {
        whole.into()
    } else {
        serde_json::Number::from_f64(value).map_or(Value::Null, Value::Number)
    }
}
