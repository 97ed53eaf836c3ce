//! The area of a mission without a spec: a box around its places.

use super::Subject;
use crate::cli::print::failure::Failure;
use crate::formats::Document;
use crate::geodesy::LatLon;

/// Positions further than this from the first one are not part of the area, degrees.
const NEAR_DEG: f64 = 2.0;
/// The area reaches this far beyond the items, degrees of latitude.
const AROUND_DEG: f64 = 0.006;
/// The area reaches no further north or south, degrees.
const MAX_LAT_DEG: f64 = 89.9;

/// The corners of a box around all positions.
pub(super) fn around_positions(subjects: &[Subject]) -> Result<(LatLon, LatLon), Failure> {
    let documents = subjects.iter().map(|subject| &subject.document);
    let positions: Vec<LatLon> = documents.flat_map(positions).collect();
    // Without any position there is nothing to fly, and the verdict fails anywhere.
    let middle = positions.first().copied().unwrap_or(LatLon {
        lat_deg: 0.0,
        lon_deg: 0.0,
    });
    let corners = corners(middle, &positions);
    refuse_pole(subjects, corners).map(|()| corners)
}

/// Home first, then every item with a position.
fn positions(document: &Document) -> Vec<LatLon> {
    let home = document.home.map(|home| (home.x, home.y));
    let lists = [&document.items, &document.fence, &document.rally];
    let of_items = lists
        .into_iter()
        .flatten()
        .filter(|item| item.place().is_some())
        .map(|item| (item.x, item.y));
    let positions = home
        .into_iter()
        .chain(of_items)
        .filter(|&place| place != (0, 0))
        .filter_map(|(x, y)| LatLon::new(f64::from(x) / 1e7, f64::from(y) / 1e7).ok());
    document.home_place.into_iter().chain(positions).collect()
}

/// The corners of a box around the positions near the first.
fn corners(middle: LatLon, positions: &[LatLon]) -> (LatLon, LatLon) {
    let (mut low, mut high) = (middle, middle);
    let near = positions.iter().filter(|place| {
        (place.lat_deg - middle.lat_deg).abs() < NEAR_DEG
            && (place.lon_deg - middle.lon_deg).abs() < NEAR_DEG
    });
    for place in near {
        low.lat_deg = low.lat_deg.min(place.lat_deg);
        low.lon_deg = low.lon_deg.min(place.lon_deg);
        high.lat_deg = high.lat_deg.max(place.lat_deg);
        high.lon_deg = high.lon_deg.max(place.lon_deg);
    }
    let wide_deg = AROUND_DEG / middle.lat_deg.to_radians().cos().max(0.1);
    let south_west = LatLon {
        lat_deg: (low.lat_deg - AROUND_DEG).max(-MAX_LAT_DEG),
        lon_deg: (low.lon_deg - wide_deg).max(-180.0),
    };
    let north_east = LatLon {
        lat_deg: (high.lat_deg + AROUND_DEG).min(MAX_LAT_DEG),
        lon_deg: (high.lon_deg + wide_deg).min(180.0),
    };
    (south_west, north_east)
}

/// No area reaches to a pole.
fn refuse_pole(subjects: &[Subject], corners: (LatLon, LatLon)) -> Result<(), Failure> {
    if corners.0.lat_deg < corners.1.lat_deg {
        return Ok(());
    }
    let path = subjects.first().map(|subject| subject.path.display());
    let message = format!(
        "{}: its places lie within {:.1} degrees of a pole and cannot be judged (allowed: latitudes from -{MAX_LAT_DEG} to {MAX_LAT_DEG})",
        path.map_or_else(String::new, |path| path.to_string()),
        90.0 - MAX_LAT_DEG
    );
    Err(Failure::new(Failure::INPUT, message))
}
