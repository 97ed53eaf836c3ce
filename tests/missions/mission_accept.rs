//! What each autopilot takes: one test for each rule.

use sortie::autopilot::{Airframe, Autopilot, Version, facts};
use sortie::mission::{
    AcceptanceProblem, Home, Item, MissionType, Parameter, VehicleMission, command, problems,
};

use Autopilot::{ArduPilot, Px4};

fn at(command: u16, frame: u8, z: f32) -> Item {
    Item {
        command,
        frame,
        autocontinue: true,
        params: [0.0; 4],
        x: 362_500_000,
        y: -843_000_000,
        z,
    }
}

/// Takeoff, waypoint, landing: nothing to complain about.
fn good(autopilot: Autopilot) -> VehicleMission {
    VehicleMission {
        autopilot_version: None,
        autopilot,
        airframe: Airframe::Copter,
        home: Home {
            x: 362_500_000,
            y: -843_000_000,
            amsl_m: 400.0,
        },
        items: vec![
            at(command::NAV_TAKEOFF, 3, 80.0),
            at(command::NAV_WAYPOINT, 3, 80.0),
            at(command::NAV_LAND, 3, 0.0),
        ],
        fence: Vec::new(),
        rally: Vec::new(),
        params: Vec::new(),
        is_fence_known: true,
        notes: Vec::new(),
    }
}

fn found(autopilot: Autopilot, change: impl FnOnce(&mut VehicleMission)) -> Vec<AcceptanceProblem> {
    let mut mission = good(autopilot);
    change(&mut mission);
    problems(&mission)
}

/// Exactly one problem: item and rule, and a text with found and allowed.
fn only(
    autopilot: Autopilot,
    change: impl FnOnce(&mut VehicleMission),
) -> (usize, &'static str, String) {
    let found = found(autopilot, change);
    assert_eq!(found.len(), 1, "{found:?}");
    (found[0].item, found[0].rule, found[0].to_string())
}

fn one(autopilot: Autopilot, change: impl FnOnce(&mut VehicleMission)) -> (usize, &'static str) {
    let (item, rule, _) = only(autopilot, change);
    (item, rule)
}

fn fine(autopilot: Autopilot, change: impl FnOnce(&mut VehicleMission)) {
    assert_eq!(found(autopilot, change), []);
}

#[test]
fn a_plain_mission_has_no_problems() {
    for autopilot in [ArduPilot, Px4] {
        fine(autopilot, |_| {});
    }
}

#[test]
fn an_empty_mission_is_nothing_to_fly() {
    assert_eq!(
        one(ArduPilot, |mission| mission.items.clear()),
        (0, "something to fly")
    );
}

#[test]
fn ardupilot_holds_650_items_with_home_and_px4_10000_without() {
    let fill =
        |count| move |mission: &mut VehicleMission| mission.items.resize(count, at(21, 3, 0.0));
    fine(ArduPilot, fill(649));
    let (item, rule, text) = only(ArduPilot, fill(650));
    assert_eq!((item, rule), (0, "item count"));
    assert_eq!(
        text,
        "mission: item count: 650 items (allowed: 649, not counting home)"
    );
    fine(Px4, fill(10_000));
    assert_eq!(one(Px4, fill(10_001)), (0, "item count"));
}

#[test]
fn a_command_is_known_to_one_autopilot_and_not_to_the_other() {
    let turns = |mission: &mut VehicleMission| mission.items[1].command = command::NAV_LOITER_TURNS;
    fine(ArduPilot, turns);
    let (item, rule, text) = only(Px4, turns);
    assert_eq!((item, rule), (2, "known command"));
    assert!(
        text.starts_with("mission item 2: known command: command 18"),
        "{text}"
    );
}

#[test]
fn px4_has_no_terrain_frame_and_neither_takes_local_frames() {
    let set = |frame| move |mission: &mut VehicleMission| mission.items[1].frame = frame;
    fine(ArduPilot, set(10));
    assert_eq!(one(Px4, set(10)), (2, "frame"));
    for autopilot in [ArduPilot, Px4] {
        fine(autopilot, set(6));
        assert_eq!(one(autopilot, set(1)), (2, "frame"));
    }
}

/// ArduPilot takes frame 2 for absolute without a word.
#[test]
fn a_place_in_the_frame_of_commands_is_refused() {
    for autopilot in [ArduPilot, Px4] {
        assert_eq!(
            one(autopilot, |mission| mission.items[1].frame = 2),
            (2, "frame")
        );
    }
}

#[test]
fn px4_takes_commands_without_a_place_in_frame_2_only() {
    let rtl =
        |mission: &mut VehicleMission| mission.items[2] = at(command::NAV_RETURN_TO_LAUNCH, 3, 0.0);
    fine(ArduPilot, rtl);
    assert_eq!(one(Px4, rtl), (3, "frame"));
}

#[test]
fn nan_is_a_default_for_px4_and_for_the_heading_of_some_ardupilot_commands() {
    let set = |index: usize| {
        move |mission: &mut VehicleMission| mission.items[1].params[index] = f32::NAN
    };
    for index in 0..4 {
        fine(Px4, set(index));
    }
    fine(ArduPilot, set(3));
    for index in 0..3 {
        let (item, rule, text) = only(ArduPilot, set(index));
        assert_eq!((item, rule), (2, "finite parameters"));
        assert!(
            text.contains(&format!("param{} is NaN", index + 1)),
            "{text}"
        );
    }
}

#[test]
fn infinite_parameters_are_refused() {
    for autopilot in [ArduPilot, Px4] {
        let endless = |mission: &mut VehicleMission| mission.items[1].params[1] = f32::INFINITY;
        assert_eq!(one(autopilot, endless), (2, "finite parameters"));
    }
}

#[test]
fn latitude_and_longitude_are_on_earth() {
    for autopilot in [ArduPilot, Px4] {
        assert_eq!(
            one(autopilot, |mission| mission.items[1].x = 950_000_000),
            (2, "latitude")
        );
        assert_eq!(
            one(autopilot, |mission| mission.items[1].y = -1_800_000_001),
            (2, "longitude")
        );
    }
}

#[test]
fn zero_zero_is_no_place_but_to_arducopter_the_present_one() {
    let origin = |mission: &mut VehicleMission| (mission.items[1].x, mission.items[1].y) = (0, 0);
    assert_eq!(one(Px4, origin), (2, "a real place"));
    fine(ArduPilot, origin);
}

#[test]
fn a_takeoff_or_landing_at_zero_zero_is_where_ardupilot_stands() {
    for index in [0, 2] {
        let here = |mission: &mut VehicleMission| {
            (mission.items[index].x, mission.items[index].y) = (0, 0);
        };
        fine(ArduPilot, here);
        assert_eq!(one(Px4, here), (index + 1, "a real place"));
    }
}

#[test]
fn an_altitude_is_a_number_that_fits() {
    for autopilot in [ArduPilot, Px4] {
        for z in [f32::NAN, f32::INFINITY, 83_000.0, -83_000.0] {
            assert_eq!(
                one(autopilot, |mission| mission.items[1].z = z),
                (2, "altitude"),
                "{z}"
            );
        }
        fine(autopilot, |mission| mission.items[1].z = 82_999.0);
    }
}

/// ArduPilot reads 70000 s as 4464 s and -1 s as 65535 s.
#[test]
fn a_hold_fits_16_bits() {
    for hold_s in [70_000.0, -1.0] {
        let (item, rule, _) = only(ArduPilot, |mission| mission.items[1].params[0] = hold_s);
        assert_eq!((item, rule), (2, "hold time"));
    }
}

#[test]
fn a_jump_goes_to_an_item_as_the_autopilot_counts_them() {
    let jump = |target| {
        move |mission: &mut VehicleMission| {
            mission.items.push(Item::without_place(
                command::DO_JUMP,
                [target, 1.0, 0.0, 0.0],
            ));
        }
    };
    for (autopilot, allowed, refused) in [
        (ArduPilot, [1.0, 4.0], [0.0, 5.0]),
        (Px4, [0.0, 3.0], [-1.0, 4.0]),
    ] {
        for target in allowed {
            fine(autopilot, jump(target));
        }
        for target in refused {
            assert_eq!(one(autopilot, jump(target)), (4, "jump target"), "{target}");
        }
        assert_eq!(one(autopilot, jump(1.5)), (4, "jump target"));
    }
}

#[test]
fn the_first_place_is_a_takeoff_but_a_delay_may_come_before() {
    let waypoint_first = |mission: &mut VehicleMission| mission.items.swap(0, 1);
    assert_eq!(one(ArduPilot, waypoint_first), (1, "takeoff first"));
    // PX4 climbs to it by itself, and rejects a takeoff after it (`FeasibilityChecker::checkTakeoff`).
    fine(Px4, |mission| {
        mission.items.remove(0);
    });
    assert_eq!(one(Px4, waypoint_first), (2, "takeoff first of all"));
    for autopilot in [ArduPilot, Px4] {
        fine(autopilot, |mission| {
            mission.items.insert(
                0,
                Item::without_place(command::NAV_DELAY, [5.0, -1.0, -1.0, -1.0]),
            );
        });
    }
}

#[test]
fn px4_takes_a_takeoff_before_anything_that_counts_as_a_place() {
    for before in [211, 42600] {
        let gripper = |mission: &mut VehicleMission| {
            mission.items.insert(0, at(before, 2, 0.0));
        };
        let of = found(Px4, gripper);
        let is_it = |of: &AcceptanceProblem| (of.item, of.rule) == (2, "takeoff first of all");
        assert!(of.iter().any(is_it), "{before}: {of:?}");
    }
    fine(Px4, |mission| {
        let wait = Item::without_place(command::NAV_DELAY, [5.0, -1.0, -1.0, -1.0]);
        mission.items.insert(0, wait);
    });
}

#[test]
fn px4_takes_one_start_of_a_landing_on_wings_before_the_landing_and_no_return_after_it() {
    let start = || at(command::DO_LAND_START, 2, 0.0);
    let vtol = |change: &dyn Fn(&mut Vec<Item>)| {
        found(Px4, |mission| {
            mission.airframe = Airframe::Vtol;
            mission.items[0].command = command::NAV_VTOL_TAKEOFF;
            mission.items[2].command = command::NAV_VTOL_LAND;
            change(&mut mission.items);
        })
    };
    let rule = |of: &[AcceptanceProblem]| {
        let of = of.iter().find(|of| of.rule == "start of the landing");
        of.map(|of| of.item)
    };
    assert_eq!(rule(&vtol(&|items| items.insert(2, start()))), None);
    let twice = vtol(&|items| {
        items.insert(2, start());
        items.insert(1, start());
    });
    assert_eq!(rule(&twice), Some(4));
    let late = vtol(&|items| items.push(start()));
    assert_eq!(rule(&late), Some(4));
    let home = vtol(&|items| {
        items.insert(2, start());
        items.push(at(command::NAV_RETURN_TO_LAUNCH, 2, 0.0));
    });
    assert_eq!(rule(&home), Some(5));
}

#[test]
fn a_takeoff_goes_up() {
    let to = |frame, z| {
        move |mission: &mut VehicleMission| {
            (mission.items[0].frame, mission.items[0].z) = (frame, z)
        }
    };
    for autopilot in [ArduPilot, Px4] {
        assert_eq!(one(autopilot, to(3, 0.0)), (1, "takeoff altitude"));
        assert_eq!(one(autopilot, to(0, 390.0)), (1, "takeoff altitude"));
        // PX4's rule "acceptance radius and 1 m" is gone since mid-2024.
        fine(autopilot, to(3, 5.0));
    }
}

fn action(command: u16) -> impl Fn(&mut VehicleMission) {
    move |mission| {
        mission
            .items
            .insert(1, Item::without_place(command, [0.0; 4]))
    }
}

#[test]
fn commands_without_motion_are_known_to_those_that_accept_them() {
    for command in [
        83, 191, 193, 194, 202, 210, 212, 213, 215, 216, 217, 218, 223, 531, 532, 534, 600, 601,
        1000, 2000, 2001, 2500, 2501, 42600, 42702, 42703,
    ] {
        fine(ArduPilot, action(command));
    }
    for command in [212, 214, 400, 534, 1001] {
        fine(Px4, action(command));
    }
    assert_eq!(one(Px4, action(600)), (2, "known command"));
    // PX4 receives a delay of what is done next, and calls the mission not feasible.
    fine(ArduPilot, action(112));
    assert_eq!(one(Px4, action(112)), (2, "known command"));
    assert_eq!(one(ArduPilot, action(214)), (2, "known command"));
}

#[test]
fn a_landing_sequence_has_an_altitude_for_ardupilot_and_frame_2_for_px4() {
    let start =
        |frame, z| move |mission: &mut VehicleMission| mission.items.insert(1, at(189, frame, z));
    fine(ArduPilot, start(3, 80.0));
    fine(ArduPilot, start(2, 0.0));
    assert_eq!(one(ArduPilot, start(3, f32::NAN)), (2, "altitude"));
    assert_eq!(one(ArduPilot, start(2, f32::NAN)), (2, "altitude"));
    assert_eq!(one(ArduPilot, start(2, 90_000.0)), (2, "altitude"));
    fine(Px4, |mission| {
        mission.items.insert(1, Item::without_place(189, [0.0; 4]));
    });
    assert_eq!(one(Px4, start(3, 80.0)), (2, "frame"));
}

/// `AP_Mission::stored_in_location`: the frame does not matter.
#[test]
fn ardupilot_checks_the_location_of_a_landing_sequence_in_frame_2_too() {
    let start = |x, y| {
        move |mission: &mut VehicleMission| {
            mission.items.insert(
                1,
                Item {
                    x,
                    y,
                    ..at(189, 2, 0.0)
                },
            );
        }
    };
    assert_eq!(one(ArduPilot, start(950_000_000, 0)), (2, "latitude"));
    assert_eq!(one(ArduPilot, start(0, 1_900_000_000)), (2, "longitude"));
    fine(ArduPilot, start(0, 0));
    assert_eq!(one(Px4, start(950_000_000, 0)), (2, "unread parameter"));
    fine(Px4, |mission| {
        of_version(1, 17)(mission);
        start(950_000_000, 0)(mission);
    });
}

#[test]
fn px4_rejects_a_region_of_interest_at_a_location_in_the_frame_of_commands() {
    let roi = |frame, mode| {
        move |mission: &mut VehicleMission| {
            let mut item = at(201, frame, 10.0);
            item.params[0] = mode;
            mission.items.insert(1, item);
        }
    };
    assert_eq!(one(Px4, roi(2, 3.0)), (2, "parameter value"));
    assert_eq!(one(Px4, roi(2, 4.0)), (2, "unread parameter"));
    fine(Px4, |mission| {
        of_version(1, 17)(mission);
        roi(3, 3.0)(mission);
    });
    fine(ArduPilot, roi(2, 3.0));
}

/// `DO_GIMBAL_MANAGER_CONFIGURE`: -1 leaves the control, -2 takes it, -3 releases it, others are ids.
#[test]
fn px4_takes_ids_of_bytes_for_the_control_of_a_gimbal() {
    for param in 0..4 {
        let with = |value: f32| {
            move |mission: &mut VehicleMission| {
                let mut item = at(1001, 2, 0.0);
                item.params = [-2.0, -2.0, -3.0, -1.0];
                item.params[param] = value;
                mission.items.insert(1, item);
            }
        };
        for good in [-3.0, -2.0, -1.0, 0.0, 255.0] {
            fine(Px4, with(good));
        }
        for bad in [-4.0, 256.0, 300.0, 1.5] {
            let (_, rule, text) = only(Px4, with(bad));
            assert_eq!(rule, "parameter value");
            assert!(text.contains("a whole number from -3 to 255"), "{text}");
        }
    }
}

fn of_version(major: u8, minor: u8) -> impl FnOnce(&mut VehicleMission) {
    move |mission| mission.autopilot_version = Some(Version { major, minor })
}

#[test]
fn px4_since_1_18_rejects_numbers_in_parameters_that_it_does_not_read() {
    let set = |index: usize, value: f32| {
        move |mission: &mut VehicleMission| mission.items[1].params[index] = value
    };
    let (item, rule, text) = only(Px4, set(2, 5.0));
    assert_eq!((item, rule), (2, "unread parameter"));
    assert!(
        text.contains("param3 is 5 (allowed: 0 or NaN: PX4 1.18"),
        "{text}"
    );
    fine(Px4, set(2, f32::NAN));
    fine(ArduPilot, set(2, 5.0));
    fine(Px4, |mission| {
        of_version(1, 17)(mission);
        set(2, 5.0)(mission);
    });
    let (item, rule) = one(Px4, |mission| {
        of_version(1, 18)(mission);
        set(2, 5.0)(mission);
    });
    assert_eq!((item, rule), (2, "unread parameter"));
}

/// Each uploaded to PX4 1.18 beta in its own simulator: refused with 6 to 12, by the parameter.
#[test]
fn px4_1_18_reads_these_parameters_of_these_commands_alone() {
    let unread: [(u16, &[u8]); 30] = [
        (17, &[1, 2]),
        (20, &[1, 2, 3, 4, 5, 6, 7]),
        (22, &[1, 2, 3]),
        (31, &[3]),
        (93, &[5, 6, 7]),
        (177, &[3, 4, 5, 6, 7]),
        (178, &[4, 5, 6, 7]),
        (189, &[1, 2, 3, 4, 5, 6, 7]),
        (195, &[1, 2, 3, 4]),
        (196, &[2, 3, 4, 5, 6, 7]),
        (197, &[2, 3, 4, 5, 6, 7]),
        (201, &[4, 5, 6, 7]),
        (206, &[5, 6, 7]),
        (211, &[3, 4, 5, 6, 7]),
        (212, &[3, 4, 5, 6, 7]),
        (214, &[4, 5, 6, 7]),
        (400, &[3, 4, 5, 6, 7]),
        (530, &[3, 4, 5, 6, 7]),
        (532, &[4, 5, 6, 7]),
        (534, &[4, 5, 6, 7]),
        (2000, &[5, 6, 7]),
        (2001, &[2, 3, 4, 5, 6, 7]),
        (2003, &[5, 6, 7]),
        (2500, &[4, 5, 6, 7]),
        (2501, &[3, 4, 5, 6, 7]),
        (3000, &[3, 4, 5, 6, 7]),
        (42_600, &[5, 6, 7]),
        // Not checked.
        (1000, &[]),
        (203, &[]),
        (187, &[]),
    ];
    for (command, unread) in unread {
        let placed = [17, 22, 31, 195].contains(&command);
        let params = if placed { 1..=4 } else { 1..=7 };
        for param in params {
            let made = found(Px4, |mission| {
                let mut item = match placed {
                    true => at(command, 3, 80.0),
                    false => Item::without_place(command, [0.0; 4]),
                };
                if command == command::DO_JUMP {
                    item.params[0] = 1.0;
                }
                match param {
                    5 => item.x = 1,
                    6 => item.y = 1,
                    7 => item.z = 1.0,
                    _ => item.params[param - 1] = 1.0,
                }
                mission.items.insert(1, item);
            });
            let refused = made
                .iter()
                .any(|problem| problem.rule == "unread parameter");
            let expected = unread.iter().any(|of| usize::from(*of) == param);
            assert_eq!(refused, expected, "{command} param{param}: {made:?}");
        }
    }
}

/// Uploaded to PX4 1.18 beta: 10 (the latitude), 3 and 3.
#[test]
fn px4_rejects_a_region_of_interest_with_a_place_a_gate_and_a_zoom() {
    let mut roi = at(201, 3, 10.0);
    roi.params[0] = 3.0;
    let gate = at(4501, 3, 80.0);
    for item in [roi, gate] {
        let add = |mission: &mut VehicleMission| mission.items.insert(1, item);
        assert_eq!(one(Px4, add), (2, "unread parameter"));
        fine(Px4, |mission| {
            of_version(1, 17)(mission);
            add(mission);
        });
    }
    let zoom = |mission: &mut VehicleMission| {
        mission.items.insert(1, Item::without_place(531, [0.0; 4]));
    };
    assert_eq!(one(Px4, zoom), (2, "known command"));
    let home = |mission: &mut VehicleMission| mission.items.insert(1, at(179, 3, 80.0));
    assert_eq!(one(Px4, home), (2, "frame"));
}

/// The pitch of a takeoff: a copter has none.
#[test]
fn px4_1_18_reads_the_pitch_of_a_takeoff_on_a_wing_only() {
    let pitched = |airframe| {
        move |mission: &mut VehicleMission| {
            mission.airframe = airframe;
            mission.items[0].params[0] = 15.0;
        }
    };
    assert_eq!(one(Px4, pitched(Airframe::Copter)), (1, "unread parameter"));
    fine(Px4, pitched(Airframe::Vtol));
}

#[test]
fn a_command_of_a_later_version_is_accepted_by_that_version() {
    let arc = |mission: &mut VehicleMission| {
        mission.items[1].command = 36;
        mission.items[1].params = [90.0, 0.0, 0.0, 0.0];
    };
    let (item, rule, text) = only(ArduPilot, arc);
    assert_eq!((item, rule), (2, "known command"));
    assert!(text.contains("in ArduPilot 4.7 and later"), "{text}");
    fine(ArduPilot, |mission| {
        mission.autopilot_version = Some(Version { major: 4, minor: 7 });
        arc(mission);
    });
}

#[test]
fn small_boards_of_ardupilot_hold_15_jumps() {
    let jumps = |count| {
        move |mission: &mut VehicleMission| {
            let jump = Item::without_place(command::DO_JUMP, [2.0, 1.0, 0.0, 0.0]);
            mission.items.extend(vec![jump; count]);
        }
    };
    fine(ArduPilot, jumps(15));
    assert_eq!(one(ArduPilot, jumps(16)), (0, "jump count"));
    fine(Px4, |mission| {
        jumps(16)(mission);
    });
}

fn corner(command: u16, param1: f32) -> Item {
    Item {
        params: [param1, 0.0, 0.0, 0.0],
        autocontinue: false,
        ..at(command, 0, 0.0)
    }
}

#[test]
fn a_fence_and_its_rally_points_fit_the_storage() {
    for autopilot in [ArduPilot, Px4] {
        let allowed = facts(autopilot, Airframe::Copter).capacity;
        fine(autopilot, |mission| {
            mission.fence = vec![corner(5004, 9.0); allowed.fence];
            mission.rally = vec![corner(5100, 0.0); allowed.rally];
        });
        let too_many = found(autopilot, |mission| {
            mission.fence = vec![corner(5004, 9.0); allowed.fence + 1];
            mission.rally = vec![corner(5100, 0.0); allowed.rally + 1];
        });
        let told: Vec<_> = too_many
            .iter()
            .map(|problem| (problem.list, problem.rule))
            .collect();
        assert_eq!(
            told,
            [
                (MissionType::Fence, "item count"),
                (MissionType::Rally, "item count")
            ]
        );
    }
}

#[test]
fn a_fence_polygon_has_as_many_corners_as_each_of_them_says() {
    let polygons = |counts: &'static [f32]| {
        move |mission: &mut VehicleMission| {
            mission.fence = counts.iter().map(|&count| corner(5001, count)).collect();
        }
    };
    fine(ArduPilot, polygons(&[3.0, 3.0, 3.0, 4.0, 4.0, 4.0, 4.0]));
    fine(ArduPilot, polygons(&[3.0, 3.0, 3.0, 3.0, 3.0, 3.0]));
    for (bad, item) in [
        (&[2.0, 2.0][..], 1),
        (&[3.0, 3.0], 1),
        (&[3.0, 3.0, 3.0, 3.0], 4),
    ] {
        assert_eq!(
            one(ArduPilot, polygons(bad)),
            (item, "polygon corners"),
            "{bad:?}"
        );
    }
}

#[test]
fn a_fence_circle_has_a_radius() {
    for radius_m in [0.0, -5.0, f32::NAN, f32::INFINITY] {
        let circle = |mission: &mut VehicleMission| mission.fence = vec![corner(5003, radius_m)];
        assert_eq!(one(Px4, circle), (1, "circle radius"));
    }
}

#[test]
fn fence_and_rally_items_have_places_and_are_of_their_kind() {
    let with = |change: fn(&mut Item)| {
        move |mission: &mut VehicleMission| {
            mission.rally = vec![corner(5100, 0.0)];
            change(&mut mission.rally[0]);
        }
    };
    fine(Px4, with(|_| {}));
    assert_eq!(one(Px4, with(|item| item.frame = 10)), (1, "frame"));
    assert_eq!(
        one(Px4, with(|item| item.x = 910_000_000)),
        (1, "a real place")
    );
    assert_eq!(one(Px4, with(|item| item.z = f32::NAN)), (1, "altitude"));
    assert_eq!(
        one(Px4, with(|item| item.command = 16)),
        (1, "known command")
    );
    assert_eq!(
        one(Px4, |mission| mission.fence = vec![corner(5100, 0.0)]),
        (1, "known command")
    );
}

/// The same mission on a wing: a plane's, or a VTOL's with its own takeoff and landing.
fn winged(autopilot: Autopilot, airframe: Airframe) -> VehicleMission {
    let mut mission = good(autopilot);
    mission.airframe = airframe;
    // 1 km before the landing, 80 m above it: 4.6 degrees.
    mission.items[1].x += 90_000;
    if airframe == Airframe::Vtol {
        mission.items[0].command = command::NAV_VTOL_TAKEOFF;
        mission.items[2].command = command::NAV_VTOL_LAND;
    }
    mission
}

fn on_a_wing(
    (autopilot, airframe): (Autopilot, Airframe),
    change: impl FnOnce(&mut VehicleMission),
) -> Vec<(usize, &'static str)> {
    let mut mission = winged(autopilot, airframe);
    change(&mut mission);
    let found = problems(&mission);
    found
        .iter()
        .map(|problem| (problem.item, problem.rule))
        .collect()
}

const WINGS: [(Autopilot, Airframe); 4] = [
    (ArduPilot, Airframe::Plane),
    (ArduPilot, Airframe::Vtol),
    (Px4, Airframe::Plane),
    (Px4, Airframe::Vtol),
];

#[test]
fn a_plain_mission_of_a_wing_has_no_problems() {
    for wing in WINGS {
        assert_eq!(on_a_wing(wing, |_| {}), [], "{wing:?}");
    }
}

#[test]
fn each_airframe_takes_off_with_its_own_command() {
    for wing in WINGS {
        if wing == (Px4, Airframe::Vtol) {
            continue;
        }
        let other = |mission: &mut VehicleMission| {
            let takeoff = &mut mission.items[0].command;
            *takeoff = command::NAV_TAKEOFF + command::NAV_VTOL_TAKEOFF - *takeoff;
        };
        let found = on_a_wing(wing, other);
        assert!(found.contains(&(1, "takeoff first")), "{wing:?}: {found:?}");
    }
}

#[test]
fn each_airframe_lands_with_its_own_command() {
    let other = |mission: &mut VehicleMission| {
        let landing = &mut mission.items[2].command;
        *landing = command::NAV_LAND + command::NAV_VTOL_LAND - *landing;
    };
    for wing in WINGS {
        // `NAV_FORCE_VT` lands a VTOL of PX4 with either.
        let expected: &[_] = match wing {
            (Px4, Airframe::Vtol) => &[],
            _ => &[(3, "kind of landing")],
        };
        assert_eq!(on_a_wing(wing, other), expected, "{wing:?}");
    }
    // ArduCopter lands with either.
    fine(ArduPilot, other);
    assert_eq!(one(Px4, other), (3, "kind of landing"));
}

#[test]
fn arduplane_does_not_wait_and_px4_does() {
    for wing in WINGS {
        let delay = |mission: &mut VehicleMission| {
            let delay = Item::without_place(command::NAV_DELAY, [30.0, -1.0, -1.0, -1.0]);
            mission.items.insert(0, delay);
        };
        let expected: &[_] = match wing.0 {
            ArduPilot => &[(1, "departure delay")],
            Px4 => &[],
        };
        assert_eq!(on_a_wing(wing, delay), expected, "{wing:?}");
    }
}

#[test]
fn a_quadplane_reads_the_altitude_of_its_takeoff_above_home() {
    let amsl = |mission: &mut VehicleMission| {
        mission.items[0].frame = 0;
        mission.items[0].z = 480.0;
    };
    assert_eq!(
        on_a_wing((ArduPilot, Airframe::Vtol), amsl),
        [(1, "takeoff frame")]
    );
    assert_eq!(on_a_wing((Px4, Airframe::Vtol), amsl), []);
    assert_eq!(on_a_wing((ArduPilot, Airframe::Plane), amsl), []);
}

#[test]
fn arduplane_keeps_whole_numbers_and_no_hold() {
    for (index, value, is_fine) in [
        (0, 5.0, false),
        (1, 255.0, true),
        (1, 256.0, false),
        (1, 1.5, false),
        (2, -1.0, false),
        (2, 30.0, true),
    ] {
        let set = |mission: &mut VehicleMission| mission.items[1].params[index] = value;
        let expected: &[_] = if is_fine {
            &[]
        } else {
            &[(2, "whole numbers")]
        };
        assert_eq!(
            on_a_wing((ArduPilot, Airframe::Plane), set),
            expected,
            "{index}: {value}"
        );
        let px4: &[_] = match index {
            2 => &[(2, "unread parameter")],
            _ => &[],
        };
        assert_eq!(on_a_wing((Px4, Airframe::Plane), set), px4);
    }
    let circle = |mission: &mut VehicleMission| {
        mission.items[2].command = command::NAV_LOITER_UNLIM;
        mission.items[2].params[2] = 80.5;
        mission.items[2].z = 80.0;
    };
    assert_eq!(
        on_a_wing((ArduPilot, Airframe::Plane), circle),
        [(3, "whole numbers")]
    );
}

#[test]
fn px4_lands_a_plane_from_a_waypoint_above_on_a_glide_that_is_not_too_steep() {
    let plane = (Px4, Airframe::Plane);
    let steepest = |glide_deg: f32| {
        move |mission: &mut VehicleMission| {
            mission.params = vec![Parameter {
                name: "FW_LND_ANG".to_owned(),
                value: glide_deg,
                why: String::new(),
            }];
        }
    };
    assert_eq!(on_a_wing(plane, steepest(5.0)), []);
    assert_eq!(on_a_wing(plane, steepest(4.0)), [(3, "landing approach")]);
    let level = |mission: &mut VehicleMission| mission.items[2].z = 80.0;
    assert_eq!(on_a_wing(plane, level), [(3, "landing approach")]);
    let circle = |mission: &mut VehicleMission| mission.items[1].command = 17;
    assert_eq!(on_a_wing(plane, circle), [(3, "landing approach")]);
    assert_eq!(on_a_wing((ArduPilot, Airframe::Plane), level), []);
}

#[test]
fn arduplane_holds_655_items_with_home_and_84_fence_points() {
    let fill = |count| {
        move |mission: &mut VehicleMission| {
            let waypoint = mission.items[1];
            mission.items.resize(count, waypoint);
        }
    };
    let plane = (ArduPilot, Airframe::Plane);
    assert_eq!(on_a_wing(plane, fill(654)), []);
    assert_eq!(on_a_wing(plane, fill(655)), [(0, "item count")]);
    let fence =
        |count| move |mission: &mut VehicleMission| mission.fence = vec![corner(5004, 9.0); count];
    assert_eq!(on_a_wing(plane, fence(84)), []);
    assert_eq!(on_a_wing(plane, fence(85)), [(0, "item count")]);
}
