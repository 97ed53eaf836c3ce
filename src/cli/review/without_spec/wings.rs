//! How high and how fast a wing (a plane or VTOL) flies that no spec describes: at its mission, by its parameters.

use super::assumed::amsl;
use super::rates::Rates;
use crate::cli::args::Limits;
use crate::geodesy::Amsl;
use crate::mission::{VehicleMission, command};
use crate::spec::{Airframe, Vehicle, turn_radius_by_load_m};
use crate::world::Terrain;

/// Sets what the verdict takes from a spec: the ceiling at whose speed a wing turns at the widest, its
/// circles, and on a plane the climb and descent.
pub(super) fn describe(
    vehicles: &mut [Vehicle],
    missions: &[(usize, VehicleMission)],
    terrain: &Terrain,
    limits: &Limits,
) {
    for (index, mission) in missions {
        describe_one(&mut vehicles[*index], mission, terrain, limits);
    }
}

fn describe_one(
    vehicle: &mut Vehicle,
    mission: &VehicleMission,
    terrain: &Terrain,
    limits: &Limits,
) {
    let Some(mut wing) = vehicle.wing else {
        return;
    };
    wing.ceiling = Amsl(limits.max_amsl.unwrap_or_else(|| top_m(mission, terrain)));
    let fastest_mps = vehicle.fastest_at_mps(vehicle.speed_mps, wing.ceiling);
    wing.loiter_radius_m = turn_radius_by_load_m(fastest_mps, vehicle.max_load_factor).ceil();
    vehicle.wing = Some(wing);
    if vehicle.airframe == Airframe::Plane
        && let Some(rates) = Rates::of(&vehicle.id, mission)
    {
        vehicle.climb_mps = limits.climb.unwrap_or(rates.climb_mps);
        vehicle.descent_mps = limits.descent.unwrap_or(rates.descent_mps);
    }
}

/// The highest place of a mission, that of its return included, metres above mean sea level.
fn top_m(mission: &VehicleMission, terrain: &Terrain) -> f64 {
    let home_m = f64::from(mission.home.amsl_m);
    let of_items = mission.items.iter().filter_map(|item| {
        let at = item.place()?;
        (item.command <= command::NAV_LAST && item.z.is_finite())
            .then(|| amsl(item, at, mission, terrain))?
    });
    let return_m = mission.param_si("RTL_ALTITUDE").map(|up_m| home_m + up_m);
    let all_m = of_items.map(|amsl| amsl.0).chain(return_m);
    all_m.fold(home_m, f64::max)
}
