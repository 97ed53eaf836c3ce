//! Tables of obstacles with a column of well-known text, as GDAL and databases write them.

use serde_json::{Map, Value, json};

use crate::numeric::text::shell_word;
use crate::shapes::{geojson_of_wkt, is_wkt};

/// What columns of geometries are named, in lower case.
const COLUMNS: [&str; 4] = ["wkt", "geometry", "geom", "the_geom"];
/// What is read from a table with such a column.
const NUMBERS: [&str; 2] = ["height_m", "radius_m"];

/// The column of a name, in whichever case.
pub(super) fn column(names: &csv::StringRecord, name: &str) -> Option<usize> {
    names.iter().position(|of| of.eq_ignore_ascii_case(name))
}

/// A name that two columns have.
pub(super) fn twice(names: &csv::StringRecord) -> Option<&str> {
    let mut numbered = names.iter().enumerate();
    let (_, name) = numbered.find(|(index, name)| {
        let mut before = names.iter().take(*index);
        !name.is_empty() && before.any(|other| other.eq_ignore_ascii_case(name))
    })?;
    Some(name)
}

/// The column with the geometry: of such a name, and with well-known text or without another place in
/// the table.
pub(super) fn geometry_column(
    names: &csv::StringRecord,
    records: &[csv::StringRecord],
) -> Option<usize> {
    let column = |name: &str| column(names, name);
    let found = COLUMNS.iter().find_map(|name| column(name))?;
    let cells = records.iter().filter_map(|record| record.get(found));
    let has_place = column("lat").is_some() && column("lon").is_some();
    (!has_place || cells.into_iter().any(is_wkt)).then_some(found)
}

/// The table as GeoJSON, each row a feature.
pub(super) fn as_geojson(
    file: &str,
    (names, records): (&csv::StringRecord, &[csv::StringRecord]),
    geometry: usize,
) -> Result<Vec<u8>, String> {
    let column = |name: &str| column(names, name);
    let id = column("id").or(column("name"));
    let mut features = Vec::new();
    for record in records {
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |column: usize| Some(record.get(column)?).filter(|cell| !cell.is_empty());
        let of = |name: &str| cell(column(name)?);
        let name = id.and_then(cell);
        let name = name.map_or_else(|| format!("line {line}"), str::to_owned);
        let mut properties = Map::new();
        properties.insert("id".to_owned(), json!(name));
        for key in NUMBERS {
            if let Some(text) = of(key) {
                let number = number(text).ok_or_else(|| {
                    format!("line {line}: `{}` is no number", text.escape_debug())
                })?;
                properties.insert(key.to_owned(), json!(number));
            }
        }
        if let Some(text) = of("heights_m") {
            let heights_m = list(text).ok_or_else(|| {
                let text = text.escape_debug();
                format!("line {line}: `{text}` is no list of numbers, such as [35, 40]")
            })?;
            properties.insert("heights_m".to_owned(), json!(heights_m));
        }
        let found = geojson_of_wkt(cell(geometry).unwrap_or_default());
        let geometry: Value = found.map_err(|why| {
            let column = names.get(geometry).unwrap_or_default().escape_debug();
            format!("line {line}, column {column}: {why}; {}", command(file))
        })?;
        features.push(json!({"type": "Feature", "properties": properties, "geometry": geometry}));
    }
    let all = json!({"type": "FeatureCollection", "features": features});
    Ok(all.to_string().into_bytes())
}

/// What makes a file of it that is read.
pub(super) fn command(file: &str) -> String {
    let stem = file.rsplit_once('.').map_or(file, |(stem, _)| stem);
    let (old, new) = (shell_word(file), shell_word(&format!("{stem}.geojson")));
    format!(
        "`ogr2ogr -f GeoJSON -lco RFC7946=YES -s_srs EPSG:CODE -t_srs EPSG:4326 {new} {old}` converts it, with the \
         code of its coordinates for CODE, such as 4326"
    )
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Numbers as JSON has them, or as GDAL writes them: `(2:35,40)`.
fn list(text: &str) -> Option<Vec<f64>> {
    let within = match text.strip_prefix('[') {
        Some(json) => json.strip_suffix(']')?,
        None => {
            text.strip_prefix('(')?
                .strip_suffix(')')?
                .split_once(':')?
                .1
        }
    };
    within.split(',').map(|text| number(text.trim())).collect()
}
