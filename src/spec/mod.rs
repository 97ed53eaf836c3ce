//! The mission spec: YAML as typed, then checked, SI and immutable.

mod check;
mod file;
mod issue;
mod link;
mod model;
mod places;
mod raw;
mod scenario;

pub use file::{SpecFile, json_schema};
pub use issue::{Issue, SpecError};
pub use model::{
    Airframe, Algorithm, AltitudeReference, ApproachLengths, Area, Autopilot, ELEVATION_ENDINGS,
    EndPoint, Finish, GRAVITY_MPS2, Hill, Landing, Link, MissionOptions, MissionSpec, Objective,
    OnLinkLoss, Placement, Planner, Rally, Separation, TerrainSource, Threat, Vehicle, Weights,
    Wind, Wing, Zone, turn_radius_by_load_m,
};
pub use scenario::{Cylinder, Document, Mover, Peak, Scenario, Surface, Waves};
