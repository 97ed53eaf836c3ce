//! The fleet: each vehicle avoids the whole flights of those before it.
//!
//! **Meaning.** Vehicles are planned one after the other in the order of the spec. Each is
//! planned as if it were alone. If its whole flight keeps the separation from the flights
//! of all before it, with its margin and at every allowed shift, that plan stands.
//! Otherwise it is planned again around those it came too near to; if its new flight comes
//! too near to others, around these and all who are about as well, until it comes too near
//! to none it was not planned around. (What then is left is no fault of the search: takeoffs and landings
//! are not its to move, and some ways are simply closed.) So a search reads the few
//! flights that matter, not all. A vehicle to which the spec leaves another departure or speed
//! flies the way it would have alone at another time instead, if there is one at which it is
//! apart from all before it. If there is none, it is planned around others from a departure
//! at which they are not in the way of its takeoff and landing; and if that flight still meets
//! one of them, it is flown at another time, if there is one at which it does not. Vehicles at the head of the order are few enough to be
//! planned around all before them at once, which spares small fleets the second search;
//! so are all by the paper's objective, which has a collision term of its own.
//!
//! **Order.** A plan is a function of the spec, the world, the request, the vehicle and the
//! flights it is planned around, so it does not matter when and on which thread it is made.
//! [`plan_fleet`] makes the plans of many vehicles at once, against those that stand
//! already, and keeps what also holds against those that came to stand meanwhile. What
//! comes out is what [`plan_one_at_a_time`] gives, to the bit.

pub(super) mod columns;
pub(super) mod prioritised;
pub(super) mod retiming;
pub(super) mod vehicle;

use super::{FleetPlan, VehiclePlan};
use crate::cost::Margins;
use crate::numeric::tracks::Nearness;
use crate::path::{Flight, flight};
use crate::spec::MissionSpec;
use crate::world::World;
use prioritised::Fleet;

/// What to plan besides the spec.
pub struct Request<'a> {
    /// The seed every random stream comes from.
    pub seed: u64,
    /// Margins on the limits for each vehicle; none for vehicles that are not listed.
    pub margins: Vec<Margins>,
    /// Parameters in `[0, 1]` at which a vehicle's path is sampled besides the even
    /// ones, because verification failed there; none for vehicles that are not listed.
    pub extra_parameters: Vec<Vec<f64>>,
    /// Told while the search goes on, from several threads at once.
    pub progress: &'a (dyn Fn(Progress) + Sync),
}

impl Request<'_> {
    /// Margins of one vehicle.
    pub(super) fn margins_of(&self, index: usize) -> Margins {
        self.margins.get(index).copied().unwrap_or_default()
    }

    /// Parameters at which one vehicle's path is sampled besides.
    pub(super) fn extra_parameters_of(&self, index: usize) -> &[f64] {
        self.extra_parameters.get(index).map_or(&[], Vec::as_slice)
    }
}

/// How far planning has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Index of the vehicle that is being planned.
    pub vehicle: usize,
    /// Number of vehicles.
    pub vehicles: usize,
    /// Evaluations spent on it so far.
    pub evaluations: usize,
    /// Evaluations it may spend.
    pub budget: usize,
    /// Least cost of its route so far.
    pub best: f64,
}

/// Plans a fleet in the order of the spec; the module says what that means.
///
/// An infeasible vehicle is no error: its plan is the least bad one that was found, and
/// its terms say what is violated. Same spec, world and request, same plan, on any
/// number of threads.
#[must_use]
pub fn plan_fleet(spec: &MissionSpec, world: &World, request: &Request<'_>) -> FleetPlan {
    Fleet::new(spec, world, request, &[], Vec::new()).settle()
}

/// Plans the vehicles at the indices `again` anew, and those that `previous` has no plan
/// for. Of the others only those are planned again that a new flight comes too near to.
///
/// A vehicle that is planned anew is planned around those it was planned around before,
/// and others as need be.
#[must_use]
pub fn replan(
    previous: &FleetPlan,
    again: &[usize],
    spec: &MissionSpec,
    world: &World,
    request: &Request<'_>,
) -> FleetPlan {
    Fleet::new(spec, world, request, again, previous.vehicles.clone()).settle()
}

/// Plans the vehicle at index `first` and all after it as if they had no plan; those
/// before it keep their paths of `previous`.
#[must_use]
pub fn replan_from(
    previous: &FleetPlan,
    first: usize,
    spec: &MissionSpec,
    world: &World,
    request: &Request<'_>,
) -> FleetPlan {
    let kept = previous.vehicles.iter().take(first).cloned().collect();
    Fleet::new(spec, world, request, &[], kept).settle()
}

/// What [`plan_fleet`] means, without any speculation: one vehicle after the other.
#[must_use]
pub fn plan_one_at_a_time(spec: &MissionSpec, world: &World, request: &Request<'_>) -> FleetPlan {
    let mut fleet = Fleet::new(spec, world, request, &[], Vec::new());
    for index in 0..spec.vehicles.len() {
        let mut chain = Vec::new();
        fleet.advance(index, &mut chain);
        fleet.accept(chain);
    }
    fleet.plan()
}

impl FleetPlan {
    /// The whole flight of every vehicle, takeoff to touchdown.
    #[must_use]
    pub fn flights(&self, spec: &MissionSpec, world: &World) -> Vec<Flight> {
        (0..spec.vehicles.len().min(self.vehicles.len()))
            .map(|index| flight_of(spec, world, index, &self.vehicles[index]))
            .collect()
    }
}

/// The whole flight of a planned vehicle.
pub(super) fn flight_of(
    spec: &MissionSpec,
    world: &World,
    index: usize,
    plan: &VehiclePlan,
) -> Flight {
    let mut vehicle = spec.vehicles[index].clone();
    plan.settle(&mut vehicle);
    flight(&vehicle, &world.stations[index], &plan.points())
}

/// When a flight is too near to an earlier one, as the objective sees it too.
pub(super) fn nearness(spec: &MissionSpec, margins: Margins) -> Nearness {
    let separation = margins.beyond(&spec.separation);
    Nearness {
        distance_m: separation.distance_m,
        vertical_m: separation.vertical_m,
        slack_s: separation.time_slack_s,
    }
}
