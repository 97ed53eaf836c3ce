//! The parameters of a wing (a plane, or a VTOL on its wing), and how it flies by them.

use super::{Limits, Settings};
use crate::simulator::profile::Profile;
use crate::spec::GRAVITY_MPS2;

/// How the altitude follows what is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Follows {
    /// ArduPlane's TECS: the demand passes a filter of the first order; its rate and the
    /// error over the time constant make the climb.
    Filtered { filter_s: f64, error_s: f64 },
    /// PX4's TECS: the error over the time constant, and a share of the rate.
    Shared { error_s: f64, rate_share: f64 },
}

/// When a wing turns to its next leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Passes {
    /// ArduPlane: this far before the waypoint at most, the less the smaller the turn; or when
    /// it is abeam.
    Turning { radius_m: f64 },
    /// PX4: within a radius that grows with the speed, seconds of it, at the altitude of the
    /// waypoint; before a landing more exactly.
    Within {
        radius_m: f64,
        speed_s: f64,
        height_m: f64,
        landing_height_m: f64,
    },
}

/// How a wing flies: m, m/s (equivalent airspeed), radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WingLimits {
    pub(crate) airspeed_mps: f64,
    /// Where the wheels leave the ground.
    pub(crate) min_airspeed_mps: f64,
    pub(crate) approach_mps: f64,
    pub(crate) bank_rad: f64,
    pub(crate) climb_mps: f64,
    pub(crate) sink_mps: f64,
    pub(crate) follows: Follows,
    /// Period, seconds, and damping of the guidance onto a leg.
    pub(crate) period_s: f64,
    pub(crate) damping: f64,
    pub(crate) passes: Passes,
    pub(crate) loiter_radius_m: f64,
    /// ArduPlane: the bank of circles at sea level, 0 for none; they are wider higher up.
    pub(crate) circle_bank_rad: Option<f64>,
    /// ArduPlane: smaller changes of altitude are flown at once.
    pub(crate) slope_min_m: f64,
    pub(crate) takeoff_pitch_rad: f64,
    /// A landing flares at this height, or this many seconds of its sink above the ground,
    pub(crate) flare_m: f64,
    pub(crate) flare_s: f64,
    /// and touches down with this.
    pub(crate) flare_sink_mps: f64,
    /// From rest until the motor stops, milliseconds.
    pub(crate) disarm_ms: u64,
    /// Height above home of a return.
    pub(crate) return_m: f64,
}

impl WingLimits {
    /// The radius of a circle as it is flown at a ratio of true to equivalent airspeed, metres
    /// (`AP_L1_Control::loiter_radius`).
    pub(crate) fn circle_m(&self, stated_m: f64, ratio: f64) -> f64 {
        let Some(bank_rad) = self.circle_bank_rad else {
            return stated_m;
        };
        let at_sea_m = self.airspeed_mps.powi(2) / (GRAVITY_MPS2 * bank_rad.tan());
        match at_sea_m > stated_m.abs() {
            true => stated_m * ratio * ratio,
            false => stated_m
                .abs()
                .max(at_sea_m * ratio * ratio)
                .copysign(stated_m),
        }
    }
}

impl Settings {
    /// How the vehicle flies on its wing by them.
    pub(crate) fn wing(&self) -> WingLimits {
        match self.profile {
            Profile::Px4 => self.px4_wing(),
            Profile::ArduPilot | Profile::Generic => self.arduplane(),
        }
    }

    fn arduplane(&self) -> WingLimits {
        let airspeed_mps = self.of_name("AIRSPEED_CRUISE").max(5.0);
        let min_airspeed_mps = self.of_name("AIRSPEED_MIN").clamp(3.0, airspeed_mps);
        // A plan has the name since 4.7 as well.
        let slope_min_m = self.of_name("GLIDE_SLOPE_MIN").trunc();
        WingLimits {
            airspeed_mps,
            min_airspeed_mps,
            // TECS_LAND_ARSPD is -1: between the least and the planned one.
            approach_mps: 0.5 * (min_airspeed_mps + airspeed_mps),
            bank_rad: self.of_name("ROLL_LIMIT_DEG").clamp(5.0, 80.0).to_radians(),
            climb_mps: self.of_name("TECS_CLMB_MAX").max(0.1),
            sink_mps: self.of_name("TECS_SINK_MAX").max(0.1),
            follows: Follows::Filtered {
                filter_s: self.of_name("TECS_HDEM_TCONST").max(0.1),
                error_s: self.of_name("TECS_TIME_CONST").max(1.0),
            },
            period_s: self.of_name("NAVL1_PERIOD").max(1.0),
            damping: self.of_name("NAVL1_DAMPING").clamp(0.6, 1.0),
            passes: Passes::Turning {
                radius_m: self.of_name("WP_RADIUS").max(1.0),
            },
            loiter_radius_m: self.of_name("WP_LOITER_RAD"),
            circle_bank_rad: Some(self.of_name("NAVL1_LIM_BANK").clamp(0.0, 89.0).to_radians()),
            slope_min_m: if slope_min_m > 0.0 {
                slope_min_m
            } else {
                f64::INFINITY
            },
            // Its items state it.
            takeoff_pitch_rad: 4_f64.to_radians(),
            flare_m: self.of_name("LAND_FLARE_ALT").max(0.1),
            flare_s: self.of_name("LAND_FLARE_SEC").max(0.0),
            flare_sink_mps: self.of_name("TECS_LAND_SINK").max(0.1),
            disarm_ms: milliseconds(self.of_name("LAND_DISARMDELAY")),
            return_m: self.of_name("RTL_ALTITUDE"),
        }
    }

    fn px4_wing(&self) -> WingLimits {
        let airspeed_mps = self.of_name("FW_AIRSPD_TRIM").max(5.0);
        let min_airspeed_mps = self.of_name("FW_AIRSPD_MIN").clamp(3.0, airspeed_mps);
        let (period_s, damping) = (self.of_name("NPFG_PERIOD"), self.of_name("NPFG_DAMPING"));
        let climb_mps = self.of_name("FW_T_CLMB_R_SP");
        let sink_mps = self.of_name("FW_T_SINK_R_SP");
        WingLimits {
            airspeed_mps,
            min_airspeed_mps,
            // FW_LND_AIRSPD is -1.
            approach_mps: min_airspeed_mps,
            bank_rad: self.of_name("FW_R_LIM").clamp(5.0, 80.0).to_radians(),
            climb_mps: climb_mps.min(self.of_name("FW_T_CLMB_MAX")).max(0.1),
            sink_mps: sink_mps.min(self.of_name("FW_T_SINK_MAX")).max(0.1),
            follows: Follows::Shared {
                error_s: self.of_name("FW_T_ALT_TC").max(1.0),
                rate_share: self.of_name("FW_T_HRATE_FF").clamp(0.0, 1.0),
            },
            period_s: period_s.max(1.0),
            damping: damping.clamp(0.1, 1.0),
            passes: Passes::Within {
                radius_m: self.of_name("NAV_ACC_RAD").max(0.1),
                speed_s: self.of_name("NPFG_SW_DST_MLT") * period_s * damping,
                height_m: self.of_name("NAV_FW_ALT_RAD").max(0.1),
                landing_height_m: self.of_name("NAV_FW_ALTL_RAD").max(0.1),
            },
            loiter_radius_m: self.of_name("NAV_LOITER_RAD"),
            circle_bank_rad: None,
            slope_min_m: 0.0,
            takeoff_pitch_rad: self.of_name("FW_TKO_PITCH_MIN").to_radians(),
            flare_m: self.of_name("FW_LND_FLALT").max(0.1),
            flare_s: self.of_name("FW_LND_FL_TIME").max(0.0),
            flare_sink_mps: self.of_name("FW_LND_FL_SINK").max(0.1),
            disarm_ms: milliseconds(self.of_name("COM_DISARM_LAND")),
            return_m: self.of_name("RTL_RETURN_ALT"),
        }
    }

    /// How a VTOL moves on its rotors. It brakes from the speed of its wing.
    pub(crate) fn quadplane(&self) -> Limits {
        let metres = |name| self.of_name(name) / 100.0;
        let accel_mps2 = self.of_name("Q_TRANS_DECEL").max(0.5);
        let climb_mps = metres("Q_WP_SPEED_UP").max(0.1);
        Limits {
            speed_mps: self.wing().airspeed_mps,
            accel_mps2,
            corner_accel_mps2: accel_mps2,
            accel_z_mps2: 1.0,
            takeoff_mps: climb_mps,
            climb_mps,
            descent_mps: metres("Q_WP_SPEED_DN").max(0.1),
            corner_cut_m: 2.0,
            cornering: None,
            level_m: None,
            slow_landing_m: self.of_name("Q_LAND_FINAL_ALT"),
            slow_landing_mps: self.of_name("Q_LAND_FINAL_SPD").max(0.1),
            placing_mps: self.of_name("Q_LAND_FINAL_SPD").max(0.1),
            return_m: self.wing().return_m,
            idle_s: None,
        }
    }

    /// The same with PX4.
    pub(crate) fn px4_vtol(&self) -> Limits {
        let accel_mps2 = self.of_name("VT_B_DEC_MSS").max(0.5);
        Limits {
            speed_mps: self.wing().airspeed_mps,
            accel_mps2,
            corner_accel_mps2: accel_mps2,
            level_m: None,
            ..self.px4()
        }
    }
}

fn milliseconds(seconds: f64) -> u64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a positive count of milliseconds"
    )]
    let milliseconds = (seconds * 1000.0).clamp(0.0, 1e9) as u64;
    milliseconds
}
