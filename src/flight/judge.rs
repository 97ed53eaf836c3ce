//! What was flown against the plan and against the limits of the spec.

use super::end::End;
use super::limits::separation;
use super::record::{Fix, Flight, Record};
use super::reference::{Deviation, Reference, to_segment};
use super::report::{FlightReport, Passage, Spread, VehicleReport};
use crate::geodesy::{EastNorth, PlanPoint};
use crate::spec::{Airframe, MissionSpec};
use crate::verify::Margin;
use crate::world::World;

/// Around home and the place of landing the minimum height does not hold, metres.
const COLUMN_M: f64 = 25.0;
/// Between two positions this far apart in time nothing is known, seconds.
pub(super) const GAP_S: f64 = 5.0;

/// One vehicle's flight in planning coordinates.
pub(super) struct Trail<'a> {
    pub(super) flight: &'a Flight,
    /// Of each position: which of the plans it was flown by.
    plan_of: Vec<usize>,
    pub(super) airframe: Airframe,
    pub(super) points: Vec<PlanPoint>,
}

/// Judges a flight by its record. The world is that of the spec; threats that came up on
/// the way are added to it.
#[must_use]
pub fn judge(spec: &MissionSpec, world: &World, record: &Record) -> FlightReport {
    let flights = record.flights.iter();
    let trails: Vec<Trail<'_>> = flights.map(|f| Trail::new(f, spec, world)).collect();
    let mut margins: Vec<Margin> = trails
        .iter()
        .flat_map(|trail| trail.margins(spec, world, &record.popups))
        .collect();
    for (index, first) in trails.iter().enumerate() {
        for second in &trails[index + 1..] {
            margins.extend(separation(&spec.separation, world, first, second));
        }
    }
    FlightReport {
        vehicles: trails.iter().map(Trail::report).collect(),
        margins,
    }
}

impl<'a> Trail<'a> {
    pub(super) fn new(flight: &'a Flight, spec: &MissionSpec, world: &World) -> Self {
        let mut fleet = spec.vehicles.iter();
        let this = fleet.find(|vehicle| vehicle.id == flight.vehicle);
        let point = |fix: &Fix| PlanPoint {
            at: world.frame.to_plan(fix.place),
            amsl: fix.amsl,
        };
        Self {
            flight,
            plan_of: flight.plan_of_each(),
            airframe: this.map_or(Airframe::Copter, |vehicle| vehicle.airframe),
            points: flight.flown.fixes.iter().map(point).collect(),
        }
    }

    pub(super) fn id(&self) -> &str {
        &self.flight.vehicle
    }

    pub(super) fn fixes(&self) -> &[Fix] {
        &self.flight.flown.fixes
    }

    fn plan(&self, fix: usize) -> Option<&Reference> {
        let plan = *self.plan_of.get(fix)?;
        self.flight.plans.get(plan).map(|plan| &plan.reference)
    }

    /// Indices of positions on the route: neither in the column of the takeoff nor in that
    /// of the landing; of a plane, neither on its climb-out nor on its glide.
    pub(super) fn on_route(&self) -> impl Iterator<Item = usize> {
        let first = self.flight.plans.first().map(|plan| &plan.reference);
        let home = first.and_then(|plan| plan.waypoints.first().map(|w| w.point.at));
        (0..self.points.len()).filter(move |&index| {
            let at = self.points[index].at;
            let near = |place: Option<EastNorth>| {
                place.is_some_and(|place| place.distance_m(at) < COLUMN_M)
            };
            let plan = self.plan(index).filter(|plan| plan.lands);
            let end = plan.and_then(|plan| plan.waypoints.last().map(|w| w.point.at));
            match self.airframe {
                Airframe::Plane => !self.rises(index) && !self.glides(index),
                Airframe::Copter | Airframe::Vtol => {
                    !self.rises(index) && !near(home) && !near(end)
                }
            }
        })
    }

    /// Whether it is on its takeoff.
    pub(super) fn rises(&self, index: usize) -> bool {
        let first = self.flight.plans.first().map(|plan| &plan.reference);
        let takeoff = first.and_then(|plan| plan.waypoints.get(1));
        self.plan_of[index] == 0 && self.fixes()[index].item <= takeoff.map_or(0, |w| w.item)
    }

    /// Whether a plane is on the glide to its landing.
    pub(super) fn glides(&self, index: usize) -> bool {
        let plan = self.plan(index).filter(|plan| plan.lands);
        let last = plan.and_then(|plan| plan.waypoints.last());
        let glides = self.airframe == Airframe::Plane;
        glides && last.is_some_and(|last| self.fixes()[index].item >= last.item)
    }

    /// Where each waypoint of each plan was passed while it was flown.
    fn passages(&self) -> Vec<Passage> {
        let mut found = Vec::new();
        for (number, plan) in self.flight.plans.iter().enumerate() {
            let from = self.plan_of.partition_point(|&of| of < number);
            let to = self.plan_of.partition_point(|&of| of <= number);
            if from < to {
                found.extend(self.passages_of(&plan.reference, from, to));
            }
        }
        found
    }

    /// The nearest of the ways between two positions, one waypoint after the other.
    fn passages_of(&self, plan: &Reference, mut from: usize, to: usize) -> Vec<Passage> {
        let fixes = &self.fixes()[..to];
        let (begun, reached) = (from > 0, &self.flight.flown.reached);
        let (first_item, ends_s) = (fixes[from].item, fixes[to - 1].t_s);
        let mut found = Vec::new();
        for (index, waypoint) in plan.waypoints.iter().enumerate().skip(1) {
            if begun && waypoint.item < first_item {
                // Passed by the plan before.
                continue;
            }
            let next = plan.waypoints.get(index + 1).map_or(usize::MAX, |w| w.item);
            let mut best: Option<(f64, f64, usize)> = None;
            for at in from..fixes.len().saturating_sub(1) {
                if fixes[at].item > next {
                    break;
                }
                let (distance_m, share) =
                    to_segment(waypoint.point, self.points[at], self.points[at + 1]);
                if waypoint.radius_m > 0.0 && distance_m <= waypoint.radius_m {
                    // It comes to the rim of its circle here.
                    best = Some((0.0, fixes[at].t_s, at));
                    break;
                }
                let distance_m = (distance_m - waypoint.radius_m).max(0.0);
                if best.is_none_or(|(least, ..)| distance_m < least - 0.05) {
                    let t_s = fixes[at].t_s + share * (fixes[at + 1].t_s - fixes[at].t_s);
                    best = Some((distance_m, t_s, at));
                }
            }
            let was_reached = fixes[from..].iter().any(|fix| fix.item > waypoint.item)
                || reached
                    .iter()
                    .any(|&(item, t_s)| item == waypoint.item && t_s <= ends_s + GAP_S);
            if let Some((distance_m, flown_s, at)) = best.filter(|_| was_reached) {
                from = at;
                found.push(Passage {
                    item: waypoint.item,
                    planned_s: waypoint.t_s,
                    flown_s,
                    distance_m,
                });
            }
        }
        found
    }

    /// When each position on the route was how far from the plan.
    pub(super) fn deviations(&self) -> impl Iterator<Item = (f64, Deviation)> {
        self.on_route().filter_map(|index| {
            let fix = &self.fixes()[index];
            let of = self.plan(index)?.deviation(fix.item, self.points[index])?;
            Some((fix.t_s, of))
        })
    }

    fn report(&self) -> VehicleReport {
        let deviations: Vec<Deviation> = self.deviations().map(|(_, of)| of).collect();
        let end = &self.flight.flown.end;
        let lands = self.flight.plans.last().map(|plan| plan.reference.lands);
        let ended_as_planned = match end {
            End::Landed => lands == Some(true),
            End::Loitering => lands == Some(false),
            _ => false,
        };
        let spread = |of: fn(&Deviation) -> f64| Spread::of(deviations.iter().map(of).collect());
        VehicleReport {
            vehicle: self.id().to_owned(),
            end: end.words().to_owned(),
            ended_as_planned,
            fixes: self.fixes().len(),
            cross_track_m: spread(|deviation| deviation.cross_track_m),
            altitude_error_m: spread(|deviation| deviation.above_m.abs()),
            passages: self.passages(),
        }
    }
}
