//! Pages and documents from facts handed over.

mod certificate;
mod documents;
mod infeasibility;
mod map;
mod page;
mod scene;
mod trajectories;
mod words;

pub use certificate::{
    CertificateDocument, CertifiedRoute, CertifiedVehicle, certificate_document,
};
pub use documents::{
    CheckDocument, CheckedVehicle, ControlPoint, Cost, FleetCost, ImportEntry, IssueEntry, LeftOut,
    MarginEntry, PathPoint, Place, PlanDocument, PlannedVehicle, PlannedVehicles, ReviewDocument,
    TimingDocument, UploadDocument, UploadedVehicle, UsedEndurance, WrittenPlan, json_text,
    plan_json, review_json,
};
pub use infeasibility::{Infeasibility, departures_that_pass, infeasibilities};
pub use map::review_svg;
pub(crate) use page::BASE_STYLE;
pub use page::{flight_html, review_html};
pub use scene::{FlownError, FlownFacts, ServedFacts};
pub use trajectories::{
    TrajectoriesDocument, TrajectorySegment, VehicleTrajectory, trajectories_json,
};
pub use words::{END_AS_PLANNED, IN_WORDS, worst_first};

use crate::mission::VehicleMission;
use crate::plan::FleetPlan;
use crate::spec::MissionSpec;
use crate::verify::Review;
use crate::world::World;

/// The facts of a review.
#[derive(Clone, Copy, Debug)]
pub struct ReviewInput<'a> {
    /// The limits and the fleet.
    pub spec: &'a MissionSpec,
    /// The ground, the area and the obstacles.
    pub world: &'a World,
    /// The paths, if Sortie planned the missions.
    pub plan: Option<&'a FleetPlan>,
    /// The missions, each with the index of its vehicle in the spec.
    pub missions: &'a [(usize, &'a VehicleMission)],
    /// What `verify` found.
    pub review: &'a Review,
    /// The seed of the plan, if Sortie made it.
    pub seed: Option<u64>,
    /// SHA-256 of the spec file, hexadecimal.
    pub spec_sha256: &'a str,
    /// Version of Sortie.
    pub version: &'a str,
}

/// Colours of vehicles, for a light and for a dark background: distinct in the
/// common kinds of colour blindness (after Okabe and Ito 2008), and none is
/// the red of threats. More vehicles repeat them.
const COLOURS: [[&str; 2]; 8] = [
    ["#0067a5", "#56b4e9"],
    ["#c26a00", "#f0a93b"],
    ["#007a5a", "#2fc79a"],
    ["#a8418a", "#e08bc4"],
    ["#766600", "#efe04a"],
    ["#4b4fc4", "#a3a8ff"],
    ["#7b4a2a", "#cfa27c"],
    ["#3c4650", "#d4d9de"],
];
