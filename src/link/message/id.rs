//! Message ids of the common dialect.

pub(super) const HEARTBEAT: u32 = 0;
pub(super) const SYS_STATUS: u32 = 1;
pub(super) const SET_MODE: u32 = 11;
pub(super) const PARAM_REQUEST_READ: u32 = 20;
pub(super) const PARAM_VALUE: u32 = 22;
pub(super) const PARAM_SET: u32 = 23;
pub(super) const GPS_RAW_INT: u32 = 24;
pub(super) const GLOBAL_POSITION_INT: u32 = 33;
pub(super) const MISSION_ITEM: u32 = 39;
pub(super) const MISSION_REQUEST: u32 = 40;
pub(super) const MISSION_SET_CURRENT: u32 = 41;
pub(super) const MISSION_CURRENT: u32 = 42;
pub(super) const MISSION_REQUEST_LIST: u32 = 43;
pub(super) const MISSION_COUNT: u32 = 44;
pub(super) const MISSION_CLEAR_ALL: u32 = 45;
pub(super) const MISSION_ITEM_REACHED: u32 = 46;
pub(super) const MISSION_ACK: u32 = 47;
pub(super) const MISSION_REQUEST_INT: u32 = 51;
pub(super) const MISSION_ITEM_INT: u32 = 73;
pub(super) const COMMAND_INT: u32 = 75;
pub(super) const COMMAND_LONG: u32 = 76;
pub(super) const COMMAND_ACK: u32 = 77;
pub(super) const TIMESYNC: u32 = 111;
pub(super) const CAMERA_TRIGGER: u32 = 112;
pub(super) const BATTERY_STATUS: u32 = 147;
pub(super) const AUTOPILOT_VERSION: u32 = 148;
pub(super) const FENCE_STATUS: u32 = 162;
pub(super) const CAMERA_FEEDBACK: u32 = 180;
pub(super) const EKF_STATUS_REPORT: u32 = 193;
pub(super) const ESTIMATOR_STATUS: u32 = 230;
pub(super) const HOME_POSITION: u32 = 242;
pub(super) const EXTENDED_SYS_STATE: u32 = 245;
pub(super) const STATUSTEXT: u32 = 253;

/// Bytes of a payload without the extensions of MAVLink 2.
pub(crate) fn length_1(id: u32) -> u8 {
    match id {
        COMMAND_ACK | MISSION_ACK => 3,
        MISSION_REQUEST_LIST | MISSION_CLEAR_ALL => 2,
        MISSION_COUNT | MISSION_REQUEST | MISSION_REQUEST_INT => 4,
        MISSION_CURRENT | MISSION_ITEM_REACHED | EXTENDED_SYS_STATE => 2,
        MISSION_SET_CURRENT => 4,
        SET_MODE => 6,
        HEARTBEAT => 9,
        PARAM_REQUEST_READ => 20,
        PARAM_SET => 23,
        PARAM_VALUE => 25,
        GLOBAL_POSITION_INT => 28,
        SYS_STATUS => 31,
        FENCE_STATUS => 8,
        EKF_STATUS_REPORT => 22,
        GPS_RAW_INT => 30,
        BATTERY_STATUS => 36,
        ESTIMATOR_STATUS => 42,
        COMMAND_LONG => 33,
        CAMERA_TRIGGER => 12,
        TIMESYNC => 16,
        CAMERA_FEEDBACK => 45,
        MISSION_ITEM | MISSION_ITEM_INT => 37,
        STATUSTEXT => 51,
        HOME_POSITION => 52,
        _ => 60,
    }
}
