//! Checks the keys of a file into a spec. Reports every problem that needs no terrain to be found.

mod airspace;
mod buffers;
mod fleet;
mod keep_in;
mod map;
mod name;
mod ranges;
mod retiming;
mod scenario;
mod shapes;
mod vehicles;
mod wing;
mod zones;

pub(super) use scenario::scenario;
pub(super) use shapes::relative;

use std::fmt::Display;

use super::airspace::{AirspaceImport, AttachedFile};
use super::keys;
use super::positions::Positions;
use super::table::Table;
use super::value_sources::{ValueSources, in_order};
use super::{
    Action, Algorithm, Issue, KnownPlace, MissionOptions, MissionSpec, Objective, OnLinkLoss,
    Planner, Vehicle, Wind,
};
use crate::geodesy::LatLon;

/// Checks a whole spec and its table.
pub(super) fn check(
    mut keys: keys::Spec,
    positions: Positions,
    table: Table,
    attached: &[AttachedFile],
) -> Checked {
    let mut checker = Checker {
        sources: ValueSources::new(positions, keys.vehicles.len()),
        version: keys.sortie,
        issues: Vec::new(),
        vehicles: Vec::new(),
        sites: Vec::new(),
        origin: None,
    };
    checker.ranges([(String::new(), &keys)]);
    checker.add_fleet(&mut keys, table);
    let spec = checker.spec(&keys, attached);
    Checked {
        spec,
        sources: checker.sources,
        issues: in_order(checker.issues),
        vehicles: checker.vehicles,
        sites: checker.sites,
    }
}

/// What the check of a spec found.
pub(super) struct Checked {
    /// The spec, with the summaries of its airspace files: what is broken is left out of it, and then
    /// there is an issue. None without an area and a terrain.
    pub(super) spec: Option<(MissionSpec, Vec<AirspaceImport>)>,
    pub(super) sources: ValueSources,
    /// Every problem, in file order.
    pub(super) issues: Vec<Issue>,
    /// Where each vehicle of the spec stands in the file.
    pub(super) vehicles: Vec<String>,
    /// The places of all vehicles and tasks, and the rally points, as far as they are good.
    pub(super) sites: Vec<KnownPlace>,
}

/// Collects problems. A check returns `None` after reporting a problem that leaves no value.
struct Checker {
    sources: ValueSources,
    /// Of the format of the spec.
    version: u32,
    issues: Vec<Issue>,
    /// Where each vehicle that is left stands in the file.
    vehicles: Vec<String>,
    /// Places whose keys are good.
    sites: Vec<KnownPlace>,
    /// Of the map, once it is known.
    origin: Option<LatLon>,
}

impl Checker {
    fn report(&mut self, path: &str, found: impl Display, allowed: impl Display) {
        let issue = self
            .sources
            .issue(path, found.to_string(), allowed.to_string());
        self.issues.push(issue);
    }

    /// The value of a key that must be given, below `path`.
    fn required<T>(&mut self, path: &str, key: &str, value: Option<T>) -> Option<T> {
        if value.is_none() {
            self.issues.push(self.sources.missing(path, key));
        }
        value
    }

    /// A position; `path` has the keys `lat` and `lon`, their ranges checked already.
    fn place(&mut self, path: &str, place: keys::Place) -> Option<LatLon> {
        let lat_deg = self.required(path, "lat", place.lat);
        let lon_deg = self.required(path, "lon", place.lon);
        LatLon::new(lat_deg?, lon_deg?).ok()
    }

    fn spec(
        &mut self,
        keys: &keys::Spec,
        attached: &[AttachedFile],
    ) -> Option<(MissionSpec, Vec<AirspaceImport>)> {
        self.file_name("name", &keys.name);
        let buffers = self.buffers(keys);
        let map = self.map(keys, buffers, attached);
        let wind = keys.wind.map(|wind| Wind {
            from_rad: wind.from_deg.to_radians(),
            speed_mps: wind.speed_mps,
        });
        let vehicles = self.vehicles(keys, map.as_ref(), wind);
        let tasks = self.tasks(keys, map.as_ref(), &vehicles);
        let planner = self.planner(&keys.planner);
        self.on_alarm(keys, &vehicles);
        let map = map?;
        let imports = map.imports;
        let spec = MissionSpec {
            version: keys.sortie,
            name: keys.name.clone(),
            frame: map.frame,
            area: map.area,
            terrain: map.terrain?,
            threats: map.threats,
            no_fly: map.no_fly,
            rally: map.rally,
            vehicles,
            tasks,
            separation: keys.separation,
            buffers,
            planner,
            mission: MissionOptions {
                altitude: keys.mission.altitude,
                tolerance_m: keys.mission.tolerance_m,
                max_items: count(keys.mission.max_items),
                fence: keys.mission.fence,
            },
            wind,
            on_link_loss: keys.on_link_loss,
            on_alarm: keys.on_alarm,
        };
        Some((spec, imports))
    }

    /// `on_alarm`: no conflict with `on_link_loss`, and `return_amsl_m` where it orders a return.
    fn on_alarm(&mut self, keys: &keys::Spec, fleet: &[Vehicle]) {
        if keys.on_alarm.link.is_some() && keys.on_link_loss != OnLinkLoss::Continue {
            let allowed = "one of on_link_loss and on_alarm.link: they are the same";
            self.report("on_link_loss", "both", allowed);
        }
        for (kind, answer) in keys.on_alarm.answers() {
            let mut fleet = fleet.iter();
            let cannot = fleet.find(|vehicle| vehicle.return_amsl.is_none());
            if let (Action::Return, Some(vehicle)) = (answer.action, cannot) {
                let id = &vehicle.id;
                let allowed = format!(
                    "continue, hold or land, or return_amsl_m for {id}: a return is flown at that altitude"
                );
                self.report(&format!("on_alarm.{kind}.do"), "return", allowed);
            }
        }
    }

    fn planner(&mut self, keys: &keys::Planner) -> Planner {
        if keys
            .threshold
            .is_some_and(|threshold| !threshold.is_finite())
        {
            let found = keys.threshold.unwrap_or_default();
            self.report("planner.threshold", found, "a finite number");
        }
        Planner {
            algorithm: keys.algorithm,
            objective: keys.objective,
            seed: keys.seed,
            evaluations: count(keys.evaluations),
            control_points: keys
                .control_points
                .map_or_else(|| default_control_points(keys), count),
            samples: count(keys.samples),
            weights: keys.weights,
            swarms: keys.swarms.map(count),
            population: keys.population.map(count),
            threshold: keys.threshold,
            step: keys.step,
        }
    }
}

fn count(value: u64) -> usize {
    usize::try_from(value).unwrap_or(usize::MAX)
}

/// Default control points. The default search starts near good paths, so more of them cost little
/// time and shorten paths; the published algorithms use the number of the paper's harder experiment.
fn default_control_points(planner: &keys::Planner) -> usize {
    match (planner.algorithm, planner.objective) {
        (Algorithm::Msfoa, Objective::Operational) => 16,
        _ => 8,
    }
}
