//! Prioritised planning: each vehicle avoids the whole flights of those before it.
//!
//! **Meaning.** Vehicles are planned one after the other in the order of the spec. Each is first
//! planned as if it were alone. A candidate is committed if its whole flight keeps the separation
//! from the flights of all before it, with its margin and at every allowed shift. Otherwise the
//! vehicle is planned again around those with a conflict. If the new flight conflicts with others,
//! it is planned around these as well, and around all that are near, until no conflict is left
//! with a vehicle that it was not planned around. (Conflicts that are left then are beyond the
//! search: takeoffs and landings are fixed, and some ways are closed.) So a search reads the few
//! flights that matter.
//!
//! A vehicle with retiming flies the path that it would fly alone at another time or speed, if
//! there is one without a conflict. If there is none, it is planned around others from a departure
//! at which its takeoff and landing are free, and that path may be retimed once more.
//!
//! In a large fleet a vehicle that failed verification gives way to all others as they stand: see
//! [`repair`].
//!
//! The first vehicles of the order are few enough to be planned around all before them at once,
//! which spares small fleets the second search. So are all vehicles under the paper's objective,
//! which has a collision term of its own.
//!
//! **Order.** A plan is a function of the spec, the world, the request, the vehicle and the
//! flights it is planned around, so it does not matter when and on which thread it is made.
//! [`plan_fleet`] makes candidates for many vehicles at once, against the committed flights, and
//! keeps those that also hold against later commits. The result is that of
//! [`plan_one_at_a_time`], to the bit.

pub(super) mod columns;
pub(super) mod holds;
pub(super) mod pairs;
pub(super) mod passing;
pub(super) mod prioritised;
pub(super) mod repair;
pub(super) mod rests;
pub(super) mod retiming;
pub(super) mod shapes;
pub(super) mod vehicle;

use std::sync::atomic::AtomicBool;

use rayon::prelude::*;

use super::bound::{self, CertifyBudget, RouteBound, proven};
use super::route_context::RouteContext;
use super::search::{KnownClasses, KnownSearches};
use super::search_options::SearchOptions;
use super::{FleetPlan, VehiclePlan};
use crate::cost::{EarlierFlights, Margins, RouteEnds};
use crate::numeric::tracks::{Nearness, clear_m};
use crate::path::{Among, Flight, flight_among, route_ends};
use crate::spec::{MissionSpec, Objective};
use crate::world::World;
use prioritised::Fleet;
use repair::repaired;

/// Most vehicles of a fleet that is planned again in priority order.
const MAX_IN_ORDER: usize = 100;

/// Evaluations of a search for what a vehicle would cost alone.
const ALONE: usize = 4000;

/// What to plan besides the spec.
pub struct Request<'a> {
    /// The seed every random stream comes from.
    pub seed: u64,
    /// Margins on the limits for each vehicle; none for vehicles that are not listed.
    pub margins: Vec<Margins>,
    /// Parameters in `[0, 1]` at which a vehicle's path is sampled besides the even
    /// ones, because verification failed there; none for vehicles that are not listed.
    pub extra_parameters: Vec<Vec<f64>>,
    /// Called while the search goes on, from several threads at once.
    pub progress: &'a (dyn Fn(Progress) + Sync),
    /// Once it is set, searches end at once, and the plans are of no use.
    pub cancel: Option<&'a AtomicBool>,
    /// What other plans of the same fleet have found, so that it is not searched again.
    pub known: Option<&'a KnownSearches>,
}

impl Request<'_> {
    /// Without margins.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self {
            seed,
            margins: Vec::new(),
            extra_parameters: Vec::new(),
            progress: &|_| (),
            cancel: None,
            known: None,
        }
    }

    /// Margins of one vehicle.
    pub(super) fn margins_of(&self, index: usize) -> Margins {
        self.margins.get(index).copied().unwrap_or_default()
    }

    /// Parameters at which one vehicle's path is sampled besides.
    pub(super) fn extra_parameters_of(&self, index: usize) -> &[f64] {
        self.extra_parameters.get(index).map_or(&[], Vec::as_slice)
    }
}

/// What all plans of a fleet are made from.
#[derive(Clone, Copy)]
pub(super) struct Planning<'a> {
    pub spec: &'a MissionSpec,
    pub world: &'a World,
    pub request: &'a Request<'a>,
    pub options: SearchOptions,
    /// Takeoff of the vehicle that is planned, seconds after T0; none for the specified one.
    pub depart_s: Option<f64>,
    /// What the plans of the vehicle that is planned share.
    pub classes: Option<&'a KnownClasses>,
}

impl<'a> Planning<'a> {
    /// With the default search.
    pub(super) fn new(spec: &'a MissionSpec, world: &'a World, request: &'a Request<'a>) -> Self {
        Self {
            spec,
            world,
            request,
            options: SearchOptions::default(),
            depart_s: None,
            classes: None,
        }
    }

    /// The same for one vehicle: among the zones that it has to keep out of.
    pub(super) fn of(&self, index: usize) -> Self {
        match self.world.own.get(index).and_then(Option::as_deref) {
            Some(own) => Self {
                spec: &own.spec,
                world: &own.world,
                ..*self
            },
            None => *self,
        }
    }

    /// The context of a route of one vehicle among `earlier` flights.
    fn route_context<'c>(
        &'c self,
        index: usize,
        ends: RouteEnds,
        earlier: &'c EarlierFlights,
    ) -> RouteContext<'c> {
        RouteContext {
            world: self.world,
            spec: self.spec,
            index,
            ends,
            earlier,
            margins: self.request.margins_of(index),
            extra: self.request.extra_parameters_of(index),
            options: self.options,
            at_edges: false,
            cancel: self.request.cancel,
        }
    }

    /// The whole flight of a planned vehicle.
    pub(super) fn flight(&self, index: usize, plan: &VehiclePlan) -> Flight {
        flight_of(self.spec, self.world, index, plan)
    }

    /// The separation of one vehicle, with its margins. Where others stand counts for one with retiming only: no path
    /// around them helps the others.
    pub(super) fn nearness(&self, index: usize) -> Nearness {
        let nearness = nearness(self.spec, self.request.margins_of(index));
        let clear_m = match self.spec.vehicles[index].retiming.is_allowed() {
            true => clear_m(nearness.distance_m),
            false => 0.0,
        };
        Nearness {
            clear_m,
            ..nearness
        }
    }
}

/// How far planning has come.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
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

/// Plans a fleet in the order of the spec, see the module.
///
/// An infeasible vehicle is no error: its plan is the least bad one that was found, and
/// its terms say what is violated. Same spec, world and request, same plan, on any
/// number of threads.
#[must_use]
pub fn plan_fleet(spec: &MissionSpec, world: &World, request: &Request<'_>) -> FleetPlan {
    plan_fleet_with(spec, world, request, SearchOptions::default())
}

/// [`plan_fleet`] with other steps of the search: for studies of what they are worth.
#[must_use]
pub fn plan_fleet_with(
    spec: &MissionSpec,
    world: &World,
    request: &Request<'_>,
    options: SearchOptions,
) -> FleetPlan {
    let planning = Planning {
        options,
        ..Planning::new(spec, world, request)
    };
    with_bounds(spec, world, || {
        Fleet::new(planning, &[], Vec::new()).plan_in_parallel()
    })
}

/// Plans every vehicle as if it were alone, all of its routes with the control points that are
/// searched, as their points are recombined.
#[must_use]
pub fn plan_each_alone(spec: &MissionSpec, world: &World, request: &Request<'_>) -> FleetPlan {
    let planning = Planning {
        options: SearchOptions {
            polishing: false,
            ..SearchOptions::default()
        },
        ..Planning::new(spec, world, request)
    };
    let fleet = (0..spec.vehicles.len()).into_par_iter();
    with_bounds(spec, world, || FleetPlan {
        seed: request.seed,
        vehicles: fleet
            .map(|index| {
                let planning = planning.of(index);
                planning.plan_vehicle(index, Vec::new(), EarlierFlights::none(), None)
            })
            .collect(),
    })
}

/// What the vehicles of a plan that fly around others cost more than each would cost alone, by a
/// search of a few evaluations; than its bound, where that finds no path.
#[must_use]
pub(crate) fn paid_for_others(
    plan: &FleetPlan,
    (spec, world): (&MissionSpec, &World),
    request: &Request<'_>,
) -> f64 {
    let planning = Planning::new(spec, world, request);
    let paid = |(index, plan): (usize, &VehiclePlan)| {
        if !plan.is_detour {
            return 0.0;
        }
        let own = planning.of(index);
        let mut spec = own.spec.clone();
        spec.planner.evaluations = spec.planner.evaluations.min(ALONE);
        let own = Planning { spec: &spec, ..own };
        let alone = own.plan_alone(index, 0.0).terms;
        let least = if alone.is_clean() {
            alone.total()
        } else {
            plan.bound
        };
        (plan.terms.total() - least).max(0.0)
    };
    let fleet = plan.vehicles.par_iter().enumerate();
    // In their order: a sum of floats depends on it.
    let paid: Vec<f64> = fleet.map(paid).collect();
    paid.into_iter().sum()
}

/// Plans the vehicles at the indices `again` anew, and those that `previous` has no plan
/// for. Of the others only those are planned again that a new flight comes too near to.
///
/// A vehicle that is planned anew is planned around those it was planned around before,
/// and others as need be. In a large fleet it first gives way to all others, so that nobody else
/// is planned again; a vehicle for which that fails pushes aside those after it.
#[must_use]
pub fn replan(
    previous: &FleetPlan,
    again: &[usize],
    spec: &MissionSpec,
    world: &World,
    request: &Request<'_>,
) -> FleetPlan {
    let is_whole = previous.vehicles.len() == spec.vehicles.len();
    let is_large = is_whole && spec.vehicles.len() > MAX_IN_ORDER;
    if is_large && spec.planner.objective != Objective::Paper {
        return replan_in_place(previous, again, spec, world, request);
    }
    let planning = Planning::new(spec, world, request);
    let plan = Fleet::new(planning, again, previous.vehicles.clone()).plan_in_parallel();
    with_bounds_of(previous, plan)
}

/// Plans the vehicles at the indices `again` of a whole plan anew around all others as they stand; a vehicle for
/// which that fails pushes aside those after it.
#[must_use]
pub fn replan_in_place(
    previous: &FleetPlan,
    again: &[usize],
    spec: &MissionSpec,
    world: &World,
    request: &Request<'_>,
) -> FleetPlan {
    let planning = Planning::new(spec, world, request);
    let plan = FleetPlan {
        seed: request.seed,
        vehicles: repaired(planning, &previous.vehicles, again),
    };
    with_bounds_of(previous, plan)
}

/// A plan with the bounds of an earlier one: neither margins nor other flights change them.
fn with_bounds_of(previous: &FleetPlan, mut plan: FleetPlan) -> FleetPlan {
    for (vehicle, previous) in plan.vehicles.iter_mut().zip(&previous.vehicles) {
        vehicle.set_bound(previous.bound);
    }
    plan
}

/// Plans all vehicles from the paths of an earlier plan, of this spec or of one that differs a
/// little. A path keeps its line in the plane, if the altitudes that are now required make it keep
/// every limit; the others are searched.
#[must_use]
pub fn plan_from(
    earlier: &FleetPlan,
    spec: &MissionSpec,
    world: &World,
    request: &Request<'_>,
) -> FleetPlan {
    let fleet = earlier.vehicles.iter().take(spec.vehicles.len());
    let previous = fleet.enumerate().map(|(index, plan)| VehiclePlan {
        avoids: (plan.avoids.iter().copied())
            .filter(|&other| other < index)
            .collect(),
        evaluations: 0,
        plans: 0,
        ..plan.clone()
    });
    let all: Vec<usize> = (0..spec.vehicles.len()).collect();
    let planning = Planning::new(spec, world, request);
    with_bounds(spec, world, || {
        Fleet::new(planning, &all, previous.collect()).plan_in_parallel()
    })
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
    let earlier = previous.vehicles.iter().take(first).cloned().collect();
    let planning = Planning::new(spec, world, request);
    with_bounds(spec, world, || {
        Fleet::new(planning, &[], earlier).plan_in_parallel()
    })
}

/// The definition of [`plan_fleet`], without speculation: one vehicle after the other.
#[must_use]
pub fn plan_one_at_a_time(spec: &MissionSpec, world: &World, request: &Request<'_>) -> FleetPlan {
    let mut fleet = Fleet::new(Planning::new(spec, world, request), &[], Vec::new());
    for index in 0..spec.vehicles.len() {
        let mut chain = Vec::new();
        fleet.advance(index, &mut chain);
        fleet.commit(chain);
    }
    with_bounds(spec, world, || fleet.plan())
}

/// What is proven of the routes of one vehicle, with certificates.
#[must_use]
pub fn certify(
    spec: &MissionSpec,
    world: &World,
    vehicle: usize,
    budget: &CertifyBudget<'_>,
) -> Vec<RouteBound> {
    let routes = route_ends(&spec.vehicles[vehicle], &world.sites[vehicle]);
    bound::certify((spec, world), vehicle, &routes, budget)
}

/// A plan, and at the same time the proven bound of each vehicle.
fn with_bounds(
    spec: &MissionSpec,
    world: &World,
    plan: impl FnOnce() -> FleetPlan + Send,
) -> FleetPlan {
    let ends = spec.vehicles.iter().zip(&world.sites);
    let routes: Vec<_> = ends
        .map(|(vehicle, sites)| route_ends(vehicle, sites))
        .collect();
    let (mut plan, bounds) = rayon::join(plan, || proven(spec, world, &routes));
    for (vehicle, bound) in plan.vehicles.iter_mut().zip(bounds) {
        vehicle.set_bound(bound);
    }
    plan
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
    plan.apply_to(&mut vehicle);
    let among = Among {
        sites: &world.sites[index],
        is_free: &|point| world.is_free(point),
    };
    flight_among(&vehicle, among, &plan.points())
}

/// When a flight is too near to an earlier one, as the objective sees it too.
pub(super) fn nearness(spec: &MissionSpec, margins: Margins) -> Nearness {
    let separation = margins.beyond(&spec.buffered_separation());
    Nearness {
        distance_m: separation.distance_m,
        vertical_m: separation.vertical_m,
        slack_s: separation.time_slack_s,
        clear_m: 0.0,
    }
}
