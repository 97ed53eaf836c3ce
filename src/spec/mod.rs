//! The mission spec: keys as a file has them, then checked, SI and immutable.
//!
//! [`SpecFile::parse`] or a [`Builder`] supplies the [`keys`]. `check` makes a [`MissionSpec`] of
//! them and reports every [`Issue`] at once, each with its path, line and column.
//!
//! # How to add a key
//!
//! A key is written in two places of the code. Its line of the guide (`src/guide/spec.md`) is written by hand;
//! `missions/schema.json` (`sortie schema`) and `src/guide/keys.md` (the test that holds it writes `target/keys.md`) are
//! made. A key of the spec itself is also listed in `MissionSpec::builder`, one of a struct without `Default` in
//! every literal of it. The two places:
//!
//! 1. Its struct in [`keys`]: name, type, `range`, and the doc comment that becomes its
//!    description. A key of a vehicle is an `Option`, with the attribute `required` if each vehicle
//!    must have one. The JSON Schema (`sortie schema`), the check of the range, the key in
//!    `fleet.defaults`, the column of a table and the builder follow from it.
//! 2. Its check and conversion into the model, in the file of `check` that has the struct: conditions beyond a
//!    range (`self.required`, `self.report`), the unit (SI), and the default. The field of the
//!    model stands in `model.rs` or `vehicle.rs`.
//!
//! Enums written as strings are one type for file and model: they derive `Deserialize` and `JsonSchema` with
//! `transform = words`. Issues are located by path, so a message needs no code of its own for
//! tables, grids and defaults. Do not use untagged or flattened enums: serde loses positions in
//! them.

mod airspace;
mod builder;
mod check;
mod file;
#[cfg(test)]
pub(crate) mod fixtures;
mod issue;
pub mod keys;
mod link;
mod model;
mod positions;
mod scenario;
mod table;
mod value_sources;
mod vehicle;
mod wind;

pub use crate::autopilot::{Airframe, Autopilot};
pub use airspace::{AirspaceImport, AttachedFile, Zone};
pub(crate) use airspace::{dome_of, zone_buffer_key, zone_buffer_m};
pub use builder::Builder;
pub use file::partial::{Incomplete, Known, KnownPlace, PlaceKind};
pub use file::{SpecFile, json_schema};
pub use issue::{Issue, SpecError};
pub use keys::{Action, AlarmKind, Answer, OnAlarm, Pattern, Who};
pub(crate) use model::BufferedLimit;
pub use model::{
    Algorithm, AltitudeReference, Area, Buffers, ELEVATION_ENDINGS, Hill, MAX_CONTROL_POINTS,
    MAX_TASKS, MissionOptions, MissionSpec, Objective, OnLinkLoss, Planner, Rally, SearchPattern,
    Sensor, Separation, Sweep, SweepShape, THREAT_RADIUS_M, Task, TerrainSource, Threat, Weights,
    elevation_command,
};
pub use scenario::{Cylinder, Document, Mover, Peak, Scenario, Surface, Waves};
pub use table::TableFile;
pub use vehicle::{
    ACTION_S, AltitudeLimits, ApproachLengths, Arrival, Capacity, EndPoint, Endurance, Energy,
    Finish, GRAVITY_MPS2, Landing, Link, MAX_STOPS, OnWay, Order, Placement, RELEASE_S, Retiming,
    Span, Stop, StopAction, TakeoffRegion, Vehicle, Wing, new_stop_ids, turn_radius_by_load_m,
    wait_less,
};
pub use wind::Wind;
