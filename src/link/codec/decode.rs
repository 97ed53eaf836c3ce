//! Frames to messages.

use std::io::{self, Read};

use mavlink::dialects::ardupilotmega::MavMessage;
use mavlink::{MAVLinkMessageRaw, MavlinkReader};

use super::Version;
use crate::link::message::payload::read_payload;
use crate::link::message::{Address, Message};

/// Finds messages in the bytes of one peer, however they are cut.
///
/// Use one for each peer address, or fragments of different peers mix.
pub struct Decoder {
    reader: MavlinkReader<Feed>,
}

impl Default for Decoder {
    fn default() -> Self {
        Self {
            // Two of the longest frames; a fleet has many decoders.
            reader: MavlinkReader::with_capacity(560, Feed::default()),
        }
    }
}

impl Decoder {
    /// Takes bytes in.
    pub fn push(&mut self, bytes: &[u8]) {
        self.reader.get_mut().0.extend(bytes);
    }

    /// The next message that this project uses, with its sender.
    #[must_use]
    pub fn next_message(&mut self) -> Option<(Address, Message)> {
        loop {
            let frame = self.next_frame()?;
            if let Some(message) = frame.message {
                return Some((frame.from, message));
            }
        }
    }

    /// The next frame with a valid checksum, of any message.
    pub(in crate::link) fn next_frame(&mut self) -> Option<Frame> {
        loop {
            let raw = self.reader.read_any_raw_message::<MavMessage>().ok()?;
            let Ok(system) = u8::try_from(raw.system_id()) else {
                continue;
            };
            let (component, version, bytes) = match &raw {
                MAVLinkMessageRaw::V1(v1) => (v1.component_id(), Version::One, v1.raw_bytes()),
                MAVLinkMessageRaw::V2(v2) => (v2.component_id(), Version::Two, v2.raw_bytes()),
            };
            let number = match &raw {
                MAVLinkMessageRaw::V1(v1) => v1.sequence(),
                MAVLinkMessageRaw::V2(v2) => v2.sequence(),
            };
            return Some(Frame {
                from: Address { system, component },
                number,
                version,
                message: read_payload(raw.message_id(), raw.payload()),
                bytes: bytes.to_vec(),
            });
        }
    }
}

/// One received frame.
pub(in crate::link) struct Frame {
    pub(in crate::link) from: Address,
    /// Its number in the sequence of its sender.
    pub(in crate::link) number: u8,
    pub(in crate::link) version: Version,
    /// `None` for a message that this project does not use.
    pub(in crate::link) message: Option<Message>,
    pub(in crate::link) bytes: Vec<u8>,
}

/// Source of the reader; when empty, more bytes may follow.
#[derive(Default)]
struct Feed(std::collections::VecDeque<u8>);

impl Read for Feed {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.0.is_empty() {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        self.0.read(buffer)
    }
}
