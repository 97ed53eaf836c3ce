//! Values of a spec that are allowed, and that look as if they were in another unit.

use super::{World, sunken_zones};
use crate::numeric::digits::plain;
use crate::spec::{MissionSpec, Vehicle};

const FOOT_M: f64 = 0.3048;
const KMH_MPS: f64 = 1.0 / 3.6;
/// A ceiling is rarely further above the highest place of a mission, metres.
const HIGH_M: f64 = 1500.0;
/// Legal ceilings above ground, in metres: 300 to 500 feet.
const LEGAL_M: std::ops::RangeInclusive<f64> = 91.0..=153.0;
/// Steepest slope in radians.
const STEEPEST_RAD: f64 = std::f64::consts::FRAC_PI_2;
/// Copters and wings rarely fly faster, m/s.
const FAST_MPS: (f64, f64) = (20.0, 40.0);
/// Nothing is flown in more wind, m/s.
const STORM_MPS: f64 = 20.0;

/// Warnings of a spec: ceilings that look like feet or are under the ground, slopes that look like
/// radians, speeds that look like km/h; each with its key and what the value would be.
#[must_use]
pub fn unit_warnings(spec: &MissionSpec, world: &World) -> Vec<String> {
    let mut warnings = Vec::new();
    let sites = world.sites.iter();
    let highest_m = sites
        .flat_map(|of| {
            [of.start, of.goal]
                .into_iter()
                .chain(of.stops.iter().copied())
        })
        .chain(world.tasks.iter().flatten().copied())
        .map(|point| point.amsl.0)
        .fold(f64::NEG_INFINITY, f64::max);
    let top_m = spec.area.max_amsl.0;
    let in_feet_m = top_m * FOOT_M;
    if top_m - highest_m > HIGH_M && in_feet_m > highest_m {
        warnings.push(format!(
            "area.max_amsl_m: {} m is {:.0} m above the highest start, goal or stop; is it in feet? Those are {in_feet_m:.0} m",
            plain(top_m),
            top_m - highest_m
        ));
    }
    let area = spec.area.altitudes.max_agl;
    let of_area = area.map(|agl| ("area.max_agl_m".to_owned(), agl.0));
    let own = |vehicle: &Vehicle| {
        let agl = vehicle.altitudes.max_agl.filter(|agl| Some(*agl) != area);
        agl.map(|agl| (format!("{}: max_agl_m", vehicle.id), agl.0))
    };
    for (key, agl_m) in of_area
        .into_iter()
        .chain(spec.vehicles.iter().filter_map(own))
    {
        let in_feet_m = agl_m * FOOT_M;
        if LEGAL_M.contains(&in_feet_m) {
            warnings.push(format!(
                "{key}: {} m; is it in feet? Those are {in_feet_m:.0} m",
                plain(agl_m)
            ));
        }
    }
    warnings.extend(sunken_zones::warnings(spec, world));
    warnings.extend(spec.vehicles.iter().flat_map(of_vehicle));
    let wind = spec.wind.filter(|wind| wind.speed_mps > STORM_MPS);
    warnings.extend(wind.map(|wind| as_kmh("wind.speed_mps", wind.speed_mps)));
    warnings
}

fn of_vehicle(vehicle: &Vehicle) -> Vec<String> {
    let id = &vehicle.id;
    let slopes = [
        ("max_climb_deg", vehicle.max_climb_rad),
        ("max_descent_deg", vehicle.max_descent_rad),
    ];
    let mut warnings = Vec::new();
    for (key, rad) in slopes {
        let deg = rad.map(f64::to_degrees).filter(|deg| *deg < STEEPEST_RAD);
        warnings.extend(deg.map(|deg| {
            format!(
                "{id}: {key}: {} degrees; is it in radians? Those are {:.1} degrees",
                plain(deg),
                deg.to_degrees()
            )
        }));
    }
    let max_mps = match vehicle.wing {
        None => FAST_MPS.0,
        Some(_) => FAST_MPS.1,
    };
    if vehicle.speed_mps > max_mps {
        warnings.push(as_kmh(&format!("{id}: speed_mps"), vehicle.speed_mps));
    }
    warnings
}

fn as_kmh(key: &str, speed_mps: f64) -> String {
    format!(
        "{key}: {} m/s; is it in km/h? Those are {:.1} m/s",
        plain(speed_mps),
        speed_mps * KMH_MPS
    )
}
