//! Verified trajectories as a document.

use schemars::JsonSchema;
use serde::Serialize;

use super::documents::{Place, place, rounded};
use crate::verify::{VerifiedSegment, VerifiedTrajectory};

/// The verified trajectories of a fleet.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TrajectoriesDocument {
    /// Version of Sortie.
    pub sortie: &'static str,
    /// In the order of the missions.
    pub vehicles: Vec<VehicleTrajectory>,
}

/// The verified trajectory of one vehicle.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct VehicleTrajectory {
    /// Id in the spec.
    pub id: String,
    /// By how much it may be early from its takeoff on, seconds.
    pub takeoff_early_s: Option<f64>,
    /// By how much it may be late from its takeoff on, seconds.
    pub takeoff_late_s: Option<f64>,
    /// Straight motions at constant velocity from takeoff to touchdown.
    pub segments: Vec<TrajectorySegment>,
}

/// One straight motion of a verified trajectory.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TrajectorySegment {
    /// Where and when it begins.
    pub from: Place,
    /// Where and when it ends; without a time for a stay for ever.
    pub to: Place,
    /// Whether the vehicle is there at these times; else it is judged in space alone.
    pub flown: bool,
    /// The trajectory is never further than this from the segment, metres.
    pub error_m: Option<f64>,
    /// For the separation the vehicle may be this far from it, metres.
    pub wide_m: Option<f64>,
    /// By how much the vehicle may be late here, for what is behind it, seconds.
    pub late_s: Option<f64>,
    /// By how much the vehicle may be early here, besides what it may be from its takeoff on, seconds.
    pub early_s: Option<f64>,
}

/// Decimals of metres and seconds.
const PER_UNIT: f64 = 1e4;

/// The document of verified trajectories.
#[must_use]
pub fn trajectories_json(trajectories: &[VerifiedTrajectory]) -> TrajectoriesDocument {
    let vehicle = |of: &VerifiedTrajectory| VehicleTrajectory {
        id: of.vehicle.clone(),
        takeoff_early_s: rounded(-of.takeoff_late_s.least, PER_UNIT),
        takeoff_late_s: rounded(of.takeoff_late_s.most, PER_UNIT),
        segments: of.segments.iter().map(segment).collect(),
    };
    TrajectoriesDocument {
        sortie: env!("CARGO_PKG_VERSION"),
        vehicles: trajectories.iter().map(vehicle).collect(),
    }
}

fn segment(of: &VerifiedSegment) -> TrajectorySegment {
    TrajectorySegment {
        from: place(&of.from),
        to: place(&of.to),
        flown: of.is_flown,
        error_m: rounded(of.error_m, PER_UNIT),
        wide_m: rounded(of.wide_m, PER_UNIT),
        late_s: rounded(of.late_s, PER_UNIT),
        early_s: rounded(of.early_s, PER_UNIT),
    }
}
