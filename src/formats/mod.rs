//! Files: written, and read back exactly.
//!
//! [`waypoints`] and [`plan`] hold missions and are read as well as written; what
//! each of them cannot keep is told by [`losses`]. Fence and rally [`lists`] are read
//! only; [`read`] reads any of them, whatever the name of the file. [`params`],
//! [`kml`] and [`geojson`] are maps for others to read, of a fleet and of one [`Drawing`].

mod any;
pub mod dat;
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

pub use any::{Kind, read};
pub use document::{Document, Repair, Spot};
pub use error::FormatError;
pub use files::{OutputError, sibling, write_file};
pub use losses::{Format, known_losses, losses};
pub use maps::drawing::Drawing;
pub use maps::{geojson, kml};
