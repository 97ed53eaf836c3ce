//! Conflict resolution over whole fleets: who flies which variant of its path, and when.
//!
//! Every vehicle has variants: the path that it would fly alone, at the departures and speeds
//! that the spec leaves open, and that path bent aside or raised. Each variant is encoded and
//! flown as the verdict flies it, so a conflict here is a conflict there, lateness included.
//!
//! Vehicles get variants one after the other, or all by one rule. Where conflicts are left, those in conflict get
//! others, conflicts that last weighing more and more. Then groups of vehicles get new variants,
//! and shapes are drawn towards the path alone, as long as the fleet becomes cheaper.

mod collective;
mod conflicts;
mod improve;
mod moves;
mod search;
mod variants;

use rayon::prelude::*;

use crate::numeric::Seed;
use crate::plan::{FleetPlan, VehiclePlan};
use crate::spec::{MissionSpec, Objective};
use crate::world::World;

use conflicts::{Choice, Conflicts};
use search::Search;
pub(super) use variants::{Flight, Variants};

/// Plans of a fleet with as few conflicts as were found, each vehicle on a variant of its path
/// alone, the best first: one for each of the specs, which give the fleet more or fewer freedoms.
pub(super) fn resolved(
    specs: &[MissionSpec],
    world: &World,
    seed: u64,
    alone: &[VehiclePlan],
) -> Vec<FleetPlan> {
    let specs = specs.par_iter();
    let specs = specs.filter(|spec| spec.planner.objective != Objective::Paper);
    let found = specs.filter_map(|spec| resolved_with((spec, world), seed, alone));
    let mut all: Vec<Resolved> = found.collect();
    all.sort_by(|a, b| (a.left.cmp(&b.left)).then(a.cost.total_cmp(&b.cost)));
    all.into_iter().map(|found| found.plan).collect()
}

/// A plan, how many pairs are left in conflict, and what it costs.
struct Resolved {
    plan: FleetPlan,
    left: usize,
    cost: f64,
}

/// None where paths cannot be varied.
fn resolved_with(
    (spec, world): (&MissionSpec, &World),
    seed: u64,
    alone: &[VehiclePlan],
) -> Option<Resolved> {
    let mut fleet = spec.vehicles.iter();
    let retimes = fleet.any(|vehicle| vehicle.retiming.is_allowed());
    let mut conflicts = Conflicts::new((spec, world), alone)?;
    let rng = Seed(seed).stream("deconfliction", u64::from(retimes));
    let mut search = Search::new(&mut conflicts, rng);
    let (choice, left) = search.run()?;
    let cost = search.cost(&choice);
    let vehicles = plans(&mut search, &choice);
    let plan = FleetPlan { seed, vehicles };
    Some(Resolved { plan, left, cost })
}

/// The plans of a choice. A vehicle avoids those before it that its path alone would meet.
fn plans(search: &mut Search<'_, '_>, choice: &Choice) -> Vec<VehiclePlan> {
    let met = search.pairs(&vec![0; choice.len()]);
    let each = choice.iter().copied().enumerate();
    each.map(|(vehicle, variant)| VehiclePlan {
        avoids: met
            .iter()
            .filter(|(_, second)| *second == vehicle)
            .map(|(first, _)| *first)
            .collect(),
        ..search.conflicts.plan((vehicle, variant))
    })
    .collect()
}
