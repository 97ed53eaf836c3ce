//! Geometry that lies far from where the vehicles fly, as swapped coordinates do.

use crate::geodesy::LatLon;
use crate::mission::{Item, VehicleMission};
use crate::spec::MissionSpec;

/// Geometry further away than this is named, metres.
const FAR_M: f64 = 20_000.0;
/// Nearer geometry is named if it were nearer by this factor when swapped.
const MUCH_NEARER: f64 = 20.0;
/// Geometry nearer than this is never named, metres.
const NEAR_M: f64 = 2_000.0;

/// Where vehicles fly: south-west and north-east corner.
type Bounds = (LatLon, LatLon);

/// What of a spec, and of the fences and rally points of missions, lies far from the area: a
/// sentence each.
#[must_use]
pub fn distant_from_area(spec: &MissionSpec, missions: &[(usize, &VehicleMission)]) -> Vec<String> {
    let area = (spec.area.south_west, spec.area.north_east);
    let threats = spec.threats.iter();
    let threats = threats.map(|threat| (format!("threat {}", threat.id), vec![threat.place]));
    // Files of airspace hold what is far away.
    let zones = spec.no_fly.iter().filter(|zone| zone.source.is_none());
    let zones = zones.map(|zone| (format!("zone {}", zone.id), zone.polygon.clone()));
    let rally = spec.rally.iter().enumerate();
    let rally = rally.map(|(index, point)| (format!("rally {}", index + 1), vec![point.place]));
    let of_spec = threats.chain(zones).chain(rally);
    let found = of_spec.filter_map(|(what, points)| sentence(&what, &points, area, "the area"));
    let of_missions = missions.iter().flat_map(|(vehicle, mission)| {
        let id = spec
            .vehicles
            .get(*vehicle)
            .map_or("", |vehicle| &vehicle.id);
        let lists = [("fence", &mission.fence), ("rally points", &mission.rally)];
        lists.into_iter().filter_map(move |(list, items)| {
            let what = format!("{id}: {list}");
            sentence(&what, &furthest(items, area), area, "the area")
        })
    });
    found.chain(of_missions).collect()
}

/// What of missions lies far from their homes: a sentence for each list of each vehicle.
#[must_use]
pub fn distant_from_home(spec: &MissionSpec, missions: &[(usize, &VehicleMission)]) -> Vec<String> {
    let of_mission = |(vehicle, mission): &(usize, &VehicleMission)| {
        let Some(vehicle) = spec.vehicles.get(*vehicle) else {
            return Vec::new();
        };
        let home = (vehicle.home, vehicle.home);
        let lists = [
            ("items", &mission.items),
            ("fence", &mission.fence),
            ("rally points", &mission.rally),
        ];
        let found = lists.into_iter().filter_map(|(list, items)| {
            let what = format!("{}: {list}", vehicle.id);
            sentence(&what, &furthest(items, home), home, "home")
        });
        found.collect()
    };
    missions.iter().flat_map(of_mission).collect()
}

/// The place of a list that lies furthest away; none of 0, 0, which means no place.
fn furthest(items: &[Item], bounds: Bounds) -> Vec<LatLon> {
    let points = items.iter().filter(|item| (item.x, item.y) != (0, 0));
    let points = points.filter_map(Item::place);
    let by_distance = |a: &LatLon, b: &LatLon| away_m(*a, bounds).total_cmp(&away_m(*b, bounds));
    points.max_by(by_distance).into_iter().collect()
}

/// A sentence on geometry whose nearest corner is far away, or would be much nearer swapped.
fn sentence(what: &str, points: &[LatLon], bounds: Bounds, of: &str) -> Option<String> {
    let least = |points: &mut dyn Iterator<Item = LatLon>| {
        let away = points.map(|place| away_m(place, bounds));
        away.fold(f64::INFINITY, f64::min)
    };
    let now_m = least(&mut points.iter().copied());
    let swapped_m = least(&mut points.iter().filter_map(|place| swapped(*place)));
    let size_m = bounds.0.chord_m(bounds.1);
    let is_swapped = now_m > NEAR_M.max(size_m) && swapped_m * MUCH_NEARER < now_m;
    if points.is_empty() || !(is_swapped || now_m > FAR_M + size_m) {
        return None;
    }
    let hint = match is_swapped {
        true => format!(
            ": with latitude and longitude swapped it would be {:.1} km",
            swapped_m / 1000.0
        ),
        false => String::new(),
    };
    let away_km = now_m / 1000.0;
    Some(format!("{what}: {away_km:.0} km from {of}{hint}"))
}

fn swapped(place: LatLon) -> Option<LatLon> {
    LatLon::new(place.lon_deg, place.lat_deg).ok()
}

/// Straight distance to the nearest place within the bounds, metres.
fn away_m(place: LatLon, (south_west, north_east): Bounds) -> f64 {
    let nearest = LatLon {
        lat_deg: place.lat_deg.clamp(south_west.lat_deg, north_east.lat_deg),
        lon_deg: place.lon_deg.clamp(south_west.lon_deg, north_east.lon_deg),
    };
    place.chord_m(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(lat_deg: f64, lon_deg: f64) -> LatLon {
        LatLon { lat_deg, lon_deg }
    }

    #[test]
    fn swapped_coordinates_near_45_degrees_are_named_with_their_distance() {
        let area = (at(45.0, 43.2), at(45.1, 43.4));
        let found = sentence("zone town", &[at(43.3, 45.05)], area, "the area");
        let found = found.expect("it is far");
        assert!(
            found.starts_with("zone town: 230 km from the area"),
            "{found}"
        );
        assert!(found.ends_with("swapped it would be 0.0 km"), "{found}");
        // Where both are nearly the same, the distance is small and still many times greater.
        let area = (at(45.000, 45.060), at(45.010, 45.070));
        let found = sentence("zone town", &[at(45.065, 45.005)], area, "the area");
        assert!(found.is_some_and(|found| found.contains("swapped")));
    }

    #[test]
    fn geometry_near_the_area_or_that_no_swap_brings_near_is_not_said_to_be_swapped() {
        let area = (at(45.0, 43.2), at(45.1, 43.4));
        for near in [at(45.05, 43.3), at(45.2, 43.5), at(44.9, 43.3)] {
            assert_eq!(sentence("zone", &[near], area, "the area"), None);
        }
        let found = sentence("zone", &[at(46.5, 43.3)], area, "the area").expect("far");
        assert!(
            found.contains("156 km") && !found.contains("swapped"),
            "{found}"
        );
    }
}
