//! Files: written, and read back exactly.
//!
//! [`waypoints`] and [`plan`] hold missions and are read as well as written; what
//! each of them cannot keep is told by [`losses`]. [`params`], [`kml`] and
//! [`geojson`] are written for others to read.

mod document;
mod error;
pub mod geojson;
pub mod kml;
mod losses;
mod number;
pub mod params;
pub mod plan;
mod shape;
pub mod waypoints;

pub use document::{Document, Repair};
pub use error::FormatError;
pub use losses::{Format, known_losses, losses};
