//! The verified trajectory of a mission, with what the verdict allows around it: for comparisons
//! with flown tracks.

use crate::mission::VehicleMission;
use crate::path::takeoff_lateness_s;
use crate::spec::{MissionSpec, Span};
use crate::world::World;

use super::Moment;
use super::review::Sortie;

/// One straight motion at constant velocity of a verified trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerifiedSegment {
    /// Where and when it begins.
    pub from: Moment,
    /// Where and when it ends; the time of a stay for ever is infinite.
    pub to: Moment,
    /// Whether the vehicle is there at these times. Other segments are judged in space alone: the
    /// ends of legs at a corner, overshoots, lags, drift.
    pub is_flown: bool,
    /// The trajectory is never further than this from the segment, metres.
    pub error_m: f64,
    /// For the separation the vehicle may be this far from it, metres.
    pub wide_m: f64,
    /// By how much the vehicle may be late here, for the stops, legs and corners behind it, seconds.
    pub late_s: f64,
    /// By how much the vehicle may be early here, besides what it may be from its takeoff on, seconds.
    pub early_s: f64,
}

/// The verified trajectory of one vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct VerifiedTrajectory {
    /// Id of the vehicle.
    pub vehicle: String,
    /// By how much it may be early (negative) or late from its takeoff on, seconds.
    pub takeoff_late_s: Span,
    /// From takeoff to touchdown. Flown ones are in order of time.
    pub segments: Vec<VerifiedSegment>,
}

/// The trajectories that [`super::review`] judges the missions of a fleet by, in the order given.
#[must_use]
pub fn verified_trajectories(
    spec: &MissionSpec,
    world: &World,
    missions: &[(usize, &VehicleMission)],
) -> Vec<VerifiedTrajectory> {
    let known = missions.iter().filter_map(|&(index, mission)| {
        let (vehicle, sites) = (spec.vehicles.get(index)?, world.sites.get(index)?);
        let sortie = Sortie::new(spec, world, vehicle, sites, mission);
        let segments = sortie
            .flight
            .segments
            .iter()
            .map(|segment| VerifiedSegment {
                from: segment.moment(&world.frame, 0.0),
                to: segment.moment(&world.frame, 1.0),
                is_flown: segment.flown,
                error_m: segment.error_m,
                wide_m: segment.wide_m,
                late_s: segment.late_s,
                early_s: segment.early_s,
            });
        Some(VerifiedTrajectory {
            vehicle: vehicle.id.clone(),
            takeoff_late_s: takeoff_lateness_s(vehicle),
            segments: segments.collect(),
        })
    });
    known.collect()
}
