//! Fields of each message, once for both directions, in their order on the wire: little
//! endian, largest types first, extensions last.
//!
//! The types that the crate `mavlink` generates would need no layouts. But they reject a
//! whole message for one enum value or flag that they do not know, and most of these
//! messages have such a field. A transfer must survive a command of a newer autopilot.

use super::fields::Fields;
use super::flight::{Command, FlightMessage, Position};
use super::{Address, Body, Message, MissionMessage, TEXT_BYTES, id};
use crate::mission::frame;

/// Moves the fields of a message between it and a payload.
pub(super) fn layout(id: u32, message: &mut Message, fields: &mut dyn Fields) {
    match message {
        Message::Heartbeat(heartbeat) => {
            fields.u32(&mut heartbeat.custom_mode);
            fields.u8(&mut heartbeat.kind);
            fields.u8(&mut heartbeat.autopilot);
            fields.u8(&mut heartbeat.base_mode);
            fields.u8(&mut heartbeat.system_status);
            fields.unused(&[3]);
        }
        Message::StatusText { severity, text } => {
            fields.u8(severity);
            fields.text(text, TEXT_BYTES);
        }
        Message::TextChunk(chunk) => {
            fields.u8(&mut chunk.severity);
            fields.bytes(&mut chunk.bytes);
            fields.u16(&mut chunk.id);
            fields.u8(&mut chunk.seq);
        }
        Message::MissionCurrent {
            seq,
            total,
            opaque_ids,
        } => {
            fields.u16(seq);
            fields.u16(total);
            fields.unused(&[0; 2]);
            opaque_ids.iter_mut().for_each(|id| fields.u32(id));
        }
        Message::HomePosition { x, y, amsl_mm } => {
            [x, y, amsl_mm].into_iter().for_each(|v| fields.i32(v));
            // Local position and approach vector are 0; the attitude is "level".
            fields.unused(&[0; 12]);
            fields.unused(&1_f32.to_le_bytes());
            fields.unused(&[0; 24]);
        }
        Message::AutopilotVersion {
            capabilities,
            flight_software,
        } => {
            let mut bytes = capabilities.to_le_bytes();
            fields.bytes(&mut bytes);
            *capabilities = u64::from_le_bytes(bytes);
            fields.unused(&[0; 8]);
            fields.u32(flight_software);
            fields.unused(&[0; 40]);
        }
        Message::Mission(mission) => mission_layout(mission, fields),
        Message::Flight(flight) => flight_layout(id, flight, fields),
    }
}

fn mission_layout(mission: &mut MissionMessage, fields: &mut dyn Fields) {
    let MissionMessage {
        target,
        mission_type,
        body,
    } = mission;
    match body {
        Body::Count { count, opaque_id } => {
            fields.u16(count);
            fields.address(target);
            fields.u8(mission_type);
            fields.u32(opaque_id);
        }
        Body::Ack { result, opaque_id } => {
            fields.address(target);
            fields.u8(&mut result.0);
            fields.u8(mission_type);
            fields.u32(opaque_id);
        }
        Body::Request { seq } | Body::RequestInt { seq } => {
            fields.u16(seq);
            fields.address(target);
            fields.u8(mission_type);
        }
        Body::RequestList | Body::ClearAll => {
            fields.address(target);
            fields.u8(mission_type);
        }
        Body::Item { .. } | Body::ItemInt { .. } => item_layout(mission, fields),
    }
}

/// `MISSION_ITEM` and `MISSION_ITEM_INT` differ only in the type of x and y.
fn item_layout(mission: &mut MissionMessage, fields: &mut dyn Fields) {
    let MissionMessage {
        target,
        mission_type,
        body,
    } = mission;
    let has_integers = matches!(body, Body::ItemInt { .. });
    let (Body::Item { seq, current, item } | Body::ItemInt { seq, current, item }) = body else {
        return;
    };
    let mut place = [item.x, item.y].map(|value| match has_integers {
        true => value.to_le_bytes(),
        false => to_float(item.frame, value).to_le_bytes(),
    });
    item.params.iter_mut().for_each(|param| fields.f32(param));
    place.iter_mut().for_each(|bytes| fields.bytes(bytes));
    fields.f32(&mut item.z);
    fields.u16(seq);
    fields.u16(&mut item.command);
    fields.address(target);
    fields.u8(&mut item.frame);
    fields.u8(current);
    let mut autocontinue = u8::from(item.autocontinue);
    fields.u8(&mut autocontinue);
    item.autocontinue = autocontinue != 0;
    fields.u8(mission_type);
    [item.x, item.y] = place.map(|bytes| match has_integers {
        true => i32::from_le_bytes(bytes),
        false => from_float(item.frame, f32::from_le_bytes(bytes)),
    });
}

fn flight_layout(id: u32, message: &mut FlightMessage, fields: &mut dyn Fields) {
    match message {
        FlightMessage::Command { target, order } => command_layout(id, target, order, fields),
        FlightMessage::CommandAck {
            target,
            command,
            result,
        } => {
            fields.u16(command);
            fields.u8(&mut result.0);
            fields.unused(&[0; 5]);
            fields.address(target);
        }
        FlightMessage::SetMode {
            system,
            base_mode,
            custom_mode,
        } => {
            fields.u32(custom_mode);
            fields.u8(system);
            fields.u8(base_mode);
        }
        FlightMessage::SetCurrent { target, seq } => {
            fields.u16(seq);
            fields.address(target);
        }
        FlightMessage::ItemReached { seq } => fields.u16(seq),
        FlightMessage::TimeSync {
            target,
            answer_ns,
            asked_ns,
        } => {
            fields.i64(answer_ns);
            fields.i64(asked_ns);
            fields.address(target);
        }
        FlightMessage::CameraTrigger { .. } | FlightMessage::CameraFeedback { .. } => {
            camera_layout(message, fields);
        }
        FlightMessage::Position(position) => position_layout(position, fields),
        FlightMessage::Health(health) => health.layout(fields),
        FlightMessage::Landed(state) => {
            fields.unused(&[0]);
            fields.u8(&mut state.0);
        }
        FlightMessage::ParamRead { .. }
        | FlightMessage::ParamSet { .. }
        | FlightMessage::Param { .. } => param_layout(message, fields),
    }
}

fn camera_layout(message: &mut FlightMessage, fields: &mut dyn Fields) {
    match message {
        FlightMessage::CameraTrigger { seq } => {
            fields.unused(&[0; 8]);
            fields.u32(seq);
        }
        FlightMessage::CameraFeedback {
            index,
            x,
            y,
            amsl_m,
        } => {
            fields.unused(&[0; 8]);
            fields.i32(x);
            fields.i32(y);
            fields.f32(amsl_m);
            fields.unused(&[0; 20]);
            fields.u16(index);
            fields.unused(&[0; 3]);
        }
        _ => {}
    }
}

fn param_layout(message: &mut FlightMessage, fields: &mut dyn Fields) {
    match message {
        FlightMessage::ParamRead { target, name } => {
            // Index -1: by name.
            fields.unused(&[255; 2]);
            fields.address(target);
            fields.text(name, 16);
        }
        FlightMessage::ParamSet {
            target,
            name,
            value,
        } => {
            fields.bytes(&mut value.bytes);
            fields.address(target);
            fields.text(name, 16);
            fields.u8(&mut value.kind);
        }
        FlightMessage::Param { name, value } => {
            fields.bytes(&mut value.bytes);
            // One parameter, without an index: the request had its name.
            fields.unused(&[1, 0, 255, 255]);
            fields.text(name, 16);
            fields.u8(&mut value.kind);
        }
        _ => {}
    }
}

/// `COMMAND_LONG`, and `COMMAND_INT` with its place in 1e-7 degrees.
fn command_layout(id: u32, target: &mut Address, order: &mut Command, fields: &mut dyn Fields) {
    let is_int = id == id::COMMAND_INT;
    for (index, param) in order.params.iter_mut().enumerate() {
        if is_int && (4..6).contains(&index) {
            let mut e7 = 0;
            fields.i32(&mut e7);
            *param = to_float(frame::GLOBAL, e7);
        } else {
            fields.f32(param);
        }
    }
    fields.u16(&mut order.command);
    fields.address(target);
    // COMMAND_INT has a frame here, and no confirmation.
    if !is_int {
        fields.u8(&mut order.confirmation);
    }
}

fn position_layout(position: &mut Position, fields: &mut dyn Fields) {
    fields.u32(&mut position.boot_ms);
    fields.i32(&mut position.x);
    fields.i32(&mut position.y);
    fields.i32(&mut position.amsl_mm);
    fields.i32(&mut position.above_home_mm);
    for speed in &mut position.velocity_cmps {
        let mut bytes = speed.to_le_bytes();
        fields.bytes(&mut bytes);
        *speed = i16::from_le_bytes(bytes);
    }
    // The heading is not known.
    fields.unused(&u16::MAX.to_le_bytes());
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
