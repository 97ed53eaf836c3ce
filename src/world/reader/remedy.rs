//! The command that turns a refused elevation file into one that can be used.

use std::path::Path;

use super::TerrainError;
use crate::spec::{elevation_command, shell_word};

/// The error with the command that helps, if one does.
pub(super) fn with_command(path: &Path, error: TerrainError) -> TerrainError {
    if let TerrainError::InFile { name, error } = error {
        let error = Box::new(with_command(&path.join(&name), *error));
        return TerrainError::InFile { name, error };
    }
    match command(path, &error) {
        Some(command) => TerrainError::Convertible {
            error: Box::new(error),
            command,
        },
        None => error,
    }
}

/// What each command does to the file before it, and what the error says of the file is the reason.
fn command(path: &Path, error: &TerrainError) -> Option<String> {
    let old = shell_word(&path.to_string_lossy());
    let new = shell_word(&path.with_extension("new.tif").to_string_lossy());
    let by = |command: &str, then: &str| {
        let command = command.replace("OLD", &old).replace("NEW", &new);
        Some(format!("`{command}` {then}"))
    };
    let warp = "gdalwarp -t_srs EPSG:4326 -r bilinear OLD NEW";
    match error {
        TerrainError::UnknownKind => elevation_command(&path.to_string_lossy()),
        TerrainError::Crs(found) if found.starts_with("no ") || found.ends_with("no EPSG code") => {
            by(
                "gdalwarp -s_srs EPSG:CODE -t_srs EPSG:4326 -r bilinear OLD NEW",
                "converts it, with the code of its coordinates for CODE",
            )
        }
        TerrainError::Crs(_) => by(warp, "converts it"),
        TerrainError::NoPrj(_) => by(
            "gdalwarp -s_srs EPSG:CODE -t_srs EPSG:4326 -r bilinear OLD NEW",
            "converts it instead, with the code of its coordinates for CODE",
        ),
        TerrainError::Heights(found)
            if found.starts_with("unit") || found.contains("not in metres") =>
        {
            by(
                "gdal_calc.py -A OLD --calc=A*0.3048 --outfile=NEW",
                "converts international feet, with the factor of another unit for 0.3048",
            )
        }
        TerrainError::Heights(_) => by(
            "gdalwarp -t_srs EPSG:9707 OLD NEW",
            "converts it to heights above EGM96",
        ),
        TerrainError::Meaning(found) if found.contains("mask") || found.contains("MaskBand") => by(
            "gdalwarp -t_srs EPSG:4326 -r bilinear -dstnodata -9999 OLD NEW",
            "makes what is masked no data",
        ),
        TerrainError::Meaning(found) if found.contains("GDAL does not apply") => by(
            "gdal_calc.py -A OLD --calc=A*SCALE+OFFSET --outfile=NEW",
            "converts it, with numbers for SCALE and OFFSET",
        ),
        TerrainError::Meaning(_) => by(
            "gdal_translate -unscale -ot Float32 OLD NEW",
            "writes plain heights; look at them with `gdalinfo -mm` before",
        ),
        TerrainError::Layout(found) if found.starts_with("no place") => by(
            "gdal_translate -a_srs EPSG:4326 -a_ullr WEST NORTH EAST SOUTH OLD NEW",
            "places it, with the degrees of its edges",
        ),
        TerrainError::Layout(_) => by(warp, "lays it out anew"),
        TerrainError::Samples(found) if found.ends_with("bands") => by(
            "gdal_translate -b 1 OLD NEW",
            "takes the first band, if that holds the heights",
        ),
        TerrainError::Samples(_) => by("gdal_translate -ot Float32 OLD NEW", "converts it"),
        TerrainError::Decode(_) => by(
            "gdal_translate -co COMPRESS=DEFLATE OLD NEW",
            "writes it anew, if it is not damaged",
        ),
        TerrainError::Ascii(_) => by(
            "gdal_translate OLD NEW",
            "converts it, if it is not damaged",
        ),
        TerrainError::Png(_) => by(
            "gdal_translate -of GTiff OLD NEW",
            "helps only where the picture holds heights in metres",
        ),
        TerrainError::TooLarge(_) => by(
            "gdalwarp -t_srs EPSG:4326 -tr 0.0003 0.0003 -r max OLD NEW",
            "makes it coarser: the highest of each 30 m",
        ),
        _ => None,
    }
}
