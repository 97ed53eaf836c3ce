//! The problem whose costs are timed: one vehicle, a good path, and candidates around it.

use std::path::Path;
use std::sync::Arc;

use rand::RngExt;

use crate::cost::{Batch, CostModel, PaperOptions, Scratch};
use crate::geodesy::EastNorth;
use crate::numeric::Seed;
use crate::optimize::{Algorithm, DeParameters, Problem, SearchSeeds, minimise};
use crate::path::Flight;
use crate::spec::{Cylinder, Objective, Scenario, SpecError};
use crate::study::paper::shipped_maps;
use crate::study::setting::{Encoding, Setting, Spline, controls};
use crate::world::Ground;

/// Free control points.
const FREE: usize = 8;
/// Samples of the path.
const SAMPLES: usize = 101;
/// Threats.
const THREATS: usize = 10;
/// Spacing of the ground's grid, metres.
const SPACING_M: f64 = 100_000.0 / 512.0;
/// Candidates of a population.
pub(super) const CANDIDATES: usize = 1024;
/// Candidates of one batch.
pub(super) const BATCH: usize = 64;
/// Evaluations of the search for the good path.
const SEARCH: usize = 20_000;

/// Where the candidates of a population lie in the unit cube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Population {
    /// Uniform steps of a tenth of the map around a good path.
    Local,
    /// Steps of a hundredth, as in a swarm that has nearly converged.
    Near,
    /// Uniform in the whole map.
    Global,
}

/// One vehicle's objective and a good path: the third map of the paper's experiment with a
/// tenth threat, its ground on a grid of 513 nodes a side, 8 free control points and 101
/// samples, and each sample reads the ground once.
pub struct SpeedCourse {
    setting: Setting,
    /// The objective.
    pub model: CostModel,
    encoding: Encoding,
    middle: Vec<f64>,
}

impl SpeedCourse {
    /// Searches the path.
    ///
    /// # Errors
    /// None with the shipped map.
    pub fn new(objective: Objective) -> Result<Self, SpecError> {
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
            encoding: setting.encoding(0),
            setting,
            middle: Vec::new(),
        };
        let algorithm = Algorithm::De(DeParameters::default());
        let mut rng = Seed(1).stream("speed search", 0);
        let seeds = SearchSeeds::default();
        let found = minimise(&course, &algorithm, seeds, SEARCH, &mut rng, &|_| ());
        course.middle = found
            .finalists
            .first()
            .map_or_else(|| vec![0.5; 3 * FREE], |best| best.position.clone());
        Ok(course)
    }

    /// The candidates of a population.
    pub(super) fn splines(&self, population: Population) -> Vec<Spline> {
        let mut rng = Seed(1).stream("speed candidates", 0);
        let mut number = |middle: &f64| match population {
            Population::Local => (middle + rng.random_range(-0.1..0.1)).clamp(0.0, 1.0),
            Population::Near => (middle + rng.random_range(-0.01..0.01)).clamp(0.0, 1.0),
            Population::Global => rng.random(),
        };
        (0..CANDIDATES)
            .map(|_| self.middle.iter().map(&mut number).collect::<Vec<f64>>())
            .map(|candidate| self.encoding.spline(&candidate))
            .collect()
    }

    /// The candidates of a population in batches.
    #[must_use]
    pub fn batches(&self, population: Population) -> Vec<Batch> {
        batches(&self.splines(population))
    }

    /// The objective with two earlier vehicles that fly straight.
    pub(super) fn among_others(&self) -> CostModel {
        let straight = |vehicle: usize| {
            let leg = self.setting.leg(vehicle);
            let line = |from: f64, to: f64| {
                let shares = (0..10_u8).map(|k| f64::from(k) / 9.0);
                shares.map(|share| from + (to - from) * share).collect()
            };
            let (from, to) = (leg.from, leg.to);
            let spline = [
                line(from.at.east_m, to.at.east_m),
                line(from.at.north_m, to.at.north_m),
                line(from.amsl.0, from.amsl.0),
            ];
            self.setting.flight(vehicle, &spline)
        };
        let flights: Vec<Flight> = [1, 2].map(straight).into();
        self.setting.model(0, &flights, SAMPLES).with_one_reading()
    }

    /// The objective as the planner evaluates it.
    pub(super) fn dense(&self) -> CostModel {
        self.setting.model(0, &[], SAMPLES)
    }
}

impl Problem for SpeedCourse {
    fn dimension(&self) -> usize {
        3 * FREE
    }

    fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
        let rows = candidates.chunks_exact(3 * FREE);
        let splines: Vec<_> = rows.map(|row| self.encoding.spline(row)).collect();
        for (batch, costs) in batches(&splines).iter().zip(costs.chunks_mut(BATCH)) {
            self.model.totals(batch, &mut Scratch::default(), costs);
        }
    }
}

fn batches(splines: &[Spline]) -> Vec<Batch> {
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
