//! The local frame in which missions are planned.
//!
//! Planning coordinates are east and north of the WGS84 tangent (ENU) frame at
//! the origin, and altitude above mean sea level instead of ENU up: the tangent
//! plane leaves the earth by 7.8 m at 10 km and by 785 m at 100 km. East and
//! north are taken at the foot of the vertical (ellipsoidal height 0), so that
//! one vertical line is one point `(east, north)`: a threat is a true vertical
//! cylinder, and height above ground is a difference at one place. Distances
//! come out short by height over earth radius (0.016 % at 1000 m), which is the
//! safe side for every separation.

use geo::{LineString, Polygon};
use nalgebra::{Matrix3, Vector3};

use super::Amsl;

/// WGS84 semi-major axis `a`, metres (NGA.STND.0036 table 3.1).
const SEMI_MAJOR_M: f64 = 6_378_137.0;
/// WGS84 flattening `f` (NGA.STND.0036 table 3.1).
const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// First eccentricity squared, `e^2 = f (2 - f)`.
const ECCENTRICITY_SQ: f64 = FLATTENING * (2.0 - FLATTENING);

/// Longest straight piece of an edge in planning coordinates.
const EDGE_PIECE_M: f64 = 5000.0;

/// A place on the earth, WGS84, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatLon {
    /// Geodetic latitude, degrees north, -90 to 90.
    pub lat_deg: f64,
    /// Longitude, degrees east, -180 to 180.
    pub lon_deg: f64,
}

/// A place in planning coordinates, metres from the origin of a [`LocalFrame`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EastNorth {
    /// Metres east.
    pub east_m: f64,
    /// Metres north.
    pub north_m: f64,
}

/// A point in planning coordinates: east, north, and altitude above the sea.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanPoint {
    /// Where.
    pub at: EastNorth,
    /// How high.
    pub amsl: Amsl,
}

/// What cannot be converted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GeodesyError {
    /// Latitude or longitude is out of range or not a number.
    #[error(
        "no such place: latitude {lat_deg}, longitude {lon_deg} (allowed: -90 to 90, -180 to 180)"
    )]
    NoSuchPlace {
        /// Latitude as given, degrees.
        lat_deg: f64,
        /// Longitude as given, degrees.
        lon_deg: f64,
    },
}

/// The WGS84 tangent frame at one place: east, north, up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalFrame {
    origin: LatLon,
    origin_ecef_m: Vector3<f64>,
    /// Rows are east, north and up in ECEF.
    ecef_to_enu: Matrix3<f64>,
}

/// Mean radius of the earth, metres (IUGG R1, rounded).
pub(crate) const EARTH_RADIUS_M: f64 = 6_371_000.0;

/// Length of a degree on the sphere of mean radius, on which analytic hills are drawn, metres.
pub(crate) const METRES_PER_DEG: f64 = 111_195.08;

/// The tangent of a latitude beyond this is taken to be that of this, degrees: 10 cm from a pole.
const NEAR_POLE_DEG: f64 = 89.999_999;

/// How far a line of some length that is straight in latitude and longitude leaves the geodesic
/// between its ends, metres: `L^2 tan(lat) / 8 R`.
#[must_use]
pub fn bend_m(length_m: f64, lat_deg: f64) -> f64 {
    let tan_lat = lat_deg.abs().min(NEAR_POLE_DEG).to_radians().tan();
    length_m * length_m * tan_lat / (8.0 * EARTH_RADIUS_M)
}

/// The least radius of curvature of the earth, of a meridian at the equator, metres (WGS84).
const MIN_CURVATURE_RADIUS_M: f64 = 6_335_439.0;

/// The way along the earth to a place that is so far from the origin of a [`LocalFrame`] in its plane, no
/// shorter than it is, metres.
pub(crate) fn on_earth_m(in_plane_m: f64) -> f64 {
    MIN_CURVATURE_RADIUS_M * (in_plane_m / MIN_CURVATURE_RADIUS_M).min(1.0).asin()
}

/// How far from the origin of a [`LocalFrame`] a place is in its plane that is so far along the earth, no
/// further than it is, metres.
pub(crate) fn in_plane_m(on_earth_m: f64) -> f64 {
    let quarter_rad = std::f64::consts::FRAC_PI_2;
    MIN_CURVATURE_RADIUS_M * (on_earth_m / MIN_CURVATURE_RADIUS_M).min(quarter_rad).sin()
}

/// How far a straight line of a [`LocalFrame`] leaves the geodesic between its ends, metres:
/// `d L^2 / 8 R^2` at a distance `d` from the origin, with the 1 % that this is too small by up to 500 km.
#[must_use]
pub fn frame_bend_m(length_m: f64, from_origin_m: f64) -> f64 {
    const ENLARGED: f64 = 1.01;
    ENLARGED * from_origin_m * length_m * length_m / (8.0 * EARTH_RADIUS_M * EARTH_RADIUS_M)
}

/// Bends up to this are left to buffers, metres: those of copters are as wide.
pub(crate) const SMALL_BEND_M: f64 = 10.0;

/// The longest line that bends by no more than half of [`SMALL_BEND_M`], metres.
#[must_use]
pub(crate) fn straight_m(lat_deg: f64) -> f64 {
    (0.5 * SMALL_BEND_M / bend_m(1.0, lat_deg)).sqrt()
}

impl LatLon {
    /// A checked place.
    ///
    /// # Errors
    /// [`GeodesyError::NoSuchPlace`] when out of range or not finite.
    pub fn new(lat_deg: f64, lon_deg: f64) -> Result<Self, GeodesyError> {
        if (-90.0..=90.0).contains(&lat_deg) && (-180.0..=180.0).contains(&lon_deg) {
            Ok(Self { lat_deg, lon_deg })
        } else {
            Err(GeodesyError::NoSuchPlace { lat_deg, lon_deg })
        }
    }

    /// A place as MAVLink has it, latitude and longitude in 1e-7 degrees; not checked.
    #[must_use]
    pub fn of_e7(lat_e7: i32, lon_e7: i32) -> Self {
        Self {
            lat_deg: f64::from(lat_e7) / 1e7,
            lon_deg: f64::from(lon_e7) / 1e7,
        }
    }

    /// Straight distance through the earth, metres; 1 cm short of the way along it at 20 km.
    #[must_use]
    pub fn chord_m(self, other: Self) -> f64 {
        (self.to_ecef(0.0) - other.to_ecef(0.0)).norm()
    }

    /// Earth-centred coordinates of the point `height_m` above the ellipsoid here.
    #[must_use]
    pub fn to_ecef(self, height_m: f64) -> Vector3<f64> {
        let (sin_lat, cos_lat) = self.lat_deg.to_radians().sin_cos();
        let (sin_lon, cos_lon) = self.lon_deg.to_radians().sin_cos();
        // Radius of curvature in the prime vertical.
        let n_m = SEMI_MAJOR_M / (1.0 - ECCENTRICITY_SQ * sin_lat * sin_lat).sqrt();
        Vector3::new(
            (n_m + height_m) * cos_lat * cos_lon,
            (n_m + height_m) * cos_lat * sin_lon,
            (n_m * (1.0 - ECCENTRICITY_SQ) + height_m) * sin_lat,
        )
    }

    /// The place and ellipsoidal height (metres) of a point in ECEF.
    ///
    /// Fixed-point iteration on the reduced latitude (Bowring 1976): three
    /// rounds reach the last bits for every height from the deep sea to orbit.
    /// Its sine and cosine are enough for that: angles take ten times as long.
    #[must_use]
    pub fn from_ecef(ecef_m: &Vector3<f64>) -> (Self, f64) {
        let axis_distance_m = ecef_m.x.hypot(ecef_m.y);
        let semi_minor_m = SEMI_MAJOR_M * (1.0 - FLATTENING);
        let second_ecc_sq = ECCENTRICITY_SQ / (1.0 - ECCENTRICITY_SQ);
        // Up and out along the normal of the ellipsoid, in any length.
        let (mut up, mut out) = (ecef_m.z, axis_distance_m * (1.0 - ECCENTRICITY_SQ));
        for _ in 0..3 {
            let (sin_b, cos_b) = direction((1.0 - FLATTENING) * up, out);
            up = ecef_m.z + second_ecc_sq * semi_minor_m * sin_b.powi(3);
            out = axis_distance_m - ECCENTRICITY_SQ * SEMI_MAJOR_M * cos_b.powi(3);
        }
        let lat_rad = up.atan2(out);
        let (sin_lat, cos_lat) = lat_rad.sin_cos();
        // This form of the height is good at the poles as well as the equator.
        let height_m = axis_distance_m * cos_lat + ecef_m.z * sin_lat
            - SEMI_MAJOR_M * (1.0 - ECCENTRICITY_SQ * sin_lat * sin_lat).sqrt();
        let place = Self {
            lat_deg: lat_rad.to_degrees(),
            lon_deg: ecef_m.y.atan2(ecef_m.x).to_degrees(),
        };
        (place, height_m)
    }
}

/// Sine and cosine of the angle of a vector.
fn direction(up: f64, out: f64) -> (f64, f64) {
    let length = (up * up + out * out).sqrt();
    if length > 0.0 {
        (up / length, out / length)
    } else {
        (0.0, 1.0)
    }
}

impl EastNorth {
    /// Distance in the plane, metres.
    #[must_use]
    pub fn distance_m(self, other: Self) -> f64 {
        (self.east_m - other.east_m).hypot(self.north_m - other.north_m)
    }

    /// Whether a point is further than a distance to the east, west, north or south alone: cheaper
    /// than [`Self::distance_m`], and true of most that are far.
    #[must_use]
    pub fn is_beyond(self, other: Self, reach_m: f64) -> bool {
        (self.east_m - other.east_m).abs() > reach_m
            || (self.north_m - other.north_m).abs() > reach_m
    }

    /// The place at a share of the straight way to another.
    #[must_use]
    pub fn toward(self, to: Self, share: f64) -> Self {
        Self {
            east_m: self.east_m + share * (to.east_m - self.east_m),
            north_m: self.north_m + share * (to.north_m - self.north_m),
        }
    }
}

impl PlanPoint {
    /// The place at a share of the straight way to another.
    #[must_use]
    pub fn toward(self, to: Self, share: f64) -> Self {
        Self {
            at: self.at.toward(to.at, share),
            amsl: Amsl(self.amsl.0 + share * (to.amsl.0 - self.amsl.0)),
        }
    }

    /// East, north and altitude, metres.
    #[must_use]
    pub fn axes_m(self) -> [f64; 3] {
        [self.at.east_m, self.at.north_m, self.amsl.0]
    }

    /// The point higher by a height, metres.
    #[must_use]
    pub fn raised(self, by_m: f64) -> Self {
        Self {
            amsl: Amsl(self.amsl.0 + by_m),
            ..self
        }
    }

    /// A point from its three coordinates, metres.
    #[must_use]
    pub fn new(east_m: f64, north_m: f64, amsl: Amsl) -> Self {
        Self {
            at: EastNorth { east_m, north_m },
            amsl,
        }
    }

    /// Straight distance in three dimensions, metres.
    #[must_use]
    pub fn distance_m(self, other: Self) -> f64 {
        self.at
            .distance_m(other.at)
            .hypot(self.amsl.0 - other.amsl.0)
    }
}

/// Corners of the polygons about and in a circle.
const CIRCLE_CORNERS: u32 = 72;

impl LocalFrame {
    /// The frame tangent to the ellipsoid at `origin`.
    #[must_use]
    pub fn new(origin: LatLon) -> Self {
        let (sin_lat, cos_lat) = origin.lat_deg.to_radians().sin_cos();
        let (sin_lon, cos_lon) = origin.lon_deg.to_radians().sin_cos();
        #[rustfmt::skip]
        let ecef_to_enu = Matrix3::new(
            -sin_lon,            cos_lon,           0.0,
            -sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat,
             cos_lat * cos_lon,  cos_lat * sin_lon, sin_lat,
        );
        Self {
            origin,
            origin_ecef_m: origin.to_ecef(0.0),
            ecef_to_enu,
        }
    }

    /// Where the plane touches the ellipsoid.
    #[must_use]
    pub fn origin(&self) -> LatLon {
        self.origin
    }

    /// East, north, up (metres) of a place at an ellipsoidal height.
    #[must_use]
    pub fn to_enu(&self, place: LatLon, height_m: f64) -> Vector3<f64> {
        self.ecef_to_enu * (place.to_ecef(height_m) - self.origin_ecef_m)
    }

    /// The place and ellipsoidal height (metres) of a point in east, north, up.
    #[must_use]
    pub fn from_enu(&self, enu_m: &Vector3<f64>) -> (LatLon, f64) {
        LatLon::from_ecef(&(self.origin_ecef_m + self.ecef_to_enu.transpose() * enu_m))
    }

    /// Planning coordinates of a place (see the module).
    #[must_use]
    pub fn to_plan(&self, place: LatLon) -> EastNorth {
        let enu_m = self.to_enu(place, 0.0);
        EastNorth {
            east_m: enu_m.x,
            north_m: enu_m.y,
        }
    }

    /// The polygon circumscribed about a circle around the origin, counter-clockwise.
    #[must_use]
    pub fn circumscribed(&self, radius_m: f64) -> Vec<LatLon> {
        let half_step_rad = std::f64::consts::PI / f64::from(CIRCLE_CORNERS);
        self.inscribed(radius_m / half_step_rad.cos())
    }

    /// The polygon inscribed in a circle around the origin, counter-clockwise.
    #[must_use]
    pub fn inscribed(&self, radius_m: f64) -> Vec<LatLon> {
        let step_rad = std::f64::consts::TAU / f64::from(CIRCLE_CORNERS);
        let corner = |corner: u32| {
            let (sin, cos) = (f64::from(corner) * step_rad).sin_cos();
            self.from_plan(EastNorth {
                east_m: radius_m * cos,
                north_m: radius_m * sin,
            })
        };
        (0..CIRCLE_CORNERS).map(corner).collect()
    }

    /// In how many pieces [`Self::outline`] draws an edge.
    #[must_use]
    pub fn pieces(from: LatLon, to: LatLon) -> u32 {
        let mut pieces = 1_u32;
        while pieces < 1000 && from.chord_m(to) > f64::from(pieces) * EDGE_PIECE_M {
            pieces += 1;
        }
        pieces
    }

    /// The polygon of these corners in planning coordinates (x east, y north, metres).
    ///
    /// Edges are straight in latitude and longitude, as autopilots test fences. In
    /// the plane such an edge bends by `d^2 tan(lat) / 8 R`, 9 m over 25 km at 36
    /// degrees, so it is drawn in pieces of at most 5 km (0.4 m).
    #[must_use]
    pub fn outline(&self, corners: &[LatLon]) -> Polygon<f64> {
        let next = corners.iter().cycle().skip(1);
        let ring: Vec<(f64, f64)> = corners
            .iter()
            .zip(next)
            .flat_map(|(&from, &to)| {
                let pieces = Self::pieces(from, to);
                (0..pieces).map(move |piece| {
                    let share = f64::from(piece) / f64::from(pieces);
                    let between = |a: f64, b: f64| a + (b - a) * share;
                    let place = LatLon {
                        lat_deg: between(from.lat_deg, to.lat_deg),
                        lon_deg: between(from.lon_deg, to.lon_deg),
                    };
                    let plan = self.to_plan(place);
                    (plan.east_m, plan.north_m)
                })
            })
            .collect();
        Polygon::new(LineString::from(ring), Vec::new())
    }

    /// The place of planning coordinates: the inverse of [`Self::to_plan`].
    ///
    /// Looks for the up at which the point lies on the ellipsoid; the height is
    /// almost linear in up, so a few Newton steps reach the last bits. Good to
    /// 2000 km from the origin; beyond the earth's rim there is no such place,
    /// and the nearest rim is returned.
    #[must_use]
    pub fn from_plan(&self, plan: EastNorth) -> LatLon {
        let range_sq = plan.east_m * plan.east_m + plan.north_m * plan.north_m;
        let mut up_m = (SEMI_MAJOR_M * SEMI_MAJOR_M - range_sq).max(0.0).sqrt() - SEMI_MAJOR_M;
        let mut place = self.origin;
        for _ in 0..6 {
            let (found, height_m) = self.from_enu(&Vector3::new(plan.east_m, plan.north_m, up_m));
            place = found;
            // d(height)/d(up) is the cosine between the two verticals.
            let slope = (1.0 + up_m / SEMI_MAJOR_M).max(0.1);
            up_m -= height_m / slope;
            // Sideways the place is off by no more than the angle between the verticals of it.
            if height_m.abs() < 1e-7 {
                break;
            }
        }
        place
    }
}
