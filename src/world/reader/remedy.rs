//! The command that turns a refused elevation file into one that can be used.

use std::path::Path;

use super::TerrainError;
use crate::numeric::text::shell_word;
use crate::spec::elevation_command;

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

const WARP: &str = "gdalwarp -t_srs EPSG:4326 -r bilinear OLD NEW";
const WARP_FROM: &str = "gdalwarp -s_srs EPSG:CODE -t_srs EPSG:4326 -r bilinear OLD NEW";

fn command(path: &Path, error: &TerrainError) -> Option<String> {
    if matches!(error, TerrainError::UnknownKind) {
        return elevation_command(&path.to_string_lossy());
    }
    let (command, then) = of_nodes(error).or_else(|| of_heights(error))?;
    let old = shell_word(&path.to_string_lossy());
    let new = shell_word(&path.with_extension("new.tif").to_string_lossy());
    let command = command.replace("OLD", &old).replace("NEW", &new);
    Some(format!("`{command}` {then}"))
}

/// A command and what it does.
type Remedy = (&'static str, &'static str);

/// For files whose nodes cannot be placed, or are too many.
fn of_nodes(error: &TerrainError) -> Option<Remedy> {
    let is_without_code = |found: &str| found.starts_with("no ") || found.ends_with("no EPSG code");
    Some(match error {
        TerrainError::Crs(found) if is_without_code(found) => (
            WARP_FROM,
            "converts it, with the code of its coordinates for CODE",
        ),
        TerrainError::Crs(_) => (WARP, "converts it"),
        TerrainError::NoPrj(_) => (
            WARP_FROM,
            "converts it instead, with the code of its coordinates for CODE",
        ),
        TerrainError::Layout(found) if found.starts_with("no place") => (
            "gdal_translate -a_srs EPSG:4326 -a_ullr WEST NORTH EAST SOUTH OLD NEW",
            "places it, with the degrees of its edges",
        ),
        TerrainError::Layout(_) => (WARP, "lays it out anew"),
        TerrainError::Size(_) => (
            "gdal_translate OLD NEW",
            "converts a whole tile of another size, such as 1801 x 3601; load one that was cut off again",
        ),
        TerrainError::TooLarge(_) => (
            "gdalwarp -t_srs EPSG:4326 -tr 0.0003 0.0003 -r max OLD NEW",
            "makes it coarser: the highest of each 30 m",
        ),
        _ => return None,
    })
}

/// For files whose samples are no heights that can be used.
fn of_heights(error: &TerrainError) -> Option<Remedy> {
    let is_unit = |found: &str| found.starts_with("unit") || found.contains("not in metres");
    let is_mask = |found: &str| found.contains("mask") || found.contains("MaskBand");
    Some(match error {
        TerrainError::Heights(found) if is_unit(found) => (
            "gdal_calc.py -A OLD --calc=A*0.3048 --outfile=NEW",
            "converts international feet, with the factor of another unit for 0.3048",
        ),
        TerrainError::Heights(_) => (
            "gdalwarp -t_srs EPSG:9707 OLD NEW",
            "converts it to heights above EGM96",
        ),
        TerrainError::Meaning(found) if is_mask(found) => (
            "gdalwarp -t_srs EPSG:4326 -r bilinear -dstnodata -9999 OLD NEW",
            "makes what is masked no data",
        ),
        TerrainError::Meaning(found) if found.contains("GDAL does not apply") => (
            "gdal_calc.py -A OLD --calc=A*SCALE+OFFSET --outfile=NEW",
            "converts it, with numbers for SCALE and OFFSET",
        ),
        TerrainError::Meaning(_) => (
            "gdal_translate -unscale -ot Float32 OLD NEW",
            "writes plain heights; look at them with `gdalinfo -mm` before",
        ),
        TerrainError::Samples(found) if found.ends_with("bands") => (
            "gdal_translate -b 1 OLD NEW",
            "takes the first band, if that holds the heights",
        ),
        TerrainError::Samples(_) => ("gdal_translate -ot Float32 OLD NEW", "converts it"),
        TerrainError::Decode(_) => (
            "gdal_translate -co COMPRESS=DEFLATE OLD NEW",
            "writes it anew, if it is not damaged",
        ),
        TerrainError::Ascii(_) => (
            "gdal_translate OLD NEW",
            "converts it, if it is not damaged",
        ),
        TerrainError::Png(_) => (
            "gdal_translate -of GTiff OLD NEW",
            "helps only where the picture holds heights in metres",
        ),
        _ => return None,
    })
}
