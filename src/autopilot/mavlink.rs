//! Numbers of MAVLink that mission items are written in (`common.xml`).

/// Commands (`MAV_CMD`) that Sortie writes or understands.
pub mod command {
    /// Fly to a place.
    pub const NAV_WAYPOINT: u16 = 16;
    /// Loiter for ever.
    pub const NAV_LOITER_UNLIM: u16 = 17;
    /// Loiter for a number of turns.
    pub const NAV_LOITER_TURNS: u16 = 18;
    /// Loiter for a time.
    pub const NAV_LOITER_TIME: u16 = 19;
    /// Return to the launch place.
    pub const NAV_RETURN_TO_LAUNCH: u16 = 20;
    /// Land.
    pub const NAV_LAND: u16 = 21;
    /// Take off.
    pub const NAV_TAKEOFF: u16 = 22;
    /// Circle down or up to an altitude.
    pub const NAV_LOITER_TO_ALT: u16 = 31;
    /// Fly a spline through a place.
    pub const NAV_SPLINE_WAYPOINT: u16 = 82;
    /// Climb vertically, then fly on the wing.
    pub const NAV_VTOL_TAKEOFF: u16 = 84;
    /// Stop flying on the wing, and land vertically.
    pub const NAV_VTOL_LAND: u16 = 85;
    /// Go on, and change the altitude.
    pub const NAV_CONTINUE_AND_CHANGE_ALT: u16 = 30;
    /// Wait for an altitude, as a balloon does.
    pub const NAV_ALTITUDE_WAIT: u16 = 83;
    /// Hand over to another computer.
    pub const NAV_GUIDED_ENABLE: u16 = 92;
    /// Wait, on the ground or in the air.
    pub const NAV_DELAY: u16 = 93;
    /// Descend until the payload stands, and release it.
    pub const NAV_PAYLOAD_PLACE: u16 = 94;
    /// The last navigation command (`MAV_CMD_NAV_LAST`).
    pub const NAV_LAST: u16 = 95;
    /// Wait for a time before the commands that follow.
    pub const CONDITION_DELAY: u16 = 112;
    /// Wait until the next waypoint is so near before the commands that follow.
    pub const CONDITION_DISTANCE: u16 = 114;
    /// Turn the nose, and wait for that before the commands that follow.
    pub const CONDITION_YAW: u16 = 115;
    /// Jump to another item.
    pub const DO_JUMP: u16 = 177;
    /// `MAV_CMD_JUMP_TAG`.
    pub const JUMP_TAG: u16 = 600;
    /// `MAV_CMD_DO_JUMP_TAG`.
    pub const DO_JUMP_TAG: u16 = 601;
    /// Change the speed.
    pub const DO_CHANGE_SPEED: u16 = 178;
    /// Switch a relay.
    pub const DO_SET_RELAY: u16 = 181;
    /// Set the pulse of a servo.
    pub const DO_SET_SERVO: u16 = 183;
    /// Abandon a landing.
    pub const DO_GO_AROUND: u16 = 191;
    /// Pause the mission, or go on.
    pub const DO_PAUSE_CONTINUE: u16 = 193;
    /// Drive backwards.
    pub const DO_SET_REVERSE: u16 = 194;
    /// Switch the fence on or off.
    pub const DO_FENCE_ENABLE: u16 = 207;
    /// Fly upside down.
    pub const DO_INVERTED_FLIGHT: u16 = 210;
    /// Turn by an angle, and fly at a speed.
    pub const NAV_SET_YAW_SPEED: u16 = 213;
    /// Limits of control by another computer.
    pub const DO_GUIDED_LIMITS: u16 = 222;
    /// Where a return along the mission begins.
    pub const DO_RETURN_PATH_START: u16 = 188;
    /// Where a landing sequence begins.
    pub const DO_LAND_START: u16 = 189;
    /// Point camera or nose at a place.
    pub const DO_SET_ROI_LOCATION: u16 = 195;
    /// Point camera or nose at the next waypoint, or near it.
    pub const DO_SET_ROI_WPNEXT_OFFSET: u16 = 196;
    /// Point camera or nose at a place, or at none.
    pub const DO_SET_ROI: u16 = 201;
    /// No longer point at a place.
    pub const DO_SET_ROI_NONE: u16 = 197;
    /// How a camera mount is controlled.
    pub const DO_MOUNT_CONFIGURE: u16 = 204;
    /// Turn a camera mount.
    pub const DO_MOUNT_CONTROL: u16 = 205;
    /// Take pictures at a distance from each other.
    pub const DO_SET_CAM_TRIGG_DIST: u16 = 206;
    /// Enable, disable or release a parachute.
    pub const DO_PARACHUTE: u16 = 208;
    /// Open or close a gripper.
    pub const DO_GRIPPER: u16 = 211;
    /// What a switch of the transmitter does.
    pub const DO_AUX_FUNCTION: u16 = 218;
    /// Start or stop an engine.
    pub const DO_ENGINE_CONTROL: u16 = 223;
    /// Turn a gimbal.
    pub const DO_GIMBAL_MANAGER_PITCHYAW: u16 = 1000;
    /// Who controls a gimbal.
    pub const DO_GIMBAL_MANAGER_CONFIGURE: u16 = 1001;
    /// Take pictures.
    pub const IMAGE_START_CAPTURE: u16 = 2000;
    /// Take no more pictures.
    pub const IMAGE_STOP_CAPTURE: u16 = 2001;
    /// Start a video.
    pub const VIDEO_START_CAPTURE: u16 = 2500;
    /// Stop a video.
    pub const VIDEO_STOP_CAPTURE: u16 = 2501;
    /// Let a line out or in.
    pub const DO_WINCH: u16 = 42600;
    /// Change between rotors and wing.
    pub const DO_VTOL_TRANSITION: u16 = 3000;
    /// Fence: where to return to.
    pub const NAV_FENCE_RETURN_POINT: u16 = 5000;
    /// Fence: a corner of a polygon to stay in.
    pub const NAV_FENCE_POLYGON_VERTEX_INCLUSION: u16 = 5001;
    /// Fence: a corner of a polygon to stay out of.
    pub const NAV_FENCE_POLYGON_VERTEX_EXCLUSION: u16 = 5002;
    /// Fence: a circle to stay in.
    pub const NAV_FENCE_CIRCLE_INCLUSION: u16 = 5003;
    /// Fence: a circle to stay out of.
    pub const NAV_FENCE_CIRCLE_EXCLUSION: u16 = 5004;
    /// A rally point.
    pub const NAV_RALLY_POINT: u16 = 5100;
}

/// Frames (`MAV_FRAME`) of mission items. 5, 6 and 11 are synonyms of 0, 3 and 10.
pub mod frame {
    /// Latitude, longitude, altitude above mean sea level.
    pub const GLOBAL: u8 = 0;
    /// No place at all: the item is a command.
    pub const MISSION: u8 = 2;
    /// Latitude, longitude, altitude above home.
    pub const GLOBAL_RELATIVE_ALT: u8 = 3;
    /// Latitude, longitude, altitude above terrain.
    pub const GLOBAL_TERRAIN_ALT: u8 = 10;

    /// The frame with synonyms (5, 6, 11) folded into 0, 3, 10.
    #[must_use]
    pub fn canonical(frame: u8) -> u8 {
        match frame {
            5 => GLOBAL,
            6 => GLOBAL_RELATIVE_ALT,
            11 => GLOBAL_TERRAIN_ALT,
            other => other,
        }
    }
}
