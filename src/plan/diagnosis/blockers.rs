//! Reasons why no path was found for a vehicle.

use rayon::prelude::*;

use super::blocking_set::BlockingSets;
use super::relaxations::relaxations;
use crate::cost::Margins;
use crate::numeric::tracks::Tracks;
use crate::path::Flight;
use crate::plan::fleet::{Planning, Request, nearness};
use crate::plan::{BlockingElement, FleetPlan, Relaxation, VehiclePlan};
use crate::spec::MissionSpec;
use crate::world::World;

/// Vehicles for which relaxations are tried, at most: each costs a dozen searches.
const MAX_TRIED: usize = 2;

/// Why no path was found.
enum Reason {
    /// These earlier vehicles: alone it would have one.
    Others(Vec<usize>),
    /// It has none alone either.
    Itself,
}

impl FleetPlan {
    /// Says of every vehicle whose path breaks a limit, though nothing is known to close every way, which
    /// earlier vehicles are the reason; else, of the first few, what it would have a path with.
    ///
    /// None of the earlier ones is the reason if it breaks a limit alone too; else those that
    /// its path comes too near to are. If it keeps apart from them by breaking another limit,
    /// those that its way alone would meet. `at_first` are the margins that plans are made
    /// with before any verification.
    pub fn name_blockers(
        &mut self,
        spec: &MissionSpec,
        world: &World,
        request: &Request<'_>,
        at_first: &[Margins],
    ) {
        let flights = self.flights(spec, world);
        let mut tracks = Tracks::new(&nearness(spec, Margins::default()));
        tracks.extend(flights.iter().map(Flight::track));
        let reasons: Vec<(usize, Reason)> = (self.vehicles.par_iter().enumerate())
            .filter(|(_, plan)| !plan.terms.is_clean() && plan.blocking_set.is_empty())
            .map(|(index, plan)| {
                let planning = Planning::new(spec, world, request);
                let reason = reason(planning, (index, plan), (&flights, &tracks));
                (index, reason)
            })
            .collect();
        let alone = reasons.iter().filter(|of| matches!(of.1, Reason::Itself));
        let tried: Vec<(usize, Option<Vec<Relaxation>>)> = alone
            .take(MAX_TRIED)
            .map(|&(index, _)| {
                let margins = at_first.get(index).copied().unwrap_or_default();
                (
                    index,
                    relaxations(spec, world, (request.seed, margins), index),
                )
            })
            .collect();
        for (index, relaxations) in tried {
            self.vehicles[index].relaxations = relaxations;
        }
        for (index, reason) in reasons {
            if let Reason::Others(others) = reason {
                self.vehicles[index].blocked_by = others;
            }
        }
    }

    /// Says of every vehicle whose path breaks a limit what closes every way, if it does.
    pub fn name_the_cut_off(&mut self, world: &World) {
        if self.vehicles.iter().all(|plan| plan.terms.is_clean()) {
            return;
        }
        let blocking_sets = BlockingSets::of(world);
        let broken = self.vehicles.par_iter_mut();
        broken
            .filter(|plan| !plan.terms.is_clean())
            .for_each(|plan| plan.blocking_set = closed(plan, &blocking_sets));
    }
}

/// What closes every way of one of the routes of a plan.
fn closed(plan: &VehiclePlan, blocking_sets: &BlockingSets) -> Vec<BlockingElement> {
    let ends = plan
        .routes
        .iter()
        .filter_map(|route| Some((route.path.first()?.point.at, route.path.last()?.point.at)));
    let found = ends.map(|(from, to)| blocking_sets.between(from, to));
    found
        .into_iter()
        .find(|closed| !closed.is_empty())
        .unwrap_or_default()
}

/// Why a vehicle has no path among the flights of all.
fn reason(
    planning: Planning<'_>,
    (index, plan): (usize, &VehiclePlan),
    (flights, tracks): (&[Flight], &Tracks),
) -> Reason {
    if index == 0 {
        return Reason::Itself;
    }
    let alone = planning.plan_alone(index, plan.estimate);
    if !alone.terms.is_clean() {
        return Reason::Itself;
    }
    let near = |own: &Flight, margins: Margins| {
        let mut near = tracks.near(&own.track(), &nearness(planning.spec, margins), 0);
        near.retain(|other| *other < index);
        near
    };
    let met = near(&flights[index], Margins::default());
    if plan.terms.collision > 0.0 && !met.is_empty() {
        return Reason::Others(met);
    }
    let alone = planning.flight(index, &alone);
    Reason::Others(near(&alone, planning.request.margins_of(index)))
}
