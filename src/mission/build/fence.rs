//! The fence and the rally points of a spec as items.

mod clear;
mod fit;

use super::encode::{Encoder, degrees_e7, up};
use crate::autopilot::{command, frame};
use crate::geodesy::LatLon;
use crate::mission::item::Item;
use crate::numeric::geometry::cover::twice_area;
use crate::spec::{MissionSpec, Vehicle, Zone, dome_of};
use crate::world::{NoData, World};
use clear::{Clear, Plane, Shape};
use fit::Piece;

/// Seconds at top speed beyond which a boundary may be left out of a full fence.
pub const FENCE_REACH_S: f64 = 60.0;
/// Boundaries that a note names.
const MAX_NAMED: usize = 3;

/// One boundary of a spec's fence.
struct Boundary<'a> {
    /// Such as `threat radar-1`.
    name: String,
    items: Vec<Item>,
    outline: Outline<'a>,
}

/// The shape of a boundary.
enum Outline<'a> {
    /// What a vehicle stays inside of.
    Area,
    Polygon(&'a [LatLon]),
    Circle(LatLon, f64),
}

/// Fence items of one vehicle, and what they do not say, in sentences: the area, zones without a
/// height, threats. In the order in which a `.plan` keeps them: polygons, then circles. `flown`
/// are the items of its mission.
pub(crate) fn fence(
    spec: &MissionSpec,
    vehicle: &Vehicle,
    flown: &[Item],
) -> (Vec<Item>, Vec<String>) {
    let boundaries = boundaries(spec);
    let needs: usize = boundaries.iter().map(|boundary| boundary.items.len()).sum();
    let mut notes = not_encoded(spec);
    if needs <= vehicle.fence_capacity() {
        let items = boundaries.into_iter().flat_map(|boundary| boundary.items);
        return (items.collect(), notes);
    }
    let (items, more) = fitted(spec, vehicle, flown, &boundaries);
    notes.extend(more);
    (items, notes)
}

/// How many fence items a spec needs; none if it wants no fence.
#[must_use]
pub fn fence_needs(spec: &MissionSpec) -> usize {
    match spec.mission.fence {
        true => boundaries(spec).iter().map(|b| b.items.len()).sum(),
        false => 0,
    }
}

/// Each boundary of a spec's fence.
fn boundaries(spec: &MissionSpec) -> Vec<Boundary<'_>> {
    let mut found = vec![Boundary {
        name: "area".to_owned(),
        items: polygon(
            command::NAV_FENCE_POLYGON_VERTEX_INCLUSION,
            &spec.area.outline(),
        ),
        outline: Outline::Area,
    }];
    let mut circles = Vec::new();
    let circle_named = |name: String, center: LatLon, radius_m: f64| Boundary {
        name,
        items: vec![circle(center, radius_m)],
        outline: Outline::Circle(center, radius_m),
    };
    for zone in spec.no_fly.iter().filter(|zone| zone.fits_fence()) {
        let name = format!("zone {}", zone.id);
        match zone.circle {
            Some((center, radius_m)) => circles.push(circle_named(name, center, radius_m)),
            None => found.push(Boundary {
                name,
                items: polygon(command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION, &zone.polygon),
                outline: Outline::Polygon(&zone.polygon),
            }),
        }
    }
    found.append(&mut circles);
    let threats = spec.threats.iter();
    found.extend(threats.map(|threat| {
        let name = format!("threat {}", threat.id);
        circle_named(name, threat.place, threat.radius_m)
    }));
    found
}

/// The fence within what the vehicle keeps.
fn fitted(
    spec: &MissionSpec,
    vehicle: &Vehicle,
    flown: &[Item],
    boundaries: &[Boundary<'_>],
) -> (Vec<Item>, Vec<String>) {
    let plane = Plane::new(spec.area.south_west, spec.area.north_east);
    let clear = clear(spec, vehicle, flown, &plane);
    let capacity = vehicle.fence_capacity();
    let reach_m = FENCE_REACH_S * vehicle.top_speed_mps();
    let mut items: Vec<Item> = Vec::new();
    let mut exclusions: Vec<&Boundary<'_>> = Vec::new();
    let mut pieces = Vec::new();
    for boundary in boundaries {
        let shape = match boundary.outline {
            Outline::Area => {
                items.extend(&boundary.items);
                continue;
            }
            Outline::Circle(center, radius_m) => plane.disc(center, radius_m),
            Outline::Polygon(corners) => {
                let mut corners: Vec<_> = corners.iter().map(|&at| plane.flat(at)).collect();
                if twice_area(&corners) < 0.0 {
                    corners.reverse();
                }
                Shape::Polygon(corners)
            }
        };
        exclusions.push(boundary);
        pieces.push(Piece::new(shape, &clear));
    }
    let left = capacity.saturating_sub(items.len());
    // The verdict measures from what is flown, which leaves the legs by the tolerance.
    let far_m = plane.at_least_m(reach_m) + spec.mission.tolerance_m + clear.bend_m + FAR_M;
    let covers = fit::fit(&pieces, (&plane, &clear), (left, far_m));
    let mut circles = Vec::new();
    for cover in &covers {
        let exact = cover.pieces.first().map(|&piece| &exclusions[piece].items);
        let wider = cover.wider.as_ref().map(|shape| encoded(shape, &plane));
        let written = wider.or_else(|| exact.cloned()).unwrap_or_default();
        match written.len() {
            1 => circles.extend(written),
            _ => items.extend(written),
        }
    }
    items.append(&mut circles);
    let mut left_out: Vec<(f64, &str)> = (pieces.iter().zip(&exclusions).enumerate())
        .filter(|(index, _)| !covers.iter().any(|cover| cover.pieces.contains(index)))
        .map(|(_, (piece, boundary))| (piece.distance_m, boundary.name.as_str()))
        .collect();
    left_out.sort_by(|a, b| a.0.total_cmp(&b.0));
    let wider = covers.iter().filter(|cover| cover.wider.is_some());
    let wider = wider.map(|cover| cover.pieces.len()).sum();
    let notes = notes(vehicle, (pieces.len(), wider), &left_out);
    (items, notes)
}

/// Distance by which this measure and that of the verdict may differ, metres.
const FAR_M: f64 = 50.0;

/// Where wider boundaries must not be.
fn clear(spec: &MissionSpec, vehicle: &Vehicle, flown: &[Item], plane: &Plane) -> Clear {
    let home = plane.flat(vehicle.home);
    let mut route = vec![home];
    for item in flown {
        match item.command {
            command::NAV_RETURN_TO_LAUNCH => route.push(home),
            // Something to look at.
            command::DO_SET_ROI_LOCATION => {}
            _ => route.extend(item.place().map(|place| plane.flat(place))),
        }
    }
    let pads: Vec<_> = (spec.rally.iter())
        .map(|rally| plane.flat(rally.place))
        .collect();
    let turn_m = vehicle.wing.map_or(0.0, |wing| wing.loiter_radius_m);
    let keep_m = spec.fence_margin_m() + spec.mission.tolerance_m + turn_m;
    Clear::new(&route, &pads, plane, plane.at_least_m(keep_m))
}

/// What the fence is instead of the spec's.
fn notes(vehicle: &Vehicle, (all, wider): (usize, usize), left_out: &[(f64, &str)]) -> Vec<String> {
    let capacity = vehicle.fence_capacity();
    let mut notes = Vec::new();
    if !left_out.is_empty() {
        let named = left_out.iter().take(MAX_NAMED);
        let named: Vec<String> = named
            .map(|(distance_m, name)| format!("{name} ({distance_m:.0} m)"))
            .collect();
        let more = match left_out.len().checked_sub(MAX_NAMED) {
            Some(more @ 1..) => format!(" and {more} more"),
            _ => String::new(),
        };
        let (speed_mps, count) = (vehicle.top_speed_mps(), left_out.len());
        let reach_m = FENCE_REACH_S * speed_mps;
        notes.push(format!(
            "the fence keeps {capacity} items: {count} of {all} zones and threats are left out, each more than \
             {FENCE_REACH_S} s at {speed_mps:.1} m/s ({reach_m:.0} m) from the path and every way back: {}{more}",
            named.join(", ")
        ));
    }
    if wider > 0 {
        notes.push(format!(
            "the fence keeps {capacity} items: {wider} of {all} zones and threats are inside of wider, simpler boundaries"
        ));
    }
    notes
}

/// The items of a wider boundary.
fn encoded(shape: &Shape, plane: &Plane) -> Vec<Item> {
    match shape {
        Shape::Circle(center, radius_m) => vec![circle(plane.place(*center), *radius_m)],
        Shape::Polygon(corners) => {
            let corners: Vec<LatLon> = corners.iter().map(|&at| plane.place(at)).collect();
            polygon(command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION, &corners)
        }
    }
}

/// The items of each exclusion of a spec's fence, with its name, such as `threat radar-1`, and
/// first those of its area.
#[must_use]
pub fn fence_pieces(spec: &MissionSpec) -> Vec<(String, Vec<Item>)> {
    let all = boundaries(spec).into_iter();
    all.map(|boundary| (boundary.name, boundary.items))
        .collect()
}

/// An exclusion circle.
fn circle(center: LatLon, radius_m: f64) -> Item {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a radius is float32 on the wire"
    )]
    let radius_m = radius_m as f32;
    corner(command::NAV_FENCE_CIRCLE_EXCLUSION, radius_m, center)
}

/// Zones that the fence leaves out have a sentence each up to this number.
const MAX_SENTENCES: usize = 8;

/// What the fence leaves out, one sentence for each zone or dome, or for all of many zones: fences are
/// two-dimensional.
fn not_encoded(spec: &MissionSpec) -> Vec<String> {
    let left_out = || spec.no_fly.iter().filter(|zone| !zone.fits_fence());
    let are_many = left_out().filter(|zone| dome_of(zone).is_none()).count() > MAX_SENTENCES;
    let (many, each): (Vec<&Zone>, Vec<&Zone>) =
        left_out().partition(|zone| are_many && dome_of(zone).is_none());
    let sentence = |zone: &Zone| match (dome_of(zone), zone.is_closed_throughout()) {
        (Some(id), _) => format!(
            "threat {id} is a dome; a fence has no height and no time, so it is not in the fence"
        ),
        (None, true) => format!(
            "zone {} has holes; a fence has none, so it is not in the fence",
            zone.id
        ),
        (None, false) => format!(
            "zone {} is closed {zone} only; a fence has no height and no time, so it is not in the fence",
            zone.id
        ),
    };
    let mut sentences: Vec<String> = each.into_iter().map(sentence).collect();
    // The layers of a dome follow each other.
    sentences.dedup();
    if are_many {
        let ids: Vec<&str> = many.iter().map(|zone| zone.id.as_str()).collect();
        sentences.push(format!(
            "{} zones have a height, a time or holes; a fence has none, so they are not in the fence: {}",
            ids.len(),
            ids.join(", ")
        ));
    }
    sentences
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
            let mut item = corner(command::NAV_RALLY_POINT, 0.0, rally.place);
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
