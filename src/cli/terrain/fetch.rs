//! `sortie terrain fetch`: the tiles of a spec from a server of SRTM tiles.
//!
//! A tile is written next to its final name, checked from end to end, and then renamed. A
//! broken transfer is resumed if the server still has the same file (`ETag` or
//! `Last-Modified`); otherwise it starts again.

use std::fs;
use std::path::{Path, PathBuf};

use super::http::{Client, Outcome};
use super::unusable;
use crate::cli::args;
use crate::cli::print::console::{note, out};
use crate::cli::print::failure::Failure;
use crate::cli::print::progress::Progress;
use crate::geodesy::LatLon;
use crate::spec::{Area, SpecFile, TerrainSource};
use crate::world::{self, Bounds};

/// How the names of tiles of one degree end.
const ENDINGS: [&str; 5] = [".hgt", ".hgt.gz", ".hgt.zip", ".tif", ".tiff"];

/// A square of one degree by its south-west corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Square {
    lat_deg: i32,
    lon_deg: i32,
}

/// An address with places for a square.
struct Template<'a> {
    text: &'a str,
    /// How the files end that come from it.
    ending: &'static str,
}

pub(crate) fn run(arguments: &args::TerrainFetch) -> Result<(), Failure> {
    let template = Template::new(&arguments.url)?;
    let file = SpecFile::read(&arguments.spec)?;
    let (TerrainSource::Folder(_), Some(folder)) = (&file.spec.terrain, file.terrain_path()) else {
        let message =
            "the spec names no folder of tiles to fetch into (allowed: terrain: {folder: tiles})";
        return Err(Failure::new(Failure::INPUT, message));
    };
    fs::create_dir_all(&folder).map_err(|error| {
        let message = format!("cannot write {}: {error}", folder.display());
        Failure::new(Failure::OUTPUT, message)
    })?;
    let client = Client::new();
    let progress = Progress::start();
    let mut missing = Vec::new();
    let squares = squares(Bounds::around(&file.spec.area));
    for (index, square) in squares.iter().enumerate() {
        let (name, number) = (square.name(), index + 1);
        progress.say(&format!("{name} ({number} of {})", squares.len()));
        if let Some(path) = square.at_hand(&folder) {
            check(*square, &path)?;
            out(&format!("{}: there already", path.display()))?;
            continue;
        }
        let path = folder.join(format!("{}{}", square.name(), template.ending));
        let url = template.fill(*square);
        match client.get(&url, &path, |arrived| check(*square, arrived))? {
            Outcome::Written { bytes, resumed } => {
                let how = if resumed { ", resumed" } else { "" };
                out(&format!("{}: {bytes} bytes{how}", path.display()))?;
            }
            Outcome::NotThere => missing.push((*square, url)),
        }
    }
    drop(progress);
    report_missing(&missing, &file.spec.area)
}

/// A tile that the server lacks is a failure within the area, and a note in the margin around it.
fn report_missing(missing: &[(Square, String)], area: &Area) -> Result<(), Failure> {
    let mut needed = Vec::new();
    for (square, url) in missing {
        let line = format!("{url}: the server has no such file");
        if square.touches(area) {
            needed.push(line);
        } else {
            note(&format!(
                "{line}; only the margin around the area is without it"
            ));
        }
    }
    if needed.is_empty() {
        Ok(())
    } else {
        Err(Failure::all(Failure::TRANSFER, needed))
    }
}

/// Whether a file is whole and of its square.
fn check(square: Square, path: &Path) -> Result<(), Failure> {
    let found = world::inspect(path).map_err(|error| unusable(path, &error))?;
    let (south, west) = (f64::from(square.lat_deg), f64::from(square.lon_deg));
    // Grids of areas end half a step or a whole one before the next degree.
    let (row, column) = (1.01 * found.row_step_deg, 1.01 * found.column_step_deg);
    let holds = found.south_west.lat_deg <= south + row
        && found.south_west.lon_deg <= west + column
        && found.north_east.lat_deg >= south + 1.0 - row
        && found.north_east.lon_deg >= west + 1.0 - column;
    if holds {
        return Ok(());
    }
    let message = format!("{}: not the tile {}", path.display(), square.name());
    Err(Failure::new(Failure::INPUT, message))
}

/// The squares that hold something within bounds.
fn squares(bounds: Bounds) -> Vec<Square> {
    let range = |from: f64, to: f64| {
        #[expect(clippy::cast_possible_truncation, reason = "whole degrees")]
        let (first, last) = (from.floor() as i32, (to.ceil() as i32) - 1);
        first..=last.max(first)
    };
    let (south_west, north_east) = (bounds.south_west, bounds.north_east);
    let lats = range(south_west.lat_deg, north_east.lat_deg);
    lats.flat_map(|lat_deg| {
        range(south_west.lon_deg, north_east.lon_deg)
            .map(move |lon_deg| Square { lat_deg, lon_deg })
    })
    .filter(|square| (-90..90).contains(&square.lat_deg) && (-180..180).contains(&square.lon_deg))
    .collect()
}

impl Square {
    fn north(self) -> char {
        if self.lat_deg < 0 { 'S' } else { 'N' }
    }

    fn east(self) -> char {
        if self.lon_deg < 0 { 'W' } else { 'E' }
    }

    fn lat(self) -> String {
        format!("{:02}", self.lat_deg.unsigned_abs())
    }

    fn lon(self) -> String {
        format!("{:03}", self.lon_deg.unsigned_abs())
    }

    /// Such as `N36W085`.
    fn name(self) -> String {
        format!(
            "{}{}{}{}",
            self.north(),
            self.lat(),
            self.east(),
            self.lon()
        )
    }

    /// The file of a folder that holds it, under whatever ending.
    fn at_hand(self, folder: &Path) -> Option<PathBuf> {
        let names = ENDINGS.iter();
        names
            .map(|ending| folder.join(format!("{}{ending}", self.name())))
            .find(|path| path.exists())
    }

    fn touches(self, area: &Area) -> bool {
        let LatLon {
            lat_deg: south,
            lon_deg: west,
        } = area.south_west;
        let LatLon {
            lat_deg: north,
            lon_deg: east,
        } = area.north_east;
        let (lat_deg, lon_deg) = (f64::from(self.lat_deg), f64::from(self.lon_deg));
        lat_deg < north && lat_deg + 1.0 > south && lon_deg < east && lon_deg + 1.0 > west
    }
}

impl<'a> Template<'a> {
    fn new(text: &'a str) -> Result<Self, Failure> {
        let usage = |found: String| Err(Failure::new(Failure::USAGE, found));
        if !text.starts_with("http://") {
            return usage(format!(
                "--url {text}: only http:// is spoken here; get tiles from an https server with another program"
            ));
        }
        let file = text.split(['?', '#']).next().unwrap_or(text);
        let Some(ending) = ENDINGS.iter().rev().find(|ending| file.ends_with(**ending)) else {
            let allowed = ENDINGS.join(", ");
            return usage(format!(
                "--url {text}: no elevation file (allowed: {allowed})"
            ));
        };
        let template = Self { text, ending };
        let one = Square {
            lat_deg: 12,
            lon_deg: 34,
        };
        let filled = template.fill(one);
        if filled.contains(['{', '}']) {
            return usage(format!("--url {text}: unknown name (allowed: {FIELDS})"));
        }
        let others = [
            Square {
                lat_deg: -12,
                ..one
            },
            Square {
                lon_deg: -34,
                ..one
            },
            Square { lat_deg: 13, ..one },
            Square { lon_deg: 35, ..one },
        ];
        if others.iter().any(|other| template.fill(*other) == filled) {
            return usage(format!(
                "--url {text}: the same for different tiles (allowed: {FIELDS})"
            ));
        }
        Ok(template)
    }

    fn fill(&self, square: Square) -> String {
        self.text
            .replace("{tile}", &square.name())
            .replace("{ns}", &square.north().to_string())
            .replace("{ew}", &square.east().to_string())
            .replace("{lat}", &square.lat())
            .replace("{lon}", &square.lon())
    }
}

/// The fields of a template.
const FIELDS: &str = "{tile} such as N36W085, {ns}, {ew}, {lat} of two digits, {lon} of three";

#[cfg(test)]
mod tests {
    use super::*;

    fn place(lat_deg: f64, lon_deg: f64) -> LatLon {
        LatLon { lat_deg, lon_deg }
    }

    #[test]
    fn a_template_is_filled_for_every_hemisphere() {
        let text = "http://tiles.example/{ns}{lat}/{tile}.hgt.gz";
        let template = Template::new(text).expect("a template");
        assert_eq!(template.ending, ".hgt.gz");
        let fill = |lat_deg, lon_deg| template.fill(Square { lat_deg, lon_deg });
        assert_eq!(fill(36, -85), "http://tiles.example/N36/N36W085.hgt.gz");
        assert_eq!(fill(-1, 7), "http://tiles.example/S01/S01E007.hgt.gz");
    }

    #[test]
    fn a_template_that_cannot_tell_tiles_apart_is_refused() {
        for (text, why) in [
            ("https://tiles.example/{tile}.hgt", "only http://"),
            ("http://tiles.example/{tile}.png", "no elevation file"),
            ("http://tiles.example/{name}.hgt", "unknown name"),
            ("http://tiles.example/{lat}{lon}.hgt", "the same"),
            ("http://tiles.example/{ns}{lat}.hgt", "the same"),
        ] {
            let error = Template::new(text).err().expect("refused");
            assert!(error.message.contains(why), "{}", error.message);
            assert_eq!(error.code, Failure::USAGE);
        }
    }

    #[test]
    fn the_squares_of_an_area_are_those_it_touches() {
        let all = |south_west, north_east| {
            let found = squares(Bounds {
                south_west,
                north_east,
            });
            found.into_iter().map(Square::name).collect::<Vec<_>>()
        };
        assert_eq!(all(place(36.2, -84.9), place(36.4, -84.6)), ["N36W085"]);
        assert_eq!(all(place(36.0, -85.0), place(37.0, -84.0)), ["N36W085"]);
        assert_eq!(
            all(place(-0.1, -0.1), place(0.1, 0.1)),
            ["S01W001", "S01E000", "N00W001", "N00E000"]
        );
    }
}
