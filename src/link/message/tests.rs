//! Flight messages against the generated types of the crate `mavlink`.

use mavlink::dialects::ardupilotmega::MavMessage;
use mavlink::{MavlinkReader, Message as _};

use super::flight::{Command, CommandResult, FlightMessage, LandedState, ParamValue, Position};
use super::health::{Health, SystemStatus};
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
            order: Command::new(
                Command::COMPONENT_ARM_DISARM,
                [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0],
            ),
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
        FlightMessage::TimeSync {
            target: TARGET,
            answer_ns: 70_001_000_000_000,
            asked_ns: -5,
        },
        FlightMessage::CameraTrigger { seq: 70_000 },
        FlightMessage::CameraFeedback {
            index: 7,
            x: 363_000_000,
            y: -842_500_000,
            amsl_m: 412.5,
        },
        FlightMessage::Position(Position {
            boot_ms: 70_001,
            x: 363_000_001,
            y: -842_500_009,
            amsl_mm: 480_250,
            above_home_mm: 80_250,
            velocity_cmps: [1500, -20, 300],
        }),
        FlightMessage::Health(Health::System(SystemStatus {
            present: 0x10_0001,
            enabled: 0x10_0001,
            healthy: 1,
            voltage_mv: 12_600,
            remaining: 87,
        })),
        FlightMessage::Health(Health::Gps {
            fix: 3,
            satellites: 11,
        }),
        FlightMessage::Health(Health::Battery {
            id: 1,
            remaining: 45,
            charge: 0,
        }),
        FlightMessage::Health(Health::Fence {
            is_breached: true,
            count: 2,
            kind: 3,
        }),
        FlightMessage::Health(Health::Ekf {
            variances: [0.25, 0.5, 0.75, 1.5],
            flags: 831,
        }),
        FlightMessage::Health(Health::Estimator {
            ratios: [0.25, 0.5, 0.75, 1.5],
            flags: 831,
        }),
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
            if let (
                Version::One,
                FlightMessage::CommandAck { target, .. } | FlightMessage::TimeSync { target, .. },
            ) = (version, &mut expected)
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
            "TIMESYNC" => &["tc1: 70001000000000", "ts1: -5", "target_system: 7"],
            "CAMERA_TRIGGER" => &["seq: 70000"],
            "CAMERA_FEEDBACK" => &[
                "lat: 363000000",
                "lng: -842500000",
                "alt_msl: 412.5",
                "img_idx: 7",
                "target_system: 0",
            ],
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
            "SYS_STATUS" => &[
                "onboard_control_sensors_health: MavSysStatusSensor(MAV_SYS_STATUS_SENSOR_3D_GYRO)",
                "voltage_battery: 12600",
                "battery_remaining: 87",
            ],
            "GPS_RAW_INT" => &["GPS_FIX_TYPE_3D_FIX", "satellites_visible: 11"],
            "BATTERY_STATUS" => &["id: 1", "battery_remaining: 45"],
            "FENCE_STATUS" => &[
                "breach_count: 2",
                "breach_status: 1",
                "FENCE_BREACH_BOUNDARY",
            ],
            "EKF_STATUS_REPORT" => &[
                "velocity_variance: 0.25",
                "pos_horiz_variance: 0.5",
                "pos_vert_variance: 0.75",
                "compass_variance: 1.5",
                "EKF_POS_HORIZ_ABS",
            ],
            "ESTIMATOR_STATUS" => &[
                "vel_ratio: 0.25",
                "pos_horiz_ratio: 0.5",
                "pos_vert_ratio: 0.75",
                "mag_ratio: 1.5",
                "ESTIMATOR_POS_HORIZ_ABS",
            ],
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

#[test]
fn a_position_beyond_the_poles_or_at_0_0_is_not_known() {
    let at = |x: i32, y: i32| Position {
        x,
        y,
        ..Position::default()
    };
    assert!(at(900_000_000, -1_800_000_000).is_known());
    for unknown in [at(900_000_001, 0), at(0, -1_800_000_001), at(0, 0)] {
        assert!(!unknown.is_known(), "{unknown:?}");
    }
}
