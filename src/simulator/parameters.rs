//! The parameters of a simulated vehicle, and how it flies by them.

mod wing;

use std::collections::BTreeMap;

pub(crate) use wing::{Follows, Passes, WingLimits};

use super::profile::Profile;
use crate::autopilot::{Airframe, Cornering, ParameterRow, parameter};
use crate::link::ParamValue;

/// `MAV_PARAM_TYPE_INT32`.
const INT_32: u8 = 6;

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
    /// A waypoint is passed only within this of its altitude, metres; none: at any.
    pub(crate) level_m: Option<f64>,
    pub(crate) takeoff_mps: f64,
    pub(crate) climb_mps: f64,
    pub(crate) descent_mps: f64,
    /// How far a corner may be cut.
    pub(crate) corner_cut_m: f64,
    /// How the autopilot flies corners, if that is known.
    pub(crate) cornering: Option<Cornering>,
    /// Below this height a landing is slow.
    pub(crate) slow_landing_m: f64,
    pub(crate) slow_landing_mps: f64,
    /// Down to place a load.
    pub(crate) placing_mps: f64,
    /// Height above home of a return.
    pub(crate) return_m: f64,
    /// On the ground, armed, without a takeoff for so long; none for ever, seconds.
    pub(crate) idle_s: Option<f64>,
}

impl Settings {
    /// The values that a vehicle comes with.
    pub(crate) fn of(profile: Profile, airframe: Airframe) -> Self {
        let tables = profile.facts(airframe).parameters.iter().copied().flatten();
        let version = profile.version();
        let has = |row: &&ParameterRow| version.is_none_or(|v| row.versions.contains(v));
        let named = |row: &ParameterRow| (row.name.to_owned(), row.default);
        Self {
            profile,
            airframe,
            values: tables.filter(has).map(named).collect(),
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
        self.is_bytewise() && parameter(name).is_some_and(|row| row.is_int32)
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

    fn cornering(&self, accel_mps2: f64) -> Option<Cornering> {
        let law = self.profile.facts(self.airframe).corners;
        law.map(|law| Cornering::new(law, accel_mps2))
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
            cornering: self.cornering(accel_mps2),
            level_m: None,
            slow_landing_m: metres("LAND_ALT_LOW"),
            slow_landing_mps: metres("LAND_SPEED").max(0.1),
            placing_mps: match self.of_name("PLDP_SPEED_DN") {
                placing_mps if placing_mps > 0.0 => placing_mps,
                _ => metres("LAND_SPEED").max(0.1),
            },
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
            cornering: self.cornering(accel_mps2),
            level_m: Some(self.of_name("NAV_MC_ALT_RAD").max(0.1)),
            slow_landing_m: self.of_name("MPC_LAND_ALT2"),
            slow_landing_mps: self.of_name("MPC_LAND_SPEED").max(0.1),
            placing_mps: self.of_name("MPC_LAND_SPEED").max(0.1),
            return_m: self.of_name("RTL_RETURN_ALT"),
            idle_s: (idle_s > 0.0).then_some(idle_s),
        }
    }
}
