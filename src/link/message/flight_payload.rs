//! Payloads of the messages that command a vehicle and tell how it flies.

use super::flight::{Command, CommandResult, FlightMessage, LandedState, ParamValue, Position};
use super::payload::Payload;

/// Message ids of the common dialect.
mod id {
    pub(crate) const SYS_STATUS: u32 = 1;
    pub(crate) const SET_MODE: u32 = 11;
    pub(crate) const PARAM_REQUEST_READ: u32 = 20;
    pub(crate) const PARAM_VALUE: u32 = 22;
    pub(crate) const PARAM_SET: u32 = 23;
    pub(crate) const GLOBAL_POSITION_INT: u32 = 33;
    pub(crate) const MISSION_SET_CURRENT: u32 = 41;
    pub(crate) const MISSION_ITEM_REACHED: u32 = 46;
    pub(crate) const COMMAND_INT: u32 = 75;
    pub(crate) const COMMAND_LONG: u32 = 76;
    pub(crate) const COMMAND_ACK: u32 = 77;
    pub(crate) const EXTENDED_SYS_STATE: u32 = 245;
}

/// Bytes of a payload without the extensions of MAVLink 2.
pub(crate) fn length_1(id: u32) -> Option<u8> {
    Some(match id {
        id::SYS_STATUS => 31,
        id::SET_MODE => 6,
        id::PARAM_REQUEST_READ => 20,
        id::PARAM_VALUE => 25,
        id::PARAM_SET => 23,
        id::GLOBAL_POSITION_INT => 28,
        id::MISSION_SET_CURRENT => 4,
        id::MISSION_ITEM_REACHED | id::EXTENDED_SYS_STATE => 2,
        id::COMMAND_LONG => 33,
        id::COMMAND_ACK => 3,
        _ => return None,
    })
}

pub(crate) fn read(id: u32, mut read: Payload<'_>) -> Option<FlightMessage> {
    Some(match id {
        id::SYS_STATUS => {
            let _sensors_and_load: [u8; 14] = read.take();
            let voltage_mv = read.u16();
            let _current_and_errors: [u8; 14] = read.take();
            let [remaining] = read.take().map(|byte| i8::from_le_bytes([byte]));
            FlightMessage::Battery {
                voltage_mv,
                remaining,
            }
        }
        id::SET_MODE => {
            let custom_mode = read.u32();
            FlightMessage::SetMode {
                custom_mode,
                system: read.u8(),
                base_mode: read.u8(),
            }
        }
        id::PARAM_REQUEST_READ => {
            let _index = read.u16();
            FlightMessage::ParamRead {
                target: read.address(),
                name: read.text::<16>(),
            }
        }
        id::PARAM_VALUE => {
            let bytes = read.take();
            let _count_and_index: [u8; 4] = read.take();
            FlightMessage::Param {
                name: read.text::<16>(),
                value: ParamValue {
                    bytes,
                    kind: read.u8(),
                },
            }
        }
        id::PARAM_SET => {
            let bytes = read.take();
            FlightMessage::ParamSet {
                target: read.address(),
                name: read.text::<16>(),
                value: ParamValue {
                    bytes,
                    kind: read.u8(),
                },
            }
        }
        id::GLOBAL_POSITION_INT => FlightMessage::Position(Position {
            boot_ms: read.u32(),
            x: read.i32(),
            y: read.i32(),
            amsl_mm: read.i32(),
            above_home_mm: read.i32(),
            velocity_cmps: [0; 3].map(|_: u8| i16::from_le_bytes(read.take())),
        }),
        id::MISSION_SET_CURRENT => {
            let seq = read.u16();
            let target = read.address();
            FlightMessage::SetCurrent { target, seq }
        }
        id::MISSION_ITEM_REACHED => FlightMessage::ItemReached { seq: read.u16() },
        id::COMMAND_INT | id::COMMAND_LONG => read_command(id, read),
        id::COMMAND_ACK => {
            let (command, result) = (read.u16(), CommandResult(read.u8()));
            let _progress_and_more: [u8; 5] = read.take();
            FlightMessage::CommandAck {
                target: read.address(),
                command,
                result,
            }
        }
        id::EXTENDED_SYS_STATE => {
            let _vtol = read.u8();
            FlightMessage::Landed(LandedState(read.u8()))
        }
        _ => return None,
    })
}

fn read_command(id: u32, mut read: Payload<'_>) -> FlightMessage {
    let mut params = [0.0_f32; 7];
    for (index, param) in params.iter_mut().enumerate() {
        *param = if id == id::COMMAND_INT && (4..6).contains(&index) {
            degrees(read.i32())
        } else {
            read.f32()
        };
    }
    let command = read.u16();
    let target = read.address();
    // COMMAND_INT has a frame here, and is never repeated under another number.
    let confirmation = if id == id::COMMAND_INT { 0 } else { read.u8() };
    FlightMessage::Command {
        target,
        order: Command {
            command,
            confirmation,
            params,
        },
    }
}

fn degrees(integer: i32) -> f32 {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "COMMAND_LONG is float by definition"
    )]
    let degrees = (f64::from(integer) / 1e7) as f32;
    degrees
}

pub(crate) fn write(message: &FlightMessage) -> (u32, Vec<u8>) {
    match message {
        FlightMessage::Command { target, order } => {
            let mut bytes: Vec<u8> = order.params.iter().flat_map(|p| p.to_le_bytes()).collect();
            bytes.extend(order.command.to_le_bytes());
            bytes.extend([target.system, target.component, order.confirmation]);
            (id::COMMAND_LONG, bytes)
        }
        FlightMessage::CommandAck {
            target,
            command,
            result,
        } => {
            let mut bytes = command.to_le_bytes().to_vec();
            bytes.push(result.0);
            bytes.extend([0; 5]);
            bytes.extend([target.system, target.component]);
            (id::COMMAND_ACK, bytes)
        }
        FlightMessage::SetMode {
            system,
            base_mode,
            custom_mode,
        } => {
            let mut bytes = custom_mode.to_le_bytes().to_vec();
            bytes.extend([*system, *base_mode]);
            (id::SET_MODE, bytes)
        }
        FlightMessage::SetCurrent { target, seq } => {
            let bytes = [seq.to_le_bytes(), [target.system, target.component]].concat();
            (id::MISSION_SET_CURRENT, bytes)
        }
        FlightMessage::ItemReached { seq } => {
            (id::MISSION_ITEM_REACHED, seq.to_le_bytes().to_vec())
        }
        FlightMessage::Position(position) => write_position(position),
        FlightMessage::Battery {
            voltage_mv,
            remaining,
        } => {
            let mut bytes = vec![0; 14];
            bytes.extend(voltage_mv.to_le_bytes());
            bytes.resize(30, 0);
            bytes.extend(remaining.to_le_bytes());
            (id::SYS_STATUS, bytes)
        }
        FlightMessage::Landed(state) => (id::EXTENDED_SYS_STATE, vec![0, state.0]),
        FlightMessage::ParamRead { target, name } => {
            let mut bytes = (-1_i16).to_le_bytes().to_vec();
            bytes.extend([target.system, target.component]);
            bytes.extend(name_bytes(name));
            (id::PARAM_REQUEST_READ, bytes)
        }
        FlightMessage::ParamSet {
            target,
            name,
            value,
        } => {
            let mut bytes = value.bytes.to_vec();
            bytes.extend([target.system, target.component]);
            bytes.extend(name_bytes(name));
            bytes.push(value.kind);
            (id::PARAM_SET, bytes)
        }
        FlightMessage::Param { name, value } => {
            let mut bytes = value.bytes.to_vec();
            // One parameter, of no index: it was asked for by name.
            bytes.extend([1, 0, 255, 255]);
            bytes.extend(name_bytes(name));
            bytes.push(value.kind);
            (id::PARAM_VALUE, bytes)
        }
    }
}

fn write_position(position: &Position) -> (u32, Vec<u8>) {
    let mut bytes = position.boot_ms.to_le_bytes().to_vec();
    let place = [
        position.x,
        position.y,
        position.amsl_mm,
        position.above_home_mm,
    ];
    bytes.extend(place.iter().flat_map(|value| value.to_le_bytes()));
    let velocity = position.velocity_cmps;
    bytes.extend(velocity.iter().flat_map(|value| value.to_le_bytes()));
    // The heading is not known.
    bytes.extend(u16::MAX.to_le_bytes());
    (id::GLOBAL_POSITION_INT, bytes)
}

/// At most 16 characters, ended by 0 if there are fewer.
fn name_bytes(name: &str) -> [u8; 16] {
    let mut bytes = [0; 16];
    bytes
        .iter_mut()
        .zip(name.bytes())
        .for_each(|(to, from)| *to = from);
    bytes
}

#[cfg(test)]
mod tests {
    use mavlink::dialects::ardupilotmega::MavMessage;
    use mavlink::{MavlinkReader, Message as _};

    use super::*;
    use crate::link::codec::{Decoder, Encoder, Version};
    use crate::link::message::{Address, Message};

    const US: Address = Address {
        system: 245,
        component: 190,
    };
    const TARGET: Address = Address {
        system: 7,
        component: 1,
    };

    fn all() -> Vec<FlightMessage> {
        let name = "WPNAV_SPEED_UP16".to_owned();
        let value = ParamValue::float(250.5);
        vec![
            FlightMessage::Command {
                target: TARGET,
                order: Command::new(Command::ARM_DISARM, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]),
            },
            FlightMessage::CommandAck {
                target: US,
                command: 400,
                result: CommandResult::DENIED,
            },
            FlightMessage::SetMode {
                system: 7,
                base_mode: 1,
                custom_mode: 0x0403_0201,
            },
            FlightMessage::SetCurrent {
                target: TARGET,
                seq: 300,
            },
            FlightMessage::ItemReached { seq: 300 },
            FlightMessage::Position(Position {
                boot_ms: 70_001,
                x: 363_000_001,
                y: -842_500_009,
                amsl_mm: 480_250,
                above_home_mm: 80_250,
                velocity_cmps: [1500, -20, 300],
            }),
            FlightMessage::Battery {
                voltage_mv: 12_600,
                remaining: 87,
            },
            FlightMessage::Landed(LandedState::IN_AIR),
            FlightMessage::ParamRead {
                target: TARGET,
                name: name.clone(),
            },
            FlightMessage::ParamSet {
                target: TARGET,
                name: name.clone(),
                value,
            },
            FlightMessage::Param { name, value },
        ]
    }

    #[test]
    fn every_message_comes_back_as_it_was_in_both_versions() {
        for version in [Version::One, Version::Two] {
            for message in all() {
                let mut expected = message.clone();
                if let (Version::One, FlightMessage::CommandAck { target, .. }) =
                    (version, &mut expected)
                {
                    // An extension of MAVLink 2.
                    *target = Address {
                        system: 0,
                        component: 0,
                    };
                }
                let frame = Encoder::new(US).encode_in(version, &Message::Flight(message));
                let mut decoder = Decoder::default();
                decoder.push(&frame);
                let found = decoder.next_message().map(|(_, message)| message);
                assert_eq!(found, Some(Message::Flight(expected)));
            }
        }
    }

    /// Against the generated code of the crate `mavlink`, which knows the dialect from its XML.
    #[test]
    fn the_fields_are_where_the_dialect_has_them() {
        let typed = |message: FlightMessage| {
            let frame = Encoder::new(US).encode(&Message::Flight(message));
            let (_, message) = MavlinkReader::new(&*frame)
                .read_any_message::<MavMessage>()
                .expect("a frame of the dialect");
            message
        };
        for message in all() {
            let (name, data) = {
                let read = typed(message);
                (read.message_name(), format!("{read:?}"))
            };
            let expected: &[&str] = match name {
                "COMMAND_LONG" => &[
                    "param1: 1.0",
                    "param7: 7.0",
                    "target_system: 7",
                    "ARM_DISARM",
                ],
                "COMMAND_ACK" => &["ARM_DISARM", "DENIED", "target_system: 245"],
                "SET_MODE" => &["custom_mode: 67305985", "target_system: 7"],
                "MISSION_SET_CURRENT" => &["seq: 300", "target_system: 7"],
                "MISSION_ITEM_REACHED" => &["seq: 300"],
                "GLOBAL_POSITION_INT" => &[
                    "time_boot_ms: 70001",
                    "lat: 363000001",
                    "lon: -842500009",
                    "alt: 480250",
                    "relative_alt: 80250",
                    "vx: 1500",
                    "vy: -20",
                    "vz: 300",
                    "hdg: 65535",
                ],
                "SYS_STATUS" => &["voltage_battery: 12600", "battery_remaining: 87"],
                "EXTENDED_SYS_STATE" => &["IN_AIR"],
                "PARAM_REQUEST_READ" => &["param_index: -1", "target_system: 7"],
                "PARAM_SET" => &["param_value: 250.5", "target_system: 7", "REAL32"],
                "PARAM_VALUE" => &["param_value: 250.5", "param_count: 1", "REAL32"],
                other => panic!("{other} was not written"),
            };
            for part in expected {
                assert!(data.contains(part), "{part} in {data}");
            }
        }
    }

    #[test]
    fn a_whole_number_of_px4_is_read_from_its_bytes() {
        let held = ParamValue {
            bytes: 2_i32.to_le_bytes(),
            kind: 6,
        };
        assert_eq!(held.value(true).to_bits(), 2_f32.to_bits());
        assert_eq!(held.with(-1.0, true).bytes, (-1_i32).to_le_bytes());
        let float = ParamValue::float(2.5);
        assert_eq!(float.value(true).to_bits(), 2.5_f32.to_bits());
        assert_eq!(float.with(-1.0, true).bytes, (-1_f32).to_le_bytes());
    }
}
