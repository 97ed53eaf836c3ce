//! One item as the autopilot reads it.

use crate::autopilot::{Airframe, Autopilot, Motion, command_row, facts};
use crate::geodesy::{AboveHome, Agl, Amsl, LatLon};
use crate::mission::{Item, command, frame, stored_hold_s, stored_radius_m, stored_turns};
use crate::world::World;

/// An altitude as an item gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Height {
    /// Above the sea, or above home with home's altitude added.
    Sea(Amsl),
    /// Above the ground, by the vehicle's own terrain data.
    Ground(Agl),
    /// That which the vehicle has, above the ground below it if so.
    Keep { follows: bool },
}

/// How a vehicle flies around a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Circling {
    /// Metres, clockwise where positive. 0: of the circle before, or of the parameters.
    pub(crate) radius_m: f64,
    pub(crate) until: Until,
    /// Whether it leaves the circle on the way to the next place, at no other course.
    pub(crate) leaves_aligned: bool,
}

/// When a vehicle leaves a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Until {
    Turns(f64),
    Seconds(f64),
    /// At the altitude of the item.
    Altitude,
}

/// What one item makes the vehicle do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    /// Climb: straight up, or a plane along its course. PX4 then moves to the item's place,
    /// a plane towards it.
    Takeoff { at: Option<LatLon>, height: Height },
    /// Fly to a place, or stay at the present one, and stop and stay there for a time; without
    /// one pass by.
    Fly {
        at: Option<LatLon>,
        height: Height,
        hold_s: Option<f64>,
    },
    /// Fly to a place and stay for ever; on a wing, circle around it, clockwise where the
    /// radius (metres) is positive.
    Stay {
        at: Option<LatLon>,
        height: Height,
        radius_m: Option<f64>,
    },
    /// Fly a curve to a place that also depends on the places around it, and stop there for a
    /// time if there is one (`NAV_SPLINE_WAYPOINT`).
    Spline {
        at: Option<LatLon>,
        height: Height,
        hold_s: Option<f64>,
    },
    /// Fly around a place for a while, then go on.
    Circle {
        at: Option<LatLon>,
        height: Height,
        circle: Circling,
    },
    /// Fly to a place, or stay at the present one, descend to the ground, no further than a number
    /// of metres, and rise again.
    Place {
        at: Option<LatLon>,
        max_m: Option<f64>,
    },
    /// Wait where the vehicle is.
    Wait { hold_s: f64 },
    /// Land there, or where the vehicle is.
    Land { at: Option<LatLon> },
    /// Return to launch.
    Return,
    /// From now on this ground speed, m/s.
    Speed { speed_mps: f64 },
    /// From now on the speed of its parameters again.
    OwnSpeed,
    /// Stop in the air and go on.
    Stop,
    /// Fly on its wing, as it does already.
    OnWing,
    /// Nothing that moves the vehicle.
    Nothing,
}

/// The order of one item to a copter, or why its motion is not known.
pub(crate) fn read(item: &Item, autopilot: Autopilot, home: Amsl) -> Result<Order, String> {
    // PX4 holds at such an item until it gets a command; ArduPilot stores no such flag.
    let conventions = autopilot.conventions();
    if conventions.waits_without_autocontinue && !item.autocontinue {
        return Err("autocontinue is off: the vehicle waits for a command there".to_owned());
    }
    let here = conventions.zero_is_unset && item.x == 0 && item.y == 0;
    match item.command {
        command::NAV_TAKEOFF => Ok(Order::Takeoff {
            // ArduCopter climbs where it stands, whatever the place says.
            at: match conventions.reads_takeoff_location {
                false => None,
                true => Some(place(item)?),
            },
            height: height(item, autopilot, home)?,
        }),
        command::NAV_WAYPOINT => Ok(Order::Fly {
            at: own_place(item, here)?,
            height: own_height(item, autopilot, home)?,
            hold_s: Some(hold_s(item.params[0], autopilot)?).filter(|&hold_s| hold_s > 0.0),
        }),
        command::NAV_LOITER_TIME => Ok(Order::Fly {
            at: own_place(item, here)?,
            height: own_height(item, autopilot, home)?,
            hold_s: Some(hold_s(item.params[0], autopilot)?).filter(|&hold_s| {
                let stops = facts(autopilot, Airframe::Copter).stops;
                hold_s > 0.0 || stops.at_timed_loiter
            }),
        }),
        command::NAV_LOITER_UNLIM => Ok(Order::Stay {
            at: own_place(item, here)?,
            height: own_height(item, autopilot, home)?,
            radius_m: None,
        }),
        command::NAV_LOITER_TO_ALT
        | command::NAV_SPLINE_WAYPOINT
        | command::NAV_LOITER_TURNS
        | command::NAV_PAYLOAD_PLACE
            if autopilot == Autopilot::ArduPilot =>
        {
            of_arducopter(item, here, home)
        }
        command::NAV_LAND if here => Ok(Order::Land { at: None }),
        command::NAV_LAND => {
            height(item, autopilot, home)?;
            Ok(Order::Land {
                at: Some(place(item)?),
            })
        }
        command::NAV_RETURN_TO_LAUNCH => Ok(Order::Return),
        command::NAV_DELAY => Ok(Order::Wait {
            hold_s: delay_s(item, autopilot)?,
        }),
        command::DO_CHANGE_SPEED => speed(item, autopilot),
        _ => without_order(item),
    }
}

/// The order of an item that ArduCopter alone flies.
fn of_arducopter(item: &Item, here: bool, home: Amsl) -> Result<Order, String> {
    let autopilot = Autopilot::ArduPilot;
    let at = own_place(item, here)?;
    let height = own_height(item, autopilot, home)?;
    if item.command == command::NAV_LOITER_TO_ALT && matches!(height, Height::Keep { .. }) {
        // `ModeAuto::do_loiter_to_alt` keeps its altitude on the way alone.
        return Err("altitude 0: ArduCopter descends to 0 m where it circles".to_owned());
    }
    Ok(match item.command {
        // It goes there as to a waypoint, stops, and continues at its altitude
        // (`ModeAuto::loiter_to_alt_run`).
        command::NAV_LOITER_TO_ALT => Order::Fly {
            at,
            height,
            hold_s: Some(0.0),
        },
        command::NAV_LOITER_TURNS => Order::Circle {
            at,
            height,
            circle: turns(item)?,
        },
        command::NAV_PAYLOAD_PLACE => Order::Place {
            at,
            max_m: max_descent_m(item.params[0])?,
        },
        _ => Order::Spline {
            at,
            height,
            hold_s: Some(hold_s(item.params[0], autopilot)?).filter(|&hold_s| hold_s > 0.0),
        },
    })
}

/// What a command without an order of its own does, if that is nothing.
fn without_order(item: &Item) -> Result<Order, String> {
    let (command, first) = (item.command, item.params[0]);
    match command_row(command).map(|row| (row.motion, row.name)) {
        // 0 and 1 disable and enable it.
        _ if command == command::DO_PARACHUTE && (0.0..2.0).contains(&first) => Ok(Order::Nothing),
        // Above 0 it starts, and is running already.
        _ if command == command::DO_ENGINE_CONTROL && first > 0.0 => Ok(Order::Nothing),
        Some((Motion::NoMotion, name))
            if command == command::DO_AUX_FUNCTION && !is_harmless_function(first) =>
        {
            Err(format!("{name} {first} may do anything"))
        }
        Some((Motion::NoMotion, _)) => Ok(Order::Nothing),
        Some((Motion::Unknown(why), _)) => Err(why.to_owned()),
        Some((Motion::Moves, name)) => Err(format!("the motion of {name} is not known")),
        None => Err(format!("the motion of command {command} is not known")),
    }
}

/// Slower ones are ignored (`AC_WPNav::set_speed_NE_cms`, `WPNAV_WP_SPEED_MIN`; later versions have 0.1 m/s).
const MIN_SPEED_MPS: f64 = 0.2;

fn speed(item: &Item, autopilot: Autopilot) -> Result<Order, String> {
    let [kind, speed_mps, ..] = item.params.map(f64::from);
    // Airspeed and ground speed are one to a copter. Without a speed ArduPilot leaves it as it is,
    // and PX4 flies that of its parameters again (`Navigator::set_cruising_speed`).
    if kind.is_nan() || !(kind.trunc().abs() < 0.5 || (kind.trunc() - 1.0).abs() < 0.5) {
        return Err(format!(
            "DO_CHANGE_SPEED of kind {kind} changes the vertical speed"
        ));
    }
    if autopilot == Autopilot::ArduPilot && (0.0..MIN_SPEED_MPS).contains(&speed_mps) {
        return Err(format!(
            "DO_CHANGE_SPEED to {speed_mps} m/s: ArduPilot leaves the speed as it is below {MIN_SPEED_MPS} m/s"
        ));
    }
    if speed_mps > 0.0 && speed_mps.is_finite() {
        Ok(Order::Speed { speed_mps })
    } else if speed_mps < 0.0 && speed_mps.is_finite() {
        Ok(match autopilot {
            Autopilot::ArduPilot => Order::Nothing,
            Autopilot::Px4 => Order::OwnSpeed,
        })
    } else {
        Err(format!("DO_CHANGE_SPEED to {speed_mps} m/s"))
    }
}

/// The circles of `NAV_LOITER_TURNS` as ArduPilot stores them.
pub(crate) fn turns(item: &Item) -> Result<Circling, String> {
    let [turns, _, radius_m, aligned] = item.params.map(f64::from);
    if !(turns >= 0.0 && turns.is_finite() && radius_m.is_finite()) {
        return Err(format!("{turns} turns with a radius of {radius_m} m"));
    }
    Ok(Circling {
        radius_m: stored_radius_m(radius_m),
        until: Until::Turns(stored_turns(turns)),
        leaves_aligned: !aligned.is_nan(),
    })
}

/// Whether an auxiliary function (`RC_Channel::AUX_FUNC`) moves nothing but a payload: cameras,
/// sprayer, gripper, relays, mounts.
fn is_harmless_function(function: f32) -> bool {
    const HARMLESS: [f32; 16] = [
        9.0, 15.0, 19.0, 27.0, 28.0, 34.0, 35.0, 36.0, 66.0, 67.0, 113.0, 163.0, 166.0, 167.0,
        168.0, 169.0,
    ];
    HARMLESS
        .iter()
        .any(|known| known.to_bits() == function.to_bits())
}

/// How far a vehicle descends at most to place a payload, metres; none: until it feels the ground.
/// ArduPilot keeps centimetres in 16 bits.
fn max_descent_m(param: f32) -> Result<Option<f64>, String> {
    let max_m = seconds(param).map_err(|_| format!("a descent of {param} m at most"))?;
    if max_m > 655.0 {
        return Err(format!("a descent of {param} m at most"));
    }
    Ok(Some(max_m).filter(|max_m| *max_m > 0.0))
}

/// The place that an item is flown to; none is the present one.
fn own_place(item: &Item, is_here: bool) -> Result<Option<LatLon>, String> {
    match is_here {
        true => Ok(None),
        false => place(item).map(Some),
    }
}

/// The place of an item that has one, 1e-7 degrees.
pub(crate) fn place(item: &Item) -> Result<LatLon, String> {
    if item.x == 0 && item.y == 0 {
        return Err("latitude and longitude are 0".to_owned());
    }
    item.place().ok_or_else(|| {
        if frame::canonical(item.frame) == frame::MISSION {
            "a place in frame 2 (MAV_FRAME_MISSION) has no altitude reference".to_owned()
        } else {
            format!(
                "no place from frame {} with x {}, y {}",
                item.frame, item.x, item.y
            )
        }
    })
}

/// Above and below all that flies, metres: a climb there would be followed for ever.
const MAX_ALTITUDE_M: f64 = 100_000.0;

/// The altitude of an item with the reference of its frame.
///
/// ArduPilot keeps whole centimetres, truncated toward zero (measured on 4.6.3).
pub(crate) fn height(item: &Item, autopilot: Autopilot, home: Amsl) -> Result<Height, String> {
    let z_m = f64::from(item.z);
    if !z_m.is_finite() {
        return Err(format!("the altitude is {z_m}"));
    }
    if z_m.abs() > MAX_ALTITUDE_M {
        return Err(format!("an altitude of {z_m} m, at which nothing flies"));
    }
    let z_m = match autopilot.conventions().packs_items {
        true => (z_m * 100.0).trunc() / 100.0,
        false => z_m,
    };
    match frame::canonical(item.frame) {
        frame::GLOBAL => Ok(Height::Sea(Amsl(z_m))),
        frame::GLOBAL_RELATIVE_ALT => {
            if home.0.is_finite() {
                Ok(Height::Sea(AboveHome(z_m).over(home)))
            } else {
                Err("an altitude above home, and the altitude of home is not known".to_owned())
            }
        }
        frame::GLOBAL_TERRAIN_ALT => Ok(Height::Ground(Agl(z_m))),
        other => Err(format!("frame {other} has no altitude reference")),
    }
}

/// The altitude of a place that is flown to.
///
/// ArduPilot takes an altitude of 0 cm for none, in every frame: the vehicle keeps its
/// present altitude (ArduCopter `ModeAuto::loc_from_cmd`).
pub(crate) fn own_height(item: &Item, autopilot: Autopilot, home: Amsl) -> Result<Height, String> {
    let height = height(item, autopilot, home)?;
    let is_unset = autopilot.conventions().zero_is_unset && (f64::from(item.z) * 100.0).abs() < 1.0;
    Ok(match is_unset {
        true => Height::Keep {
            follows: matches!(height, Height::Ground(_)),
        },
        false => height,
    })
}

/// Place, altitude and height above ground (metres, where the ground is known) of a rally point.
///
/// ArduPilot keeps whole metres, truncated (measured on 4.6.3).
pub(crate) fn rally(
    item: &Item,
    autopilot: Autopilot,
    home: Amsl,
    world: &World,
) -> Result<(LatLon, Amsl, Result<f64, String>), String> {
    let mut stored = *item;
    if autopilot.conventions().packs_items {
        stored.z = stored.z.trunc();
    }
    let place = place(&stored)?;
    let ground = world.terrain.height(place).map_err(|gap| gap.to_string());
    let amsl = match height(&stored, autopilot, home)? {
        Height::Sea(amsl) => amsl,
        Height::Ground(agl) => agl.over(ground.clone()?),
        Height::Keep { .. } => return Err("a rally point without an altitude".to_owned()),
    };
    Ok((
        place,
        amsl,
        ground.map(|ground| amsl.above_ground(ground).0),
    ))
}

/// The time of a waypoint or a timed circle: ArduPilot keeps it as `uint16`, wrapping (measured on 4.6.3).
pub(crate) fn hold_s(param: f32, autopilot: Autopilot) -> Result<f64, String> {
    match autopilot {
        Autopilot::ArduPilot if param.is_finite() => Ok(stored_hold_s(param.into())),
        // NaN is PX4's "default", which is no hold.
        Autopilot::Px4 if param.is_nan() => Ok(0.0),
        _ => seconds(param),
    }
}

/// How long a delay lasts.
///
/// Without seconds ArduPilot waits until an hour, minute and second of the day. -1 means any:
/// three times -1 is no wait.
fn delay_s(item: &Item, autopilot: Autopilot) -> Result<f64, String> {
    let [delay_s, of_day @ ..] = item.params;
    match autopilot {
        Autopilot::ArduPilot if delay_s <= 0.0 => of_day
            .iter()
            .all(|part| part.to_bits() == (-1.0_f32).to_bits())
            .then_some(0.0)
            .ok_or(()),
        _ => seconds(delay_s).map_err(|_| ()),
    }
    .map_err(|()| "a delay until a time of day is not known after T0".to_owned())
}

fn seconds(param: f32) -> Result<f64, String> {
    if param >= 0.0 && param.is_finite() {
        Ok(f64::from(param))
    } else {
        Err(format!("a time of {param} s"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_altitude_at_which_nothing_flies_is_none() {
        for (z, is_one) in [
            (-1e9, false),
            (90_000.0, true),
            (1e8, false),
            (f32::NAN, false),
        ] {
            let item = Item {
                z,
                frame: frame::GLOBAL,
                ..Item::without_place(command::NAV_WAYPOINT, [0.0; 4])
            };
            let found = height(&item, Autopilot::Px4, Amsl(0.0));
            assert_eq!(found.is_ok(), is_one, "{z}: {found:?}");
        }
    }

    #[test]
    fn ardupilot_holds_for_whole_seconds_alone() {
        for (sent, holds_s) in [(0.9, 0.0), (3.5, 3.0), (65536.5, 0.0)] {
            assert_eq!(hold_s(sent, Autopilot::ArduPilot), Ok(holds_s), "{sent}");
        }
        assert_eq!(hold_s(0.5, Autopilot::Px4), Ok(0.5));
    }
}
