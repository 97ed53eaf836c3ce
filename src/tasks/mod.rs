//! What a fleet does besides flying from start to goal: the order of stops, who does which task.

mod areas;
mod assignment;
mod fleet;
mod order;
mod stops;

pub use areas::{Cell, Cells, Gap, Layout, Pass, SweepLine, far_apart, gaps, lay_out, seen_by};
pub use assignment::{Assigned, Assignment, Carrier, Form, Job, Spent, Visit, Way};
pub use fleet::{AssignedTask, Assigner, FleetTasks, TaskLeft};
pub use order::{MAX_EXACT, Sequence, best_order};
pub use stops::{FreeOrder, free_orders, in_order, orders_in_time};
