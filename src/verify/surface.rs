//! The ground under a line, as a chain of parabolas.

use crate::geodesy::LatLon;
use crate::spec::Hill;
use crate::world::{NoData, Terrain, TerrainGrid};

/// Metres in a degree on the sphere that analytic hills are drawn on.
const METRES_PER_DEGREE: f64 = 111_195.08;

/// The ground, with a bound of how fast it bends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface<'a> {
    terrain: &'a Terrain,
    /// Bound of the third derivative along any line, 1/m^2; 0 where parabolas are exact.
    third_derivative: f64,
}

/// The ground over part of a line: `h0 + (h1 - h0) w + 4 bulge w (1 - w)`, `w` from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Patch {
    /// Fractions of the line at the ends.
    pub(super) w: (f64, f64),
    /// Heights above the sea at the ends, metres.
    pub(super) height_m: (f64, f64),
    /// Height of the middle above the straight line between the ends, metres.
    pub(super) bulge_m: f64,
    /// The ground is within this of the parabola, metres.
    pub(super) error_m: f64,
}

impl Patch {
    /// The least height of a line above the patch, from its heights above it at
    /// the ends, and the fraction of the patch where that is.
    pub(super) fn least_clearance_m(&self, from_m: f64, to_m: f64) -> (f64, f64) {
        let lower_end = if from_m <= to_m {
            (from_m, 0.0)
        } else {
            (to_m, 1.0)
        };
        // NaN at an end must come out as NaN.
        if !(from_m + to_m).is_finite() {
            return (f64::NAN, 0.0);
        }
        let mut least = lower_end;
        if self.bulge_m > 0.0 {
            let w = (4.0 * self.bulge_m - (to_m - from_m)) / (8.0 * self.bulge_m);
            if w > 0.0 && w < 1.0 {
                let inside_m = from_m + (to_m - from_m) * w - 4.0 * self.bulge_m * w * (1.0 - w);
                if inside_m < least.0 {
                    least = (inside_m, w);
                }
            }
        }
        (least.0 - self.error_m, least.1)
    }
}

impl<'a> Surface<'a> {
    pub(super) fn new(terrain: &'a Terrain) -> Self {
        let third_derivative = match terrain {
            Terrain::Flat(_) | Terrain::Grid(_) | Terrain::Unknown => 0.0,
            // |d^3/dx^3 exp(-x^2)| stays below 4.
            Terrain::Analytic { hills, .. } => hills
                .iter()
                .map(|hill: &Hill| 4.0 * hill.height_m.abs() / hill.radius_m.powi(3))
                .sum(),
        };
        Self {
            terrain,
            third_derivative,
        }
    }

    /// The height of the ground at a place, metres above the sea.
    pub(super) fn height_m(&self, place: LatLon) -> Result<f64, NoData> {
        Ok(self.terrain.height(place)?.0)
    }

    /// The ground under the line between two places, straight in latitude and longitude.
    ///
    /// On a grid the line is cut where it crosses rows and columns; within one
    /// bilinear cell the ground under it is exactly a parabola.
    pub(super) fn under(&self, from: LatLon, to: LatLon) -> Result<Vec<Patch>, NoData> {
        let (cuts, error_m) = match self.terrain {
            Terrain::Flat(_) | Terrain::Unknown => (vec![0.0, 1.0], 0.0),
            Terrain::Grid(grid) => (grid_cuts(grid, from, to), 0.0),
            Terrain::Analytic { .. } => self.even_cuts(from, to),
        };
        let at = |w: f64| LatLon {
            lat_deg: from.lat_deg + (to.lat_deg - from.lat_deg) * w,
            lon_deg: from.lon_deg + (to.lon_deg - from.lon_deg) * w,
        };
        let mut patches = Vec::with_capacity(cuts.len());
        let mut last_m = self.height_m(from)?;
        for pair in cuts.windows(2) {
            let (w0, w1) = (pair[0], pair[1]);
            let middle_m = self.height_m(at(0.5 * (w0 + w1)))?;
            let next_m = self.height_m(if w1 < 1.0 { at(w1) } else { to })?;
            patches.push(Patch {
                w: (w0, w1),
                height_m: (last_m, next_m),
                bulge_m: middle_m - 0.5 * (last_m + next_m),
                error_m,
            });
            last_m = next_m;
        }
        Ok(patches)
    }

    /// Cuts close enough that a parabola through three points is within a millimetre:
    /// it misses by at most `M L^3 / (72 sqrt 3)`, `M` the bound of the third derivative.
    fn even_cuts(&self, from: LatLon, to: LatLon) -> (Vec<f64>, f64) {
        const ERROR_M: f64 = 1e-3;
        const SHORTEST_M: f64 = 1.0;
        let length_m =
            METRES_PER_DEGREE * (to.lat_deg - from.lat_deg).hypot(to.lon_deg - from.lon_deg);
        let share = 72.0 * 3_f64.sqrt();
        let step_m = (ERROR_M * share / self.third_derivative)
            .cbrt()
            .max(SHORTEST_M);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to a small positive count"
        )]
        let count = (length_m / step_m).ceil().clamp(1.0, 1e6) as u32;
        let cuts = (0..=count)
            .map(|index| f64::from(index) / f64::from(count))
            .collect();
        let piece_m = length_m / f64::from(count);
        (cuts, self.third_derivative * piece_m.powi(3) / share)
    }
}

/// Fractions of the line at its ends and where it crosses rows and columns of the grid.
fn grid_cuts(grid: &TerrainGrid, from: LatLon, to: LatLon) -> Vec<f64> {
    let row = |place: LatLon| (grid.north_west.lat_deg - place.lat_deg) / grid.row_step_deg;
    let column = |place: LatLon| (place.lon_deg - grid.north_west.lon_deg) / grid.column_step_deg;
    let mut cuts = vec![0.0];
    let mut crossings = |a: f64, b: f64| {
        let mut line = a.min(b).floor() + 1.0;
        while line < a.max(b) {
            let w = (line - a) / (b - a);
            if w > 0.0 && w < 1.0 {
                cuts.push(w);
            }
            line += 1.0;
        }
    };
    crossings(row(from), row(to));
    crossings(column(from), column(to));
    cuts.push(1.0);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    cuts
}
