//! How the plans of a fleet come to stand: drafts of each vehicle, many at once, as
//! [`crate::plan::fleet`] says what they mean.

use rayon::prelude::*;

use super::retiming::{at_another_time, can_retime, free_departure_s};
use super::vehicle::{lift_vehicle, plan_vehicle};
use super::{Request, flight_of, nearness};
use crate::cost::Margins;
use crate::numeric::tracks::{Nearness, Track, Tracks};
use crate::path::Flight;
use crate::plan::{FleetPlan, VehiclePlan};
use crate::spec::{Algorithm, MissionSpec, Objective};
use crate::world::World;

/// Vehicles that are planned around all before them from the start.
const HEAD: usize = 8;
/// Vehicles that are brought to stand at once, as far as they do not depend on each other.
const WINDOW: usize = 32;

/// A plan and the flight it makes.
pub(crate) struct Draft {
    plan: VehiclePlan,
    flight: Flight,
    track: Track,
    /// Whether this is the plan of an earlier round.
    kept: bool,
    /// Whether this is a way at another time than the wanted one.
    is_retimed: bool,
    /// Whether this is the draft before at another time, or that one again for want of a
    /// better time: nothing is left to try around the same vehicles.
    is_last: bool,
    /// Those before it that it came too near to, among the first `checked`.
    near: Vec<usize>,
    checked: usize,
}

/// What a vehicle's next step is.
enum Step {
    /// This draft stands.
    Stands(usize),
    /// To make this draft, around these vehicles.
    Plan(usize, Vec<usize>),
}

/// A fleet as far as its plans stand.
pub(crate) struct Fleet<'a> {
    spec: &'a MissionSpec,
    world: &'a World,
    request: &'a Request<'a>,
    /// Plans of an earlier round, as far as there are any.
    previous: Vec<VehiclePlan>,
    /// Whether such a plan must be made anew.
    again: Vec<bool>,
    /// Plans and flights that stand, and whether they are not those of the earlier round.
    plans: Vec<VehiclePlan>,
    flights: Vec<Flight>,
    is_new: Vec<bool>,
    tracks: Tracks,
}

impl<'a> Fleet<'a> {
    pub(crate) fn new(
        spec: &'a MissionSpec,
        world: &'a World,
        request: &'a Request<'a>,
        again: &[usize],
        previous: Vec<VehiclePlan>,
    ) -> Self {
        let mut anew = vec![false; spec.vehicles.len()];
        for &index in again {
            if let Some(anew) = anew.get_mut(index) {
                *anew = true;
            }
        }
        Self {
            spec,
            world,
            request,
            previous,
            again: anew,
            plans: Vec::new(),
            flights: Vec::new(),
            is_new: Vec::new(),
            tracks: Tracks::new(&nearness(spec, Margins::default())),
        }
    }

    /// Brings all vehicles to stand, many at once.
    pub(crate) fn settle(mut self) -> FleetPlan {
        let count = self.spec.vehicles.len();
        // Those that are planned as if alone, and those that have a plan, wait for no one.
        let mut chains: Vec<Vec<Draft>> = (0..count)
            .into_par_iter()
            .map(|index| {
                let mut chain = Vec::new();
                self.advance(index, &mut chain);
                chain
            })
            .collect();
        while self.plans.len() < count {
            let first = self.plans.len();
            let end = (first + WINDOW).min(count);
            chains[first..end]
                .par_iter_mut()
                .enumerate()
                .for_each(|(step, chain)| self.advance(first + step, chain));
            for (index, chain) in chains.iter_mut().enumerate().take(end).skip(first) {
                match self.step(index, chain) {
                    Step::Stands(draft) => {
                        chain.truncate(draft + 1);
                        self.accept(std::mem::take(chain));
                    }
                    Step::Plan(..) => break,
                }
            }
        }
        self.plan()
    }

    pub(crate) fn plan(self) -> FleetPlan {
        FleetPlan {
            seed: self.request.seed,
            vehicles: self.plans,
        }
    }

    /// Makes the drafts of a vehicle, until one stands against all that stand, or has to
    /// wait for one that does not stand yet.
    pub(crate) fn advance(&self, index: usize, chain: &mut Vec<Draft>) {
        while let Step::Plan(number, avoids) = self.step(index, chain) {
            if avoids.last().is_some_and(|&last| last >= self.plans.len()) {
                return;
            }
            chain.truncate(number);
            let draft = self.draft(index, avoids, chain);
            chain.push(draft);
        }
    }

    /// Goes through the drafts of a vehicle, as they hold against all that stand now.
    fn step(&self, index: usize, chain: &mut [Draft]) -> Step {
        let nearness = nearness(self.spec, self.request.margins_of(index));
        let mut avoids = self.first_avoids(index);
        for (number, draft) in chain.iter_mut().enumerate() {
            if draft.checked < self.plans.len() {
                draft
                    .near
                    .extend(self.tracks.near(&draft.track, &nearness, draft.checked));
                draft.checked = self.plans.len();
            }
            // Times that were passed over stay so, whoever comes to stand besides; and a way
            // alone does not depend on whom it meets.
            let is_as_before = draft.is_retimed && draft.near.is_empty();
            if is_as_before && number == 1 {
                draft.plan.avoids.clone_from(&avoids);
            }
            if draft.plan.avoids != avoids || (draft.is_retimed && !is_as_before) {
                return Step::Plan(number, avoids);
            }
            let before = avoids.len();
            for &other in &draft.near {
                // An old plan knows nothing of new flights, nor need it ask about old ones.
                let counts = if draft.kept {
                    self.is_new[other]
                } else {
                    !draft.plan.avoids.contains(&other)
                };
                if counts && !avoids.contains(&other) {
                    avoids.push(other);
                }
            }
            let again = draft.kept && draft.near.iter().any(|&other| self.is_new[other]);
            if avoids.len() == before && !again {
                let is_last = draft.is_last || draft.kept || draft.near.is_empty();
                if is_last || !self.can_retime(index) {
                    return Step::Stands(number);
                }
            }
            if !draft.kept && number > 0 && avoids.len() > before {
                // One way around others has met more: the next knows all who are about.
                let about = self.tracks.near(&draft.track, &wider(&nearness), 0);
                avoids.extend(about);
            }
            avoids.sort_unstable();
            avoids.dedup();
        }
        Step::Plan(chain.len(), avoids)
    }

    /// Those a vehicle's first draft is planned around.
    fn first_avoids(&self, index: usize) -> Vec<usize> {
        let at_once = index < HEAD || self.spec.planner.objective == Objective::Paper;
        match self.previous.get(index) {
            _ if self.can_retime(index) && (self.again[index] || self.previous.len() <= index) => {
                Vec::new()
            }
            Some(previous) => previous.avoids.clone(),
            None if at_once => (0..index).collect(),
            None => Vec::new(),
        }
    }

    fn can_retime(&self, index: usize) -> bool {
        can_retime(&self.spec.vehicles[index])
    }

    /// The next draft of a chain.
    fn draft(&self, index: usize, avoids: Vec<usize>, chain: &[Draft]) -> Draft {
        let old = self.previous.get(index).filter(|_| chain.is_empty());
        let kept = old.filter(|_| !self.again[index]);
        let around = chain
            .last()
            .filter(|last| self.can_retime(index) && last.plan.avoids == avoids);
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
        let ready = kept.cloned().or(at_another_time).or(for_want);
        let ready = ready.or_else(|| self.lifted(index, &avoids, old?));
        let plan = ready.unwrap_or_else(|| {
            let before = chain.last().map(|draft| &draft.plan);
            let estimated = before.or(old).map(|plan| plan.estimate);
            self.or_alone(index, self.around(index, avoids, chain, estimated))
        });
        let flight = flight_of(self.spec, self.world, index, &plan);
        Draft {
            track: flight.track(),
            flight,
            plan,
            kept: kept.is_some(),
            is_retimed,
            is_last,
            near: Vec::new(),
            checked: 0,
        }
    }

    /// The plan of the earlier round, lifted to the margins that it failed, where the altitude is
    /// not searched.
    fn lifted(&self, index: usize, avoids: &[usize], old: &VehiclePlan) -> Option<VehiclePlan> {
        let decodes = self.spec.planner.algorithm == Algorithm::Msfoa;
        if !decodes || self.can_retime(index) || old.avoids != avoids {
            return None;
        }
        let earlier = self.flights_of(avoids);
        lift_vehicle(self.spec, self.world, self.request, index, old, &earlier)
    }

    fn flights_of(&self, vehicles: &[usize]) -> Vec<Flight> {
        let flights = vehicles.iter().map(|&other| self.flights[other].clone());
        flights.collect()
    }

    /// A plan around some of those that stand. Who has retiming takes off when nobody of them is
    /// in the way of its takeoff and landing.
    fn around(
        &self,
        index: usize,
        avoids: Vec<usize>,
        chain: &[Draft],
        estimated: Option<f64>,
    ) -> VehiclePlan {
        let (spec, world, request) = (self.spec, self.world, self.request);
        let earlier = self.flights_of(&avoids);
        let way = chain.first().filter(|_| self.can_retime(index));
        let Some(way) = way.map(|first| &first.plan) else {
            return plan_vehicle(spec, world, request, index, avoids, &earlier, estimated);
        };
        let nearness = nearness(spec, self.request.margins_of(index));
        let mut others = Tracks::new(&nearness);
        others.extend(earlier.iter().map(|flight| flight.track()));
        let is_apart = |columns: &Track| others.near(columns, &nearness, 0).is_empty();
        let mut settled = spec.clone();
        settled.vehicles[index].depart_s = free_departure_s(spec, world, index, way, &is_apart);
        plan_vehicle(&settled, world, request, index, avoids, &earlier, estimated)
    }

    /// A plan that breaks a limit gives way to that of the vehicle alone, if this keeps all and
    /// meets nobody of whom it had to avoid. Not in the paper's experiment, whose contestants
    /// have one budget.
    fn or_alone(&self, index: usize, plan: VehiclePlan) -> VehiclePlan {
        let is_printed = self.spec.planner.objective == Objective::Paper;
        let stands = plan.terms.is_clean() || plan.avoids.is_empty();
        if stands || is_printed || self.can_retime(index) {
            return plan;
        }
        let (spec, world, request) = (self.spec, self.world, self.request);
        let estimated = Some(plan.estimate);
        let alone = plan_vehicle(spec, world, request, index, Vec::new(), &[], estimated);
        let nearness = nearness(spec, request.margins_of(index));
        let track = flight_of(spec, world, index, &alone).track();
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
    fn alone(&self, index: usize, first: &Draft) -> VehiclePlan {
        if !first.kept && first.plan.avoids.is_empty() {
            return counted(&first.plan);
        }
        let estimated = Some(first.plan.estimate);
        let (spec, world, request) = (self.spec, self.world, self.request);
        plan_vehicle(spec, world, request, index, Vec::new(), &[], estimated)
    }

    /// A way at another time, at which it meets no one.
    fn at_another_time(
        &self,
        index: usize,
        avoids: &[usize],
        way: &VehiclePlan,
    ) -> Option<VehiclePlan> {
        let (spec, world, request) = (self.spec, self.world, self.request);
        let mut way = way.clone();
        // At the time that is looked for there is none.
        way.terms.collision = 0.0;
        let nearness = nearness(spec, self.request.margins_of(index));
        let is_apart = |plan: &VehiclePlan| {
            let flight = flight_of(spec, world, index, plan);
            self.tracks.near(&flight.track(), &nearness, 0).is_empty()
        };
        let plan = at_another_time(spec, world, request, index, &way, &is_apart)?;
        Some(VehiclePlan {
            avoids: avoids.to_vec(),
            ..plan
        })
    }

    /// The last draft of a chain is the plan of the next vehicle.
    pub(crate) fn accept(&mut self, mut chain: Vec<Draft>) {
        let Some(last) = chain.pop() else {
            return;
        };
        let mut plan = last.plan;
        let mut add = |other: &VehiclePlan| {
            plan.evaluations += other.evaluations;
            plan.plans += other.plans;
        };
        for draft in &chain {
            add(&draft.plan);
        }
        let begins_anew = !chain.first().map_or(last.kept, |first| first.kept);
        if let Some(old) = self.previous.get(self.plans.len()).filter(|_| begins_anew) {
            add(old);
        }
        self.plans.push(plan);
        self.flights.push(last.flight);
        self.is_new.push(!last.kept);
        self.tracks.extend([last.track]);
    }
}

/// The same at several times the distances.
fn wider(nearness: &Nearness) -> Nearness {
    /// Far enough that a way around others seldom meets more.
    const TIMES: f64 = 4.0;
    Nearness {
        distance_m: TIMES * nearness.distance_m,
        vertical_m: nearness.vertical_m.map(|vertical_m| TIMES * vertical_m),
        ..*nearness
    }
}

/// A plan whose effort is counted elsewhere.
fn counted(plan: &VehiclePlan) -> VehiclePlan {
    VehiclePlan {
        evaluations: 0,
        plans: 0,
        ..plan.clone()
    }
}
