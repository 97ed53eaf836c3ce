//! What no mission file says and its flight depends on: where it begins without a takeoff, and by
//! which parameters it returns.

use crate::autopilot::{Airframe, Autopilot, name_in, other_name, parameter};
use crate::cli::args::Limits;
use crate::geodesy::{Amsl, LatLon, PlanPoint};
use crate::mission::{Item, Parameter, VehicleMission, command, frame, lean_limit_deg};
use crate::path::heading_rad;
use crate::spec::Vehicle;
use crate::verify::{Limit, Margin};
use crate::world::{Departure, Terrain, World};

use super::airspeeds;

/// Items after which no wing returns by itself.
const ENDS: [u16; 3] = [
    command::NAV_LAND,
    command::NAV_VTOL_LAND,
    command::NAV_LOITER_UNLIM,
];
/// Items that a wing circles at.
const CIRCLES: [u16; 4] = [
    command::NAV_LOITER_UNLIM,
    command::NAV_LOITER_TURNS,
    command::NAV_LOITER_TIME,
    command::NAV_LOITER_TO_ALT,
];

/// Adds the defaults of the parameters by which the autopilot returns and circles, where the
/// mission needs them, and a sentence for each set of them.
pub(super) fn returns(
    vehicle: &Vehicle,
    mission: &mut VehicleMission,
    limits: &Limits,
    assumed: &mut Vec<String>,
) {
    assumed.extend(slopes(vehicle).into_iter().chain(arms(vehicle, mission)));
    let holds = |commands: &[u16]| {
        let mut items = mission.items.iter();
        items.any(|item| commands.contains(&item.command))
    };
    let returns = holds(&[command::NAV_RETURN_TO_LAUNCH]);
    let (has_wing, ends) = (vehicle.airframe.has_wing(), holds(&ENDS));
    let names: &[&str] = match (mission.autopilot, has_wing) {
        (Autopilot::ArduPilot, true) if returns || !ends => &["RTL_ALTITUDE", "WP_LOITER_RAD"],
        (Autopilot::ArduPilot, true) if holds(&CIRCLES) => &["WP_LOITER_RAD"],
        (Autopilot::Px4, true) if holds(&CIRCLES) || !ends => &["NAV_LOITER_RAD"],
        (_, true) => &[],
        _ if !returns || limits.return_amsl.is_some() => &[],
        (Autopilot::ArduPilot, false) => &["RTL_ALT", "RTL_CONE_SLOPE", "RTL_LOIT_TIME"],
        (Autopilot::Px4, false) => &["RTL_RETURN_ALT", "RTL_CONE_ANG"],
    };
    if limits.return_amsl.is_some() && !has_wing {
        // The flag says so, whatever the parameters next to the mission say.
        drop_param(mission, "RTL_ALT");
        drop_param(mission, "RTL_RETURN_ALT");
    }
    let mut stated = Vec::new();
    for &name in names {
        let given = limits.return_amsl.filter(|_| name == "RTL_ALTITUDE");
        let name = name_in(name, mission.autopilot_version);
        let Some(row) = parameter(name) else { continue };
        if given.is_none() && mission.param(name).is_some() {
            continue;
        }
        drop_param(mission, name);
        #[expect(clippy::cast_possible_truncation, reason = "parameters are float32")]
        let value = given.map_or(row.default, |amsl_m| {
            (amsl_m - f64::from(mission.home.amsl_m)) as f32
        });
        stated.push(format!("{name} {value}"));
        mission.params.push(Parameter {
            name: name.to_owned(),
            value,
            why: "the default of the autopilot".to_owned(),
        });
    }
    if !stated.is_empty() {
        let stated = stated.join(", ");
        assumed.push(format!(
            "{}: returns and circles by the defaults of {} ({stated}; --return-amsl)",
            vehicle.id,
            mission.autopilot.name()
        ));
    }
    if returns || mission.autopilot == Autopilot::ArduPilot && has_wing && !ends {
        assumed.extend(cruise(vehicle, mission, limits));
    }
}

/// The sentence for a copter whose autopilot flies slopes in another way in a later version, which is judged too.
fn slopes(vehicle: &Vehicle) -> Option<String> {
    let range = vehicle.facts().heights_at_once?;
    Some(format!(
        "{}: judged as flown with even slopes, and as {} {range} flies it, which is at the altitude of the end of a leg soon after its beginning",
        vehicle.id,
        vehicle.autopilot.name()
    ))
}

/// The sentence for a wing that its autopilot does not arm for this mission with stock parameters.
fn arms(vehicle: &Vehicle, mission: &VehicleMission) -> Option<String> {
    let holds = |commands: &[u16]| {
        mission
            .items
            .iter()
            .any(|item| commands.contains(&item.command))
    };
    let is_set = |name: &str, is: fn(f64) -> bool| mission.param(name).is_some_and(is);
    let landings = [command::NAV_LAND, command::NAV_VTOL_LAND];
    let why = match mission.autopilot {
        // `AP_Arming_Plane::mission_checks`.
        Autopilot::ArduPilot
            if holds(&[command::DO_LAND_START]) && !is_set("RTL_AUTOLAND", |value| value > 0.5) =>
        {
            "RTL_AUTOLAND 0, the default, does not arm with a DO_LAND_START in its mission"
        }
        // `FeasibilityChecker`, with the default of wings.
        Autopilot::Px4 if !holds(&landings) && !is_set("MIS_TKO_LAND_REQ", |value| value < 1.5) => {
            "MIS_TKO_LAND_REQ 2, the default of planes and VTOLs, does not fly a mission without a landing"
        }
        _ => return None,
    };
    let has_wing = vehicle.airframe.has_wing();
    has_wing.then(|| format!("{}: {why}", vehicle.id))
}

/// The version of the spec: where times are judged, that in which copters must reach their speeds (2), if one is held to it.
pub(super) fn version(missions: &[(usize, VehicleMission)], limits: &Limits) -> u32 {
    let mut missions = missions.iter();
    let is_held = missions.any(|(_, mission)| must_reach_its_speed(mission));
    match limits.separation.is_some() && is_held {
        true => 2,
        false => 1,
    }
}

/// Whether a copter is commanded more than the speed that its autopilot has by default, or leans less than by default.
pub(super) fn must_reach_its_speed(mission: &VehicleMission) -> bool {
    let defaults = mission.facts().defaults;
    let stock_deg = mission.facts().behaviour.lean_deg;
    let leans_less = lean_limit_deg(mission).is_some_and(|held_deg| held_deg < stock_deg - 1e-3);
    let stock_mps = defaults.cruise_mps();
    let held_mps = mission.param_si(defaults.cruise_parameter);
    let changes = airspeeds::changes(&mission.items, (mission.autopilot, mission.airframe));
    let commanded_mps = changes.map(|(_, item)| f64::from(item.params[1]));
    let is_faster = commanded_mps.chain(held_mps).any(|mps| mps > stock_mps);
    mission.airframe == Airframe::Copter && (leans_less || is_faster)
}

/// Adds the speed of a return where the mission commanded another one, which that forgets, and the sentence for it.
fn cruise(vehicle: &Vehicle, mission: &mut VehicleMission, limits: &Limits) -> Option<String> {
    let name = mission.facts().defaults.cruise_parameter;
    let name = name_in(name, mission.autopilot_version);
    let changes = |item: &Item| item.command == command::DO_CHANGE_SPEED;
    if mission.param_si(name).is_some() || !mission.items.iter().any(changes) {
        return None;
    }
    let row = parameter(name)?;
    #[expect(clippy::cast_possible_truncation, reason = "parameters are float32")]
    let value = (limits.speed).map_or(row.default, |mps| (mps * row.unit.per_si()) as f32);
    mission.params.push(Parameter {
        name: name.to_owned(),
        value,
        why: "the default of the autopilot".to_owned(),
    });
    Some(format!(
        "{}: returns at the cruise speed of {name} {value} and not at one of DO_CHANGE_SPEED (--speed)",
        vehicle.id
    ))
}

/// Removes a parameter, under whichever of its names.
fn drop_param(mission: &mut VehicleMission, name: &str) {
    let is_it = |held: &str| held == name || other_name(name) == Some(held);
    mission.params.retain(|param| !is_it(&param.name));
}

/// Points the takeoff of a plane to its first place: no file holds the course that it has.
pub(super) fn takeoff_heading(
    vehicle: &mut Vehicle,
    mission: &VehicleMission,
    assumed: &mut Vec<String>,
) {
    let (home, first) = (vehicle.home, vehicle.start.place);
    let takes_off = mission
        .items
        .iter()
        .any(|item| item.command == command::NAV_TAKEOFF);
    let Some(wing) = vehicle.wing.as_mut() else {
        return;
    };
    if vehicle.airframe != Airframe::Plane || !takes_off || home == first {
        return;
    }
    let east = (first.lon_deg - home.lon_deg) * home.lat_deg.to_radians().cos();
    let heading_rad = east.atan2(first.lat_deg - home.lat_deg);
    wing.takeoff_heading_rad = Some(heading_rad);
    assumed.push(format!(
        "{}: takes off towards its first waypoint, {:.0} degrees from north: the file holds no course (--takeoff-heading)",
        vehicle.id,
        heading_rad.to_degrees().rem_euclid(360.0)
    ));
}

/// Begins a mission without a takeoff in the air, at its first place. Returns the margin that
/// fails for it, unless `--airborne` says that it is so.
pub(super) fn begin_in_air(
    (index, vehicle): (usize, &Vehicle),
    mission: &VehicleMission,
    world: &mut World,
    limits: &Limits,
    assumed: &mut Vec<String>,
) -> Option<Margin> {
    let (row, point, next) = first_place(mission, world)?;
    world.sites[index].departure = Departure::Airborne {
        point,
        course_rad: next.map_or(0.0, |next| heading_rad(point.at, next)),
        speed_mps: match vehicle.airframe.has_wing() {
            true => vehicle.speed_mps,
            false => 0.0,
        },
        at_s: 0.0,
    };
    let judged = format!("judged as begun in the air at item {row}; the way there is not judged");
    if limits.airborne {
        assumed.push(format!("{}: {judged} (--airborne)", vehicle.id));
        return None;
    }
    let why = format!(
        "mission item {row}: takeoff first: {} does not fly this mission from the ground; {judged} (--airborne: it begins there)",
        mission.autopilot.name()
    );
    Some(Margin::unjudged(&vehicle.id, Limit::Acceptance, why))
}

/// The first place of a mission that needs a takeoff and has none before it: row, point, and where
/// it goes from there.
fn first_place(
    mission: &VehicleMission,
    world: &World,
) -> Option<(usize, PlanPoint, Option<crate::geodesy::EastNorth>)> {
    let is_home_known = (mission.home.x, mission.home.y) != (0, 0);
    if !mission.facts().acceptance.needs_takeoff || !is_home_known {
        return None;
    }
    let navigates =
        |item: &Item| item.command <= command::NAV_LAST && item.command != command::NAV_DELAY;
    let index = mission.items.iter().position(navigates)?;
    let item = &mission.items[index];
    let goes = matches!(
        item.command,
        command::NAV_WAYPOINT
            | command::NAV_LOITER_UNLIM
            | command::NAV_LOITER_TURNS
            | command::NAV_LOITER_TIME
            | command::NAV_LOITER_TO_ALT
            | command::NAV_SPLINE_WAYPOINT
    );
    let place = |item: &Item| item.place().filter(|_| (item.x, item.y) != (0, 0));
    let at = place(item).filter(|_| goes && item.z.is_finite() && item.z.abs() >= 0.01)?;
    let amsl = amsl(item, at, mission, &world.terrain)?;
    let next = mission.items[index + 1..].iter().find_map(place);
    let point = PlanPoint {
        at: world.frame.to_plan(at),
        amsl,
    };
    Some((index + 1, point, next.map(|next| world.frame.to_plan(next))))
}

/// The altitude of an item with a place; none over ground that is not known.
pub(super) fn amsl(
    item: &Item,
    at: LatLon,
    mission: &VehicleMission,
    terrain: &Terrain,
) -> Option<Amsl> {
    let z_m = f64::from(item.z);
    match frame::canonical(item.frame) {
        frame::GLOBAL => Some(Amsl(z_m)),
        frame::GLOBAL_RELATIVE_ALT => Some(Amsl(f64::from(mission.home.amsl_m) + z_m)),
        frame::GLOBAL_TERRAIN_ALT => Some(Amsl(terrain.height(at).ok()?.0 + z_m)),
        _ => None,
    }
}
