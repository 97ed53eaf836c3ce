//! What an autopilot keeps of an item, measured on ArduPilot 4.6.3 and PX4 1.18
//! with their simulators, and read from ArduPilot's storage code
//! (`AP_Mission::mavlink_int_to_mission_cmd`) and PX4's (`parse_mavlink_mission_item`).
//!
//! A command that is not listed here is expected back unchanged: then a lossy
//! autopilot is reported as different, never the other way round.

use super::message::List;
use crate::mission::{Item, command, frame};
use crate::spec::{Airframe, Autopilot};

/// Commands that ArduPilot stores with a place; all others come back without one.
const ARDUPILOT_PLACES: [u16; 17] = [
    command::NAV_WAYPOINT,
    command::NAV_LOITER_UNLIM,
    command::NAV_LOITER_TURNS,
    command::NAV_LOITER_TIME,
    command::NAV_LAND,
    command::NAV_TAKEOFF,
    30,  // NAV_CONTINUE_AND_CHANGE_ALT
    31,  // NAV_LOITER_TO_ALT
    82,  // NAV_SPLINE_WAYPOINT
    84,  // NAV_VTOL_TAKEOFF
    85,  // NAV_VTOL_LAND
    94,  // NAV_PAYLOAD_PLACE
    179, // DO_SET_HOME
    188, // DO_RETURN_PATH_START
    189, // DO_LAND_START
    195, // DO_SET_ROI_LOCATION
    201, // DO_SET_ROI
];

/// The item as this autopilot gives it back on such an airframe, with the canonical frame.
#[must_use]
pub fn kept(autopilot: Autopilot, airframe: Airframe, list: List, item: &Item) -> Item {
    let mut kept = Item {
        frame: frame::canonical(item.frame),
        ..*item
    };
    match (autopilot, list) {
        (Autopilot::ArduPilot, List::Mission) => ardupilot_mission(&mut kept, airframe),
        (Autopilot::ArduPilot, List::Fence) => ardupilot_fence(&mut kept),
        (Autopilot::ArduPilot, List::Rally) => ardupilot_rally(&mut kept),
        (Autopilot::Px4, List::Mission) => px4_mission(&mut kept),
        (Autopilot::Px4, List::Fence | List::Rally) => {}
    }
    kept
}

fn ardupilot_mission(item: &mut Item, airframe: Airframe) {
    // Neither is stored; autocontinue always reads back as set.
    item.autocontinue = true;
    if ARDUPILOT_PLACES.contains(&item.command) {
        if item.frame == frame::MISSION {
            item.frame = frame::GLOBAL;
        }
        item.z = centimetres(item.z);
    } else {
        item.frame = frame::GLOBAL;
        (item.x, item.y, item.z) = (0, 0, 0.0);
    }
    let [p1, p2, p3, p4] = item.params;
    item.params = match item.command {
        // ArduPlane, and so a QuadPlane: acceptance radius and how far to go past, no hold.
        command::NAV_WAYPOINT if airframe.has_wing() => [0.0, one_byte(p2), one_byte(p3), 0.0],
        command::NAV_WAYPOINT | command::NAV_TAKEOFF => [whole_u16(p1), 0.0, 0.0, 0.0],
        command::NAV_LOITER_UNLIM => [0.0, 0.0, p3.trunc(), 0.0],
        command::NAV_LOITER_TURNS => [p1.trunc(), 0.0, loiter_radius(p3), flag(p4)],
        command::NAV_LOITER_TIME => [whole_u16(p1), 0.0, sign(p3), flag(p4)],
        command::NAV_LAND => [whole_u16(p1), 0.0, 0.0, sign(p4)],
        command::NAV_RETURN_TO_LAUNCH => [0.0; 4],
        command::NAV_DELAY => [p1, p2.trunc(), p3.trunc(), p4.trunc()],
        command::DO_JUMP => [p1.trunc(), p2.trunc(), 0.0, 0.0],
        command::DO_CHANGE_SPEED => [p1.trunc(), p2, p3, 0.0],
        _ => item.params,
    };
}

/// Fences have no height: frame and altitude are not kept.
fn ardupilot_fence(item: &mut Item) {
    item.autocontinue = false;
    item.frame = frame::GLOBAL;
    item.z = 0.0;
    item.params = [item.params[0], 0.0, 0.0, 0.0];
}

fn ardupilot_rally(item: &mut Item) {
    item.autocontinue = false;
    item.params = [0.0; 4];
    item.z = item.z.trunc();
}

fn px4_mission(item: &mut Item) {
    let [p1, p2, p3, p4] = item.params;
    item.params = match item.command {
        command::NAV_WAYPOINT => [p1, p2, 0.0, degrees_360(p4)],
        command::NAV_TAKEOFF => [p1, 0.0, 0.0, degrees_360(p4)],
        command::NAV_LAND => [0.0, p2, 0.0, degrees_360(p4)],
        command::NAV_LOITER_UNLIM => [0.0, 0.0, p3, degrees_360(p4)],
        _ => item.params,
    };
}

/// ArduPilot multiplies by 100 in `f32` and cuts: 80.2 becomes 80.19.
fn centimetres(metres: f32) -> f32 {
    (metres * 100.0).trunc() / 100.0
}

/// Cut to a whole number and wrapped into 16 bits: -1 becomes 65535, 70000 becomes 4464.
fn whole_u16(value: f32) -> f32 {
    if value.is_finite() {
        value.trunc().rem_euclid(65536.0)
    } else {
        0.0
    }
}

/// The same, and no more than 255.
fn one_byte(value: f32) -> f32 {
    whole_u16(value).min(255.0)
}

/// ArduPilot keeps loiter radii in steps of 1 m up to 255 m, of 10 m above.
fn loiter_radius(radius_m: f32) -> f32 {
    if radius_m.abs() > 255.0 {
        (radius_m / 10.0).trunc() * 10.0
    } else {
        radius_m.trunc()
    }
}

/// A number of which only the sign is kept.
fn sign(value: f32) -> f32 {
    if value < 0.0 { -1.0 } else { 1.0 }
}

/// A number of which only "positive" is kept.
fn flag(value: f32) -> f32 {
    if value > 0.0 { 1.0 } else { 0.0 }
}

/// PX4 wraps a yaw to a full circle; NaN stays.
fn degrees_360(yaw_deg: f32) -> f32 {
    yaw_deg.rem_euclid(360.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waypoint() -> Item {
        Item {
            command: command::NAV_WAYPOINT,
            frame: frame::GLOBAL_RELATIVE_ALT,
            autocontinue: true,
            params: [0.0; 4],
            x: 473_977_418,
            y: 85_455_938,
            z: 80.0,
        }
    }

    fn same(read: [f32; 4], expected: [f32; 4]) {
        assert_eq!(read.map(f32::to_bits), expected.map(f32::to_bits));
    }

    fn copter(item: Item) -> Item {
        kept(Autopilot::ArduPilot, Airframe::Copter, List::Mission, &item)
    }

    /// Values read back from ArduPlane 4.6.3 (software in the loop, November 2026).
    #[test]
    fn arduplane_drops_the_hold_and_caps_two_radii() {
        for airframe in [Airframe::Plane, Airframe::Vtol] {
            for (sent, held) in [
                ([7.0, 20.0, 30.0, 45.0], [0.0, 20.0, 30.0, 0.0]),
                ([1.5, 300.0, 1000.0, 0.0], [0.0, 255.0, 255.0, 0.0]),
            ] {
                let item = Item {
                    params: sent,
                    ..waypoint()
                };
                let read = kept(Autopilot::ArduPilot, airframe, List::Mission, &item);
                same(read.params, held);
                // No word of ArduPilot's: PX4 keeps the hold on a wing too.
                let px4 = kept(Autopilot::Px4, airframe, List::Mission, &item);
                same(px4.params, [sent[0], sent[1], 0.0, sent[3]]);
            }
        }
    }

    /// Values read back from ArduCopter 4.6.3 (software in the loop, November 2026).
    #[test]
    fn ardupilot_keeps_what_was_measured() {
        for (sent, held) in [(30.129_f32, 30.12_f32), (80.2, 80.19), (-5.557, -5.55)] {
            let z = copter(Item {
                z: sent,
                ..waypoint()
            })
            .z;
            assert!(
                (z - held).abs() < 1e-4,
                "{sent} became {z}, measured {held}"
            );
        }
        for (sent, held) in [(1.5, 1.0), (-1.0, 65535.0), (70000.0, 4464.0)] {
            let params = [sent, 2.0, 3.0, 4.0];
            let read = copter(Item {
                params,
                ..waypoint()
            })
            .params;
            same(read, [held, 0.0, 0.0, 0.0]);
        }
        for (sent, held) in [(6, 3), (5, 0), (11, 10)] {
            assert_eq!(
                copter(Item {
                    frame: sent,
                    ..waypoint()
                })
                .frame,
                held
            );
        }
        let turns = Item {
            command: command::NAV_LOITER_TURNS,
            params: [3.0, 0.0, -1234.0, 0.0],
            ..waypoint()
        };
        same(copter(turns).params, [3.0, 0.0, -1230.0, 0.0]);
        let land = Item {
            command: command::NAV_LAND,
            params: [0.0, 0.0, 0.0, 90.0],
            ..waypoint()
        };
        same(copter(land).params, [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn ardupilot_gives_items_without_a_place_back_at_frame_0_and_zeros() {
        let speed = Item {
            z: 7.0,
            x: 1,
            ..Item::without_place(command::DO_CHANGE_SPEED, [1.0, 8.5, -1.0, 0.0])
        };
        let read = copter(speed);
        assert_eq!((read.frame, read.x, read.y), (0, 0, 0));
        assert_eq!(read.z.to_bits(), 0);
        same(read.params, [1.0, 8.5, -1.0, 0.0]);
    }

    #[test]
    fn rally_altitudes_lose_their_decimals_and_fences_their_autocontinue() {
        let rally = Item {
            command: command::RALLY_POINT,
            z: 80.9,
            ..waypoint()
        };
        let read = kept(Autopilot::ArduPilot, Airframe::Copter, List::Rally, &rally);
        assert_eq!(
            (read.z.to_bits(), read.autocontinue),
            (80_f32.to_bits(), false)
        );
        let read = kept(Autopilot::ArduPilot, Airframe::Copter, List::Fence, &rally);
        assert!(!read.autocontinue);
    }

    #[test]
    fn px4_keeps_nan_yaw_and_wraps_others() {
        let yaw = |yaw| {
            let params = [0.0, 0.0, 9.0, yaw];
            kept(
                Autopilot::Px4,
                Airframe::Copter,
                List::Mission,
                &Item {
                    params,
                    ..waypoint()
                },
            )
            .params
        };
        assert!(yaw(f32::NAN)[3].is_nan());
        same(yaw(-90.0), [0.0, 0.0, 0.0, 270.0]);
    }
}
