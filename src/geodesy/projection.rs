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

/// Codes of EPSG 10 whose systems have the axis "ellipsoidal height", in order (crate `crs-definitions`).
#[rustfmt::skip]
const THREE_DIMENSIONAL: &[u16] = &[
    3823, 3888, 4017, 4040, 4074, 4080, 4327, 4329, 4339, 4341, 4343, 4345, 4347, 4349, 4351, 4353, 4355,
    4357, 4359, 4361, 4363, 4365, 4367, 4369, 4371, 4373, 4375, 4377, 4379, 4381, 4383, 4386, 4388, 4466,
    4469, 4472, 4480, 4482, 4557, 4883, 4885, 4887, 4889, 4891, 4893, 4895, 4898, 4900, 4907, 4909, 4921,
    4923, 4925, 4927, 4929, 4931, 4933, 4935, 4937, 4939, 4941, 4943, 4945, 4947, 4949, 4951, 4953, 4955,
    4957, 4959, 4961, 4963, 4965, 4967, 4969, 4971, 4973, 4975, 4977, 4979, 4981, 4983, 4985, 4987, 4989,
    4991, 4993, 4995, 4997, 4999, 5012, 5245, 5251, 5263, 5323, 5342, 5353, 5359, 5364, 5370, 5372, 5380,
    5392, 5488, 5545, 5560, 5592, 5830, 5885, 6134, 6310, 6319, 6321, 6324, 6364, 6667, 6705, 6782, 6979,
    6982, 6986, 6989, 7034, 7036, 7038, 7040, 7042, 7072, 7085, 7087, 7135, 7138, 7372, 7657, 7659, 7661,
    7663, 7665, 7678, 7680, 7682, 7685, 7797, 7816, 7843, 7880, 7885, 7900, 7901, 7902, 7903, 7904, 7905,
    7906, 7907, 7908, 7909, 7910, 7911, 7912, 7915, 7917, 7919, 7921, 7923, 7925, 7927, 7929, 7931, 8085,
    8231, 8235, 8239, 8244, 8248, 8251, 8254, 8399, 8403, 8426, 8430, 8542, 8544, 8684, 8817, 8899, 8901,
    8906, 9002, 9005, 9008, 9011, 9013, 9016, 9018,
];

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

    /// Whether heights in a system of EPSG are metres above its ellipsoid: the three-dimensional ones, such as 4979.
    #[must_use]
    pub fn has_ellipsoidal_heights(code: u16) -> bool {
        THREE_DIMENSIONAL.binary_search(&code).is_ok()
    }

    /// The name of the system.
    #[must_use]
    pub fn name(&self) -> String {
        format!("EPSG:{}", self.code)
    }

    /// The place of a point east and north in the units of the system; degrees in one of degrees.
    #[must_use]
    pub fn to_lat_lon(&self, east: f64, north: f64) -> Option<LatLon> {
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

    /// The reverse of [`Self::to_lat_lon`].
    #[must_use]
    pub fn from_lat_lon(&self, place: LatLon) -> Option<(f64, f64)> {
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
