//! The member `crs` of GeoJSON from before RFC 7946: other systems than WGS84 become degrees of it.

use ::geojson::{Feature, Geometry, GeometryValue, JsonObject, Position};
use serde_json::Value;

use super::ShapesError;
use crate::geodesy::Projection;

/// Longest edge of a polygon that is drawn straight in latitude and longitude, metres: it is straight
/// in its own plane, and over 2 km both differ by less than a decimetre.
const EDGE_M: f64 = 2000.0;
/// Most pieces of one edge.
const MAX_PIECES: u32 = 1000;

/// Where a file says in what system its coordinates are.
#[derive(Clone)]
pub(super) enum System {
    /// Degrees of WGS84, longitude first.
    Degrees,
    Other(Box<Projection>),
}

impl System {
    /// The system by the member `crs` of an object, and that of the object around it without one.
    ///
    /// # Errors
    /// A system that does not lead to WGS84.
    pub(super) fn within(members: Option<&JsonObject>, around: &Self) -> Result<Self, ShapesError> {
        let Some(crs) = members.and_then(|members| members.get("crs")) else {
            return Ok(around.clone());
        };
        if crs.is_null() {
            return Ok(around.clone());
        }
        let properties = crs.get("properties");
        let property = |key: &str| properties?.get(key).and_then(Value::as_str);
        let name = property("name").or_else(|| property("href"));
        let Some(name) = name else {
            return Err(ShapesError::Crs(crs.to_string().chars().take(60).collect()));
        };
        let upper = name.to_ascii_uppercase();
        if upper.ends_with(":CRS84") || upper == "CRS84" || upper.ends_with("/CRS84") {
            return Ok(Self::Degrees);
        }
        // `urn:ogc:def:crs:EPSG::2056`, `urn:ogc:def:crs:EPSG:9.1:2056`, `EPSG:2056`.
        let code = upper
            .contains("EPSG")
            .then(|| upper.rsplit([':', '/']).next());
        match code.flatten().and_then(|code| code.parse().ok()) {
            Some(4326) => Ok(Self::Degrees),
            code => code
                .and_then(Projection::of_epsg)
                .map(|projection| Self::Other(Box::new(projection)))
                .ok_or_else(|| ShapesError::Crs(name.to_owned())),
        }
    }

    /// Puts the positions of a feature into degrees.
    ///
    /// # Errors
    /// A system of a feature or of its geometry that does not lead to WGS84.
    pub(super) fn apply(&self, feature: &mut Feature) -> Result<(), ShapesError> {
        let own = Self::within(feature.foreign_members.as_ref(), self)?;
        match &mut feature.geometry {
            Some(geometry) => own.to_degrees(geometry),
            None => Ok(()),
        }
    }

    fn to_degrees(&self, geometry: &mut Geometry) -> Result<(), ShapesError> {
        let own = Self::within(geometry.foreign_members.as_ref(), self)?;
        if let GeometryValue::GeometryCollection { geometries } = &mut geometry.value {
            let mut geometries = geometries.iter_mut();
            return geometries.try_for_each(|part| own.to_degrees(part));
        }
        let Self::Other(projection) = own else {
            return Ok(());
        };
        let place = |at: &mut Position| move_to_degrees(at, &projection);
        match &mut geometry.value {
            GeometryValue::Point { coordinates } => place(coordinates),
            GeometryValue::MultiPoint { coordinates }
            | GeometryValue::LineString { coordinates } => coordinates.iter_mut().for_each(place),
            GeometryValue::MultiLineString { coordinates } => {
                coordinates.iter_mut().flatten().for_each(place);
            }
            GeometryValue::Polygon { coordinates } => {
                coordinates
                    .iter_mut()
                    .for_each(|ring| finer(ring, &projection));
            }
            GeometryValue::MultiPolygon { coordinates } => {
                let rings = coordinates.iter_mut().flatten();
                rings.for_each(|ring| finer(ring, &projection));
            }
            GeometryValue::GeometryCollection { .. } => {}
        }
        Ok(())
    }
}

/// Replaces east and north by longitude and latitude. What is nowhere on earth becomes a position that
/// no place has, so that its shape is refused by name.
fn move_to_degrees(at: &mut Position, projection: &Projection) {
    if let [east, north, ..] = at.as_slice_mut() {
        let place = projection.to_lat_lon(*east, *north);
        (*east, *north) =
            place.map_or((f64::NAN, f64::NAN), |place| (place.lon_deg, place.lat_deg));
    }
}

/// Puts a ring into degrees, with more corners on edges that are long.
fn finer(ring: &mut Vec<Position>, projection: &Projection) {
    let mut corners: Vec<Position> = Vec::with_capacity(ring.len());
    for (index, to) in ring.iter().enumerate() {
        let from = index.checked_sub(1).and_then(|before| ring.get(before));
        if let (Some([x0, y0, ..]), [x1, y1, ..]) = (from.map(Position::as_slice), to.as_slice()) {
            let place = |x: f64, y: f64| projection.to_lat_lon(x, y);
            let length_m = place(*x0, *y0).zip(place(*x1, *y1));
            let length_m = length_m.map_or(0.0, |(from, to)| from.chord_m(to));
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a cast of a float saturates"
            )]
            let pieces = ((length_m / EDGE_M).ceil() as u32).clamp(1, MAX_PIECES);
            for piece in 1..pieces {
                let share = f64::from(piece) / f64::from(pieces);
                let between = |a: f64, b: f64| a + (b - a) * share;
                corners.push(Position::from([between(*x0, *x1), between(*y0, *y1)]));
            }
        }
        corners.push(to.clone());
    }
    for corner in &mut corners {
        move_to_degrees(corner, projection);
    }
    *ring = corners;
}

#[cfg(test)]
mod tests {
    use super::super::{Collection, Geometry, ShapesError, read};

    fn square(crs: &str, east: f64, north: f64, side: f64) -> String {
        let (right, top) = (east + side, north + side);
        format!(
            r#"{{"type":"FeatureCollection"{crs},"features":[{{"type":"Feature","properties":{{"id":"a"}},"geometry":
              {{"type":"Polygon","coordinates":[[[{east},{north}],[{right},{north}],[{right},{top}],[{east},{north}]]]}}}}]}}"#
        )
    }

    fn named(system: &str) -> String {
        format!(r#","crs":{{"type":"name","properties":{{"name":"{system}"}}}}"#)
    }

    fn of(text: &str) -> Result<Collection, ShapesError> {
        read("zones.geojson", text.as_bytes())
    }

    fn corners(collection: &Collection) -> Vec<(f64, f64)> {
        let Geometry::Polygon { outer, .. } = &collection.shapes[0].geometry else {
            panic!("{collection:?}")
        };
        outer.iter().map(|at| (at.lat_deg, at.lon_deg)).collect()
    }

    /// The old observatory of Berne: 46.951083 N, 7.438637 E by swisstopo.
    #[test]
    fn coordinates_of_a_national_grid_become_degrees() {
        for system in [
            "urn:ogc:def:crs:EPSG::2056",
            "EPSG:2056",
            "http://www.opengis.net/def/crs/EPSG/0/2056",
        ] {
            let found = of(&square(&named(system), 2_600_000.0, 1_200_000.0, 1000.0));
            let found = corners(&found.expect("a known system"));
            assert_eq!(found.len(), 3);
            assert!((found[0].0 - 46.951_083).abs() < 2e-5, "{found:?}");
            assert!((found[0].1 - 7.438_637).abs() < 2e-5, "{found:?}");
            // The diagonal of a kilometre is 1414 m long.
            assert!((found[2].0 - 46.960_078).abs() < 5e-5, "{found:?}");
        }
    }

    #[test]
    fn long_edges_of_a_national_grid_bend() {
        let text = square(&named("EPSG:2056"), 2_600_000.0, 1_200_000.0, 20_000.0);
        let found = corners(&of(&text).expect("a known system"));
        // 10, 10 and 15 pieces.
        assert!((35..=36).contains(&found.len()), "{}", found.len());
    }

    #[test]
    fn degrees_of_wgs84_stay_as_they_are_by_any_name() {
        let plain = of(&square("", 8.0, 47.0, 0.01)).expect("degrees");
        for system in [
            "urn:ogc:def:crs:OGC:1.3:CRS84",
            "urn:ogc:def:crs:EPSG::4326",
            "EPSG:4326",
        ] {
            let found = of(&square(&named(system), 8.0, 47.0, 0.01));
            assert_eq!(found.expect("degrees"), plain, "{system}");
        }
        assert_eq!(
            of(&square(r#","crs":null"#, 8.0, 47.0, 0.01)).expect("degrees"),
            plain
        );
    }

    #[test]
    fn another_system_is_refused_with_the_command_that_converts_the_file() {
        for system in [
            "EPSG:27700",
            "urn:ogc:def:crs:EPSG::999999",
            "urn:ogc:def:crs:OGC::CRS83",
            "mine",
        ] {
            let error = of(&square(&named(system), 1.0, 2.0, 1.0)).expect_err(system);
            let error = error.to_string();
            assert!(
                error.contains(&format!("coordinates in {system}")),
                "{error}"
            );
            let command = "`ogr2ogr -f GeoJSON -lco RFC7946=YES -t_srs EPSG:4326 zones.new.geojson zones.geojson`";
            assert!(error.contains(command), "{error}");
        }
        let link = r#","crs":{"type":"link","properties":{"href":"http://example.com/mine.prj"}}"#;
        assert!(of(&square(link, 1.0, 2.0, 1.0)).is_err());
        // Of a single feature or geometry too.
        let own = square("", 1.0, 2.0, 1.0).replace(
            r#""geometry":"#,
            r#""crs":{"properties":{"name":"EPSG:27700"}},"geometry":"#,
        );
        assert!(of(&own).is_err(), "{own}");
    }

    #[test]
    fn a_position_that_is_nowhere_refuses_its_shape_by_name() {
        let text = square(&named("EPSG:2056"), 1e300, 1e300, 1.0);
        let found = of(&text).expect("a known system");
        assert_eq!(found.refused.len(), 1, "{found:?}");
        assert_eq!(found.refused[0].name, "a");
    }
}
