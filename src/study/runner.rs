//! The runs: one vehicle after the other, many runs at once.

use std::cmp::Reverse;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use super::config::Config;
use super::contest::{Contestant, Method};
use super::record::{Record, VehicleRecord};
use super::setting::Setting;
use super::store::Study;
use crate::cost::{Batch, Controls, CostModel, Scratch};
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::{Basis, Seed};
use crate::optimize::{Algorithm, Problem, SearchSeeds, TracePoint, minimise};
use crate::path::{Flight, time_route};
use crate::plan::{Request, plan_fleet};

/// Points of a trace.
const TRACE_POINTS: usize = 50;

/// One run to be made; jobs are in the order of the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Job {
    /// Index of the contestant.
    pub contestant: usize,
    /// Index of the map.
    pub map: usize,
    /// Number of the run, from 0.
    pub run: usize,
}

impl Job {
    /// All jobs of a study.
    #[must_use]
    pub fn all(config: &Config) -> Vec<Self> {
        let maps = config.maps.len();
        config
            .contestants()
            .iter()
            .enumerate()
            .flat_map(|(contestant, of)| {
                let runs = of.runs(config.runs);
                (0..maps).flat_map(move |map| {
                    (0..runs).map(move |run| Self {
                        contestant,
                        map,
                        run,
                    })
                })
            })
            .collect()
    }
}

/// Runs jobs on as many threads as rayon would use, each job on one and the longest
/// first, so that all threads end together, and hands each record to `done` with the
/// seconds it took, in no certain order.
///
/// Runs end early once `done` returns false.
pub fn run(
    config: &Config,
    settings: &[Setting],
    jobs: &[Job],
    done: &(dyn Fn(Record, f64) -> bool + Sync),
) {
    let (contestants, hash) = (config.contestants(), config.hash());
    let mut jobs = jobs.to_vec();
    jobs.sort_by_key(|job| Reverse(effort(config, &contestants[job.contestant])));
    let make = |job: &Job| {
        let contestant = &contestants[job.contestant];
        let mut record = one(config, contestant, &settings[job.map], job.run);
        record.config.clone_from(&hash);
        record
    };
    spread(&jobs, &make, done);
}

/// Makes something of each job, one job on each thread of as many as rayon would use, and
/// hands it to `done` with the seconds it took, in no certain order, until that says false.
pub(super) fn spread<J: Sync, R: Send>(
    jobs: &[J],
    make: &(dyn Fn(&J) -> R + Sync),
    done: &(dyn Fn(R, f64) -> bool + Sync),
) {
    let next = AtomicUsize::new(0);
    let work = || {
        // The evaluations of one run stay on its thread.
        let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else {
            return;
        };
        while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
            #[expect(
                clippy::disallowed_methods,
                reason = "wall times are shown, they decide nothing"
            )]
            let started = Instant::now();
            let made = pool.install(|| make(job));
            if !done(made, started.elapsed().as_secs_f64()) {
                next.store(jobs.len(), Ordering::Relaxed);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..rayon::current_num_threads() {
            scope.spawn(work);
        }
    });
}

/// How long a run takes, in evaluations.
fn effort(config: &Config, contestant: &Contestant) -> usize {
    /// The planner decodes an altitude for every evaluation.
    const DECODING: usize = 3;
    let budget = contestant.budget(config.population, config.iterations);
    match contestant.method {
        Method::Printed(_) => budget,
        Method::Planner => DECODING * budget,
    }
}

/// One run.
fn one(config: &Config, contestant: &Contestant, setting: &Setting, run: usize) -> Record {
    let seed = u64::try_from(run).map_or(config.seed, |run| config.seed.wrapping_add(run));
    let budget = contestant.budget(config.population, config.iterations);
    let found = match &contestant.method {
        Method::Printed(algorithm) => printed(setting, contestant.name, algorithm, budget, seed),
        Method::Planner => planned(setting, budget, seed),
    };
    let vehicles = judged(setting, &found);
    Record {
        config: String::new(),
        algorithm: contestant.name.to_owned(),
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

/// Control points of one vehicle by coordinate, ends included, and how they were found.
#[derive(Clone, Debug, Default)]
struct Found {
    east_m: Vec<f64>,
    north_m: Vec<f64>,
    amsl_m: Vec<f64>,
    evaluations: usize,
    trace: Vec<f64>,
}

impl Found {
    fn controls(&self) -> Controls<'_> {
        Controls {
            east_m: &self.east_m,
            north_m: &self.north_m,
            amsl_m: &self.amsl_m,
        }
    }

    /// The flight that later vehicles see: as many points as the search has samples.
    fn flight(&self, setting: &Setting, vehicle: usize) -> Flight {
        let basis = Basis::uniform(self.east_m.len(), setting.spec.planner.samples);
        let (east, north) = (basis.sampled(&self.east_m), basis.sampled(&self.north_m));
        let points: Vec<PlanPoint> = basis
            .sampled(&self.amsl_m)
            .into_iter()
            .zip(east.into_iter().zip(north))
            .map(|(amsl_m, (east_m, north_m))| PlanPoint::new(east_m, north_m, Amsl(amsl_m)))
            .collect();
        let vehicle = &setting.spec.vehicles[vehicle];
        Flight {
            points: time_route(&points, 0.0, vehicle.speed_mps, vehicle.accel_mps2),
            route_starts_s: vec![0.0],
            loiters: false,
        }
    }
}

/// Eq. 33: first all east, then all north, then all altitudes, each in parts of the map.
struct Encoded {
    model: CostModel,
    from: PlanPoint,
    to: PlanPoint,
    low: EastNorth,
    high: EastNorth,
    top_m: f64,
    free: usize,
}

impl Encoded {
    fn decode(&self, candidate: &[f64], found: &mut Found) {
        let axis = |part: usize, low: f64, high: f64, ends: [f64; 2], out: &mut Vec<f64>| {
            let free = &candidate[part * self.free..][..self.free];
            out.clear();
            out.push(ends[0]);
            out.extend(free.iter().map(|s| low + s * (high - low)));
            out.push(ends[1]);
        };
        let (from, to) = (self.from, self.to);
        let (low, high) = (self.low, self.high);
        axis(
            0,
            low.east_m,
            high.east_m,
            [from.at.east_m, to.at.east_m],
            &mut found.east_m,
        );
        axis(
            1,
            low.north_m,
            high.north_m,
            [from.at.north_m, to.at.north_m],
            &mut found.north_m,
        );
        axis(
            2,
            0.0,
            self.top_m,
            [from.amsl.0, to.amsl.0],
            &mut found.amsl_m,
        );
    }
}

impl Problem for Encoded {
    fn dimension(&self) -> usize {
        3 * self.free
    }

    fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
        let mut found = Found::default();
        let mut batch = Batch::new(self.model.control_points());
        for candidate in candidates.chunks_exact(self.dimension()) {
            self.decode(candidate, &mut found);
            batch.push(&found.controls());
        }
        self.model.totals(&batch, &mut Scratch::default(), costs);
    }
}

/// An algorithm of the paper, vehicle after vehicle.
fn printed(
    setting: &Setting,
    name: &str,
    algorithm: &Algorithm,
    budget: usize,
    seed: u64,
) -> Vec<Found> {
    let planner = &setting.spec.planner;
    let mut flights = Vec::new();
    let mut all = Vec::new();
    let purpose = format!("study {name} {}", setting.scenario.name);
    for (vehicle, stream) in (0..setting.spec.vehicles.len()).zip(0..) {
        let leg = setting.leg(vehicle);
        let problem = Encoded {
            model: setting.model(vehicle, &flights, planner.samples),
            from: leg.from,
            to: leg.to,
            low: setting.scenario.south_west,
            high: setting.scenario.north_east,
            top_m: setting.scenario.max_amsl.0,
            free: planner.control_points,
        };
        let mut rng = Seed(seed).stream(&purpose, stream);
        let outcome = minimise(
            &problem,
            algorithm,
            SearchSeeds::default(),
            budget,
            &mut rng,
            &|_| (),
        );
        let mut found = Found {
            evaluations: outcome.evaluations,
            trace: thinned(&outcome.trace, budget),
            ..Found::default()
        };
        if let Some(best) = outcome.finalists.first() {
            problem.decode(&best.position, &mut found);
        }
        flights.push(found.flight(setting, vehicle));
        all.push(found);
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
            seed,
            margins: Vec::new(),
            extra_parameters: Vec::new(),
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
        },
    );
    let traces = traces.into_inner().unwrap_or_default();
    plan.vehicles
        .iter()
        .zip(traces)
        .map(|(vehicle, trace)| {
            let points = vehicle
                .routes
                .iter()
                .flat_map(|route| &route.control_points);
            Found {
                east_m: points.clone().map(|point| point.at.east_m).collect(),
                north_m: points.clone().map(|point| point.at.north_m).collect(),
                amsl_m: points.map(|point| point.amsl.0).collect(),
                evaluations: vehicle.evaluations,
                trace: thinned(&trace, budget),
            }
        })
        .collect()
}

/// Least cost after each fiftieth of the budget; before the first is known, the first.
fn thinned(trace: &[TracePoint], budget: usize) -> Vec<f64> {
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

/// Every contestant judged alike, at the samples of the search and finely.
fn judged(setting: &Setting, all: &[Found]) -> Vec<VehicleRecord> {
    let mut flights: Vec<Flight> = Vec::new();
    let mut vehicles = Vec::new();
    for (vehicle, found) in all.iter().enumerate() {
        let controls = found.controls();
        let samples = setting.spec.planner.samples;
        let terms = setting.model(vehicle, &flights, samples).terms(&controls);
        let fine = setting.judge(vehicle, &flights).terms(&controls);
        vehicles.push(VehicleRecord {
            total: terms.total(),
            terms: terms.into(),
            fine_total: fine.total(),
            fine: fine.into(),
            safe: fine.is_clean(),
            evaluations: found.evaluations,
            control_points: found
                .east_m
                .iter()
                .zip(&found.north_m)
                .zip(&found.amsl_m)
                .map(|((&east_m, &north_m), &amsl_m)| [east_m, north_m, amsl_m])
                .collect(),
            trace: found.trace.clone(),
        });
        flights.push(found.flight(setting, vehicle));
    }
    vehicles
}
