//! Starts and goals in rows and columns.

use super::super::raw;
use super::cells::Part;
use super::expanded::{MOST, Making};
use crate::geodesy::{EastNorth, LatLon, LocalFrame};

/// Greatest side of a grid, metres: as far as the local frame is proven.
const MOST_GRID_M: f64 = 300_000.0;

impl Making<'_, '_> {
    /// A part of a vehicle for each place of the grids.
    pub(super) fn grids(&mut self) -> Vec<(Part, Option<usize>)> {
        let starts = self.fleet.start_grid;
        let starts = starts.map(|grid| self.grid("fleet.start_grid", grid));
        let goals = self.fleet.goal_grid;
        let goals = goals.map(|grid| self.grid("fleet.goal_grid", grid));
        let number = match (&starts, &goals) {
            (None, None) => {
                let allowed = "csv, start_grid, goal_grid or both grids";
                self.checker
                    .report("fleet", "no starts and no goals", allowed);
                return Vec::new();
            }
            // A broken one is reported already.
            (Some(None), _) | (_, Some(None)) => return Vec::new(),
            (Some(Some(starts)), Some(Some(goals))) if starts.len() != goals.len() => {
                let found = format!("{} goals for {} starts", goals.len(), starts.len());
                let allowed = format!("rows and columns of {} places", starts.len());
                self.checker.report("fleet.goal_grid", found, allowed);
                return Vec::new();
            }
            (Some(Some(places)), _) | (None, Some(Some(places))) => places.len(),
        };
        let (starts, goals) = (starts.flatten(), goals.flatten());
        let parts = (0..number).map(|index| {
            let mut part = self.part(index);
            for (end, places) in [
                (&mut part.rest.start, &starts),
                (&mut part.rest.goal, &goals),
            ] {
                if let Some(places) = places {
                    let end = end.get_or_insert_default();
                    end.lat = Some(places[index].lat_deg);
                    end.lon = Some(places[index].lon_deg);
                }
            }
            (part, None)
        });
        parts.collect()
    }

    /// The places of a grid, row by row.
    fn grid(&mut self, path: &str, grid: raw::Grid) -> Option<Vec<LatLon>> {
        let before = self.checker.issues.len();
        let at = |key: &str| format!("{path}.{key}");
        self.checker.count(&at("rows"), grid.rows, 1..=MOST);
        self.checker.count(&at("columns"), grid.columns, 1..=MOST);
        let spacing_m = self
            .checker
            .number(&at("spacing_m"), grid.spacing_m, 0.1..=100_000.0);
        let corner = grid.south_west;
        let corner = self
            .checker
            .place(&at("south_west"), corner.lat, corner.lon)?;
        if self.checker.issues.len() > before {
            return None;
        }
        let number = grid.rows * grid.columns;
        if number > MOST {
            let found = format!("{number} places");
            self.checker.report(path, found, format!("at most {MOST}"));
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "ten thousand at most")]
        let away_m = |count: u64| count as f64 * spacing_m;
        let side_m = away_m(grid.rows.max(grid.columns) - 1);
        if side_m > MOST_GRID_M {
            let found = format!("a side of {:.0} km", side_m / 1e3);
            let allowed = format!("at most {:.0} km", MOST_GRID_M / 1e3);
            self.checker.report(path, found, allowed);
            return None;
        }
        let frame = LocalFrame::new(corner);
        let places = (0..number).map(|index| {
            frame.from_plan(EastNorth {
                east_m: away_m(index % grid.columns),
                north_m: away_m(index / grid.columns),
            })
        });
        Some(places.collect())
    }
}
