//! Reads `.plan` files, those of ground stations included.

use serde_json::Value;

use super::mission_alone::Form;
use super::node::Node;
use super::unique_keys::UniqueKeys;
use super::{FIRMWARE, airframe, altitude_mode};
use super::{dropped, landing_pattern, mission_alone};
use crate::formats::document::{point_item, raised_item};
use crate::formats::{Document, FormatError, Repair, SourceLocation};
use crate::geodesy::LatLon;
use crate::mission::{Home, Item, command, frame};

/// Reads a mission with its fence and rally points, or the mission of a `.mission` file. Unknown keys
/// end in [`Document::dropped`].
///
/// Of a complex item its flown items are read (surveys and corridors). Landing patterns hold none:
/// those that QGroundControl sends are made. Structure scans are rejected.
///
/// # Errors
/// [`FormatError::Text`] when it is no JSON; [`FormatError::Json`] with the path, and
/// the item from 1, for everything else.
pub fn read(text: &str) -> Result<Document, FormatError> {
    let plain = text.strip_prefix('\u{feff}').unwrap_or(text);
    let UniqueKeys(plan) = serde_json::from_str(plain).map_err(|error| FormatError::Text {
        line: error.line(),
        column: error.column(),
        found: without_place(&error),
        allowed: "a JSON document".to_owned(),
    })?;
    let root = Node {
        value: &plan,
        at: String::new(),
        item: None,
    };
    if mission_alone::is_one(&plan) {
        return of_mission_alone(&root);
    }
    if root.value["fileType"] != "Plan" {
        return Err(root.get("fileType").bad("\"Plan\""));
    }
    root.get("version").expect_version(1)?;
    let mut document = Document {
        is_fence_known: true,
        dropped: dropped::of(&plan),
        ..Document::default()
    };
    if plain.len() != text.len() {
        document
            .repairs
            .push(repair("", "a byte order mark was left out"));
    }
    mission(&root.get("mission"), &mut document)?;
    for part in ["geoFence", "rallyPoints"] {
        let node = root.get(part);
        if node.value.is_null() {
            document
                .repairs
                .push(repair(part, "missing: taken as empty"));
        } else if part == "geoFence" {
            fence(&node, &mut document)?;
        } else {
            rally(&node, &mut document)?;
        }
    }
    Ok(document)
}

/// The mission of a file that holds nothing else.
fn of_mission_alone(root: &Node<'_>) -> Result<Document, FormatError> {
    let form = mission_alone::form(root)?;
    let mut document = Document {
        dropped: dropped::of_mission_alone(root.value),
        ..Document::default()
    };
    kind(root, form.firmware, &mut document);
    home(&form.home(root), &mut document)?;
    items(root, &form, &mut document)?;
    Ok(document)
}

fn repair(path: &str, what: &str) -> Repair {
    Repair {
        at: SourceLocation::Json(path.to_owned()),
        what: what.to_owned(),
    }
}

/// The text of a JSON error without its line and column, which are fields of their own.
fn without_place(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let place = format!(" at line {} column {}", error.line(), error.column());
    text.strip_suffix(&place).unwrap_or(&text).to_owned()
}

fn mission(node: &Node<'_>, document: &mut Document) -> Result<(), FormatError> {
    node.get("version").expect_version(2)?;
    kind(node, Form::PLAN.firmware, document);
    home(&node.get("plannedHomePosition"), document)?;
    items(node, &Form::PLAN, document)
}

fn items(node: &Node<'_>, form: &Form, document: &mut Document) -> Result<(), FormatError> {
    // Each item with the id that jumps name, in the order of rows.
    let mut rows = Vec::new();
    for (index, mut item) in node.get("items").list()?.into_iter().enumerate() {
        item.item = Some(index + 1);
        match item.value["type"].as_str() {
            Some(name) if form.simple.contains(&name) => {
                let read = simple_item(&item, document)?;
                rows.push((item.value[form.id].as_u64(), read));
            }
            Some("ComplexItem") => {
                if let Some(items) = landing_pattern::items(&item)? {
                    let what = "a landing pattern holds no items: those that QGroundControl sends";
                    document.repairs.push(repair(&item.at, what));
                    rows.extend(items.into_iter().map(|item| (None, item)));
                    continue;
                }
                let flown = item.get("TransectStyleComplexItem").get("Items");
                if flown.value.is_null() {
                    let kind = item.get("complexItemType");
                    return Err(kind.bad("a complex item with its flown items in the file"));
                }
                let inners = flown.list()?;
                if inners.is_empty() {
                    return Err(flown.bad("at least one flown item"));
                }
                for inner in inners {
                    let read = simple_item(&inner, document)?;
                    rows.push((inner.value["doJumpId"].as_u64(), read));
                }
            }
            _ => return Err(item.get("type").bad(form.types)),
        }
    }
    let ids: Vec<Option<u64>> = rows.iter().map(|(id, _)| *id).collect();
    for (_, item) in rows {
        document.items.push(resolved(item, &ids, form, node)?);
    }
    Ok(())
}

/// Home, or its place alone, or none: ground stations write `null` for unknown numbers.
fn home(node: &Node<'_>, document: &mut Document) -> Result<(), FormatError> {
    if node.value.is_null() {
        return Ok(());
    }
    let numbers = node.list()?;
    let [lat, lon, height] = numbers.as_slice() else {
        return Err(node.bad("[latitude, longitude, altitude above mean sea level]"));
    };
    let amsl_m = height.float()?;
    if lat.value.is_null() || lon.value.is_null() {
        let what = "latitude or longitude is null: no home position, it must come from --home";
        document.repairs.push(repair(&node.at, what));
        return Ok(());
    }
    let (x, y) = (lat.scaled(frame::GLOBAL)?, lon.scaled(frame::GLOBAL)?);
    if amsl_m.is_finite() {
        document.home = Some(Home { x, y, amsl_m });
    } else {
        let what = "the altitude is null: it must come from --home or the terrain";
        document.repairs.push(repair(&node.at, what));
        let place = LatLon::of_e7(x, y);
        document.home_place = LatLon::new(place.lat_deg, place.lon_deg).ok();
    }
    Ok(())
}

/// The autopilot and airframe of the mission; a repair for each that is not supported.
fn kind(node: &Node<'_>, firmware: &str, document: &mut Document) {
    let firmware = node.get(firmware);
    document.autopilot = FIRMWARE
        .iter()
        .find(|(number, _)| Some(*number) == firmware.value.as_u64())
        .map(|&(_, autopilot)| autopilot);
    if !firmware.value.is_null() && document.autopilot.is_none() {
        document.repairs.push(repair(
            &firmware.at,
            &format!(
                "{} is neither ArduPilot (3) nor PX4 (12): read as for whatever it is judged for",
                firmware.value
            ),
        ));
    }
    let Node {
        value: vehicle, at, ..
    } = node.get("vehicleType");
    document.airframe = vehicle.as_u64().and_then(airframe);
    if !vehicle.is_null() && document.airframe.is_none() {
        let what = format!(
            "{vehicle} is no multicopter, fixed wing or VTOL: read as for whatever it is judged for"
        );
        document.repairs.push(repair(&at, &what));
    }
}

/// DO_JUMP names a `doJumpId` or `id`; the document has rows.
fn resolved(
    mut item: Item,
    ids: &[Option<u64>],
    form: &Form,
    node: &Node<'_>,
) -> Result<Item, FormatError> {
    if item.command != command::DO_JUMP {
        return Ok(item);
    }
    let target = f64::from(item.params[0]);
    let named = |id: &Option<u64>| {
        id.and_then(|id| u32::try_from(id).ok())
            .is_some_and(|id| f64::from(id).to_bits() == target.to_bits())
    };
    let rows: Vec<u16> = ids
        .iter()
        .zip(1_u16..)
        .filter(|(id, _)| named(id))
        .map(|(_, row)| row)
        .collect();
    let [row] = rows[..] else {
        return Err(FormatError::Json {
            at: node.get("items").at,
            item: None,
            found: format!(
                "a jump to item {target}: the file has {} of that id",
                rows.len()
            ),
            allowed: form.target.to_owned(),
        });
    };
    item.params[0] = f32::from(row);
    Ok(item)
}

fn simple_item(node: &Node<'_>, document: &mut Document) -> Result<Item, FormatError> {
    let frame: u8 = node.get("frame").unsigned("0 to 255")?;
    let [a, b, c, d, x, y, z] = mission_alone::numbers(node)?;
    let item = Item {
        command: node.get("command").unsigned("0 to 65535")?,
        frame,
        autocontinue: match node.get("autoContinue").value {
            Value::Null => true,
            Value::Bool(flag) => *flag,
            _ => return Err(node.get("autoContinue").bad("true or false")),
        },
        params: [a.float()?, b.float()?, c.float()?, d.float()?],
        x: x.scaled(frame)?,
        y: y.scaled(frame)?,
        z: match z.value {
            Value::Null if frame == frame::MISSION => 0.0,
            _ => z.float()?,
        },
    };
    check_altitude(node, &item, document)?;
    Ok(item)
}

/// Compares the altitude and reference that the ground station shows with those flown
/// (`params[6]` and `frame`).
fn check_altitude(
    node: &Node<'_>,
    item: &Item,
    document: &mut Document,
) -> Result<(), FormatError> {
    let mode = node.get("AltitudeMode");
    let expected = match mode.value.as_u64() {
        None | Some(altitude_mode::NONE) => return Ok(()),
        Some(altitude_mode::RELATIVE) => frame::GLOBAL_RELATIVE_ALT,
        Some(altitude_mode::ABSOLUTE) => frame::GLOBAL,
        Some(altitude_mode::TERRAIN) => frame::GLOBAL_TERRAIN_ALT,
        // QGroundControl computes altitudes above the sea.
        Some(altitude_mode::CALCULATED)
            if item.z.is_finite() && frame::canonical(item.frame) != frame::GLOBAL =>
        {
            return Err(mode.bad("the reference of the item's frame"));
        }
        Some(altitude_mode::CALCULATED) if item.z.is_finite() => return Ok(()),
        Some(altitude_mode::CALCULATED) => {
            let z = node.get("params");
            return Err(z.bad("an altitude: it never was computed from terrain"));
        }
        Some(_) => return Err(mode.bad("0 to 4")),
    };
    if item.frame == frame::MISSION {
        let what = "ignored: a command in frame 2 has no altitude";
        document.repairs.push(repair(&mode.at, what));
        return Ok(());
    }
    if frame::canonical(item.frame) != expected {
        return Err(mode.bad("the reference of the item's frame"));
    }
    let shown = node.get("Altitude").float()?;
    if shown.is_finite() && shown.to_bits() != item.z.to_bits() {
        document.repairs.push(repair(
            &node.at,
            &format!(
                "Altitude {shown} is shown but params[6] {} is flown",
                item.z
            ),
        ));
    }
    Ok(())
}

fn fence(node: &Node<'_>, document: &mut Document) -> Result<(), FormatError> {
    let version = node.get("version");
    if version.value.is_null() || version.value == 1 {
        let what = format!(
            "{}: this fence is ignored, as QGroundControl does",
            version.value
        );
        document.repairs.push(repair(&version.at, &what));
        return Ok(());
    }
    version.expect_version(2)?;
    let breach = node.get("breachReturn");
    if !breach.value.is_null() {
        let (at, z) = breach.place()?;
        let item = raised_item(command::NAV_FENCE_RETURN_POINT, at, z.unwrap_or(0.0));
        document.fence.push(item);
    }
    for polygon in node.get("polygons").list()? {
        let command = if polygon.get("inclusion").flag()? {
            command::NAV_FENCE_POLYGON_VERTEX_INCLUSION
        } else {
            command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION
        };
        let corners = polygon.get("polygon").list()?;
        let count = u16::try_from(corners.len())
            .ok()
            .filter(|&count| count >= 3)
            .ok_or_else(|| polygon.get("polygon").bad("at least 3 corners"))?;
        for corner in corners {
            let (at, _) = corner.place()?;
            let item = point_item(command, f32::from(count), at);
            document.fence.push(item);
        }
    }
    for circle in node.get("circles").list()? {
        let command = if circle.get("inclusion").flag()? {
            command::NAV_FENCE_CIRCLE_INCLUSION
        } else {
            command::NAV_FENCE_CIRCLE_EXCLUSION
        };
        let circle = circle.get("circle");
        let (at, _) = circle.get("center").place()?;
        let radius_m = circle.get("radius").float()?;
        document.fence.push(point_item(command, radius_m, at));
    }
    Ok(())
}

fn rally(node: &Node<'_>, document: &mut Document) -> Result<(), FormatError> {
    let version = node.get("version");
    if version.value.is_null() || version.value == 1 {
        let what = format!(
            "{}: these rally points are ignored, as QGroundControl does",
            version.value
        );
        document.repairs.push(repair(&version.at, &what));
        return Ok(());
    }
    version.expect_version(2)?;
    for point in node.get("points").list()? {
        let (at, z) = point.place()?;
        let z = z.ok_or_else(|| point.bad("[latitude, longitude, altitude above home]"))?;
        let item = raised_item(command::NAV_RALLY_POINT, at, z);
        document.rally.push(item);
    }
    Ok(())
}
