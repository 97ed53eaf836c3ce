//! PX4: copters, planes and VTOL.

use super::acceptance::{AcceptanceRules, Capacity};
use super::ardupilot;
use super::behaviour::{Behaviour, Figure, NONE, measured};
use super::commands::read_parameters;
use super::corner::{CornerLaw, Skips, Stops};
use super::modes::{Modes, px4_auto};
use super::support::{Evidence, Support};
use super::version::{VersionRange, version};
use super::{Conventions, Defaults, Facts, command, frame, parameters, stored_form};

/// PX4 on every airframe. Version 1.17 is stable, 1.18 in beta since July 2026, 1.19 is `main` after
/// it (November 2026).
pub(super) static CONVENTIONS: Conventions = Conventions {
    name: "PX4",
    key: "px4",
    mav_autopilot: 12,
    versions: &[version(1, 17), version(1, 18), version(1, 19)],
    measured: version(1, 17),
    counts_home: false,
    packs_items: false,
    // Angles are stored in radians.
    param_tolerance: 1e-4,
    max_system_id: 250,
    no_heading: f32::NAN,
    speed_in_mission: false,
    waits_without_autocontinue: true,
    reads_takeoff_location: true,
    zero_is_unset: false,
    bytewise_parameters: true,
    gives_any_order: false,
    request_ms: 270,
    give_up_ms: 5000,
    silence_ms: 3000,
    rejects_after_ack: true,
};

/// What `FeasibilityChecker::checkTakeoff` of 1.17 does not count as the first item with a position: a gripper or a winch
/// before the takeoff counts as one.
static BEFORE_TAKEOFF: [u16; 29] = [
    0, 93, 177, 178, 179, 189, 195, 196, 197, 200, 201, 203, 204, 205, 206, 214, 260, 530, 531,
    532, 534, 1000, 1001, 2000, 2001, 2003, 2500, 2501, 3000,
];

const COPTER_ACCEPTANCE: AcceptanceRules = AcceptanceRules {
    location_frames: &[0, 3, 5, 6],
    command_frames: Some(&[frame::MISSION]),
    zero_is_here: &[],
    zero_is_no_place: &[],
    any_nan: true,
    reads: Some(&read_parameters::PX4),
    max_altitude_m: 83_000.0,
    max_hold_s: 65_535.0,
    precision_landing: true,
    takeoffs: &[command::NAV_TAKEOFF],
    // With `MIS_TKO_LAND_REQ` 0 a copter climbs to its first waypoint by itself.
    needs_takeoff: false,
    before_takeoff: Some(&BEFORE_TAKEOFF),
    one_land_start: false,
    landings: &[command::NAV_LAND],
    never_waits: false,
    whole_numbers: false,
    takeoff_above_home: false,
    needs_approach: false,
};

const MODES: Modes = Modes {
    initial: px4_auto("AUTO.LOITER", 3),
    arming: px4_auto("AUTO.LOITER", 3),
    mission: px4_auto("AUTO.MISSION", 4),
    hold: px4_auto("AUTO.LOITER", 3),
    loiter: px4_auto("AUTO.LOITER", 3),
    land: Some(px4_auto("AUTO.LAND", 6)),
    return_to_launch: px4_auto("AUTO.RTL", 5),
};

/// `TECSControl::_calcAltitudeControlOutput` holds its target rates within the greatest ones.
const RATES: [&[&str]; 2] = [
    &["FW_T_CLMB_R_SP", "FW_T_CLMB_MAX"],
    &["FW_T_SINK_R_SP", "FW_T_SINK_MAX"],
];

const COPTER_BEHAVIOUR: Behaviour = Behaviour {
    // 1.16 alpha of December 2024, its own simulated quadrotor, still air, on the clock of the
    // vehicle; three at once on flat ground at 7 and 8 m/s, three over the ridge of Jacksboro at 8
    // and at 12 m/s (there with less drag): 6.0 to 10.1 s late over their homes, up to 12.3 s at
    // the end of the first leg, which also has its share of `leg_late_s`.
    takeoff_late_s: Figure::greatest(&[measured(
        (14.0, "s"),
        version(1, 18),
        8,
        "PX4 1.16 alpha, simulated: 6 to 10 s over their homes; main line of March 2026: 14.7 s on the first legs, \
         1.5 s of them leg_late_s",
    )]),
    // The same flights. It slows down for corners and changes of slope, by itself and unlike
    // ArduCopter: at 8 m/s by up to 2.1 s a leg (slopes that change by 14 degrees), 12.5 s more
    // after twelve legs; at 12 m/s 1.7 s a corner of 20 degrees, 6.0 s after four such legs in a
    // row, 20.7 s after 23 legs.
    leg_late_s: Figure::greatest(&[measured(
        (1.5, "s"),
        version(1, 16),
        6,
        "PX4 1.16 alpha, simulated: over a few legs in a row, at 8 and 12 m/s",
    )]),
    // It flies to and fro around the altitude of a waypoint that is followed by another altitude, by up to 4 m, as long
    // as it is on its way to the waypoint, and is 10 % slower then: 72 to 115 s late after 15 to 27 minutes.
    late_share: Figure::greatest(&[measured(
        (0.1, ""),
        version(1, 18),
        3,
        "PX4 1.18 beta, simulated, still air, 6 to 6.5 m/s: 8.7 to 9.5 % of the time; 1.17.0: nothing beyond leg_late_s",
    )]),
    // At the end of its climb it may dwell, up and down and to and fro by some metres, before it flies to its first place:
    // 12 of 88 flights were so late, in still air as in wind.
    climb_late_s: Figure::greatest(&[measured(
        (12.0, "s"),
        version(1, 17),
        88,
        "PX4 1.17 of January 2026, simulated, 0 to 8 m/s of wind: up to 11.7 s later than with takeoff_late_s and leg_late_s",
    )]),
    // Planned for 10 m/s it was 44 s late after 7 minutes; with less drag it flew 12 m/s.
    lean_speed_mps: Figure::least(&[measured(
        (9.8, "m/s"),
        version(1, 16),
        1,
        "PX4 1.16 alpha, its own simulated quadrotor: at most 9.8 m/s",
    )]),
    lean_deg: 45.0,
    // Each leg may be late already.
    corner_late_s: NONE,
    slow_landing_mps: 0.7,
    // `stop_late_s` is ArduCopter's: PX4 was measured only together with the leg to the stop.
    ..ardupilot::COPTER_BEHAVIOUR
};

const WING_BEHAVIOUR: Behaviour = Behaviour {
    takeoff_late_s: NONE,
    leg_late_s: NONE,
    late_share: NONE,
    climb_late_s: NONE,
    lean_speed_mps: NONE,
    lean_deg: 0.0,
    altitude_lag_s: Figure::greatest(&[measured(
        (3.5, "s"),
        version(1, 18),
        0,
        "TECS.cpp: (1 - FW_T_HRATE_FF) * FW_T_ALT_TC with the defaults 0.3 and 5 s",
    )]),
    // Assumed: ArduPlane was measured.
    climb_out_share: ardupilot::CLIMB_OUT_SHARE,
    climb_out_last_share: ardupilot::CLIMB_OUT_LAST_SHARE,
    climb_out_overshoot_m: ardupilot::CLIMB_OUT_OVERSHOOT_M,
    // The wind of its planes, which were flown in up to 6 m/s.
    max_wind_mps: ardupilot::PLANE_MAX_WIND_MPS,
    ..COPTER_BEHAVIOUR
};

pub(super) static COPTER: Facts = Facts {
    firmware: "PX4 (copter)",
    support: Support {
        replan: Evidence::Sources,
        ..Support::all(Evidence::Measured("1.17"))
    },
    // `dataman.h` holds 64 fence and 32 rally points.
    capacity: Capacity {
        items: 10_000,
        fence: 64,
        rally: 32,
        jumps: 10_000,
        // `MissionBase::getNonJumpItem` reads ten items.
        jumps_in_a_row: 9,
        commands_in_a_row: None,
    },
    acceptance: COPTER_ACCEPTANCE,
    stored: &[stored_form::PX4],
    modes: MODES,
    parameters: &[parameters::PX4_ROTORS, parameters::PX4_COPTER],
    param_fence: parameters::PX4_FENCE,
    landing: Some(parameters::PX4_LANDING),
    returns_with: parameters::PX4_RETURNS,
    judged_with: &[parameters::PX4_JUDGED],
    defaults: Defaults {
        cruise_parameter: "MPC_XY_CRUISE",
        speed_parameters: [None, Some("MPC_XY_VEL_MAX")],
        rate_parameters: None,
        motion_parameters: Some(["MPC_Z_V_AUTO_UP", "MPC_Z_V_AUTO_DN", "MPC_ACC_HOR"]),
        rotor_parameters: None,
        max_rotor_parameters: Some(["MPC_Z_VEL_MAX_UP", "MPC_Z_VEL_MAX_DN"]),
        bank_parameter: None,
        climb_mps: 3.0,
        descent_mps: 1.5,
        accel_mps2: 3.0,
    },
    corners: Some(CornerLaw::Circle),
    stops: Stops::NONE,
    skips: Skips::NONE,
    // `PositionSmoothing::_generateVelocitySetpoint` since 1ae8f2383f (in 1.18.0-beta1): the vertical speed no longer
    // depends on the way that is left.
    heights_at_once: Some(VersionRange::since(version(1, 18))),
    rises_from_boot: None,
    behaviour: COPTER_BEHAVIOUR,
    buffer_m: ardupilot::COPTER_BUFFER_M,
};

pub(super) static PLANE: Facts = Facts {
    firmware: "PX4 (plane)",
    support: Support {
        plan: Evidence::Sources,
        replan: Evidence::No,
        ..Support::all(Evidence::Measured("1.16"))
    },
    acceptance: AcceptanceRules {
        needs_takeoff: true,
        one_land_start: true,
        reads: Some(&read_parameters::PX4_WING),
        // `FeasibilityChecker::checkFixedWindLandApproach`.
        needs_approach: true,
        ..COPTER_ACCEPTANCE
    },
    parameters: &[parameters::PX4_WING],
    // FW_T_CLMB_R_SP and FW_T_SINK_R_SP: with what it changes its altitude on a mission, whatever the greatest are (1.17
    // climbed at 3 of 5 m/s), and plans set them; no parameter has the acceleration of a takeoff run.
    defaults: Defaults {
        cruise_parameter: "FW_AIRSPD_TRIM",
        speed_parameters: [Some("FW_AIRSPD_MIN"), Some("FW_AIRSPD_MAX")],
        rate_parameters: Some(RATES),
        motion_parameters: None,
        rotor_parameters: None,
        max_rotor_parameters: None,
        bank_parameter: Some("FW_R_LIM"),
        climb_mps: 5.0,
        descent_mps: 5.0,
        accel_mps2: 3.0,
    },
    corners: None,
    heights_at_once: None,
    // Its own simulator, 1.17.0, homes at 584 m, boots 5 s and 200 s before: up to 78 m under its path in 3 of 3
    // flights, and at most 3.5 m in 3 of 3.
    rises_from_boot: Some("FW_T_CLMB_MAX"),
    behaviour: Behaviour {
        // Assumed: ArduPlane was measured.
        takeoff_early_s: ardupilot::TAKEOFF_EARLY_S,
        // It comes to its planned speed in a minute or two, and flies the rest of its mission as planned.
        // Flown with 1.17 of January 2026, its own simulated plane at 11 to 13 m/s: coordinated turns, 33.6 degrees of bank
        // within 1.2 s; the way of its law with these two is at most 12 m beside what was flown.
        turning_share: Figure::least(&[measured(
            (0.95, ""),
            version(1, 17),
            5,
            "PX4 1.17 of January 2026, simulated, 0 to 6 m/s of wind: 0.97 to 1.02 at 33.6 degrees of bank",
        )]),
        bank_lag_s: Figure::greatest(&[measured(
            (0.5, "s"),
            version(1, 17),
            5,
            "PX4 1.17 of January 2026, simulated, 0 to 6 m/s of wind: from 0 to 32 degrees in 1.2 s",
        )]),
        // On its circle it keeps within 2.9 m of the rim; it turns onto it late, and without the wind first.
        circle_wide_share: Figure::greatest(&[measured(
            (0.25, ""),
            version(1, 17),
            22,
            "PX4 1.17 of January 2026, simulated, 0 to 6 m/s of wind: 24 m as it comes to it with a turn radius of 52 m, 15 m of them a buffer",
        )]),
        circle_level_m: Figure::greatest(&[measured(
            (3.0, "m"),
            version(1, 17),
            22,
            "PX4 1.17 of January 2026, simulated, 0 to 6 m/s of wind: 13.4 m below at the rim, the rest of the climb included",
        )]),
        drift_share: Figure::greatest(&[measured(
            (0.1, ""),
            version(1, 17),
            22,
            "PX4 1.17 of January 2026, simulated, 0 to 6 m/s of wind: 20 m beside its takeoff in a climb planned for 27 s, 15 m of them a buffer",
        )]),
        // Seeds 1006 and 1012 of the campaign: on loops of short legs soon after their climb-outs 19 and 17 m beside all ways of
        // the law at the planned speed, 5 and 9 m beside that of 0.9 of it.
        slower_share: Figure::greatest(&[measured(
            (0.1, ""),
            version(1, 17),
            12,
            "PX4 1.17 of January 2026, simulated, 6 m/s of wind: 11.2 to 11.9 m/s through the air a minute after takeoff, 12.35 m/s planned",
        )]),
        climb_late_s: Figure::greatest(&[measured(
            (36.0, "s"),
            version(1, 17),
            58,
            "PX4 1.17 of January 2026, simulated, 0 to 6 m/s of wind: 8.6 to 34.6 s, what corners took besides",
        )]),
        ..WING_BEHAVIOUR
    },
    buffer_m: ardupilot::WING_BUFFER_M,
    ..COPTER
};

pub(super) static VTOL: Facts = Facts {
    firmware: "PX4 (VTOL)",
    support: Support {
        plan: Evidence::Sources,
        replan: Evidence::No,
        ..Support::all(Evidence::Measured("1.18"))
    },
    acceptance: AcceptanceRules {
        needs_takeoff: true,
        one_land_start: true,
        reads: Some(&read_parameters::PX4_WING),
        // `NAV_FORCE_VT` 1, the default, is to fly 22 as 84 and 21 as 85; after a 22 a VTOL of 1.18 beta stayed on its
        // rotors.
        takeoffs: &[command::NAV_VTOL_TAKEOFF, command::NAV_TAKEOFF],
        landings: &[command::NAV_VTOL_LAND, command::NAV_LAND],
        ..COPTER_ACCEPTANCE
    },
    parameters: &[
        parameters::PX4_ROTORS,
        parameters::PX4_WING,
        parameters::PX4_VTOL,
    ],
    defaults: Defaults {
        cruise_parameter: "FW_AIRSPD_TRIM",
        speed_parameters: [Some("FW_AIRSPD_MIN"), Some("FW_AIRSPD_MAX")],
        rate_parameters: Some(RATES),
        motion_parameters: None,
        rotor_parameters: Some(["MPC_Z_V_AUTO_UP", "MPC_Z_V_AUTO_DN"]),
        max_rotor_parameters: Some(["MPC_Z_VEL_MAX_UP", "MPC_Z_VEL_MAX_DN"]),
        bank_parameter: Some("FW_R_LIM"),
        ..COPTER.defaults
    },
    corners: None,
    heights_at_once: None,
    rises_from_boot: None,
    behaviour: Behaviour {
        // Main of March 2026, its own simulated VTOL at 9 and 10 m/s.
        takeoff_late_s: Figure::greatest(&[measured(
            (30.0, "s"),
            version(1, 18),
            3,
            "PX4 1.18 alpha, simulated, 4 m/s of wind: 20.0, 23.2 and 29.2 s late on their ways",
        )]),
        // `Mission::handleTakeoff` turns the nose to where its takeoff is from where it hovers: any course, where both are
        // one place. On legs to the north, east, south and west it was 3 to 38 m beside them; at most 4.2 m
        // where the takeoff was 8 or 60 m ahead on the leg.
        transition_m: Figure::greatest(&[measured(
            (45.0, "m"),
            version(1, 18),
            7,
            "PX4 1.17.0 and 1.18 beta, simulated, still air: 41 m from the end of the climb, on any course",
        )]),
        // On its wing the same modules steer it as a plane (`fw_mode_manager`, `fw_lateral_longitudinal_control`). Its simulated
        // VTOL flew corners of up to 120 degrees at 10 and 11 m/s up to 10.6 m beside legs and arcs, and within 6.2 m of the
        // way of that law with the figures of planes.
        turning_share: Figure::least(&[measured(
            (0.95, ""),
            version(1, 17),
            3,
            "PX4 1.17 of January 2026, simulated, still air: within 6.2 m of the way with the figures of its planes",
        )]),
        bank_lag_s: Figure::greatest(&[measured(
            (0.5, "s"),
            version(1, 17),
            3,
            "PX4 1.17 of January 2026, simulated, still air: within 6.2 m of the way with the figures of its planes",
        )]),
        slower_share: Figure::greatest(&[measured(
            (0.1, ""),
            version(1, 17),
            0,
            "the figure of its planes",
        )]),
        // Assumed: QuadPlanes of ArduPlane were measured.
        max_wind_mps: ardupilot::QUADPLANE_MAX_WIND_MPS,
        ..WING_BEHAVIOUR
    },
    buffer_m: ardupilot::WING_BUFFER_M,
    ..COPTER
};

#[cfg(test)]
mod tests {
    use super::VTOL;

    /// Three flights of PX4 1.18 alpha in its own simulator.
    #[test]
    fn a_vtol_may_be_as_late_as_simulated_ones_were() {
        let late_s = VTOL.behaviour.takeoff_late_s.value(None);
        assert!(
            [20.0, 23.2, 29.2]
                .into_iter()
                .all(|flown_s| flown_s <= late_s),
            "{late_s}"
        );
    }
}
