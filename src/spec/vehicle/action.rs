//! What a vehicle does at a stop.

use super::EndPoint;
use crate::autopilot::{Autopilot, command, command_row};

/// One action at a stop.
#[derive(Clone, Debug, PartialEq)]
pub enum StopAction {
    /// Takes one picture.
    Photo,
    /// Starts a video, or stops it.
    Video {
        /// Whether it starts.
        starts: bool,
    },
    /// Turns the gimbal, whole degrees.
    Gimbal {
        /// Above the horizon.
        pitch_deg: i16,
        /// Clockwise from the nose.
        yaw_deg: i16,
    },
    /// Camera or nose point at this place from now on.
    Roi(EndPoint),
    /// No longer.
    RoiNone,
    /// Sets a servo.
    Servo {
        /// Number of the output, from 1.
        channel: u8,
        /// Length of the pulse, microseconds.
        pwm_us: u16,
    },
    /// Sets a relay.
    Relay {
        /// From 0.
        number: u8,
        /// Whether it is switched on.
        closed: bool,
    },
    /// Moves the gripper.
    Gripper {
        /// Whether it closes.
        grabs: bool,
    },
    /// Lets a line out.
    Winch {
        /// Metres out, negative in.
        length_m: f64,
        /// Speed of the line, m/s.
        rate_mps: f64,
    },
    /// Comes down until the load is on the ground, releases it, and rises to where it was.
    PayloadPlace {
        /// Most that it comes down, metres; none: any height.
        max_descent_m: Option<f64>,
    },
}

/// What release of a load on the ground and the measurement of the thrust take, seconds.
pub const RELEASE_S: f64 = 5.0;

impl StopAction {
    /// The `MAV_CMD` that does it.
    #[must_use]
    pub fn command(&self) -> u16 {
        match self {
            Self::Photo => command::IMAGE_START_CAPTURE,
            Self::Video { starts: true } => command::VIDEO_START_CAPTURE,
            Self::Video { starts: false } => command::VIDEO_STOP_CAPTURE,
            Self::Gimbal { .. } => command::DO_GIMBAL_MANAGER_PITCHYAW,
            Self::Roi(_) => command::DO_SET_ROI_LOCATION,
            Self::RoiNone => command::DO_SET_ROI_NONE,
            Self::Servo { .. } => command::DO_SET_SERVO,
            Self::Relay { .. } => command::DO_SET_RELAY,
            Self::Gripper { .. } => command::DO_GRIPPER,
            Self::Winch { .. } => command::DO_WINCH,
            Self::PayloadPlace { .. } => command::NAV_PAYLOAD_PLACE,
        }
    }

    /// Whether it moves a load: done once more, or elsewhere, it loses it.
    #[must_use]
    pub fn moves_load(&self) -> bool {
        use StopAction::{Gripper, PayloadPlace, Relay, Servo, Winch};
        matches!(
            self,
            Gripper { .. } | Winch { .. } | PayloadPlace { .. } | Servo { .. } | Relay { .. }
        )
    }

    /// Whether an autopilot accepts it in a mission.
    #[must_use]
    pub fn is_run_by(&self, autopilot: Autopilot) -> bool {
        command_row(self.command()).is_some_and(|row| row.rule(autopilot).is_some())
    }

    /// The key of the spec.
    #[must_use]
    pub fn key(&self) -> &'static str {
        match self {
            Self::Photo => "photo",
            Self::Video { .. } => "video",
            Self::Gimbal { .. } => "gimbal",
            Self::Roi(_) => "roi",
            Self::RoiNone => "roi_none",
            Self::Servo { .. } => "servo",
            Self::Relay { .. } => "relay",
            Self::Gripper { .. } => "gripper",
            Self::Winch { .. } => "winch",
            Self::PayloadPlace { .. } => "payload_place",
        }
    }
}
