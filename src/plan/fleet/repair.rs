//! Repairs of a large fleet: vehicles that failed verification are planned again around all others
//! as they stand, whatever their priority.
//!
//! Planning again in priority order would also move those after them that they now come too near
//! to, and these would move others. In a large fleet each round of that plans many times as many
//! vehicles as had failed. Here nobody else moves. A vehicle keeps its line in the plane if that is
//! enough, and flies it at another time if others are in the way then. Only where that fails it is
//! searched anew.
//!
//! A vehicle for which no path is found among all others pushes some aside: see [`pushing`].

mod pushing;

use rayon::prelude::*;

use super::prioritised::{counted, wider};
use super::{Planning, nearness};
use crate::cost::{EarlierFlights, Margins};
use crate::numeric::tracks::{Track, Tracks};
use crate::path::Flight;
use crate::plan::VehiclePlan;
use crate::plan::search::KnownClasses;
use crate::spec::Algorithm;

/// Vehicles planned at once, as far as they do not come too near to each other.
const WINDOW: usize = 32;
/// Searches around others, each around those that the one before met as well, at most.
const SEARCHES: usize = 9;
/// How often vehicles for which there is no path push others aside, at most.
const PUSHES: usize = 12;
/// Departures from which a vehicle is searched around others, until a path keeps every limit.
const DEPARTURES: usize = 4;

/// A fleet in which some vehicles are planned again.
struct Repair<'a> {
    planning: Planning<'a>,
    /// By vehicle.
    plans: Vec<VehiclePlan>,
    /// By vehicle; none where it is not planned yet.
    flights: Vec<Option<Flight>>,
    /// Of the vehicles that have a flight, and some that were flown before.
    tracks: Tracks,
    /// The vehicle of each track.
    vehicles: Vec<usize>,
    /// By vehicle: the number of the track of its flight.
    current: Vec<Option<usize>>,
    /// Vehicles whose new plan breaks a limit among the others.
    failed: Vec<usize>,
}

/// A vehicle that is planned again.
struct Pending {
    vehicle: usize,
    /// Only vehicles with a lower index are in its way.
    below: usize,
    classes: KnownClasses,
    /// Its old line at the altitudes that are now required, at its old departure, if that is good.
    lifted: Option<VehiclePlan>,
    /// The path that it would fly alone, once it is known.
    alone: Option<VehiclePlan>,
    /// What was spent on it before the plan that is committed.
    evaluations: usize,
    plans: usize,
}

/// A plan with the flight that it makes.
struct Planned {
    plan: VehiclePlan,
    flight: Flight,
    track: Track,
    /// Whether it keeps every limit among all that have a flight.
    is_good: bool,
}

/// The plans with those of some vehicles made again. Where no path was found that keeps every limit
/// among those before a vehicle, its plan breaks one.
pub(super) fn repaired(
    planning: Planning<'_>,
    previous: &[VehiclePlan],
    again: &[usize],
) -> Vec<VehiclePlan> {
    let mut repair = Repair::new(planning, previous, again);
    let again: Vec<usize> = (again.iter().copied())
        .filter(|&vehicle| vehicle < previous.len())
        .collect();
    repair.plan_again(&again);
    for _ in 0..PUSHES {
        let mut failed = std::mem::take(&mut repair.failed);
        in_order(&mut failed);
        let pushed = repair.push_aside(&failed);
        if pushed.is_empty() {
            break;
        }
        repair.plan_again(&pushed);
    }
    repair.plans
}

impl Pending {
    /// Counts what was spent on a plan that is not the one that is committed.
    fn count(&mut self, plan: &VehiclePlan) {
        self.evaluations += plan.evaluations;
        self.plans += plan.plans;
    }

    fn count_before(&mut self, planned: Option<&Planned>) {
        if let Some(planned) = planned {
            self.count(&planned.plan);
        }
    }
}

impl<'a> Repair<'a> {
    /// Plans vehicles that have no flight among all that have one.
    fn plan_again(&mut self, again: &[usize]) {
        let each = again.par_iter().map(|&vehicle| self.pending(vehicle));
        let all: Vec<(Pending, Option<Planned>)> = each.collect();
        // Those that can stay where they were come first, so that nobody moves into their way.
        let waiting = self.commit_free(all);
        self.plan_waiting(waiting);
    }

    fn plan_waiting(&mut self, mut waiting: Vec<Pending>) {
        while !waiting.is_empty() {
            let rest = waiting.split_off(waiting.len().min(WINDOW));
            let each = waiting.into_par_iter().map(|mut pending| {
                let planned = self.planned(&mut pending);
                (pending, Some(planned))
            });
            let all = each.collect();
            waiting = self.commit_free(all);
            waiting.extend(rest);
        }
    }

    /// Whether the track of a number is that of a vehicle as it flies now, with an index below one.
    fn counts(&self, number: usize, below: usize) -> bool {
        let vehicle = self.vehicles[number];
        vehicle < below && self.current[vehicle] == Some(number)
    }

    fn new(planning: Planning<'a>, previous: &[VehiclePlan], again: &[usize]) -> Self {
        let mut stands = vec![true; previous.len()];
        for &vehicle in again {
            if let Some(stands) = stands.get_mut(vehicle) {
                *stands = false;
            }
        }
        let each = previous.par_iter().zip(&stands).enumerate();
        let flights: Vec<Option<Flight>> = each
            .map(|(vehicle, (plan, stands))| stands.then(|| planning.flight(vehicle, plan)))
            .collect();
        let standing: Vec<Track> = (flights.par_iter().flatten()).map(Flight::track).collect();
        let mut tracks = Tracks::new(&nearness(planning.spec, Margins::default()));
        tracks.extend(standing);
        let vehicles: Vec<usize> = (0..previous.len()).filter(|&one| stands[one]).collect();
        let mut current = vec![None; previous.len()];
        for (number, &vehicle) in vehicles.iter().enumerate() {
            current[vehicle] = Some(number);
        }
        Self {
            planning,
            plans: previous.to_vec(),
            flights,
            tracks,
            vehicles,
            current,
            failed: Vec::new(),
        }
    }

    /// A vehicle to plan again, and its old line, if it can stay there.
    fn pending(&self, vehicle: usize) -> (Pending, Option<Planned>) {
        let old = &self.plans[vehicle];
        let planning = Planning {
            depart_s: Some(old.depart_s),
            ..self.planning.of(vehicle)
        };
        // Other algorithms search the altitude.
        let decodes = planning.spec.planner.algorithm == Algorithm::Msfoa;
        let lifted = decodes.then(|| planning.lift_vehicle(vehicle, old, EarlierFlights::none()));
        let mut pending = Pending {
            vehicle,
            below: usize::MAX,
            classes: KnownClasses::default(),
            lifted: None,
            alone: None,
            evaluations: old.evaluations,
            plans: old.plans,
        };
        if let Some(lifted) = lifted.flatten() {
            pending.count(&lifted);
            pending.lifted = Some(counted(&lifted));
        }
        let at = (vehicle, pending.below);
        let planned = (pending.lifted.as_ref()).map(|lifted| self.lifted(at, lifted));
        (pending, planned.filter(|planned| planned.is_good))
    }

    fn lifted(&self, at: (usize, usize), lifted: &VehiclePlan) -> Planned {
        self.with_flight(at, lifted.clone(), &[])
    }

    /// Commits the plans that do not come too near to those before them, in order, and those for which
    /// nothing better is known. Returns the vehicles of the others.
    fn commit_free(&mut self, all: Vec<(Pending, Option<Planned>)>) -> Vec<Pending> {
        let before = self.tracks.len();
        let mut others = Vec::new();
        for (mut pending, planned) in all {
            let Some(planned) = planned else {
                others.push(pending);
                continue;
            };
            let nearness = self.planning.nearness(pending.vehicle);
            let met = self.tracks.near(&planned.track, &nearness, before);
            let mut met = met.into_iter();
            let is_met = met.any(|number| self.counts(number, pending.below));
            if !is_met || !planned.is_good {
                self.commit(&pending, planned);
            } else {
                pending.count(&planned.plan);
                others.push(pending);
            }
        }
        others
    }

    /// The next plan of a vehicle among all that have a flight.
    fn planned(&self, pending: &mut Pending) -> Planned {
        let (vehicle, below) = (pending.vehicle, pending.below);
        let at = (vehicle, below);
        let mut avoids = self.plans[vehicle].avoids.clone();
        avoids.retain(|&other| other < below);
        if let Some(lifted) = &pending.lifted {
            let planned = self.lifted(at, lifted);
            if planned.is_good {
                return planned;
            }
            avoids.extend(self.met(at, &planned.track));
            in_order(&mut avoids);
        }
        if !self.planning.spec.vehicles[vehicle].retiming.is_allowed() {
            avoids.retain(|&other| self.flights[other].is_some());
            return self.searched(pending, vec![(None, avoids)]);
        }
        let alone = self.alone(pending);
        let planning = self.planning.of(vehicle);
        let counts = |number: usize| self.counts(number, below);
        if let Some(plan) = planning.at_another_time(vehicle, &alone, (&self.tracks, &counts)) {
            return self.with_flight(at, VehiclePlan { avoids, ..plan }, &[]);
        }
        let nearness = planning.nearness(vehicle);
        let met = |track: &Track, delays_s: &[f64]| {
            let all = 0..self.tracks.len();
            let met = self.tracks.near_delayed(track, &nearness, all, delays_s);
            let met = met
                .into_iter()
                .map(|numbers| self.of_tracks(numbers, below));
            met.collect()
        };
        let departures = planning.departures_by_conflicts(vehicle, &alone, &met);
        let best = departures.into_iter().take(DEPARTURES);
        let around = best.map(|(depart_s, others)| {
            let path = planning.departing(vehicle, &alone, depart_s);
            let track = planning.flight(vehicle, &path).track();
            let mut avoids = others;
            // The way around them would meet more.
            avoids.extend(self.about(at, &track));
            (Some(depart_s), avoids)
        });
        self.searched(pending, around.collect())
    }

    /// The path that a vehicle would fly alone: its old one, unless that gives way to others.
    fn alone(&self, pending: &mut Pending) -> VehiclePlan {
        let vehicle = pending.vehicle;
        let old = &self.plans[vehicle];
        let known = pending.alone.take();
        let known = known.or_else(|| pending.lifted.clone().filter(|_| !old.is_detour));
        let mut alone = known.unwrap_or_else(|| {
            let planning = Planning {
                classes: Some(&pending.classes),
                ..self.planning.of(vehicle)
            };
            let alone = planning.plan_alone(vehicle, old.estimate);
            pending.count(&alone);
            counted(&alone)
        });
        // At the time that is looked for there is no conflict.
        alone.terms.collision = 0.0;
        pending.alone = Some(alone.clone());
        alone
    }

    /// A path around others: from the first of some departures from which one is found that keeps every
    /// limit, and where there is none the last that was found.
    fn searched(&self, pending: &mut Pending, from: Vec<(Option<f64>, Vec<usize>)>) -> Planned {
        let at = (pending.vehicle, pending.below);
        let mut last: Option<Planned> = None;
        for (depart_s, mut avoids) in from {
            for _ in 0..SEARCHES {
                in_order(&mut avoids);
                let planned = self.around(pending, depart_s, &avoids);
                if planned.is_good {
                    pending.count_before(last.as_ref());
                    return planned;
                }
                let known = avoids.len();
                let met = self.met(at, &planned.track);
                if met.iter().any(|other| !avoids.contains(other)) {
                    // One way around others has met more: the next knows all who are about.
                    avoids.extend(met);
                    avoids.extend(self.about(at, &planned.track));
                    in_order(&mut avoids);
                }
                let is_clean = planned.plan.terms.is_clean();
                pending.count_before(last.replace(planned).as_ref());
                if !is_clean || avoids.len() == known {
                    break;
                }
            }
        }
        last.unwrap_or_else(|| self.with_flight(at, self.plans[at.0].clone(), &[]))
    }

    fn around(&self, pending: &Pending, depart_s: Option<f64>, avoids: &[usize]) -> Planned {
        let vehicle = pending.vehicle;
        let planning = Planning {
            depart_s,
            classes: Some(&pending.classes),
            ..self.planning.of(vehicle)
        };
        let flights = (avoids.iter()).filter_map(|&other| self.flights[other].clone());
        let earlier = EarlierFlights::from(flights.collect::<Vec<Flight>>());
        let estimated = Some(self.plans[vehicle].estimate);
        let plan = planning.plan_vehicle(vehicle, avoids.to_vec(), &earlier, estimated);
        self.with_flight((vehicle, pending.below), plan, avoids)
    }

    /// A plan as it is flown. It may come near some whose distance it was searched with.
    fn with_flight(&self, at: (usize, usize), plan: VehiclePlan, searched: &[usize]) -> Planned {
        let flight = self.planning.flight(at.0, &plan);
        let track = flight.track();
        let met = self.met(at, &track);
        let is_apart = met.iter().all(|other| searched.contains(other));
        Planned {
            is_good: is_apart && plan.terms.is_clean(),
            plan,
            flight,
            track,
        }
    }

    /// The vehicles with an index below one that the track of a vehicle comes too near to.
    fn met(&self, (vehicle, below): (usize, usize), track: &Track) -> Vec<usize> {
        let nearness = self.planning.nearness(vehicle);
        self.of_tracks(self.tracks.near(track, &nearness, 0), below)
    }

    /// Those that are about while a track is flown.
    fn about(&self, (vehicle, below): (usize, usize), track: &Track) -> Vec<usize> {
        let nearness = wider(&self.planning.nearness(vehicle));
        self.of_tracks(self.tracks.near(track, &nearness, 0), below)
    }

    /// The vehicles of tracks that count.
    fn of_tracks(&self, numbers: Vec<usize>, below: usize) -> Vec<usize> {
        let numbers = numbers.into_iter();
        let numbers = numbers.filter(|&number| self.counts(number, below));
        numbers.map(|number| self.vehicles[number]).collect()
    }

    fn commit(&mut self, pending: &Pending, planned: Planned) {
        let vehicle = pending.vehicle;
        self.failed.extend((!planned.is_good).then_some(vehicle));
        let plan = planned.plan;
        self.plans[vehicle] = VehiclePlan {
            evaluations: pending.evaluations + plan.evaluations,
            plans: pending.plans + plan.plans,
            ..plan
        };
        self.flights[vehicle] = Some(planned.flight);
        self.current[vehicle] = Some(self.tracks.len());
        self.tracks.extend([planned.track]);
        self.vehicles.push(vehicle);
    }
}

fn in_order(vehicles: &mut Vec<usize>) {
    vehicles.sort_unstable();
    vehicles.dedup();
}
