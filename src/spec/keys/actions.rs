//! What a vehicle does at a stop.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::EndPoint;
use super::words;

/// One action, by its only key.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("minProperties" = 1, "maxProperties" = 1))]
pub struct StopAction {
    /// Takes one picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub photo: Option<Photo>,
    /// Starts or stops a video.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub video: Option<Video>,
    /// Turns the gimbal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gimbal: Option<Gimbal>,
    /// A place that camera or nose point at from now on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roi: Option<EndPoint>,
    /// Ends the region of interest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roi_none: Option<RoiNone>,
    /// ArduPilot: sets a servo.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo: Option<Servo>,
    /// ArduPilot: sets a relay.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relay: Option<Relay>,
    /// Grabs or releases.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gripper: Option<Gripper>,
    /// Lets a line out or in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub winch: Option<Winch>,
    /// ArduCopter: comes down until the load is on the ground, releases it, and rises again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub payload_place: Option<PayloadPlace>,
}

/// One picture; it has no keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Photo {}

/// The end of a region of interest; it has no keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RoiNone {}

/// What happens to a video.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(transform = words)]
pub enum Video {
    /// It begins.
    Start,
    /// It ends.
    Stop,
}

/// What a gripper does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(transform = words)]
pub enum Gripper {
    /// It closes.
    Grab,
    /// It opens.
    Release,
}

/// Where a gimbal points: whole degrees, which is what ArduPilot keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gimbal {
    /// Degrees above the horizon; -90 is straight down.
    #[schemars(required, range(min = -90, max = 90))]
    pub pitch_deg: Option<i64>,
    /// Degrees clockwise from the nose; absent: 0.
    #[schemars(range(min = -180, max = 180))]
    pub yaw_deg: Option<i64>,
}

/// The pulse of a servo.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Servo {
    /// Number of the output.
    #[schemars(required, range(min = 1, max = 32))]
    pub channel: Option<i64>,
    /// Length of the pulse, microseconds.
    #[schemars(required, range(min = 500, max = 2500))]
    pub pwm_us: Option<i64>,
}

/// The state of a relay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Relay {
    /// Number of the relay, from 0.
    #[schemars(required, range(min = 0, max = 15))]
    pub number: Option<i64>,
    /// Whether it is switched on.
    #[schemars(required)]
    pub closed: Option<bool>,
}

/// How much line a winch lets out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Winch {
    /// Metres out, negative in.
    #[schemars(required, range(min = -100, max = 100))]
    pub length_m: Option<f64>,
    /// Speed of the line, m/s.
    #[schemars(required, range(min = 0.1, max = 10))]
    pub rate_mps: Option<f64>,
}

/// How a load is placed on the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PayloadPlace {
    /// Most that the vehicle comes down, metres: without ground by then it rises again with its load.
    /// Absent: no limit.
    #[schemars(range(min = 1, max = 600))]
    pub max_descent_m: Option<f64>,
}
