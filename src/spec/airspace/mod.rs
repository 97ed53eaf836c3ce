//! What vehicles stay out of.

mod zone;

pub use zone::Zone;
