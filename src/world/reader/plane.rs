//! Grids in the plane of a map projection.

use proj4rs::Proj;
use proj4rs::transform::transform;

use super::{Bounds, TerrainError, Window};
use crate::geodesy::LatLon;

/// Points on each side of an outline that is projected.
const OUTLINE_POINTS: u32 = 24;

/// A coordinate reference system with a code of EPSG, and the way to WGS84.
#[derive(Clone, Debug)]
pub(super) struct Projection {
    code: u16,
    from: Proj,
    wgs84: Proj,
    /// How far a place may be from where the definition puts it, metres.
    pub(super) error_m: f64,
}

impl Projection {
    /// None where no definition is known, or none that leads to WGS84 without grids of shifts.
    pub(super) fn of_epsg(code: u16) -> Option<Self> {
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

    /// The name of the system.
    pub(super) fn name(&self) -> String {
        format!("EPSG:{}", self.code)
    }

    /// The place of a point east and north in the units of the system; degrees in one of degrees.
    fn place(&self, east: f64, north: f64) -> Option<LatLon> {
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

    /// The reverse of [`Self::place`].
    fn point(&self, place: LatLon) -> Option<(f64, f64)> {
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

/// The nodes of a file in a plane: rows go south, columns east.
#[derive(Clone, Debug)]
pub(super) struct PlaneLattice {
    pub(super) projection: Projection,
    /// East and north of the first node, in the units of the system.
    pub(super) first: (f64, f64),
    /// Between columns and rows, both positive.
    pub(super) step: (f64, f64),
    pub(super) rows: usize,
    pub(super) columns: usize,
}

impl PlaneLattice {
    /// The place of a node, or of a point between nodes.
    pub(super) fn place(&self, row: f64, column: f64) -> Option<LatLon> {
        let (east, north) = (
            self.first.0 + column * self.step.0,
            self.first.1 - row * self.step.1,
        );
        self.projection.place(east, north)
    }

    /// Row and column of a place, with fractions.
    pub(super) fn row_column(&self, place: LatLon) -> Option<(f64, f64)> {
        let (east, north) = self.projection.point(place)?;
        Some((
            (self.first.1 - north) / self.step.1,
            (east - self.first.0) / self.step.0,
        ))
    }

    /// The part of the earth that it covers.
    pub(super) fn extent(&self) -> Option<Bounds> {
        let (last_row, last_column) = (count(self.rows - 1), count(self.columns - 1));
        around(outline().filter_map(|(x, y)| {
            self.place(y * last_row, x * last_column)
                .map(|place| (place.lat_deg, place.lon_deg))
        }))
        .map(|(south, north, west, east)| Bounds {
            south_west: LatLon {
                lat_deg: south,
                lon_deg: west,
            },
            north_east: LatLon {
                lat_deg: north,
                lon_deg: east,
            },
        })
    }

    /// The nodes within bounds and two more on each side; all of them without bounds.
    pub(super) fn window(&self, bounds: Option<Bounds>) -> Result<Window, TerrainError> {
        let whole = Window {
            first_row: 0,
            rows: self.rows,
            first_column: 0,
            columns: self.columns,
        };
        let Some(Bounds {
            south_west,
            north_east,
        }) = bounds
        else {
            return Ok(whole);
        };
        let corners = outline().filter_map(|(x, y)| {
            let mix = |from: f64, to: f64, share: f64| from + (to - from) * share;
            self.row_column(LatLon {
                lat_deg: mix(south_west.lat_deg, north_east.lat_deg, y),
                lon_deg: mix(south_west.lon_deg, north_east.lon_deg, x),
            })
        });
        let cut = around(corners).and_then(|(top, bottom, left, right)| {
            let (first_row, rows) = span(top, bottom, self.rows)?;
            let (first_column, columns) = span(left, right, self.columns)?;
            Some(Window {
                first_row,
                rows,
                first_column,
                columns,
            })
        });
        cut.ok_or_else(|| match self.extent() {
            Some(extent) => TerrainError::Elsewhere {
                south: extent.south_west.lat_deg,
                north: extent.north_east.lat_deg,
                west: extent.south_west.lon_deg,
                east: extent.north_east.lon_deg,
            },
            None => TerrainError::Layout("pixels that are nowhere on earth".to_owned()),
        })
    }
}

/// Points along the edge of the unit square.
fn outline() -> impl Iterator<Item = (f64, f64)> {
    (0..OUTLINE_POINTS).flat_map(|index| {
        let share = f64::from(index) / f64::from(OUTLINE_POINTS);
        [
            (share, 0.0),
            (1.0, share),
            (1.0 - share, 1.0),
            (0.0, 1.0 - share),
        ]
    })
}

/// Least and greatest of the first and of the second numbers.
fn around(points: impl Iterator<Item = (f64, f64)>) -> Option<(f64, f64, f64, f64)> {
    let none = (
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
    );
    let all = points.fold(none, |all, (a, b)| {
        (all.0.min(a), all.1.max(a), all.2.min(b), all.3.max(b))
    });
    all.0.is_finite().then_some(all)
}

/// First and number of the nodes from one to another, two more on each side.
fn span(from: f64, to: f64, nodes: usize) -> Option<(usize, usize)> {
    let last = count(nodes.checked_sub(1)?);
    if from > last || to < 0.0 || nodes < 2 {
        return None;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped"
    )]
    let (first, end) = (
        (from.floor() - 2.0).clamp(0.0, last - 1.0) as usize,
        (to.ceil() + 2.0).clamp(1.0, last) as usize,
    );
    Some((first, end.max(first + 1) + 1 - first))
}

#[expect(
    clippy::cast_precision_loss,
    reason = "grids have far fewer than 2^52 rows"
)]
fn count(nodes: usize) -> f64 {
    nodes as f64
}
