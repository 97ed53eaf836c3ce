//! The fence and the rally points of a spec as items.

use super::encode::{Encoder, degrees_e7, up};
use super::item::{Item, command, frame};
use crate::geodesy::LatLon;
use crate::spec::MissionSpec;
use crate::world::{NoData, World};

/// Fence items: the area, zones without a height, threats. In the order in which
/// a `.plan` keeps them: polygons, then circles.
pub(super) fn fence(spec: &MissionSpec) -> Vec<Item> {
    let mut items = polygon(command::FENCE_POLYGON_INCLUSION, &spec.area.outline());
    for zone in spec.no_fly.iter().filter(|zone| zone.below.is_none()) {
        items.extend(polygon(command::FENCE_POLYGON_EXCLUSION, &zone.polygon));
    }
    for threat in &spec.threats {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a radius is float32 on the wire"
        )]
        let radius_m = threat.radius_m as f32;
        items.push(corner(
            command::FENCE_CIRCLE_EXCLUSION,
            radius_m,
            threat.place,
        ));
    }
    items
}

/// What the fence leaves out, one sentence for each zone: fences are two-dimensional.
pub(super) fn not_encoded(spec: &MissionSpec) -> Vec<String> {
    spec.no_fly
        .iter()
        .filter_map(|zone| {
            let below = zone.below?;
            Some(format!(
                "zone {} is closed below {} m only; a fence has no height, so it is not in the fence",
                zone.id, below.0
            ))
        })
        .collect()
}

/// Rally items, altitudes above home in whole metres rounded up (ArduPilot keeps no more).
pub(super) fn rally(
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
