//! Starts and goals in rows and columns.

use serde_yaml::{Mapping, Value};

use super::super::Checker;
use super::{MAX_VEHICLES, Own};
use crate::geodesy::{EastNorth, LatLon, LocalFrame};
use crate::spec::keys;

/// Greatest side of a grid, metres: the local frame is accurate up to this distance.
const MAX_SIDE_M: f64 = 300_000.0;

impl Checker {
    /// One entry for each vehicle, with the start and goal that the grids give it.
    pub(super) fn grids(&mut self, fleet: &keys::Fleet) -> Vec<Own> {
        let starts = fleet.start_grid;
        let starts = starts.map(|grid| self.grid("fleet.start_grid", grid));
        let goals = fleet.goal_grid;
        let goals = goals.map(|grid| self.grid("fleet.goal_grid", grid));
        let count = match (&starts, &goals) {
            (None, None) => {
                let allowed = "csv, start_grid, goal_grid or both grids";
                self.report("fleet", "no starts and no goals", allowed);
                return Vec::new();
            }
            // An invalid grid has been reported.
            (Some(None), _) | (_, Some(None)) => return Vec::new(),
            (Some(Some(starts)), Some(Some(goals))) if starts.len() != goals.len() => {
                let found = format!("{} goals for {} starts", goals.len(), starts.len());
                let allowed = format!("a grid of {} positions", starts.len());
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
        (0..count).map(own).collect()
    }

    /// The positions of a grid, row by row.
    fn grid(&mut self, path: &str, grid: keys::Grid) -> Option<Vec<LatLon>> {
        let corner = self.place(&format!("{path}.south_west"), grid.south_west)?;
        let is_count = |number: u64| (1..=MAX_VEHICLES).contains(&number);
        if !is_count(grid.rows) || !is_count(grid.columns) || !grid.spacing_m.is_finite() {
            // The range check has reported it.
            return None;
        }
        let count = grid.rows * grid.columns;
        if count > MAX_VEHICLES {
            let allowed = format!("at most {MAX_VEHICLES}");
            self.report(path, format!("{count} places"), allowed);
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "at most ten thousand")]
        let offset_m = |steps: u64| steps as f64 * grid.spacing_m;
        let side_m = offset_m(grid.rows.max(grid.columns) - 1);
        if side_m > MAX_SIDE_M {
            let found = format!("a side {:.0} km long", side_m / 1e3);
            let allowed = format!("at most {:.0} km", MAX_SIDE_M / 1e3);
            self.report(path, found, allowed);
            return None;
        }
        let frame = LocalFrame::new(corner);
        let positions = (0..count).map(|index| {
            frame.from_plan(EastNorth {
                east_m: offset_m(index % grid.columns),
                north_m: offset_m(index / grid.columns),
            })
        });
        Some(positions.collect())
    }
}
