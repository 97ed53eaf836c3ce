//! Areas to cover, corridors and search patterns: which lines are flown over the ground, and what
//! is seen from them.

mod apart;
mod corridor;
mod layout;
mod line;
mod profile;
mod seen;
mod survey;

pub use apart::far_apart;
pub use layout::{Layout, lay_out};
pub use line::SweepLine;
pub(super) use profile::{Sampled, lifted};
pub use seen::{Cell, Cells, Gap, Pass, gaps, seen_by};
