//! Landing patterns of `.plan` files, which hold no items: QGroundControl makes them when it sends
//! the plan (`LandingComplexItem::appendMissionItems`).

use super::node::Node;
use crate::formats::FormatError;
use crate::mission::{Item, command, frame};

/// Command of the landing and `version` of a pattern, by its `complexItemType`.
const PATTERNS: [(&str, u16, u64); 2] = [
    ("fwLandingPattern", command::NAV_LAND, 2),
    ("vtolLandingPattern", command::NAV_VTOL_LAND, 1),
];

/// Whether a complex item is a landing pattern.
pub(super) fn is_one(kind: &str) -> bool {
    PATTERNS.iter().any(|(name, ..)| *name == kind)
}

/// The items that QGroundControl sends for a landing pattern; none for another complex item.
///
/// # Errors
/// A version or a value that it would not read.
pub(super) fn items(node: &Node<'_>) -> Result<Option<Vec<Item>>, FormatError> {
    let kind = node.get("complexItemType");
    let pattern = PATTERNS
        .iter()
        .find(|(name, ..)| kind.value.as_str() == Some(name));
    let Some(&(_, landing, version)) = pattern else {
        return Ok(None);
    };
    node.get("version").expect_version(version)?;
    let frame = match node.get("altitudesAreRelative").flag()? {
        true => frame::GLOBAL_RELATIVE_ALT,
        false => frame::GLOBAL,
    };
    let at = |key: &str, command, params| {
        let place = node.get(key);
        let ((x, y), z) = place.place()?;
        let z = z.ok_or_else(|| place.bad("[latitude, longitude, altitude]"))?;
        Ok(Item {
            command,
            frame,
            autocontinue: true,
            params,
            x,
            y,
            z,
        })
    };
    // Absent in older files.
    let is_set = |key: &str| node.get(key).value == true;
    let mut items = vec![Item::without_place(command::DO_LAND_START, [0.0; 4])];
    if is_set("useDoChangeSpeed") {
        items.push(approach_speed(node)?);
    }
    if is_set("stopTakingPhotos") {
        let trigger = command::DO_SET_CAM_TRIGG_DIST;
        items.push(Item::without_place(trigger, [0.0; 4]));
        items.push(Item::without_place(command::IMAGE_STOP_CAPTURE, [0.0; 4]));
    }
    if is_set("stopVideoPhotos") {
        items.push(Item::without_place(command::VIDEO_STOP_CAPTURE, [0.0; 4]));
    }
    let approach = "landingApproachCoordinate";
    items.push(if node.get("useLoiterToAlt").flag()? {
        let radius_m = node.get("loiterRadius").float()?.abs();
        let signed_m = match node.get("loiterClockwise").flag()? {
            true => radius_m,
            false => -radius_m,
        };
        // It leaves the circle on its tangent, towards the landing.
        let params = [1.0, signed_m, 0.0, 1.0];
        at(approach, command::NAV_LOITER_TO_ALT, params)?
    } else {
        at(approach, command::NAV_WAYPOINT, [0.0; 4])?
    });
    items.push(at("landCoordinate", landing, [0.0; 4])?);
    Ok(Some(items))
}

/// The change to the airspeed of the approach, which the ground station hands over as an `int`.
fn approach_speed(node: &Node<'_>) -> Result<Item, FormatError> {
    let speed = node.get("finalApproachSpeed");
    let speed_mps = speed.float()?.trunc();
    if speed_mps.is_nan() {
        return Err(speed.bad("a speed in m/s"));
    }
    let params = [0.0, speed_mps, -1.0, 0.0];
    Ok(Item::without_place(command::DO_CHANGE_SPEED, params))
}
