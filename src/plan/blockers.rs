//! Who is in the way of a vehicle for which no path was found.

use rayon::prelude::*;

use super::FleetPlan;
use super::cutoff::Parts;
use super::fleet::{Request, nearness};
use super::vehicle::plan_vehicle;
use crate::cost::Margins;
use crate::numeric::tracks::Tracks;
use crate::path::Flight;
use crate::spec::MissionSpec;
use crate::world::World;

impl FleetPlan {
    /// Says of every vehicle whose path breaks a limit which earlier ones are the reason: none
    /// if it breaks one alone too, else those that its path comes too near to. If it keeps
    /// apart from them by breaking another limit, those that its way alone would meet.
    pub fn name_blockers(&mut self, spec: &MissionSpec, world: &World, request: &Request<'_>) {
        self.name_the_cut_off(world);
        let flights = self.flights(spec, world);
        let mut tracks = Tracks::new(&nearness(spec, Margins::default()));
        tracks.extend(flights.iter().map(Flight::track));
        let blocked: Vec<(usize, Vec<usize>)> = self
            .vehicles
            .par_iter()
            .enumerate()
            .filter(|(index, plan)| *index > 0 && !plan.terms.is_clean() && !plan.cut_off)
            .map(|(index, plan)| {
                let estimated = Some(plan.estimate);
                let alone = plan_vehicle(spec, world, request, index, Vec::new(), &[], estimated);
                if !alone.terms.is_clean() {
                    return (index, Vec::new());
                }
                let near = |own: &Flight, margins: Margins| {
                    let mut near = tracks.near(&own.track(), &nearness(spec, margins), 0);
                    near.retain(|other| *other < index);
                    near
                };
                let met = near(&flights[index], Margins::default());
                if plan.terms.collision > 0.0 && !met.is_empty() {
                    return (index, met);
                }
                let margins = request.margins_of(index);
                let alone = super::fleet::flight_of(spec, world, index, &alone);
                (index, near(&alone, margins))
            })
            .collect();
        for (index, others) in blocked {
            self.vehicles[index].blocked_by = others;
        }
    }

    /// Says of every vehicle whose path breaks a limit whether there is any way to its goal.
    fn name_the_cut_off(&mut self, world: &World) {
        if self.vehicles.iter().all(|plan| plan.terms.is_clean()) {
            return;
        }
        let parts = Parts::of(world);
        for (plan, stations) in self.vehicles.iter_mut().zip(&world.stations) {
            let (start, goal) = (stations.start.at, stations.goal.at);
            plan.cut_off = !plan.terms.is_clean() && parts.are_apart(start, goal);
        }
    }
}
