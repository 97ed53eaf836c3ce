//! Bytes to messages and back: the only file that knows the crate `mavlink`.
//!
//! The crate finds the frames (MAVLink 1 and 2, resynchronising over garbage) and
//! knows every message's checksum seed. Payloads are read and written here field
//! by field, because the crate's generated types refuse enum values they do not
//! know, and a transfer must not die of a command from a newer autopilot.

use std::io::{self, Read};

use mavlink::dialects::ardupilotmega::MavMessage;
use mavlink::{MAV_STX, MAV_STX_V2, MAVLinkMessageRaw, MavlinkReader, Message as _, calculate_crc};

use super::message::{Address, Body, Heartbeat, Message, MissionMessage, MissionResult};
use crate::mission::{Item, frame};

/// Message ids of the common dialect.
mod id {
    pub(super) const HEARTBEAT: u32 = 0;
    pub(super) const MISSION_ITEM: u32 = 39;
    pub(super) const MISSION_REQUEST: u32 = 40;
    pub(super) const MISSION_CURRENT: u32 = 42;
    pub(super) const MISSION_REQUEST_LIST: u32 = 43;
    pub(super) const MISSION_COUNT: u32 = 44;
    pub(super) const MISSION_CLEAR_ALL: u32 = 45;
    pub(super) const MISSION_ACK: u32 = 47;
    pub(super) const MISSION_REQUEST_INT: u32 = 51;
    pub(super) const MISSION_ITEM_INT: u32 = 73;
    pub(super) const HOME_POSITION: u32 = 242;
    pub(super) const STATUSTEXT: u32 = 253;
}

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

/// Bytes of a payload without the extensions of MAVLink 2.
fn length_1(id: u32) -> u8 {
    match id {
        id::HEARTBEAT => 9,
        id::STATUSTEXT => 51,
        id::HOME_POSITION => 52,
        id::MISSION_ITEM | id::MISSION_ITEM_INT => 37,
        id::MISSION_COUNT | id::MISSION_REQUEST | id::MISSION_REQUEST_INT => 4,
        id::MISSION_ACK => 3,
        _ => 2,
    }
}

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

    /// The next message that this project knows, with its sender.
    #[must_use]
    pub fn next_message(&mut self) -> Option<(Address, Message)> {
        loop {
            let frame = self.next_frame()?;
            if let Some(message) = frame.message {
                return Some((frame.from, message));
            }
        }
    }

    /// The next frame whose checksum is right, whether its message is known or not.
    pub(super) fn next_frame(&mut self) -> Option<Frame> {
        loop {
            let raw = self.reader.read_any_raw_message::<MavMessage>().ok()?;
            let Ok(system) = u8::try_from(raw.system_id()) else {
                continue;
            };
            let (component, version, bytes) = match &raw {
                MAVLinkMessageRaw::V1(v1) => (v1.component_id(), Version::One, v1.raw_bytes()),
                MAVLinkMessageRaw::V2(v2) => (v2.component_id(), Version::Two, v2.raw_bytes()),
            };
            return Some(Frame {
                from: Address { system, component },
                version,
                message: read_payload(raw.message_id(), raw.payload()),
                bytes: bytes.to_vec(),
            });
        }
    }
}

/// Which MAVLink a frame is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// MAVLink 1: no mission types, so no fence and no rally points.
    One,
    /// MAVLink 2.
    Two,
}

/// One frame as it came.
pub(super) struct Frame {
    pub(super) from: Address,
    pub(super) version: Version,
    /// `None` for a message that no transfer needs.
    pub(super) message: Option<Message>,
    pub(super) bytes: Vec<u8>,
}

/// What the reader reads from; empty means "later", not "the end".
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

/// A payload from its beginning; bytes that were cut off are zeros.
struct Payload<'a>(&'a [u8]);

impl Payload<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        let have = self.0.len().min(N);
        bytes[..have].copy_from_slice(&self.0[..have]);
        self.0 = &self.0[have..];
        bytes
    }

    fn u8(&mut self) -> u8 {
        let [byte] = self.take();
        byte
    }

    fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn i32(&mut self) -> i32 {
        i32::from_le_bytes(self.take())
    }

    fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    fn address(&mut self) -> Address {
        Address {
            system: self.u8(),
            component: self.u8(),
        }
    }
}

fn read_payload(id: u32, payload: &[u8]) -> Option<Message> {
    let mut read = Payload(payload);
    let message = match id {
        id::HEARTBEAT => {
            let custom_mode = read.u32();
            Message::Heartbeat(Heartbeat {
                kind: read.u8(),
                autopilot: read.u8(),
                base_mode: read.u8(),
                custom_mode,
                system_status: read.u8(),
            })
        }
        id::STATUSTEXT => {
            let severity = read.u8();
            let text: [u8; 50] = read.take();
            let end = text.iter().position(|&byte| byte == 0).unwrap_or(50);
            Message::StatusText {
                severity,
                text: String::from_utf8_lossy(&text[..end]).into_owned(),
            }
        }
        id::MISSION_CURRENT => {
            let (seq, total) = (read.u16(), read.u16());
            let _state_and_mode: [u8; 2] = read.take();
            Message::MissionCurrent {
                seq,
                total,
                opaque_ids: [read.u32(), read.u32(), read.u32()],
            }
        }
        id::HOME_POSITION => Message::HomePosition {
            x: read.i32(),
            y: read.i32(),
            amsl_mm: read.i32(),
        },
        _ => Message::Mission(read_mission(id, read)?),
    };
    Some(message)
}

fn read_mission(id: u32, mut read: Payload<'_>) -> Option<MissionMessage> {
    let (target, mission_type, body) = match id {
        id::MISSION_ITEM | id::MISSION_ITEM_INT => return Some(read_item(id, read)),
        id::MISSION_COUNT => {
            let count = read.u16();
            let (target, mission_type) = (read.address(), read.u8());
            let opaque_id = read.u32();
            (target, mission_type, Body::Count { count, opaque_id })
        }
        id::MISSION_ACK => {
            let target = read.address();
            let result = MissionResult(read.u8());
            let mission_type = read.u8();
            let opaque_id = read.u32();
            (target, mission_type, Body::Ack { result, opaque_id })
        }
        id::MISSION_REQUEST | id::MISSION_REQUEST_INT => {
            let seq = read.u16();
            let body = if id == id::MISSION_REQUEST {
                Body::Request { seq }
            } else {
                Body::RequestInt { seq }
            };
            (read.address(), read.u8(), body)
        }
        id::MISSION_REQUEST_LIST => (read.address(), read.u8(), Body::RequestList),
        id::MISSION_CLEAR_ALL => (read.address(), read.u8(), Body::ClearAll),
        _ => return None,
    };
    Some(MissionMessage {
        target,
        mission_type,
        body,
    })
}

/// `MISSION_ITEM` and `MISSION_ITEM_INT` differ only in the type of x and y.
fn read_item(id: u32, mut read: Payload<'_>) -> MissionMessage {
    let params = [read.f32(), read.f32(), read.f32(), read.f32()];
    let (x, y): ([u8; 4], [u8; 4]) = (read.take(), read.take());
    let z = read.f32();
    let (seq, command) = (read.u16(), read.u16());
    let target = read.address();
    let frame = read.u8();
    let current = read.u8();
    let autocontinue = read.u8() != 0;
    let mission_type = read.u8();
    let integer = |bytes| match id {
        id::MISSION_ITEM => from_float(frame, f32::from_le_bytes(bytes)),
        _ => i32::from_le_bytes(bytes),
    };
    let item = Item {
        command,
        frame,
        autocontinue,
        params,
        x: integer(x),
        y: integer(y),
        z,
    };
    let body = match id {
        id::MISSION_ITEM => Body::Item { seq, current, item },
        _ => Body::ItemInt { seq, current, item },
    };
    MissionMessage {
        target,
        mission_type,
        body,
    }
}

/// Integers per unit of the float: degrees are scaled, parameters of a command without a place are not.
fn scale(frame: u8) -> f64 {
    match frame::canonical(frame) {
        frame::GLOBAL | frame::GLOBAL_RELATIVE_ALT | frame::GLOBAL_TERRAIN_ALT => 1e7,
        _ => 1.0,
    }
}

fn from_float(frame: u8, value: f32) -> i32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "`as` saturates, and NaN becomes 0, as a receiver in C would want"
    )]
    let integer = (f64::from(value) * scale(frame)).round() as i32;
    integer
}

fn to_float(frame: u8, value: i32) -> f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "MISSION_ITEM is float by definition"
    )]
    let float = (f64::from(value) / scale(frame)) as f32;
    float
}

fn write_payload(message: &Message) -> (u32, Vec<u8>) {
    match message {
        Message::Heartbeat(heartbeat) => {
            let mut bytes = heartbeat.custom_mode.to_le_bytes().to_vec();
            bytes.extend([heartbeat.kind, heartbeat.autopilot, heartbeat.base_mode]);
            bytes.extend([heartbeat.system_status, 3]);
            (id::HEARTBEAT, bytes)
        }
        Message::StatusText { severity, text } => {
            let mut bytes = vec![*severity];
            bytes.extend(text.bytes().take(50));
            (id::STATUSTEXT, bytes)
        }
        Message::MissionCurrent {
            seq,
            total,
            opaque_ids,
        } => {
            let mut bytes = [seq.to_le_bytes(), total.to_le_bytes(), [0, 0]].concat();
            bytes.extend(opaque_ids.iter().flat_map(|id| id.to_le_bytes()));
            (id::MISSION_CURRENT, bytes)
        }
        Message::HomePosition { x, y, amsl_mm } => {
            let mut bytes = [x, y, amsl_mm].map(|value| value.to_le_bytes()).concat();
            // Local position and approach vector are 0; the attitude is "level".
            bytes.resize(24, 0);
            bytes.extend(1_f32.to_le_bytes());
            bytes.resize(52, 0);
            (id::HOME_POSITION, bytes)
        }
        Message::Mission(mission) => write_mission(mission),
    }
}

fn write_mission(mission: &MissionMessage) -> (u32, Vec<u8>) {
    let target = [mission.target.system, mission.target.component];
    let kind = mission.mission_type;
    match mission.body {
        Body::Count { count, opaque_id } => {
            let mut bytes = [count.to_le_bytes(), target].concat();
            bytes.push(kind);
            bytes.extend(opaque_id.to_le_bytes());
            (id::MISSION_COUNT, bytes)
        }
        Body::Ack { result, opaque_id } => {
            let mut bytes = vec![target[0], target[1], result.0, kind];
            bytes.extend(opaque_id.to_le_bytes());
            (id::MISSION_ACK, bytes)
        }
        Body::Request { seq } | Body::RequestInt { seq } => {
            let mut bytes = [seq.to_le_bytes(), target].concat();
            bytes.push(kind);
            let id = match mission.body {
                Body::Request { .. } => id::MISSION_REQUEST,
                _ => id::MISSION_REQUEST_INT,
            };
            (id, bytes)
        }
        Body::RequestList => (id::MISSION_REQUEST_LIST, vec![target[0], target[1], kind]),
        Body::ClearAll => (id::MISSION_CLEAR_ALL, vec![target[0], target[1], kind]),
        Body::Item { seq, current, item } => {
            let place = [item.x, item.y].map(|value| to_float(item.frame, value).to_le_bytes());
            let bytes = write_item(mission, seq, current, &item, place);
            (id::MISSION_ITEM, bytes)
        }
        Body::ItemInt { seq, current, item } => {
            let place = [item.x, item.y].map(i32::to_le_bytes);
            let bytes = write_item(mission, seq, current, &item, place);
            (id::MISSION_ITEM_INT, bytes)
        }
    }
}

fn write_item(
    mission: &MissionMessage,
    seq: u16,
    current: u8,
    item: &Item,
    place: [[u8; 4]; 2],
) -> Vec<u8> {
    let mut bytes: Vec<u8> = item.params.iter().flat_map(|p| p.to_le_bytes()).collect();
    bytes.extend(place.concat());
    bytes.extend(item.z.to_le_bytes());
    bytes.extend(seq.to_le_bytes());
    bytes.extend(item.command.to_le_bytes());
    bytes.extend([mission.target.system, mission.target.component]);
    bytes.extend([item.frame, current, u8::from(item.autocontinue)]);
    bytes.push(mission.mission_type);
    bytes
}

#[cfg(test)]
mod tests {
    use mavlink::dialects::ardupilotmega as dialect;
    use mavlink::{MAVLinkV2MessageRaw, MavHeader};

    use super::*;
    use crate::link::List;

    const US: Address = Address {
        system: 245,
        component: 190,
    };
    const TARGET: Address = Address {
        system: 7,
        component: 1,
    };

    fn item() -> Item {
        Item {
            command: 16,
            frame: frame::GLOBAL_RELATIVE_ALT,
            autocontinue: true,
            params: [1.5, -2.0, 3.25, f32::NAN],
            x: 363_000_001,
            y: -842_500_009,
            z: 80.25,
        }
    }

    fn mission(body: Body) -> Message {
        Message::Mission(MissionMessage {
            target: TARGET,
            mission_type: List::Fence.mission_type(),
            body,
        })
    }

    fn decode(bytes: &[u8]) -> Vec<Message> {
        let mut decoder = Decoder::default();
        decoder.push(bytes);
        std::iter::from_fn(|| decoder.next_message())
            .map(|(_, message)| message)
            .collect()
    }

    fn typed(bytes: &[u8]) -> dialect::MavMessage {
        let (_, message) = MavlinkReader::new(bytes)
            .read_any_message()
            .expect("a frame");
        message
    }

    /// One of each, without NaN so that they compare.
    fn all() -> Vec<Message> {
        let item = Item {
            params: [1.5, -2.0, 0.0, 0.0],
            ..item()
        };
        let mut all = vec![
            Message::Heartbeat(Heartbeat {
                kind: 2,
                autopilot: 12,
                base_mode: 128,
                custom_mode: 0x0102_0304,
                system_status: 4,
            }),
            Message::StatusText {
                severity: 4,
                text: "Mission upload timeout".to_owned(),
            },
            Message::MissionCurrent {
                seq: 3,
                total: 9,
                opaque_ids: [1, 0xdead_beef, 3],
            },
            Message::HomePosition {
                x: 363_000_000,
                y: -842_500_000,
                amsl_mm: -1500,
            },
        ];
        let (seq, current, result) = (258, 1, MissionResult(13));
        all.extend(
            [
                Body::Count {
                    count: 300,
                    opaque_id: 77,
                },
                Body::Request { seq },
                Body::RequestInt { seq },
                Body::ItemInt { seq, current, item },
                Body::Ack {
                    result,
                    opaque_id: 9,
                },
                Body::RequestList,
                Body::ClearAll,
            ]
            .map(mission),
        );
        all
    }

    #[test]
    fn every_message_comes_back_as_it_was() {
        for message in all() {
            let bytes = Encoder::new(US).encode(&message);
            let mut decoder = Decoder::default();
            decoder.push(&bytes);
            assert_eq!(decoder.next_message(), Some((US, message)));
            assert_eq!(decoder.next_message(), None);
        }
    }

    /// Against the generated code of the crate `mavlink`, which knows the dialect from its XML.
    #[test]
    fn the_fields_are_where_the_dialect_has_them() {
        let (seq, current) = (258, 1);
        let item = item();
        let frame = Encoder::new(US).encode(&mission(Body::ItemInt { seq, current, item }));
        let dialect::MavMessage::MISSION_ITEM_INT(data) = typed(&frame) else {
            panic!("another message");
        };
        assert_eq!((data.x, data.y, data.seq), (item.x, item.y, seq));
        assert_eq!(
            [data.param1, data.param2, data.param3].map(f32::to_bits),
            [1.5_f32, -2.0, 3.25].map(f32::to_bits)
        );
        assert!(data.param4.is_nan());
        assert_eq!(data.z.to_bits(), item.z.to_bits());
        assert_eq!(data.command, dialect::MavCmd::MAV_CMD_NAV_WAYPOINT);
        assert_eq!(data.frame, dialect::MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT);
        assert_eq!(
            data.mission_type,
            dialect::MavMissionType::MAV_MISSION_TYPE_FENCE
        );
        assert_eq!(
            (
                data.target_system,
                data.target_component,
                data.current,
                data.autocontinue
            ),
            (7, 1, 1, 1)
        );
        let result = MissionResult(13);
        let frame = Encoder::new(US).encode(&mission(Body::Ack {
            result,
            opaque_id: 0x0102_0304,
        }));
        let dialect::MavMessage::MISSION_ACK(data) = typed(&frame) else {
            panic!("another message");
        };
        assert_eq!(data.opaque_id, 0x0102_0304);
        assert_eq!(
            data.mavtype,
            dialect::MavMissionResult::MAV_MISSION_INVALID_SEQUENCE
        );
        let frame = Encoder::new(US).encode(&all()[2]);
        let dialect::MavMessage::MISSION_CURRENT(data) = typed(&frame) else {
            panic!("another message");
        };
        assert_eq!((data.seq, data.total), (3, 9));
        assert_eq!(
            [data.mission_id, data.fence_id, data.rally_points_id],
            [1, 0xdead_beef, 3]
        );
    }

    #[test]
    fn frames_are_found_however_the_bytes_are_cut_and_whatever_lies_between() {
        let mut encoder = Encoder::new(US);
        let mut bytes = vec![0xfd, 3, 9, 0xfe, 0x55];
        for message in all() {
            bytes.extend(encoder.encode(&message));
            bytes.extend([0xfe, 1, 2, 0xfd]);
        }
        // The last garbage looks like a beginning; what follows decides.
        bytes.extend([0; 300]);
        for size in 1..80 {
            let mut decoder = Decoder::default();
            let mut found = Vec::new();
            for chunk in bytes.chunks(size) {
                decoder.push(chunk);
                while let Some((_, message)) = decoder.next_message() {
                    found.push(message);
                }
            }
            assert_eq!(found, all(), "in pieces of {size}");
        }
    }

    #[test]
    fn a_damaged_frame_is_dropped_and_the_next_one_is_found() {
        let mut encoder = Encoder::new(US);
        let good = mission(Body::Request { seq: 4 });
        for at in 0..20 {
            let mut bytes = encoder.encode(&mission(Body::RequestInt { seq: 9 }));
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 0x10;
            }
            let is_whole = at >= bytes.len();
            bytes.extend(encoder.encode(&good));
            bytes.extend([0; 300]);
            let found = decode(&bytes);
            assert_eq!(found.len(), 1 + usize::from(is_whole), "byte {at}");
            assert_eq!(found.last(), Some(&good));
        }
    }

    #[test]
    fn unknown_enum_values_survive_where_the_generated_types_refuse_them() {
        let strange = Item {
            command: 59_999,
            frame: 200,
            params: [0.0; 4],
            ..item()
        };
        let (seq, current) = (1, 0);
        let message = mission(Body::ItemInt {
            seq,
            current,
            item: strange,
        });
        let bytes = Encoder::new(US).encode(&message);
        assert!(
            MavlinkReader::new(&*bytes)
                .read_any_message::<dialect::MavMessage>()
                .is_err()
        );
        assert_eq!(decode(&bytes), [message]);
        let result = MissionResult(200);
        let message = mission(Body::Ack {
            result,
            opaque_id: 0,
        });
        let bytes = Encoder::new(US).encode(&message);
        assert_eq!(decode(&bytes), [message]);
    }

    #[test]
    fn messages_of_no_interest_are_skipped() {
        let mut raw = MAVLinkV2MessageRaw::new();
        let header = MavHeader {
            system_id: 1,
            component_id: 1,
            sequence: 0,
        };
        raw.serialize_message(
            header,
            &dialect::MavMessage::ATTITUDE(dialect::ATTITUDE_DATA::default()),
        );
        let mut bytes = raw.raw_bytes().to_vec();
        let good = mission(Body::Request { seq: 4 });
        bytes.extend(Encoder::new(US).encode(&good));
        assert_eq!(decode(&bytes), [good]);
    }

    #[test]
    fn mavlink_1_frames_come_back_without_what_mavlink_1_has_not() {
        for message in all() {
            let mut expected = message.clone();
            match &mut expected {
                Message::Mission(mission) => {
                    mission.mission_type = 0;
                    if let Body::Count { opaque_id, .. } | Body::Ack { opaque_id, .. } =
                        &mut mission.body
                    {
                        *opaque_id = 0;
                    }
                }
                Message::MissionCurrent {
                    total, opaque_ids, ..
                } => (*total, *opaque_ids) = (0, [0; 3]),
                _ => {}
            }
            let frame = Encoder::new(US).encode_in(Version::One, &message);
            let mut decoder = Decoder::default();
            decoder.push(&frame);
            let found = decoder.next_frame().expect("a frame");
            assert_eq!((found.from, found.version), (US, Version::One));
            assert_eq!(found.message, Some(expected));
            assert_eq!(found.bytes, frame);
            assert!(
                MavlinkReader::new(&*frame)
                    .read_any_raw_message::<dialect::MavMessage>()
                    .is_ok()
            );
        }
    }

    #[test]
    fn mavlink_1_frames_are_read() {
        let mut raw = mavlink::MAVLinkV1MessageRaw::new();
        let header = MavHeader {
            system_id: 1,
            component_id: 1,
            sequence: 0,
        };
        let data = dialect::MISSION_REQUEST_INT_DATA {
            seq: 300,
            target_system: 245,
            target_component: 190,
            ..Default::default()
        };
        raw.serialize_message(header, &dialect::MavMessage::MISSION_REQUEST_INT(data));
        let expected = Message::Mission(MissionMessage {
            target: US,
            mission_type: 0,
            body: Body::RequestInt { seq: 300 },
        });
        assert_eq!(decode(raw.raw_bytes()), [expected]);
    }

    #[test]
    fn float_items_carry_degrees_only_where_the_frame_is_global() {
        let (seq, current) = (0, 0);
        let place = Item {
            params: [0.0; 4],
            ..item()
        };
        let bare = Item {
            x: 5,
            y: -7,
            ..Item::without_place(177, [1.0, 2.0, 0.0, 0.0])
        };
        for (sent, most) in [(place, 30), (bare, 0)] {
            let message = mission(Body::Item {
                seq,
                current,
                item: sent,
            });
            let bytes = Encoder::new(US).encode(&message);
            let [
                Message::Mission(MissionMessage {
                    body: Body::Item { item, .. },
                    ..
                }),
            ] = decode(&bytes)[..]
            else {
                panic!("one float item");
            };
            assert!((item.x - sent.x).abs() <= most && (item.y - sent.y).abs() <= most);
        }
    }
}
