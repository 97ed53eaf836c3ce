//! Sortie turns one geodetic mission spec into verified, collision-free MAVLink
//! missions for a whole fleet of UAVs.
//!
//! ```text
//! spec -> local ENU frame -> multiple swarm fruit fly optimisation (MSFOA) per vehicle, in priority order -> sampled path -> MISSION_ITEM_INT
//!      -> re-verified from the encoded integers -> .waypoints / .plan files, review, upload over MAVLink
//! ```
//!
//! A [`Mission`] is read or built, [`plan`](fn@plan)ned, [`verify`](fn@verify)ed and
//! [`upload`]ed; [`guide::library`] has an example of each step. The [`guide`] explains specs, planning,
//! review, upload and flight; its glossary has the terms.
//!
//! # Stability
//!
//! The functions and types at the root of the crate keep their meaning within a minor version.
//! **The modules are internal**: they are public for the program, the tests and the curious, and may change in any
//! version.
//!
//! # Layers
//!
//! Each folder is one noun and imports only from folders of lower layers
//! (`tests/layering.rs` holds it):
//!
//! | layer | folder | owns |
//! |---|---|---|
//! | 0 | [`numeric`] | seeds and streams, B-spline basis, plane and space-time geometry |
//! | 1 | [`autopilot`] | facts by autopilot, airframe and version: acceptance, capacities, modes, parameters, measured behaviour |
//! | 1 | [`geodesy`] | WGS84, ECEF, local ENU frame, EGM96 geoid, altitude references |
//! | 1 | [`optimize`] | the trait `Problem`, evaluation budgets, one file per algorithm |
//! | 1 | [`shapes`] | bytes of airspace files to polygons, circles, lines with floors, ceilings, times |
//! | 2 | [`spec`] | YAML as typed, then checked: an immutable [`spec::MissionSpec`] |
//! | 3 | [`world`] | terrain and its readers, threats, zones, area |
//! | 4 | [`path`] | control points to a sampled, timed trajectory; turn and climb limits |
//! | 5 | [`cost`] | the objective: named terms, weights, the fast kernel and its reference |
//! | 6 | [`plan`](mod@plan) | one vehicle's search problem; the fleet in priority order; why there is no path |
//! | 7 | [`mission`] | mission items, path to items, acceptance |
//! | 7 | [`tasks`] | tasks to stops of vehicles: who does what, in which order |
//! | 8 | [`formats`] | `.waypoints`, `.plan`, KML, GeoJSON, parameter files |
//! | 8 | [`verify`](mod@verify) | limits, margins, the verdict on encoded missions in continuous time |
//! | 9 | [`dispatch`] | plan, encode, verify, repair, in bounded rounds |
//! | 9 | [`link`] | sans-IO upload and download, codec, sockets |
//! | 10 | [`simulator`] | the simulated vehicle |
//! | 10 | [`report`] | HTML, SVG and JSON from facts handed to it |
//! | 11 | [`flight`] | launch, session, record, conformance, new paths in flight |
//! | 11 | [`study`] | the paper's experiment, planner and fleet studies |
//! | 12 | `library` | the functions at the root of the crate |
//! | 13 | [`cli`] | arguments, progress, printing, exit codes |
//!
//! # Units
//!
//! SI and radians inside, with the unit as a suffix of the name. Degrees, always as `_deg`, are latitudes and
//! longitudes everywhere, keys, parameters of autopilots, and what people read.
//! An altitude never travels without its reference: see [`geodesy::Amsl`].

pub mod guide;

pub mod numeric;

pub mod autopilot;
pub mod geodesy;
pub mod optimize;
pub mod shapes;

pub mod spec;

pub mod world;

pub mod path;

pub mod cost;

pub mod plan;

pub mod mission;
pub mod tasks;

pub mod formats;
pub mod verify;

pub mod dispatch;
pub mod link;

pub mod report;
pub mod simulator;

pub mod flight;
pub mod study;

pub mod cli;

mod library;

pub use dispatch::{Dispatched, Stage};
pub use library::{
    Mission, UploadError, files, improve, plan, plan_with, upload, upload_with, verify,
};
pub use link::{Progress, TransferReport};
pub use mission::VehicleMission;
pub use spec::{SpecError, keys};
pub use verify::{Limit, Margin, Review};

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
