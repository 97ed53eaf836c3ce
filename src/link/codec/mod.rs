//! Bytes to messages and back: the only file that knows the crate `mavlink`.
//!
//! The crate finds the frames (MAVLink 1 and 2, resynchronising over garbage) and
//! knows every message's checksum seed. Payloads are read and written in `payload`
//! field by field, because the crate's generated types refuse enum values they do not
//! know, and a transfer must not die of a command from a newer autopilot.

mod decode;
mod encode;
#[cfg(test)]
mod tests;

pub use decode::Decoder;
pub use encode::Encoder;

/// Which MAVLink a frame is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// MAVLink 1: no mission types, so no fence and no rally points.
    One,
    /// MAVLink 2.
    Two,
}
