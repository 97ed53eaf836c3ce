//! Files: written, and read back exactly.
//!
//! [`waypoints`] and [`plan`] hold missions and are both read and written; [`losses`]
//! names what each of them cannot hold. Fence and rally [`lists`] are only read.
//! [`read`] detects the format from the content, not from the name of the file.
//! [`kml`] and [`geojson`] are maps of a fleet or of one [`Drawing`], for other programs;
//! [`params`] are parameter files and [`dat`] ArduPilot's terrain database.

pub mod dat;
mod detect;
mod document;
mod error;
mod files;
pub mod lists;
mod losses;
mod maps;
pub mod params;
pub mod plan;
mod text;
pub mod waypoints;

pub use detect::{Kind, read};
pub use document::{Document, Repair, SourceLocation};
pub use error::FormatError;
pub use files::{OutputError, sibling, write_file};
pub use losses::{Format, known_losses, losses};
pub use maps::drawing::Drawing;
pub use maps::{geojson, kml};
