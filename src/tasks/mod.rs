//! What a fleet does besides flying from start to goal: the order of stops, who does which job.

mod assignment;
mod order;
mod stops;

pub use assignment::{Assigned, Assignment, Carrier};
pub use order::{MAX_EXACT, Sequence, best_order};
pub use stops::{FreeOrder, free_orders, in_order};
