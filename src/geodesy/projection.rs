//! Coordinate reference systems by their codes of EPSG.

use proj4rs::Proj;
use proj4rs::transform::transform;

use super::LatLon;

/// A coordinate reference system with a code of EPSG, and the way to WGS84.
#[derive(Clone, Debug)]
pub struct Projection {
    code: u16,
    from: Proj,
    wgs84: Proj,
    /// How far a place may be from where the definition puts it, metres.
    pub error_m: f64,
}

impl Projection {
    /// None where no definition is known, or none that leads to WGS84 without grids of shifts.
    #[must_use]
    pub fn of_epsg(code: u16) -> Option<Self> {
        let definition = crs_definitions::from_code(code)?.proj4;
        let has = |part: &str| definition.contains(part);
        // EPSG states 1 to 5 m for national systems shifted by three or seven parameters; ETRS89 and
        // NAD83 have drifted from WGS84 by up to 2 m with their continents.
        let error_m = if has("+datum=WGS84") || has("+nadgrids=@null") {
            0.1
        } else if has("+nadgrids") || has("+datum=NAD27") {
            return None;
        } else if has("+datum=NAD83") || has("+towgs84=0,0,0") {
            2.5
        } else if has("+towgs84=") {
            5.0
        } else {
            return None;
        };
        Some(Self {
            code,
            from: Proj::from_proj_string(definition).ok()?,
            wgs84: Proj::from_proj_string("+proj=longlat +datum=WGS84 +no_defs").ok()?,
            error_m,
        })
    }

    /// The name of the system.
    #[must_use]
    pub fn name(&self) -> String {
        format!("EPSG:{}", self.code)
    }

    /// The place of a point east and north in the units of the system; degrees in one of degrees.
    #[must_use]
    pub fn place(&self, east: f64, north: f64) -> Option<LatLon> {
        let unit = if self.from.is_latlong() {
            1.0_f64.to_radians()
        } else {
            1.0
        };
        let mut point = (east * unit, north * unit, 0.0);
        transform(&self.from, &self.wgs84, &mut point).ok()?;
        let place = LatLon {
            lat_deg: point.1.to_degrees(),
            lon_deg: point.0.to_degrees(),
        };
        (place.lat_deg.is_finite() && place.lon_deg.is_finite()).then_some(place)
    }

    /// The reverse of [`Self::place`].
    #[must_use]
    pub fn point(&self, place: LatLon) -> Option<(f64, f64)> {
        let mut point = (place.lon_deg.to_radians(), place.lat_deg.to_radians(), 0.0);
        transform(&self.wgs84, &self.from, &mut point).ok()?;
        let unit = if self.from.is_latlong() {
            1.0_f64.to_radians()
        } else {
            1.0
        };
        let (east, north) = (point.0 / unit, point.1 / unit);
        (east.is_finite() && north.is_finite()).then_some((east, north))
    }
}
