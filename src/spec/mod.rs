//! The mission spec: YAML as typed, then checked, SI and immutable.

mod check;
mod file;
#[cfg(test)]
pub(crate) mod fixtures;
mod issue;
mod link;
mod model;
mod positions;
mod raw;
mod scenario;
mod table;
mod value_sources;
mod vehicle;

pub use file::{SpecFile, json_schema};
pub use issue::{Issue, SpecError};
pub use model::{
    Algorithm, AltitudeReference, Area, ELEVATION_ENDINGS, Hill, MOST_CONTROL_POINTS,
    MissionOptions, MissionSpec, Objective, OnLinkLoss, Planner, Rally, Separation,
    THREAT_RADIUS_M, TerrainSource, Threat, Weights, Wind, Zone,
};
pub use scenario::{Cylinder, Document, Mover, Peak, Scenario, Surface, Waves};
pub use table::TableFile;
pub use vehicle::{
    Airframe, ApproachLengths, Autopilot, EndPoint, Finish, GRAVITY_MPS2, Landing, Link, Placement,
    Retiming, Span, Vehicle, Wing, turn_radius_by_load_m,
};
