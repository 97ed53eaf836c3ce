//! The fence and the rally points of a spec as items.

use super::encode::{Encoder, degrees_e7, up};
use crate::autopilot::{command, frame};
use crate::geodesy::LatLon;
use crate::mission::item::Item;
use crate::spec::{MissionSpec, Zone};
use crate::world::{NoData, World};

/// Fence items: the area, zones without a height, threats. In the order in which
/// a `.plan` keeps them: polygons, then circles.
pub(crate) fn fence(spec: &MissionSpec) -> Vec<Item> {
    let pieces = pieces(spec);
    pieces.into_iter().flat_map(|(_, items)| items).collect()
}

/// How many fence items a spec needs; none if it wants no fence.
#[must_use]
pub fn fence_needs(spec: &MissionSpec) -> usize {
    match spec.mission.fence {
        true => fence(spec).len(),
        false => 0,
    }
}

/// Each boundary of a spec's fence with its name, such as `threat radar-1`.
fn pieces(spec: &MissionSpec) -> Vec<(String, Vec<Item>)> {
    let area = polygon(command::FENCE_POLYGON_INCLUSION, &spec.area.outline());
    let mut pieces = vec![("area".to_owned(), area)];
    let mut circles = Vec::new();
    for zone in spec.no_fly.iter().filter(|zone| is_encoded(zone)) {
        let name = format!("zone {}", zone.id);
        match zone.circle {
            Some((center, radius_m)) => circles.push((name, vec![circle(center, radius_m)])),
            None => {
                let corners = polygon(command::FENCE_POLYGON_EXCLUSION, &zone.polygon);
                pieces.push((name, corners));
            }
        }
    }
    pieces.append(&mut circles);
    for threat in &spec.threats {
        let circle = circle(threat.place, threat.radius_m);
        pieces.push((format!("threat {}", threat.id), vec![circle]));
    }
    pieces
}

/// Whether a zone can be in a fence, which has no height, no time and no holes.
fn is_encoded(zone: &Zone) -> bool {
    zone.is_closed_throughout() && zone.holes.is_empty()
}

/// An exclusion circle.
fn circle(center: LatLon, radius_m: f64) -> Item {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a radius is float32 on the wire"
    )]
    let radius_m = radius_m as f32;
    corner(command::FENCE_CIRCLE_EXCLUSION, radius_m, center)
}

/// Names of what the spec wants in a fence (its area, zones without a height,
/// threats) and these fence items do not hold.
#[must_use]
pub fn missing_from_fence(spec: &MissionSpec, fence: &[Item]) -> Vec<String> {
    let held = boundaries(fence);
    pieces(spec)
        .into_iter()
        .filter(|(_, required)| !held.iter().any(|items| holds(items, required)))
        .map(|(name, _)| name)
        .collect()
}

/// Splits fence items into boundaries: a circle is one item, a polygon as many as its first says.
fn boundaries(mut fence: &[Item]) -> Vec<&[Item]> {
    let mut found = Vec::new();
    while let Some(first) = fence.first() {
        let is_polygon = [
            command::FENCE_POLYGON_INCLUSION,
            command::FENCE_POLYGON_EXCLUSION,
        ]
        .contains(&first.command);
        let corners = (1_u16..)
            .zip(fence)
            .take_while(|(number, item)| {
                item.command == first.command && f32::from(*number) <= first.params[0]
            })
            .count();
        let (boundary, rest) = fence.split_at(if is_polygon { corners.max(1) } else { 1 });
        found.push(boundary);
        fence = rest;
    }
    found
}

/// Two points of a fence are the same within this, 1e-7 degrees: 5 cm.
const SAME_PLACE_E7: u32 = 5;
/// A circle may be this much smaller than the threat it keeps out of, metres.
const RADIUS_M: f32 = 0.01;

/// Whether a boundary is the required one: its corners in either direction from any of them, a
/// circle no smaller.
fn holds(boundary: &[Item], required: &[Item]) -> bool {
    let is = |item: &Item, required: &Item| {
        item.command == required.command
            && item.x.abs_diff(required.x) <= SAME_PLACE_E7
            && item.y.abs_diff(required.y) <= SAME_PLACE_E7
            && item.params[0] >= required.params[0] - RADIUS_M
    };
    let around = |first: usize| required.iter().cycle().skip(first).take(required.len());
    boundary.len() == required.len()
        && (0..required.len()).any(|first| {
            let mut ahead = boundary.iter().zip(around(first));
            let mut back = boundary.iter().rev().zip(around(first));
            ahead.all(|(item, corner)| is(item, corner))
                || back.all(|(item, corner)| is(item, corner))
        })
}

/// What the fence leaves out, one sentence for each zone: fences are two-dimensional.
pub(crate) fn not_encoded(spec: &MissionSpec) -> Vec<String> {
    spec.no_fly
        .iter()
        .filter(|zone| !is_encoded(zone))
        .map(|zone| match zone.is_closed_throughout() {
            true => format!(
                "zone {} has holes; a fence has none, so it is not in the fence",
                zone.id
            ),
            false => format!(
                "zone {} is closed {zone} only; a fence has no height and no time, so it is not in the fence",
                zone.id
            ),
        })
        .collect()
}

/// Rally items, altitudes above home in whole metres rounded up (ArduPilot keeps no more).
pub(crate) fn rally(
    spec: &MissionSpec,
    world: &World,
    encoder: &Encoder<'_>,
) -> Result<Vec<Item>, NoData> {
    spec.rally
        .iter()
        .map(|rally| {
            let amsl = rally.agl.over(world.terrain.height(rally.place)?);
            let mut item = corner(command::RALLY_POINT, 0.0, rally.place);
            item.frame = frame::GLOBAL_RELATIVE_ALT;
            item.z = up(amsl.above_home(encoder.home_amsl()).0);
            Ok(item)
        })
        .collect()
}

/// Each corner carries the number of corners in `param1`.
fn polygon(command: u16, corners: &[LatLon]) -> Vec<Item> {
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^24 corners")]
    let count = corners.len() as f32;
    corners
        .iter()
        .map(|&place| corner(command, count, place))
        .collect()
}

fn corner(command: u16, param1: f32, place: LatLon) -> Item {
    let (x, y) = degrees_e7(place);
    Item {
        command,
        frame: frame::GLOBAL,
        // Means nothing here; vehicles return it as 0.
        autocontinue: false,
        params: [param1, 0.0, 0.0, 0.0],
        x,
        y,
        z: 0.0,
    }
}
