//! Starts and goals in rows and columns.

use serde_yaml::{Mapping, Value};

use super::super::Checker;
use super::{MAX_VEHICLES, Own};
use crate::geodesy::{EastNorth, LatLon, LocalFrame};
use crate::spec::keys;

/// Greatest side of a grid, metres: the local frame is proven to here.
const MAX_SIDE_M: f64 = 300_000.0;

impl Checker {
    /// The starts and goals of the vehicles of the grids.
    pub(super) fn grids(&mut self, fleet: &keys::Fleet) -> Vec<Own> {
        let starts = fleet.start_grid;
        let starts = starts.map(|grid| self.grid("fleet.start_grid", grid));
        let goals = fleet.goal_grid;
        let goals = goals.map(|grid| self.grid("fleet.goal_grid", grid));
        let number = match (&starts, &goals) {
            (None, None) => {
                let allowed = "csv, start_grid, goal_grid or both grids";
                self.report("fleet", "no starts and no goals", allowed);
                return Vec::new();
            }
            // A broken one is reported already.
            (Some(None), _) | (_, Some(None)) => return Vec::new(),
            (Some(Some(starts)), Some(Some(goals))) if starts.len() != goals.len() => {
                let found = format!("{} goals for {} starts", goals.len(), starts.len());
                let allowed = format!("rows and columns of {} places", starts.len());
                self.report("fleet.goal_grid", found, allowed);
                return Vec::new();
            }
            (Some(Some(ends)), _) | (None, Some(Some(ends))) => ends.len(),
        };
        let ends = [("start", starts.flatten()), ("goal", goals.flatten())];
        let own = |index: usize| {
            let given = ends.iter().filter_map(|(key, ends)| {
                let place = ends.as_ref()?.get(index)?;
                let place = [("lat", place.lat_deg), ("lon", place.lon_deg)];
                let place = place.map(|(key, degrees)| (key.into(), degrees.into()));
                Some((Value::from(*key), Mapping::from_iter(place).into()))
            });
            (given.collect(), None)
        };
        (0..number).map(own).collect()
    }

    /// The positions of a grid, row by row.
    fn grid(&mut self, path: &str, grid: keys::Grid) -> Option<Vec<LatLon>> {
        let corner = self.place(&format!("{path}.south_west"), grid.south_west)?;
        let is_count = |count: u64| (1..=MAX_VEHICLES).contains(&count);
        if !is_count(grid.rows) || !is_count(grid.columns) || !grid.spacing_m.is_finite() {
            // Reported with the ranges.
            return None;
        }
        let number = grid.rows * grid.columns;
        if number > MAX_VEHICLES {
            let allowed = format!("at most {MAX_VEHICLES}");
            self.report(path, format!("{number} places"), allowed);
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "ten thousand at most")]
        let away_m = |count: u64| count as f64 * grid.spacing_m;
        let side_m = away_m(grid.rows.max(grid.columns) - 1);
        if side_m > MAX_SIDE_M {
            let found = format!("a side of {:.0} km", side_m / 1e3);
            let allowed = format!("at most {:.0} km", MAX_SIDE_M / 1e3);
            self.report(path, found, allowed);
            return None;
        }
        let frame = LocalFrame::new(corner);
        let positions = (0..number).map(|index| {
            frame.from_plan(EastNorth {
                east_m: away_m(index % grid.columns),
                north_m: away_m(index / grid.columns),
            })
        });
        Some(positions.collect())
    }
}
