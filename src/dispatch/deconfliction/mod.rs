//! Conflict resolution over whole fleets: who flies which variant of its path, and when.
//!
//! Every vehicle has variants: the path that it would fly alone, at the departures and speeds
//! that the spec leaves open, and that path bent aside or raised. Each variant is encoded and
//! flown as the verdict flies it, so a conflict here is a conflict there, lateness included.
//!
//! Vehicles get variants one after the other. Where conflicts are left, those in conflict get
//! others, conflicts that last weighing more and more. Then groups of vehicles get new variants,
//! and shapes are drawn towards the path alone, as long as the fleet becomes cheaper.

mod conflicts;
mod moves;
mod search;
mod variants;

use crate::numeric::Seed;
use crate::plan::{FleetPlan, VehiclePlan};
use crate::spec::{MissionSpec, Objective};
use crate::world::World;

use conflicts::Conflicts;
use search::{Choice, Search};

/// Plans of a fleet with as few conflicts as were found, each vehicle on a variant of its path
/// alone, the best first. None where paths cannot be varied.
///
/// Without the freedoms of the spec and with them, departures and speeds, and another distance
/// in height: so that no freedom makes a fleet dearer.
pub(super) fn resolved(
    spec: &MissionSpec,
    world: &World,
    seed: u64,
    alone: &[VehiclePlan],
) -> Vec<FleetPlan> {
    if spec.planner.objective == Objective::Paper {
        return Vec::new();
    }
    let mut all = resolved_by_time((spec, world), seed, alone);
    if spec.separation.vertical_m.is_some() {
        let mut in_space = spec.clone();
        in_space.separation.vertical_m = None;
        all.extend(resolved_by_time((&in_space, world), seed, alone));
    }
    all.sort_by(|a, b| (a.left.cmp(&b.left)).then(a.cost.total_cmp(&b.cost)));
    all.into_iter().map(|found| found.plan).collect()
}

/// A plan, how many pairs are left in conflict, and what it costs.
struct Resolved {
    plan: FleetPlan,
    left: usize,
    cost: f64,
}

/// At the specified departures and speeds, and at those that the spec allows.
fn resolved_by_time(
    (spec, world): (&MissionSpec, &World),
    seed: u64,
    alone: &[VehiclePlan],
) -> Vec<Resolved> {
    let is_free = spec
        .vehicles
        .iter()
        .any(|vehicle| vehicle.retiming.depart_s.is_some() || vehicle.retiming.speed_mps.is_some());
    let mut all = Vec::new();
    for retimes in [false, true] {
        if retimes && !is_free {
            break;
        }
        let Some(mut conflicts) = Conflicts::new((spec, world), alone, retimes) else {
            break;
        };
        let rng = Seed(seed).stream("deconfliction", u64::from(retimes));
        let mut search = Search::new(&mut conflicts, rng);
        let Some((choice, left)) = search.run() else {
            continue;
        };
        let cost = search.cost(&choice);
        let vehicles = plans(&mut search, &choice);
        let plan = FleetPlan { seed, vehicles };
        all.push(Resolved { plan, left, cost });
    }
    all
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
