//! What costs are measured on: one vehicle, a good path, and candidates around it.

use std::path::Path;
use std::sync::Arc;

use rand::RngExt;

use super::setting::Setting;
use super::shipped_maps;
use crate::cost::{Batch, Controls, CostModel, PaperOptions, Scratch};
use crate::geodesy::{EastNorth, PlanPoint};
use crate::numeric::{Basis, Seed};
use crate::optimize::{Algorithm, DeParameters, Problem, SearchSeeds, minimise};
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
/// Candidates of a population.
pub(super) const CANDIDATES: usize = 1024;
/// Candidates of one batch.
pub(super) const BATCH: usize = 64;
/// Evaluations of the search for the path in the middle.
const SEARCH: usize = 20_000;

/// Where the candidates of a population lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Population {
    /// Uniform steps of a tenth of the map around a good path.
    Local,
    /// Steps of a hundredth, as in a swarm that has nearly settled.
    Near,
    /// Anywhere.
    Global,
}

/// One vehicle's objective and a good path: the third map of the paper's experiment with a
/// tenth threat, its ground on a grid of 513 nodes a side, 8 free control points and 101
/// samples, at each of which the ground is read once.
pub struct SpeedCourse {
    setting: Setting,
    /// The objective.
    pub model: CostModel,
    middle: Vec<f64>,
}

impl SpeedCourse {
    /// Lays it out and searches the path.
    ///
    /// # Errors
    /// None with the map that comes with the program.
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
            setting,
            middle: Vec::new(),
        };
        let algorithm = Algorithm::De(DeParameters::default());
        let mut rng = Seed(1).stream("speed search", 0);
        let found = minimise(
            &course,
            &algorithm,
            SearchSeeds::default(),
            SEARCH,
            &mut rng,
            &|_| (),
        );
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

    /// The candidates of a population.
    pub(super) fn splines(&self, population: Population) -> Vec<[Vec<f64>; 3]> {
        let mut rng = Seed(1).stream("speed candidates", 0);
        let mut number = |middle: &f64| match population {
            Population::Local => (middle + rng.random_range(-0.1..0.1)).clamp(0.0, 1.0),
            Population::Near => (middle + rng.random_range(-0.01..0.01)).clamp(0.0, 1.0),
            Population::Global => rng.random(),
        };
        (0..CANDIDATES)
            .map(|_| self.middle.iter().map(&mut number).collect::<Vec<f64>>())
            .map(|candidate| self.spline(&candidate))
            .collect()
    }

    /// The same in batches.
    #[must_use]
    pub fn batches(&self, population: Population) -> Vec<Batch> {
        batches(&self.splines(population))
    }

    /// The objective after two other vehicles that fly straight.
    pub(super) fn among_others(&self) -> CostModel {
        let flights: Vec<Flight> = [1, 2]
            .iter()
            .map(|&vehicle| {
                let leg = self.setting.leg(vehicle);
                let basis = Basis::uniform(FREE + 2, SAMPLES);
                let coordinate = |from: f64, to: f64| {
                    let controls: Vec<f64> = (0..10_u8)
                        .map(|i| from + (to - from) * f64::from(i) / 9.0)
                        .collect();
                    basis.sampled(&controls)
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
        let splines: Vec<_> = rows.map(|row| self.spline(row)).collect();
        for (batch, costs) in batches(&splines).iter().zip(costs.chunks_mut(BATCH)) {
            self.model.totals(batch, &mut Scratch::default(), costs);
        }
    }
}

fn batches(splines: &[[Vec<f64>; 3]]) -> Vec<Batch> {
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

pub(super) fn controls(spline: &[Vec<f64>; 3]) -> Controls<'_> {
    Controls {
        east_m: &spline[0],
        north_m: &spline[1],
        amsl_m: &spline[2],
    }
}
