//! Well-known text of a geometry (OGC 06-103r4), longitude first, as GDAL writes it into tables.

use serde_json::{Value, json};

/// Deepest nesting of collections.
const MAX_DEPTH: usize = 8;

/// How deep positions are nested in the coordinates of a type of GeoJSON.
const TYPES: [(&str, &str, usize); 6] = [
    ("POINT", "Point", 0),
    ("LINESTRING", "LineString", 1),
    ("POLYGON", "Polygon", 2),
    ("MULTIPOINT", "MultiPoint", 1),
    ("MULTILINESTRING", "MultiLineString", 2),
    ("MULTIPOLYGON", "MultiPolygon", 3),
];

/// Whether a text begins as well-known text does.
#[must_use]
pub fn is_wkt(text: &str) -> bool {
    let words = TYPES.iter().map(|(word, ..)| *word);
    let start = text.trim_start().to_ascii_uppercase();
    let mut words = words.chain(["GEOMETRYCOLLECTION", "SRID="]);
    words.any(|word| start.starts_with(word))
}

/// The geometry of GeoJSON of a text.
///
/// # Errors
/// What the text has in place of such a geometry.
pub fn geojson_of_wkt(text: &str) -> Result<Value, String> {
    let upper = text.trim().to_ascii_uppercase();
    let text = match upper.strip_prefix("SRID=") {
        Some(after) => match after.split_once(';') {
            Some(("4326", text)) => text,
            _ => return Err("well-known text that is not in EPSG:4326".to_owned()),
        },
        None => upper.as_str(),
    };
    let mut reader = Reader { rest: text };
    let geometry = reader.geometry(0)?;
    match reader.rest.trim() {
        "" => Ok(geometry),
        rest => Err(format!("`{}` after its geometry", shortened(rest))),
    }
}

/// What is left of a text.
struct Reader<'a> {
    rest: &'a str,
}

impl<'a> Reader<'a> {
    fn word(&mut self) -> &'a str {
        let text = self.rest.trim_start();
        let end = text.find(|c: char| !c.is_ascii_alphabetic());
        let (word, rest) = text.split_at(end.unwrap_or(text.len()));
        self.rest = rest;
        word
    }

    /// Takes a sign, if it comes next.
    fn takes(&mut self, sign: char) -> bool {
        let rest = self.rest.trim_start().strip_prefix(sign);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn geometry(&mut self, depth: usize) -> Result<Value, String> {
        let start = self.rest;
        let word = self.word();
        let named = ["ZM", "Z", "M"]
            .iter()
            .find_map(|suffix| word.strip_suffix(suffix));
        let known = |word: &str| TYPES.iter().find(|(name, ..)| *name == word);
        let found = known(word).or_else(|| known(named?));
        let is_collection = word.starts_with("GEOMETRYCOLLECTION");
        // Heights above ground are properties: what a third number means is in no table.
        let before = self.rest;
        if !["Z", "M", "ZM"].contains(&self.word()) {
            self.rest = before;
        }
        if let Some((_, kind, nesting)) = found {
            let coordinates = self.nested(*nesting)?;
            return Ok(json!({"type": kind, "coordinates": coordinates}));
        }
        if !is_collection || depth == MAX_DEPTH {
            return Err(format!("`{}`, no geometry that is read", shortened(start)));
        }
        self.needs('(', "(")?;
        let mut geometries = vec![self.geometry(depth + 1)?];
        while self.takes(',') {
            geometries.push(self.geometry(depth + 1)?);
        }
        self.needs(')', ", or )")?;
        Ok(json!({"type": "GeometryCollection", "geometries": geometries}))
    }

    /// Takes a sign that must come next, or names what does.
    fn needs(&mut self, sign: char, due: &str) -> Result<(), String> {
        match self.takes(sign) {
            true => Ok(()),
            false => Err(format!("`{}` where {due} is due", shortened(self.rest))),
        }
    }

    /// Positions in brackets, nested so deep. A position alone may have its own: those of a multipoint.
    fn nested(&mut self, nesting: usize) -> Result<Value, String> {
        let is_alone = nesting == 0;
        self.needs('(', "(")?;
        let mut parts = Vec::new();
        loop {
            let has_own = self.rest.trim_start().starts_with('(');
            parts.push(match nesting {
                0 => self.position()?,
                1 if !has_own => self.position()?,
                _ => self.nested(nesting - 1)?,
            });
            if is_alone || !self.takes(',') {
                break;
            }
        }
        self.needs(')', ", or )")?;
        Ok(match (is_alone, parts.pop()) {
            (true, Some(position)) => position,
            (_, last) => parts.into_iter().chain(last).collect(),
        })
    }

    /// Longitude, latitude, and what else there is.
    fn position(&mut self) -> Result<Value, String> {
        let end = self.rest.find([',', ')']).unwrap_or(self.rest.len());
        let (text, rest) = self.rest.split_at(end);
        self.rest = rest;
        let numbers: Result<Vec<f64>, String> = text
            .split_whitespace()
            .map(|word| {
                let number = word.parse::<f64>().ok().filter(|of| of.is_finite());
                number.ok_or(format!("`{}` is no number", shortened(word)))
            })
            .collect();
        let numbers = numbers?;
        match numbers.len() {
            2..=4 => Ok(json!(numbers[..2])),
            count => Err(format!("a position of {count} numbers")),
        }
    }
}

/// The start of a text, fit to be printed.
fn shortened(text: &str) -> String {
    let start: String = text.trim().chars().take(20).collect();
    start.escape_debug().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_becomes_that_of_geojson_with_longitude_first() {
        for (text, expected) in [
            (
                "POINT (7.4 46.9)",
                json!({"type": "Point", "coordinates": [7.4, 46.9]}),
            ),
            (
                "Point Z(7.4 46.9 500)",
                json!({"type": "Point", "coordinates": [7.4, 46.9]}),
            ),
            (
                "SRID=4326;POINTZ(7.4 46.9 500)",
                json!({"type": "Point", "coordinates": [7.4, 46.9]}),
            ),
            (
                "LINESTRING (7 46,-8e0 47)",
                json!({"type": "LineString", "coordinates": [[7.0, 46.0], [-8.0, 47.0]]}),
            ),
            (
                "POLYGON((0 0,1 0,1 1,0 0),(2 2, 3 2, 3 3, 2 2))",
                json!({"type": "Polygon", "coordinates": [
                    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]],
                    [[2.0, 2.0], [3.0, 2.0], [3.0, 3.0], [2.0, 2.0]],
                ]}),
            ),
            (
                "MULTIPOINT ((7 46), (8 47))",
                json!({"type": "MultiPoint", "coordinates": [[7.0, 46.0], [8.0, 47.0]]}),
            ),
            (
                "MULTIPOINT (7 46, 8 47)",
                json!({"type": "MultiPoint", "coordinates": [[7.0, 46.0], [8.0, 47.0]]}),
            ),
            (
                "MULTILINESTRING ((7 46, 8 47), (1 2, 3 4))",
                json!({"type": "MultiLineString", "coordinates": [
                    [[7.0, 46.0], [8.0, 47.0]],
                    [[1.0, 2.0], [3.0, 4.0]],
                ]}),
            ),
            (
                "MULTIPOLYGON (((0 0,1 0,1 1,0 0)))",
                json!({"type": "MultiPolygon", "coordinates": [
                    [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]]],
                ]}),
            ),
            (
                "GEOMETRYCOLLECTION (POINT (1 2))",
                json!({"type": "GeometryCollection", "geometries": [
                    {"type": "Point", "coordinates": [1.0, 2.0]},
                ]}),
            ),
        ] {
            assert!(is_wkt(text), "{text}");
            assert_eq!(geojson_of_wkt(text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn text_that_is_no_geometry_is_refused_with_what_it_has() {
        for text in [
            "",
            "POINT",
            "POINT EMPTY",
            "POINT (1)",
            "POINT (1 2",
            "POINT (1 2, 3 4)",
            "POINT (1 x)",
            "POINT (1 nan)",
            "POINT (1 2) 3",
            "POINT ((1 2))",
            "LINESTRING ((1 2), (3 4)",
            "CURVEPOLYGON ((1 2))",
            "SRID=2056;POINT (1 2)",
            "0101000000",
            "GEOMETRYCOLLECTION EMPTY",
        ] {
            assert!(geojson_of_wkt(text).is_err(), "{text}");
        }
        let deep = "GEOMETRYCOLLECTION (".repeat(100_000);
        assert!(geojson_of_wkt(&deep).is_err());
        let deep = format!("POINT {}", "(".repeat(100_000));
        assert!(geojson_of_wkt(&deep).is_err());
    }
}
