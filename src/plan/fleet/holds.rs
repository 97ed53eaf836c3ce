//! Copters that hold in the air on their own ways until others have passed.
//!
//! Time is no term of the objective, so that a hold costs less than any way around. Each vehicle keeps the way that it
//! would fly alone. In several orders of priority the vehicles take one after the other the shortest hold that keeps
//! them apart from those before; the order with the least time of holding wins.

use std::collections::BTreeSet;

use rand::seq::SliceRandom;
use rayon::prelude::*;

use super::vehicle::path_basis;
use super::{Planning, Request, flight_of, paid_for_others};
use crate::cost::{EarlierFlights, Margins, RouteEnds};
use crate::geodesy::PlanPoint;
use crate::numeric::approach::Segment;
use crate::numeric::tracks::{Track, Tracks};
use crate::numeric::{Seed, as_f64};
use crate::path::route_ends;
use crate::plan::spline::Spline;
use crate::plan::{FleetPlan, VehiclePlan};
use crate::spec::{Arrival, MissionSpec, Stop, new_stop_ids};
use crate::world::World;

/// A way around others counts as dear above this multiple of the cost of the ways alone. What a spec leaves open must
/// not make a fleet dearer: there every hold counts.
const DEAR: f64 = 1.01;
const DEAR_WITH_FREEDOMS: f64 = 1.0001;
/// Elsewhere holds must save this share of the distance that their vehicles would fly meanwhile: half a minute in the air
/// for some metres is no gain.
const SAVED: f64 = 0.1;
/// Points evenly along a route at which a copter may hold.
const EVEN: usize = 8;
/// Points near its start besides, before it comes near to others, each further away by a factor.
const NEAR_START: usize = 6;
const FURTHER: f64 = 1.5;
/// Fewest and most spans of a route, which can only be split between two of them.
const SPANS: usize = 24;
const MAX_SPANS: usize = 192;
/// Nearest to the ends of its route, metres.
const FROM_END_M: f64 = 20.0;
/// Longest span of a route that has fewer than [`MAX_SPANS`], metres.
const SPAN_M: f64 = 0.25 * FROM_END_M;
/// Holds that are tried, seconds: from the first number to the second in steps of the third.
const HOLDS_S: [(u16, u16, usize); 3] = [(5, 60, 5), (65, 180, 10), (185, 600, 30)];
/// The shortest of them.
const FIRST_S: f64 = 5.0;
/// Orders of priority that are tried.
const ORDERS: usize = 48;
/// What times differ by in rounding, seconds.
const ROUNDING_S: f64 = 1e-6;

/// A fleet with holds: the spec and the world have them as stops.
pub(crate) struct Held {
    pub(crate) spec: MissionSpec,
    pub(crate) world: World,
    pub(crate) plan: FleetPlan,
    /// What its holds must save at least, in units of cost.
    pub(crate) price: f64,
}

/// A hold on the way that a vehicle would fly alone.
#[derive(Clone, Debug)]
struct Hold {
    /// Number of the route.
    route: usize,
    at: PlanPoint,
    /// The parts of the route before and after it.
    parts: [Spline; 2],
    /// Whole seconds.
    hold_s: f64,
}

/// A point at which a copter may hold on its way, and the flight before and after.
struct HoldPoint {
    hold: Hold,
    arrives_s: f64,
    before: Track,
    /// After a hold of [`FIRST_S`].
    after: Track,
}

impl HoldPoint {
    /// Where the vehicle is while it holds for a time, seconds.
    fn holding(&self, hold_s: f64) -> Track {
        Track::new(vec![Segment {
            t0_s: self.arrives_s,
            t1_s: self.arrives_s + hold_s,
            from_m: self.hold.at.axes_m(),
            velocity_mps: [0.0; 3],
        }])
    }
}

/// A vehicle on the way that it would fly alone.
struct Alone {
    plan: VehiclePlan,
    track: Track,
    hold_points: Vec<HoldPoint>,
}

/// A fleet on the ways that its vehicles would fly alone, and where they may hold.
pub(crate) struct AloneWithHolds<'a> {
    of: (&'a MissionSpec, &'a World),
    seed: u64,
    fleet: Vec<Alone>,
    /// Share of the way flown during a hold that it must save.
    saved: f64,
}

impl<'a> AloneWithHolds<'a> {
    /// Of a fleet with a plan in which vehicles pay for each other, or are too near where it `fails`. None where the
    /// ways alone are hardly cheaper.
    pub(crate) fn new(
        (spec, world): (&'a MissionSpec, &'a World),
        (plan, fails): (&FleetPlan, bool),
        request: &Request<'_>,
    ) -> Option<Self> {
        let mut fleet = spec.vehicles.iter();
        let is_open = spec.separation.vertical_m.is_some()
            || fleet.any(|vehicle| vehicle.retiming.is_allowed());
        let dear = if is_open { DEAR_WITH_FREEDOMS } else { DEAR };
        // Half of it, as few evaluations may find ways alone that are a little dearer; with freedoms even less counts.
        let worth = 0.5 * (dear - 1.0) * plan.cost();
        let pays = || {
            plan.cost() >= dear * plan.bound()
                && (is_open || paid_for_others(plan, (spec, world), request) >= worth)
        };
        if !fails && !pays() {
            return None;
        }
        let planning = Planning::new(spec, world, request);
        let known = plan.vehicles.par_iter().enumerate();
        let alone: Vec<VehiclePlan> = known
            .map(|(index, plan)| planning.plan_alone(index, plan.estimate))
            .collect();
        let cost: f64 = alone.iter().map(|plan| plan.terms.total()).sum();
        let are_clean = alone.iter().all(|plan| plan.terms.is_clean());
        if !are_clean || !fails && plan.cost() < dear * cost {
            return None;
        }
        let fleet = alone.into_iter().enumerate();
        Some(Self {
            of: (spec, world),
            seed: plan.seed,
            saved: if is_open { 0.0 } else { SAVED },
            fleet: fleet
                .map(|(index, plan)| planning.with_hold_points(index, plan))
                .collect(),
        })
    }

    /// The fleet with the holds that keep its vehicles apart, with the margins of each; none where no holds do.
    pub(crate) fn held(&self, margins: &[Margins]) -> Option<Held> {
        let request = Request {
            margins: margins.to_vec(),
            ..Request::new(self.seed)
        };
        let planning = Planning::new(self.of.0, self.of.1, &request);
        let orders = orders(&self.fleet, self.seed);
        let found = orders.par_iter().filter_map(|order| {
            let holds = in_order(order, &self.fleet, &planning)?;
            let held_s: f64 = holds.iter().flatten().map(|hold| hold.hold_s).sum();
            Some((held_s, holds))
        });
        let found: Vec<(f64, Vec<Option<Hold>>)> = found.collect();
        let (_, holds) = found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let fleet = self.fleet.iter().zip(&holds);
        let held_m = fleet.filter_map(|(alone, hold)| {
            let hold = hold.as_ref()?;
            Some(hold.hold_s * alone.plan.speed_mps)
        });
        let held_km = held_m.sum::<f64>() / 1000.0;
        let price = self.saved * held_km * self.of.0.planner.weights.length;
        let (mut spec, mut world) = (self.of.0.clone(), self.of.1.clone());
        let held = self.fleet.iter().zip(&holds).enumerate();
        let held = held.map(|(index, (alone, hold))| match hold {
            Some(hold) => {
                hold.add_to(index, &mut spec, &mut world);
                planning.held(index, &alone.plan, hold).2
            }
            None => alone.plan.clone(),
        });
        let vehicles = held.collect();
        let seed = self.seed;
        let plan = FleetPlan { seed, vehicles };
        Some(Held {
            spec,
            world,
            plan,
            price,
        })
    }
}

/// Orders of priority: those of the spec and of the time of the flights first.
fn orders(fleet: &[Alone], seed: u64) -> Vec<Vec<usize>> {
    let given: Vec<usize> = (0..fleet.len()).collect();
    let mut by_time = given.clone();
    let duration_s = |index: usize| fleet[index].plan.duration_s();
    by_time.sort_by(|&a, &b| duration_s(a).total_cmp(&duration_s(b)));
    let reversed = |order: &[usize]| order.iter().rev().copied().collect::<Vec<_>>();
    let mut all = vec![given.clone(), reversed(&given), reversed(&by_time), by_time];
    let mut rng = Seed(seed).stream("holds", 0);
    while all.len() < ORDERS {
        let mut order = given.clone();
        order.shuffle(&mut rng);
        all.push(order);
    }
    all
}

/// The shortest hold of each vehicle that keeps it apart from those before it in an order, if it needs one; none where a
/// vehicle finds none.
fn in_order(
    order: &[usize],
    fleet: &[Alone],
    planning: &Planning<'_>,
) -> Option<Vec<Option<Hold>>> {
    let mut chosen = vec![None; order.len()];
    let mut tracks = Tracks::new(&planning.nearness(0));
    for &index in order {
        let own = &fleet[index];
        let nearness = planning.nearness(index);
        let is_free = |track: &Track, later_s: f64| {
            !tracks.is_any_near((track, later_s), &nearness, |_| true)
        };
        if is_free(&own.track, 0.0) {
            tracks.extend([own.track.clone()]);
            continue;
        }
        let points: Vec<&HoldPoint> = (own.hold_points.iter())
            .filter(|point| is_free(&point.before, 0.0))
            .collect();
        let mut holds =
            holds_s().flat_map(|hold_s| points.iter().map(move |point| (*point, hold_s)));
        let (point, hold_s) = holds.find(|(point, hold_s)| {
            is_free(&point.after, hold_s - FIRST_S) && is_free(&point.holding(*hold_s), 0.0)
        })?;
        let hold = Hold {
            hold_s,
            ..point.hold.clone()
        };
        let (spec, world, plan) = planning.held(index, &own.plan, &hold);
        tracks.extend([flight_of(&spec, &world, index, &plan).track()]);
        chosen[index] = Some(hold);
    }
    Some(chosen)
}

impl Planning<'_> {
    /// A way alone with the points at which the vehicle may hold on it.
    fn with_hold_points(&self, index: usize, plan: VehiclePlan) -> Alone {
        let points = self.holds(index, &plan).into_par_iter();
        let points = points.filter_map(|hold| {
            let (spec, world, held) = self.held(index, &plan, &hold);
            let arrives_s = held.routes.get(hold.route)?.end_s();
            let leaves_s = arrives_s + FIRST_S;
            let flight = flight_of(&spec, &world, index, &held);
            let track = flight.track();
            let is_before = |segment: &&Segment| segment.t1_s <= arrives_s + ROUNDING_S;
            let is_after = |segment: &&Segment| segment.t0_s >= leaves_s - ROUNDING_S;
            let before = track.segments().iter().filter(is_before).copied();
            let after = track.segments().iter().filter(is_after).copied();
            Some(HoldPoint {
                hold,
                arrives_s,
                before: Track::new(before.collect()),
                after: Track::new(after.collect()).standing_at(flight.ends()),
            })
        });
        Alone {
            track: self.flight(index, &plan).track(),
            hold_points: points.collect(),
            plan,
        }
    }

    /// The points at which a vehicle may hold, each with the shortest hold.
    fn holds(&self, index: usize, alone: &VehiclePlan) -> Vec<Hold> {
        let vehicle = &self.spec.vehicles[index];
        if vehicle.airframe.has_wing() {
            return Vec::new();
        }
        let arrivals = vehicle.arrivals(alone.routes.len());
        let mut holds = Vec::new();
        // Those up to the goal: on the way home from there nothing is a stop.
        let routes = alone.routes.iter().zip(arrivals).enumerate();
        for (route, (flown, arrival)) in routes.take(vehicle.stops.len() + 1) {
            if arrival != Arrival::Planned || flown.control_points.len() < 4 {
                continue;
            }
            let length_m = flown.length_m();
            let mut spline = Spline::through(&flown.control_points);
            while spline.spans() < SPANS
                || spline.spans() < MAX_SPANS && length_m > SPAN_M * as_f64(spline.spans())
            {
                spline = spline.halved();
            }
            let parts = hold_points(&spline).into_iter();
            holds.extend(parts.map(|(at, parts)| Hold {
                route,
                at,
                parts,
                hold_s: FIRST_S,
            }));
        }
        holds
    }

    /// The plan of a vehicle with a hold on its way, and the spec and world that have it. It costs what the way alone
    /// does: the parts are the same curve.
    fn held(
        &self,
        index: usize,
        alone: &VehiclePlan,
        hold: &Hold,
    ) -> (MissionSpec, World, VehiclePlan) {
        let (mut spec, mut world) = (self.spec.clone(), self.world.clone());
        hold.add_to(index, &mut spec, &mut world);
        let planning = Planning {
            spec: &spec,
            world: &world,
            ..*self
        };
        let mut shape = alone.shape().control_points;
        let parts = hold.parts.iter().map(Spline::points);
        shape.splice(hold.route..=hold.route, parts);
        let ends = route_ends(&spec.vehicles[index], &world.sites[index]);
        let bases = ends.iter().zip(&shape).map(|(&(from, to), points)| {
            let start_s = 0.0;
            let ends = RouteEnds { from, to, start_s };
            let context = planning.route_context(index, ends, EarlierFlights::none());
            path_basis(&context, points.len())
        });
        let bases: Vec<_> = bases.collect();
        let plan = VehiclePlan {
            routes: planning.routes_of(index, &shape, &bases),
            ..alone.clone()
        };
        (spec, world, plan)
    }
}

impl Hold {
    /// Makes it a stop of a vehicle.
    fn add_to(&self, index: usize, spec: &mut MissionSpec, world: &mut World) {
        let stops = &mut spec.vehicles[index].stops;
        let id = new_stop_ids(stops, "hold").next().unwrap_or_default();
        let stop = Stop {
            hold_s: self.hold_s,
            ..Stop::passing(&id, world.end_point(self.at))
        };
        stops.insert(self.route, stop);
        world.sites[index].stops.insert(self.route, self.at);
    }
}

/// Points at which a copter may hold on a route, and the parts before and after each.
fn hold_points(spline: &Spline) -> Vec<(PlanPoint, [Spline; 2])> {
    let points = spline.points();
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
        return Vec::new();
    };
    let splits = (0..spline.spans() - 1).map(|span| spline.split(span));
    let splits = splits.filter_map(|parts| Some((parts[0].points().pop()?, parts)));
    let is_inside = |at: PlanPoint| at.distance_m(first).min(at.distance_m(last)) >= FROM_END_M;
    let inside: Vec<(PlanPoint, [Spline; 2])> = splits.filter(|(at, _)| is_inside(*at)).collect();
    let Some(end) = inside.len().checked_sub(1) else {
        return Vec::new();
    };
    let even = (0..EVEN).map(|number| number * end / (EVEN - 1));
    let distances_m = std::iter::successors(Some(FROM_END_M), |m| Some(FURTHER * m));
    let near_start = distances_m.take(NEAR_START).filter_map(|away_m| {
        let mut inside = inside.iter();
        inside.position(|(at, _)| at.distance_m(first) >= away_m)
    });
    let chosen: BTreeSet<usize> = even.chain(near_start).collect();
    let numbered = inside.into_iter().enumerate();
    let chosen = numbered.filter(|(number, _)| chosen.contains(number));
    chosen.map(|(_, found)| found).collect()
}

/// Times of holds to try, seconds.
fn holds_s() -> impl Iterator<Item = f64> {
    let steps = HOLDS_S.into_iter();
    steps.flat_map(|(from, until, step)| (from..=until).step_by(step).map(f64::from))
}
