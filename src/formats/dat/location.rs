//! Places as ArduPilot keeps them, and its own arithmetic of distances (`Location`), which is no
//! geodesy.

use crate::spec::Area;

/// 1e-7 degrees in a degree.
pub(super) const PER_DEGREE: i32 = 10_000_000;
/// Metres in 1e-7 degrees of latitude (`LOCATION_SCALING_FACTOR`), single precision.
const SCALE_M: f32 = 0.011_131_884_5;
/// 1e-7 degrees of latitude in a metre (`LOCATION_SCALING_FACTOR_INV`).
const SCALE_INV: f32 = 89.832_05;

/// A place as ArduPilot keeps it, 1e-7 degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Location {
    pub(super) lat: i32,
    pub(super) lon: i32,
}

impl Location {
    pub(super) fn is_in(self, area: &Area) -> bool {
        let between = |from: f64, at: i32, to: f64| (e7(from)..=e7(to)).contains(&at);
        let (south_west, north_east) = (area.south_west, area.north_east);
        between(south_west.lat_deg, self.lat, north_east.lat_deg)
            && between(south_west.lon_deg, self.lon, north_east.lon_deg)
    }
}

pub(super) fn corner_of(lat_deg: i32, lon_deg: i32) -> Location {
    Location {
        lat: lat_deg * PER_DEGREE,
        lon: lon_deg * PER_DEGREE,
    }
}

/// Metres north and east (`Location::get_distance_NE`).
pub(super) fn distance_m(from: Location, to: Location) -> (f32, f32) {
    let scale = longitude_scale(i32::midpoint(from.lat, to.lat));
    (
        single(to.lat - from.lat) * SCALE_M,
        single(to.lon - from.lon) * SCALE_M * scale,
    )
}

/// The place at a distance (`Location::offset_latlng`).
pub(super) fn offset(from: Location, north_m: i32, east_m: i32) -> Location {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a cast of a float saturates"
    )]
    let whole = |e7: f64| e7 as i32;
    let lat = from.lat + whole(f64::from(north_m) * f64::from(SCALE_INV));
    let scale = longitude_scale(i32::midpoint(from.lat, lat));
    let lon = whole(f64::from(east_m) * f64::from(SCALE_INV) / f64::from(scale));
    Location {
        lat,
        lon: from.lon + lon,
    }
}

/// How much shorter a degree of longitude is than one of latitude (`Location::longitude_scale`).
fn longitude_scale(lat: i32) -> f32 {
    let lat_rad = (f64::from(lat) / f64::from(PER_DEGREE)).to_radians();
    single_of(f64::from(single_of(lat_rad)).cos()).max(0.01)
}

#[expect(clippy::cast_possible_truncation, reason = "single precision is meant")]
fn single_of(value: f64) -> f32 {
    value as f32
}

fn single(value: i32) -> f32 {
    single_of(f64::from(value))
}

pub(super) fn e7(degrees: f64) -> i32 {
    #[expect(clippy::cast_possible_truncation, reason = "checked degrees")]
    let e7 = (degrees * f64::from(PER_DEGREE)).round() as i32;
    e7
}
