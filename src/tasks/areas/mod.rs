//! Areas to cover, corridors and search patterns: which lines are flown over the ground, and what
//! is seen from them.

mod corridor;
mod layout;
mod profile;
mod seen;
mod survey;

pub use layout::{Layout, SweepLine, lay_out};
pub(super) use profile::{Sampled, lifted};
pub use seen::{Cell, Cells, Gap, Pass, gaps, seen_by};
