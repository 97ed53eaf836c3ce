//! Areas to cover, corridors and search patterns: which lines are flown over the ground, and what
//! is seen from them.

mod apart;
mod corridor;
mod coverage;
mod layout;
mod line;
mod profile;
mod survey;

pub use apart::far_apart;
pub use coverage::{Cell, Cells, Gap, Pass, gaps, seen_by};
pub use layout::{Layout, lay_out};
pub use line::SweepLine;
pub(super) use profile::{Sampled, lifted};
