//! What each autopilot takes: one test for each rule.

use sortie::mission::{
    AcceptanceProblem, Home, Item, List, Parameter, VehicleMission, command, limits, problems,
};
use sortie::spec::{Airframe, Autopilot};

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
        "mission: item count: 650 items (allowed: 649, home aside)"
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
fn zero_zero_is_no_place() {
    let origin = |mission: &mut VehicleMission| (mission.items[1].x, mission.items[1].y) = (0, 0);
    for autopilot in [ArduPilot, Px4] {
        assert_eq!(one(autopilot, origin), (2, "a real place"));
    }
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
    for autopilot in [ArduPilot, Px4] {
        let waypoint_first = |mission: &mut VehicleMission| mission.items.swap(0, 1);
        assert_eq!(one(autopilot, waypoint_first), (1, "takeoff first"));
        fine(autopilot, |mission| {
            mission.items.insert(
                0,
                Item::without_place(command::NAV_DELAY, [5.0, -1.0, -1.0, -1.0]),
            );
        });
    }
}

#[test]
fn a_takeoff_goes_up_and_for_px4_beyond_the_acceptance_radius() {
    let to = |frame, z| {
        move |mission: &mut VehicleMission| {
            (mission.items[0].frame, mission.items[0].z) = (frame, z)
        }
    };
    assert_eq!(one(ArduPilot, to(3, 0.0)), (1, "takeoff altitude"));
    fine(ArduPilot, to(3, 5.0));
    assert_eq!(one(ArduPilot, to(0, 390.0)), (1, "takeoff altitude"));
    assert_eq!(one(Px4, to(3, 11.0)), (1, "takeoff altitude"));
    fine(Px4, to(3, 11.5));
    fine(Px4, |mission| {
        to(3, 11.0)(mission);
        let name = "NAV_ACC_RAD".to_owned();
        mission.params.push(Parameter {
            name,
            value: 2.0,
            why: String::new(),
        });
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
        let allowed = limits(autopilot);
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
            [(List::Fence, "item count"), (List::Rally, "item count")]
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
    for wing in WINGS {
        let other = |mission: &mut VehicleMission| {
            let landing = &mut mission.items[2].command;
            *landing = command::NAV_LAND + command::NAV_VTOL_LAND - *landing;
        };
        assert_eq!(on_a_wing(wing, other), [(3, "kind of landing")], "{wing:?}");
    }
    let copter = |mission: &mut VehicleMission| mission.items[2].command = command::NAV_VTOL_LAND;
    assert_eq!(one(ArduPilot, copter), (3, "kind of landing"));
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
        assert_eq!(on_a_wing((Px4, Airframe::Plane), set), []);
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
fn arduplane_holds_655_items_with_home() {
    let fill = |count| {
        move |mission: &mut VehicleMission| {
            let waypoint = mission.items[1];
            mission.items.resize(count, waypoint);
        }
    };
    let plane = (ArduPilot, Airframe::Plane);
    assert_eq!(on_a_wing(plane, fill(654)), []);
    assert_eq!(on_a_wing(plane, fill(655)), [(0, "item count")]);
}
