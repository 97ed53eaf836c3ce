//! What one vehicle may fly, each as its encoded mission is flown.

use rand_chacha::ChaCha8Rng;

use crate::cost::CostTerms;
use crate::mission;
use crate::path::TimedPoint;
use crate::plan::{Shape, Shaper, VehiclePlan};
use crate::spec::{MissionSpec, Span};
use crate::verify::{Executed, Judge};
use crate::world::World;

use super::moves::{between, random, shapes};

/// Departures of a window that are tried with the path alone.
const DEPARTURES: u32 = 30;
/// Speeds of a range that are tried, besides the specified one.
const SPEEDS: u32 = 4;

/// A path, a speed and a departure.
pub(super) struct Variant {
    shape: Shape,
    terms: CostTerms,
    /// Which of the speeds.
    speed: usize,
    pub(super) later_s: f64,
    pub(super) cost: f64,
}

/// What one vehicle may fly.
pub(super) struct Variants<'a> {
    index: usize,
    shapers: Vec<Shaper<'a>>,
    /// The first is the path alone as specified.
    pub(super) all: Vec<Variant>,
}

impl<'a> Variants<'a> {
    /// Around the path of a vehicle alone. With `retimes` the departures and speeds that the
    /// spec leaves open are tried too. None where paths have no shapes that could be moved.
    pub(super) fn new(
        (spec, world): (&'a MissionSpec, &'a World),
        index: usize,
        alone: &VehiclePlan,
        retimes: bool,
    ) -> Option<Self> {
        let vehicle = spec.vehicles.get(index)?;
        let speeds = choices(vehicle.speed_mps, vehicle.retiming.speed_mps, SPEEDS);
        let shapers: Option<Vec<Shaper<'a>>> = speeds
            .iter()
            .take(if retimes { usize::MAX } else { 1 })
            .map(|&speed_mps| Shaper::new(spec, world, index, alone, speed_mps))
            .collect();
        let mut found = Self {
            index,
            shapers: shapers?,
            all: Vec::new(),
        };
        let shape = Shape {
            depart_s: vehicle.depart_s,
            ..alone.shape()
        };
        found.add(shapes(&shape, &spec.buffered_separation()), 0, &[0.0]);
        if retimes {
            let window = vehicle.retiming.depart_s;
            let times = choices(vehicle.depart_s, window, DEPARTURES);
            let times = times.iter().skip(1).map(|at| at - vehicle.depart_s);
            let times: Vec<f64> = times.collect();
            found.add(vec![shape.clone()], 0, &times);
            for speed in 1..speeds.len() {
                found.add(vec![shape.clone()], speed, &[0.0]);
            }
        }
        (!found.all.is_empty()).then_some(found)
    }

    /// Adds the shapes that break no limit, at some departures.
    fn add(&mut self, shapes: Vec<Shape>, speed: usize, times: &[f64]) {
        let terms = self.shapers[speed].terms(&shapes);
        for (shape, terms) in shapes.into_iter().zip(terms) {
            if terms.is_clean() {
                self.all.extend(times.iter().map(|&later_s| Variant {
                    shape: shape.clone(),
                    terms,
                    speed,
                    later_s,
                    cost: terms.total(),
                }));
            }
        }
    }

    /// Adds shapes around the first, at random.
    pub(super) fn add_random(&mut self, count: usize, rng: &mut ChaCha8Rng) {
        let Some((shape, later_s)) = self.all.first().map(|first| (&first.shape, first.later_s))
        else {
            return;
        };
        let separation = self.shapers[0].spec().buffered_separation();
        let shapes = (0..count).map(|_| random(shape, &separation, rng));
        self.add(shapes.collect(), 0, &[later_s]);
    }

    /// Adds shapes between that of a variant and the first.
    pub(super) fn add_between(&mut self, variant: usize) {
        let own = &self.all[variant];
        let (speed, later_s) = (own.speed, own.later_s);
        self.add(between(&own.shape, &self.all[0].shape), speed, &[later_s]);
    }

    /// The flight of a variant as it is encoded; none if its mission breaks a limit of its own.
    pub(super) fn executed(
        &self,
        judge: &Judge<'a>,
        world: &World,
        variant: usize,
    ) -> Option<Executed<'a>> {
        let speed = &self.shapers[self.all[variant].speed];
        let plan = self.plan(variant);
        // The items of another departure are others: they hold a delay.
        let mut spec = speed.spec().clone();
        spec.vehicles[self.index].depart_s = plan.depart_s;
        let paths = plan.routes.iter().map(|route| route.path.clone());
        let routes: Vec<Vec<TimedPoint>> = paths.collect();
        let mission = mission::build(&spec, world, self.index, &routes).ok()?;
        if !judge.keeps_limits(self.index, &mission) {
            return None;
        }
        judge.execute(self.index, &mission)
    }

    /// The plan of a variant.
    pub(super) fn plan(&self, variant: usize) -> VehiclePlan {
        let own = &self.all[variant];
        let mut shape = own.shape.clone();
        shape.depart_s += own.later_s;
        self.shapers[own.speed].plan(&shape, own.terms)
    }
}

/// A specified number, and others of a span around it, evenly apart.
fn choices(specified: f64, span: Option<Span>, count: u32) -> Vec<f64> {
    let mut all = vec![specified];
    if let Some(span) = span {
        let step = (span.most - span.least) / f64::from(count);
        let steps = (0..=count).map(|number| span.least + step * f64::from(number));
        // What a mission can say: decimetres a second, and tenths of a second.
        let rounded =
            steps.map(|value| ((value * 10.0).round() / 10.0).clamp(span.least, span.most));
        all.extend(rounded.filter(|value| (value - specified).abs() > 1e-9));
    }
    all
}
