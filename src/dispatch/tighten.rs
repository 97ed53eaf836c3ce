//! What a failed verification asks of the next round of planning.

use std::collections::{BTreeSet, HashMap};

use crate::cost::Margins;
use crate::plan::FleetPlan;
use crate::spec::MissionSpec;
use crate::verify::{Margin, Review};
use crate::world::World;

/// Stricter margins and more samples for the next round.
#[derive(Clone, Debug)]
pub(super) struct Strictness {
    /// For each vehicle, how much stricter than its limits the search is.
    pub(super) margins: Vec<Margins>,
    /// For each vehicle, where along its spline the search looks besides the even samples.
    pub(super) parameters: Vec<Vec<f64>>,
}

/// Added to what was missing, so that the next round does not fail by a hair, metres.
const EXTRA_M: f64 = 1.0;
/// Least step of a margin that is a fraction.
const LEAST_FRACTION: f64 = 0.02;

impl Strictness {
    /// For the first round: waypoint legs may leave the path by the tolerance, so
    /// that much of everything that is a distance is kept in hand.
    pub(super) fn first(spec: &MissionSpec) -> Self {
        let tolerance_m = spec.mission.tolerance_m;
        let margins = Margins {
            clearance_m: tolerance_m,
            threat_m: tolerance_m,
            separation_m: Self::separation_m(spec),
            ..Margins::default()
        };
        let fleet = spec.vehicles.len();
        Self {
            margins: vec![margins; fleet],
            parameters: vec![Vec::new(); fleet],
        }
    }

    /// At first.
    fn separation_m(spec: &MissionSpec) -> f64 {
        2.0 * spec.mission.tolerance_m
    }

    /// Answers every failed margin that planning can mend; returns the vehicles that
    /// have to be planned again, in order of priority.
    pub(super) fn tighten(
        &mut self,
        spec: &MissionSpec,
        world: &World,
        plan: &FleetPlan,
        review: &Review,
    ) -> Vec<usize> {
        let ids: HashMap<&str, usize> = spec
            .vehicles
            .iter()
            .enumerate()
            .map(|(index, vehicle)| (vehicle.id.as_str(), index))
            .collect();
        let index = |id: &str| ids.get(id).copied();
        let mut again = BTreeSet::new();
        for margin in review.margins.iter().filter(|margin| !margin.ok) {
            // The vehicle of lower priority gives way.
            let other = margin.other.as_deref().and_then(index);
            let Some(vehicle) = index(&margin.vehicle).max(other) else {
                continue;
            };
            let waits = spec.vehicles[vehicle].retiming.depart_s.is_some();
            if mends(plan, vehicle, margin, waits) && self.answer(vehicle, margin, spec) {
                self.parameters[vehicle].extend(parameter_at(plan, vehicle, margin, world));
                again.insert(vehicle);
            }
        }
        again.into_iter().collect()
    }

    /// Whether a stricter search may mend this margin; if so, makes it stricter.
    fn answer(&mut self, vehicle: usize, margin: &Margin, spec: &MissionSpec) -> bool {
        let missing = -margin.slack();
        if !missing.is_finite() {
            return false;
        }
        let slack_s = spec.separation.time_slack_s;
        let margins = &mut self.margins[vehicle];
        // Mostly some metres are enough, and in a crowd a shift asks for too much.
        let are_metres_in_vain = margins.separation_m > Self::separation_m(spec);
        let beyond = margin
            .shift
            .filter(|shift| are_metres_in_vain && shift.worst_s.abs() > slack_s + margins.shift_s);
        let shifted_s = beyond.map(|shift| shift.most_s());
        let fraction = (1.2 * missing / margin.limit.abs().max(1e-9)).clamp(LEAST_FRACTION, 0.2);
        match margin.what.split(' ').next().unwrap_or_default() {
            "terrain" | "ceiling" => margins.clearance_m += missing + EXTRA_M,
            "threat" | "zone" | "area" | "fence" => margins.threat_m += missing + EXTRA_M,
            "separation" => match shifted_s {
                Some(most_s) => margins.shift_s = most_s - slack_s,
                None => margins.separation_m += missing + EXTRA_M,
            },
            "climb" | "descent" => {
                margins.climb_fraction = (margins.climb_fraction + fraction).min(0.6)
            }
            "turn" => margins.turn_fraction += fraction,
            _ => return false,
        }
        true
    }
}

/// Whether a stricter search can help at all: not where it has not even kept the
/// limit itself, and not before the planned path begins, unless the vehicle can wait.
fn mends(plan: &FleetPlan, vehicle: usize, margin: &Margin, waits: bool) -> bool {
    let plan = &plan.vehicles[vehicle];
    let begins_s = plan
        .routes
        .first()
        .and_then(|route| route.path.first())
        .map(|first| first.t_s);
    let on_route = margin
        .at
        .zip(begins_s)
        .is_none_or(|(at, begins_s)| at.t_s >= begins_s - 1.0);
    let kept = match margin.what.split(' ').next().unwrap_or_default() {
        "terrain" | "ceiling" => plan.terms.terrain,
        "threat" | "zone" | "area" | "fence" => plan.terms.threat,
        "separation" => plan.terms.collision,
        "climb" | "descent" => plan.terms.climb,
        "turn" => plan.terms.turn,
        _ => 0.0,
    } <= 0.0;
    (on_route || waits && margin.what == "separation") && kept
}

/// Where along the vehicle's spline a margin failed: the parameter of the nearest
/// point of its path, and its neighbours.
fn parameter_at(plan: &FleetPlan, vehicle: usize, margin: &Margin, world: &World) -> Vec<f64> {
    let Some(at) = margin.at else {
        return Vec::new();
    };
    let place = world.frame.to_plan(at.place);
    let paths = plan.vehicles[vehicle].routes.iter();
    let nearest = paths
        .flat_map(|route| {
            let last = route.path.len().saturating_sub(1).max(1);
            route
                .path
                .iter()
                .enumerate()
                .map(move |(index, timed)| (index, last, timed))
        })
        .min_by(|a, b| {
            a.2.point
                .at
                .distance_m(place)
                .total_cmp(&b.2.point.at.distance_m(place))
        });
    let Some((index, last, _)) = nearest else {
        return Vec::new();
    };
    #[expect(
        clippy::cast_precision_loss,
        reason = "a path has far fewer than 2^52 points"
    )]
    let parameter = index as f64 / last as f64;
    [-0.002, 0.0, 0.002]
        .iter()
        .map(|step| (parameter + step).clamp(0.0, 1.0))
        .collect()
}
