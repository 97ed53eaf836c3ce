//! What vehicles stay out of, and the files that hold it.

mod attached;
mod zone;

pub(super) use attached::read;
pub use attached::{AttachedFile, Survey};
pub use zone::Zone;
