//! How many costs a second the objective gives on this machine.
//!
//! The world is the third map of the paper's experiment with a tenth threat, its
//! ground on a grid of 513 nodes a side; the path has 8 free control points and 101
//! samples, at each of which the ground is read once, unless something else is said. Local
//! are uniform steps of a tenth of the map around a path that was found by differential
//! evolution, near ones of a hundredth, global ones are anywhere. Rates are those of the
//! fastest of several passes, because other programs take their share of the others.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use rand::RngExt;
use rayon::prelude::*;
use serde::Serialize;

use super::setting::Setting;
use super::shipped_maps;
use crate::cost::{Batch, Controls, CostModel, Dispatch, PaperOptions, Scratch};
use crate::geodesy::{EastNorth, PlanPoint};
use crate::numeric::{Basis, Seed};
use crate::optimize::{Algorithm, DeParameters, Problem, minimise};
use crate::path::{Flight, time_route};
use crate::spec::{Cylinder, Objective, Scenario, SpecError};
use crate::world::Ground;

/// Free control points.
const FREE: usize = 8;
/// Samples of the path.
const SAMPLES: usize = 101;
/// Threats.
const THREATS: usize = 10;
/// Spacing of the ground's grid, metres.
const SPACING_M: f64 = 100_000.0 / 512.0;
/// Candidates of a pass.
const CANDIDATES: usize = 1024;
/// Candidates of one batch.
const BATCH: usize = 64;
/// Evaluations of the search for the path in the middle.
const SEARCH: usize = 20_000;
/// Radius of local steps, in parts of the map.
const RADIUS: f64 = 0.1;
/// Radius of the steps of a swarm that has nearly settled.
const NEAR_RADIUS: f64 = 0.01;

/// Evaluations per second.
#[derive(Clone, Debug, Serialize)]
pub struct Speed {
    /// Local candidates, one thread.
    pub fast_one_thread: f64,
    /// Global candidates, one thread.
    pub fast_global_one_thread: f64,
    /// Near candidates, one thread.
    pub fast_near_one_thread: f64,
    /// Near candidates with the ground read up to four times a piece, as the planner does.
    pub fast_dense_one_thread: f64,
    /// Local candidates, all threads.
    pub fast_all_threads: f64,
    /// Local candidates, no more exact than needed to find the best twentieth.
    pub fast_cutoff_one_thread: f64,
    /// Local candidates with two earlier vehicles in the collision term.
    pub fast_traffic_one_thread: f64,
    /// The plain reference, one thread.
    pub reference_one_thread: f64,
    /// Instructions in use.
    pub dispatch: &'static str,
    /// The processor.
    pub cpu: String,
    /// Threads that `fast_all_threads` uses.
    pub threads: usize,
    /// Local and global candidates by each set of instructions, one thread.
    pub levels: Vec<Level>,
    /// The same by the paper's objective.
    pub paper: Paper,
}

/// One set of instructions.
#[derive(Clone, Debug, Serialize)]
pub struct Level {
    /// Its name.
    pub dispatch: &'static str,
    /// Local candidates.
    pub fast_one_thread: f64,
    /// Global candidates.
    pub fast_global_one_thread: f64,
}

/// The paper's objective.
#[derive(Clone, Debug, Serialize)]
pub struct Paper {
    /// Local candidates, one thread.
    pub fast_one_thread: f64,
    /// Global candidates, one thread.
    pub fast_global_one_thread: f64,
    /// Near candidates, one thread.
    pub fast_near_one_thread: f64,
    /// Local candidates with two earlier vehicles in the collision term.
    pub fast_traffic_one_thread: f64,
    /// The plain reference, one thread.
    pub reference_one_thread: f64,
    /// Local and global candidates by each set of instructions.
    pub levels: Vec<Level>,
}

/// Measures, each rate for about `seconds`.
///
/// # Errors
/// None with the map that comes with the program.
pub fn speed(seconds: f64) -> Result<Speed, SpecError> {
    let operational = Course::new(Objective::Operational)?;
    let paper = Course::new(Objective::Paper)?;
    let rate = |course: &Course, batches: &[Batch]| fast(&course.model, batches, seconds);
    let (local, global) = (operational.local(RADIUS), operational.global());
    let threads = rayon::current_num_threads();
    let mut fastest = Meter::new(seconds);
    while fastest.goes_on() {
        fastest.pass(|| {
            local.par_iter().for_each(|batch| {
                totals(&operational.model, batch, f64::INFINITY);
            });
        });
    }
    let fast_all_threads = fastest.rate();
    Ok(Speed {
        fast_one_thread: rate(&operational, &local),
        fast_global_one_thread: rate(&operational, &global),
        fast_near_one_thread: rate(&operational, &operational.local(NEAR_RADIUS)),
        fast_dense_one_thread: fast(
            &operational.dense(),
            &operational.local(NEAR_RADIUS),
            seconds,
        ),
        fast_all_threads,
        fast_cutoff_one_thread: cut(&operational.model, &local, seconds),
        fast_traffic_one_thread: fast(&operational.among_others(), &local, seconds),
        reference_one_thread: plain(&operational, seconds),
        dispatch: Dispatch::best().name(),
        cpu: cpu(),
        threads,
        levels: operational.levels(seconds),
        paper: Paper {
            fast_one_thread: rate(&paper, &paper.local(RADIUS)),
            fast_global_one_thread: rate(&paper, &paper.global()),
            fast_near_one_thread: rate(&paper, &paper.local(NEAR_RADIUS)),
            fast_traffic_one_thread: fast(&paper.among_others(), &paper.local(RADIUS), seconds),
            reference_one_thread: plain(&paper, seconds),
            levels: paper.levels(seconds),
        },
    })
}

/// One vehicle's objective and a good path.
struct Course {
    setting: Setting,
    model: CostModel,
    middle: Vec<f64>,
}

impl Course {
    fn new(objective: Objective) -> Result<Self, SpecError> {
        let [.., (name, text)] = shipped_maps();
        let mut scenario = Scenario::parse(Path::new(name), text)?;
        scenario.planner.objective = objective;
        scenario.planner.control_points = FREE;
        scenario.planner.samples = SAMPLES;
        let tenth = Cylinder {
            id: "radar-4".to_owned(),
            kind: "radar".to_owned(),
            center: EastNorth {
                east_m: 15_000.0,
                north_m: 20_000.0,
            },
            radius_m: 5000.0,
        };
        scenario.threats.push(tenth);
        scenario.threats.truncate(THREATS);
        let mut setting = Setting::new(scenario, PaperOptions::default());
        let surface = setting.scenario.surface.clone();
        setting.world.ground = Arc::new(Ground::sample_by(&setting.world.area, SPACING_M, |at| {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "heights need no more than f32"
            )]
            let height_m = surface.height_m(at) as f32;
            height_m
        }));
        let mut course = Self {
            model: setting.model(0, &[], SAMPLES).with_one_reading(),
            setting,
            middle: Vec::new(),
        };
        let algorithm = Algorithm::De(DeParameters::default());
        let mut rng = Seed(1).stream("speed search", 0);
        let found = minimise(&course, &algorithm, &[], SEARCH, &mut rng, &|_| ());
        course.middle = found
            .finalists
            .first()
            .map_or_else(|| vec![0.5; 3 * FREE], |best| best.position.clone());
        Ok(course)
    }

    /// The spline of a point of the unit cube.
    fn spline(&self, candidate: &[f64]) -> [Vec<f64>; 3] {
        let leg = self.setting.leg(0);
        let scenario = &self.setting.scenario;
        let (low, high) = (scenario.south_west, scenario.north_east);
        let axis = |axis: usize, low: f64, high: f64, from: f64, to: f64| {
            let mut values = vec![from];
            let free = &candidate[axis * FREE..][..FREE];
            values.extend(free.iter().map(|share| low + share * (high - low)));
            values.push(to);
            values
        };
        let (from, to) = (leg.from, leg.to);
        [
            axis(0, low.east_m, high.east_m, from.at.east_m, to.at.east_m),
            axis(1, low.north_m, high.north_m, from.at.north_m, to.at.north_m),
            axis(2, 0.0, scenario.max_amsl.0, from.amsl.0, to.amsl.0),
        ]
    }

    fn batches(&self, candidates: impl Iterator<Item = Vec<f64>>) -> Vec<Batch> {
        let splines: Vec<[Vec<f64>; 3]> = candidates.map(|one| self.spline(&one)).collect();
        splines
            .chunks(BATCH)
            .map(|chunk| {
                let mut batch = Batch::new(FREE + 2);
                for spline in chunk {
                    batch.push(&controls(spline));
                }
                batch
            })
            .collect()
    }

    fn local(&self, radius: f64) -> Vec<Batch> {
        let mut rng = Seed(1).stream("speed local", 0);
        self.batches((0..CANDIDATES).map(|_| {
            let step = |middle: &f64| {
                let by: f64 = rng.random_range(-radius..radius);
                (middle + by).clamp(0.0, 1.0)
            };
            self.middle.iter().map(step).collect()
        }))
    }

    fn global(&self) -> Vec<Batch> {
        let mut rng = Seed(1).stream("speed global", 0);
        self.batches((0..CANDIDATES).map(|_| (0..3 * FREE).map(|_| rng.random()).collect()))
    }

    /// The objective after two other vehicles that fly straight.
    fn among_others(&self) -> CostModel {
        let flights: Vec<Flight> = [1, 2]
            .iter()
            .map(|&vehicle| {
                let leg = self.setting.leg(vehicle);
                let basis = Basis::uniform(FREE + 2, SAMPLES);
                let coordinate = |from: f64, to: f64| {
                    let controls: Vec<f64> = (0..10_u8)
                        .map(|i| from + (to - from) * f64::from(i) / 9.0)
                        .collect();
                    let mut out = vec![0.0; SAMPLES];
                    basis.apply(&controls, &mut out);
                    out
                };
                let (from, to) = (leg.from, leg.to);
                let east_m = coordinate(from.at.east_m, to.at.east_m);
                let north_m = coordinate(from.at.north_m, to.at.north_m);
                let points: Vec<PlanPoint> = east_m
                    .into_iter()
                    .zip(north_m)
                    .map(|(east_m, north_m)| PlanPoint::new(east_m, north_m, from.amsl))
                    .collect();
                let of = &self.setting.spec.vehicles[vehicle];
                Flight {
                    points: time_route(&points, 0.0, of.speed_mps, of.accel_mps2),
                    route_starts_s: vec![0.0],
                    loiters: false,
                }
            })
            .collect();
        self.setting.model(0, &flights, SAMPLES).with_one_reading()
    }

    /// The objective as the planner has it.
    fn dense(&self) -> CostModel {
        self.setting.model(0, &[], SAMPLES)
    }

    fn levels(&self, seconds: f64) -> Vec<Level> {
        let (local, global) = (self.local(RADIUS), self.global());
        Dispatch::all()
            .into_iter()
            .map(|dispatch| {
                let model = self.model.clone().with_dispatch(dispatch);
                Level {
                    dispatch: dispatch.name(),
                    fast_one_thread: fast(&model, &local, seconds),
                    fast_global_one_thread: fast(&model, &global, seconds),
                }
            })
            .collect()
    }
}

impl Problem for Course {
    fn dimension(&self) -> usize {
        3 * FREE
    }

    fn evaluate(&self, candidates: &[f64], cutoff: f64, costs: &mut [f64]) {
        let rows = candidates.chunks_exact(3 * FREE).map(<[f64]>::to_vec);
        for (batch, costs) in self.batches(rows).iter().zip(costs.chunks_mut(BATCH)) {
            self.model
                .totals(batch, cutoff, &mut Scratch::default(), costs);
        }
    }
}

fn controls(spline: &[Vec<f64>; 3]) -> Controls<'_> {
    Controls {
        east_m: &spline[0],
        north_m: &spline[1],
        amsl_m: &spline[2],
    }
}

/// Passes over all candidates against the clock.
struct Meter {
    until_s: f64,
    spent_s: f64,
    best_s: f64,
}

impl Meter {
    fn new(seconds: f64) -> Self {
        Self {
            until_s: seconds,
            spent_s: 0.0,
            best_s: f64::INFINITY,
        }
    }

    fn goes_on(&self) -> bool {
        self.spent_s < self.until_s
    }

    fn pass(&mut self, act: impl FnOnce()) {
        #[expect(
            clippy::disallowed_methods,
            reason = "wall times are what is asked for"
        )]
        let started = Instant::now();
        act();
        let took_s = started.elapsed().as_secs_f64();
        self.spent_s += took_s;
        self.best_s = self.best_s.min(took_s);
    }

    fn rate(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "a thousand")]
        let candidates = CANDIDATES as f64;
        candidates / self.best_s
    }
}

fn totals(model: &CostModel, batch: &Batch, cutoff: f64) -> [f64; BATCH] {
    let mut costs = [0.0; BATCH];
    let costs_of = &mut costs[..batch.len()];
    model.totals(batch, cutoff, &mut Scratch::default(), costs_of);
    costs
}

fn fast(model: &CostModel, batches: &[Batch], seconds: f64) -> f64 {
    pass_all(model, batches, f64::INFINITY, seconds)
}

fn pass_all(model: &CostModel, batches: &[Batch], cutoff: f64, seconds: f64) -> f64 {
    let mut scratch = Scratch::default();
    let mut costs = [0.0; BATCH];
    let mut meter = Meter::new(seconds);
    while meter.goes_on() {
        meter.pass(|| {
            for batch in batches {
                model.totals(batch, cutoff, &mut scratch, &mut costs[..batch.len()]);
                std::hint::black_box(&costs);
            }
        });
    }
    meter.rate()
}

/// With a cutoff that one in twenty is below.
fn cut(model: &CostModel, batches: &[Batch], seconds: f64) -> f64 {
    let mut costs: Vec<f64> = batches
        .iter()
        .flat_map(|batch| totals(model, batch, f64::INFINITY))
        .collect();
    costs.sort_by(f64::total_cmp);
    pass_all(model, batches, costs[costs.len() / 20], seconds)
}

/// The plain reference.
fn plain(course: &Course, seconds: f64) -> f64 {
    let mut rng = Seed(1).stream("speed local", 0);
    let splines: Vec<[Vec<f64>; 3]> = (0..CANDIDATES)
        .map(|_| {
            let step = |middle: &f64| {
                let by: f64 = rng.random_range(-RADIUS..RADIUS);
                (middle + by).clamp(0.0, 1.0)
            };
            let one: Vec<f64> = course.middle.iter().map(step).collect();
            course.spline(&one)
        })
        .collect();
    let mut meter = Meter::new(seconds);
    while meter.goes_on() {
        meter.pass(|| {
            for spline in &splines {
                std::hint::black_box(course.model.terms(&controls(spline)).total());
            }
        });
    }
    meter.rate()
}

/// What the system calls the processor.
fn cpu() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map(|(_, name)| name.trim().to_owned());
    name.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}
