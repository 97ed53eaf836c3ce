//! The vehicles that `fleet` makes, written out as `vehicles` would have them.

use std::collections::BTreeSet;

use super::Checker;
use super::cells::{COLUMNS, Part};
use super::template::filled;
use crate::spec::positions::Positions;
use crate::spec::raw;
use crate::spec::table::Table;
use crate::spec::value_sources::{Made, ValueSources};

/// Most vehicles that `fleet` makes.
pub(super) const MOST: u64 = 10_000;
/// System ids that are given out end here, below those of ground stations.
const LAST_SYSTEM_ID: i64 = 240;

/// A spec of which all vehicles are written out, and where all of it stands.
pub(in crate::spec) struct Whole {
    pub(in crate::spec) raw: raw::Spec,
    pub(in crate::spec) places: ValueSources,
    pub(in crate::spec) issues: Vec<crate::spec::Issue>,
}

/// Writes out `fleet`.
pub(in crate::spec) fn write_out(mut raw: raw::Spec, places: Positions, table: Table) -> Whole {
    let listed = raw.vehicles.len();
    let Some(fleet) = raw.fleet.clone() else {
        return Whole {
            places: ValueSources::new(places, listed, Vec::new(), table),
            raw,
            issues: Vec::new(),
        };
    };
    let plain = ValueSources::new(places.clone(), listed, Vec::new(), Table::default());
    let mut checker = Checker {
        places: &plain,
        issues: Vec::new(),
    };
    let taken = raw.vehicles.iter().map(|vehicle| vehicle.sysid).collect();
    let mut making = Making {
        checker: &mut checker,
        fleet: &fleet,
        table: &table,
        taken,
    };
    let (made, vehicles) = making.all().into_iter().unzip();
    raw.vehicles.extend::<Vec<_>>(vehicles);
    Whole {
        issues: checker.issues,
        places: ValueSources::new(places, listed, made, table),
        raw,
    }
}

pub(super) struct Making<'a, 'b> {
    pub(super) checker: &'a mut Checker<'b>,
    pub(super) fleet: &'a raw::Fleet,
    table: &'a Table,
    /// System ids that are not given out.
    taken: BTreeSet<i64>,
}

impl Making<'_, '_> {
    fn all(&mut self) -> Vec<(Made, raw::Vehicle)> {
        let parts = match self.fleet.csv {
            Some(_) => self.rows(),
            None => self.grids(),
        };
        self.templates();
        if let Some(every_s) = self.fleet.depart_every_s {
            self.checker
                .number("fleet.depart_every_s", every_s, 0.0..=86_400.0);
        }
        let sysids = self.system_ids(&parts);
        let whole = parts.into_iter().zip(sysids).enumerate();
        whole
            .filter_map(|(index, ((part, row), sysid))| self.whole(index, part, row, sysid))
            .collect()
    }

    /// A part of a vehicle for each row of the table, with the index of the row.
    fn rows(&mut self) -> Vec<(Part, Option<usize>)> {
        for (grid, is_there) in [
            ("fleet.start_grid", self.fleet.start_grid.is_some()),
            ("fleet.goal_grid", self.fleet.goal_grid.is_some()),
        ] {
            if is_there {
                let found = "a grid, and csv";
                self.checker.report(grid, found, "either csv or grids");
            }
        }
        let (table, columns) = (self.table, &self.table.columns);
        for (column, name) in columns.iter().enumerate() {
            if !COLUMNS.contains(&name.as_str()) {
                let found = "an unknown column".to_owned();
                let issue = table.name_issue(column, found, &COLUMNS.join(", "));
                self.checker.issues.push(issue);
            }
        }
        if table.rows.is_empty() && !columns.is_empty() {
            let issue = table.row_issue(1, "", "no vehicle".to_owned(), "one row for each");
            self.checker.issues.push(issue);
        }
        if table.rows.len() as u64 > MOST {
            let found = format!("{} vehicles", table.rows.len());
            self.checker
                .report("fleet.csv", found, format!("at most {MOST}"));
            return Vec::new();
        }
        let mut parts = Vec::new();
        for (index, row) in table.rows.iter().enumerate() {
            let mut part = self.part(index);
            let filled = || columns.iter().zip(&row.cells).enumerate();
            let filled = || filled().filter(|(_, (_, cell))| !cell.is_empty());
            for (_, (name, _)) in filled() {
                part.forget_altitude(name);
            }
            for (column, (name, cell)) in filled() {
                if !COLUMNS.contains(&name.as_str()) {
                    continue;
                }
                if let Err(allowed) = part.set(name, cell) {
                    let found = format!("`{}`", cell.escape_debug());
                    let issue = table.cell_issue(row.line, column, found, &allowed);
                    self.checker.issues.push(issue);
                }
            }
            parts.push((part, Some(index)));
        }
        parts
    }

    /// What a vehicle has of the defaults; `index` counts in the fleet.
    pub(super) fn part(&self, index: usize) -> Part {
        let mut part = Part {
            rest: self.fleet.defaults.clone(),
            ..Part::default()
        };
        let every_s = self.fleet.depart_every_s.unwrap_or(0.0);
        #[expect(clippy::cast_precision_loss, reason = "ten thousand at most")]
        let later_s = index as f64 * every_s;
        if later_s > 0.0 {
            part.rest.depart_s = Some(self.first_s() + later_s);
        }
        part
    }

    /// When the first one takes off, seconds after T0.
    fn first_s(&self) -> f64 {
        let defaults = &self.fleet.defaults;
        let opens_s = defaults.depart_window_s.and_then(|window| window.from);
        defaults.depart_s.or(opens_s).unwrap_or(0.0)
    }

    /// Names and links must differ.
    fn templates(&mut self) {
        let by_table = |name: &str| self.table.columns.iter().any(|column| column == name);
        match &self.fleet.id {
            Some(id) if filled(id, 1).is_none() || filled(id, 1) == filled(id, 2) => {
                let found = format!("`{}`", id.escape_debug());
                let allowed = "text with {n}, {n:03} or {100+n} in it";
                self.checker.report("fleet.id", found, allowed);
            }
            None if !by_table("id") => {
                let allowed = "id, such as d{n:03}, or a column id of a table";
                self.checker.report("fleet", "no names", allowed);
            }
            _ => {}
        }
        if let Some(link) = &self.fleet.defaults.link
            && filled(link, 1).is_none()
        {
            let found = format!("`{}`", link.escape_debug());
            let allowed = "{n}, {n:03}, {14550+n} or {5750+10*n} in braces";
            self.checker.report("fleet.defaults.link", found, allowed);
        }
    }

    /// A system id for each vehicle: its own, or the next that nobody has, and from the
    /// beginning again when all are used up.
    fn system_ids(&mut self, parts: &[(Part, Option<usize>)]) -> Vec<i64> {
        self.taken
            .extend(parts.iter().filter_map(|(part, _)| part.sysid));
        let first = self.fleet.first_sysid.unwrap_or(1);
        if !(1..=LAST_SYSTEM_ID).contains(&first) {
            let allowed = format!("1 to {LAST_SYSTEM_ID}");
            self.checker.report("fleet.first_sysid", first, allowed);
            return vec![1; parts.len()];
        }
        let free: Vec<i64> = (first..=LAST_SYSTEM_ID)
            .chain(1..first)
            .filter(|id| !self.taken.contains(id))
            .collect();
        let mut next = free.iter().cycle();
        let own = parts.iter().map(|(part, _)| part.sysid);
        own.map(|own| own.or_else(|| next.next().copied()).unwrap_or(first))
            .collect()
    }

    /// The vehicle, or a problem for each key that it lacks.
    fn whole(
        &mut self,
        index: usize,
        part: Part,
        row: Option<usize>,
        sysid: i64,
    ) -> Option<(Made, raw::Vehicle)> {
        let number = index as u64 + 1;
        let named = || filled(self.fleet.id.as_deref()?, number);
        let id = part.id.or_else(named);
        let rest = part.rest;
        let by_cell = row.is_some_and(|row| {
            let cells = self.table.columns.iter().zip(&self.table.rows[row].cells);
            cells
                .filter(|(name, _)| *name == "link")
                .any(|(_, cell)| !cell.is_empty())
        });
        let link = match rest.link {
            // A broken one is reported already.
            Some(link) if !by_cell => filled(&link, number).or(Some(link)),
            link => link,
        };
        let start = self.end(row, "start", rest.start);
        let goal = self.end(row, "goal", rest.goal);
        let home = match part.home {
            [Some(lat), Some(lon)] => Some(raw::Place { lat, lon }),
            [None, None] => rest.home,
            [lat, _] => {
                let missing = if lat.is_some() {
                    "home_lon"
                } else {
                    "home_lat"
                };
                self.lacking(row, missing);
                None
            }
        };
        let landing = rest.landing.and_then(|landing| {
            let heading_deg = landing.heading_deg;
            let heading_deg = self.needed(row, "landing.heading_deg", heading_deg)?;
            let glide_deg = self.needed(row, "landing.glide_deg", landing.glide_deg)?;
            Some(raw::Landing {
                heading_deg,
                glide_deg,
            })
        });
        let depart_window_s = rest.depart_window_s.and_then(|window| {
            let from = self.needed(row, "depart_window_s.from", window.from)?;
            let to = self.needed(row, "depart_window_s.to", window.to)?;
            Some(raw::Window { from, to })
        });
        let speed_range_mps = rest.speed_range_mps.and_then(|range| {
            let min = self.needed(row, "speed_range_mps.min", range.min)?;
            let max = self.needed(row, "speed_range_mps.max", range.max)?;
            Some(raw::SpeedRange { min, max })
        });
        let autopilot = self.needed(row, "autopilot", rest.autopilot);
        let link = self.needed(row, "link", link);
        let finish = self.needed(row, "finish", rest.finish);
        let speed_mps = self.needed(row, "speed_mps", rest.speed_mps);
        // Without a name there is a problem already, unless only this row has none.
        if id.is_none() && row.is_some() {
            self.lacking(row, "id");
        }
        let vehicle = raw::Vehicle {
            id: id?,
            sysid,
            autopilot: autopilot?,
            autopilot_version: rest.autopilot_version,
            airframe: rest.airframe.unwrap_or_default(),
            link: link?,
            home,
            start: start?,
            goal: goal?,
            finish: finish?,
            speed_mps: speed_mps?,
            max_load_factor: rest.max_load_factor,
            max_climb_deg: rest.max_climb_deg,
            max_descent_deg: rest.max_descent_deg,
            climb_mps: rest.climb_mps,
            descent_mps: rest.descent_mps,
            accel_mps2: rest.accel_mps2,
            depart_s: rest.depart_s,
            depart_window_s,
            speed_range_mps,
            return_amsl_m: rest.return_amsl_m,
            takeoff_heading_deg: rest.takeoff_heading_deg,
            landing,
            loiter_radius_m: rest.loiter_radius_m,
        };
        let id = vehicle.id.clone();
        Some((Made { id, row }, vehicle))
    }

    fn end(
        &mut self,
        row: Option<usize>,
        key: &str,
        end: Option<raw::PartOfEnd>,
    ) -> Option<raw::EndPoint> {
        let end = end.unwrap_or_default();
        let lat = self.needed(row, &format!("{key}.lat"), end.lat);
        let lon = self.needed(row, &format!("{key}.lon"), end.lon);
        Some(raw::EndPoint {
            lat: lat?,
            lon: lon?,
            agl_m: end.agl_m,
            amsl_m: end.amsl_m,
        })
    }

    fn needed<T>(&mut self, row: Option<usize>, key: &str, value: Option<T>) -> Option<T> {
        if value.is_none() {
            self.lacking(row, key);
        }
        value
    }

    /// A key that neither the defaults have nor a row of a table.
    fn lacking(&mut self, row: Option<usize>, key: &str) {
        let column = key.replace('.', "_");
        let row = row.and_then(|row| self.table.rows.get(row));
        let columns = &self.table.columns;
        let found = format!("no {key}");
        match (row, columns.iter().position(|name| *name == column)) {
            (Some(row), Some(index)) => {
                let empty = "an empty cell".to_owned();
                let allowed = format!("a value, or {key} in fleet.defaults");
                let issue = self.table.cell_issue(row.line, index, empty, &allowed);
                self.checker.issues.push(issue);
            }
            (Some(_), None) => {
                let allowed = format!("{key} here, or a column {column}");
                self.checker.report("fleet.defaults", found, allowed);
            }
            (None, _) => {
                let allowed = match key {
                    "start.lat" | "start.lon" => format!("{key} here, or start_grid"),
                    "goal.lat" | "goal.lon" => format!("{key} here, or goal_grid"),
                    _ => format!("{key}, as a vehicle has it"),
                };
                self.checker.report("fleet.defaults", found, allowed);
            }
        }
    }
}
