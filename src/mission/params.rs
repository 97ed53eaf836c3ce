//! Autopilot parameters that the verdict assumes, written with every mission.
//!
//! Names, units and defaults are in [`crate::autopilot`]. Where a version renamed a parameter, the
//! name is that of the spec's `autopilot_version`; without one it is the older, and of lean angles
//! and slopes both, and a vehicle knows one of them.

use super::held_params::{PLACING, corner_accel_mps2};
use super::item::{Item, Parameter};
use crate::autopilot::{
    Airframe, Autopilot, COPTER_LEAN, PX4_LEAN, ParameterRow, SLOPE_MIN, SLOW_LANDING_M, Version,
    command, frame, name_in, parameter,
};
use crate::geodesy::Amsl;
use crate::path::VehicleLimits;
use crate::spec::{MissionOptions, Vehicle, Wing, turn_radius_by_load_m};

/// What a mission that follows the terrain needs, at its defaults, and why.
const FOLLOWING: [(&str, &str); 2] = [
    ("TERRAIN_ENABLE", "altitudes are above the terrain"),
    (
        "TERRAIN_SPACING",
        "posts of the terrain that the verdict judges altitudes with, m",
    ),
];

/// Turn radius of a vehicle at its planned speed, metres.
#[must_use]
pub fn turn_radius_m(vehicle: &Vehicle) -> f64 {
    VehicleLimits::of(vehicle).turn_radius_m
}

/// The parameters for one vehicle, by the altitude of its home above the sea (metres). With a fence
/// there is its margin, metres: 0 where the plan keeps none. The items show what
/// else the mission needs, its tasks included.
#[must_use]
pub fn parameters(
    vehicle: &Vehicle,
    options: &MissionOptions,
    items: &[Item],
    home_amsl_m: f64,
    fence_margin_m: Option<f64>,
    airspeed_mps: Option<f64>,
) -> Vec<Parameter> {
    let mut list = List {
        vehicle,
        items,
        parameters: Vec::new(),
    };
    match (vehicle.autopilot, vehicle.wing) {
        (Autopilot::ArduPilot, None) => list.arducopter(options, home_amsl_m),
        (Autopilot::Px4, None) => list.px4_copter(options, home_amsl_m),
        (Autopilot::ArduPilot, Some(wing)) => list.arduplane(&wing),
        (Autopilot::Px4, Some(wing)) => list.px4_wing(&wing, options),
    }
    if let Some(lean_deg) = airspeed_mps.and_then(|mps| vehicle.lean_for_speed_deg(mps)) {
        list.lean(lean_deg);
    }
    if items
        .iter()
        .any(|item| frame::canonical(item.frame) == frame::GLOBAL_TERRAIN_ALT)
    {
        for (name, why) in FOLLOWING {
            let default = parameter(name).map_or(0.0, ParameterRow::default_si);
            list.set(name, default, why);
        }
    }
    if let Some(margin_m) = fence_margin_m {
        list.fence(margin_m);
    }
    list.parameters
}

/// Share of the planned airspeed below which a QuadPlane's rotors may help. With 18 at a planned
/// 18 m/s they did some 40 times on one way, and it sank 36 m under its line (ArduPlane 4.7.0-dev of
/// December 2025, simulated).
const ASSIST_SHARE: f64 = 0.7;

/// PX4's widest acceptance of altitudes (`NAV_FW_ALT_RAD`), metres.
const ANY_HEIGHT_M: f64 = 200.0;

/// PX4's steepest glide, degrees; it rejects a landing on a steeper one.
pub(super) const STEEPEST_GLIDE: &str = "FW_LND_ANG";

/// The upper end of the range that ArduPilot documents for `FENCE_MARGIN`, metres.
const WIDEST_FENCE_MARGIN_M: f64 = 10.0;

/// How far a corner may be cut: the tolerance, within the range of both autopilots, metres.
/// `WPNAV_RADIUS` and `NAV_ACC_RAD` are set to it.
#[must_use]
pub fn corner_cut_m(options: &MissionOptions) -> f64 {
    options.tolerance_m.clamp(1.0, 10.0)
}

/// How far off the altitude of a waypoint a PX4 copter accepts it, metres: `NAV_MC_ALT_RAD`. One
/// of 1.18 that came 2.7 m too high at 8 m/s never accepted it with the default of 0.8 m; with 5 m
/// all items advanced.
fn altitude_acceptance_m(options: &MissionOptions) -> f64 {
    corner_cut_m(options).max(5.0)
}

/// A comment with the names that parameters have in a version.
fn with_names(why: &str, version: Option<Version>) -> String {
    // Looked up for each variant of a path in a search: names alone begin with a capital.
    let may_be_name = |word: &str| word.starts_with(|first: char| first.is_ascii_uppercase());
    let named = |word| {
        let row = may_be_name(word).then(|| parameter(word)).flatten();
        row.map_or(word, |row| name_in(row.name, version))
    };
    let words: Vec<&str> = why.split(' ').map(named).collect();
    words.join(" ")
}

/// The parameters of one vehicle, in the order of its file.
struct List<'a> {
    vehicle: &'a Vehicle,
    items: &'a [Item],
    parameters: Vec<Parameter>,
}

impl List<'_> {
    /// Adds a parameter with a value in SI units, angles in degrees, under the name that it has in
    /// the vehicle's version.
    fn set(&mut self, name: &'static str, value: f64, why: &str) {
        let version = self.vehicle.autopilot_version;
        let (own, name) = (name, name_in(name, version));
        if self.parameters.iter().any(|param| param.name == name) {
            return;
        }
        let mut why = with_names(why, version);
        if own != name {
            why = why.replace(", cm", ", m");
        }
        let per_si = parameter(name).map_or(1.0, |row| row.unit.per_si());
        #[expect(
            clippy::cast_possible_truncation,
            reason = "parameters are float32 on the wire"
        )]
        let value = (value * per_si) as f32;
        self.parameters.push(Parameter {
            name: name.to_owned(),
            value,
            why,
        });
    }

    fn arducopter(&mut self, options: &MissionOptions, home_amsl_m: f64) {
        let v = self.vehicle;
        self.set("WPNAV_SPEED", v.speed_mps, "planned ground speed, cm/s");
        self.set("WPNAV_ACCEL", v.accel_mps2, "planned acceleration, cm/s^2");
        self.set(
            "WPNAV_ACCEL_C",
            corner_accel_mps2(v.accel_mps2, None),
            "acceleration in corners of the verdict, cm/s^2: with less a copter nearly stops at sharp ones",
        );
        self.set("WPNAV_SPEED_UP", v.climb_mps, "planned climb, cm/s");
        self.set("WPNAV_SPEED_DN", v.descent_mps, "planned descent, cm/s");
        let radii = v.stops.iter().filter_map(|stop| stop.acceptance_radius_m);
        let cut_m = corner_cut_m(options);
        let nearest_m = radii.fold(cut_m, f64::min);
        let why = match nearest_m < cut_m {
            true => "how far a corner may be cut, cm: the least acceptance_radius_m of a stop",
            false => "how far a corner may be cut, cm: mission.tolerance_m",
        };
        self.set("WPNAV_RADIUS", nearest_m, why);
        self.set(
            "LAND_SPEED_HIGH",
            0.0,
            "land at WPNAV_SPEED_DN until LAND_ALT_LOW",
        );
        self.set(
            "LAND_ALT_LOW",
            SLOW_LANDING_M,
            "height of the slow end of a landing, cm",
        );
        self.slow_landing("LAND_SPEED", "speed of the slow end of a landing, cm/s");
        let is_placing = |item: &Item| item.command == command::NAV_PAYLOAD_PLACE;
        if self.items.iter().any(is_placing) {
            self.set(PLACING, 0.0, "loads are placed at LAND_SPEED");
        }
        self.armed_until_departure("DISARM_DELAY", 0.0);
        if let Some(amsl) = v.return_amsl {
            self.set(
                "RTL_ALT",
                amsl.0 - home_amsl_m,
                "altitude of a return to launch above home, cm: return_amsl_m",
            );
            self.set("RTL_CONE_SLOPE", 0.0, "climb so high however near home");
            self.set("RTL_CLIMB_MIN", 0.0, "and no higher");
            self.set("RTL_LOIT_TIME", 0.0, "do not wait over home");
            self.set("RTL_ALT_FINAL", 0.0, "land there");
        }
    }

    /// ArduPlane, and its QuadPlane.
    fn arduplane(&mut self, wing: &Wing) {
        let v = self.vehicle;
        let airspeed = "planned speed, m/s, indicated airspeed";
        self.set("AIRSPEED_CRUISE", v.speed_mps, airspeed);
        self.set("ROLL_LIMIT_DEG", self.bank_deg(), "bank of max_load_factor");
        self.set("TECS_CLMB_MAX", v.climb_mps, "planned climb, m/s");
        self.set("TECS_SINK_MAX", v.descent_mps, "planned descent, m/s");
        let at_sea_mps = v.fastest_at_mps(v.speed_mps, Amsl(0.0));
        self.set(
            "WP_RADIUS",
            turn_radius_by_load_m(at_sea_mps, v.max_load_factor).ceil(),
            "turns onto the next leg begin no further before a waypoint than this, at sea level",
        );
        for name in ["NAVL1_PERIOD", "NAVL1_DAMPING"] {
            let default = parameter(name).map_or(0.0, ParameterRow::default_si);
            self.set(name, default, "the verdict judges corners with it");
        }
        let why = "circles have their radius at any altitude";
        self.set("NAVL1_LIM_BANK", self.bank_deg(), why);
        let [new, old] = SLOPE_MIN;
        self.set(new, 1.0, "smaller changes of altitude are flown at once, m");
        self.set(old, 1.0, "the same before ArduPlane 4.7");
        self.loiter_radius("WP_LOITER_RAD", wing);
        if v.airframe == Airframe::Vtol {
            self.set(
                "Q_ASSIST_SPEED",
                (ASSIST_SHARE * v.speed_mps).floor(),
                "airspeed below which the rotors help, not at the planned one, m/s",
            );
            let (climb, descent) = (
                "planned climb on rotors, cm/s",
                "planned descent on rotors, cm/s",
            );
            self.set("Q_WP_SPEED_UP", v.climb_mps, climb);
            self.set("Q_WP_SPEED_DN", v.descent_mps, descent);
            self.set(
                "Q_LAND_FINAL_ALT",
                SLOW_LANDING_M,
                "height of the slow end of a landing, m",
            );
            self.slow_landing(
                "Q_LAND_FINAL_SPD",
                "speed of the slow end of a landing, m/s",
            );
        }
    }

    fn px4_copter(&mut self, options: &MissionOptions, home_amsl_m: f64) {
        let v = self.vehicle;
        self.set(
            "MPC_XY_VEL_MAX",
            v.speed_mps.max(12.0),
            "set before MPC_XY_CRUISE, which PX4 limits to it",
        );
        self.set(
            "MPC_XY_CRUISE",
            v.speed_mps,
            "planned ground speed; here and not DO_CHANGE_SPEED, with which a copter was seen to drift off",
        );
        self.set("MPC_ACC_HOR", v.accel_mps2, "planned acceleration");
        self.px4_vertical_speeds("planned climb", "planned descent");
        self.set(
            "NAV_ACC_RAD",
            corner_cut_m(options),
            "how far a corner may be cut: mission.tolerance_m",
        );
        self.set(
            "NAV_MC_ALT_RAD",
            altitude_acceptance_m(options),
            "a waypoint is accepted so far off its altitude, m: with the default of 0.8 a copter was seen to pass one too high, and to drift on",
        );
        self.armed_until_departure("COM_DISARM_PRFLT", -1.0);
        if let Some(amsl) = v.return_amsl {
            self.set(
                "RTL_RETURN_ALT",
                amsl.0 - home_amsl_m,
                "altitude of a return above home: return_amsl_m",
            );
            self.set("RTL_CONE_ANG", 0.0, "climb so high however near home");
            self.set("RTL_LAND_DELAY", 0.0, "do not wait over home, land there");
        }
    }

    /// PX4 fixed wing and VTOL.
    fn px4_wing(&mut self, wing: &Wing, options: &MissionOptions) {
        let v = self.vehicle;
        let (climb, descent) = ("planned climb, m/s", "planned descent, m/s");
        let airspeed = "planned speed, m/s, indicated airspeed";
        self.set("FW_AIRSPD_TRIM", v.speed_mps, airspeed);
        self.set("FW_R_LIM", self.bank_deg(), "bank of max_load_factor");
        self.set("FW_T_CLMB_MAX", v.climb_mps, climb);
        self.set("FW_T_CLMB_R_SP", v.climb_mps, climb);
        self.set("FW_T_SINK_MAX", v.descent_mps, descent);
        self.set("FW_T_SINK_R_SP", v.descent_mps, descent);
        self.loiter_radius("NAV_LOITER_RAD", wing);
        self.set(
            "NAV_ACC_RAD",
            corner_cut_m(options),
            "a waypoint is reached within this: mission.tolerance_m",
        );
        for name in ["NPFG_PERIOD", "NPFG_DAMPING", "NPFG_SW_DST_MLT"] {
            let default = parameter(name).map_or(0.0, ParameterRow::default_si);
            self.set(name, default, "the verdict judges corners with it");
        }
        self.set(
            "NAV_FW_ALT_RAD",
            ANY_HEIGHT_M,
            "a waypoint is passed so far off its altitude, m: PX4 would circle there, on a way nobody judged",
        );
        if let (Airframe::Plane, Some(landing)) = (v.airframe, wing.landing) {
            self.set(
                STEEPEST_GLIDE,
                landing.glide_rad.to_degrees(),
                "steepest glide that is not refused: landing.glide_deg",
            );
        }
        if v.airframe == Airframe::Vtol {
            self.px4_vertical_speeds("planned climb on rotors", "planned descent on rotors");
        }
        self.armed_until_departure("COM_DISARM_PRFLT", -1.0);
    }

    /// Climb and descent of PX4 on rotors, maximum speeds first: PX4 limits a speed to its maximum as
    /// soon as it is set. In the other order a copter climbed at 3 m/s instead of 4 and descended at
    /// 1.5 m/s instead of 3 (1.17, SIH simulator).
    fn px4_vertical_speeds(&mut self, climb: &str, descent: &str) {
        let v = self.vehicle;
        self.set(
            "MPC_Z_VEL_MAX_UP",
            v.climb_mps.max(3.0),
            "set before MPC_Z_V_AUTO_UP, which PX4 limits to it",
        );
        self.set(
            "MPC_Z_VEL_MAX_DN",
            v.descent_mps.max(1.5),
            "set before MPC_Z_V_AUTO_DN, which PX4 limits to it",
        );
        self.set("MPC_Z_V_AUTO_UP", v.climb_mps, climb);
        self.set("MPC_Z_V_AUTO_DN", v.descent_mps, descent);
        self.set("MPC_TKO_SPEED", v.climb_mps, "planned climb at takeoff");
        self.slow_landing("MPC_LAND_SPEED", "speed of the slow end of a landing");
    }

    fn slow_landing(&mut self, name: &'static str, why: &str) {
        self.set(name, self.vehicle.facts().behaviour.slow_landing_mps, why);
    }

    fn loiter_radius(&mut self, name: &'static str, wing: &Wing) {
        let why = "radius of circles where no item states one";
        self.set(name, wing.loiter_radius_m, why);
    }

    fn armed_until_departure(&mut self, name: &'static str, never: f64) {
        if self.vehicle.depart_s > 0.0 {
            self.set(name, never, "stay armed on the ground until the departure");
        }
    }

    /// The greatest lean angle, which decides how fast it flies.
    fn lean(&mut self, lean_deg: f64) {
        let why = "lean angle for the planned speed through the air";
        match self.vehicle.autopilot {
            Autopilot::ArduPilot => {
                let [new, old] = COPTER_LEAN;
                let unit = match name_in(new, self.vehicle.autopilot_version) == new {
                    true => "degrees",
                    false => "hundredths of a degree",
                };
                self.set(new, lean_deg, &format!("{why}, {unit}; more is as good"));
                self.set(
                    old,
                    lean_deg,
                    "the same before ArduCopter 4.7, hundredths of a degree",
                );
            }
            Autopilot::Px4 => {
                self.set(
                    PX4_LEAN,
                    lean_deg,
                    &format!("{why}, degrees; more is as good"),
                );
            }
        }
    }

    /// The fence reports or stops the vehicle: a return would fly a leg nobody judged.
    fn fence(&mut self, margin_m: f64) {
        let returns = "a return would fly a leg nobody judged";
        if self.vehicle.autopilot == Autopilot::Px4 {
            self.set("GF_ACTION", 2.0, &format!("hold at the fence: {returns}"));
            return;
        }
        let (action, does) = match self.vehicle.wing {
            None => (4.0, "brake, or land"),
            Some(_) => (0.0, "report only"),
        };
        self.set("FENCE_ENABLE", 1.0, "the fence that was written is watched");
        self.set(
            "FENCE_TYPE",
            4.0,
            "polygons and circles; altitudes are judged beforehand",
        );
        self.set("FENCE_ACTION", action, &format!("{does}: {returns}"));
        if margin_m > 0.0 {
            self.set(
                "FENCE_MARGIN",
                margin_m.min(WIDEST_FENCE_MARGIN_M),
                "distance that the plan keeps from the fence, m: buffer_m, at most what the parameter holds",
            );
        }
    }

    /// Bank at which the planned load factor is reached, degrees.
    fn bank_deg(&self) -> f64 {
        (1.0 / self.vehicle.max_load_factor).acos().to_degrees()
    }
}
