//! Against the generated types of the crate `mavlink`, and against damage.

use mavlink::dialects::ardupilotmega as dialect;
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkReader};

use super::*;
use crate::link::MissionType;
use crate::link::message::payload::{read_payload, write_payload};
use crate::link::message::{
    Address, Body, Heartbeat, Message, MissionMessage, MissionResult, TEXT_BYTES, TextChunk,
};
use crate::mission::{Item, frame};

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
        mission_type: MissionType::Fence.mission_type(),
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
        Message::AutopilotVersion {
            capabilities: 4 | 8192,
            flight_software: 0x0406_03ff,
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
    all.push(Message::TextChunk(TextChunk {
        severity: 2,
        bytes: [b'x'; TEXT_BYTES],
        id: 515,
        seq: 3,
    }));
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
    let chunk = all().pop().expect("messages");
    let dialect::MavMessage::STATUSTEXT(text) = typed(&Encoder::new(US).encode(&chunk)) else {
        panic!("another message");
    };
    assert_eq!((text.id, text.chunk_seq), (515, 3));
    let frame = Encoder::new(US).encode(&all()[2]);
    let dialect::MavMessage::MISSION_CURRENT(data) = typed(&frame) else {
        panic!("another message");
    };
    assert_eq!((data.seq, data.total), (3, 9));
    let frame = Encoder::new(US).encode(&all()[4]);
    let dialect::MavMessage::AUTOPILOT_VERSION(version) = typed(&frame) else {
        panic!("another message");
    };
    assert_eq!(version.flight_sw_version, 0x0406_03ff);
    assert_eq!(
        version.capabilities,
        dialect::MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MISSION_INT
            | dialect::MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MAVLINK2
    );
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
            Message::TextChunk(chunk) => {
                expected = Message::of_text(chunk.severity, chunk.text());
            }
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
    let command = Item {
        x: 5,
        y: -7,
        ..Item::without_place(177, [1.0, 2.0, 0.0, 0.0])
    };
    for (sent, most) in [(place, 30), (command, 0)] {
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

/// A parameter's name and a text for people, of bytes that are neither.
#[test]
fn bytes_that_are_no_text_are_written_as_they_were_read() {
    for (id, length) in [(22, 25), (253, 51)] {
        let mut payload = vec![0xff; length];
        payload[10..14].copy_from_slice(b"\xc3(\xe2\x82");
        let read = read_payload(id, &payload).expect("a message that we know");
        let (_, written) = write_payload(&read);
        assert_eq!(read_payload(id, &written), Some(read));
    }
    let text = read_payload(253, b"\x06H\xf6he \xc3\xb6\0 and more");
    let expected = Message::StatusText {
        severity: 6,
        text: "H?he ö".to_owned(),
    };
    assert_eq!(text, Some(expected));
}
