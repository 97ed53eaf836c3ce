//! What vehicles stay out of, and the files that hold it.

mod attached;
mod dome;
mod zone;

pub(super) use attached::read;
pub use attached::{AttachedFile, Survey};
pub(crate) use dome::{dome_layers, dome_of};
pub use zone::Zone;
