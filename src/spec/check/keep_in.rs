//! Zones to stay in: what lies outside of all of them is closed.

use geo::orient::{Direction, Orient};
use geo::{Coord, LineString, MultiPolygon, Polygon, unary_union};

use super::super::{Area, Zone};
use super::Checker;
use crate::geodesy::{LatLon, LocalFrame, in_plane_m};

/// How far the closed ground around zones to stay in reaches beyond the area, degrees.
const BEYOND_DEG: f64 = 0.05;

impl Checker {
    /// A zone to stay in; one with a floor, a ceiling or times is reported, because it holds always.
    pub(super) fn check_keep_in(&mut self, path: &str, zone: Zone) -> Option<Zone> {
        if !zone.is_closed_throughout() {
            let found = "a zone to stay in with a floor, a ceiling or times";
            self.report(path, found, "keep_in at all heights and times");
            return None;
        }
        Some(zone)
    }
}

/// The zones that are closed where one must stay in the union of others; none if there are none.
pub(super) fn outside(of: &[Zone], area: &Area) -> Vec<Zone> {
    let Some(first) = of.first() else {
        return Vec::new();
    };
    let allowed: MultiPolygon<f64> = match of {
        [one] => polygon(one).into(),
        _ => unary_union(&of.iter().map(polygon).collect::<Vec<_>>()),
    };
    let names: Vec<&str> = of.iter().map(|zone| zone.id.as_str()).collect();
    let name = match names.len() {
        1 => format!("outside {}", first.id),
        _ => format!("outside {} and {} more", first.id, names.len() - 1),
    };
    let exteriors = allowed.iter().map(|part| corners(part.exterior()));
    let around = Zone {
        holes: exteriors.collect(),
        source: Some(format!("to stay in: {}", names.join(", "))),
        ..Zone::closed(name.clone(), surroundings(area))
    };
    let holes = allowed.iter().flat_map(Polygon::interiors);
    let holes = (1..).zip(holes).map(|(number, hole): (u32, _)| {
        Zone::closed(format!("{name}, hole {number}"), corners(hole))
    });
    std::iter::once(around).chain(holes).collect()
}

/// The box around the area, and a little more.
fn surroundings(area: &Area) -> Vec<LatLon> {
    let wider = |of: LatLon, by_deg: f64| LatLon {
        lat_deg: (of.lat_deg + by_deg).clamp(-90.0, 90.0),
        lon_deg: (of.lon_deg + by_deg).clamp(-180.0, 180.0),
    };
    let area = Area {
        south_west: wider(area.south_west, -BEYOND_DEG),
        north_east: wider(area.north_east, BEYOND_DEG),
        ..*area
    };
    area.outline()
}

fn polygon(zone: &Zone) -> Polygon<f64> {
    let ring = |corners: &[LatLon]| -> LineString<f64> {
        let corners = corners.iter().map(|at| Coord {
            x: at.lon_deg,
            y: at.lat_deg,
        });
        corners.collect()
    };
    let outer = match zone.circle {
        // The corners on the circle: nothing outside of it may count as inside.
        Some((center, radius_m)) => ring(&LocalFrame::new(center).inscribed(in_plane_m(radius_m))),
        None => ring(&zone.polygon),
    };
    // A union takes a hole for one by its direction.
    Polygon::new(outer, zone.holes.iter().map(|hole| ring(hole)).collect())
        .orient(Direction::Default)
}

/// Corners without the last, which repeats the first.
fn corners(ring: &LineString<f64>) -> Vec<LatLon> {
    let mut corners: Vec<LatLon> = ring
        .coords()
        .map(|at| LatLon {
            lat_deg: at.y,
            lon_deg: at.x,
        })
        .collect();
    if corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::{LatLon, Zone, polygon};
    use crate::geodesy::EARTH_RADIUS_M;

    #[test]
    fn a_wide_circle_to_stay_in_reaches_no_further_on_the_earth() {
        let center = LatLon {
            lat_deg: 47.1,
            lon_deg: 8.5,
        };
        let zone = Zone {
            circle: Some((center, 250_000.0)),
            ..Zone::default()
        };
        for corner in polygon(&zone).exterior().coords() {
            let corner = LatLon {
                lat_deg: corner.y,
                lon_deg: corner.x,
            };
            let diameter_m = 2.0 * EARTH_RADIUS_M;
            let away_m = diameter_m * (center.chord_m(corner) / diameter_m).asin();
            assert!((249_998.0..250_000.5).contains(&away_m), "{away_m}");
        }
    }
}
