//! What vehicles stay out of, and the files that hold it.

mod attached;
mod dome;
mod zone;

pub(super) use attached::read;
pub use attached::{AirspaceImport, AttachedFile};
pub(crate) use dome::{dome_layers, dome_of, zone_buffer_key, zone_buffer_m};
pub use zone::Zone;
