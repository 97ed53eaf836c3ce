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

/// The plan of a fleet with as few conflicts as were found, each vehicle on a variant of its path
/// alone. None where paths cannot be varied.
///
/// Without freedom of departures and speeds first, and then with it, the cheaper of both: so such
/// freedom makes no fleet dearer.
pub(super) fn resolved(
    spec: &MissionSpec,
    world: &World,
    seed: u64,
    alone: &[VehiclePlan],
) -> Option<FleetPlan> {
    if spec.planner.objective == Objective::Paper {
        return None;
    }
    let is_free = spec
        .vehicles
        .iter()
        .any(|vehicle| vehicle.retiming.depart_s.is_some() || vehicle.retiming.speed_mps.is_some());
    let mut best: Option<(FleetPlan, usize, f64)> = None;
    for retimes in [false, true] {
        if retimes && !is_free {
            break;
        }
        let mut conflicts = Conflicts::new((spec, world), alone, retimes)?;
        let rng = Seed(seed).stream("deconfliction", u64::from(retimes));
        let mut search = Search::new(&mut conflicts, rng);
        let Some((choice, left)) = search.run() else {
            continue;
        };
        let cost = search.cost(&choice);
        let is_better = |best: &(_, usize, f64)| left < best.1 || left == best.1 && cost < best.2;
        if best.as_ref().is_none_or(is_better) {
            let vehicles = plans(&mut search, &choice);
            best = Some((FleetPlan { seed, vehicles }, left, cost));
        }
    }
    best.map(|(plan, ..)| plan)
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
