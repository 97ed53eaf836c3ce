//! Payloads of the messages a transfer needs, field by field as the dialect orders
//! them on the wire: little endian, zeros at the end cut off.

use super::flight_payload;
use super::{Address, Body, Heartbeat, Message, MissionMessage, MissionResult};
use crate::mission::{Item, frame};

/// Message ids of the common dialect.
pub(crate) mod id {
    pub(in crate::link) const HEARTBEAT: u32 = 0;
    pub(in crate::link) const MISSION_ITEM: u32 = 39;
    pub(in crate::link) const MISSION_REQUEST: u32 = 40;
    pub(in crate::link) const MISSION_CURRENT: u32 = 42;
    pub(in crate::link) const MISSION_REQUEST_LIST: u32 = 43;
    pub(in crate::link) const MISSION_COUNT: u32 = 44;
    pub(in crate::link) const MISSION_CLEAR_ALL: u32 = 45;
    pub(in crate::link) const MISSION_ACK: u32 = 47;
    pub(in crate::link) const MISSION_REQUEST_INT: u32 = 51;
    pub(in crate::link) const MISSION_ITEM_INT: u32 = 73;
    pub(in crate::link) const AUTOPILOT_VERSION: u32 = 148;
    pub(in crate::link) const HOME_POSITION: u32 = 242;
    pub(in crate::link) const STATUSTEXT: u32 = 253;
}

/// A payload from its beginning; bytes that were cut off are zeros.
pub(crate) struct Payload<'a>(&'a [u8]);

impl Payload<'_> {
    pub(crate) fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        let have = self.0.len().min(N);
        bytes[..have].copy_from_slice(&self.0[..have]);
        self.0 = &self.0[have..];
        bytes
    }

    /// Text of at most so many bytes, ended by 0 if it is shorter. A byte that is no
    /// text becomes `?`: what is read is as long as what was sent.
    pub(crate) fn text<const N: usize>(&mut self) -> String {
        let bytes: [u8; N] = self.take();
        let mut text = String::new();
        let mut until_0 = bytes.split(|&byte| byte == 0);
        for chunk in until_0.next().unwrap_or_default().utf8_chunks() {
            text += chunk.valid();
            text.extend(chunk.invalid().iter().map(|_| '?'));
        }
        text
    }

    pub(crate) fn u8(&mut self) -> u8 {
        let [byte] = self.take();
        byte
    }

    pub(crate) fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.take())
    }

    pub(crate) fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    pub(crate) fn i32(&mut self) -> i32 {
        i32::from_le_bytes(self.take())
    }

    pub(crate) fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }

    pub(crate) fn address(&mut self) -> Address {
        Address {
            system: self.u8(),
            component: self.u8(),
        }
    }
}

pub(crate) fn read_payload(id: u32, payload: &[u8]) -> Option<Message> {
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
            Message::StatusText {
                severity,
                text: read.text::<50>(),
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
        id::AUTOPILOT_VERSION => {
            let capabilities = u64::from_le_bytes(read.take());
            let _uid: [u8; 8] = read.take();
            Message::AutopilotVersion {
                capabilities,
                flight_software: read.u32(),
            }
        }
        _ => match flight_payload::read(id, Payload(payload)) {
            Some(message) => Message::Flight(message),
            None => Message::Mission(read_mission(id, read)?),
        },
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

pub(crate) fn write_payload(message: &Message) -> (u32, Vec<u8>) {
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
        Message::AutopilotVersion {
            capabilities,
            flight_software,
        } => {
            let mut bytes = capabilities.to_le_bytes().to_vec();
            bytes.resize(16, 0);
            bytes.extend(flight_software.to_le_bytes());
            bytes.resize(60, 0);
            (id::AUTOPILOT_VERSION, bytes)
        }
        Message::Mission(mission) => write_mission(mission),
        Message::Flight(message) => flight_payload::write(message),
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
