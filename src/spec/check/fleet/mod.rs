//! The vehicles that `fleet` makes, as `vehicles` would list them.

mod columns;
mod grid;
mod template;

use std::collections::BTreeSet;

use serde_yaml::{Mapping, Value};

use super::Checker;
use crate::numeric::text::did_you_mean;
use crate::spec::keys::{self, Vehicle};
use crate::spec::table::Table;
use crate::spec::value_sources::Made;
use columns::{Column, columns, merge};
use template::filled;

/// Most vehicles that `fleet` makes.
const MAX_VEHICLES: u64 = 10_000;
/// System ids that are given out end here, below those of ground stations.
const LAST_SYSTEM_ID: i64 = 240;

/// What one vehicle has of its own: keys, and the index of its row in the table.
type Own = (Mapping, Option<usize>);

impl Checker {
    /// Appends the vehicles of `fleet` to those of `vehicles`.
    pub(super) fn add_fleet(&mut self, spec: &mut keys::Spec, table: Table) {
        let Some(fleet) = &spec.fleet else { return };
        for (key, is_present) in [
            ("id", fleet.defaults.id.is_some()),
            ("sysid", fleet.defaults.sysid.is_some()),
        ] {
            if is_present {
                let found = format!("{key}, which each vehicle has for itself");
                let path = format!("fleet.defaults.{key}");
                self.report(&path, found, "any other key of a vehicle");
            }
        }
        let columns = columns();
        let own = match fleet.csv {
            Some(_) => self.rows(fleet, &columns, &table),
            None => self.grids(fleet),
        };
        self.templates(fleet, &table);
        let taken = spec.vehicles.iter().filter_map(|vehicle| vehicle.sysid);
        let sysids = system_ids(fleet, &own, taken.collect());
        let (mut made, mut vehicles) = (Vec::new(), Vec::new());
        for (index, ((own, row), sysid)) in own.into_iter().zip(sysids).enumerate() {
            match vehicle(fleet, index, own) {
                Err(error) => self.report("fleet", error, ""),
                // Reported once for the fleet if no row has a name.
                Ok(Vehicle { id: None, .. }) if !has_column(&table, "id") => {}
                Ok(vehicle) => {
                    let id = vehicle.id.clone().unwrap_or_default();
                    made.push(Made { id, row });
                    vehicles.push(Vehicle {
                        sysid: Some(sysid),
                        ..vehicle
                    });
                }
            }
        }
        self.sources.add_fleet(made, table);
        let listed = spec.vehicles.len();
        let paths = (listed..).map(|index| format!("vehicles[{index}]"));
        self.ranges(paths.zip(&vehicles));
        spec.vehicles.append(&mut vehicles);
    }

    /// The keys of each row of the table.
    fn rows(&mut self, fleet: &keys::Fleet, columns: &[Column], table: &Table) -> Vec<Own> {
        for (grid, is_present) in [
            ("fleet.start_grid", fleet.start_grid.is_some()),
            ("fleet.goal_grid", fleet.goal_grid.is_some()),
        ] {
            if is_present {
                self.report(grid, "a grid, and csv", "either csv or grids");
            }
        }
        let known: Vec<Option<&Column>> = table
            .columns
            .iter()
            .map(|name| columns.iter().find(|column| column.name == *name))
            .collect();
        for (index, _) in known.iter().enumerate().filter(|(_, it)| it.is_none()) {
            let names: Vec<&str> = columns.iter().map(|column| &*column.name).collect();
            let like = did_you_mean(&table.columns[index], names.iter().copied());
            let found = format!("an unknown column{like}");
            self.issues
                .push(table.name_issue(index, found, &names.join(", ")));
        }
        if table.rows.is_empty() && !table.columns.is_empty() {
            let issue = table.row_issue(1, "", "no vehicle".to_owned(), "one row for each");
            self.issues.push(issue);
        }
        if table.rows.len() as u64 > MAX_VEHICLES {
            let found = format!("{} vehicles", table.rows.len());
            self.report("fleet.csv", found, format!("at most {MAX_VEHICLES}"));
            return Vec::new();
        }
        let mut rows = Vec::new();
        for (index, row) in table.rows.iter().enumerate() {
            let mut own = Mapping::new();
            for (place, (column, cell)) in known.iter().zip(&row.cells).enumerate() {
                let Some(column) = column.filter(|_| !cell.is_empty()) else {
                    continue;
                };
                if let Err(allowed) = column.put(cell, &mut own) {
                    let found = format!("`{}`", cell.escape_debug());
                    self.issues
                        .push(table.cell_issue(row.line, place, found, &allowed));
                }
            }
            rows.push((own, Some(index)));
        }
        rows
    }

    /// Names and links must differ.
    fn templates(&mut self, fleet: &keys::Fleet, table: &Table) {
        match &fleet.id {
            Some(id) if filled(id, 1).is_none() || filled(id, 1) == filled(id, 2) => {
                let found = format!("`{}`", id.escape_debug());
                let allowed = "text with {n}, {n:03} or {100+n} in it";
                self.report("fleet.id", found, allowed);
            }
            None if !has_column(table, "id") => {
                let allowed = "id, such as d{n:03}, or a column id of a table";
                self.report("fleet", "no names", allowed);
            }
            _ => {}
        }
        if let Some(link) = &fleet.defaults.link
            && filled(link, 1).is_none()
        {
            let found = format!("`{}`", link.escape_debug());
            let allowed = "{n}, {n:03}, {14550+n} or {5750+10*n} in braces";
            self.report("fleet.defaults.link", found, allowed);
        }
    }
}

fn has_column(table: &Table, name: &str) -> bool {
    table.columns.iter().any(|column| column == name)
}

/// A system id for each vehicle: its own, or the next free one, from the beginning again when
/// all are in use.
fn system_ids(fleet: &keys::Fleet, own: &[Own], mut taken: BTreeSet<i64>) -> Vec<i64> {
    let of_row = |(keys, _): &Own| keys.get("sysid").and_then(Value::as_i64);
    taken.extend(own.iter().filter_map(of_row));
    let first = fleet.first_sysid.unwrap_or(1).clamp(1, LAST_SYSTEM_ID);
    let free: Vec<i64> = (first..=LAST_SYSTEM_ID)
        .chain(1..first)
        .filter(|id| !taken.contains(id))
        .collect();
    let mut next = free.iter().cycle();
    own.iter()
        .map(|keys| {
            of_row(keys)
                .or_else(|| next.next().copied())
                .unwrap_or(first)
        })
        .collect()
}

/// A vehicle of the defaults and of its own keys; `index` counts in the fleet.
fn vehicle(fleet: &keys::Fleet, index: usize, own: Mapping) -> Result<Vehicle, serde_yaml::Error> {
    let defaults = &fleet.defaults;
    let mut common = defaults.clone();
    let number = index as u64 + 1;
    common.id = fleet.id.as_ref().and_then(|id| filled(id, number));
    // A broken template is reported already.
    let link = common.link.take();
    common.link = link.map(|link| filled(&link, number).unwrap_or(link));
    #[expect(clippy::cast_precision_loss, reason = "ten thousand at most")]
    let later_s = index as f64 * fleet.depart_every_s.unwrap_or(0.0);
    if later_s > 0.0 {
        let opens_s = defaults.depart_window_s.and_then(|window| window.from);
        common.depart_s = Some(defaults.depart_s.or(opens_s).unwrap_or(0.0) + later_s);
    }
    let mut common = serde_yaml::to_value(&common)?;
    if let Value::Mapping(common) = &mut common {
        merge(own, common);
    }
    let mut vehicle: Vehicle = serde_yaml::from_value(common)?;
    vehicle.start.get_or_insert_default();
    vehicle.goal.get_or_insert_default();
    Ok(vehicle)
}
