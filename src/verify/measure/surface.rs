//! The ground under a line, as a chain of parabolas.

use crate::geodesy::{LatLon, METRES_PER_DEG};
use crate::spec::Hill;
use crate::world::{NoData, Terrain, TerrainGrid};

use super::hills::Hills;
use super::outline::metres_per_degree;
use super::patch::{ERROR_M, Patch, SHARE};
use super::segment::{Segment, Stretch};

/// One bound for all hills together does where it lets parabolas be as long as this, metres.
const GENTLE_M: f64 = 10.0;

/// The ground, with a bound of how fast it bends.
#[derive(Clone, Debug)]
pub(crate) struct Surface<'a> {
    terrain: &'a Terrain,
    /// Bound of the third derivative along any line, 1/m^2; 0 where parabolas are exact.
    third_derivative: f64,
    /// Hills that are evaluated one by one, where a common bound would be too loose: they are
    /// steep, or there are many.
    steep: Option<Hills>,
}

impl<'a> Surface<'a> {
    pub(crate) fn new(terrain: &'a Terrain) -> Self {
        let third_derivative = match terrain {
            Terrain::Flat(_) | Terrain::Grid(_) | Terrain::Unknown => 0.0,
            // |d^3/dx^3 exp(-x^2)| stays below 4.
            Terrain::Analytic { hills, .. } => hills
                .iter()
                .map(|hill: &Hill| 4.0 * hill.height_m.abs() / hill.radius_m.powi(3))
                .sum(),
        };
        let steep = match terrain {
            Terrain::Analytic { base, hills } if longest_m(third_derivative) < GENTLE_M => {
                Some(Hills::new(base.0, hills))
            }
            _ => None,
        };
        Self {
            terrain,
            third_derivative,
            steep,
        }
    }

    /// The terrain that it is made of.
    pub(crate) fn terrain(&self) -> &'a Terrain {
        self.terrain
    }

    /// The height of the ground at a place, metres above the sea.
    pub(crate) fn height_m(&self, place: LatLon) -> Result<f64, NoData> {
        Ok(self.terrain.height(place)?.0)
    }

    /// A bound of the slope of the ground, rise over run, within `within_m` of the line
    /// between two places; on a grid, in the cell of a place on that line and its neighbours.
    pub(crate) fn steepest(&self, line: (LatLon, LatLon), within_m: f64, place: LatLon) -> f64 {
        if let Some(hills) = &self.steep {
            return hills.steepest(line, within_m);
        }
        match self.terrain {
            // Where the ground is not known, its height is not either.
            Terrain::Flat(_) | Terrain::Unknown => 0.0,
            // |d/dx exp(-x^2)| stays below 0.858.
            Terrain::Analytic { hills, .. } => hills
                .iter()
                .map(|hill: &Hill| 0.87 * hill.height_m.abs() / hill.radius_m)
                .sum(),
            Terrain::Grid(grid) => steepest_cell(grid, place),
        }
    }

    /// By how much the ground differs at most between a segment and the bow that is flown, metres.
    pub(crate) fn bow_rise_m(
        &self,
        segment: &Segment,
        part: &Stretch,
        (patch, w): (&Patch, f64),
    ) -> f64 {
        if segment.bow_m <= 0.0 {
            return 0.0;
        }
        let line = (part.place(patch.w.0), part.place(patch.w.1));
        segment.bow_m * self.steepest(line, segment.bow_m, part.place(w))
    }

    /// The ground under the line between two places, straight in latitude and longitude.
    ///
    /// On a grid the line is cut where it crosses rows and columns; within one
    /// bilinear cell the ground under it is exactly a parabola.
    pub(crate) fn under(&self, from: LatLon, to: LatLon) -> Result<Vec<Patch>, NoData> {
        if let Some(hills) = &self.steep {
            return Ok(hills.under(from, to));
        }
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

    /// Cuts close enough that a parabola through three points is within a millimetre.
    fn even_cuts(&self, from: LatLon, to: LatLon) -> (Vec<f64>, f64) {
        let length_m =
            METRES_PER_DEG * (to.lat_deg - from.lat_deg).hypot(to.lon_deg - from.lon_deg);
        let step_m = longest_m(self.third_derivative);
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
        (cuts, self.third_derivative * piece_m.powi(3) / SHARE)
    }
}

/// The longest piece with a parabola near enough, metres.
fn longest_m(third_derivative: f64) -> f64 {
    (ERROR_M * SHARE / third_derivative).cbrt()
}

/// The steepest slope in the cell of a place and its neighbours: in a bilinear cell
/// no slope east or north exceeds that of the steeper of two opposite edges.
fn steepest_cell(grid: &TerrainGrid, place: LatLon) -> f64 {
    let (row, column) = grid.row_column(place);
    let (north, east) = metres_per_degree(place.lat_deg);
    let (down_m, across_m) = (grid.row_step_deg * north, grid.column_step_deg * east);
    let around = |at: f64| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "negative numbers become 0"
        )]
        let index = at as usize;
        index.saturating_sub(1)..=index.saturating_add(1)
    };
    around(row)
        .flat_map(|row| around(column).filter_map(move |column| grid.cell_m(row, column)))
        .map(|[north_west, north_east, south_west, south_east]| {
            let across = (north_east - north_west)
                .abs()
                .max((south_east - south_west).abs());
            let down = (south_west - north_west)
                .abs()
                .max((south_east - north_east).abs());
            (across / across_m).hypot(down / down_m)
        })
        .fold(0.0, f64::max)
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::Surface;
    use crate::geodesy::LatLon;
    use crate::verify::measure::outline::metres_per_degree;
    use crate::world::{Terrain, TerrainGrid};

    fn grid(heights_m: &[f32]) -> Terrain {
        Terrain::Grid(TerrainGrid {
            raised_m: 0.0,
            north_west: LatLon {
                lat_deg: 47.0,
                lon_deg: 8.0,
            },
            row_step_deg: 1.0 / 1200.0,
            column_step_deg: 1.0 / 1200.0,
            rows: 4,
            columns: 5,
            heights_m: heights_m.to_vec(),
        })
    }

    fn place((row, column): (f64, f64)) -> LatLon {
        LatLon {
            lat_deg: 47.0 - row / 1200.0,
            lon_deg: 8.0 + column / 1200.0,
        }
    }

    proptest! {
        #[test]
        fn the_ground_near_a_place_is_no_steeper_than_the_bound(
            heights_m in prop::collection::vec(0.0..200.0_f32, 20),
            from in (0.0..3.0, 0.0..4.0),
            way in (-0.01..0.01, -0.01..0.01),
        ) {
            let terrain = grid(&heights_m);
            let surface = Surface::new(&terrain);
            let to: (f64, f64) = (from.0 + way.0, from.1 + way.1);
            let to = (to.0.clamp(0.0, 3.0), to.1.clamp(0.0, 4.0));
            let (a, b) = (place(from), place(to));
            let (north, east) = metres_per_degree(a.lat_deg);
            let away_m = ((b.lat_deg - a.lat_deg) * north).hypot((b.lon_deg - a.lon_deg) * east);
            let rise_m = (surface.height_m(b).unwrap() - surface.height_m(a).unwrap()).abs();
            prop_assert!(rise_m <= surface.steepest((a, b), away_m, a) * away_m * 1.0001 + 1e-7);
        }

        /// No sample lies below what the parabolas give, and the least is nearly reached.
        #[test]
        fn the_least_clearance_over_a_grid_is_that_of_dense_samples(
            heights_m in prop::collection::vec(0.0..200.0_f32, 20),
            from in (0.0..3.0, 0.0..4.0),
            to in (0.0..3.0, 0.0..4.0),
            rise_m in -50.0..50.0_f64,
        ) {
            const SAMPLES: u32 = 4000;
            let terrain = grid(&heights_m);
            let surface = Surface::new(&terrain);
            let (a, b) = (place(from), place(to));
            let line_m = |w: f64| 300.0 + rise_m * w;
            let exact_m = surface
                .under(a, b)
                .unwrap()
                .iter()
                .map(|patch| {
                    let ends = (line_m(patch.w.0), line_m(patch.w.1));
                    patch.min_clearance_m(ends.0 - patch.height_m.0, ends.1 - patch.height_m.1).0
                })
                .fold(f64::INFINITY, f64::min);
            let sampled_m = (0..=SAMPLES)
                .map(|index| {
                    let w = f64::from(index) / f64::from(SAMPLES);
                    let at = LatLon {
                        lat_deg: a.lat_deg + (b.lat_deg - a.lat_deg) * w,
                        lon_deg: a.lon_deg + (b.lon_deg - a.lon_deg) * w,
                    };
                    line_m(w) - surface.height_m(at).unwrap()
                })
                .fold(f64::INFINITY, f64::min);
            prop_assert!(exact_m <= sampled_m + 1e-6, "{exact_m} {sampled_m}");
            // 500 m in 4000 steps over slopes of at most 4, and half a step to a sample.
            prop_assert!(exact_m >= sampled_m - 0.5, "{exact_m} {sampled_m}");
        }
    }
}
