//! Where real ArduPlanes and QuadPlanes were beside their missions: judged as far as they go.
#![allow(clippy::cast_possible_truncation)]

use crate::support;
use crate::support::missions;
use missions::{GROUND_M, at, mission, waypoint};
use sortie::geodesy::{Amsl, EastNorth, LatLon};
use sortie::mission::{Item, Parameter, VehicleMission, command, frame};
use sortie::spec::*;
use sortie::verify::{Limit, Margin, review, verified_trajectories};
use support::{empty_spec, plane, threat, vtol, world};

const UP_M: f64 = GROUND_M + 80.0;
const SPEED_MPS: f64 = 18.0;

/// A place by metres east and north of the origin.
fn spot(east_m: f64, north_m: f64) -> LatLon {
    let spec = empty_spec(vec![]);
    spec.frame.from_plan(EastNorth { east_m, north_m })
}

/// The items and parameters of a wing after its takeoff: eastward to a circle of 100 m at 3 km.
fn eastward(mut vehicle: Vehicle, takeoff: Item) -> (MissionSpec, VehicleMission) {
    (vehicle.finish, vehicle.speed_mps) = (Finish::Loiter, SPEED_MPS);
    let speed = Item {
        params: [0.0, SPEED_MPS as f32, -1.0, 0.0],
        ..missions::speed(SPEED_MPS as f32)
    };
    let circle = Item {
        params: [0.0, 0.0, 100.0, 0.0],
        ..at(
            command::NAV_LOITER_UNLIM,
            frame::GLOBAL,
            spot(3000.0, 0.0),
            UP_M,
            0.0,
        )
    };
    let items = vec![takeoff, speed, waypoint(spot(1500.0, 0.0), UP_M), circle];
    let mut mission = mission(&vehicle, GROUND_M, items);
    mission.params.push(Parameter {
        name: "WP_LOITER_RAD".to_owned(),
        value: 100.0,
        why: String::new(),
    });
    (empty_spec(vec![vehicle]), mission)
}

/// A QuadPlane that rises at the origin.
fn quadplane(autopilot: Autopilot) -> (MissionSpec, VehicleMission) {
    let mut vehicle = vtol(plane("osprey", 1, spot(0.0, 0.0), spot(3000.0, 0.0)));
    vehicle.autopilot = autopilot;
    let frame = frame::GLOBAL_RELATIVE_ALT;
    eastward(
        vehicle,
        at(command::NAV_VTOL_TAKEOFF, frame, spot(0.0, 0.0), 80.0, 0.0),
    )
}

/// A plane that takes off eastward from 600 m before the origin, where it has its height.
fn climbing_plane() -> (MissionSpec, VehicleMission) {
    let mut vehicle = plane("heron", 1, spot(0.0, 0.0), spot(3000.0, 0.0));
    (vehicle.home, vehicle.climb_mps) = (spot(-600.0, 0.0), 3.0);
    eastward(
        vehicle,
        at(
            command::NAV_TAKEOFF,
            frame::GLOBAL,
            spot(0.0, 0.0),
            UP_M,
            8.0,
        ),
    )
}

/// `Plane::do_change_speed` ignores a speed beyond the limits, and TECS keeps the cruise speed within
/// them.
#[test]
fn a_planned_speed_beyond_the_airspeeds_of_the_parameters_is_said() {
    let with = |params: &[(&str, f32)]| {
        let (spec, mut mission) = climbing_plane();
        mission
            .params
            .extend(params.iter().map(|&(name, value)| Parameter {
                name: name.to_owned(),
                value,
                why: String::new(),
            }));
        margin(&spec, &mission, &Limit::Speed).expect("a margin")
    };
    assert!(with(&[]).ok);
    assert!(with(&[("AIRSPEED_MAX", 22.0), ("AIRSPEED_MIN", 9.0)]).ok);
    // Nothing says how fast it is.
    let ignored = with(&[("AIRSPEED_MAX", 15.0)]);
    assert!(!ignored.ok && ignored.value.is_nan(), "{ignored:?}");
    assert!(
        ignored
            .note
            .contains("no DO_CHANGE_SPEED within AIRSPEED_MAX 15"),
        "{ignored:?}"
    );
    let slower = with(&[("ARSPD_FBW_MAX", 15.0), ("AIRSPEED_CRUISE", 18.0)]);
    assert!(
        !slower.ok && (slower.value - 3.0).abs() < 1e-6,
        "{slower:?}"
    );
    assert!(slower.note.contains("within AIRSPEED_MAX 15"), "{slower:?}");
}

/// `Plane::mission_alt_offset`.
#[test]
fn a_mission_that_a_parameter_raises_or_lowers_is_not_judged_as_if_it_did_not() {
    let judged = |offset_m: f32| {
        let (spec, mut mission) = climbing_plane();
        mission.params.push(Parameter {
            name: "ALT_OFFSET".to_owned(),
            value: offset_m,
            why: String::new(),
        });
        margin(&spec, &mission, &Limit::ItemsJudged).expect("a margin")
    };
    assert!(judged(0.0).ok);
    for offset_m in [-60.0, 20.0] {
        let found = judged(offset_m);
        assert!(!found.ok && found.note.contains("ALT_OFFSET"), "{found:?}");
    }
}

/// With a wind from a direction, in the spec and on its vehicles.
fn windy(spec: &mut MissionSpec, from_deg: f64, speed_mps: f64) {
    let wind = Some(Wind {
        from_rad: from_deg.to_radians(),
        speed_mps,
    });
    spec.wind = wind;
    for vehicle in &mut spec.vehicles {
        vehicle.wind = wind;
    }
}

fn margin(spec: &MissionSpec, mission: &VehicleMission, limit: &Limit) -> Option<Margin> {
    let review = review(spec, &world(spec), &[(0, mission)]);
    review
        .margins
        .into_iter()
        .find(|margin| margin.limit == *limit)
}

/// How far the flight keeps from a place, metres.
fn nearest_m(spec: &MissionSpec, mission: &VehicleMission, place: LatLon) -> f64 {
    let mut spec = spec.clone();
    spec.threats = vec![threat("mast", place, 1.0)];
    let found = margin(&spec, mission, &Limit::Threat("mast".to_owned()));
    found.expect("judged").value
}

/// Chords of a circle are within it: what is outside is nearer to the circle than to them.
#[test]
fn nothing_outside_of_a_circle_is_further_from_it_than_it_is() {
    let (spec, mission) = quadplane(Autopilot::Px4);
    let (out_m, off_m) = (150.0, 50.0);
    for index in 0..40 {
        // East of the middle, away from the way to the circle.
        let north_rad = f64::from(index) * 0.037 + 0.8;
        let (east_m, north_m) = (out_m * north_rad.sin(), out_m * north_rad.cos());
        let place = spot(3000.0 + east_m, north_m);
        let to_threat_m = nearest_m(&spec, &mission, place) + 1.0;
        let mut zoned = spec.clone();
        zoned.no_fly.push(Zone {
            id: "mast".to_owned(),
            polygon: [(-1e-3, -1e-3), (1e-3, -1e-3), (0.0, 1e-3)]
                .map(|(east, north)| spot(3000.0 + east_m + east, north_m + north))
                .to_vec(),
            ..Zone::default()
        });
        let found = margin(&zoned, &mission, &Limit::Zone("mast".to_owned())).expect("judged");
        for found_m in [to_threat_m, found.value] {
            assert!(found_m <= off_m + 3e-3, "{found_m} at {north_rad}");
            assert!(found_m > off_m - 0.05, "{found_m} at {north_rad}");
        }
    }
}

/// PX4 1.17 came to its circle between the tangent and the way to the middle, up to 17 m from both.
#[test]
fn a_wing_that_comes_to_a_circle_is_judged_everywhere_between_the_tangent_and_the_way_to_the_middle()
 {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let (spec, mission) = quadplane(autopilot);
        for north_m in [10.0, 30.0, 50.0, 70.0] {
            let found_m = nearest_m(&spec, &mission, spot(2850.0, north_m));
            assert!(found_m < 15.0, "{autopilot:?}, {north_m}: {found_m}");
        }
        assert!(nearest_m(&spec, &mission, spot(2600.0, -60.0)) > 40.0);
    }
}

/// Nor does the edge of the area cut anything off a circle.
#[test]
fn a_circle_is_as_near_to_the_edge_as_its_outermost_place() {
    let (mut spec, mut mission) = quadplane(Autopilot::Px4);
    spec.area.north_east.lon_deg = spot(3300.0, 0.0).lon_deg;
    // Its chords begin where the wing comes to it: a little further around each time.
    let max_m = (0..13).map(|step| {
        let middle = spot(3000.0, 5.0 * f64::from(step));
        let circle = mission.items.last_mut().expect("a circle");
        let moved = at(circle.command, frame::GLOBAL, middle, UP_M, 0.0);
        (circle.x, circle.y) = (moved.x, moved.y);
        let found = margin(&spec, &mission, &Limit::Area).expect("judged");
        found.value - 200.0
    });
    let max_m = max_m.fold(f64::NEG_INFINITY, f64::max);
    assert!(max_m.abs() <= 0.03 && max_m <= 5e-3, "{max_m}");
}

#[test]
fn a_quadplane_goes_on_where_its_nose_points_before_it_turns_onto_its_first_leg() {
    let (spec, mission) = quadplane(Autopilot::ArduPilot);
    // Two turn radii of 50 m and 80 m: flown with the nose backwards, 180 m beside and behind.
    for (east_m, north_m) in [(0.0, 150.0), (0.0, -150.0), (-150.0, 0.0), (400.0, 120.0)] {
        let found_m = nearest_m(&spec, &mission, spot(east_m, north_m));
        assert!(found_m < 10.0, "{east_m} {north_m}: {found_m}");
    }
    for (east_m, north_m) in [(0.0, 300.0), (-300.0, 0.0), (1200.0, 150.0)] {
        let found_m = nearest_m(&spec, &mission, spot(east_m, north_m));
        assert!(found_m > 60.0, "{east_m} {north_m}: {found_m}");
    }
}

#[test]
fn a_quadplane_may_be_driven_off_to_any_side_of_its_climb() {
    let (mut spec, mission) = quadplane(Autopilot::ArduPilot);
    windy(&mut spec, 270.0, 4.0);
    // Low over the ground, where nothing but the climb is: a wall lower than the first leg.
    let wall = |east_m: f64, north_m: f64| Zone {
        id: "wall".to_owned(),
        polygon: [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]
            .map(|(east, north)| spot(east_m + east, north_m + north))
            .to_vec(),
        ceiling: Some(Placement::Amsl(sortie::geodesy::Amsl(UP_M - 8.0))),
        ..Zone::default()
    };
    for (east_m, north_m) in [(20.0, 0.0), (-20.0, 0.0), (0.0, 20.0), (0.0, -20.0)] {
        let mut spec = spec.clone();
        spec.no_fly.push(wall(east_m, north_m));
        let found = margin(&spec, &mission, &Limit::Zone("wall".to_owned())).expect("judged");
        assert!(found.value < 5.0, "{east_m} {north_m}: {found:?}");
    }
}

#[test]
fn a_quadplane_is_refused_in_more_wind_than_the_model_holds_for() {
    let (mut spec, mission) = quadplane(Autopilot::ArduPilot);
    assert_eq!(margin(&spec, &mission, &Limit::Wind), None);
    windy(&mut spec, 270.0, 4.0);
    let held = margin(&spec, &mission, &Limit::Wind).expect("judged");
    assert!(held.ok && (held.bound - 4.0).abs() < 1e-9, "{held:?}");
    windy(&mut spec, 270.0, 6.0);
    let broken = margin(&spec, &mission, &Limit::Wind).expect("judged");
    assert!(
        !broken.ok && (broken.value - 6.0).abs() < 1e-9,
        "{broken:?}"
    );
    assert!(
        broken.note.contains("more than 4 m/s of wind"),
        "{}",
        broken.note
    );
    // Nor is a PX4 VTOL passed, of which nothing was measured.
    let (mut spec, mission) = quadplane(Autopilot::Px4);
    windy(&mut spec, 270.0, 6.0);
    let broken = margin(&spec, &mission, &Limit::Wind).expect("judged");
    assert!(
        !broken.ok && broken.note.contains("PX4 (VTOL)"),
        "{broken:?}"
    );
}

#[test]
fn a_plane_is_refused_in_more_wind_than_it_was_flown_in() {
    let (mut spec, mission) = climbing_plane();
    for (wind_mps, holds) in [(6.0, true), (6.5, false)] {
        windy(&mut spec, 270.0, wind_mps);
        let found = margin(&spec, &mission, &Limit::Wind).expect("judged");
        assert!(
            found.ok == holds && (found.bound - 6.0).abs() < 1e-9,
            "{found:?}"
        );
    }
}

#[test]
fn the_wind_carries_a_plane_off_its_climb_out() {
    let (mut spec, mission) = climbing_plane();
    // From the south: to the left. 5 m/s of 0.32 of a climb of 27 s: 43 m.
    let beside = |spec: &MissionSpec| {
        [40.0, -40.0].map(|north_m| nearest_m(spec, &mission, spot(-330.0, north_m)))
    };
    assert!(beside(&spec).into_iter().all(|away_m| away_m > 30.0));
    windy(&mut spec, 180.0, 5.0);
    let [downwind_m, upwind_m] = beside(&spec);
    assert!(
        downwind_m < 12.0 && upwind_m > 30.0,
        "{downwind_m} {upwind_m}"
    );
    // And so it is on its way to the next place.
    assert!(nearest_m(&spec, &mission, spot(0.0, 33.0)) < 12.0);
}

#[test]
fn an_arduplane_swings_out_of_its_circle() {
    let beyond_m = |autopilot, away_m: f64| {
        let (spec, mission) = quadplane(autopilot);
        nearest_m(&spec, &mission, spot(3000.0 + 100.0 + away_m, 0.0))
    };
    // Turns of 50 m: 38 m further out.
    for away_m in [10.0, 25.0, 35.0] {
        let found_m = beyond_m(Autopilot::ArduPilot, away_m);
        assert!(found_m < 11.0, "{away_m}: {found_m}");
    }
    assert!(beyond_m(Autopilot::ArduPilot, 80.0) > 30.0);
    assert!(beyond_m(Autopilot::Px4, 35.0) > 30.0);
}

#[test]
fn an_arduplane_swings_out_of_a_circle_that_it_leaves_again() {
    let (spec, mut mission) = quadplane(Autopilot::ArduPilot);
    let hold = Item {
        params: [60.0, 0.0, 1.0, 1.0],
        ..at(
            command::NAV_LOITER_TIME,
            frame::GLOBAL,
            spot(1500.0, 0.0),
            UP_M,
            0.0,
        )
    };
    mission.items[2] = hold;
    for away_m in [10.0, 25.0, 35.0] {
        let found_m = nearest_m(&spec, &mission, spot(1500.0, -100.0 - away_m));
        assert!(found_m < 11.0, "{away_m}: {found_m}");
    }
    assert!(nearest_m(&spec, &mission, spot(1500.0, -180.0)) > 30.0);
}

#[test]
fn a_wing_gains_time_on_its_way_and_separation_allows_for_it() {
    let (mut spec, alpha) = quadplane(Autopilot::ArduPilot);
    let all = verified_trajectories(&spec, &world(&spec), &[(0, &alpha)]);
    let flown = all[0]
        .segments
        .iter()
        .filter(|of| of.is_flown && of.to.t_s.is_finite());
    for of in flown {
        assert!((of.early_s - 0.05 * of.to.t_s).abs() < 1e-6, "{of:?}");
    }
    // A second one of its kind crosses the first leg 1300 m on, 75 s and 95 s after the takeoff.
    let mut beta = vtol(plane(
        "beta",
        2,
        spot(1300.0, -2000.0),
        spot(1300.0, 4000.0),
    ));
    (beta.finish, beta.speed_mps) = (Finish::Loiter, SPEED_MPS);
    let frame = frame::GLOBAL_RELATIVE_ALT;
    let items = vec![
        at(command::NAV_VTOL_TAKEOFF, frame, beta.home, 80.0, 0.0),
        alpha.items[1],
        Item {
            params: [0.0, 0.0, 100.0, 0.0],
            ..at(
                command::NAV_LOITER_UNLIM,
                frame::GLOBAL,
                spot(1300.0, 4000.0),
                UP_M,
                0.0,
            )
        },
    ];
    let beta_mission = mission(&beta, GROUND_M, items);
    spec.vehicles.push(beta);
    let review = review(&spec, &world(&spec), &[(0, &alpha), (1, &beta_mission)]);
    let mut margins = review.margins.iter();
    let found = margins
        .find(|margin| margin.limit == Limit::Separation)
        .expect("a pair");
    let shift = found.shift.expect("a shift");
    let slack_s = spec.separation.time_slack_s;
    assert!(shift.allowed_s.least < -slack_s - 3.0, "{shift:?}");
    assert!(shift.allowed_s.most > slack_s + 3.0, "{shift:?}");
}

/// A wall of 4 m around a place, closed below an altitude.
fn low_wall(at: LatLon, below_m: f64) -> Zone {
    let spec = empty_spec(vec![]);
    let middle = spec.frame.to_plan(at);
    Zone {
        id: "wall".to_owned(),
        polygon: [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]
            .map(|(east_m, north_m)| spot(middle.east_m + east_m, middle.north_m + north_m))
            .to_vec(),
        ceiling: Some(Placement::Amsl(Amsl(below_m))),
        ..Zone::default()
    }
}

#[test]
fn a_quadplane_beside_its_second_leg_is_judged_as_low_as_one_was_flown_there() {
    // ArduPlane 4.6.3, 2 m/s of wind: 15 m beside the leg, and by how far along it as high as on it.
    let (mut spec, mut mission) = quadplane(Autopilot::ArduPilot);
    windy(&mut spec, 145.0, 2.0);
    spec.vehicles[0].climb_mps = 3.4;
    let speed = mission.items[1];
    let circle = mission.items[3];
    let ways = [
        (-104.5, 137.5, 71.5),
        (-353.1, 464.2, 107.0),
        (-507.8, 663.5, 96.25),
    ];
    let ways = ways.map(|(east_m, north_m, up_m)| waypoint(spot(east_m, north_m), GROUND_M + up_m));
    mission.items = vec![mission.items[0], speed, ways[0], ways[1], ways[2], circle];
    let flown = spot(-227.0, 273.7);
    spec.no_fly.push(low_wall(flown, GROUND_M + 81.5));
    let found = margin(&spec, &mission, &Limit::Zone("wall".to_owned())).expect("judged");
    assert!(found.value < 5.0, "{found:?}");
}

#[test]
fn a_quadplane_that_turns_at_a_first_place_near_its_climb_is_beside_the_second_where_one_was_flown()
{
    // ArduPlane 4.7.0-beta1, 2 m/s of wind: it left its climb to the north-east, passed its first place on a course of
    // 240 degrees, and its second one 32 m beside it.
    let (mut spec, mut mission) = quadplane(Autopilot::ArduPilot);
    windy(&mut spec, 10.0, 2.0);
    (spec.vehicles[0].speed_mps, mission.items[1].params[1]) = (16.0, 16.0);
    let ways = [(-4.3, -205.5), (-4.4, -318.4), (-7.3, -687.6)];
    let ways = ways.map(|(east_m, north_m)| waypoint(spot(east_m, north_m), UP_M));
    let [takeoff, speed, _, circle] = mission.items[..] else {
        panic!("{} items", mission.items.len());
    };
    mission.items = vec![takeoff, speed, ways[0], ways[1], ways[2], circle];
    let found_m = nearest_m(&spec, &mission, spot(-36.3, -320.2));
    assert!(found_m < 5.0, "{found_m}");
}

/// PX4 1.17.0 and 1.18 beta (simulator, still air, seventeen takeoffs): up to 38 m beside their first legs where the
/// takeoff was at home, at most 4.2 m where it was 8 or 60 m ahead.
#[test]
fn a_vtol_of_px4_is_judged_around_its_climb_unless_its_takeoff_is_ahead() {
    let (mut spec, mut mission) = quadplane(Autopilot::Px4);
    spec.no_fly
        .push(low_wall(spot(20.0, 38.0), GROUND_M + 200.0));
    let wall = Limit::Zone("wall".to_owned());
    let at_home = margin(&spec, &mission, &wall).expect("judged");
    assert!(at_home.value < 1.0, "{at_home:?}");
    let ahead = waypoint(spot(60.0, 0.0), UP_M);
    (mission.items[0].x, mission.items[0].y) = (ahead.x, ahead.y);
    let turned = margin(&spec, &mission, &wall).expect("judged");
    assert!((turned.value - 36.0).abs() < 0.5, "{turned:?}");
    let judged = margin(&spec, &mission, &Limit::ItemsJudged).expect("judged");
    assert!(judged.ok, "{judged:?}");
}

/// PX4 1.17 of January 2026 (simulator, 2 and 4 m/s of wind): eight of ten could not turn their noses to a place at home and
/// gave their missions up.
#[test]
fn a_vtol_of_px4_that_takes_off_just_upwind_of_home_is_judged_as_over_its_home() {
    let (mut spec, mut mission) = quadplane(Autopilot::Px4);
    windy(&mut spec, 250.0, 4.0);
    spec.no_fly
        .push(low_wall(spot(20.0, 38.0), GROUND_M + 200.0));
    let judged = |mission: &VehicleMission| {
        [
            Limit::Zone("wall".to_owned()),
            Limit::ItemsJudged,
            Limit::TurnFit,
        ]
        .map(|limit| margin(&spec, mission, &limit).expect("judged"))
    };
    let at_home = judged(&mission);
    let upwind = waypoint(spot(-14.1, -5.1), UP_M);
    (mission.items[0].x, mission.items[0].y) = (upwind.x, upwind.y);
    for (found, home) in judged(&mission).into_iter().zip(at_home) {
        assert_eq!(found.ok, home.ok, "{found:?}");
        assert!(
            (found.value - home.value).abs() < 1e-6,
            "{found:?} {home:?}"
        );
    }
}

#[test]
fn a_vtol_of_px4_is_judged_outside_of_a_corner_with_wind_from_behind_where_one_was_flown() {
    // PX4 1.17 of January 2026, 4 m/s of wind: 31 m beside its legs and arcs.
    let (mut spec, mut mission) = quadplane(Autopilot::Px4);
    windy(&mut spec, 70.0, 4.0);
    let vehicle = &mut spec.vehicles[0];
    (vehicle.speed_mps, vehicle.max_load_factor) = (11.0, 1.2);
    let ways = [
        (-1186.0, -1073.7),
        (-1518.6, -1448.7),
        (-1552.7, -1487.1),
        (-1501.5, -1538.7),
        (-1314.0, -1374.3),
        (-1293.1, -1366.7),
    ];
    let ways = ways.map(|(east_m, north_m)| waypoint(spot(east_m, north_m), UP_M));
    let circle = mission.items[3];
    mission.items.truncate(1);
    mission.items.extend(ways);
    mission.items.push(circle);
    let found_m = nearest_m(&spec, &mission, spot(-1555.5, -1528.4));
    assert!(found_m < 8.0, "{found_m}");
}

#[test]
fn a_plane_that_climbs_to_its_circle_is_judged_inside_of_it_where_one_was_flown() {
    // ArduPlane 4.6.3, 5 m/s of wind from behind: 19.5 m below the circle, 10 m inside of it.
    let (mut spec, mut mission) = climbing_plane();
    windy(&mut spec, 270.0, 5.0);
    let vehicle = &mut spec.vehicles[0];
    vehicle.wing.as_mut().expect("a wing").loiter_radius_m = 120.0;
    mission.items[3].params[2] = 120.0;
    let before = waypoint(spot(2532.0, 0.0), UP_M - 43.75);
    mission.items.insert(3, before);
    mission.items[2] = waypoint(spot(1500.0, 0.0), UP_M - 43.75);
    spec.no_fly
        .push(low_wall(spot(3000.0 - 95.3, 55.0), UP_M - 19.0));
    let found = margin(&spec, &mission, &Limit::Zone("wall".to_owned())).expect("judged");
    assert!(found.value < 5.0, "{found:?}");
}

/// A QuadPlane that climbs by 70 m on its first leg, 400 m north, and goes on eastward by places (metres east and up).
fn climbs_and_turns(eastward: &[(f64, f64)]) -> (MissionSpec, VehicleMission) {
    let (spec, mut mission) = quadplane(Autopilot::ArduPilot);
    let ways = eastward
        .iter()
        .map(|&(east_m, up_m)| waypoint(spot(east_m, 400.0), UP_M + up_m));
    let mut circle = mission.items[3];
    let end = waypoint(
        spot(3000.0, 400.0),
        UP_M + eastward.last().expect("places").1,
    );
    (circle.x, circle.y, circle.z) = (end.x, end.y, end.z);
    let begin = mission.items[..2].to_vec();
    mission.items = begin.into_iter().chain(ways).chain([circle]).collect();
    (spec, mission)
}

/// The margin to a low wall where its nose brings it widest around the end of that leg.
fn at_wide_turn(eastward: &[(f64, f64)], below_m: f64) -> f64 {
    let (mut spec, mission) = climbs_and_turns(eastward);
    spec.no_fly.push(low_wall(spot(110.0, 450.0), below_m));
    let found = margin(&spec, &mission, &Limit::Zone("wall".to_owned()));
    found.map_or(f64::INFINITY, |found| found.value)
}

#[test]
fn a_quadplane_that_comes_wide_around_a_corner_is_there_as_low_as_its_climb_before_leaves_it() {
    // 70 m in 24 s: 9 m below the second leg, wherever beside it.
    let level = [(0.0, 70.0), (1500.0, 70.0)];
    let found_m = at_wide_turn(&level, UP_M + 75.0);
    assert!(found_m < 5.0, "the way is not there: {found_m}");
    let found_m = at_wide_turn(&level, UP_M + 65.0);
    assert!(found_m < 5.0, "{found_m}");
}

#[test]
fn a_quadplane_that_comes_wide_around_corners_lags_the_climb_of_the_third_leg_after_them() {
    // 30 m in 17 s from 80 m on: 5.6 m below.
    let climbs = [(0.0, 70.0), (40.0, 70.0), (80.0, 70.0), (400.0, 100.0)];
    let found_m = at_wide_turn(&climbs, UP_M + 80.0);
    assert!(found_m < 5.0, "the way is not there: {found_m}");
    let found_m = at_wide_turn(&climbs, UP_M + 69.0);
    assert!(found_m < 5.0, "{found_m}");
}

#[test]
fn a_wing_on_a_leg_of_a_moment_is_no_further_off_its_line_than_it_climbs_there() {
    // To the rim of the circle 3 m in 0.2 s, and 20 m up: 3.3 s of that climb would be 370 m below.
    let (spec, mut mission) = climbing_plane();
    let before = waypoint(spot(2899.95, 0.0), UP_M);
    mission.items.insert(3, before);
    mission.items[4].z += 20.0;
    let found = margin(&spec, &mission, &Limit::TerrainClearance).expect("judged");
    assert!(found.value > 55.0 && found.value < 80.0, "{found:?}");
}

/// PX4 1.17 of January 2026, its simulated VTOL at 9 m/s: it climbed at 3.4 m/s as soon as it headed for its circle, up to 17.9 m
/// above the slope to there. No slope leads to a circle (`FixedWingPositionControl::control_auto_loiter`).
#[test]
fn a_wing_of_px4_climbs_and_descends_at_once_on_its_leg_to_a_circle() {
    for (from_m, to_m) in [(54.0, 92.25), (92.25, 54.0)] {
        let (mut spec, mut mission) = quadplane(Autopilot::Px4);
        mission.items[2] = waypoint(spot(2400.0, 0.0), GROUND_M + from_m);
        mission.items[3].z = (GROUND_M + to_m) as f32;
        // Half of the way there it is at its altitude, 19 m off the slope.
        let there = low_wall(spot(2700.0, 0.0), GROUND_M + to_m + 4.0);
        spec.no_fly = vec![Zone {
            floor: Some(Placement::Amsl(Amsl(GROUND_M + to_m - 4.0))),
            ..there
        }];
        let wall = Limit::Zone("wall".to_owned());
        let away_m = margin(&spec, &mission, &wall).expect("judged").value;
        assert!(away_m < 0.0, "{from_m} to {to_m} m: {away_m} m");
    }
}

/// ArduPlane 4.7.0-dev of February 2026, its simulated QuadPlane, 16 m/s, 2 m/s of wind from ahead: 10.7 m beyond its place and
/// 9.7 m beside it, 13.2 m from all that was judged.
#[test]
fn a_quadplane_swings_over_the_place_that_it_lands_at_before_it_descends() {
    let (mut spec, mut mission) = quadplane(Autopilot::ArduPilot);
    spec.vehicles[0].finish = Finish::Land;
    let landing = command::NAV_VTOL_LAND;
    let relative = frame::GLOBAL_RELATIVE_ALT;
    mission.items[3] = at(landing, relative, spot(3000.0, 0.0), 0.0, 0.0);
    for aside_m in [-9.7, 9.7] {
        let near_m = nearest_m(&spec, &mission, spot(3010.7, aside_m));
        assert!(near_m < 6.0, "{near_m} m from it");
    }
    // It is there at the altitude that it comes with.
    for (below_m, is_met) in [(70.0, false), (90.0, true)] {
        spec.no_fly = vec![low_wall(spot(3012.0, 6.0), GROUND_M + below_m)];
        let wall = Limit::Zone("wall".to_owned());
        let away_m = margin(&spec, &mission, &wall).expect("judged").value;
        assert_eq!(away_m < 5.0, is_met, "{below_m}: {away_m}");
    }
}

/// `QuadPlane::do_vtol_land`, `Plane::set_next_WP`: without a place it lands where it is as the item begins.
#[test]
fn a_quadplane_lands_where_it_is_without_a_place_and_about_there_if_it_comes_on_its_wing() {
    let (mut spec, mut mission) = quadplane(Autopilot::ArduPilot);
    spec.vehicles[0].finish = Finish::Land;
    let here = Item {
        x: 0,
        y: 0,
        ..at(
            command::NAV_VTOL_LAND,
            frame::GLOBAL_RELATIVE_ALT,
            spot(0.0, 0.0),
            0.0,
            0.0,
        )
    };
    mission.items[3] = here;
    mission.items[2] = waypoint(spot(3000.0, 0.0), UP_M);
    let judged = |spec: &MissionSpec, mission: &VehicleMission| {
        margin(spec, mission, &Limit::ItemsJudged).expect("always judged")
    };
    let found = judged(&spec, &mission);
    assert!(found.ok, "{found:?}");
    // It flies on as it slows down, 81 m and more, and may land some 80 m before its waypoint.
    for (east_m, is_met) in [(3070.0, true), (2950.0, true), (3600.0, false)] {
        let near_m = nearest_m(&spec, &mission, spot(east_m, 0.0));
        assert_eq!(near_m < 10.0, is_met, "{east_m}: {near_m}");
    }
    // On its rotors it is where it is.
    mission.items.drain(1..3);
    assert!(judged(&spec, &mission).ok);
    // One of PX4 flies there.
    let (spec, mut px4) = quadplane(Autopilot::Px4);
    px4.items[3] = here;
    assert!(!judged(&spec, &px4).ok);
}
