//! Elevation files by their names.

use crate::numeric::text::shell_word;

/// How the names of elevation files end, in lower case.
pub const ELEVATION_ENDINGS: [&str; 7] = [
    ".hgt", ".hgt.gz", ".hgt.zip", ".tif", ".tiff", ".asc", ".png",
];

/// Kinds of files that a command of GDAL turns into a GeoTIFF without a loss, by their extension.
const OF_GDAL: &[&str] = &[
    "adf", "bil", "bt", "ddf", "dt0", "dt1", "dt2", "flt", "grd", "img", "jp2", "nc", "sdat",
    "vrt", "xyz",
];

/// The command that turns a file of another kind into an elevation file; none for kinds that hold no
/// heights.
#[must_use]
pub fn elevation_command(name: &str) -> Option<String> {
    let (stem, extension) = name.rsplit_once('.')?;
    let (old, new) = (shell_word(name), shell_word(&format!("{stem}.tif")));
    match extension.to_ascii_lowercase().as_str() {
        "las" | "laz" => Some(format!(
            "`pdal translate {old} {new} -w writers.gdal --writers.gdal.resolution=1 --writers.gdal.output_type=max` \
             makes a GeoTIFF of the highest point in each metre"
        )),
        // Those of the USGS are in degrees or zones of NAD27 as a rule.
        "dem" => Some(format!(
            "`gdalwarp -t_srs EPSG:4326 -r bilinear {old} {new}` converts it"
        )),
        kind if OF_GDAL.contains(&kind) => {
            Some(format!("`gdal_translate {old} {new}` converts it"))
        }
        _ => None,
    }
}
