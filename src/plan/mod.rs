//! Prioritised planning: paths for a fleet, one vehicle after the other in order of priority.
//!
//! `fleet` commits vehicles in order; `classes` finds homotopy classes; `search` searches one
//! route; `bound` proves what no path can cost less than; `diagnosis` says why there is no path.
//!
//! Altitude of a fixed horizontal spline: `altitude/floor.rs` makes the floor (ground, zones, slopes), a linear
//! program in `altitude` finds the lowest spline over it, `search/polish.rs` the one of least cost, and
//! `mission/build/encode.rs` rounds up what is written.

mod altitude;
mod bound;
mod classes;
mod diagnosis;
mod fleet;
mod memo;
mod route_context;
mod search;
mod search_options;
mod spline;

pub use crate::plan::diagnosis::blocking_set::{BlockingElement, BlockingSets};
pub use crate::plan::diagnosis::relaxations::{Change, Relaxation};
pub use crate::plan::diagnosis::violations::{Violation, violations};
pub use bound::{CertifyBudget, RouteBound, RouteCertificate};
pub use fleet::columns::ColumnConflict;
pub(crate) use fleet::holds::AloneWithHolds;
pub(crate) use fleet::paid_for_others;
pub use fleet::pairs::{min_lengths_m, route_bounds, route_costs};
pub(crate) use fleet::rests::rests_of;
pub use fleet::shapes::{Shape, Shaper};
pub use fleet::{
    Progress, Request, certify, plan_each_alone, plan_fleet, plan_fleet_with, plan_from,
    plan_one_at_a_time, replan, replan_from, replan_in_place,
};
pub use search::KnownSearches;
pub use search::objective::{objective, objective_specs};
pub use search_options::SearchOptions;

use crate::cost::CostTerms;
use crate::geodesy::PlanPoint;
use crate::path::TimedPoint;
use crate::spec::{MissionSpec, Vehicle};

/// The paths of a fleet, in the order of the spec.
#[derive(Clone, Debug, PartialEq)]
pub struct FleetPlan {
    /// The seed every stream came from.
    pub seed: u64,
    /// One plan for each vehicle.
    pub vehicles: Vec<VehiclePlan>,
}

/// The path of one vehicle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VehiclePlan {
    /// Indices of the stops of the spec in the order in which they are visited; empty where the spec
    /// gives the order.
    pub order: Vec<usize>,
    /// Takeoff, seconds after T0: the specified time, or another one of its window.
    pub depart_s: f64,
    /// Speed, m/s: the specified one, or another one of its range.
    pub speed_mps: f64,
    /// From start over the stops to the goal, and with [`crate::spec::Finish::Return`] to over
    /// home: between [`crate::path::route_ends`].
    pub routes: Vec<Route>,
    /// The objective, judged finely, summed over the routes.
    pub terms: CostTerms,
    /// Proven: no path that keeps the limits costs less.
    pub bound: f64,
    /// Estimate of the best cost from the cost field; proves nothing.
    pub estimate: f64,
    /// Objective evaluations spent, on all plans that were made for it.
    pub evaluations: usize,
    /// How often it was planned: more than once where the first plan came too near to
    /// others, or failed verification.
    pub plans: usize,
    /// Indices of the vehicles that it is planned around, in order; from the flights of all others
    /// it is apart. They are before it, unless it is of a large fleet and was planned again.
    pub avoids: Vec<usize>,
    /// Whether its paths were searched around others, and not as if it were alone.
    pub is_detour: bool,
    /// Indices of the earlier vehicles that leave it no path within the limits; set by
    /// [`FleetPlan::name_blockers`].
    pub blocked_by: Vec<usize>,
    /// Blocking set, proven and set by [`FleetPlan::name_the_cut_off`]: the obstacles that close every path of one of
    /// its routes, in a row around an end of it. Empty without a proof.
    pub blocking_set: Vec<BlockingElement>,
    /// Relaxations with which it has a path. `None` if they were not tried, because one of the
    /// above is the reason.
    pub relaxations: Option<Vec<Relaxation>>,
    /// Another departure, seconds after T0: with all of these the fleet, which has no plan that passes,
    /// was found to have one.
    pub passes_departing_s: Option<f64>,
}

/// One planned spline.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// Control points of the clamped cubic B-spline, ends included.
    pub control_points: Vec<PlanPoint>,
    /// Points along it, times after T0, first and last exactly the ends.
    pub path: Vec<TimedPoint>,
}

impl Route {
    /// When its path ends, seconds after T0.
    pub(crate) fn end_s(&self) -> f64 {
        self.path.last().map_or(0.0, |last| last.t_s)
    }

    /// Length in three dimensions, metres.
    pub(crate) fn length_m(&self) -> f64 {
        let pieces = self.path.windows(2);
        pieces
            .map(|pair| pair[0].point.distance_m(pair[1].point))
            .sum()
    }

    /// The points of its path.
    #[must_use]
    pub fn points(&self) -> Vec<PlanPoint> {
        self.path.iter().map(|timed| timed.point).collect()
    }
}

impl FleetPlan {
    /// Sum of the vehicles' costs.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.vehicles.iter().map(|plan| plan.terms.total()).sum()
    }

    /// Proven: no plans that keep the limits cost less together, because none of them costs less
    /// than its own bound.
    #[must_use]
    pub fn bound(&self) -> f64 {
        self.vehicles.iter().map(|plan| plan.bound).sum()
    }

    /// How far the cost is above the bound, as a fraction of the bound; none where a plan breaks
    /// limits.
    #[must_use]
    pub fn gap(&self) -> Option<f64> {
        let bound = self.bound();
        let is_bounded = bound > 0.0 && self.vehicles.iter().all(|plan| plan.gap().is_some());
        is_bounded.then(|| (self.cost() - bound) / bound)
    }

    /// The spec with the departures, speeds and orders that were chosen. Missions are made from it, and
    /// judged against the spec itself.
    #[must_use]
    pub fn retimed(&self, spec: &MissionSpec) -> MissionSpec {
        let mut retimed = spec.clone();
        for (vehicle, plan) in retimed.vehicles.iter_mut().zip(&self.vehicles) {
            plan.apply_to(vehicle);
        }
        retimed
    }
}

impl VehiclePlan {
    /// Indices of the earlier vehicles that it conflicts with at the specified departure and
    /// speed, if others were chosen, or that it is then planned around.
    #[must_use]
    pub fn gives_way_to(&self, specified: &Vehicle) -> &[usize] {
        let as_specified = [
            (self.depart_s, specified.depart_s),
            (self.speed_mps, specified.speed_mps),
        ];
        if as_specified
            .iter()
            .all(|(is, was)| is.to_bits() == was.to_bits())
        {
            &[]
        } else {
            &self.avoids
        }
    }

    /// Whether both fly the same paths at the same times.
    pub(crate) fn flies_as(&self, other: &Self) -> bool {
        let times = |plan: &Self| [plan.depart_s, plan.speed_mps].map(f64::to_bits);
        times(self) == times(other) && self.order == other.order && self.routes == other.routes
    }

    /// Sets the order of stops, the departure and the speed that were chosen.
    pub(crate) fn apply_to(&self, vehicle: &mut Vehicle) {
        vehicle.visit_in(&self.order);
        (vehicle.depart_s, vehicle.speed_mps) = (self.depart_s, self.speed_mps);
    }

    /// How far the total is above the bound, as a fraction of the bound; none for a plan that
    /// breaks limits, which the bound does not hold for.
    #[must_use]
    pub fn gap(&self) -> Option<f64> {
        let is_bounded = self.bound > 0.0 && self.terms.is_clean();
        is_bounded.then(|| (self.terms.total() - self.bound) / self.bound)
    }

    /// Sets the bound; the estimate is never below it.
    pub(crate) fn set_bound(&mut self, bound: f64) {
        self.bound = bound;
        self.estimate = self.estimate.max(bound);
    }
}

impl VehiclePlan {
    /// The points of each route.
    #[must_use]
    pub fn points(&self) -> Vec<Vec<PlanPoint>> {
        self.routes.iter().map(Route::points).collect()
    }

    /// Length of all routes in three dimensions, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.routes.iter().map(Route::length_m).sum()
    }

    /// All routes in one, in order of time.
    #[must_use]
    pub fn path(&self) -> Vec<TimedPoint> {
        self.routes
            .iter()
            .flat_map(|route| route.path.iter().copied())
            .collect()
    }

    /// From the beginning of the first route to the end of the last, seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        let first = self.routes.first().and_then(|route| route.path.first());
        let last = self.routes.last().and_then(|route| route.path.last());
        first
            .zip(last)
            .map_or(0.0, |(first, last)| last.t_s - first.t_s)
    }
}
