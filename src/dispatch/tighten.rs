//! Which violated margins planning again can repair, and how much stricter it becomes for them.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use crate::cost::Margins;
use crate::path::TimedPoint;
use crate::plan::{FleetPlan, VehiclePlan};
use crate::spec::{MissionSpec, TerrainSource, Vehicle};
use crate::verify::{Limit, Margin, Repair, Review};
use crate::world::World;

/// Buffers and additional samples of the next round.
#[derive(Clone, Debug)]
pub(super) struct Strictness {
    /// By vehicle: how much stricter than its limits the search is.
    pub(super) margins: Vec<Margins>,
    /// By vehicle: spline parameters that the search samples besides the even ones.
    pub(super) parameters: Vec<Vec<f64>>,
    /// By pair: what was missing of their separation, metres, and how many rounds one after the
    /// other then left nearly as much.
    missing: BTreeMap<(usize, usize), (f64, usize)>,
}

/// Added to a missing distance, so that the next round does not fail by rounding, metres.
const EXTRA_M: f64 = 1.0;
/// The same where little of a separation is missing.
const MIN_EXTRA_M: f64 = 0.1;
/// So little of a separation is found without a time shift, metres.
const SLIGHT_M: f64 = 0.5;
/// A round leaves nearly as much as was missing where it is more than this share of it.
const NEARLY: f64 = 0.9;
/// So much of a separation is missing, as a share of it, where how far vehicles stray is the reason.
const MAX_MISSING: f64 = 0.5;
/// Rounds that leave nearly as much of that, until greater distances are given up: searches with
/// those meet nearly every motion of the other, and take many times as long.
const MAX_FRUITLESS: usize = 2;
/// Buffer of copters in the first round, metres.
const NEAREST_M: f64 = 0.5;
/// Buffer where that leaves no way, metres.
const CLOSEST_M: f64 = 0.05;
/// Buffer of copters in the first round above ground that is not flat, where legs aside of the path are
/// higher or lower over it, metres.
const OVER_TERRAIN_M: f64 = 1.5;
/// The least that is added to a small buffer: height above ground costs all along the path.
const MIN_MORE_M: f64 = 0.25;
/// How many times greater a buffer from obstacles becomes where more was not enough before, up to the
/// tolerance.
const GROWTH: f64 = 2.0;
/// How much further from its limits a path is moved that needs too many items.
const FURTHER: f64 = 2.0;
/// Least step of a margin that is a fraction.
const MIN_FRACTION: f64 = 0.02;
/// Greatest sum of the steps of the slope fraction.
const MAX_CLIMB_FRACTION: f64 = 0.6;

impl Strictness {
    /// For the first round. Where legs stay nearer to a path near its limits a part of the tolerance is
    /// enough as a buffer; else they may leave it by the tolerance, and for the distance of two vehicles
    /// both may.
    pub(super) fn first(spec: &MissionSpec) -> Self {
        let tolerance_m = spec.mission.tolerance_m;
        let margins = |vehicle: &Vehicle| {
            let margin_m = match spec.passes_limits_closely(vehicle) {
                true => tolerance_m.min(NEAREST_M),
                false => tolerance_m,
            };
            let ground_m = match spec.terrain {
                TerrainSource::Flat(_) => margin_m,
                _ => margin_m.max(tolerance_m.min(OVER_TERRAIN_M)),
            };
            Margins {
                clearance_m: ground_m,
                under_m: margin_m,
                threat_m: margin_m,
                separation_m: first_separation_m(spec),
                ..Margins::default()
            }
        };
        Self {
            margins: spec.vehicles.iter().map(margins).collect(),
            parameters: vec![Vec::new(); spec.vehicles.len()],
            missing: BTreeMap::new(),
        }
    }

    /// The same where hardly more than the limits is kept.
    pub(super) fn closest(spec: &MissionSpec) -> Self {
        let mut first = Self::first(spec);
        for margins in &mut first.margins {
            margins.clearance_m = margins.clearance_m.min(CLOSEST_M);
            margins.under_m = margins.under_m.min(CLOSEST_M);
            margins.threat_m = margins.threat_m.min(CLOSEST_M);
        }
        first
    }

    /// Becomes stricter for every violated margin that planning can repair. Returns the vehicles
    /// to plan again, in order of priority.
    pub(super) fn tighten(
        &mut self,
        spec: &MissionSpec,
        world: &World,
        plan: &FleetPlan,
        review: &Review,
    ) -> Vec<usize> {
        let ids: HashMap<&str, usize> = (spec.vehicles.iter().enumerate())
            .map(|(index, vehicle)| (vehicle.id.as_str(), index))
            .collect();
        let index = |id: &str| ids.get(id).copied();
        let mut again = BTreeSet::new();
        let before = self.margins.clone();
        for margin in review.margins.iter().filter(|margin| !margin.ok) {
            let Some(repair) = margin.limit.repair() else {
                if margin.limit == Limit::Encoding
                    && let Some(vehicle) = index(&margin.vehicle)
                    && self.move_away(vehicle, spec)
                {
                    again.insert(vehicle);
                }
                continue;
            };
            // The vehicle of lower priority gives way.
            let other = margin.other.as_deref().and_then(index);
            let Some(vehicle) = index(&margin.vehicle).max(other) else {
                continue;
            };
            if repair == Repair::Separation
                && let Some(other) = index(&margin.vehicle).min(other)
                && self.is_given_up((vehicle, other), margin)
            {
                continue;
            }
            let can_wait = spec.vehicles[vehicle].retiming.depart_s.is_some();
            let path = &plan.vehicles[vehicle];
            if can_repair(path, margin, repair, can_wait)
                && self.tighten_one(vehicle, margin, (repair, &before[vehicle]), spec)
            {
                self.parameters[vehicle].extend(parameters_at(path, margin, world));
                again.insert(vehicle);
            }
        }
        again.into_iter().collect()
    }

    /// Whether much of the separation of two is missing that greater distances did not make less.
    fn is_given_up(&mut self, pair: (usize, usize), margin: &Margin) -> bool {
        let missing_m = -margin.slack();
        let known = self.missing.entry(pair).or_insert((f64::INFINITY, 0));
        let is_as_much =
            missing_m > MAX_MISSING * margin.bound.abs() && missing_m > NEARLY * known.0;
        *known = (missing_m, if is_as_much { known.1 + 1 } else { 0 });
        known.1 >= MAX_FRUITLESS
    }

    /// Moves the path of a vehicle that needs too many items further from its limits, where legs may
    /// leave it by more; false where they may leave it by the tolerance.
    fn move_away(&mut self, vehicle: usize, spec: &MissionSpec) -> bool {
        let tolerance_m = spec.mission.tolerance_m;
        let margins = &mut self.margins[vehicle];
        let mut is_nearer = false;
        for margin_m in [
            &mut margins.clearance_m,
            &mut margins.under_m,
            &mut margins.threat_m,
        ] {
            is_nearer |= *margin_m < tolerance_m;
            *margin_m = margin_m.max((FURTHER * *margin_m).min(tolerance_m));
        }
        is_nearer
    }

    /// Makes the search of one vehicle stricter, unless the violation has no size.
    fn tighten_one(
        &mut self,
        vehicle: usize,
        margin: &Margin,
        (repair, before): (Repair, &Margins),
        spec: &MissionSpec,
    ) -> bool {
        let missing = -margin.slack();
        if !missing.is_finite() {
            return false;
        }
        let slack_s = spec.separation.time_slack_s;
        let tolerance_m = spec.mission.tolerance_m;
        let margins = &mut self.margins[vehicle];
        let fraction = (1.2 * missing / margin.bound.abs().max(1e-9)).clamp(MIN_FRACTION, 0.2);
        match repair {
            Repair::Clearance => {
                let more_m = missing + (0.5 * margins.clearance_m).clamp(MIN_MORE_M, EXTRA_M);
                margins.clearance_m = raised_m(margins.clearance_m, more_m, tolerance_m);
            }
            Repair::Height => {
                margins.under_m = raised_m(margins.under_m, missing + EXTRA_M, tolerance_m);
            }
            Repair::Obstacle => {
                // One path may break more limits at one place, which need no more together.
                let more_m = missing + (0.5 * before.threat_m).clamp(MIN_MORE_M, EXTRA_M);
                // The whole tolerance at once would close narrow streets.
                let again_m = (GROWTH * before.threat_m).min(tolerance_m);
                let raised_m = raised_m(before.threat_m, more_m, again_m);
                margins.threat_m = margins.threat_m.max(raised_m);
            }
            Repair::Separation => {
                // A greater distance is enough for most pairs, and a time shift costs more in a
                // dense fleet: the shift is for a pair that a greater distance did not separate.
                let was_tried = margins.separation_m > first_separation_m(spec);
                let is_beyond = |worst_s: f64| worst_s.abs() > slack_s + margins.shift_s;
                match margin.shift {
                    Some(shift) if was_tried && missing > SLIGHT_M && is_beyond(shift.worst_s) => {
                        margins.shift_s = shift.max_s() - slack_s;
                    }
                    // A metre more may take much longer to wait for than the one that is missing, so that
                    // what is added begins small, and doubles.
                    _ => {
                        let added_m = margins.separation_m - first_separation_m(spec);
                        let more_m = missing.max(added_m).clamp(MIN_EXTRA_M, EXTRA_M);
                        margins.separation_m += missing + more_m;
                    }
                }
            }
            Repair::Slope => {
                // A path may climb and descend too steeply: neither asks for more than the other has.
                let more = (before.climb_fraction + fraction).min(MAX_CLIMB_FRACTION);
                margins.climb_fraction = margins.climb_fraction.max(more);
            }
            Repair::Turn => margins.turn_fraction += fraction,
        }
        true
    }
}

/// A buffer with more, metres: no less than `again_m` where more was not enough before.
fn raised_m(margin_m: f64, more_m: f64, again_m: f64) -> f64 {
    let min_m = match margin_m > NEAREST_M {
        true => again_m,
        false => 0.0,
    };
    (margin_m + more_m).max(min_m)
}

/// Buffer between two vehicles in the first round, metres.
fn first_separation_m(spec: &MissionSpec) -> f64 {
    2.0 * spec.mission.tolerance_m
}

/// Whether a stricter search can repair a margin. It cannot where the plan violates the limit
/// itself, nor before the planned path begins, unless the vehicle can depart later.
fn can_repair(plan: &VehiclePlan, margin: &Margin, repair: Repair, can_wait: bool) -> bool {
    let first = plan.routes.first().and_then(|route| route.path.first());
    let is_on_route = margin
        .at
        .zip(first)
        .is_none_or(|(at, first)| at.t_s >= first.t_s - 1.0);
    let violation = match repair {
        Repair::Clearance | Repair::Height => plan.terms.terrain,
        Repair::Obstacle => plan.terms.threat,
        Repair::Separation => plan.terms.collision,
        Repair::Slope => plan.terms.climb,
        Repair::Turn => plan.terms.turn,
    };
    (is_on_route || can_wait && repair == Repair::Separation) && violation <= 0.0
}

/// Where a margin is violated: the spline parameter of the nearest point of the path, and its
/// neighbours.
fn parameters_at(plan: &VehiclePlan, margin: &Margin, world: &World) -> Vec<f64> {
    let Some(at) = margin.at else {
        return Vec::new();
    };
    let place = world.frame.to_plan(at.place);
    let away_m = |timed: &TimedPoint| timed.point.at.distance_m(place);
    let nearest = (plan.routes.iter())
        .flat_map(|route| {
            let last = route.path.len().saturating_sub(1).max(1);
            let points = route.path.iter().enumerate();
            points.map(move |(index, timed)| (index, last, timed))
        })
        .min_by(|a, b| away_m(a.2).total_cmp(&away_m(b.2)));
    let Some((index, last, _)) = nearest else {
        return Vec::new();
    };
    #[expect(
        clippy::cast_precision_loss,
        reason = "a path has far fewer than 2^52 points"
    )]
    let parameter = index as f64 / last as f64;
    [-0.002, 0.0, 0.002]
        .map(|step| (parameter + step).clamp(0.0, 1.0))
        .to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::Sense;

    #[test]
    fn distances_do_not_grow_where_as_much_is_missing_as_before() {
        let path = std::path::Path::new("missions/harbour.yaml");
        let text = include_str!("../../missions/harbour.yaml").to_owned();
        let spec = (crate::spec::SpecFile::parse(path, text).expect("a shipped mission")).spec;
        let flat = crate::world::Terrain::Flat(crate::geodesy::Amsl(0.0));
        let world = World::new(&spec, flat).expect("ground");
        let plan = FleetPlan {
            seed: 1,
            vehicles: vec![VehiclePlan::default(); spec.vehicles.len()],
        };
        let near = |value: f64| {
            let margin = Margin {
                other: Some(spec.vehicles[1].id.clone()),
                value,
                bound: 100.0,
                sense: Sense::AtLeast,
                ..Margin::unjudged(&spec.vehicles[0].id, Limit::Separation, "")
            };
            Review {
                margins: vec![margin],
                ..Review::default()
            }
        };
        let rounds = |values: [f64; 5]| {
            let mut strictness = Strictness::first(&spec);
            values.map(|value| {
                let again = strictness.tighten(&spec, &world, &plan, &near(value));
                again.len()
            })
        };
        assert_eq!(rounds([0.0; 5]), [1, 1, 0, 0, 0]);
        // Less and less is missing, or little.
        assert_eq!(rounds([0.0, 20.0, 40.0, 60.0, 80.0]), [1; 5]);
        assert_eq!(rounds([80.0; 5]), [1; 5]);
        let mut strictness = Strictness::first(&spec);
        for _ in 0..5 {
            strictness.tighten(&spec, &world, &plan, &near(0.0));
        }
        assert!(strictness.margins[1].separation_m < 3.0 * 100.0);
    }
}
