//! A vehicle as the parameters of its mission set it, where they say something else than the spec.

use std::borrow::Cow;
use std::slice;

use super::item::VehicleMission;
use crate::spec::Vehicle;

/// A float32, in centimetres or degrees, is the planned value within this share.
const SAME_SHARE: f64 = 1e-4;

/// The parameters that limit climb and descent, on the wing where there is one; the least of each list holds.
#[must_use]
pub fn rate_parameters(mission: &VehicleMission) -> Option<[&'static [&'static str]; 2]> {
    let defaults = &mission.facts().defaults;
    let of_copter = || {
        let [up, down, _] = defaults.motion_parameters.as_ref()?;
        Some([up, down].map(slice::from_ref))
    };
    defaults.rate_parameters.or_else(of_copter)
}

/// The vehicle as the parameters of its mission make it climb, descend, accelerate and bank. Those of
/// a wing are limits: they make it no faster than planned.
#[must_use]
pub fn as_set<'a>(vehicle: &'a Vehicle, mission: &VehicleMission) -> Cow<'a, Vehicle> {
    let defaults = mission.facts().defaults;
    match rate_parameters(mission) {
        Some(rates) if vehicle.airframe.has_wing() => {
            let mut set = Cow::Borrowed(vehicle);
            let planned = [vehicle.climb_mps, vehicle.descent_mps];
            let less = [0, 1].map(|way| {
                let held = rates[way]
                    .iter()
                    .filter_map(|name| other_than(planned[way], mission, name));
                held.filter(|held| *held < planned[way]).reduce(f64::min)
            });
            set_rates(&mut set, less);
            if let Some(load_factor) = load_factor(vehicle, mission) {
                set.to_mut().max_load_factor = load_factor;
            }
            set
        }
        _ => {
            let mut set = Cow::Borrowed(vehicle);
            let Some([up, down, accel]) = defaults.motion_parameters else {
                return set;
            };
            let held = [
                other_than(vehicle.climb_mps, mission, up),
                other_than(vehicle.descent_mps, mission, down),
            ];
            set_rates(&mut set, held);
            keep_down(&mut set, mission);
            if let Some(accel_mps2) = other_than(vehicle.accel_mps2, mission, accel) {
                set.to_mut().accel_mps2 = accel_mps2;
            }
            set
        }
    }
}

/// The same of a vehicle on its rotors: of one with a wing they have parameters of their own.
#[must_use]
pub fn as_set_on_rotors<'a>(vehicle: &'a Vehicle, mission: &VehicleMission) -> Cow<'a, Vehicle> {
    let mut set = as_set(vehicle, mission);
    if let Some([up, down]) = mission.facts().defaults.rotor_parameters {
        let of_spec = [Some(vehicle.climb_mps), Some(vehicle.descent_mps)];
        if let Cow::Owned(_) = set {
            set_rates(&mut set, of_spec);
        }
        let held = [
            other_than(vehicle.climb_mps, mission, up),
            other_than(vehicle.descent_mps, mission, down),
        ];
        set_rates(&mut set, held);
        keep_down(&mut set, mission);
    }
    set
}

/// The value of a parameter that is another than the planned one, in SI units.
fn other_than(planned: f64, mission: &VehicleMission, name: &str) -> Option<f64> {
    let held = mission.param_si(name).filter(|held| *held > 0.0)?;
    ((held - planned).abs() > SAME_SHARE * planned).then_some(held)
}

/// Climb and descent on rotors within the greatest ones of the parameters (PX4: `MulticopterPositionControl` lowers
/// `MPC_Z_V_AUTO_UP` and `MPC_Z_V_AUTO_DN` to them).
fn keep_down(set: &mut Cow<'_, Vehicle>, mission: &VehicleMission) {
    let Some(names) = mission.facts().defaults.max_rotor_parameters else {
        return;
    };
    let rates_mps = [set.climb_mps, set.descent_mps];
    let less = [0, 1].map(|way| {
        let held = other_than(rates_mps[way], mission, names[way]);
        held.filter(|held| *held < rates_mps[way])
    });
    set_rates(set, less);
}

fn set_rates(set: &mut Cow<'_, Vehicle>, [climb_mps, descent_mps]: [Option<f64>; 2]) {
    if let Some(climb_mps) = climb_mps {
        set.to_mut().climb_mps = climb_mps;
    }
    if let Some(descent_mps) = descent_mps {
        set.to_mut().descent_mps = descent_mps;
    }
}

/// The load factor of the greatest bank, where that is less than planned.
fn load_factor(vehicle: &Vehicle, mission: &VehicleMission) -> Option<f64> {
    let name = mission.facts().defaults.bank_parameter?;
    let planned_deg = (1.0 / vehicle.max_load_factor).acos().to_degrees();
    let held_deg = other_than(planned_deg, mission, name)?;
    (held_deg < planned_deg).then(|| 1.0 / held_deg.to_radians().cos())
}
