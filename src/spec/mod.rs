//! The mission spec: YAML as typed, then checked, SI and immutable.

mod issue;
mod model;

pub use issue::{Issue, SpecError};
pub use model::{
    Airframe, Algorithm, AltitudeReference, Area, Autopilot, EndPoint, Finish, Hill, Link,
    MissionOptions, MissionSpec, Objective, Placement, Planner, Rally, Separation, TerrainSource,
    Threat, Vehicle, Weights, Wind, Zone,
};
