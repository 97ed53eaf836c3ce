//! Items as a plane or vtol reads them.

use crate::geodesy::{AboveHome, Amsl};
use crate::mission::{Item, VehicleMission, command};
use crate::spec::{Airframe, Autopilot};

use crate::verify::execute::item::{self, Circling, Height, Order, Until, place};

/// What one item makes a plane or vtol do.
///
/// An altitude of 0 is one: ArduPlane keeps its present altitude only where the place is 0, 0 as
/// well (`Plane::set_next_WP`).
pub(crate) fn read(item: &Item, mission: &VehicleMission, home: Amsl) -> Result<Order, String> {
    let autopilot = mission.autopilot;
    if autopilot.conventions().waits_without_autocontinue && !item.autocontinue {
        return Err("autocontinue is off: the vehicle waits for a command there".to_owned());
    }
    // `Plane::mission_alt_offset`.
    let offset_m = mission.param("ALT_OFFSET").unwrap_or(0.0);
    if autopilot == Autopilot::ArduPilot
        && item.command <= command::NAV_LAST
        && offset_m.abs() > 0.0
    {
        return Err(format!("ALT_OFFSET raises its altitude by {offset_m} m"));
    }
    // `AP_Landing::type_deepstall`.
    let kind = mission.param("LAND_TYPE").unwrap_or(0.0);
    if autopilot == Autopilot::ArduPilot && item.command == command::NAV_LAND && kind.abs() >= 0.5 {
        return Err(format!("a landing with LAND_TYPE {kind}: a deep stall"));
    }
    let [_, second, third, _] = item.params.map(f64::from);
    match item.command {
        command::NAV_TAKEOFF
        | command::NAV_VTOL_TAKEOFF
        | command::NAV_LAND
        | command::NAV_VTOL_LAND => end(item, mission, home),
        command::NAV_WAYPOINT => waypoint(item, mission, home),
        command::NAV_LOITER_UNLIM => Ok(Order::Stay {
            at: Some(place(item)?),
            height: item::height(item, autopilot, home)?,
            radius_m: Some(radius_m(third, mission)?),
        }),
        command::NAV_LOITER_TURNS if autopilot == Autopilot::ArduPilot => {
            let circle = item::turns(item)?;
            circled(item, mission, home, (circle.until, circle.radius_m))
        }
        command::NAV_LOITER_TIME => {
            let seconds = Until::Seconds(item::hold_s(item.params[0], autopilot)?);
            circled(item, mission, home, (seconds, third))
        }
        command::NAV_LOITER_TO_ALT => circled(item, mission, home, (Until::Altitude, second)),
        command::NAV_RETURN_TO_LAUNCH if autopilot == Autopilot::ArduPilot => Ok(Order::Return),
        command::NAV_RETURN_TO_LAUNCH => Err(
            "NAV_RETURN_TO_LAUNCH ends in a circle over home, or a landing of its own".to_owned(),
        ),
        command::NAV_SPLINE_WAYPOINT | command::NAV_PAYLOAD_PLACE => {
            Err("its motion on a wing is not known".to_owned())
        }
        // Over at once: the rules of acceptance refuse it.
        command::NAV_DELAY if mission.facts().acceptance.never_waits => Ok(Order::Nothing),
        command::DO_CHANGE_SPEED => speed(item, mission, home),
        // `QuadPlane::handle_do_vtol_transition`, `MissionBlock::is_mission_item_reached_or_completed`:
        // on its wing it is in that state already.
        command::DO_VTOL_TRANSITION
            if mission.airframe == Airframe::Vtol && is_forward_flight(item) =>
        {
            Ok(Order::OnWing)
        }
        _ => item::read(item, autopilot, home),
    }
}

/// A takeoff or a landing.
fn end(item: &Item, mission: &VehicleMission, home: Amsl) -> Result<Order, String> {
    let (autopilot, is_vtol) = (mission.autopilot, mission.airframe == Airframe::Vtol);
    let is_spiral = (item.params[0].trunc() - 1.0).abs() < 0.5;
    match item.command {
        command::NAV_VTOL_TAKEOFF if is_vtol => takeoff(item, autopilot, home),
        command::NAV_TAKEOFF if !is_vtol => takeoff(item, autopilot, home),
        // `QuadPlane::landing_with_fixed_wing_spiral_approach`.
        command::NAV_VTOL_LAND if is_vtol && autopilot == Autopilot::ArduPilot && is_spiral => {
            Err("param1 1 comes down on a spiral on the wing".to_owned())
        }
        command::NAV_VTOL_LAND if is_vtol => landing(item, mission, home),
        command::NAV_LAND if !is_vtol || forces_vtol(mission) => landing(item, mission, home),
        command::NAV_TAKEOFF | command::NAV_VTOL_TAKEOFF => {
            Err("a takeoff of another kind of airframe".to_owned())
        }
        _ => Err("a landing of another kind of airframe".to_owned()),
    }
}

fn waypoint(item: &Item, mission: &VehicleMission, home: Amsl) -> Result<Order, String> {
    let (hold_s, past_m) = (item.params[0], item.params[2]);
    // ArduPlane drops the hold; PX4 circles for so long and leaves on no known course.
    if mission.autopilot == Autopilot::Px4 && hold_s > 0.0 {
        return Err("a hold, on a wing, circles".to_owned());
    }
    let circled_m = mission.param("WP_MAX_RADIUS");
    if circled_m.is_some_and(|radius_m| radius_m > 0.0) {
        return Err("WP_MAX_RADIUS makes it circle a waypoint that it misses by more".to_owned());
    }
    if past_m.abs() > 0.0 {
        return Err(format!("param3 leads past the waypoint by {past_m} m"));
    }
    Ok(Order::Fly {
        at: Some(place(item)?),
        height: item::height(item, mission.autopilot, home)?,
        hold_s: None,
    })
}

/// Whether a transition is one to `MAV_VTOL_STATE_FW`.
fn is_forward_flight(item: &Item) -> bool {
    (item.params[0].trunc() - 4.0).abs() < 0.5
}

fn speed(item: &Item, mission: &VehicleMission, home: Amsl) -> Result<Order, String> {
    let [kind, airspeed_mps, ..] = item.params.map(f64::from);
    // PX4 takes a ground speed for an airspeed (`Navigator::run`, VEHICLE_CMD_DO_CHANGE_SPEED).
    let airspeeds = match mission.autopilot {
        Autopilot::ArduPilot => 0.5,
        Autopilot::Px4 => 1.5,
    };
    if kind.trunc().abs() > airspeeds {
        return Err(format!(
            "DO_CHANGE_SPEED of kind {kind} does not set the airspeed"
        ));
    }
    let is_ardupilot = mission.autopilot == Autopilot::ArduPilot;
    if is_ardupilot && (airspeed_mps + 2.0).abs() < 1e-6 {
        return Ok(Order::OwnSpeed);
    }
    if is_ardupilot && is_ignored(airspeed_mps, mission) {
        return Ok(Order::Nothing);
    }
    item::read(item, mission.autopilot, home)
}

/// Whether ArduPlane ignores an airspeed, m/s: one outside of its limits, where the parameters have
/// them (`Plane::do_change_speed`).
fn is_ignored(airspeed_mps: f64, mission: &VehicleMission) -> bool {
    let held = |name: &str| mission.param_si(name);
    held("AIRSPEED_MIN").is_some_and(|min_mps| airspeed_mps < min_mps)
        || held("AIRSPEED_MAX").is_some_and(|max_mps| airspeed_mps > max_mps)
}

fn takeoff(item: &Item, autopilot: Autopilot, home: Amsl) -> Result<Order, String> {
    let height = item::height(item, autopilot, home)?;
    Ok(match autopilot.conventions().reads_takeoff_location {
        // The place is not read. A QuadPlane climbs by the altitude, whatever the frame.
        false => Order::Takeoff {
            at: None,
            height: if item.command == command::NAV_VTOL_TAKEOFF {
                Height::Sea(AboveHome(f64::from(item.z)).over(home))
            } else {
                height
            },
        },
        true => Order::Takeoff {
            at: Some(place(item)?),
            height,
        },
    })
}

fn landing(item: &Item, mission: &VehicleMission, home: Amsl) -> Result<Order, String> {
    let autopilot = mission.autopilot;
    item::height(item, autopilot, home)?;
    let is_quadplane = autopilot == Autopilot::ArduPilot && mission.airframe == Airframe::Vtol;
    if is_quadplane && (item.x, item.y) == (0, 0) {
        return Ok(Order::Land { at: None });
    }
    Ok(Order::Land {
        at: Some(place(item)?),
    })
}

/// A circle that is left again.
///
/// ArduPlane keeps no radius of `NAV_LOITER_TIME` but its sign, and takes one of a metre for none.
/// PX4 waits for its course only where param1 (of a time, param2) says so, and not always then.
fn circled(
    item: &Item,
    mission: &VehicleMission,
    home: Amsl,
    (until, stated_m): (Until, f64),
) -> Result<Order, String> {
    let is_px4 = mission.autopilot == Autopilot::Px4;
    let own_m = match until {
        Until::Seconds(_) if !is_px4 => 0.0_f64.copysign(stated_m),
        _ if stated_m.abs() > 1.0 => stated_m,
        _ => 0.0_f64.copysign(stated_m),
    };
    let held_m = radius_m(own_m, mission)?;
    let radius_m = match own_m.is_sign_negative() {
        true => -held_m.abs(),
        false => held_m,
    };
    Ok(Order::Circle {
        at: Some(place(item)?),
        height: item::height(item, mission.autopilot, home)?,
        circle: Circling {
            radius_m,
            until,
            leaves_aligned: !is_px4,
        },
    })
}

/// The radius of a circle: that of the item in whole metres as ArduPlane keeps it, or, for
/// 0, that of the parameters.
fn radius_m(param: f64, mission: &VehicleMission) -> Result<f64, String> {
    let (own, name) = match mission.autopilot {
        Autopilot::ArduPilot => (param.trunc(), "WP_LOITER_RAD"),
        Autopilot::Px4 => (param, "NAV_LOITER_RAD"),
    };
    if own.is_finite() && own.abs() > 0.0 {
        return Ok(own);
    }
    held_m(mission, name).ok_or_else(|| format!("a circle without a radius, and no {name}"))
}

/// The radius of circles of PX4 where no item states one, if its parameters state one.
pub(crate) fn loiter_radius_m(mission: &VehicleMission) -> Option<f64> {
    held_m(mission, "NAV_LOITER_RAD").map(f64::abs)
}

/// Whether the vehicle lands on rotors at a landing of planes: a VTOL of PX4 on its wing does, unless
/// `NAV_FORCE_VT` is 0 (`Navigator::force_vtol`).
fn forces_vtol(mission: &VehicleMission) -> bool {
    let found = mission.param("NAV_FORCE_VT");
    mission.autopilot == Autopilot::Px4 && found.is_none_or(|value| value.abs() > 0.0)
}

/// A radius from the parameters.
fn held_m(mission: &VehicleMission, name: &str) -> Option<f64> {
    mission.param_si(name).filter(|radius| radius.abs() > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::{Home, Parameter};

    #[test]
    fn arduplane_ignores_an_airspeed_beyond_the_limits_of_its_parameters() {
        let param = |name: &str, value: f32| Parameter {
            name: name.to_owned(),
            value,
            why: String::new(),
        };
        let mut mission = VehicleMission {
            autopilot: Autopilot::ArduPilot,
            autopilot_version: None,
            airframe: Airframe::Plane,
            home: Home {
                x: 363_000_000,
                y: -842_500_000,
                amsl_m: 400.0,
            },
            items: Vec::new(),
            fence: Vec::new(),
            is_fence_known: false,
            rally: Vec::new(),
            params: vec![param("AIRSPEED_MIN", 9.0), param("AIRSPEED_MAX", 22.0)],
            notes: Vec::new(),
        };
        let obeys = |mission: &VehicleMission, speed_mps: f32| {
            let item = Item::without_place(command::DO_CHANGE_SPEED, [0.0, speed_mps, -1.0, 0.0]);
            matches!(read(&item, mission, Amsl(400.0)), Ok(Order::Speed { .. }))
        };
        let obeyed = [8.9, 9.0, 22.0, 22.1].map(|mps| obeys(&mission, mps));
        assert_eq!(obeyed, [false, true, true, false]);
        // ArduPlane until 4.4.
        mission.params = vec![param("ARSPD_FBW_MAX", 15.0)];
        assert_eq!([15.0, 15.1].map(|mps| obeys(&mission, mps)), [true, false]);
    }
}
