//! From the file as it is to a spec that may be trusted: every problem that can be
//! told without the ground, all at once.

mod cells;
mod expanded;
mod fleet;
mod grid;
mod map;
mod name;
mod retiming;
mod scenario;
mod shapes;
mod template;
mod wing;

pub(super) use expanded::write_out;
pub(super) use scenario::scenario;
pub(super) use shapes::relative;

use std::fmt::Display;
use std::ops::RangeInclusive;

use super::raw;
use super::value_sources::{ValueSources, in_order};
use super::{
    Algorithm, AltitudeReference, Issue, MOST_CONTROL_POINTS, MissionOptions, MissionSpec,
    Objective, OnLinkLoss, Planner, Separation, Weights, Wind,
};
use crate::geodesy::LatLon;
use crate::numeric::digits;

/// Checks a whole spec, of which these problems are known.
///
/// # Errors
/// Every problem, in file order.
pub(super) fn check(
    raw: &raw::Spec,
    places: &ValueSources,
    issues: Vec<Issue>,
) -> Result<MissionSpec, Vec<Issue>> {
    let mut checker = Checker { places, issues };
    let spec = checker.spec(raw);
    let issues = in_order(checker.issues);
    match spec {
        Some(spec) if issues.is_empty() => Ok(spec),
        _ => Err(issues),
    }
}

/// Collects problems. Its methods return what they checked, or `None` where a
/// problem leaves nothing to go on with; then a problem was noted.
struct Checker<'a> {
    places: &'a ValueSources,
    issues: Vec<Issue>,
}

impl Checker<'_> {
    /// Notes a problem.
    fn report(&mut self, path: &str, found: impl Display, allowed: impl Display) {
        let issue = self
            .places
            .issue(path, found.to_string(), allowed.to_string());
        self.issues.push(issue);
    }

    /// A number that must be finite and in range; handed through.
    fn number(&mut self, path: &str, value: f64, range: RangeInclusive<f64>) -> f64 {
        if !range.contains(&value) {
            let allowed = match range == (f64::MIN..=f64::MAX) {
                true => "a finite number".to_owned(),
                false => format!("{} to {}", range.start(), range.end()),
            };
            self.report(path, digits::plain(value), allowed);
        }
        value
    }

    /// The same for a number that may be absent.
    fn optional(
        &mut self,
        path: &str,
        value: Option<f64>,
        range: RangeInclusive<f64>,
    ) -> Option<f64> {
        value.map(|value| self.number(path, value, range))
    }

    /// A count in range.
    fn count(&mut self, path: &str, value: u64, range: RangeInclusive<u64>) -> usize {
        if !range.contains(&value) {
            self.report(path, value, format!("{} to {}", range.start(), range.end()));
        }
        usize::try_from(value).unwrap_or(usize::MAX)
    }

    /// A place on the earth; `path` holds `lat` and `lon`.
    fn place(&mut self, path: &str, lat_deg: f64, lon_deg: f64) -> Option<LatLon> {
        self.number(&format!("{path}.lat"), lat_deg, -90.0..=90.0);
        self.number(&format!("{path}.lon"), lon_deg, -180.0..=180.0);
        LatLon::new(lat_deg, lon_deg).ok()
    }

    fn spec(&mut self, raw: &raw::Spec) -> Option<MissionSpec> {
        if raw.sortie != 1 {
            self.report("sortie", format!("version {}", raw.sortie), "version 1");
        }
        self.file_name("name", &raw.name);
        let map = self.map(raw);
        let separation = self.separation(raw);
        let wind = raw.wind.map(|wind| Wind {
            from_rad: self
                .number("wind.from_deg", wind.from_deg, 0.0..=360.0)
                .to_radians(),
            speed_mps: self.number("wind.speed_mps", wind.speed_mps, 0.0..=50.0),
        });
        let vehicles = self.fleet(raw, map.as_ref(), separation, wind);
        let planner = self.planner(&raw.planner);
        let mission = self.mission(&raw.mission);
        let map = map?;
        Some(MissionSpec {
            name: raw.name.clone(),
            frame: map.frame,
            area: map.area,
            terrain: map.terrain?,
            threats: map.threats,
            no_fly: map.no_fly,
            rally: map.rally,
            vehicles,
            separation,
            planner,
            mission,
            wind,
            on_link_loss: match raw.on_link_loss {
                raw::OnLinkLoss::Continue => OnLinkLoss::Continue,
                raw::OnLinkLoss::HoldAll => OnLinkLoss::HoldAll,
                raw::OnLinkLoss::LandAll => OnLinkLoss::LandAll,
            },
        })
    }

    fn separation(&mut self, raw: &raw::Spec) -> Separation {
        let raw = raw.separation;
        Separation {
            distance_m: self.number("separation.distance_m", raw.distance_m, 1.0..=50_000.0),
            time_slack_s: self.number("separation.time_slack_s", raw.time_slack_s, 0.0..=3600.0),
            vertical_m: self.optional("separation.vertical_m", raw.vertical_m, 1.0..=10_000.0),
        }
    }

    fn planner(&mut self, raw: &raw::Planner) -> Planner {
        let mut weight = |name: &str, value: f64| {
            self.number(&format!("planner.weights.{name}"), value, 0.0..=1e6)
        };
        let weights = Weights {
            length: weight("length", raw.weights.length),
            altitude: weight("altitude", raw.weights.altitude),
            threat: weight("threat", raw.weights.threat),
            terrain: weight("terrain", raw.weights.terrain),
            turn: weight("turn", raw.weights.turn),
            climb: weight("climb", raw.weights.climb),
            collision: weight("collision", raw.weights.collision),
        };
        Planner {
            algorithm: match raw.algorithm {
                raw::Algorithm::Msfoa => Algorithm::Msfoa,
                raw::Algorithm::MsfoaLiteral => Algorithm::MsfoaLiteral,
                raw::Algorithm::MsfoaDwindle => Algorithm::MsfoaDwindle,
                raw::Algorithm::Foa => Algorithm::Foa,
                raw::Algorithm::Pso => Algorithm::Pso,
                raw::Algorithm::De => Algorithm::De,
                raw::Algorithm::Abc => Algorithm::Abc,
                raw::Algorithm::Iffo => Algorithm::Iffo,
                raw::Algorithm::Mfoa => Algorithm::Mfoa,
            },
            objective: match raw.objective {
                raw::Objective::Operational => Objective::Operational,
                raw::Objective::Paper => Objective::Paper,
            },
            seed: raw.seed,
            evaluations: self.count("planner.evaluations", raw.evaluations, 100..=100_000_000),
            control_points: raw.control_points.map_or(own_control_points(raw), |count| {
                self.count(
                    "planner.control_points",
                    count,
                    2..=MOST_CONTROL_POINTS as u64,
                )
            }),
            samples: self.count("planner.samples", raw.samples, 11..=2001),
            weights,
            swarms: raw
                .swarms
                .map(|swarms| self.count("planner.swarms", swarms, 1..=1000)),
            population: raw
                .population
                .map(|flies| self.count("planner.population", flies, 2..=1_000_000)),
            threshold: self.optional("planner.threshold", raw.threshold, f64::MIN..=f64::MAX),
            step: self.optional("planner.step", raw.step, 1e-6..=1.0),
        }
    }

    fn mission(&mut self, raw: &raw::MissionOptions) -> MissionOptions {
        MissionOptions {
            altitude: match raw.altitude {
                raw::AltitudeReference::Amsl => AltitudeReference::Amsl,
                raw::AltitudeReference::Relative => AltitudeReference::Relative,
                raw::AltitudeReference::Terrain => AltitudeReference::Terrain,
            },
            tolerance_m: self.number("mission.tolerance_m", raw.tolerance_m, 0.1..=100.0),
            max_items: self.count("mission.max_items", raw.max_items, 5..=60_000),
            fence: raw.fence,
        }
    }
}

/// Free control points where a spec does not say. The default search knows where to begin, so
/// that more of them cost little time and save much way; the paper's algorithms have those
/// of its harder experiment.
fn own_control_points(planner: &raw::Planner) -> usize {
    match (&planner.algorithm, &planner.objective) {
        (raw::Algorithm::Msfoa, raw::Objective::Operational) => 16,
        _ => 8,
    }
}
