//! Stored form of an item: what a vehicle returns for it after an upload.
//!
//! The tables are in [`crate::autopilot`].

use super::message::MissionType;
use crate::autopilot::{Airframe, Autopilot, Location, command_row, facts, frame};
use crate::mission::Item;

/// The item as this autopilot returns it on such an airframe, with the canonical frame.
#[must_use]
pub fn stored_form(
    autopilot: Autopilot,
    airframe: Airframe,
    list: MissionType,
    item: &Item,
) -> Item {
    let mut stored = Item {
        frame: frame::canonical(item.frame),
        ..*item
    };
    let is_packed = autopilot.conventions().packs_items;
    match list {
        MissionType::Mission => {
            let forms = facts(autopilot, airframe).stored_params(item.command);
            for (param, form) in stored.params.iter_mut().zip(forms) {
                *param = form.apply(*param);
            }
            if is_packed {
                pack(&mut stored);
            }
        }
        MissionType::Fence if is_packed => {
            // Fences are two-dimensional: neither frame nor altitude is stored.
            stored.autocontinue = false;
            stored.frame = frame::GLOBAL;
            stored.z = 0.0;
            stored.params = [stored.params[0], 0.0, 0.0, 0.0];
        }
        MissionType::Rally if is_packed => {
            stored.autocontinue = false;
            stored.params = [0.0; 4];
            stored.z = stored.z.trunc();
        }
        MissionType::Fence | MissionType::Rally => {}
    }
    stored
}

/// Packs a mission item as ArduPilot does (`AP_Mission`).
fn pack(item: &mut Item) {
    // `autocontinue` always reads back as set.
    item.autocontinue = true;
    let row = command_row(item.command).and_then(|row| row.rule(Autopilot::ArduPilot));
    if row.is_some_and(|rule| rule.location != Location::None) {
        if item.frame == frame::MISSION {
            item.frame = frame::GLOBAL;
        }
        // Multiplied by 100 in `f32` and truncated: 80.2 becomes 80.19.
        item.z = (item.z * 100.0).trunc() / 100.0;
    } else {
        item.frame = frame::GLOBAL;
        (item.x, item.y, item.z) = (0, 0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autopilot::command;

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
        stored_form(
            Autopilot::ArduPilot,
            Airframe::Copter,
            MissionType::Mission,
            &item,
        )
    }

    /// Values read back from ArduPlane 4.6.3 (software in the loop, November 2026).
    #[test]
    fn arduplane_drops_the_hold_and_caps_two_radii() {
        for airframe in [Airframe::Plane, Airframe::Vtol] {
            for (sent, stored) in [
                ([7.0, 20.0, 30.0, 45.0], [0.0, 20.0, 30.0, 0.0]),
                ([1.5, 300.0, 1000.0, 0.0], [0.0, 255.0, 255.0, 0.0]),
            ] {
                let item = Item {
                    params: sent,
                    ..waypoint()
                };
                let read = stored_form(Autopilot::ArduPilot, airframe, MissionType::Mission, &item);
                same(read.params, stored);
                // PX4 keeps the hold on a wing too.
                let px4 = stored_form(Autopilot::Px4, airframe, MissionType::Mission, &item);
                same(px4.params, [sent[0], sent[1], 0.0, sent[3]]);
            }
        }
    }

    /// Values read back from ArduCopter 4.6.3 (software in the loop, November 2026).
    #[test]
    fn ardupilot_stores_what_was_measured() {
        for (sent, stored) in [(30.129_f32, 30.12_f32), (80.2, 80.19), (-5.557, -5.55)] {
            let z = copter(Item {
                z: sent,
                ..waypoint()
            })
            .z;
            assert!(
                (z - stored).abs() < 1e-4,
                "{sent} became {z}, measured {stored}"
            );
        }
        for (sent, stored) in [(1.5, 1.0), (-1.0, 65535.0), (70000.0, 4464.0)] {
            let params = [sent, 2.0, 3.0, 4.0];
            let read = copter(Item {
                params,
                ..waypoint()
            })
            .params;
            same(read, [stored, 0.0, 0.0, 0.0]);
        }
        for (sent, stored) in [(6, 3), (5, 0), (11, 10)] {
            assert_eq!(
                copter(Item {
                    frame: sent,
                    ..waypoint()
                })
                .frame,
                stored
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
            command: command::NAV_RALLY_POINT,
            z: 80.9,
            ..waypoint()
        };
        let read = stored_form(
            Autopilot::ArduPilot,
            Airframe::Copter,
            MissionType::Rally,
            &rally,
        );
        assert_eq!(
            (read.z.to_bits(), read.autocontinue),
            (80_f32.to_bits(), false)
        );
        let read = stored_form(
            Autopilot::ArduPilot,
            Airframe::Copter,
            MissionType::Fence,
            &rally,
        );
        assert!(!read.autocontinue);
    }

    #[test]
    fn px4_stores_nan_yaw_and_wraps_others() {
        let yaw = |yaw| {
            let params = [0.0, 0.0, 9.0, yaw];
            stored_form(
                Autopilot::Px4,
                Airframe::Copter,
                MissionType::Mission,
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
