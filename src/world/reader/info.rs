//! What an elevation file holds.

use std::path::Path;

use super::{Source, TerrainError, Window, remedy};
use crate::geodesy::{Amsl, LatLon};

/// Most nodes in memory while a file is looked at.
const AT_ONCE: usize = 1 << 24;

/// What one elevation file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct TerrainInfo {
    /// Kind of file and how it is packed, such as `SRTM tile, gzip`.
    pub format: &'static str,
    /// South-westernmost node.
    pub south_west: LatLon,
    /// North-easternmost node.
    pub north_east: LatLon,
    /// Nodes from north to south.
    pub rows: usize,
    /// Nodes from west to east.
    pub columns: usize,
    /// Degrees of latitude between rows.
    pub row_step_deg: f64,
    /// Degrees of longitude between columns.
    pub column_step_deg: f64,
    /// Nodes without data.
    pub voids: usize,
    /// Lowest and highest ground; `None` without any data.
    pub range: Option<(Amsl, Amsl)>,
    /// What the heights are measured from, and who says so.
    pub datum: String,
}

/// Reads an elevation file from end to end, a part at a time.
///
/// # Errors
/// [`TerrainError`], as for reading it.
pub fn inspect(path: &Path) -> Result<TerrainInfo, TerrainError> {
    inspected(path).map_err(|error| remedy::with_command(path, error))
}

fn inspected(path: &Path) -> Result<TerrainInfo, TerrainError> {
    let source = Source::open(path)?;
    let nodes = source.nodes();
    let (rows, columns) = nodes.size();
    let (mut voids, mut range) = (0, None::<(f32, f32)>);
    let step = (AT_ONCE / columns).max(1);
    for first_row in (0..rows).step_by(step) {
        let part = Window {
            first_row,
            rows: step.min(rows - first_row),
            first_column: 0,
            columns,
        };
        for height_m in source.read(part)? {
            if height_m.is_nan() {
                voids += 1;
            } else {
                let (low, high) = range.unwrap_or((height_m, height_m));
                range = Some((low.min(height_m), high.max(height_m)));
            }
        }
    }
    let nowhere = || TerrainError::Layout("pixels that are nowhere on earth".to_owned());
    let extent = nodes.extent().ok_or_else(nowhere)?;
    let (row_step_deg, column_step_deg) = nodes.steps_deg(extent).ok_or_else(nowhere)?;
    Ok(TerrainInfo {
        format: source.format(),
        south_west: extent.south_west,
        north_east: extent.north_east,
        rows,
        columns,
        row_step_deg,
        column_step_deg,
        voids,
        range: range.map(|(low, high)| (Amsl(f64::from(low)), Amsl(f64::from(high)))),
        datum: source.datum(),
    })
}
