//! Bytes to messages and back: the only file that knows the crate `mavlink`.
//!
//! The crate finds the frames (MAVLink 1 and 2, resynchronising over garbage) and knows
//! every message's checksum seed. [`super::message`] reads and writes the payloads,
//! because the crate's generated types reject enum values that they do not know.

mod decode;
mod encode;
#[cfg(test)]
mod tests;

pub use decode::Decoder;
pub(super) use decode::Frame;
pub use encode::Encoder;

/// MAVLink version of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// MAVLink 1: no mission types, so no fence and no rally points.
    One,
    /// MAVLink 2.
    Two,
}
