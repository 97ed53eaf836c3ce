//! Payloads to messages and back.

use super::fields::{Reader, Writer};
use super::flight::{Command, CommandResult, FlightMessage, LandedState, ParamValue, Position};
use super::health::Health;
use super::layout::layout;
use super::{
    Address, Body, Heartbeat, Message, MissionMessage, MissionResult, TEXT_BYTES, TextChunk, id,
};
use crate::mission::Item;

const NOBODY: Address = Address {
    system: 0,
    component: 0,
};

/// The message in a payload; `None` for a message that this project does not use.
pub(crate) fn read_payload(id: u32, payload: &[u8]) -> Option<Message> {
    let mut message = blank(id)?;
    layout(id, &mut message, &mut Reader(payload));
    Some(match message {
        Message::TextChunk(chunk) if chunk.id == 0 => {
            Message::of_text(chunk.severity, chunk.text())
        }
        message => message,
    })
}

/// The id and the payload of a message, extensions included.
pub(crate) fn write_payload(message: &Message) -> (u32, Vec<u8>) {
    let id = id_of(message);
    let mut writer = Writer(Vec::new());
    layout(id, &mut message.clone(), &mut writer);
    (id, writer.0)
}

fn id_of(message: &Message) -> u32 {
    match message {
        Message::Heartbeat(_) => id::HEARTBEAT,
        Message::StatusText { .. } | Message::TextChunk(_) => id::STATUSTEXT,
        Message::MissionCurrent { .. } => id::MISSION_CURRENT,
        Message::HomePosition { .. } => id::HOME_POSITION,
        Message::AutopilotVersion { .. } => id::AUTOPILOT_VERSION,
        Message::Mission(mission) => match mission.body {
            Body::Count { .. } => id::MISSION_COUNT,
            Body::Request { .. } => id::MISSION_REQUEST,
            Body::RequestInt { .. } => id::MISSION_REQUEST_INT,
            Body::Item { .. } => id::MISSION_ITEM,
            Body::ItemInt { .. } => id::MISSION_ITEM_INT,
            Body::Ack { .. } => id::MISSION_ACK,
            Body::RequestList => id::MISSION_REQUEST_LIST,
            Body::ClearAll => id::MISSION_CLEAR_ALL,
        },
        Message::Flight(flight) => match flight {
            FlightMessage::Command { .. } => id::COMMAND_LONG,
            FlightMessage::CommandAck { .. } => id::COMMAND_ACK,
            FlightMessage::SetMode { .. } => id::SET_MODE,
            FlightMessage::SetCurrent { .. } => id::MISSION_SET_CURRENT,
            FlightMessage::ItemReached { .. } => id::MISSION_ITEM_REACHED,
            FlightMessage::TimeSync { .. } => id::TIMESYNC,
            FlightMessage::CameraTrigger { .. } => id::CAMERA_TRIGGER,
            FlightMessage::CameraFeedback { .. } => id::CAMERA_FEEDBACK,
            FlightMessage::Position(_) => id::GLOBAL_POSITION_INT,
            FlightMessage::Health(health) => health.id(),
            FlightMessage::Landed(_) => id::EXTENDED_SYS_STATE,
            FlightMessage::ParamRead { .. } => id::PARAM_REQUEST_READ,
            FlightMessage::ParamSet { .. } => id::PARAM_SET,
            FlightMessage::Param { .. } => id::PARAM_VALUE,
        },
    }
}

/// A message of this id, for [`layout`] to fill.
fn blank(id: u32) -> Option<Message> {
    Some(match id {
        id::HEARTBEAT => Message::Heartbeat(Heartbeat::OURS),
        id::STATUSTEXT => Message::TextChunk(TextChunk {
            severity: 0,
            bytes: [0; TEXT_BYTES],
            id: 0,
            seq: 0,
        }),
        id::MISSION_CURRENT => Message::MissionCurrent {
            seq: 0,
            total: 0,
            opaque_ids: [0; 3],
        },
        id::HOME_POSITION => Message::HomePosition {
            x: 0,
            y: 0,
            amsl_mm: 0,
        },
        id::AUTOPILOT_VERSION => Message::AutopilotVersion {
            capabilities: 0,
            flight_software: 0,
        },
        _ => match blank_body(id) {
            Some(body) => Message::Mission(MissionMessage {
                target: NOBODY,
                mission_type: 0,
                body,
            }),
            None => Message::Flight(blank_flight(id)?),
        },
    })
}

fn blank_body(id: u32) -> Option<Body> {
    let (seq, current, opaque_id) = (0, 0, 0);
    let item = Item::without_place(0, [0.0; 4]);
    Some(match id {
        id::MISSION_COUNT => Body::Count {
            count: 0,
            opaque_id,
        },
        id::MISSION_REQUEST => Body::Request { seq },
        id::MISSION_REQUEST_INT => Body::RequestInt { seq },
        id::MISSION_ITEM => Body::Item { seq, current, item },
        id::MISSION_ITEM_INT => Body::ItemInt { seq, current, item },
        id::MISSION_ACK => Body::Ack {
            result: MissionResult::ACCEPTED,
            opaque_id,
        },
        id::MISSION_REQUEST_LIST => Body::RequestList,
        id::MISSION_CLEAR_ALL => Body::ClearAll,
        _ => return None,
    })
}

fn blank_flight(id: u32) -> Option<FlightMessage> {
    let (target, name, value) = (NOBODY, String::new(), ParamValue::float(0.0));
    Some(match id {
        id::COMMAND_INT | id::COMMAND_LONG => FlightMessage::Command {
            target,
            order: Command::new(0, []),
        },
        id::COMMAND_ACK => FlightMessage::CommandAck {
            target,
            command: 0,
            result: CommandResult::ACCEPTED,
        },
        id::SET_MODE => FlightMessage::SetMode {
            system: 0,
            base_mode: 0,
            custom_mode: 0,
        },
        id::MISSION_SET_CURRENT => FlightMessage::SetCurrent { target, seq: 0 },
        id::MISSION_ITEM_REACHED => FlightMessage::ItemReached { seq: 0 },
        id::TIMESYNC => FlightMessage::TimeSync {
            target,
            answer_ns: 0,
            asked_ns: 0,
        },
        id::CAMERA_TRIGGER => FlightMessage::CameraTrigger { seq: 0 },
        id::CAMERA_FEEDBACK => FlightMessage::CameraFeedback {
            index: 0,
            x: 0,
            y: 0,
            amsl_m: 0.0,
        },
        id::GLOBAL_POSITION_INT => FlightMessage::Position(Position::default()),
        id::EXTENDED_SYS_STATE => FlightMessage::Landed(LandedState(0)),
        id::PARAM_REQUEST_READ => FlightMessage::ParamRead { target, name },
        id::PARAM_SET => FlightMessage::ParamSet {
            target,
            name,
            value,
        },
        id::PARAM_VALUE => FlightMessage::Param { name, value },
        _ => FlightMessage::Health(Health::blank(id)?),
    })
}
