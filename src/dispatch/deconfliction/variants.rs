//! What one vehicle may fly, each as its encoded mission is flown.

use std::borrow::Cow;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::cost::CostTerms;
use crate::mission::{self, VehicleMission};
use crate::path::{TimedPoint, heading_rad};
use crate::plan::{Shape, Shaper, VehiclePlan};
use crate::spec::{MissionSpec, Span, Vehicle};
use crate::verify::{Executed, Judge};
use crate::world::World;

use super::moves::{Ruled, between, blend, delayed, even, nudged, random, ruled, shapes};

/// Departures of a window that are tried with the path alone.
const DEPARTURES: u32 = 30;
/// Speeds of a range that are tried, besides the specified one.
const SPEEDS: u32 = 4;

/// Share of the cost that control points evenly apart may add.
const EVENLY: f64 = 1e-3;
/// How far variants near to another are bent, in separations.
const NUDGES: [f64; 4] = [1.0, 0.4, 0.15, 0.05];

/// A path, a speed and a departure.
pub(in crate::dispatch) struct Variant {
    shape: Shape,
    terms: CostTerms,
    /// Which of the speeds.
    speed: usize,
    pub(super) later_s: f64,
    pub(in crate::dispatch) cost: f64,
}

/// A variant as it is encoded, and as that is flown.
pub(in crate::dispatch) struct Flight<'a> {
    pub(in crate::dispatch) mission: VehicleMission,
    pub(in crate::dispatch) executed: Executed<'a>,
}

/// What one vehicle may fly.
pub(in crate::dispatch) struct Variants<'a> {
    index: usize,
    shapers: Vec<Shaper<'a>>,
    /// Departures that are tried, after the specified one.
    later_s: Vec<f64>,
    /// The first is the path alone as specified.
    pub(in crate::dispatch) all: Vec<Variant>,
}

impl<'a> Variants<'a> {
    /// Around the path of a vehicle alone, at the departures and speeds that the spec leaves open.
    /// None where paths have no shapes that could be moved. With its control points evenly apart
    /// a path bends alike everywhere, and like those of others.
    pub(in crate::dispatch) fn new(
        (spec, world): (&'a MissionSpec, &'a World),
        index: usize,
        alone: &VehiclePlan,
        evenly: bool,
    ) -> Option<Self> {
        let vehicle = spec.vehicles.get(index)?;
        let speeds = choices(vehicle.speed_mps, vehicle.retiming.speed_mps, SPEEDS);
        let shapers: Option<Vec<Shaper<'a>>> = speeds
            .iter()
            .map(|&speed_mps| Shaper::new(spec, world, index, alone, speed_mps))
            .collect();
        let times = choices(vehicle.depart_s, vehicle.retiming.depart_s, DEPARTURES);
        let mut found = Self {
            index,
            shapers: shapers?,
            later_s: times.iter().map(|at_s| at_s - vehicle.depart_s).collect(),
            all: Vec::new(),
        };
        let shape = Shape {
            depart_s: vehicle.depart_s,
            ..if evenly { even(alone)? } else { alone.shape() }
        };
        let terms = found.shapers[0].terms(std::slice::from_ref(&shape));
        let is_good = |terms: &CostTerms| {
            terms.is_clean() && terms.total() <= (1.0 + EVENLY) * alone.terms.total()
        };
        if evenly && !terms.iter().all(is_good) {
            return None;
        }
        found.add(shapes(&shape, &spec.buffered_separation()), 0, &[0.0]);
        let others = found.later_s[1..].to_vec();
        found.add(vec![shape.clone()], 0, &others);
        for speed in 1..speeds.len() {
            found.add(vec![shape.clone()], speed, &[0.0]);
        }
        (!found.all.is_empty()).then_some(found)
    }

    /// All of them, the cheapest first, and of equals that which departs the nearest to the
    /// specified time.
    pub(in crate::dispatch) fn cheapest_first(&self) -> Vec<usize> {
        let all = &self.all;
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by(|&a, &b| {
            let by_cost = all[a].cost.total_cmp(&all[b].cost);
            by_cost.then(all[a].later_s.abs().total_cmp(&all[b].later_s.abs()))
        });
        order
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

    /// Adds shapes around the first at random, each at one of the departures and speeds.
    pub(in crate::dispatch) fn add_random(&mut self, count: usize, rng: &mut ChaCha8Rng) {
        let Some(shape) = self.all.first().map(|first| first.shape.clone()) else {
            return;
        };
        let separation = self.shapers[0].spec().buffered_separation();
        for _ in 0..count {
            let shape = random(&shape, &separation, rng);
            let mut one_of = |count: usize| match count {
                1 => 0,
                _ => rng.random_range(0..count),
            };
            let speed = one_of(self.shapers.len());
            let later_s = self.later_s[one_of(self.later_s.len())];
            self.add(vec![shape], speed, &[later_s]);
        }
    }

    /// Adds shapes around the first that are later from some part of them on.
    pub(super) fn add_delayed(&mut self) {
        let Some(first) = self.all.first() else {
            return;
        };
        let separation = self.shapers[0].spec().buffered_separation();
        self.add(delayed(&first.shape, &separation), 0, &[first.later_s]);
    }

    /// Adds variants near to one, at random: bent a little, or drawn towards the first, and where
    /// the spec leaves it open sometimes at another departure or speed.
    pub(in crate::dispatch) fn add_near(
        &mut self,
        variant: usize,
        count: usize,
        rng: &mut ChaCha8Rng,
    ) {
        let separation = self.shapers[0].spec().buffered_separation();
        for _ in 0..count {
            let (own, first) = (&self.all[variant], &self.all[0]);
            let shape = if rng.random_bool(0.5) {
                let most = NUDGES[rng.random_range(0..NUDGES.len())];
                nudged(&own.shape, &separation, most, rng)
            } else {
                blend(
                    &own.shape,
                    &first.shape,
                    rng.random_range(0.0..1.0_f64).powi(2),
                )
            };
            let (mut speed, mut later_s) = (own.speed, own.later_s);
            if self.shapers.len() > 1 && rng.random_bool(0.3) {
                speed = rng.random_range(0..self.shapers.len());
            }
            if self.later_s.len() > 1 && rng.random_bool(0.5) {
                later_s = self.later_s[rng.random_range(0..self.later_s.len())];
            }
            self.add(vec![shape], speed, &[later_s]);
        }
    }

    /// Adds the variant that is nearer to the first by a share.
    pub(super) fn add_drawn(&mut self, variant: usize, share: f64) -> Option<usize> {
        let (own, first) = (&self.all[variant], &self.all[0]);
        let shape = blend(&own.shape, &first.shape, share);
        let (speed, later_s, known) = (own.speed, own.later_s, self.all.len());
        self.add(vec![shape], speed, &[later_s]);
        (self.all.len() > known).then_some(known)
    }

    /// Adds the variant that a rule for all makes of the first.
    pub(super) fn add_ruled(&mut self, rule: Ruled) -> Option<usize> {
        let first = self.all.first()?;
        let vehicle = self.vehicle();
        let later_s = match (rule.window, vehicle.retiming.depart_s) {
            (Some(share), Some(window)) => {
                let at_s = window.least + share * (window.most - window.least);
                (at_s * 10.0).round() / 10.0 - vehicle.depart_s
            }
            _ => first.later_s,
        };
        let separation = self.shapers[0].spec().buffered_separation();
        let shape = ruled(&first.shape, &separation, rule);
        let known = self.all.len();
        self.add(vec![shape], 0, &[later_s]);
        (self.all.len() > known).then_some(known)
    }

    fn vehicle(&self) -> &Vehicle {
        &self.shapers[0].spec().vehicles[self.index]
    }

    pub(super) fn has_wing(&self) -> bool {
        self.vehicle().airframe.has_wing()
    }

    pub(super) fn can_wait(&self) -> bool {
        self.vehicle().retiming.depart_s.is_some()
    }

    /// The direction from the beginning of the path to its end.
    pub(super) fn direction_rad(&self) -> f64 {
        let shape = self.all.first().map(|first| &first.shape);
        let routes = shape.map_or(&[][..], |shape| &shape.control_points[..]);
        let first = routes.first().and_then(|route| route.first());
        let last = routes.last().and_then(|route| route.last());
        first
            .zip(last)
            .map_or(0.0, |(from, to)| heading_rad(from.at, to.at))
    }

    /// Adds shapes between that of a variant and the first.
    pub(super) fn add_between(&mut self, variant: usize) {
        let own = &self.all[variant];
        let (speed, later_s) = (own.speed, own.later_s);
        self.add(between(&own.shape, &self.all[0].shape), speed, &[later_s]);
    }

    /// The mission of a variant as it is encoded, and its flight, whether or not it keeps the
    /// limits of its vehicle; none if it cannot be encoded.
    pub(in crate::dispatch) fn flown(
        &self,
        judge: &Judge<'a>,
        world: &World,
        variant: usize,
    ) -> Option<Flight<'a>> {
        let plan = self.plan(variant);
        let mut spec = Cow::Borrowed(self.shapers[self.all[variant].speed].spec());
        if spec.vehicles[self.index].depart_s.to_bits() != plan.depart_s.to_bits() {
            // The items of another departure are others: they hold a delay.
            spec.to_mut().vehicles[self.index].depart_s = plan.depart_s;
        }
        let paths = plan.routes.into_iter().map(|route| route.path);
        let routes: Vec<Vec<TimedPoint>> = paths.collect();
        let mission = mission::build(&spec, world, self.index, &routes).ok()?;
        let executed = judge.fly(self.index, &mission)?;
        Some(Flight { mission, executed })
    }

    /// The plan of a variant.
    pub(in crate::dispatch) fn plan(&self, variant: usize) -> VehiclePlan {
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
