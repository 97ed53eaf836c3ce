//! How fast vehicles climb and descend, where no flag says so: on a leg that is steeper a wing is not
//! where the leg is, and a copter is slower than commanded.

use crate::cli::args::Limits;
use crate::mission::{VehicleMission, rate_parameters};
use crate::spec::MissionSpec;
use crate::verify::{Limit, Margin, Review, VerifiedSegment, verified_trajectories};
use crate::world::World;

/// A wing that comes to be off its legs by less keeps to them, metres.
const NEAR_M: f64 = 2.0;

/// A vehicle with its greatest climb and descent: by its parameters, or their defaults.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    vehicle: String,
    has_wing: bool,
    pub(super) climb_mps: f64,
    pub(super) descent_mps: f64,
    /// The parameters with these values.
    stated: String,
    /// How far it comes to be below its legs where they climb, and above where they descend, metres.
    below_m: f64,
    above_m: f64,
}

impl Rates {
    pub(super) fn of(vehicle: &str, mission: &VehicleMission) -> Option<Self> {
        let least = |names: &[&'static str]| {
            let all = names
                .iter()
                .filter_map(|&name| Some((mission.param_or_default_si(name)?, name)));
            all.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let [climb, descent] = rate_parameters(mission)?.map(least);
        let ((climb_mps, climb), (descent_mps, descent)) = (climb?, descent?);
        Some(Self {
            vehicle: vehicle.to_owned(),
            has_wing: mission.airframe.has_wing(),
            climb_mps,
            descent_mps,
            stated: format!("{climb} {climb_mps}, {descent} {descent_mps}"),
            below_m: 0.0,
            above_m: 0.0,
        })
    }

    /// Follows the altitudes of a flight as fast as it can.
    fn follow(&mut self, segments: &[VerifiedSegment]) {
        let mut at_m = None;
        for segment in segments.iter().filter(|segment| segment.is_flown) {
            let duration_s = segment.to.t_s - segment.from.t_s;
            if !duration_s.is_finite() {
                break;
            }
            let before_m = at_m.unwrap_or(segment.from.amsl.0);
            let (min_m, max_m) = (
                before_m - self.descent_mps * duration_s,
                before_m + self.climb_mps * duration_s,
            );
            let leg_m = segment.to.amsl.0;
            let reached_m = leg_m.max(min_m).min(max_m);
            self.below_m = self.below_m.max(leg_m - reached_m);
            self.above_m = self.above_m.max(reached_m - leg_m);
            at_m = Some(reached_m);
        }
    }

    /// Holds a margin of climb or descent against them.
    fn judge(&self, margin: &mut Margin) {
        let (bound_mps, off_m, side) = match margin.limit {
            Limit::ClimbSpeed => (self.climb_mps, self.below_m, "below"),
            _ => (self.descent_mps, self.above_m, "above"),
        };
        margin.bound = bound_mps;
        let is_slow = margin.value <= bound_mps;
        let is_near = self.has_wing && margin.value.is_finite() && off_m <= NEAR_M;
        margin.ok = is_slow || is_near;
        if !is_slow {
            margin.note = match self.has_wing {
                true => format!("it comes to be {off_m:.1} m {side} its legs"),
                false => "it is slower than commanded: when it is where is not known".to_owned(),
            };
        }
    }
}

/// Judges how fast vehicles climb and descend, where no flag says so. Returns what is assumed of
/// wings.
pub(crate) fn judge_rates(
    review: &mut Review,
    (spec, world): (&MissionSpec, &World),
    missions: &[(usize, &VehicleMission)],
    limits: &Limits,
) -> Vec<String> {
    let of = |(vehicle, mission): &(usize, &VehicleMission)| {
        Rates::of(&spec.vehicles[*vehicle].id, mission)
    };
    let mut all: Vec<Rates> = missions.iter().filter_map(of).collect();
    let wings: Vec<(usize, &VehicleMission)> = missions
        .iter()
        .filter(|(_, mission)| mission.airframe.has_wing())
        .copied()
        .collect();
    for flown in verified_trajectories(spec, world, &wings) {
        let wing = all.iter_mut().find(|wing| wing.vehicle == flown.vehicle);
        if let Some(wing) = wing {
            wing.follow(&flown.segments);
        }
    }
    for margin in &mut review.margins {
        let is_open = match margin.limit {
            Limit::ClimbSpeed => limits.climb.is_none(),
            Limit::DescentSpeed => limits.descent.is_none(),
            _ => false,
        };
        let found = all.iter().find(|of| of.vehicle == margin.vehicle);
        if let Some(of) = found.filter(|_| is_open) {
            of.judge(margin);
        }
    }
    let is_assumed = limits.climb.is_none() || limits.descent.is_none();
    let assumed = all.iter().filter(|of| of.has_wing && is_assumed);
    assumed
        .map(|wing| {
            format!(
                "{}: climbs and descends by {} (--climb, --descent)",
                wing.vehicle, wing.stated
            )
        })
        .collect()
}
