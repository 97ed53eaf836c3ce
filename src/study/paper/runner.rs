//! The runs: one vehicle after the other, many runs at once.

use std::cmp::Reverse;
use std::sync::Mutex;

use super::config::{Config, Job};
use super::contestants::{Contestant, Method};
use super::record::{Record, VehicleRecord};
use crate::cost::{Batch, CostModel, Scratch};
use crate::numeric::Seed;
use crate::optimize::{Algorithm, Problem, SearchSeeds, TracePoint, minimise};
use crate::path::Flight;
use crate::plan::{Request, plan_fleet};
use crate::study::setting::{Encoding, Setting, Spline, controls};
use crate::study::store::Study;
use crate::study::workers::{Done, run_all};

/// Points of a trace.
const TRACE_POINTS: usize = 50;

/// Makes runs, each on one thread, on as many threads as rayon would use. The longest start
/// first, so that all threads end together. `done` takes each record and its wall time in
/// seconds, in any order; no run seeds after it has returned false.
pub fn run(config: &Config, settings: &[Setting], jobs: &[Job], done: Done<'_, Record>) {
    let (contestants, hash) = (config.contestants(), config.hash());
    let mut jobs = jobs.to_vec();
    jobs.sort_by_key(|job| Reverse(effort(config, &contestants[job.contestant])));
    let make = |job: &Job| {
        let contestant = &contestants[job.contestant];
        let mut record = one(config, contestant, &settings[job.map], job.run);
        record.config.clone_from(&hash);
        record
    };
    run_all(&jobs, &make, done);
}

/// How long a run takes, in evaluations.
fn effort(config: &Config, contestant: &Contestant) -> usize {
    /// The planner decodes an altitude for every evaluation.
    const DECODING: usize = 3;
    let budget = contestant.budget(config.population, config.iterations);
    match contestant.method {
        Method::Published(_) => budget,
        Method::Planner => DECODING * budget,
    }
}

/// One run.
fn one(config: &Config, contestant: &Contestant, setting: &Setting, run: usize) -> Record {
    let seed = u64::try_from(run).map_or(config.seed, |run| config.seed.wrapping_add(run));
    let budget = contestant.budget(config.population, config.iterations);
    let found = match &contestant.method {
        Method::Published(algorithm) => {
            published(setting, &contestant.name, algorithm, budget, seed)
        }
        Method::Planner => planned(setting, budget, seed),
    };
    let vehicles = judge(setting, &found);
    Record {
        config: String::new(),
        algorithm: contestant.name.clone(),
        protocol: contestant.protocol.name().to_owned(),
        scenario: setting.scenario.name.clone(),
        run,
        seed,
        total: vehicles.iter().map(|vehicle| vehicle.total).sum(),
        fine_total: vehicles.iter().map(|vehicle| vehicle.fine_total).sum(),
        safe: vehicles.iter().all(|vehicle| vehicle.safe),
        vehicles,
    }
}

/// The path of one vehicle and its search.
struct Found {
    spline: Spline,
    evaluations: usize,
    /// Lowest cost after each fiftieth of the budget.
    trace: Vec<f64>,
}

/// The objective on the paper's encoding.
struct Encoded {
    model: CostModel,
    encoding: Encoding,
}

impl Problem for Encoded {
    fn dimension(&self) -> usize {
        self.encoding.dimension()
    }

    fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
        let mut batch = Batch::new(self.model.control_points());
        for candidate in candidates.chunks_exact(self.dimension()) {
            batch.push(&controls(&self.encoding.spline(candidate)));
        }
        self.model.totals(&batch, &mut Scratch::default(), costs);
    }
}

/// An algorithm of the paper, vehicle after vehicle.
fn published(
    setting: &Setting,
    name: &str,
    algorithm: &Algorithm,
    budget: usize,
    seed: u64,
) -> Vec<Found> {
    let mut flights = Vec::new();
    let mut all = Vec::new();
    let purpose = format!("study {name} {}", setting.scenario.name);
    for (vehicle, stream) in (0..setting.spec.vehicles.len()).zip(0..) {
        let problem = Encoded {
            model: setting.model(vehicle, &flights, setting.spec.planner.samples),
            encoding: setting.encoding(vehicle),
        };
        let mut rng = Seed(seed).stream(&purpose, stream);
        let seeds = SearchSeeds::default();
        let outcome = minimise(&problem, algorithm, seeds, budget, &mut rng, &|_| ());
        let best = outcome.finalists.first();
        let spline = best.map(|best| problem.encoding.spline(&best.position));
        let spline = spline.unwrap_or_default();
        flights.push(setting.flight(vehicle, &spline));
        all.push(Found {
            spline,
            evaluations: outcome.evaluations,
            trace: at_fiftieths(&outcome.trace, budget),
        });
    }
    all
}

/// The default planner on the same objective and budget.
fn planned(setting: &Setting, budget: usize, seed: u64) -> Vec<Found> {
    let mut spec = setting.spec.clone();
    spec.planner.evaluations = budget;
    let traces = Mutex::new(vec![Vec::new(); spec.vehicles.len()]);
    let plan = plan_fleet(
        &spec,
        &setting.world,
        &Request {
            progress: &|at| {
                if let Ok(mut traces) = traces.lock()
                    && let Some(trace) = traces.get_mut(at.vehicle)
                {
                    trace.push(TracePoint {
                        evaluations: at.evaluations,
                        best: at.best,
                    });
                }
            },
            ..Request::new(seed)
        },
    );
    let traces = traces.into_inner().unwrap_or_default();
    plan.vehicles
        .iter()
        .zip(traces)
        .map(|(vehicle, trace)| {
            let points = || {
                vehicle
                    .routes
                    .iter()
                    .flat_map(|route| &route.control_points)
            };
            Found {
                spline: [
                    points().map(|point| point.at.east_m).collect(),
                    points().map(|point| point.at.north_m).collect(),
                    points().map(|point| point.amsl.0).collect(),
                ],
                evaluations: vehicle.evaluations,
                trace: at_fiftieths(&trace, budget),
            }
        })
        .collect()
}

/// Lowest cost after each fiftieth of the budget; the first cost before any is known.
fn at_fiftieths(trace: &[TracePoint], budget: usize) -> Vec<f64> {
    let Some(first) = trace.first() else {
        return Vec::new();
    };
    let (mut best, mut next) = (first.best, 0);
    (1..=TRACE_POINTS)
        .map(|k| {
            while let Some(point) = trace
                .get(next)
                .filter(|point| point.evaluations <= k * budget / TRACE_POINTS)
            {
                best = best.min(point.best);
                next += 1;
            }
            best
        })
        .collect()
}

/// Costs of all paths at the samples of the search and at 2001.
fn judge(setting: &Setting, all: &[Found]) -> Vec<VehicleRecord> {
    let mut flights: Vec<Flight> = Vec::new();
    let mut vehicles = Vec::new();
    for (vehicle, found) in all.iter().enumerate() {
        let [east_m, north_m, amsl_m] = &found.spline;
        let controls = controls(&found.spline);
        let samples = setting.spec.planner.samples;
        let terms = setting.model(vehicle, &flights, samples).terms(&controls);
        let fine = setting.judge(vehicle, &flights).terms(&controls);
        let points = 0..east_m.len();
        vehicles.push(VehicleRecord {
            total: terms.total(),
            terms,
            fine_total: fine.total(),
            fine,
            safe: fine.is_clean(),
            evaluations: found.evaluations,
            control_points: points.map(|k| [east_m[k], north_m[k], amsl_m[k]]).collect(),
            trace: found.trace.clone(),
        });
        flights.push(setting.flight(vehicle, &found.spline));
    }
    vehicles
}
