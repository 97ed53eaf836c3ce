//! A scenario of the study.

use super::super::keys;
use super::super::{Cylinder, Issue, Mover, Objective, Peak, Scenario, Surface, Waves};
use super::Checker;
use crate::geodesy::{Agl, Amsl, EastNorth, PlanPoint};
use crate::spec::positions::Positions;
use crate::spec::value_sources::{ValueSources, in_order};

/// Checks a whole scenario.
///
/// # Errors
/// Every problem, in file order.
pub(in crate::spec) fn scenario(
    keys: &keys::Scenario,
    positions: Positions,
) -> Result<Scenario, Vec<Issue>> {
    let mut checker = Checker {
        sources: ValueSources::new(positions, 0),
        version: 1,
        issues: Vec::new(),
        vehicles: Vec::new(),
        sites: Vec::new(),
        origin: None,
    };
    checker.ranges([(String::new(), keys)]);
    let scenario = checker.scenario(keys);
    match checker.issues.is_empty() {
        true => Ok(scenario),
        false => Err(in_order(checker.issues)),
    }
}

impl Checker {
    fn scenario(&mut self, keys: &keys::Scenario) -> Scenario {
        self.file_name("name", &keys.name);
        let planner = self.planner(&keys.planner);
        if planner.objective != Objective::Paper {
            self.report("planner.objective", "operational", "paper");
        }
        let [west, east] = self.ascending("area.east_m", keys.area.east_m);
        let [south, north] = self.ascending("area.north_m", keys.area.north_m);
        let corner = |east_m, north_m| EastNorth { east_m, north_m };
        self.unique(
            "threats",
            keys.threats.iter().map(|at| Some(at.id.as_str())),
        );
        self.unique(
            "vehicles",
            keys.vehicles.iter().map(|at| Some(at.id.as_str())),
        );
        if keys.vehicles.is_empty() {
            self.report("vehicles", "no vehicle", "at least one");
        }
        let mut scenario = Scenario {
            name: keys.name.clone(),
            south_west: corner(west, south),
            north_east: corner(east, north),
            min_agl: Agl(keys.area.min_agl_m),
            max_amsl: Amsl(keys.area.max_up_m),
            surface: surface(&keys.terrain),
            threats: Vec::new(),
            vehicles: Vec::new(),
            planner,
        };
        for (index, threat) in keys.threats.iter().enumerate() {
            let checked = self.cylinder(&format!("threats[{index}]"), threat);
            scenario.threats.push(checked);
        }
        for (index, mover) in keys.vehicles.iter().enumerate() {
            let checked = self.mover(&format!("vehicles[{index}]"), mover, &scenario);
            scenario.vehicles.push(checked);
        }
        scenario
    }

    /// From and to, in this order.
    fn ascending(&mut self, path: &str, [from, to]: [f64; 2]) -> [f64; 2] {
        if to - from < 1.0 {
            self.report(path, format!("{from} to {to}"), "from and to, ascending");
        }
        [from, to]
    }

    fn cylinder(&mut self, path: &str, keys: &keys::Cylinder) -> Cylinder {
        self.label(&format!("{path}.id"), &keys.id);
        let kind = keys.kind.clone().unwrap_or_else(|| "threat".to_owned());
        self.label(&format!("{path}.kind"), &kind);
        Cylinder {
            id: keys.id.clone(),
            kind,
            center: EastNorth {
                east_m: keys.east_m,
                north_m: keys.north_m,
            },
            radius_m: keys.radius_m,
        }
    }

    fn mover(&mut self, path: &str, keys: &keys::Mover, scenario: &Scenario) -> Mover {
        self.file_name(&format!("{path}.id"), &keys.id);
        Mover {
            id: keys.id.clone(),
            start: self.end(&format!("{path}.start"), keys.start, scenario),
            goal: self.end(&format!("{path}.goal"), keys.goal, scenario),
            speed_mps: keys.speed_mps,
            max_load_factor: keys.max_load_factor,
        }
    }

    /// An end of a path: in the map, high enough, out of threats.
    fn end(&mut self, path: &str, keys: keys::End, scenario: &Scenario) -> PlanPoint {
        let at = EastNorth {
            east_m: keys.east_m,
            north_m: keys.north_m,
        };
        let (low, high) = (scenario.south_west, scenario.north_east);
        let is_inside = (low.east_m..=high.east_m).contains(&at.east_m)
            && (low.north_m..=high.north_m).contains(&at.north_m);
        if !is_inside {
            let found = format!("{} east, {} north", at.east_m, at.north_m);
            self.report(path, found, "a place in the area");
        }
        let ground_m = scenario.surface.height_m(at);
        let up_m = match (keys.up_m, keys.agl_m) {
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
        let min_amsl_m = ground_m + scenario.min_agl.0;
        // Rounding of a height above ground that is added and subtracted again.
        if !(min_amsl_m - 1e-6..=scenario.max_amsl.0).contains(&up_m) {
            let allowed = format!("{min_amsl_m:.1} to {} m up", scenario.max_amsl.0);
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

fn surface(keys: &keys::Surface) -> Surface {
    let waves = keys.waves.map(|keys| Waves {
        height_m: keys.height_m,
        shape: [keys.a, keys.b, keys.c, keys.d, keys.e, keys.f, keys.g],
    });
    let peaks = keys.peaks.iter().map(|keys| Peak {
        at: EastNorth {
            east_m: keys.east_m,
            north_m: keys.north_m,
        },
        height_m: keys.height_m,
        width_m: [keys.width_east_m, keys.width_north_m],
    });
    Surface {
        waves,
        peaks: peaks.collect(),
    }
}
