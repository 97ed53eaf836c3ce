//! Paths become missions: what each autopilot gets, and that it is the path.

#![expect(clippy::float_cmp, reason = "encoded values are exact")]

use crate::support;

use std::collections::BTreeSet;

use proptest::prelude::*;
use sortie::geodesy::{Agl, Amsl, LatLon, PlanPoint};
use sortie::mission::{
    self, Item, MissionError, MissionType, VehicleMission, command, frame, problems,
};
use sortie::path::TimedPoint;
use sortie::spec::*;
use sortie::world::World;
use support::{copter, empty_spec, place, world};

const START: LatLon = LatLon {
    lat_deg: 36.25,
    lon_deg: -84.30,
};
const GOAL: LatLon = LatLon {
    lat_deg: 36.33,
    lon_deg: -84.20,
};

fn route(points: impl IntoIterator<Item = PlanPoint>) -> Vec<TimedPoint> {
    let mut t_s = 0.0;
    let mut before: Option<PlanPoint> = None;
    points
        .into_iter()
        .map(|point| {
            t_s += before.map_or(0.0, |before| before.distance_m(point) / 15.0);
            before = Some(point);
            TimedPoint { point, t_s }
        })
        .collect()
}

fn straight(from: PlanPoint, to: PlanPoint) -> Vec<TimedPoint> {
    curved(from, to, 0.0)
}

/// From one point to another, with a sideways half wave of this height and a bump over it.
fn curved(from: PlanPoint, to: PlanPoint, side_m: f64) -> Vec<TimedPoint> {
    let (east_m, north_m) = (
        to.at.east_m - from.at.east_m,
        to.at.north_m - from.at.north_m,
    );
    let length_m = east_m.hypot(north_m);
    route((0..=400).map(|step| {
        let share = f64::from(step) / 400.0;
        if step == 0 {
            return from;
        } else if step == 400 {
            return to;
        }
        let wave = (share * std::f64::consts::PI).sin();
        PlanPoint::new(
            from.at.east_m + east_m * share - north_m / length_m * side_m * wave,
            from.at.north_m + north_m * share + east_m / length_m * side_m * wave,
            Amsl(from.amsl.0 + (to.amsl.0 - from.amsl.0) * share + 0.05 * side_m.abs() * wave),
        )
    }))
}

fn spec_of(change: impl FnOnce(&mut MissionSpec)) -> (MissionSpec, World) {
    let mut spec = empty_spec(vec![copter("alpha", 1, START, GOAL)]);
    change(&mut spec);
    let world = world(&spec);
    (spec, world)
}

fn out_and_back(world: &World) -> (Vec<TimedPoint>, Vec<TimedPoint>) {
    let sites = world.sites[0].clone();
    let over_home = PlanPoint {
        at: sites.home.at,
        amsl: sites.start.amsl,
    };
    (
        curved(sites.start, sites.goal, 1500.0),
        curved(sites.goal, over_home, 1500.0),
    )
}

fn built(change: impl FnOnce(&mut MissionSpec)) -> VehicleMission {
    let (spec, world) = spec_of(change);
    let (out, back) = out_and_back(&world);
    let routes = match spec.vehicles[0].finish {
        Finish::Return => vec![out, back],
        _ => vec![out],
    };
    mission::build(&spec, &world, 0, &routes).expect("a mission")
}

fn commands(mission: &VehicleMission) -> Vec<u16> {
    mission.items.iter().map(|item| item.command).collect()
}

fn params(item: &Item) -> [f32; 4] {
    item.params
}

fn parameter(mission: &VehicleMission, name: &str) -> f32 {
    mission
        .params
        .iter()
        .find(|p| p.name == name)
        .unwrap_or_else(|| panic!("no {name}"))
        .value
}

#[test]
fn legs_are_cut_where_the_map_of_ardupilot_would_bend_them() {
    let far = LatLon {
        lat_deg: 36.33,
        lon_deg: -83.80,
    };
    for (autopilot, is_cut) in [(Autopilot::ArduPilot, true), (Autopilot::Px4, false)] {
        let mut spec = empty_spec(vec![copter("alpha", 1, START, far)]);
        spec.vehicles[0].autopilot = autopilot;
        let world = world(&spec);
        let route = straight(world.sites[0].start, world.sites[0].goal);
        let mission = mission::build(&spec, &world, 0, &[route]).expect("a mission");
        let at = |item: &&Item| item.command == command::NAV_WAYPOINT;
        let places = mission.items.iter().filter(at).map(|item| LatLon {
            lat_deg: f64::from(item.x) / 1e7,
            lon_deg: f64::from(item.y) / 1e7,
        });
        let places: Vec<LatLon> = std::iter::once(START).chain(places).collect();
        let legs_m = places.windows(2).map(|pair| pair[0].chord_m(pair[1]));
        // 45.8 km in one leg bend by 30 m, 18.6 km by 5 m.
        let longest_m = legs_m.fold(0.0, f64::max);
        assert_eq!(longest_m < 18_600.0, is_cut, "{autopilot:?} {longest_m}");
    }
}

#[test]
fn an_ardupilot_copter_takes_off_sets_its_speed_flies_and_lands() {
    let (spec, world) = spec_of(|_| {});
    let routes = [straight(world.sites[0].start, world.sites[0].goal)];
    let mission = mission::build(&spec, &world, 0, &routes).expect("a mission");
    assert_eq!(commands(&mission), [22, 178, 16, 21]);
    let [takeoff, speed, goal, land] = mission.items[..] else {
        panic!("four items")
    };
    assert_eq!(
        (takeoff.frame, takeoff.x, takeoff.y, takeoff.z),
        (0, 362_500_000, -843_000_000, 480.0)
    );
    assert_eq!((speed.frame, params(&speed)), (2, [1.0, 15.0, -1.0, 0.0]));
    assert_eq!((goal.x, goal.y, goal.z), (363_300_000, -842_000_000, 480.0));
    assert_eq!((land.x, land.y, land.z), (363_300_000, -842_000_000, 400.0));
    assert_eq!(
        (mission.home.x, mission.home.y, mission.home.amsl_m),
        (362_500_000, -843_000_000, 400.0)
    );
    assert_eq!(problems(&mission), []);
    for (name, value) in [
        ("WPNAV_SPEED", 1500.0),
        ("WPNAV_ACCEL", 250.0),
        ("WPNAV_ACCEL_C", 500.0),
        ("WPNAV_SPEED_UP", 500.0),
        ("WPNAV_SPEED_DN", 300.0),
        ("WPNAV_RADIUS", 500.0),
        ("FENCE_ENABLE", 1.0),
    ] {
        assert_eq!(parameter(&mission, name), value, "{name}");
    }
}

#[test]
fn the_parameters_of_arducopter_4_7_have_its_names_and_metres() {
    let older = built(|spec| spec.vehicles[0].return_amsl = Some(Amsl(480.0)));
    let newer = built(|spec| {
        spec.vehicles[0].return_amsl = Some(Amsl(480.0));
        spec.vehicles[0].autopilot_version = "4.7".parse().ok();
    });
    for (old, new, value) in [
        ("WPNAV_SPEED", "WP_SPD", 15.0),
        ("WPNAV_ACCEL", "WP_ACC", 2.5),
        ("WPNAV_ACCEL_C", "WP_ACC_CNR", 5.0),
        ("WPNAV_SPEED_UP", "WP_SPD_UP", 5.0),
        ("WPNAV_SPEED_DN", "WP_SPD_DN", 3.0),
        ("WPNAV_RADIUS", "WP_RADIUS_M", 5.0),
        ("LAND_SPEED", "LAND_SPD_MS", 0.5),
        ("LAND_SPEED_HIGH", "LAND_SPD_HIGH_MS", 0.0),
        ("LAND_ALT_LOW", "LAND_ALT_LOW_M", 10.0),
        ("RTL_ALT", "RTL_ALT_M", 80.0),
        ("RTL_ALT_FINAL", "RTL_ALT_FINAL_M", 0.0),
        ("RTL_CLIMB_MIN", "RTL_CLIMB_MIN_M", 0.0),
    ] {
        assert!((parameter(&newer, new) - value).abs() < 1e-4, "{new}");
        assert!(
            (parameter(&older, old) - 100.0 * value).abs() < 1e-2,
            "{old}"
        );
        let has = |mission: &VehicleMission, name: &str| {
            mission.params.iter().any(|param| param.name == name)
        };
        assert!(!has(&newer, old) && !has(&older, new), "{old} {new}");
    }
    let names = newer.params.iter().map(|param| &param.name);
    assert_eq!(names.clone().count(), names.collect::<BTreeSet<_>>().len());
    for param in &newer.params {
        let why = &param.why;
        let is_old = ["cm", "WPNAV", "LAND_SPEED"];
        assert!(!is_old.iter().any(|word| why.contains(word)), "{why}");
    }
    assert_eq!(older.items, newer.items);
}

#[test]
fn comments_of_parameters_name_others_as_the_version_does() {
    let why = |version: Option<&str>, name: &str| {
        let (mut spec, _) = spec_of(|_| ());
        spec.vehicles[0].autopilot_version = version.and_then(|text| text.parse().ok());
        let placing = Item {
            command: command::NAV_PAYLOAD_PLACE,
            frame: frame::GLOBAL,
            autocontinue: true,
            params: [0.0; 4],
            x: 0,
            y: 0,
            z: 0.0,
        };
        let (vehicle, options) = (&spec.vehicles[0], &spec.mission);
        let params = mission::parameters(vehicle, options, &[placing], 0.0, None, Some(12.0));
        let param = params.into_iter().find(|param| param.name == name);
        param.unwrap_or_else(|| panic!("no {name}")).why
    };
    for (version, name, expected) in [
        (None, "PLDP_SPEED_DN", "loads are placed at LAND_SPEED"),
        (
            Some("4.6"),
            "PLDP_SPEED_DN",
            "loads are placed at LAND_SPEED",
        ),
        (
            Some("4.7"),
            "PLDP_SPEED_DN",
            "loads are placed at LAND_SPD_MS",
        ),
        (
            Some("4.7"),
            "LAND_SPD_HIGH_MS",
            "land at WP_SPD_DN until LAND_ALT_LOW_M",
        ),
    ] {
        assert_eq!(why(version, name), expected, "{version:?}");
    }
    // The unit is that of the value.
    for (version, name, unit) in [
        (None, "ATC_ANGLE_MAX", ", degrees"),
        (None, "ANGLE_MAX", ", hundredths of a degree"),
        (Some("4.6"), "ANGLE_MAX", ", hundredths of a degree"),
        (Some("4.7"), "ATC_ANGLE_MAX", ", degrees"),
    ] {
        let found = why(version, name);
        assert!(found.contains(unit), "{version:?}: {found}");
    }
}

/// A review of a mission names parameters by the version of the vehicle in the spec.
#[test]
fn assumptions_name_parameters_as_the_version_of_the_vehicle_does() {
    let assumed = |version: Option<&str>| {
        let (spec, world) = spec_of(|spec| {
            spec.vehicles[0].autopilot_version = version.and_then(|text| text.parse().ok());
            spec.vehicles[0].finish = Finish::Return;
        });
        let (out, back) = out_and_back(&world);
        let mut mission = mission::build(&spec, &world, 0, &[out, back]).expect("a mission");
        let mut home = *mission.items.last().expect("an item");
        home.command = command::NAV_RETURN_TO_LAUNCH;
        mission.items.push(home);
        let review = sortie::verify::review(&spec, &world, &[(0, &mission)]);
        review.assumptions.join("\n")
    };
    for (version, names) in [
        (None, ["WPNAV_RADIUS", "RTL_ALT,", "speed RTL_SPEED,"]),
        (
            Some("4.6"),
            ["WPNAV_RADIUS", "RTL_ALT,", "speed RTL_SPEED,"],
        ),
        (
            Some("4.7"),
            ["WP_RADIUS_M", "RTL_ALT_M,", "speed RTL_SPEED_MS,"],
        ),
    ] {
        let found = assumed(version);
        for name in names {
            assert!(found.contains(name), "{version:?} {name}: {found}");
        }
    }
}

#[test]
fn a_px4_copter_has_its_speed_in_a_parameter_and_its_heading_open() {
    let mission = built(|spec| spec.vehicles[0].autopilot = Autopilot::Px4);
    assert!(!commands(&mission).contains(&command::DO_CHANGE_SPEED));
    assert_eq!(parameter(&mission, "MPC_XY_CRUISE"), 15.0);
    assert!(mission.items.iter().all(|item| item.params[3].is_nan()));
    assert_eq!(problems(&mission), []);
}

#[test]
fn px4_gets_a_greatest_speed_before_the_speeds_that_it_keeps_below_it() {
    let mission = built(|spec| spec.vehicles[0].autopilot = Autopilot::Px4);
    let row = |name: &str| {
        let found = mission.params.iter().position(|param| param.name == name);
        found.unwrap_or_else(|| panic!("no {name}"))
    };
    for (greatest, speed) in [
        ("MPC_XY_VEL_MAX", "MPC_XY_CRUISE"),
        ("MPC_Z_VEL_MAX_UP", "MPC_Z_V_AUTO_UP"),
        ("MPC_Z_VEL_MAX_UP", "MPC_TKO_SPEED"),
        ("MPC_Z_VEL_MAX_DN", "MPC_Z_V_AUTO_DN"),
        ("MPC_Z_VEL_MAX_DN", "MPC_LAND_SPEED"),
    ] {
        assert!(row(greatest) < row(speed), "{greatest} after {speed}");
    }
}

#[test]
fn a_departure_delay_comes_before_the_takeoff_in_the_frame_of_commands() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let mission = built(|spec| {
            spec.vehicles[0].autopilot = autopilot;
            spec.vehicles[0].depart_s = 12.5;
        });
        assert_eq!(commands(&mission)[..2], [93, 22]);
        let delay = mission.items[0];
        assert_eq!(
            (delay.frame, params(&delay)),
            (frame::MISSION, [12.5, -1.0, -1.0, -1.0])
        );
        assert_eq!(problems(&mission), []);
    }
}

#[test]
fn a_home_elsewhere_takes_off_there_and_stops_at_the_start() {
    let home = place(36.245, -84.30);
    let mission = built(|spec| spec.vehicles[0].home = home);
    assert_eq!(commands(&mission)[..3], [22, 178, 16]);
    let (takeoff, start) = (mission.items[0], mission.items[2]);
    assert_eq!((takeoff.x, takeoff.z), (362_450_000, 480.0));
    assert_eq!(
        (start.x, start.z, start.params[0]),
        (362_500_000, 480.0, 1.0)
    );
}

#[test]
fn a_return_stops_at_the_goal_flies_the_second_route_and_lands_at_home() {
    let home = place(36.245, -84.31);
    let mission = built(|spec| {
        spec.vehicles[0].home = home;
        spec.vehicles[0].finish = Finish::Return;
    });
    let stops: Vec<usize> = (0..mission.items.len())
        .filter(|&index| mission.items[index].command == 16 && mission.items[index].params[0] > 0.0)
        .collect();
    assert_eq!(stops.len(), 2, "start and goal");
    let goal = mission.items[stops[1]];
    assert_eq!((goal.x, goal.y), (363_300_000, -842_000_000));
    let [.., over_home, land] = mission.items[..] else {
        panic!("items")
    };
    assert_eq!(
        (over_home.command, over_home.x, over_home.y, over_home.z),
        (16, 362_450_000, -843_100_000, 480.0)
    );
    assert_eq!(
        (land.command, land.x, land.y, land.z),
        (21, 362_450_000, -843_100_000, 400.0)
    );
}

#[test]
fn loitering_ends_at_the_goal() {
    let mission = built(|spec| spec.vehicles[0].finish = Finish::Loiter);
    let last = mission.items.last().expect("items");
    assert_eq!(
        (last.command, last.x, last.z),
        (command::NAV_LOITER_UNLIM, 363_300_000, 480.0)
    );
}

#[test]
fn altitudes_refer_to_the_sea_to_home_or_to_the_terrain_as_the_spec_says() {
    let hill = |spec: &mut MissionSpec| {
        spec.terrain = TerrainSource::Analytic {
            base: Amsl(400.0),
            hills: vec![Hill {
                place: GOAL,
                height_m: 100.1,
                radius_m: 2000.0,
            }],
        };
    };
    for (reference, expected_frame, takeoff, goal, land) in [
        (AltitudeReference::Amsl, 0, 480.0, 580.25, 500.25),
        (AltitudeReference::Relative, 3, 80.0, 180.25, 100.25),
        (AltitudeReference::Terrain, 10, 80.0, 80.0, 0.0),
    ] {
        let mission = built(|spec| {
            hill(spec);
            spec.mission.altitude = reference;
        });
        let [.., last, landing] = mission.items[..] else {
            panic!("items")
        };
        let found = (
            mission.items[0].frame,
            mission.items[0].z,
            last.z,
            landing.z,
        );
        assert_eq!(
            found,
            (expected_frame, takeoff, goal, land),
            "{reference:?}"
        );
        assert_eq!(problems(&mission), []);
    }
}

#[test]
fn the_fence_holds_the_area_the_threats_and_zones_without_a_height() {
    let triangle = vec![
        place(36.30, -84.28),
        place(36.31, -84.28),
        place(36.30, -84.27),
    ];
    let mission = built(|spec| {
        spec.threats = vec![Threat {
            id: "radar".to_owned(),
            kind: "radar".to_owned(),
            place: place(36.35, -84.32),
            radius_m: 900.0,
        }];
        let zone = |id: &str, below: Option<Amsl>| Zone {
            id: id.to_owned(),
            polygon: triangle.clone(),
            ceiling: below.map(sortie::spec::Placement::Amsl),
            ..Zone::default()
        };
        spec.no_fly = vec![zone("all", None), zone("low", Some(Amsl(450.0)))];
        spec.rally = vec![Rally {
            place: place(36.26, -84.30),
            agl: Agl(80.5),
        }];
    });
    let fence: Vec<(u16, f32)> = mission
        .fence
        .iter()
        .map(|item| (item.command, item.params[0]))
        .collect();
    let corner = command::NAV_FENCE_POLYGON_VERTEX_INCLUSION;
    let out = command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION;
    assert_eq!(
        fence,
        [
            (corner, 4.0),
            (corner, 4.0),
            (corner, 4.0),
            (corner, 4.0),
            (out, 3.0),
            (out, 3.0),
            (out, 3.0),
            (5004, 900.0)
        ]
    );
    assert!(mission.fence.iter().all(|item| item.frame == frame::GLOBAL));
    assert_eq!(mission.notes.len(), 1);
    assert!(
        mission.notes[0].contains("zone low"),
        "{}",
        mission.notes[0]
    );
    assert_eq!((mission.rally[0].frame, mission.rally[0].z), (3, 81.0));
    assert_eq!(problems(&mission), []);
}

/// Domes and other zones with a height are in no fence: their buffer is not its margin.
#[test]
fn the_margin_of_the_fence_is_the_least_buffer_of_what_it_holds() {
    let margin_m = |ceilings: &[Option<Amsl>]| {
        let mission = built(|spec| {
            spec.buffers.area_m = 8.0;
            spec.buffers.zones_m = 3.0;
            let zones = ceilings.iter().map(|ceiling| Zone {
                id: "zone".to_owned(),
                polygon: vec![
                    place(36.30, -84.28),
                    place(36.31, -84.28),
                    place(36.30, -84.27),
                ],
                ceiling: ceiling.map(sortie::spec::Placement::Amsl),
                ..Zone::default()
            });
            spec.no_fly = zones.collect();
        });
        parameter(&mission, "FENCE_MARGIN")
    };
    assert_eq!(margin_m(&[]), 8.0);
    assert_eq!(margin_m(&[Some(Amsl(450.0))]), 8.0);
    assert_eq!(margin_m(&[Some(Amsl(450.0)), None]), 3.0);
}

#[test]
fn without_a_fence_in_the_spec_there_is_none() {
    let mission = built(|spec| spec.mission.fence = false);
    assert!(mission.fence.is_empty());
    assert!(
        mission
            .params
            .iter()
            .all(|parameter| !parameter.name.starts_with("FENCE"))
    );
}

#[test]
fn too_many_items_are_told_with_count_and_limit() {
    let (mut spec, world) = spec_of(|spec| spec.mission.max_items = 5);
    let (out, _) = out_and_back(&world);
    let error = mission::build(&spec, &world, 0, std::slice::from_ref(&out)).expect_err("too many");
    let MissionError::TooManyItems {
        ref vehicle,
        list: MissionType::Mission,
        count,
        limit: 5,
        ..
    } = error
    else {
        panic!("{error}")
    };
    assert!(vehicle == "alpha" && count > 5);
    assert!(
        error
            .to_string()
            .contains(&format!("{count} mission items (allowed: 5")),
        "{error}"
    );
    spec.mission.max_items = 200;
    spec.vehicles[0].fence_points = Some(3);
    let error = mission::build(&spec, &world, 0, &[out]).expect_err("too many");
    assert!(
        error.to_string().contains("4 fence items (allowed: 3"),
        "{error}"
    );
}

#[test]
fn what_cannot_be_encoded_is_an_error_that_names_the_vehicle() {
    let (mut spec, world) = spec_of(|_| {});
    let (out, _) = out_and_back(&world);
    let build = |spec: &MissionSpec, vehicle, routes: &[Vec<TimedPoint>]| {
        mission::build(spec, &world, vehicle, routes)
            .expect_err("no mission")
            .to_string()
    };
    assert_eq!(build(&spec, 7, &[]), "no vehicle 7: the spec has 1");
    assert!(build(&spec, 0, &[]).starts_with("vehicle alpha: 0 routes (allowed: 1"));
    assert!(build(&spec, 0, &[out[..1].to_vec()]).starts_with("vehicle alpha: 0 routes"));
    let mut lost = out.clone();
    lost[3].point.at.east_m = f64::NAN;
    assert_eq!(
        build(&spec, 0, &[lost]),
        "vehicle alpha: point 3 of route 0 is not finite"
    );
    spec.vehicles[0].finish = Finish::Return;
    assert!(
        build(&spec, 0, std::slice::from_ref(&out))
            .starts_with("vehicle alpha: 1 routes (allowed: 2")
    );
    spec.vehicles[0].finish = Finish::Land;
    spec.vehicles[0].autopilot = Autopilot::Px4;
    spec.mission.altitude = AltitudeReference::Terrain;
    assert!(build(&spec, 0, &[out]).contains("PX4 refuses altitudes above terrain"));
}

/// Decodes an item in the frame of mean sea level.
fn decoded(world: &World, item: &Item) -> PlanPoint {
    let place = item.place().expect("a place");
    PlanPoint {
        at: world.frame.to_plan(place),
        amsl: Amsl(f64::from(item.z)),
    }
}

fn distance_m(point: PlanPoint, from: PlanPoint, to: PlanPoint) -> f64 {
    let vector = |a: PlanPoint, b: PlanPoint| {
        [
            b.at.east_m - a.at.east_m,
            b.at.north_m - a.at.north_m,
            b.amsl.0 - a.amsl.0,
        ]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (along, off) = (vector(from, to), vector(from, point));
    let share = (dot(off, along) / dot(along, along).max(1e-12)).clamp(0.0, 1.0);
    let rest = [
        off[0] - share * along[0],
        off[1] - share * along[1],
        off[2] - share * along[2],
    ];
    dot(rest, rest).sqrt()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn encoded_legs_keep_the_tolerance_and_encoded_points_are_never_below_the_path(
        side_m in -3000.0..3000.0_f64,
        tolerance_m in 1.0..30.0_f64,
        rise_m in -150.0..300.0_f64,
    ) {
        let (spec, world) = spec_of(|spec| {
            spec.mission.tolerance_m = tolerance_m;
            spec.mission.max_items = 600;
            spec.vehicles[0].goal.altitude = Placement::Agl(Agl(200.0 + rise_m));
        });
        let path = curved(world.sites[0].start, world.sites[0].goal, side_m);
        let mission = mission::build(&spec, &world, 0, std::slice::from_ref(&path)).expect("a mission");
        let mut points = vec![decoded(&world, &mission.items[0])];
        points.extend(mission.items.iter().filter(|item| item.command == 16).map(|item| decoded(&world, item)));
        for sample in &path {
            let nearest_m = points
                .windows(2)
                .map(|leg| distance_m(sample.point, leg[0], leg[1]))
                .fold(f64::INFINITY, f64::min);
            prop_assert!(nearest_m <= tolerance_m, "{nearest_m} m from the legs");
        }
        for point in &points {
            let sample = path.iter().min_by(|a, b| {
                a.point.at.distance_m(point.at).total_cmp(&b.point.at.distance_m(point.at))
            }).expect("samples");
            let over_m = point.amsl.0 - sample.point.amsl.0;
            prop_assert!((-1e-6..=0.25).contains(&over_m), "{over_m} m over the path");
        }
    }
}

#[test]
fn what_is_built_from_a_good_path_passes_the_verdict() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        for altitude in [AltitudeReference::Amsl, AltitudeReference::Relative] {
            for finish in [Finish::Land, Finish::Loiter, Finish::Return] {
                let (spec, world) = spec_of(|spec| {
                    spec.vehicles[0].autopilot = autopilot;
                    spec.vehicles[0].finish = finish;
                    spec.vehicles[0].depart_s = 20.0;
                    spec.vehicles[0].home = place(36.249, -84.301);
                    spec.mission.altitude = altitude;
                });
                let (out, back) = out_and_back(&world);
                let routes = match finish {
                    Finish::Return => vec![out, back],
                    _ => vec![out],
                };
                let mission = mission::build(&spec, &world, 0, &routes).expect("a mission");
                let review = sortie::verify::review(&spec, &world, &[(0, &mission)]);
                let broken: Vec<_> = review.margins.iter().filter(|margin| !margin.ok).collect();
                assert!(
                    review.passes(),
                    "{autopilot:?} {altitude:?} {finish:?}: {broken:?}"
                );
            }
        }
    }
}

#[test]
fn no_place_that_is_flown_to_has_an_altitude_of_zero() {
    // Along the height of the sea, over ground below it.
    let mission = built(|spec| {
        spec.terrain = TerrainSource::Flat(Amsl(-80.0));
        spec.mission.altitude = AltitudeReference::Amsl;
    });
    for item in &mission.items {
        if [command::NAV_WAYPOINT, command::NAV_TAKEOFF].contains(&item.command) {
            assert!(item.z >= 0.25, "{item:?}");
        }
    }
    assert!(mission.items.iter().any(|item| item.z == 0.25));
}
