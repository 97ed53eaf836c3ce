//! Maps of a fleet for other programs: KML and GeoJSON.

pub(super) mod drawing;
pub mod geojson;
pub mod kml;
pub(super) mod outline;
