//! The parameters of a simulated vehicle, and how it flies by them.

mod wing;

use std::collections::BTreeMap;

pub(crate) use wing::{Follows, Passes, WingLimits};

use super::profile::Profile;
use crate::link::ParamValue;
use crate::spec::Airframe;

/// `MAV_PARAM_TYPE_INT32`.
const INT_32: u8 = 6;

/// Those that shape a flight on rotors, with the values an ArduCopter 4.6 comes with.
const ARDUPILOT: &[(&str, f32)] = &[
    ("WPNAV_SPEED", 1000.0),
    ("WPNAV_ACCEL", 250.0),
    ("WPNAV_ACCEL_C", 0.0),
    ("WPNAV_ACCEL_Z", 100.0),
    ("WPNAV_SPEED_UP", 250.0),
    ("WPNAV_SPEED_DN", 150.0),
    ("WPNAV_RADIUS", 200.0),
    ("LAND_SPEED_HIGH", 0.0),
    ("LAND_ALT_LOW", 1000.0),
    ("LAND_SPEED", 50.0),
    ("DISARM_DELAY", 10.0),
    ("RTL_ALT", 1500.0),
    ("FENCE_ENABLE", 0.0),
    ("FENCE_TYPE", 7.0),
    ("FENCE_ACTION", 1.0),
];

/// The same of PX4 1.16.
const PX4: &[(&str, f32)] = &[
    ("MPC_XY_CRUISE", 5.0),
    ("MPC_XY_VEL_MAX", 12.0),
    ("MPC_ACC_HOR", 3.0),
    ("MPC_ACC_UP_MAX", 4.0),
    ("MPC_Z_V_AUTO_UP", 3.0),
    ("MPC_Z_V_AUTO_DN", 1.5),
    ("MPC_Z_VEL_MAX_UP", 3.0),
    ("MPC_Z_VEL_MAX_DN", 1.5),
    ("MPC_TKO_SPEED", 1.5),
    ("MPC_LAND_SPEED", 0.7),
    ("MPC_LAND_ALT2", 5.0),
    ("NAV_ACC_RAD", 10.0),
    ("COM_DISARM_PRFLT", 10.0),
    ("RTL_RETURN_ALT", 60.0),
    ("GF_ACTION", 2.0),
];

/// Whole numbers of PX4; its others are floats.
const PX4_WHOLE: &[&str] = &["GF_ACTION"];

/// Parameters by name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Settings {
    profile: Profile,
    airframe: Airframe,
    values: BTreeMap<String, f32>,
}

/// How a vehicle flies on rotors: m, m/s, m/s^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits {
    pub(crate) speed_mps: f64,
    pub(crate) accel_mps2: f64,
    pub(crate) corner_accel_mps2: f64,
    pub(crate) accel_z_mps2: f64,
    pub(crate) takeoff_mps: f64,
    pub(crate) climb_mps: f64,
    pub(crate) descent_mps: f64,
    /// How far a corner may be cut.
    pub(crate) corner_cut_m: f64,
    /// Below this height a landing is slow.
    pub(crate) slow_landing_m: f64,
    pub(crate) slow_landing_mps: f64,
    /// Height above home of a return.
    pub(crate) return_m: f64,
    /// On the ground, armed, without a takeoff for so long; none for ever, seconds.
    pub(crate) idle_s: Option<f64>,
}

impl Settings {
    /// What a vehicle comes with.
    pub(crate) fn of(profile: Profile, airframe: Airframe) -> Self {
        let defaults: &[&[(&str, f32)]] = match (profile, airframe) {
            (Profile::ArduPilot | Profile::Generic, Airframe::Copter) => &[ARDUPILOT],
            (Profile::ArduPilot | Profile::Generic, Airframe::Plane) => &[wing::ARDUPLANE],
            (Profile::ArduPilot | Profile::Generic, Airframe::Vtol) => {
                &[wing::ARDUPLANE, wing::QUADPLANE]
            }
            (Profile::Px4, Airframe::Copter) => &[PX4],
            (Profile::Px4, Airframe::Plane) => &[wing::PX4_WING],
            (Profile::Px4, Airframe::Vtol) => &[PX4, wing::PX4_WING, wing::PX4_VTOL],
        };
        let named = |&(name, value): &(&str, f32)| (name.to_owned(), value);
        Self {
            profile,
            airframe,
            values: defaults.concat().iter().map(named).collect(),
        }
    }

    /// Sets one; also one that it did not have.
    pub(crate) fn set(&mut self, name: &str, value: f32) {
        self.values.insert(name.to_owned(), value);
    }

    /// One as it goes over the wire, if the vehicle has it.
    pub(crate) fn on_wire(&self, name: &str) -> Option<ParamValue> {
        let value = *self.values.get(name)?;
        let kind = ParamValue {
            kind: if self.is_whole(name) {
                INT_32
            } else {
                ParamValue::float(0.0).kind
            },
            bytes: [0; 4],
        };
        Some(kind.with(value, self.is_bytewise()))
    }

    /// Takes one from the wire, if the vehicle has it.
    pub(crate) fn take_wire(&mut self, name: &str, value: ParamValue) {
        let bytewise = self.is_bytewise();
        if let Some(held) = self.values.get_mut(name) {
            *held = value.value(bytewise);
        }
    }

    fn is_whole(&self, name: &str) -> bool {
        self.is_bytewise() && PX4_WHOLE.contains(&name)
    }

    fn is_bytewise(&self) -> bool {
        self.profile == Profile::Px4
    }

    fn of_name(&self, name: &str) -> f64 {
        f64::from(self.values.get(name).copied().unwrap_or(0.0))
    }

    /// How the vehicle flies by them.
    pub(crate) fn limits(&self) -> Limits {
        match (self.profile, self.airframe) {
            (Profile::Px4, Airframe::Vtol) => self.px4_vtol(),
            (Profile::Px4, Airframe::Copter | Airframe::Plane) => self.px4(),
            (_, Airframe::Vtol) => self.quadplane(),
            (_, Airframe::Copter | Airframe::Plane) => self.ardupilot(),
        }
    }

    fn ardupilot(&self) -> Limits {
        let metres = |name| self.of_name(name) / 100.0;
        let accel_mps2 = metres("WPNAV_ACCEL").max(0.5);
        let corner = metres("WPNAV_ACCEL_C");
        let down = metres("WPNAV_SPEED_DN").max(0.1);
        let idle_s = self.of_name("DISARM_DELAY");
        Limits {
            speed_mps: metres("WPNAV_SPEED").max(0.2),
            accel_mps2,
            // 0 means twice WPNAV_ACCEL.
            corner_accel_mps2: if corner > 0.0 {
                corner
            } else {
                2.0 * accel_mps2
            },
            accel_z_mps2: metres("WPNAV_ACCEL_Z").max(0.5),
            takeoff_mps: metres("WPNAV_SPEED_UP").max(0.1),
            climb_mps: metres("WPNAV_SPEED_UP").max(0.1),
            descent_mps: down,
            corner_cut_m: metres("WPNAV_RADIUS").max(0.1),
            slow_landing_m: metres("LAND_ALT_LOW"),
            slow_landing_mps: metres("LAND_SPEED").max(0.1),
            return_m: metres("RTL_ALT"),
            idle_s: (idle_s > 0.0).then_some(idle_s),
        }
    }

    fn px4(&self) -> Limits {
        let accel_mps2 = self.of_name("MPC_ACC_HOR").max(0.5);
        let idle_s = self.of_name("COM_DISARM_PRFLT");
        let speed_mps = self.of_name("MPC_XY_CRUISE");
        Limits {
            speed_mps: speed_mps.min(self.of_name("MPC_XY_VEL_MAX")).max(0.2),
            accel_mps2,
            corner_accel_mps2: accel_mps2,
            accel_z_mps2: self.of_name("MPC_ACC_UP_MAX").max(0.5),
            takeoff_mps: self.of_name("MPC_TKO_SPEED").max(0.1),
            climb_mps: self.of_name("MPC_Z_V_AUTO_UP").max(0.1),
            descent_mps: self.of_name("MPC_Z_V_AUTO_DN").max(0.1),
            corner_cut_m: self.of_name("NAV_ACC_RAD").max(0.1),
            slow_landing_m: self.of_name("MPC_LAND_ALT2"),
            slow_landing_mps: self.of_name("MPC_LAND_SPEED").max(0.1),
            return_m: self.of_name("RTL_RETURN_ALT"),
            idle_s: (idle_s > 0.0).then_some(idle_s),
        }
    }
}
