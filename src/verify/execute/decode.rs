//! What the items tell the vehicle to do, read as the autopilot reads them.

use super::jumps::{Jumps, jump};
use super::wing::items;
use crate::autopilot::{Autopilot, Motion, command_row};
use crate::geodesy::{AboveHome, Agl, Amsl, LatLon};
use crate::mission::{Item, VehicleMission, command, frame};
use crate::world::World;

/// An altitude as an item gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Height {
    /// Above the sea, or above home with home's altitude added.
    Sea(Amsl),
    /// Above the ground, by the vehicle's own terrain data.
    Ground(Agl),
}

/// What one item makes the vehicle do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Order {
    /// Climb: straight up, or a plane along its course. PX4 then moves to the item's place,
    /// a plane towards it.
    Takeoff { at: Option<LatLon>, height: Height },
    /// Fly to a place and stay there for a time; 0 means pass by.
    Fly {
        at: LatLon,
        height: Height,
        hold_s: f64,
    },
    /// Fly to a place and stay for ever; on a wing, circle around it, clockwise where the
    /// radius (metres) is positive.
    Stay {
        at: LatLon,
        height: Height,
        radius_m: Option<f64>,
    },
    /// Wait where the vehicle is.
    Wait { hold_s: f64 },
    /// Land there, or where the vehicle is.
    Land { at: Option<LatLon> },
    /// Return to launch.
    Return,
    /// From now on this ground speed, m/s.
    Speed { speed_mps: f64 },
    /// Nothing that moves the vehicle.
    Nothing,
}

/// An order and the row it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// Row of the `.waypoints` file, home being 0.
    pub(crate) row: usize,
    pub(crate) order: Order,
}

/// Why the flight is not known from a row on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unknown {
    pub(crate) row: usize,
    pub(crate) why: String,
}

/// Most orders of a mission, jumps counted as often as they are made.
const MOST_ORDERS: usize = 200_000;

/// The orders of a mission as they are obeyed, jumps made, up to the first that
/// cannot be read.
pub(crate) fn decode(mission: &VehicleMission, home: Amsl) -> (Vec<Step>, Option<Unknown>) {
    let mut steps = Vec::with_capacity(mission.items.len());
    let mut jumps = vec![Jumps::NotMet; mission.items.len()];
    let mut next = 0;
    // Whether commands wait for a condition while the vehicle flies on.
    let mut waiting = false;
    for _ in 0..MOST_ORDERS {
        let Some(item) = mission.items.get(next) else {
            return (steps, None);
        };
        let row = next + 1;
        let unknown = |why: String| Some(Unknown { row, why });
        if item.command == command::DO_JUMP {
            match jump(item, next, mission, &mut jumps[next]) {
                Ok(index) => next = index,
                Err(why) => return (steps, unknown(why)),
            }
            continue;
        }
        match item.command {
            112 | 114 | 115 => waiting = true,
            command if command < FIRST_BESIDE => waiting = false,
            command::DO_CHANGE_SPEED if waiting => {
                let why = "a change of speed that waits for a condition comes at no known time";
                return (steps, unknown(why.to_owned()));
            }
            _ => {}
        }
        let order = if mission.airframe.has_wing() {
            items::read(item, mission, home)
        } else {
            read(item, mission.autopilot, home)
        };
        match order {
            Ok(order) => steps.push(Step { row, order }),
            Err(why) => return (steps, unknown(why)),
        }
        next += 1;
    }
    let why = format!("more than {MOST_ORDERS} orders, jumps included");
    (steps, Some(Unknown { row: next + 1, why }))
}

/// Commands below fly somewhere; those from here on act beside the flight.
const FIRST_BESIDE: u16 = 96;

pub(crate) fn read(item: &Item, autopilot: Autopilot, home: Amsl) -> Result<Order, String> {
    // PX4 holds at such an item until told otherwise; ArduPilot keeps no such flag.
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
            at: place(item)?,
            height: own_height(item, autopilot, home)?,
            hold_s: hold_s(item.params[0], autopilot)?,
        }),
        command::NAV_LOITER_TIME => Ok(Order::Fly {
            at: place(item)?,
            height: own_height(item, autopilot, home)?,
            hold_s: seconds(item.params[0])?,
        }),
        command::NAV_LOITER_UNLIM => Ok(Order::Stay {
            at: place(item)?,
            height: own_height(item, autopilot, home)?,
            radius_m: None,
        }),
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
        command::DO_CHANGE_SPEED => speed(item),
        other => match command_row(other).map(|row| (row.motion, row.name)) {
            Some((Motion::NoMotion, _)) => Ok(Order::Nothing),
            Some((Motion::Unknown(why), _)) => Err(why.to_owned()),
            Some((Motion::Moves, name)) => Err(format!("the motion of {name} is not known")),
            None => Err(format!("the motion of command {other} is not known")),
        },
    }
}

fn speed(item: &Item) -> Result<Order, String> {
    let [kind, speed_mps, ..] = item.params.map(f64::from);
    // Airspeed and ground speed are one to a copter; -1 and -2 leave the speed as it is.
    if kind.is_nan() || !(kind.trunc().abs() < 0.5 || (kind.trunc() - 1.0).abs() < 0.5) {
        return Err(format!(
            "DO_CHANGE_SPEED of kind {kind} changes the vertical speed"
        ));
    }
    if speed_mps > 0.0 && speed_mps.is_finite() {
        Ok(Order::Speed { speed_mps })
    } else if speed_mps < 0.0 && speed_mps.is_finite() {
        Ok(Order::Nothing)
    } else {
        Err(format!("DO_CHANGE_SPEED to {speed_mps} m/s"))
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

/// The altitude of an item with the reference of its frame.
///
/// ArduPilot keeps whole centimetres, truncated toward zero (measured on 4.6.3).
pub(crate) fn height(item: &Item, autopilot: Autopilot, home: Amsl) -> Result<Height, String> {
    let z_m = f64::from(item.z);
    if !z_m.is_finite() {
        return Err(format!("the altitude is {z_m}"));
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
/// To ArduPilot an altitude of 0 cm there is no altitude: the vehicle keeps the one
/// it has (ArduCopter `ModeAuto::loc_from_cmd`), whatever the frame.
pub(crate) fn own_height(item: &Item, autopilot: Autopilot, home: Amsl) -> Result<Height, String> {
    let height = height(item, autopilot, home)?;
    if autopilot.conventions().zero_is_unset && (f64::from(item.z) * 100.0).abs() < 1.0 {
        return Err(format!(
            "an altitude of {} m keeps the altitude before it (ArduPilot takes 0 cm for none)",
            item.z
        ));
    }
    Ok(height)
}

/// Place, altitude and height above ground (metres) of a rally point.
///
/// ArduPilot keeps whole metres, truncated (measured on 4.6.3).
pub(crate) fn rally(
    item: &Item,
    autopilot: Autopilot,
    home: Amsl,
    world: &World,
) -> Result<(LatLon, Amsl, f64), String> {
    let mut kept = *item;
    if autopilot.conventions().packs_items {
        kept.z = kept.z.trunc();
    }
    let place = place(&kept)?;
    let ground = world.terrain.height(place).map_err(|gap| gap.to_string())?;
    let amsl = match height(&kept, autopilot, home)? {
        Height::Sea(amsl) => amsl,
        Height::Ground(agl) => agl.over(ground),
    };
    Ok((place, amsl, amsl.above_ground(ground).0))
}

/// The hold time of a waypoint: ArduPilot keeps it as `uint16`, wrapping (measured on 4.6.3).
fn hold_s(param: f32, autopilot: Autopilot) -> Result<f64, String> {
    match autopilot {
        Autopilot::ArduPilot if param.is_finite() => {
            Ok(f64::from(param).trunc().rem_euclid(65536.0))
        }
        // NaN is PX4's "default", which is no hold.
        Autopilot::Px4 if param.is_nan() => Ok(0.0),
        _ => seconds(param),
    }
}

/// How long a delay lasts.
///
/// Without seconds ArduPilot waits until an hour, minute and second of the day, of
/// which -1 means any: three of them are no wait at all.
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
    use crate::mission::Home;
    use crate::spec::Airframe;

    fn decoded(autopilot: Autopilot, items: Vec<Item>) -> (Vec<usize>, Option<String>) {
        let mission = VehicleMission {
            autopilot_version: None,
            autopilot,
            airframe: Airframe::Copter,
            home: Home {
                x: 363_000_000,
                y: -842_500_000,
                amsl_m: 400.0,
            },
            items,
            fence: Vec::new(),
            is_fence_known: false,
            rally: Vec::new(),
            params: Vec::new(),
            notes: Vec::new(),
        };
        let (steps, unknown) = decode(&mission, Amsl(400.0));
        let rows = steps.iter().map(|step| step.row).collect();
        (rows, unknown.map(|unknown| unknown.why))
    }

    fn command(command: u16, param1: f32, param2: f32) -> Item {
        Item::without_place(command, [param1, param2, 0.0, 0.0])
    }

    fn delay() -> Item {
        command(command::NAV_DELAY, 1.0, 0.0)
    }

    #[test]
    fn a_jump_is_made_as_often_as_it_says_and_counted_as_the_autopilot_counts() {
        for (autopilot, second) in [(Autopilot::ArduPilot, 2.0), (Autopilot::Px4, 1.0)] {
            let jump = command(command::DO_JUMP, second, 2.0);
            let items = vec![delay(), delay(), jump, delay()];
            let (rows, unknown) = decoded(autopilot, items);
            assert_eq!((rows, unknown), (vec![1, 2, 2, 2, 4], None));
        }
    }

    #[test]
    fn jumps_without_end_or_target_and_loops_in_loops_are_not_known() {
        let told = |jump: Item| {
            let (_, unknown) = decoded(Autopilot::ArduPilot, vec![delay(), jump, delay()]);
            unknown.expect("not known")
        };
        assert!(told(command(177, 1.0, -1.0)).contains("for ever"));
        assert!(told(command(177, 9.0, 1.0)).contains("item 9, which there is not"));
        assert!(told(command(177, 2.0, 1.0)).contains("to itself"));
        assert!(told(command(177, 1.0, 0.5)).contains("made 0.5 times"));
        assert!(told(command(177, f32::NAN, 1.0)).contains("which there is not"));
        let inner = command(177, 1.0, 1.0);
        let (rows, unknown) = decoded(Autopilot::ArduPilot, vec![delay(), inner, inner]);
        assert_eq!(rows, [1, 1, 1]);
        assert!(
            unknown
                .expect("a loop in a loop")
                .contains("loop of another")
        );
    }

    #[test]
    fn a_speed_that_waits_for_a_condition_is_not_known() {
        let speed = command(178, 1.0, 8.0);
        let (_, none) = decoded(
            Autopilot::ArduPilot,
            vec![command(112, 5.0, 0.0), delay(), speed],
        );
        assert_eq!(none, None);
        let (rows, told) = decoded(Autopilot::ArduPilot, vec![command(112, 5.0, 0.0), speed]);
        assert_eq!(rows, [1]);
        assert!(told.expect("not known").contains("waits for a condition"));
    }
}
