//! Messages to frames.

use mavlink::dialects::ardupilotmega::MavMessage;
use mavlink::{MAV_STX, MAV_STX_V2, Message as _, calculate_crc};

use super::Version;
use crate::link::message::id::length_1;
use crate::link::message::payload::write_payload;
use crate::link::message::{Address, Message};

/// Writes frames (MAVLink 2, unsigned) in the name of one component, counting its sequence.
#[derive(Clone, Debug)]
pub struct Encoder {
    us: Address,
    sequence: u8,
}

impl Encoder {
    /// An encoder that signs as `us`.
    #[must_use]
    pub fn new(us: Address) -> Self {
        Self { us, sequence: 0 }
    }

    /// The frame of a message.
    #[must_use]
    pub fn encode(&mut self, message: &Message) -> Vec<u8> {
        self.encode_in(Version::Two, message)
    }

    /// The frame of a message for a vehicle that speaks this MAVLink. In MAVLink 1
    /// everything is about the mission: it has no `mission_type`.
    #[must_use]
    pub fn encode_in(&mut self, version: Version, message: &Message) -> Vec<u8> {
        let (id, payload) = write_payload(message);
        let frame = match version {
            Version::One => self.frame_1(id, payload),
            Version::Two => self.frame_2(id, payload),
        };
        self.sequence = self.sequence.wrapping_add(1);
        frame
    }

    fn frame_1(&self, id: u32, mut payload: Vec<u8>) -> Vec<u8> {
        let length = length_1(id);
        payload.resize(usize::from(length), 0);
        let [id0, ..] = id.to_le_bytes();
        let mut frame = vec![MAV_STX, length, self.sequence];
        frame.extend([self.us.system, self.us.component, id0]);
        frame.extend(payload);
        let crc = calculate_crc(&frame[1..], MavMessage::extra_crc(id));
        frame.extend(crc.to_le_bytes());
        frame
    }

    fn frame_2(&self, id: u32, mut payload: Vec<u8>) -> Vec<u8> {
        // MAVLink 2 cuts trailing zeros, but never the first byte.
        while payload.len() > 1 && payload.last() == Some(&0) {
            payload.pop();
        }
        let length = u8::try_from(payload.len()).expect("the longest payload here has 54 bytes");
        let [id0, id1, id2, _] = id.to_le_bytes();
        let mut frame = vec![MAV_STX_V2, length, 0, 0, self.sequence];
        frame.extend([self.us.system, self.us.component, id0, id1, id2]);
        frame.extend(payload);
        let crc = calculate_crc(&frame[1..], MavMessage::extra_crc(id));
        frame.extend(crc.to_le_bytes());
        frame
    }
}
