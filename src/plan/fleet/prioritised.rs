//! Prioritised planning in parallel: candidates of many vehicles at once, committed in priority
//! order. [`crate::plan::fleet`] defines the result.

use rayon::prelude::*;

use super::{Planning, nearness};
use crate::cost::{EarlierFlights, Margins};
use crate::numeric::tracks::{Nearness, Track, Tracks};
use crate::path::Flight;
use crate::plan::search::KnownClasses;
use crate::plan::{FleetPlan, VehiclePlan};
use crate::spec::{Algorithm, Objective};

/// Vehicles that are planned around all before them from the start.
const HEAD: usize = 8;
/// Vehicles planned at once, as far as they do not depend on each other.
const WINDOW: usize = 32;

/// Vehicles that get their first candidates at once.
const AHEAD: usize = 256;

/// Departures from which a vehicle is planned around others, until a path keeps every limit.
const ATTEMPTS: usize = 4;

/// A plan and the flight it makes.
pub(crate) struct Candidate {
    plan: VehiclePlan,
    /// The vehicles that it was to be planned around; it may be planned around others as well.
    asked: Vec<usize>,
    flight: Flight,
    track: Track,
    /// Whether this is the plan of an earlier round.
    is_reused: bool,
    /// Whether this is a path at another time than the specified one.
    is_retimed: bool,
    /// Whether this is the candidate before at another time, or that one again for lack of a
    /// better time: nothing is left to try around the same vehicles.
    is_last: bool,
    /// Those before it that it came too near to, among the first `checked`.
    near: Vec<usize>,
    checked: usize,
}

/// The next step of a vehicle.
enum Step {
    /// Commit this candidate.
    Commit(usize),
    /// Make this candidate, around these vehicles.
    Plan(usize, Vec<usize>),
}

/// A fleet as far as its plans are committed.
pub(crate) struct Fleet<'a> {
    planning: Planning<'a>,
    /// Plans of an earlier round, as far as there are any.
    previous: Vec<VehiclePlan>,
    /// Whether such a plan must be made anew.
    again: Vec<bool>,
    /// Committed plans and flights, and whether they are not those of the earlier round.
    plans: Vec<VehiclePlan>,
    flights: Vec<Flight>,
    is_new: Vec<bool>,
    tracks: Tracks,
    /// By vehicle, as long as it is not committed.
    classes: Vec<KnownClasses>,
}

impl<'a> Fleet<'a> {
    pub(crate) fn new(
        planning: Planning<'a>,
        again: &[usize],
        mut previous: Vec<VehiclePlan>,
    ) -> Self {
        // A repaired plan may avoid later vehicles: here these avoid it.
        for (index, plan) in previous.iter_mut().enumerate() {
            plan.avoids.retain(|&other| other < index);
        }
        let mut anew = vec![false; planning.spec.vehicles.len()];
        for &index in again {
            if let Some(anew) = anew.get_mut(index) {
                *anew = true;
            }
        }
        Self {
            classes: anew.iter().map(|_| KnownClasses::default()).collect(),
            planning,
            previous,
            again: anew,
            plans: Vec::new(),
            flights: Vec::new(),
            is_new: Vec::new(),
            tracks: Tracks::new(&nearness(planning.spec, Margins::default())),
        }
    }

    /// Plans and commits all vehicles, many at once.
    pub(crate) fn plan_in_parallel(mut self) -> FleetPlan {
        let count = self.planning.spec.vehicles.len();
        let mut chains: Vec<Vec<Candidate>> = (0..count).map(|_| Vec::new()).collect();
        let mut begun = 0;
        while self.plans.len() < count {
            let first = self.plans.len();
            let end = (first + WINDOW).min(count);
            if begun < end {
                // Those that are planned as if alone, and those that have a plan, wait for no one.
                let ahead = (begun + AHEAD).min(count);
                chains[begun..ahead]
                    .par_iter_mut()
                    .enumerate()
                    .for_each(|(step, chain)| self.advance(begun + step, chain));
                begun = ahead;
            }
            chains[first..end]
                .par_iter_mut()
                .enumerate()
                .for_each(|(step, chain)| self.advance(first + step, chain));
            for (index, chain) in chains.iter_mut().enumerate().take(end).skip(first) {
                match self.step(index, chain) {
                    Step::Commit(candidate) => {
                        chain.truncate(candidate + 1);
                        self.commit(std::mem::take(chain));
                    }
                    Step::Plan(..) => break,
                }
            }
        }
        self.plan()
    }

    pub(crate) fn plan(self) -> FleetPlan {
        FleetPlan {
            seed: self.planning.request.seed,
            vehicles: self.plans,
        }
    }

    /// Makes candidates of a vehicle until one holds against all commits, or must wait for a
    /// vehicle that is not committed yet.
    pub(crate) fn advance(&self, index: usize, chain: &mut Vec<Candidate>) {
        while let Step::Plan(number, avoids) = self.step(index, chain) {
            let awaited = match self.can_retime(index) && !chain.is_empty() {
                true => first_of_window(index),
                false => 0,
            };
            let others = avoids.last().map_or(0, |&last| last + 1);
            if self.plans.len() < others.max(awaited) {
                return;
            }
            chain.truncate(number);
            let candidate = self.candidate(index, avoids, chain);
            chain.push(candidate);
        }
    }

    /// Goes through the candidates of a vehicle, as they hold against all commits.
    fn step(&self, index: usize, chain: &mut [Candidate]) -> Step {
        let nearness = self.planning.nearness(index);
        let (mut avoids, mut unclean) = (self.first_avoids(index), 0);
        for (number, candidate) in chain.iter_mut().enumerate() {
            if candidate.checked < self.plans.len() {
                candidate.near.extend(self.tracks.near(
                    &candidate.track,
                    &nearness,
                    candidate.checked,
                ));
                candidate.checked = self.plans.len();
            }
            // Rejected times stay rejected with more commits, and a path alone does not depend on
            // its conflicts.
            let is_as_before = candidate.is_retimed && candidate.near.is_empty();
            if is_as_before && number == 1 {
                candidate.plan.avoids.clone_from(&avoids);
                candidate.asked.clone_from(&avoids);
            }
            if candidate.asked != avoids || (candidate.is_retimed && !is_as_before) {
                return Step::Plan(number, avoids);
            }
            avoids.clone_from(&candidate.plan.avoids);
            unclean += usize::from(candidate.is_unclean());
            let before = avoids.len();
            for &other in &candidate.near {
                // An old plan knows nothing of new flights, nor need it ask about old ones.
                let counts = if candidate.is_reused {
                    self.is_new[other]
                } else {
                    !candidate.plan.avoids.contains(&other)
                };
                if counts && !avoids.contains(&other) {
                    avoids.push(other);
                }
            }
            let again =
                candidate.is_reused && candidate.near.iter().any(|&other| self.is_new[other]);
            let retries = self.can_retime(index) && candidate.is_unclean() && unclean < ATTEMPTS;
            if avoids.len() == before && !again && !retries {
                let is_last = candidate.is_last || candidate.is_reused || candidate.near.is_empty();
                if is_last || !self.can_retime(index) {
                    return Step::Commit(number);
                }
            }
            if !candidate.is_reused && number > 0 && avoids.len() > before {
                // One way around others has met more: the next knows all who are about.
                let about = self.tracks.near(&candidate.track, &wider(&nearness), 0);
                avoids.extend(about);
            }
            avoids.sort_unstable();
            avoids.dedup();
        }
        Step::Plan(chain.len(), avoids)
    }

    /// The vehicles that the first candidate is planned around.
    fn first_avoids(&self, index: usize) -> Vec<usize> {
        let at_once = index < HEAD || self.planning.spec.planner.objective == Objective::Paper;
        match self.previous.get(index) {
            _ if self.can_retime(index) && (self.again[index] || self.previous.len() <= index) => {
                Vec::new()
            }
            Some(previous) => previous.avoids.clone(),
            None if at_once => (0..index).collect(),
            None => Vec::new(),
        }
    }

    /// What the plans of a vehicle are made from.
    fn planning_of(&self, index: usize) -> Planning<'_> {
        Planning {
            classes: self.classes.get(index),
            ..self.planning.of(index)
        }
    }

    fn can_retime(&self, index: usize) -> bool {
        self.planning.spec.vehicles[index].retiming.is_allowed()
    }

    /// The next candidate of a chain.
    fn candidate(&self, index: usize, avoids: Vec<usize>, chain: &[Candidate]) -> Candidate {
        let old = self.previous.get(index).filter(|_| chain.is_empty());
        let is_reused = old.filter(|_| !self.again[index]);
        let around = chain
            .last()
            .filter(|last| self.can_retime(index) && last.plan.avoids == avoids)
            .filter(|last| !last.is_unclean() || unclean(chain) >= ATTEMPTS);
        let at_another_time = match (chain, around) {
            ([first], _) if self.can_retime(index) => {
                self.at_another_time(index, &avoids, &self.alone(index, first))
            }
            (_, Some(last)) => self.at_another_time(index, &avoids, &counted(&last.plan)),
            _ => None,
        };
        let is_retimed = at_another_time.is_some();
        let is_last = chain.len() > 1 && around.is_some();
        let for_want = around.filter(|_| is_last).map(|last| counted(&last.plan));
        let ready = is_reused.cloned().or(at_another_time).or(for_want);
        let ready = ready.or_else(|| self.lifted(index, &avoids, old?));
        let asked = avoids.clone();
        let plan = ready.unwrap_or_else(|| {
            let before = chain.last().map(|candidate| &candidate.plan);
            let estimated = before.or(old).map(|plan| plan.estimate);
            self.or_alone(index, self.around(index, avoids, chain, estimated))
        });
        let flight = self.planning.flight(index, &plan);
        Candidate {
            track: flight.track(),
            flight,
            plan,
            asked,
            is_reused: is_reused.is_some(),
            is_retimed,
            is_last,
            near: Vec::new(),
            checked: 0,
        }
    }

    /// The plan of the earlier round, lifted to the margins that it failed, where the altitude is
    /// not searched.
    fn lifted(&self, index: usize, avoids: &[usize], old: &VehiclePlan) -> Option<VehiclePlan> {
        let decodes = self.planning.spec.planner.algorithm == Algorithm::Msfoa;
        if !decodes || self.can_retime(index) || old.avoids != avoids {
            return None;
        }
        let earlier = self.flights_of(avoids);
        self.planning.of(index).lift_vehicle(index, old, &earlier)
    }

    fn flights_of(&self, vehicles: &[usize]) -> EarlierFlights {
        let flights = vehicles.iter().map(|&other| self.flights[other].clone());
        flights.collect::<Vec<Flight>>().into()
    }

    /// A plan around committed vehicles. A vehicle with retiming departs when the fewest of all
    /// are in the way of the path that it would fly alone, and none in that of its takeoff and
    /// landing; where a path from there broke a limit, at the next best time. It is planned around
    /// those few as well. Only vehicles before its window count, so that all of a window can be
    /// planned at once.
    fn around(
        &self,
        index: usize,
        mut avoids: Vec<usize>,
        chain: &[Candidate],
        estimated: Option<f64>,
    ) -> VehiclePlan {
        let planning = self.planning_of(index);
        let first = chain.first().filter(|_| self.can_retime(index));
        let Some(path) = first.map(|first| &first.plan) else {
            let earlier = self.flights_of(&avoids);
            return planning.plan_vehicle(index, avoids, &earlier, estimated);
        };
        let nearness = planning.nearness(index);
        let known = 0..first_of_window(index);
        let met = |track: &Track, delays_s: &[f64]| {
            let among = known.clone();
            self.tracks.near_delayed(track, &nearness, among, delays_s)
        };
        let departures = planning.departures_by_conflicts(index, path, &met);
        let next = unclean(chain).min(departures.len() - 1);
        let (depart_s, others) = &departures[next];
        if chain.len() == 1 {
            // Those that the path meets at the specified departure are elsewhere by then.
            avoids.retain(|&other| other >= known.end);
        }
        avoids.extend(others);
        if index >= HEAD {
            // In a large fleet the way around them would meet more.
            let path = planning.departing(index, path, *depart_s);
            let track = planning.flight(index, &path).track();
            avoids.extend(self.tracks.near_among(&track, &wider(&nearness), known));
        }
        avoids.sort_unstable();
        avoids.dedup();
        let planning = Planning {
            depart_s: Some(*depart_s),
            ..planning
        };
        let earlier = self.flights_of(&avoids);
        planning.plan_vehicle(index, avoids, &earlier, estimated)
    }

    /// A plan that breaks a limit is replaced by that of the vehicle alone, if this one keeps all
    /// limits and conflicts with no vehicle that it had to avoid. Not in the paper's experiment,
    /// where all have one budget.
    fn or_alone(&self, index: usize, plan: VehiclePlan) -> VehiclePlan {
        let is_published = self.planning.spec.planner.objective == Objective::Paper;
        let stands = plan.terms.is_clean() || plan.avoids.is_empty();
        if stands || is_published || self.can_retime(index) {
            return plan;
        }
        let planning = self.planning_of(index);
        let alone = planning.plan_alone(index, plan.estimate);
        let nearness = planning.nearness(index);
        let track = planning.flight(index, &alone).track();
        let met = self.tracks.near(&track, &nearness, 0);
        let meets = met.iter().any(|other| plan.avoids.contains(other));
        let (evaluations, plans) = (
            plan.evaluations + alone.evaluations,
            plan.plans + alone.plans,
        );
        let better = if alone.terms.is_clean() && !meets {
            alone
        } else {
            plan.clone()
        };
        VehiclePlan {
            avoids: plan.avoids,
            evaluations,
            plans,
            ..better
        }
    }

    /// The way that a vehicle would fly alone.
    fn alone(&self, index: usize, first: &Candidate) -> VehiclePlan {
        if !first.is_reused && first.plan.avoids.is_empty() {
            return counted(&first.plan);
        }
        self.planning_of(index)
            .plan_alone(index, first.plan.estimate)
    }

    /// A path at another time, at which it has no conflict.
    fn at_another_time(
        &self,
        index: usize,
        avoids: &[usize],
        path: &VehiclePlan,
    ) -> Option<VehiclePlan> {
        let mut path = path.clone();
        // At the time that is looked for there is none.
        path.terms.collision = 0.0;
        let plan = self
            .planning
            .at_another_time(index, &path, (&self.tracks, &|_| true))?;
        Some(VehiclePlan {
            avoids: avoids.to_vec(),
            ..plan
        })
    }

    /// Commits the last candidate of a chain as the plan of the next vehicle.
    pub(crate) fn commit(&mut self, mut chain: Vec<Candidate>) {
        let Some(last) = chain.pop() else {
            return;
        };
        let mut plan = last.plan;
        let mut add = |other: &VehiclePlan| {
            plan.evaluations += other.evaluations;
            plan.plans += other.plans;
        };
        for candidate in &chain {
            add(&candidate.plan);
        }
        let begins_anew = !chain
            .first()
            .map_or(last.is_reused, |first| first.is_reused);
        if let Some(old) = self.previous.get(self.plans.len()).filter(|_| begins_anew) {
            add(old);
        }
        if let Some(classes) = self.classes.get_mut(self.plans.len()) {
            *classes = KnownClasses::default();
        }
        self.plans.push(plan);
        self.flights.push(last.flight);
        self.is_new.push(!last.is_reused);
        self.tracks.extend([last.track]);
    }
}

impl Candidate {
    /// Whether it is a path around others that breaks a limit.
    fn is_unclean(&self) -> bool {
        let is_searched = !self.is_reused && !self.is_retimed && !self.is_last;
        is_searched && !self.plan.avoids.is_empty() && !self.plan.terms.is_clean()
    }
}

/// How many candidates are paths around others that break a limit.
fn unclean(chain: &[Candidate]) -> usize {
    chain.iter().filter(|one| one.is_unclean()).count()
}

/// The first vehicle of a window: departures depend on those before it alone.
fn first_of_window(index: usize) -> usize {
    index - index % WINDOW
}

/// The same at several times the distances.
pub(super) fn wider(nearness: &Nearness) -> Nearness {
    /// Far enough that a way around others seldom meets more.
    const TIMES: f64 = 4.0;
    Nearness {
        distance_m: TIMES * nearness.distance_m,
        vertical_m: nearness.vertical_m.map(|vertical_m| TIMES * vertical_m),
        ..*nearness
    }
}

/// A plan whose effort is counted elsewhere.
pub(super) fn counted(plan: &VehiclePlan) -> VehiclePlan {
    VehiclePlan {
        evaluations: 0,
        plans: 0,
        ..plan.clone()
    }
}
