//! `plan.json`: the paths of a fleet.

mod entries;

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use super::upload::UploadDocument;
use super::{DEGREE_DIGITS, METRE_DIGITS, finite, rounded, verdict};
use crate::cost::CostTerms;
use crate::geodesy::PlanPoint;
use crate::path::TimedPoint;
use crate::plan::{FleetPlan, Route, VehiclePlan, violations};
use crate::spec::{MissionSpec, StopAction, Vehicle};
use crate::tasks::{AssignedTask, FleetTasks};
use crate::verify::{Limit, Margin, Review};
use crate::world::{VehicleSites, World};

use entries::{BlockEntry, LeftTask, PlannedStop, PlannedTask};
pub use entries::{ControlPoint, Cost, LeftOut, PathPoint, UsedEndurance};

/// The paths of a fleet: `plan.json`. Its vehicles are made one at a time as they are written:
/// those of a large fleet have hundreds of megabytes.
#[derive(Clone, Serialize, JsonSchema)]
pub struct PlanDocument<'a> {
    /// Version of Sortie.
    pub sortie: &'static str,
    /// SHA-256 of the spec file, hexadecimal.
    pub spec_sha256: String,
    /// SHA-256 of the table of vehicles that the spec names, if it names one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table_sha256: Option<String>,
    /// The seed every stream came from.
    pub seed: u64,
    /// `pass` or `fail`: what `verify` says of the encoded missions.
    pub verdict: &'static str,
    /// The whole fleet.
    pub fleet: FleetCost,
    /// In the order of the spec.
    #[schemars(with = "Vec<PlannedVehicle>")]
    pub vehicles: PlannedVehicles<'a>,
    /// The tasks that no vehicle does, and why.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tasks_left: Vec<LeftTask>,
    /// What `plan --json` adds; nothing in the file.
    #[serde(flatten)]
    pub written: Option<WrittenPlan>,
}

/// What became of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct WrittenPlan {
    /// Folder of its files.
    pub out: String,
    /// The transfer; null where none was asked for.
    pub upload: Option<UploadDocument>,
}

/// What a fleet costs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct FleetCost {
    /// Sum of the vehicles' costs.
    pub cost: Option<f64>,
    /// Proven: no plans that keep the limits cost less together. The sum of the vehicles' bounds.
    pub bound: Option<f64>,
    /// How far the cost is above the bound, as a fraction of it; null where limits are broken.
    pub gap: Option<f64>,
}

impl FleetCost {
    /// Of the plans of a fleet.
    #[must_use]
    pub fn of(plan: &FleetPlan) -> Self {
        Self {
            cost: finite(plan.cost()),
            bound: finite(plan.bound()),
            gap: plan.gap().and_then(finite),
        }
    }
}

/// The vehicles of `plan.json`.
#[derive(Clone)]
pub struct PlannedVehicles<'a> {
    spec: &'a MissionSpec,
    world: &'a World,
    plan: &'a FleetPlan,
    passes: bool,
    tasks: Option<&'a FleetTasks>,
    endurance: BTreeMap<&'a str, &'a Margin>,
    left_out: BTreeMap<&'a str, Vec<&'a Margin>>,
}

impl PlannedVehicles<'_> {
    /// The vehicle of an index.
    fn vehicle(&self, index: usize) -> PlannedVehicle {
        let (spec, world) = (self.spec, self.world);
        let (vehicle, planned) = (&spec.vehicles[index], &self.plan.vehicles[index]);
        let id = vehicle.id.as_str();
        let (own, endurance) = (self.left_out.get(id), self.endurance.get(id));
        let mut document = PlannedVehicle {
            landing_deg: landing_deg(vehicle, world.sites.get(index)),
            gives_way_to: ids(spec, planned.gives_way_to(vehicle)),
            blocked_by: ids(spec, &planned.blocked_by),
            // The objective judges turns and ground more strictly than the verdict.
            violations: if self.passes {
                Vec::new()
            } else {
                violation_entries(spec, vehicle, planned, world)
            },
            endurance: endurance.map(|margin| UsedEndurance::of(margin)),
            left_out_of_fence: own.map_or_else(Vec::new, |margins| left_out_of_fence(margins)),
            ..planned_vehicle(spec, vehicle, planned, world)
        };
        if let Some(done) = self.tasks.and_then(|tasks| tasks.done.get(index)) {
            document.add_tasks(done);
        }
        document
    }
}

impl Serialize for PlannedVehicles<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let count = self.spec.vehicles.len().min(self.plan.vehicles.len());
        serializer.collect_seq((0..count).map(|index| self.vehicle(index)))
    }
}

/// One vehicle of `plan.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PlannedVehicle {
    /// Name in the spec.
    pub id: String,
    /// MAVLink system id.
    pub sysid: u8,
    /// Takeoff time, seconds after T0: that of the spec, or another time of its window.
    pub depart_s: f64,
    /// Cruise speed, m/s: that of the spec, or another speed of its range.
    pub speed_mps: f64,
    /// The course of its landing, degrees clockwise from north, where the spec leaves it open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub landing_deg: Option<f64>,
    /// The earlier vehicles to which it gives way by another departure or speed than that
    /// of the spec.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gives_way_to: Vec<String>,
    /// The earlier vehicles that kept the search from finding a path within every limit.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub blocked_by: Vec<String>,
    /// Another departure, seconds after T0: with those of all vehicles that have one the fleet passes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub passes_departing_s: Option<f64>,
    /// The objective.
    pub cost: Cost,
    /// Proven: no path that keeps the limits costs less.
    pub bound: Option<f64>,
    /// What the relaxed problem suggests; proves nothing.
    pub estimate: Option<f64>,
    /// How far the total is above the bound, as a fraction of it; null where limits are broken.
    pub gap: Option<f64>,
    /// Objective evaluations spent.
    pub evaluations: usize,
    /// What it uses from takeoff to touchdown, and what it may; null where the spec gives no endurance.
    pub endurance: Option<UsedEndurance>,
    /// Which limits the best path breaks, if none was found that keeps them all.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub violations: Vec<BlockEntry>,
    /// Number of plans: one more for each conflict with earlier vehicles or failed verification.
    pub plans: usize,
    /// Proven: threats, zones and ground above the ceiling leave no path to its goal.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_proven_infeasible: bool,
    /// The blocking set, in a row around its start or goal.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub blocking_set: Vec<String>,
    /// Changes of the spec with which, each alone, a path that keeps every limit was found.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub relaxations: Vec<String>,
    /// The stops in the order in which they are visited.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub stops: Vec<PlannedStop>,
    /// The tasks that it does, in the order in which it begins them.
    pub tasks: Vec<PlannedTask>,
    /// What its autopilot has no space for in the fence, the nearest first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub left_out_of_fence: Vec<LeftOut>,
    /// Control points of the splines, one route after the other.
    pub control_points: Vec<ControlPoint>,
    /// The path, one route after the other.
    pub path: Vec<PathPoint>,
}

/// The content of `plan.json`, without the hash of a table of vehicles.
#[must_use]
pub fn plan_json<'a>(
    spec_sha256: &str,
    spec: &'a MissionSpec,
    world: &'a World,
    plan: &'a FleetPlan,
    passes: bool,
) -> PlanDocument<'a> {
    PlanDocument {
        sortie: env!("CARGO_PKG_VERSION"),
        spec_sha256: spec_sha256.to_owned(),
        table_sha256: None,
        seed: plan.seed,
        verdict: verdict(passes),
        fleet: FleetCost::of(plan),
        vehicles: PlannedVehicles {
            spec,
            world,
            plan,
            passes,
            tasks: None,
            endurance: BTreeMap::new(),
            left_out: BTreeMap::new(),
        },
        tasks_left: Vec::new(),
        written: None,
    }
}

impl<'a> PlanDocument<'a> {
    /// Adds who does which task.
    pub fn add_tasks(&mut self, tasks: &'a FleetTasks) {
        self.vehicles.tasks = Some(tasks);
        let left = tasks.left.iter().map(|task| LeftTask {
            id: task.id.clone(),
            why: task.why.clone(),
        });
        self.tasks_left = left.collect();
    }

    /// Adds what the verdict found: the endurance that is used, and what is left out of the fences.
    pub fn add_review(&mut self, review: &'a Review) {
        let spec = self.vehicles.spec;
        let is_limited = |id: &str| {
            let mut fleet = spec.vehicles.iter();
            fleet.any(|vehicle| vehicle.id == id && vehicle.endurance.is_some())
        };
        for margin in &review.margins {
            let id = margin.vehicle.as_str();
            match &margin.limit {
                Limit::FenceLeftOut(_) => {
                    self.vehicles.left_out.entry(id).or_default().push(margin);
                }
                Limit::Endurance if is_limited(id) => {
                    self.vehicles.endurance.insert(id, margin);
                }
                _ => {}
            }
        }
    }
}

impl PlannedVehicle {
    fn add_tasks(&mut self, done: &[AssignedTask]) {
        let stops = &self.stops;
        let planned = done.iter().map(|task| {
            let last = stops.get(task.last);
            PlannedTask {
                id: task.id.clone(),
                from_s: stops.get(task.first).and_then(|stop| stop.t_s),
                until_s: last.and_then(|stop| rounded(stop.t_s? + stop.rest_s, METRE_DIGITS)),
                lines: task.lines.clone(),
            }
        });
        self.tasks = planned.collect();
    }
}

fn violation_entries(
    spec: &MissionSpec,
    vehicle: &Vehicle,
    planned: &VehiclePlan,
    world: &World,
) -> Vec<BlockEntry> {
    let violations = violations(spec, world, vehicle, planned).into_iter();
    violations
        .map(|violation| BlockEntry {
            at: control_point(violation.at, world),
            what: violation.what,
            how: violation.how,
        })
        .collect()
}

/// The course of a landing that the spec leaves open, degrees.
fn landing_deg(vehicle: &Vehicle, sites: Option<&VehicleSites>) -> Option<f64> {
    vehicle.approach_wind()?;
    rounded(sites?.landing_rad?.to_degrees(), METRE_DIGITS)
}

/// The ids of vehicles.
fn ids(spec: &MissionSpec, indices: &[usize]) -> Vec<String> {
    let known = indices.iter().filter_map(|&index| spec.vehicles.get(index));
    known.map(|vehicle| vehicle.id.clone()).collect()
}

/// What is left out of the fence of a vehicle, the nearest first.
fn left_out_of_fence(margins: &[&Margin]) -> Vec<LeftOut> {
    let mut found: Vec<(f64, LeftOut)> = margins
        .iter()
        .filter_map(|margin| {
            let Limit::FenceLeftOut(what) = &margin.limit else {
                return None;
            };
            let what = what.clone();
            let distance_m = rounded(margin.value, 10.0);
            Some((margin.value, LeftOut { what, distance_m }))
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, left_out)| left_out).collect()
}

fn planned_vehicle(
    spec: &MissionSpec,
    vehicle: &Vehicle,
    planned: &VehiclePlan,
    world: &World,
) -> PlannedVehicle {
    PlannedVehicle {
        id: vehicle.id.clone(),
        sysid: vehicle.sysid,
        depart_s: planned.depart_s,
        speed_mps: planned.speed_mps,
        landing_deg: None,
        gives_way_to: Vec::new(),
        blocked_by: Vec::new(),
        passes_departing_s: planned.passes_departing_s,
        cost: cost(&planned.terms),
        bound: finite(planned.bound),
        estimate: finite(planned.estimate),
        gap: planned.gap().and_then(finite),
        evaluations: planned.evaluations,
        endurance: None,
        violations: Vec::new(),
        plans: planned.plans,
        is_proven_infeasible: !planned.blocking_set.is_empty(),
        blocking_set: (planned.blocking_set.iter())
            .map(|element| element.name(spec))
            .collect(),
        relaxations: (planned.relaxations.iter().flatten())
            .map(|relaxation| relaxation.words(vehicle))
            .collect(),
        stops: stops(vehicle, planned, world),
        tasks: Vec::new(),
        left_out_of_fence: Vec::new(),
        control_points: planned
            .routes
            .iter()
            .flat_map(|route| &route.control_points)
            .map(|point| control_point(*point, world))
            .collect(),
        path: whole_path(&planned.routes)
            .map(|timed| {
                let ControlPoint {
                    lat_deg,
                    lon_deg,
                    amsl_m,
                } = control_point(timed.point, world);
                PathPoint {
                    lat_deg,
                    lon_deg,
                    amsl_m,
                    t_s: rounded(timed.t_s, METRE_DIGITS),
                }
            })
            .collect(),
    }
}

/// The stops of a vehicle as they are visited, each at the end of a route.
fn stops(vehicle: &Vehicle, planned: &VehiclePlan, world: &World) -> Vec<PlannedStop> {
    let mut vehicle = vehicle.clone();
    vehicle.visit_in(&planned.order);
    let routes = vehicle.stops.iter().zip(&planned.routes);
    routes
        .map(|(stop, route)| {
            let last = route.path.last();
            let at = last.map(|last| control_point(last.point, world));
            PlannedStop {
                id: stop.id.clone(),
                lat_deg: at.as_ref().and_then(|at| at.lat_deg),
                lon_deg: at.as_ref().and_then(|at| at.lon_deg),
                amsl_m: at.and_then(|at| at.amsl_m),
                t_s: last.and_then(|last| rounded(last.t_s, METRE_DIGITS)),
                rest_s: vehicle.stay_s(stop),
                actions: stop.actions.iter().map(StopAction::key).collect(),
            }
        })
        .collect()
}

/// The points of all routes; where one begins exactly as the last ended, once.
pub(in crate::report) fn whole_path(routes: &[Route]) -> impl Iterator<Item = &TimedPoint> {
    let mut last: Option<TimedPoint> = None;
    routes
        .iter()
        .flat_map(|route| &route.path)
        .filter(move |point| last.replace(**point) != Some(**point))
}

fn cost(terms: &CostTerms) -> Cost {
    Cost {
        total: finite(terms.total()),
        length: finite(terms.length),
        altitude: finite(terms.altitude),
        threat: finite(terms.threat),
        terrain: finite(terms.terrain),
        turn: finite(terms.turn),
        climb: finite(terms.climb),
        collision: finite(terms.collision),
    }
}

fn control_point(point: PlanPoint, world: &World) -> ControlPoint {
    let place = world.frame.from_plan(point.at);
    ControlPoint {
        lat_deg: rounded(place.lat_deg, DEGREE_DIGITS),
        lon_deg: rounded(place.lon_deg, DEGREE_DIGITS),
        amsl_m: rounded(point.amsl.0, METRE_DIGITS),
    }
}
