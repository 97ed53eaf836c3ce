//! Why a plan fails: the violations of each vehicle, its blocking set, and relaxations.

use std::fmt;

use super::ReviewInput;
use crate::plan::{FleetPlan, VehiclePlan, Violation, violations};
use crate::spec::{MissionSpec, Vehicle};
use crate::world::World;

/// Barriers of a blocking set that a sentence names.
const MAX_NAMED: usize = 6;

/// A vehicle without a path that keeps every limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Infeasibility {
    /// Id of the vehicle.
    pub vehicle: String,
    /// The limits that the best path found violates, with the worst place of each.
    pub violations: Vec<Violation>,
    /// Latitude and longitude of each violation, degrees.
    positions: Vec<(f64, f64)>,
    /// Whether the best path comes too near to an earlier vehicle.
    conflicts: bool,
    /// Ids of the earlier vehicles without which it would have a path.
    pub blocked_by: Vec<String>,
    /// The barriers that close every way (proven), by name.
    pub blocking_set: Vec<String>,
    /// Changes of the spec that each make a path possible; none if not looked for.
    pub relaxations: Option<Vec<String>>,
}

/// The vehicles without a path that keeps every limit of the objective, in the order of the
/// spec.
#[must_use]
pub fn infeasibilities(spec: &MissionSpec, world: &World, plan: &FleetPlan) -> Vec<Infeasibility> {
    let vehicles = spec.vehicles.iter().zip(&plan.vehicles);
    vehicles
        .filter(|(_, plan)| !plan.terms.is_clean())
        .map(|(vehicle, plan)| Infeasibility::new(spec, world, vehicle, plan))
        .collect()
}

/// Other departures with which a fleet that fails was found to pass, in words; none if there are none.
#[must_use]
pub fn departures_that_pass(spec: &MissionSpec, plan: &FleetPlan) -> Option<String> {
    let fleet = spec.vehicles.iter().zip(&plan.vehicles);
    let departing = fleet.filter_map(|(vehicle, plan)| {
        let at_s = plan.passes_departing_s?;
        Some(format!("{} at {at_s:.0} s", vehicle.id))
    });
    let all: Vec<String> = departing.collect();
    (!all.is_empty()).then(|| {
        format!(
            "the fleet passes with staggered departures: {} (depart_s; depart_window_s leaves the time to the planner)",
            listed(&all)
        )
    })
}

impl ReviewInput<'_> {
    /// Those of a failed plan. None if the review passes, which judges turns and ground less
    /// strictly than the objective.
    pub(super) fn infeasibilities(&self) -> Vec<Infeasibility> {
        let plan = self.plan.filter(|_| !self.review.passes());
        plan.map_or_else(Vec::new, |plan| {
            infeasibilities(self.spec, self.world, plan)
        })
    }
}

impl Infeasibility {
    fn new(spec: &MissionSpec, world: &World, vehicle: &Vehicle, plan: &VehiclePlan) -> Self {
        let violations = violations(spec, world, vehicle, plan);
        let others = plan.blocked_by.iter();
        let others = others.filter_map(|&other| spec.vehicles.get(other));
        let relaxations = plan.relaxations.as_ref();
        Self {
            vehicle: vehicle.id.clone(),
            positions: (violations.iter())
                .map(|violation| world.frame.from_plan(violation.at.at))
                .map(|place| (place.lat_deg, place.lon_deg))
                .collect(),
            violations,
            conflicts: plan.terms.collision > 0.0,
            blocked_by: others.map(|other| other.id.clone()).collect(),
            blocking_set: (plan.blocking_set.iter())
                .map(|element| element.name(spec))
                .collect(),
            relaxations: relaxations.map(|all| {
                all.iter()
                    .map(|relaxation| relaxation.words(vehicle))
                    .collect()
            }),
        }
    }

    /// What the best path violates.
    fn violated(&self) -> String {
        let violations = self.violations.iter().zip(&self.positions);
        let separation = self.conflicts.then_some("separation from earlier vehicles");
        let violated: Vec<String> = violations
            .map(|(of, (lat, lon))| {
                format!("{} ({}, worst at {lat:.5}, {lon:.5})", of.what, of.how)
            })
            .chain(separation.map(str::to_owned))
            .collect();
        violated.join("; ")
    }

    /// The reason, and what would help.
    fn reason(&self) -> String {
        if let [_, rest @ ..] = &self.blocked_by[..] {
            let are = if rest.is_empty() { "is" } else { "are" };
            let others = self.blocked_by.join(", ");
            return format!("; alone it would have one: {others} {are} in its way");
        }
        if !self.blocking_set.is_empty() {
            let mut closed = self.blocking_set.clone();
            let more = closed.len().saturating_sub(MAX_NAMED);
            closed.truncate(MAX_NAMED);
            closed.extend((more > 0).then(|| format!("{more} more")));
            return format!(
                "; there is none: every way is closed by {}",
                listed(&closed)
            );
        }
        match self.relaxations.as_deref() {
            None => String::new(),
            Some([]) => "; there may be none".to_owned(),
            Some(all) => format!("; one is found with {}", all.join(", or with ")),
        }
    }
}

impl fmt::Display for Infeasibility {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: no path was found from start to goal that keeps every limit; the best breaks {}{}",
            self.vehicle,
            self.violated(),
            self.reason()
        )
    }
}

/// Names with commas, and `and` before the last.
fn listed(names: &[String]) -> String {
    match names {
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => names.concat(),
    }
}
