//! A scenario of the study.

use std::ops::RangeInclusive;

use super::super::raw;
use super::super::table::Table;
use super::super::{Cylinder, Issue, Mover, Objective, Peak, Scenario, Surface, Waves};
use super::Checker;
use crate::geodesy::{Agl, Amsl, EastNorth, PlanPoint};
use crate::spec::positions::Positions;
use crate::spec::value_sources::ValueSources;

/// Where anything may be, metres from the origin.
const EXTENT_M: RangeInclusive<f64> = -300_000.0..=300_000.0;

/// Checks a whole scenario.
///
/// # Errors
/// Every problem, in file order.
pub(in crate::spec) fn scenario(
    raw: &raw::Scenario,
    places: &Positions,
) -> Result<Scenario, Vec<Issue>> {
    let places = ValueSources::new(places.clone(), 0, Vec::new(), Table::default());
    let mut checker = Checker {
        places: &places,
        issues: Vec::new(),
    };
    let scenario = checker.scenario(raw);
    let mut issues = checker.issues;
    issues.sort_by_key(|issue| issue.position);
    if issues.is_empty() {
        Ok(scenario)
    } else {
        Err(issues)
    }
}

impl Checker<'_> {
    fn scenario(&mut self, raw: &raw::Scenario) -> Scenario {
        if raw.sortie != 1 {
            self.report("sortie", format!("version {}", raw.sortie), "version 1");
        }
        self.file_name("name", &raw.name);
        let planner = self.planner(&raw.planner);
        if planner.objective != Objective::Paper {
            self.report("planner.objective", "operational", "paper");
        }
        let [west, east] = self.range("area.east_m", raw.area.east_m);
        let [south, north] = self.range("area.north_m", raw.area.north_m);
        let corner = |east_m, north_m| EastNorth { east_m, north_m };
        let min_agl_m = self.number("area.min_agl_m", raw.area.min_agl_m, 0.0..=10_000.0);
        let max_up_m = self.number("area.max_up_m", raw.area.max_up_m, -500.0..=20_000.0);
        self.unique("threats", raw.threats.iter().map(|at| at.id.as_str()));
        self.unique("vehicles", raw.vehicles.iter().map(|at| at.id.as_str()));
        if raw.vehicles.is_empty() {
            self.report("vehicles", "no vehicle", "at least one");
        }
        let mut scenario = Scenario {
            name: raw.name.clone(),
            south_west: corner(west, south),
            north_east: corner(east, north),
            min_agl: Agl(min_agl_m),
            max_amsl: Amsl(max_up_m),
            surface: self.surface(&raw.terrain),
            threats: Vec::new(),
            vehicles: Vec::new(),
            planner,
        };
        for (index, threat) in raw.threats.iter().enumerate() {
            let checked = self.cylinder(&format!("threats[{index}]"), threat);
            scenario.threats.push(checked);
        }
        for (index, mover) in raw.vehicles.iter().enumerate() {
            let checked = self.mover(&format!("vehicles[{index}]"), mover, &scenario);
            scenario.vehicles.push(checked);
        }
        scenario
    }

    /// From and to, in this order.
    fn range(&mut self, path: &str, [from, to]: [f64; 2]) -> [f64; 2] {
        self.number(path, from, EXTENT_M);
        self.number(path, to, EXTENT_M);
        if to - from < 1.0 {
            self.report(path, format!("{from} to {to}"), "from and to, ascending");
        }
        [from, to]
    }

    fn spot(&mut self, path: &str, east_m: f64, north_m: f64) -> EastNorth {
        EastNorth {
            east_m: self.number(&format!("{path}.east_m"), east_m, EXTENT_M),
            north_m: self.number(&format!("{path}.north_m"), north_m, EXTENT_M),
        }
    }

    fn surface(&mut self, raw: &raw::Surface) -> Surface {
        let waves = raw.waves.map(|raw| {
            let shape = [raw.a, raw.b, raw.c, raw.d, raw.e, raw.f, raw.g];
            for value in shape {
                self.number("terrain.waves", value, -1000.0..=1000.0);
            }
            Waves {
                height_m: self.number("terrain.waves.height_m", raw.height_m, 0.0..=9000.0),
                shape,
            }
        });
        let peaks = raw.peaks.iter().enumerate().map(|(index, raw)| {
            let path = format!("terrain.peaks[{index}]");
            let mut width = |key: &str, value: f64| {
                self.number(&format!("{path}.{key}"), value, 1.0..=500_000.0)
            };
            let width_m = [
                width("width_east_m", raw.width_east_m),
                width("width_north_m", raw.width_north_m),
            ];
            Peak {
                at: self.spot(&path, raw.east_m, raw.north_m),
                height_m: self.number(&format!("{path}.height_m"), raw.height_m, 0.0..=9000.0),
                width_m,
            }
        });
        let peaks = peaks.collect();
        Surface { waves, peaks }
    }

    fn cylinder(&mut self, path: &str, raw: &raw::Cylinder) -> Cylinder {
        self.label(&format!("{path}.id"), &raw.id);
        let kind = raw.kind.clone().unwrap_or_else(|| "threat".to_owned());
        self.label(&format!("{path}.kind"), &kind);
        Cylinder {
            id: raw.id.clone(),
            kind,
            center: self.spot(path, raw.east_m, raw.north_m),
            radius_m: self.number(&format!("{path}.radius_m"), raw.radius_m, 1.0..=500_000.0),
        }
    }

    fn mover(&mut self, path: &str, raw: &raw::Mover, scenario: &Scenario) -> Mover {
        self.file_name(&format!("{path}.id"), &raw.id);
        Mover {
            id: raw.id.clone(),
            start: self.end(&format!("{path}.start"), raw.start, scenario),
            goal: self.end(&format!("{path}.goal"), raw.goal, scenario),
            speed_mps: self.number(&format!("{path}.speed_mps"), raw.speed_mps, 0.5..=1000.0),
            max_load_factor: self.number(
                &format!("{path}.max_load_factor"),
                raw.max_load_factor,
                1.001..=10.0,
            ),
        }
    }

    /// An end of a path: in the map, high enough, out of threats.
    fn end(&mut self, path: &str, raw: raw::End, scenario: &Scenario) -> PlanPoint {
        let at = self.spot(path, raw.east_m, raw.north_m);
        let (low, high) = (scenario.south_west, scenario.north_east);
        let is_inside = (low.east_m..=high.east_m).contains(&at.east_m)
            && (low.north_m..=high.north_m).contains(&at.north_m);
        if !is_inside {
            let found = format!("{} east, {} north", at.east_m, at.north_m);
            self.report(path, found, "a place in the area");
        }
        let ground_m = scenario.surface.height_m(at);
        let up_m = match (raw.up_m, raw.agl_m) {
            (Some(up_m), None) => up_m,
            (None, Some(agl_m)) => ground_m + agl_m,
            _ => {
                self.report(path, "both or none of up_m and agl_m", "one of the two");
                return PlanPoint {
                    at,
                    amsl: Amsl(0.0),
                };
            }
        };
        let lowest_m = ground_m + scenario.min_agl.0;
        // A hair, because heights above ground are added and taken away again.
        if !(lowest_m - 1e-6..=scenario.max_amsl.0).contains(&up_m) {
            let allowed = format!("{lowest_m:.1} to {} m up", scenario.max_amsl.0);
            self.report(path, format!("{up_m:.1} m up"), allowed);
        }
        for threat in &scenario.threats {
            if threat.center.distance_m(at) <= threat.radius_m {
                let found = format!("inside threat `{}`", threat.id.escape_debug());
                self.report(path, found, "a place outside of all threats");
            }
        }
        PlanPoint {
            at,
            amsl: Amsl(up_m),
        }
    }
}
