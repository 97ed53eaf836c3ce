//! Zones with times. The planner takes every zone as closed at all times; a fleet that flies while
//! one is inactive, or that may wait on the ground until it is, is planned without it as well, and
//! the verdict, which knows the times, decides. Where a zone begins or ends during a flight, see
//! [`in_flight`].

mod in_flight;

use super::{Dispatched, Job};
use crate::path::route_ends;
use crate::spec::{MissionSpec, Span, Stop, Vehicle, wait_less};
use crate::verify::{Limit, Review};
use crate::world::{VehicleSites, World};

/// A plan this near to its bound has nothing to gain, as a share of the bound.
const WORTH: f64 = 0.01;
/// Most plans with other departures.
const MAX: usize = 4;
/// A flight is estimated at this multiple of its straight routes.
const DETOUR: f64 = 2.0;
/// After the end of a zone's time a vehicle waits so much longer, seconds.
const AFTER_S: f64 = 1.0;

/// What a fleet is planned from instead.
type Variant = (MissionSpec, World);

/// The best plan of a fleet: through zones that are inactive as it departs by the spec, then among
/// all zones, then departing after their times. Of two plans that cost nearly the same the earlier
/// departure is kept.
pub(super) fn with_times<'a>(
    job: Job<'a>,
    dispatch_closed: impl Fn(Job<'_>) -> Dispatched,
) -> Dispatched {
    if !job.spec.no_fly.iter().any(|zone| zone.active_s.is_some()) {
        return dispatch_closed(job);
    }
    let (at_once, after) = variants(job.spec, job.world);
    let open = |variant: &Variant| {
        let (spec, world) = variant;
        dispatch_closed(Job { spec, world, ..job }).with_waits_of(spec, job.spec)
    };
    let is_good = |found: &Dispatched| {
        found.review.passes() && found.plan.gap().is_some_and(|gap| gap < WORTH)
    };
    let inactive = at_once.as_ref().map(|variant| (&variant.0, open(variant)));
    let through = inactive.as_ref().map(|(_, found)| found);
    let through = through.filter(|found| found.review.passes()).cloned();
    if let Some(found) = through.as_ref().filter(|found| is_good(found)) {
        return found.clone();
    }
    let known = inactive.as_ref().map(|(spec, found)| (*spec, found));
    let in_time = in_flight::in_time(job, known, &dispatch_closed);
    let is_as_specified = |found: &Dispatched| {
        let mut fleet = job.spec.vehicles.iter().zip(&found.plan.vehicles);
        fleet.all(|(vehicle, plan)| plan.depart_s <= vehicle.depart_s)
    };
    let good = |found: &&Dispatched| is_as_specified(found) && is_good(found);
    if let Some(found) = in_time.as_ref().filter(good) {
        return found.clone();
    }
    let closed = dispatch_closed(job);
    let mut best = match through {
        Some(found) if found.is_better_than(closed.rank()) => found,
        _ => closed,
    };
    if let Some(found) = in_time {
        let share = 1.0 - WORTH * f64::from(u8::from(!is_as_specified(&found)));
        if !best.review.passes() || found.plan.cost() < best.plan.cost() * share {
            best = found;
        }
    }
    for variant in &after {
        if is_good(&best) || job.run.is_cancelled() {
            break;
        }
        let later = open(variant);
        let most = best.plan.cost() * (1.0 - WORTH);
        if later.review.passes() && (!best.review.passes() || later.plan.cost() < most) {
            best = later;
        }
    }
    best
}

impl Dispatched {
    /// With the stops that it is planned with, where their waits are not those of the specified ones.
    fn with_waits_of(mut self, planned: &MissionSpec, specified: &MissionSpec) -> Self {
        let stops = |of: &MissionSpec| -> Vec<Vec<Stop>> {
            let fleet = of.vehicles.iter();
            fleet.map(|vehicle| vehicle.stops.clone()).collect()
        };
        let planned = stops(planned);
        self.delayed = (planned != stops(specified)).then_some(planned);
        self
    }
}

/// Whether a vehicle enters a zone with times during these.
pub(super) fn breaks_one(spec: &MissionSpec, review: &Review) -> bool {
    let mut broken = review.margins.iter().filter(|margin| !margin.ok);
    broken.any(|margin| match &margin.limit {
        Limit::Zone(id) => {
            (spec.no_fly.iter()).any(|zone| zone.id == *id && zone.active_s.is_some())
        }
        _ => false,
    })
}

/// The zones that vehicles enter while they are active, though they were planned through them: by the
/// indices of vehicle and zone of the spec that is judged.
pub(super) fn entered_in_time(job: Job<'_>, found: &Dispatched) -> Vec<(usize, usize)> {
    let all = &job.judged.0.no_fly;
    let broken = found.review.margins.iter().filter(|margin| !margin.ok);
    let entered = broken.filter_map(|margin| {
        let Limit::Zone(id) = &margin.limit else {
            return None;
        };
        let mut fleet = job.spec.vehicles.iter();
        let vehicle = fleet.position(|vehicle| vehicle.id == margin.vehicle)?;
        let own = job.world.own.get(vehicle).and_then(Option::as_deref);
        let among = own.map_or(job.spec, |own| &own.spec);
        let zone = all.iter().position(|zone| zone.id == *id)?;
        let is_planned_through =
            all[zone].active_s.is_some() && !among.no_fly.iter().any(|zone| zone.id == *id);
        is_planned_through.then_some((vehicle, zone))
    });
    entered.collect()
}

/// The spec and the world without zones that are inactive while the fleet flies: as it departs by
/// the spec, if there are any, and after each zone's time, where the windows of departures reach so
/// far.
fn variants(spec: &MissionSpec, world: &World) -> (Option<Variant>, Vec<Variant>) {
    let times = world.zones.iter().filter_map(|zone| zone.active_s);
    let mut waits_s: Vec<f64> = times.map(|(_, to_s)| to_s + AFTER_S).collect();
    waits_s.sort_by(f64::total_cmp);
    waits_s.dedup();
    let mut fewest = spec.no_fly.len();
    let mut opening = |wait_s: f64| {
        let open = without_inactive(departing_after(spec, wait_s), world.clone());
        let is_more = open.0.no_fly.len() < fewest;
        fewest = fewest.min(open.0.no_fly.len());
        is_more.then_some(open)
    };
    let at_once = opening(f64::NEG_INFINITY);
    (
        at_once,
        waits_s.into_iter().filter_map(opening).take(MAX).collect(),
    )
}

/// Without the zones that are inactive from the first departure to the last landing.
fn without_inactive(mut spec: MissionSpec, mut world: World) -> Variant {
    let (first_s, last_s) = flight_s(&spec, &world);
    let is_open = |(from_s, to_s): (f64, f64)| to_s < first_s || last_s < from_s;
    let zones = world.zones.iter();
    let stays: Vec<bool> = zones
        .map(|zone| !zone.active_s.is_some_and(is_open))
        .collect();
    keep(&mut spec.no_fly, &stays);
    keep(&mut world.zones, &stays);
    (spec, world)
}

fn keep<T>(all: &mut Vec<T>, stays: &[bool]) {
    let mut stays = stays.iter();
    all.retain(|_| stays.next().is_none_or(|stays| *stays));
}

/// The spec with departures not before a time, where a vehicle's window has such.
fn departing_after(spec: &MissionSpec, wait_s: f64) -> MissionSpec {
    let mut spec = spec.clone();
    for vehicle in &mut spec.vehicles {
        let Some(window) = vehicle.retiming.depart_s else {
            continue;
        };
        let least = window.least.max(wait_s);
        if least <= window.most {
            vehicle.retiming.depart_s = Some(Span { least, ..window });
            let specified_s = vehicle.depart_s;
            vehicle.depart_s = specified_s.max(least);
            wait_less(&mut vehicle.stops, vehicle.depart_s - specified_s);
        }
    }
    spec
}

/// From the first departure to about the last landing, seconds after T0. Whether that is long
/// enough is for the verdict to say.
fn flight_s(spec: &MissionSpec, world: &World) -> (f64, f64) {
    let fleet = spec.vehicles.iter().zip(&world.sites);
    let flights = fleet.map(|(vehicle, sites)| {
        let departs_s = vehicle.departures().least.min(vehicle.depart_s);
        (
            departs_s,
            vehicle.depart_s + DETOUR * straight_s(vehicle, sites),
        )
    });
    let whole = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
    flights.fold((f64::INFINITY, f64::NEG_INFINITY), whole)
}

/// How long a vehicle is in the air on straight routes, with its rests, seconds.
fn straight_s(vehicle: &Vehicle, sites: &VehicleSites) -> f64 {
    let routes = route_ends(vehicle, sites).into_iter();
    let straight_m: f64 = routes.map(|(from, to)| from.distance_m(to)).sum();
    let rests_s = (0..=vehicle.stops.len()).map(|route| vehicle.rest_after_s(route));
    let climb_m = (sites.start.amsl.0 - sites.home.amsl.0).abs();
    rests_s.sum::<f64>() + straight_m / vehicle.speed_mps + climb_m / climb_mps(vehicle)
}

fn climb_mps(vehicle: &Vehicle) -> f64 {
    vehicle.climb_mps.min(vehicle.descent_mps)
}
