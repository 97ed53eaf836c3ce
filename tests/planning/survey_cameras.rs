//! Where the camera of a survey points: pictures count while it looks straight down.

use std::f64::consts::FRAC_PI_2;

use sortie::geodesy::Agl;
use sortie::mission::{Item, command};
use sortie::spec::*;

use crate::support::place;
use crate::surveys::{dispatched, failed, field, judged, line, spec};

const COVERED: &str = "area covered of task field";

fn gimbal(pitch_deg: f32, yaw_deg: f32) -> Item {
    let params = [pitch_deg, yaw_deg, 0.0, 0.0];
    Item::without_place(command::DO_GIMBAL_MANAGER_PITCHYAW, params)
}

fn mount(pitch_deg: f32) -> Item {
    Item {
        z: 2.0,
        ..Item::without_place(command::DO_MOUNT_CONTROL, [pitch_deg, 0.0, 0.0, 0.0])
    }
}

fn controlled() -> Item {
    let itself = [-2.0, -2.0, -1.0, -1.0];
    Item::without_place(command::DO_GIMBAL_MANAGER_CONFIGURE, itself)
}

fn roi(command: u16, items: &[Item]) -> Item {
    let waypoint = items
        .iter()
        .find(|item| item.command == command::NAV_WAYPOINT);
    Item {
        command,
        // MAV_ROI_LOCATION, of the older command alone.
        params: [
            f32::from(u8::from(command == command::DO_SET_ROI)) * 3.0,
            0.0,
            0.0,
            0.0,
        ],
        ..*waypoint.expect("a waypoint")
    }
}

fn yaw(heading_deg: f32) -> Item {
    Item::without_place(command::CONDITION_YAW, [heading_deg, 0.0, 0.0, 0.0])
}

#[test]
fn pictures_do_not_count_while_an_item_has_turned_the_camera_away() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let spec = spec(autopilot, 1, field(Vec::new(), Some(FRAC_PI_2)));
        let planned = dispatched(&spec);
        // What is inserted before the pictures of the fourth line begin.
        let with = |inserted: &dyn Fn(&[Item]) -> Vec<Item>| {
            judged(&spec, &planned, &|items| {
                let at = line(items, 3).start() + 1;
                let inserted = inserted(items);
                items.splice(at..at, inserted);
            })
        };
        let number = line(&planned.1.missions[0].1.items, 3).start() + 2;
        let set = [command::DO_SET_ROI_LOCATION, command::DO_SET_ROI];
        type Insert<'a> = (&'a str, &'a dyn Fn(&[Item]) -> Vec<Item>);
        let away: [Insert<'_>; 5] = [
            ("DO_GIMBAL_MANAGER_PITCHYAW", &|_| vec![gimbal(0.0, 0.0)]),
            ("DO_GIMBAL_MANAGER_PITCHYAW", &|_| vec![gimbal(-90.0, 90.0)]),
            ("DO_MOUNT_CONTROL", &|_| vec![mount(0.0)]),
            ("DO_SET_ROI_LOCATION", &|items| vec![roi(set[0], items)]),
            ("DO_SET_ROI", &|items| vec![roi(set[1], items)]),
        ];
        for (name, inserted) in away {
            let failed = with(inserted);
            let named = format!("item {number} of copter1 ({name}) turns the camera away");
            let is_named = |text: &String| text.contains(COVERED) && text.contains(&named);
            assert!(failed.iter().any(is_named), "{named}: {failed:?}");
        }
        let none = || Item::without_place(command::DO_SET_ROI_NONE, [0.0; 4]);
        let px4 = autopilot == Autopilot::Px4;
        let control = || px4.then(controlled);
        let down: [Insert<'_>; 3] = [
            ("mount", &|_| vec![mount(0.0), mount(-90.0)]),
            ("roi", &|items| vec![roi(set[0], items), none()]),
            ("gimbal", &|_| {
                let turned = [gimbal(30.0, 0.0), gimbal(-90.0, 0.0)];
                control().into_iter().chain(turned).collect()
            }),
        ];
        for (name, inserted) in down {
            assert_eq!(with(inserted), Vec::<String>::new(), "{name}");
        }
        if px4 {
            // Nobody has control of it.
            assert!(!with(&|_| vec![gimbal(-90.0, 0.0)]).is_empty());
        } else {
            // The end of a region of interest does not pitch it again.
            let inserted = |items: &[Item]| vec![gimbal(-90.0, 0.0), roi(set[0], items), none()];
            assert!(!with(&inserted).is_empty());
            // The lines run east and west.
            assert!(with(&|_| vec![yaw(10.0)])[0].contains("(CONDITION_YAW)"));
            assert_eq!(with(&|_| vec![yaw(92.0)]), Vec::<String>::new());
        }
    }
}

#[test]
fn a_camera_that_was_turned_at_a_stop_looks_down_again_on_the_lines() {
    let seen = EndPoint {
        place: place(36.305, -84.25),
        altitude: Placement::Agl(Agl(0.0)),
    };
    let level = StopAction::Gimbal {
        pitch_deg: 0,
        yaw_deg: 0,
    };
    let cases = [
        (vec![level.clone()], vec![]),
        (vec![], vec![level.clone()]),
        (vec![], vec![StopAction::Roi(seen)]),
        (vec![level], vec![StopAction::Roi(seen)]),
    ];
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        for (at_start, at_visit) in cases.clone() {
            let mut spec = spec(autopilot, 1, field(Vec::new(), Some(FRAC_PI_2)));
            let vehicle = &mut spec.vehicles[0];
            vehicle.on_way.start = at_start;
            let end = EndPoint {
                place: place(36.3013, -84.2550),
                altitude: Placement::Agl(Agl(70.0)),
            };
            let mut stop = Stop::passing("look", end);
            stop.actions = at_visit;
            vehicle.stops = vec![stop];
            let (_, done) = dispatched(&spec);
            assert!(done.review.passes(), "{:?}", failed(&done.review));
            let items = &done.missions[0].1.items;
            let before = &items[..=*line(items, 0).start()];
            let ends = |item: &Item| {
                *item == gimbal(-90.0, 0.0) || item.command == command::DO_SET_ROI_NONE
            };
            assert!(before.iter().any(ends));
            assert!(!items[before.len()..].iter().any(ends), "once");
        }
    }
}

#[test]
fn lines_and_pictures_further_apart_than_overlaps_below_one_half_allow_are_gaps() {
    let mut sweep = field(Vec::new(), Some(FRAC_PI_2));
    let half = 22.5_f64.to_radians().tan();
    sweep.sensor = Some(Sensor {
        across: 30_f64.to_radians().tan(),
        along: Some((half, 0.45)),
        side_overlap: 0.45,
    });
    let spec = spec(Autopilot::ArduPilot, 1, sweep);
    let planned = dispatched(&spec);
    assert_eq!(judged(&spec, &planned, &|_| ()), Vec::<String>::new());
    let covered = |failed: Vec<String>| failed.iter().any(|text| text.contains(COVERED));
    assert!(covered(judged(&spec, &planned, &|items| {
        items.drain(line(items, 2));
    })));
    let with_distance = |distance_m: f32| {
        judged(&spec, &planned, &|items| {
            for item in items.iter_mut().filter(|item| item.params[0] > 5.0) {
                if item.command == command::DO_SET_CAM_TRIGG_DIST {
                    item.params[0] = distance_m;
                }
            }
        })
    };
    // 66.3 m of each picture, 45 % of them on the one before.
    assert_eq!(with_distance(36.4), Vec::<String>::new());
    assert!(covered(with_distance(38.0)));
    assert!(covered(with_distance(60.0)));
}

#[test]
fn lines_just_below_the_greatest_height_are_flown_and_seen() {
    // The greatest height leaves 1 m over the lines, a quarter, or nothing.
    for (agl_m, over_m) in [(106.0, 4.0), (109.0, 1.0), (110.0, 0.0)] {
        let mut sweep = field(Vec::new(), Some(FRAC_PI_2));
        sweep.agl = Agl(agl_m);
        let mut spec = spec(Autopilot::ArduPilot, 1, sweep);
        spec.vehicles[0].altitudes.max_agl = Some(Agl(agl_m + over_m));
        let (_, done) = dispatched(&spec);
        assert!(done.review.passes(), "{agl_m}: {:?}", failed(&done.review));
    }
}

#[test]
fn legs_of_a_pattern_below_their_height_are_not_flown() {
    let search = SearchPattern {
        pattern: Pattern::ParallelTrack,
        at: place(36.301, -84.250),
        heading_rad: 0.3,
        leg_m: 120.0,
        legs: 5,
        spacing_m: 60.0,
    };
    let shape = SweepShape::Search(search);
    let sweep = Sweep {
        shape,
        sensor: None,
        ..field(Vec::new(), None)
    };
    let spec = spec(Autopilot::ArduPilot, 1, sweep);
    let planned = dispatched(&spec);
    let lower = |by_m: f32| {
        judged(&spec, &planned, &|items| {
            for item in items.iter_mut().filter(|item| item.params[0] > 0.5) {
                if item.command == command::NAV_WAYPOINT {
                    item.z -= by_m;
                }
            }
        })
    };
    let is_low =
        |text: &String| text.contains("task field") && text.contains("is flown lower than");
    assert_eq!(judged(&spec, &planned, &|_| ()), Vec::<String>::new());
    assert!(!lower(1.0).iter().any(is_low));
    let failed = lower(20.0);
    assert!(failed.iter().any(is_low), "{failed:?}");
}

#[test]
fn a_copter_with_pictures_of_its_own_along_the_way_gets_no_survey() {
    let mut spec = spec(Autopilot::ArduPilot, 2, field(Vec::new(), Some(FRAC_PI_2)));
    spec.vehicles[0].on_way.trigger_m = Some(40.0);
    let (_, done) = dispatched(&spec);
    assert!(done.review.passes(), "{:?}", failed(&done.review));
    let tasks = done.tasks.as_ref().expect("tasks");
    assert!(tasks.done[0].is_empty() && !tasks.done[1].is_empty());
}

#[test]
fn a_zone_closed_at_the_height_of_the_lines_is_named_where_the_area_is_not_covered() {
    let mut spec = spec(Autopilot::ArduPilot, 1, field(Vec::new(), Some(FRAC_PI_2)));
    let corners = [
        (36.3005, -84.2520),
        (36.3005, -84.2500),
        (36.3020, -84.2500),
        (36.3020, -84.2520),
    ];
    spec.no_fly = vec![Zone {
        id: "belt".to_owned(),
        polygon: corners.map(|(lat, lon)| place(lat, lon)).to_vec(),
        floor: Some(Placement::Agl(Agl(60.0))),
        ceiling: Some(Placement::Agl(Agl(100.0))),
        ..Zone::default()
    }];
    let (_, done) = dispatched(&spec);
    let failed = failed(&done.review);
    let is_named = |text: &String| text.contains(COVERED) && text.contains("`belt` is closed 80 m");
    assert!(failed.iter().any(is_named), "{failed:?}");
}
