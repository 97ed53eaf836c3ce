//! QuadPlane of ArduPlane.

use super::DEV;
use super::copter::ARDUCOPTER;
use super::plane::{ARDUPLANE, FASTER_SHARE, PLANE_ACCEPTANCE, WING_BEHAVIOUR};
use crate::autopilot::acceptance::AcceptanceRules;
use crate::autopilot::behaviour::{Behaviour, Figure, measured};
use crate::autopilot::modes::{Modes, mode};
use crate::autopilot::version::version;
use crate::autopilot::{Defaults, Facts, command, parameters};

pub(in crate::autopilot) static QUADPLANE: Facts = Facts {
    firmware: "ArduPlane (QuadPlane)",
    support: ARDUCOPTER.support,
    acceptance: AcceptanceRules {
        takeoffs: &[command::NAV_VTOL_TAKEOFF],
        landings: &[command::NAV_VTOL_LAND],
        // `QuadPlane::do_vtol_takeoff`, unless `Q_OPTIONS` says otherwise.
        takeoff_above_home: true,
        ..PLANE_ACCEPTANCE
    },
    modes: Modes {
        arming: mode("QLOITER", 19),
        land: Some(mode("QLAND", 20)),
        ..ARDUPLANE.modes
    },
    parameters: &[parameters::ARDUPLANE, parameters::QUADPLANE],
    param_fence: parameters::ARDUPLANE_FENCE,
    landing: Some(parameters::QUADPLANE_LANDING),
    returns_with: parameters::PLANE_RETURNS,
    judged_with: &[parameters::WING_JUDGED, parameters::QUADPLANE_JUDGED],
    // Climb and descent on rotors are slower than on the wing.
    defaults: Defaults {
        cruise_parameter: "AIRSPEED_CRUISE",
        speed_parameters: [Some("AIRSPEED_MIN"), Some("AIRSPEED_MAX")],
        rate_parameters: Some([&["TECS_CLMB_MAX"], &["TECS_SINK_MAX"]]),
        motion_parameters: None,
        rotor_parameters: Some(["Q_WP_SPEED_UP", "Q_WP_SPEED_DN"]),
        max_rotor_parameters: None,
        bank_parameter: Some("ROLL_LIMIT_DEG"),
        ..ARDUCOPTER.defaults
    },
    behaviour: Behaviour {
        // The same controller of its speed on the wing as a plane: no QuadPlane was measured.
        faster_share: FASTER_SHARE,
        // The wind carries it along its first leg before that begins: 4.6 s early after 22 s.
        takeoff_early_s: Figure::greatest(&[measured(
            (4.0, "s"),
            version(4, 6),
            32,
            "ArduPlane 4.6.3, simulated, 0 to 4 m/s of wind: with early_share, 4.6 s early after 22 s",
        )]),
        // On its way up at 2.5 to 4 m/s the rotors give nearly all of their thrust to the climb, and
        // the lean angle that they have left (`get_althold_lean_angle_max_rad`) is a few degrees.
        // With the nose more than 80 degrees off the wind it was 25 to 63 m off at the top of a climb
        // of 20 to 28 s in 4 m/s; with its nose into it 1 m. In 6 to 8 m/s (4.7.0-dev) it goes where
        // it will: 43 to 267 m.
        drift_share: Figure::greatest(&[measured(
            (0.8, ""),
            version(4, 6),
            32,
            "ArduPlane 4.6.3, simulated, 0 to 4 m/s of wind: 63 m off after a climb planned for 20 s in 4 m/s",
        )]),
        // With the wind from behind its tail is blown around as it descends, and it circles: 29 m off
        // in 2 m/s, 22 m in 3 m/s, 55 m (where it touched down) in 4 m/s. Into the wind and across at
        // most 8 m.
        landing_drift_s: Figure::greatest(&[measured(
            (20.0, "s"),
            version(4, 6),
            14,
            "ArduPlane 4.6.3, simulated, 1 to 4 m/s of wind from behind: 55 m off in 4 m/s, 29 m in 2 m/s",
        )]),
        // It slows down to 9 m/s (`VTOL position2`) with 5 to 10 m left, the less the more slowly it comes, and swings
        // beyond its place by what is missing: 10.7 m at 16 m/s in 2 m/s of wind, 0.6 m at 20 m/s in still air. A corner
        // shortly before takes it 9.7 m to the side of the leg.
        landing_overshoot_m: Figure::greatest(&[measured(
            (18.0, "m"),
            DEV,
            27,
            "ArduPlane 4.7.0-dev of February 2026, simulated, 0 to 4 m/s of wind from ahead: 10.7 m beyond and 9.7 m beside it",
        )]),
        // With the nose backwards and 4 m/s from behind it was 68 m outside of the region that 3.6 s gave.
        drift_s: Figure::greatest(&[measured(
            (21.0, "s"),
            DEV,
            12,
            "ArduPlane 4.7.0-dev, simulated, 0 to 4 m/s of wind: 68 m further off than 3.6 s of 4 m/s, nose backwards",
        )]),
        // It hardly descends while it accelerates, by a tenth of its altitude error a second until its transition is done
        // (`QuadPlane::assist_climb_rate_cms`), and then has `TECS_SINK_MAX` to catch up. 15.5 s where the wind had carried it on.
        transition_lag_s: Figure::greatest(&[measured(
            (17.0, "s"),
            DEV,
            79,
            "ArduPlane 4.7.0-dev of February 2026, simulated, 0 to 4 m/s of wind: 13.9 s above its legs in still air, 15.5 s in wind",
        )]),
        // In still air and 2 m/s with the nose 171 and 173 degrees off its first leg, and 15 m of
        // buffer included, 156 and 180 m beside that: two turn radii of 52 m more.
        transition_m: Figure::greatest(&[measured(
            (80.0, "m"),
            DEV,
            3,
            "ArduPlane 4.7.0-dev, simulated, 0 to 2 m/s of wind: 180 m beside its first leg, turns of 52 m included",
        )]),
        max_wind_mps: QUADPLANE_MAX_WIND_MPS,
        ..WING_BEHAVIOUR
    },
    ..ARDUPLANE
};

/// In more a QuadPlane goes where it will as it climbs.
pub(in crate::autopilot) const QUADPLANE_MAX_WIND_MPS: Figure = Figure::least(&[measured(
    (4.0, "m/s"),
    DEV,
    22,
    "ArduPlane 4.7.0-dev, simulated: in 6 m/s up to 181 m off in its climb, in 8 m/s up to 267 m",
)]);
