//! Splines, circles and the placing of payloads, judged as the autopilots fly them.
#![allow(clippy::cast_possible_truncation)]

use crate::support;
use crate::support::missions;
use missions::{GROUND_M, at, land, mission, takeoff, waypoint, with_close_posts};
use sortie::geodesy::{Amsl, EastNorth, LatLon};
use sortie::mission::{Item, Parameter, VehicleMission, command, frame};
use sortie::spec::*;
use sortie::verify::{Limit, Margin, Review, review};
use support::{copter, empty_spec, plane, threat, vtol, world};

const UP_M: f64 = GROUND_M + 80.0;

/// A place by metres east and north of the origin.
fn spot(east_m: f64, north_m: f64) -> LatLon {
    let spec = empty_spec(vec![]);
    spec.frame.from_plan(EastNorth { east_m, north_m })
}

fn spline(place: LatLon) -> Item {
    at(
        command::NAV_SPLINE_WAYPOINT,
        frame::GLOBAL,
        place,
        UP_M,
        0.0,
    )
}

fn circle(command: u16, place: LatLon, amsl_m: f64, params: [f32; 4]) -> Item {
    Item {
        params,
        ..at(command, frame::GLOBAL, place, amsl_m, 0.0)
    }
}

/// A copter that takes off at the origin, flies the items, and lands at the last place.
fn flown(items: &[Item]) -> (MissionSpec, VehicleMission) {
    let last = items.last().expect("items").place().expect("a place");
    let mut vehicle = copter("alpha", 1, spot(0.0, 0.0), last);
    vehicle.speed_mps = 10.0;
    let mut all = vec![takeoff(spot(0.0, 0.0), UP_M), missions::speed(10.0)];
    all.extend_from_slice(items);
    all.push(land(last));
    let mission = mission(&vehicle, GROUND_M, all);
    (empty_spec(vec![vehicle]), mission)
}

fn judge(spec: &MissionSpec, mission: &VehicleMission) -> Review {
    review(spec, &world(spec), &[(0, mission)])
}

fn find(review: &Review, limit: &Limit) -> Margin {
    let mut margins = review.margins.iter();
    let found = margins.find(|margin| margin.limit == *limit);
    found.unwrap_or_else(|| panic!("no {limit}")).clone()
}

/// How far the flight keeps from a place, metres.
fn nearest_m(spec: &MissionSpec, mission: &VehicleMission, place: LatLon) -> f64 {
    let mut spec = spec.clone();
    spec.threats = vec![threat("post", place, 1.0)];
    find(&judge(&spec, mission), &Limit::Threat("post".to_owned())).value + 1.0
}

fn judged(review: &Review) -> Result<(), String> {
    let margin = find(review, &Limit::ItemsJudged);
    if margin.ok { Ok(()) } else { Err(margin.note) }
}

/// What a case does to a clean mission.
type Change<'a> = &'a dyn Fn(&mut VehicleMission);

/// The Hermite polynomial, written down anew.
fn hermite(t: f64, [a, b]: [(f64, f64); 2], [u, v]: [(f64, f64); 2]) -> (f64, f64) {
    let (h00, h10) = (
        2.0 * t.powi(3) - 3.0 * t * t + 1.0,
        t.powi(3) - 2.0 * t * t + t,
    );
    let (h01, h11) = (-2.0 * t.powi(3) + 3.0 * t * t, t.powi(3) - t * t);
    let of = |a: f64, u: f64, b: f64, v: f64| h00 * a + h10 * u + h01 * b + h11 * v;
    (of(a.0, u.0, b.0, v.0), of(a.1, u.1, b.1, v.1))
}

#[test]
fn a_spline_is_the_hermite_curve_between_the_directions_of_its_neighbours() {
    let (b, c, d) = ((600.0, 0.0), (600.0, 600.0), (0.0, 600.0));
    let here = |(east, north): (f64, f64)| spot(east, north);
    // A leg from rest to a waypoint, two splines, and a straight leg after them.
    let items = [
        waypoint(here(b), UP_M),
        spline(here(c)),
        spline(here(d)),
        waypoint(spot(-600.0, 600.0), UP_M),
    ];
    let (spec, mission) = flown(&items);
    let review = judge(&spec, &mission);
    assert_eq!(judged(&review), Ok(()));
    // To c: from the course of the leg before; there along d - b, as a spline follows.
    let first = ([b, c], [(600.0, 0.0), (d.0 - b.0, d.1 - b.1)]);
    // To d: from that direction; there along the straight leg that follows.
    let second = ([c, d], [(d.0 - b.0, d.1 - b.1), (-600.0, 0.0)]);
    for (ends, tangents) in [first, second] {
        for step in 1..10 {
            let on = hermite(f64::from(step) / 10.0, ends, tangents);
            let aside_m = nearest_m(&spec, &mission, here(on));
            assert!(aside_m.abs() < 0.1, "{on:?}: {aside_m}");
        }
    }
    // The straight lines are not flown.
    assert!(nearest_m(&spec, &mission, spot(600.0, 300.0)) > 40.0);
}

#[test]
fn a_spline_begins_and_ends_at_rest_where_the_vehicle_stops() {
    // From the takeoff, and with a landing at its own place: a straight line.
    let (spec, mission) = flown(&[spline(spot(500.0, 0.0))]);
    assert_eq!(judged(&judge(&spec, &mission)), Ok(()));
    assert!(nearest_m(&spec, &mission, spot(250.0, 0.0)) < 0.1);
    // With a waypoint after it, it arrives along that leg: 1/8 of its length to the other side.
    let items = [spline(spot(500.0, 0.0)), waypoint(spot(500.0, 400.0), UP_M)];
    let (spec, mission) = flown(&items);
    assert!(nearest_m(&spec, &mission, spot(250.0, -50.0)) < 0.1);
    // With a hold it stops.
    let mut held = items;
    held[0].params[0] = 3.0;
    let (spec, mission) = flown(&held);
    assert!(nearest_m(&spec, &mission, spot(250.0, 0.0)) < 0.1);
    let lasts = |items: &[Item]| {
        let (spec, mission) = flown(items);
        let moments = &judge(&spec, &mission).tracks[0].moments;
        moments[moments.len() - 1].t_s
    };
    let mut longer = held;
    longer[0].params[0] = 10.0;
    assert!((lasts(&longer) - lasts(&held) - 7.0).abs() < 1e-6);
}

#[test]
fn a_spline_slows_down_for_its_bends() {
    // A hairpin of 40 m: half of 2.5 m/s2 across it allow about 5 m/s there, not 10.
    let bend = [
        waypoint(spot(400.0, 0.0), UP_M),
        spline(spot(400.0, 40.0)),
        waypoint(spot(0.0, 40.0), UP_M),
    ];
    let (spec, mission) = flown(&bend);
    let moments = &judge(&spec, &mission).tracks[0].moments;
    let on_bend: Vec<_> = moments.iter().filter(|at| at.item == 4).collect();
    let length_m: f64 = on_bend
        .windows(2)
        .map(|pair| pair[0].place.chord_m(pair[1].place))
        .sum();
    let lasts_s = on_bend[on_bend.len() - 1].t_s - on_bend[0].t_s;
    assert!((50.0..120.0).contains(&length_m), "{length_m}");
    let mean_mps = length_m / lasts_s;
    assert!((3.0..8.5).contains(&mean_mps), "{mean_mps}");
}

#[test]
fn a_spline_whose_end_is_not_known_is_not_judged() {
    let (spec, clean) = flown(&[spline(spot(500.0, 0.0)), waypoint(spot(500.0, 400.0), UP_M)]);
    let with = |change: &dyn Fn(&mut VehicleMission)| {
        let mut mission = clean.clone();
        change(&mut mission);
        judged(&judge(&spec, &mission)).expect_err("not judged")
    };
    let cases: [(&str, Change<'_>); 4] = [
        ("neither a waypoint nor a landing", &|m| {
            m.items.insert(3, missions::delay(4.0));
        }),
        ("neither a waypoint nor a landing", &|m| {
            m.items[3] = circle(
                command::NAV_LOITER_TURNS,
                spot(500.0, 400.0),
                UP_M,
                [1.0; 4],
            );
        }),
        ("a spline, and the item after it is not known", &|m| {
            m.items[3].command = 92;
            m.items[3].params[0] = 1.0;
        }),
        ("altitude is NaN", &|m| m.items[2].z = f32::NAN),
    ];
    for (why, change) in cases {
        let note = with(change);
        assert!(note.contains(why), "{note}");
    }
    let mut px4 = (spec, clean);
    px4.0.vehicles[0].autopilot = Autopilot::Px4;
    px4.1.autopilot = Autopilot::Px4;
    let review = judge(&px4.0, &px4.1);
    let accepted = find(&review, &Limit::Acceptance);
    assert!(!accepted.ok && judged(&review).is_err(), "{accepted:?}");
}

#[test]
fn a_copter_stops_before_its_turns_and_flies_them_at_half_of_its_acceleration() {
    let middle = spot(800.0, 0.0);
    let turns = |turns: f32, radius_m: f32| {
        let params = [turns, 0.0, radius_m, 0.0];
        let before = waypoint(spot(400.0, 0.0), UP_M);
        let circle = circle(command::NAV_LOITER_TURNS, middle, UP_M, params);
        flown(&[before, circle, waypoint(spot(400.0, 0.0), UP_M)])
    };
    let (spec, twice) = turns(2.0, 100.0);
    assert_eq!(judged(&judge(&spec, &twice)), Ok(()));
    for (east_m, north_m) in [(900.0, 0.0), (800.0, 100.0), (800.0, -100.0), (700.0, 0.0)] {
        let aside_m = nearest_m(&spec, &twice, spot(east_m, north_m));
        assert!(aside_m < 0.1, "{east_m} {north_m}: {aside_m}");
    }
    let lasts = |turns_of: (MissionSpec, VehicleMission)| {
        let moments = &judge(&turns_of.0, &turns_of.1).tracks[0].moments;
        moments[moments.len() - 1].t_s
    };
    // sqrt(0.5 * 2.5 * 100) is more than the 10 m/s that are commanded; of 20 m it is 5 m/s.
    let orbit_s = lasts(turns(2.0, 100.0)) - lasts(turns(1.0, 100.0));
    assert!(
        (orbit_s - std::f64::consts::TAU * 10.0).abs() < 0.1,
        "{orbit_s}"
    );
    let tight_s = lasts(turns(3.0, 20.0)) - lasts(turns(2.0, 20.0));
    assert!(
        (tight_s - std::f64::consts::TAU * 4.0).abs() < 0.1,
        "{tight_s}"
    );
    // Clockwise it turns to the north from the west, and to the south the other way round: a
    // quarter of a turn ends there, and the stop is on the tangent.
    let (spec, quarter) = turns(0.25, 100.0);
    assert!(nearest_m(&spec, &quarter, spot(800.0, 100.0)) < 0.5);
    assert!(nearest_m(&spec, &quarter, spot(800.0, -100.0)) > 90.0);
    let (spec, quarter) = turns(0.25, -100.0);
    assert!(nearest_m(&spec, &quarter, spot(800.0, -100.0)) < 0.5);
    // Without a radius: that of the parameters, 10 m; 0 turns are none.
    let (spec, stock) = turns(1.0, 0.0);
    assert!(nearest_m(&spec, &stock, spot(810.0, 0.0)) < 0.1);
    let (spec, none) = turns(0.0, 100.0);
    assert!(nearest_m(&spec, &none, middle) > 99.0);
    assert!(nearest_m(&spec, &none, spot(900.0, 0.0)) > 199.0);
}

#[test]
fn a_boundary_wider_than_its_zone_is_as_near_to_a_circle_as_the_fence_is() {
    let params = [1.0, 0.0, 50.0, 0.0];
    let around = circle(command::NAV_LOITER_TURNS, spot(800.0, 0.0), UP_M, params);
    let (mut spec, mut mission) = flown(&[around, waypoint(spot(400.0, 0.0), UP_M)]);
    let square = |half_m: f64| {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        // Askew, so that the nearest place is on no corner of the chords.
        let (sin, cos) = 0.3_f64.sin_cos();
        let turned = |(x, y): (f64, f64)| (x * cos - y * sin, x * sin + y * cos);
        let of = corners.map(turned);
        of.map(|(x, y)| spot(800.0 + half_m * x, 200.0 + half_m * y))
    };
    spec.no_fly = vec![Zone {
        id: "yard".to_owned(),
        polygon: square(80.0).to_vec(),
        ..Zone::default()
    }];
    spec.mission.fence = true;
    let pieces = |spec: &MissionSpec| -> Vec<Item> {
        let pieces = sortie::mission::fence_pieces(spec);
        pieces.into_iter().flat_map(|(_, items)| items).collect()
    };
    let mut wider = spec.clone();
    wider.no_fly[0].polygon = square(90.0).to_vec();
    mission.fence = pieces(&wider);
    mission.is_fence_known = true;
    let review = judge(&spec, &mission);
    let fence_m = find(&review, &Limit::Fence).value;
    let wider_m = find(&review, &Limit::FenceWider).value;
    assert!((30.0..60.0).contains(&fence_m), "{fence_m}");
    assert!((wider_m - fence_m).abs() < 1e-9, "{wider_m} {fence_m}");
}

#[test]
fn turns_that_no_autopilot_flies_so_are_not_judged() {
    for (why, place, params) in [
        ("-1 turns", spot(800.0, 0.0), [-1.0, 0.0, 100.0, 0.0]),
        ("NaN turns", spot(800.0, 0.0), [f32::NAN, 0.0, 100.0, 0.0]),
        ("radius of NaN", spot(800.0, 0.0), [1.0, 0.0, f32::NAN, 0.0]),
        (
            "place where it begins",
            spot(400.0, 1.0),
            [1.0, 0.0, 50.0, 0.0],
        ),
    ] {
        let (spec, mission) = flown(&[
            waypoint(spot(400.0, 0.0), UP_M),
            circle(command::NAV_LOITER_TURNS, place, UP_M, params),
            waypoint(spot(400.0, 300.0), UP_M),
        ]);
        let note = judged(&judge(&spec, &mission)).expect_err("not judged");
        assert!(note.contains(why), "{note}");
    }
    // 2 m from the rim ArduCopter circles at once, at the altitude that it has.
    for (higher_m, is_judged) in [(0.0, true), (1.5, false), (4.0, true)] {
        let params = [1.0, 0.0, 98.0, 0.0];
        let (spec, mission) = flown(&[
            waypoint(spot(400.0, 0.0), UP_M),
            circle(
                command::NAV_LOITER_TURNS,
                spot(500.0, 0.0),
                UP_M + higher_m,
                params,
            ),
            waypoint(spot(400.0, 300.0), UP_M),
        ]);
        assert_eq!(
            judged(&judge(&spec, &mission)).is_ok(),
            is_judged,
            "{higher_m}"
        );
    }
}

#[test]
fn a_copter_stops_at_the_waypoint_before_a_loiter_to_altitude() {
    let lasts = |command: u16| {
        let to = at(command, frame::GLOBAL, spot(400.0, 400.0), UP_M, 0.0);
        let (spec, mission) = flown(&[waypoint(spot(400.0, 0.0), UP_M), to]);
        let review = judge(&spec, &mission);
        assert_eq!(judged(&review), Ok(()));
        let moments = &review.tracks[0].moments;
        moments[moments.len() - 1].t_s
    };
    // A stop from 10 m/s with 2.5 m/s2 takes 4 s more than a pass at unchanged speed.
    let corner_s = lasts(command::NAV_WAYPOINT);
    let stop_s = lasts(command::NAV_LOITER_TO_ALT);
    assert!(stop_s > corner_s, "{stop_s} {corner_s}");
}

#[test]
fn a_copter_of_px4_that_loiters_to_an_altitude_is_said_not_to_be_modelled() {
    let to = at(
        command::NAV_LOITER_TO_ALT,
        frame::GLOBAL,
        spot(400.0, 400.0),
        UP_M,
        0.0,
    );
    let (mut spec, mut mission) = flown(&[waypoint(spot(400.0, 0.0), UP_M), to]);
    assert_eq!(judged(&judge(&spec, &mission)), Ok(()));
    spec.vehicles[0].autopilot = Autopilot::Px4;
    mission.autopilot = Autopilot::Px4;
    let why = judged(&judge(&spec, &mission)).expect_err("its motion is not known");
    assert!(
        why.contains("NAV_LOITER_TO_ALT on a copter of PX4 is not modelled"),
        "{why}"
    );
}

#[test]
fn a_payload_is_placed_by_a_column_down_to_the_ground_and_up_again() {
    let place = spot(500.0, 0.0);
    let payload = at(command::NAV_PAYLOAD_PLACE, frame::GLOBAL, place, 0.0, 0.0);
    let (spec, mission) = flown(&[payload, waypoint(spot(800.0, 0.0), UP_M)]);
    let review = judge(&spec, &mission);
    assert_eq!(judged(&review), Ok(()));
    assert!(review.passes(), "{:#?}", review.margins);
    let lowest = review.tracks[0]
        .moments
        .iter()
        .filter(|at| at.item == 3)
        .map(|at| at.amsl.0)
        .fold(f64::INFINITY, f64::min);
    assert!((lowest - GROUND_M).abs() < 0.01, "{lowest}");
    // No more than 30 m down.
    let (spec, short) = flown(&[
        Item {
            params: [30.0, 0.0, 0.0, 0.0],
            ..payload
        },
        waypoint(spot(800.0, 0.0), UP_M),
    ]);
    let moments = judge(&spec, &short).tracks[0].moments.clone();
    let lowest = moments.iter().filter(|at| at.item == 3).map(|at| at.amsl.0);
    let lowest = lowest.fold(f64::INFINITY, f64::min);
    assert!((lowest - (UP_M - 30.0)).abs() < 0.01, "{lowest}");
    // A zone that is closed below 30 m is entered on the way down.
    let mut zoned = spec.clone();
    let corner = |east, north| spot(500.0 + east, north);
    zoned.no_fly.push(Zone {
        id: "yard".to_owned(),
        polygon: vec![
            corner(-9.0, -9.0),
            corner(9.0, -9.0),
            corner(9.0, 9.0),
            corner(-9.0, 9.0),
        ],
        ceiling: Some(Placement::Amsl(Amsl(GROUND_M + 30.0))),
        ..Zone::default()
    });
    assert!(find(&judge(&zoned, &short), &Limit::Zone("yard".to_owned())).ok);
    assert!(!find(&judge(&zoned, &mission), &Limit::Zone("yard".to_owned())).ok);
}

/// ArduCopter 4.7.0-beta1 was at the altitude of the item over the place, 250 s later still.
#[test]
fn a_payload_place_at_another_altitude_than_the_waypoint_before_it_is_never_reached() {
    let judged_with = |hold_s: f32, up_m: f64| {
        let place = spot(500.0, 0.0);
        let payload = at(command::NAV_PAYLOAD_PLACE, frame::GLOBAL, place, up_m, 0.0);
        let mut before = waypoint(spot(200.0, 100.0), UP_M);
        before.params[0] = hold_s;
        let (spec, mission) = flown(&[before, payload, waypoint(spot(800.0, 0.0), UP_M)]);
        judged(&judge(&spec, &mission))
    };
    assert_eq!(judged_with(0.0, UP_M), Ok(()));
    assert_eq!(judged_with(0.0, UP_M + 1.5), Ok(()));
    assert_eq!(judged_with(0.0, 0.0), Ok(()));
    assert_eq!(judged_with(1.0, UP_M - 30.0), Ok(()));
    for up_m in [UP_M - 30.0, UP_M + 30.0] {
        let why = judged_with(0.0, up_m).expect_err("it stays there");
        assert!(why.contains("stays there for ever"), "{why}");
    }
}

/// A hill of 60 m halfway between 100 m and 900 m east of the origin.
fn hilly(items: &[Item]) -> (MissionSpec, VehicleMission) {
    let (mut spec, mission) = flown(items);
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(GROUND_M),
        hills: vec![Hill {
            place: spot(500.0, 0.0),
            height_m: 60.0,
            radius_m: 150.0,
        }],
    };
    (spec, with_close_posts(mission))
}

/// `ModeAuto::shift_alt_to_current_alt`: the altitude that it has, above what the frame of the item is
/// above. With the item above the sea it does not follow the ground, though it did before.
#[test]
fn a_payload_is_carried_level_or_over_the_ground_by_the_frame_of_its_item() {
    let terrain = frame::GLOBAL_TERRAIN_ALT;
    let clearance_m = |before: u8, of_item: u8| {
        let up_m = if before == terrain {
            40.0
        } else {
            GROUND_M + 40.0
        };
        let low = at(command::NAV_WAYPOINT, before, spot(100.0, 0.0), up_m, 0.0);
        let payload = at(
            command::NAV_PAYLOAD_PLACE,
            of_item,
            spot(900.0, 0.0),
            0.0,
            0.0,
        );
        let after = waypoint(spot(1000.0, 0.0), GROUND_M + 40.0);
        let (spec, mission) = hilly(&[low, payload, after]);
        let review = judge(&spec, &mission);
        assert_eq!(judged(&review), Ok(()));
        find(&review, &Limit::TerrainClearance).value
    };
    for before in [frame::GLOBAL, terrain] {
        for of_item in [frame::GLOBAL, frame::GLOBAL_RELATIVE_ALT] {
            let level_m = clearance_m(before, of_item);
            assert!(
                (level_m + 20.0).abs() < 0.1,
                "{before} {of_item}: {level_m}"
            );
        }
        let over_m = clearance_m(before, terrain);
        assert!((over_m - 40.0).abs() < 0.2, "{before}: {over_m}");
    }
}

#[test]
fn a_landing_above_terrain_follows_the_ground_to_its_place() {
    let ceiling_m = |of_item: u8| {
        let (spec, mut mission) = hilly(&[waypoint(spot(100.0, 0.0), GROUND_M + 70.0)]);
        let down = mission.items.last_mut().expect("a landing");
        *down = at(command::NAV_LAND, of_item, spot(900.0, 0.0), 0.0, 0.0);
        let review = judge(&spec, &mission);
        assert_eq!(judged(&review), Ok(()));
        find(&review, &Limit::Ceiling).value
    };
    // The takeoff is higher: to 80 m.
    for of_item in [frame::GLOBAL, frame::GLOBAL_RELATIVE_ALT] {
        let level_m = ceiling_m(of_item);
        assert!((level_m - UP_M).abs() < 0.01, "{of_item}: {level_m}");
    }
    let over_m = ceiling_m(frame::GLOBAL_TERRAIN_ALT);
    assert!((over_m - (GROUND_M + 130.0)).abs() < 0.2, "{over_m}");
}

/// `Mission::calculate_takeoff_altitude`.
#[test]
fn a_px4_copter_climbs_to_the_takeoff_altitude_of_its_parameters() {
    let (mut spec, mut mission) = flown(&[waypoint(spot(500.0, 0.0), GROUND_M + 30.0)]);
    spec.vehicles[0].autopilot = Autopilot::Px4;
    mission.autopilot = Autopilot::Px4;
    mission.items[0].z = (GROUND_M + 30.0) as f32;
    let ceiling_m = |min_m: Option<f32>, first: usize| {
        let mut mission = mission.clone();
        // Without a takeoff it climbs to the first waypoint by itself.
        mission.items.drain(..first);
        mission.params.extend(min_m.map(|value| Parameter {
            name: "MIS_TAKEOFF_ALT".to_owned(),
            value,
            why: String::new(),
        }));
        find(&judge(&spec, &mission), &Limit::Ceiling).value
    };
    for first in [0, 1] {
        for (min_m, above_m) in [(None, 30.0), (Some(10.0), 30.0), (Some(90.0), 90.0)] {
            let found_m = ceiling_m(min_m, first) - GROUND_M;
            assert!(
                (found_m - above_m).abs() < 0.01,
                "{first} {min_m:?}: {found_m}"
            );
        }
    }
}

/// A vtol of an autopilot that rises at the origin, flies the items, and circles at the last.
fn wing(autopilot: Autopilot, items: &[Item]) -> (MissionSpec, VehicleMission) {
    let mut vehicle = vtol(plane("heron", 1, spot(0.0, 0.0), spot(3000.0, 0.0)));
    (vehicle.autopilot, vehicle.finish) = (autopilot, Finish::Loiter);
    vehicle.speed_mps = 18.0;
    let up = at(
        command::NAV_VTOL_TAKEOFF,
        frame::GLOBAL_RELATIVE_ALT,
        spot(0.0, 0.0),
        80.0,
        0.0,
    );
    // Kind 0: the airspeed.
    let speed = Item {
        params: [0.0, 18.0, -1.0, 0.0],
        ..missions::speed(18.0)
    };
    let mut all = vec![up, speed];
    all.extend_from_slice(items);
    let mut mission = mission(&vehicle, GROUND_M, all);
    for (name, value) in [
        ("WP_LOITER_RAD", 80.0),
        ("NAV_LOITER_RAD", 80.0),
        ("NAVL1_LIM_BANK", 40.0),
    ] {
        mission.params.push(Parameter {
            name: name.to_owned(),
            value,
            why: String::new(),
        });
    }
    (empty_spec(vec![vehicle]), mission)
}

fn last_circle() -> Item {
    let params = [0.0, 0.0, 100.0, 0.0];
    circle(command::NAV_LOITER_UNLIM, spot(3000.0, 0.0), UP_M, params)
}

/// How far a place is from the hull of a disc and a point, metres: from the nearest of the lines
/// between the point and 3600 places of the rim.
fn to_hull_m(
    (x, y): (f64, f64),
    ((middle_x, middle_y), radius_m): ((f64, f64), f64),
    (end_x, end_y): (f64, f64),
) -> f64 {
    let rim = (0..3600).map(|step| (f64::from(step) / 10.0).to_radians().sin_cos());
    let away = rim.map(|(sin, cos)| {
        let (from_x, from_y) = (middle_x + radius_m * cos, middle_y + radius_m * sin);
        let (along_x, along_y) = (end_x - from_x, end_y - from_y);
        let share = (x - from_x) * along_x + (y - from_y) * along_y;
        let share = (share / (along_x * along_x + along_y * along_y)).clamp(0.0, 1.0);
        (x - from_x - share * along_x).hypot(y - from_y - share * along_y)
    });
    away.fold(f64::INFINITY, f64::min)
}

#[test]
fn a_wing_flies_its_turns_its_time_and_to_its_altitude_and_goes_on() {
    let middle = spot(1500.0, 0.0);
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        for (number, params, flies) in [
            (command::NAV_LOITER_TURNS, [2.0, 0.0, 120.0, 0.0], true),
            (command::NAV_LOITER_TIME, [90.0, 0.0, 120.0, 0.0], true),
            (command::NAV_LOITER_TO_ALT, [0.0, 120.0, 0.0, 0.0], true),
        ] {
            let accepted = number != command::NAV_LOITER_TURNS || autopilot != Autopilot::Px4;
            let (spec, mission) = wing(
                autopilot,
                &[
                    waypoint(spot(700.0, 0.0), UP_M),
                    circle(number, middle, UP_M, params),
                    last_circle(),
                ],
            );
            let review = judge(&spec, &mission);
            assert_eq!(judged(&review).is_ok(), accepted && flies, "{number}");
            if !accepted {
                continue;
            }
            // ArduPlane has its own radius for a time: 80 m.
            let is_stock = number == command::NAV_LOITER_TIME && autopilot == Autopilot::ArduPilot;
            let radius_m = if is_stock { 80.0 } else { 120.0 };
            for (east_m, north_m) in [(0.0, radius_m), (0.0, -radius_m), (radius_m, 0.0)] {
                let on = spot(1500.0 + east_m, north_m);
                assert!(
                    nearest_m(&spec, &mission, on) < 0.2,
                    "{number} {east_m} {north_m}"
                );
            }
            // Between circle and next place, beside the straight line, it may be anywhere.
            assert!(
                nearest_m(&spec, &mission, spot(1900.0, 60.0)) < 10.0,
                "{number}"
            );
            // No further: ArduPlane leaves on course, within 1.2 radii of the middle
            // or as far out as it swings on a circle; PX4 on any
            // course, within two turn radii of the circle. Both fly to the left rim of the next
            // circle, which is flown clockwise.
            let turn_m = sortie::path::VehicleLimits::of(&spec.vehicles[0]).turn_radius_m;
            let reach_m = match autopilot {
                Autopilot::ArduPilot => (1.2 * radius_m).max(radius_m + 0.75 * turn_m),
                Autopilot::Px4 => radius_m + 2.0 * turn_m,
            };
            let (sin, cos) = (100.0_f64 / 1500.0).asin().sin_cos();
            let rim = (3000.0 - 100.0 * sin, 100.0 * cos);
            // The swings of ArduPlane onto its course are judged besides, on the other side.
            let beside_it = [(2400.0, 250.0), (2400.0, -250.0), (2000.0, 400.0)];
            let count = match autopilot {
                Autopilot::ArduPilot => 1,
                Autopilot::Px4 => beside_it.len(),
            };
            for beside in beside_it.into_iter().take(count) {
                let expected_m = to_hull_m(beside, ((1500.0, 0.0), reach_m), rim);
                let found_m = nearest_m(&spec, &mission, spot(beside.0, beside.1));
                assert!(
                    (found_m - expected_m).abs() < 8.0,
                    "{number} {autopilot:?} {beside:?}: {found_m}, expected {expected_m}"
                );
            }
        }
    }
}

#[test]
fn two_wings_meet_where_one_may_still_be_on_its_circle() {
    // Beta crosses the circle of alpha when that has left it at the earliest, or circles still.
    let items = [
        circle(
            command::NAV_LOITER_TIME,
            spot(1500.0, 0.0),
            UP_M,
            [120.0, 0.0, 80.0, 0.0],
        ),
        last_circle(),
    ];
    let (mut spec, alpha) = wing(Autopilot::ArduPilot, &items);
    let mut beta = vtol(plane(
        "beta",
        2,
        spot(1500.0, -3000.0),
        spot(1500.0, 4000.0),
    ));
    (beta.finish, beta.speed_mps) = (Finish::Loiter, 18.0);
    let up = at(
        command::NAV_VTOL_TAKEOFF,
        frame::GLOBAL_RELATIVE_ALT,
        spot(1500.0, -3000.0),
        80.0,
        0.0,
    );
    let circle = circle(
        command::NAV_LOITER_UNLIM,
        spot(1500.0, 4000.0),
        UP_M,
        [0.0, 0.0, 100.0, 0.0],
    );
    let speed = Item {
        params: [0.0, 18.0, -1.0, 0.0],
        ..missions::speed(18.0)
    };
    let beta_mission = mission(&beta, GROUND_M, vec![up, speed, circle]);
    spec.vehicles.push(beta);
    let review = review(&spec, &world(&spec), &[(0, &alpha), (1, &beta_mission)]);
    let apart = find(&review, &Limit::Separation);
    assert!(!apart.ok, "{apart:?}");
}

#[test]
fn a_wing_that_circles_to_an_altitude_is_judged_at_all_of_them() {
    // Down from 300 m over a hill of 100 m beside the middle of its circle.
    let high_m = GROUND_M + 300.0;
    let items = [
        waypoint(spot(700.0, 0.0), high_m),
        circle(
            command::NAV_LOITER_TO_ALT,
            spot(1500.0, 0.0),
            UP_M,
            [0.0, 120.0, 0.0, 0.0],
        ),
        last_circle(),
    ];
    let (mut spec, mission) = wing(Autopilot::ArduPilot, &items);
    spec.area.min_agl = sortie::geodesy::Agl(30.0);
    assert_eq!(judged(&judge(&spec, &mission)), Ok(()));
    let ceiling = find(&judge(&spec, &mission), &Limit::Ceiling);
    assert!(ceiling.value >= high_m - 0.01, "{ceiling:?}");
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(GROUND_M),
        hills: vec![Hill {
            place: spot(1500.0, 120.0),
            height_m: 60.0,
            radius_m: 60.0,
        }],
    };
    let clearance = find(&judge(&spec, &mission), &Limit::TerrainClearance);
    assert!(!clearance.ok && clearance.value < 21.0, "{clearance:?}");
}

#[test]
fn a_px4_wing_whose_mission_ends_in_the_air_circles_around_its_last_place() {
    let items = [
        waypoint(spot(1500.0, 0.0), UP_M),
        waypoint(spot(3000.0, 0.0), UP_M),
    ];
    let (spec, mission) = wing(Autopilot::Px4, &items);
    let review = judge(&spec, &mission);
    assert_eq!(judged(&review), Ok(()));
    assert!(nearest_m(&spec, &mission, spot(3000.0, 80.0)) < 0.2);
    assert!(nearest_m(&spec, &mission, spot(3080.0, 0.0)) < 0.2);
    // It turns on to it from the middle, wider than it at worst.
    assert!(nearest_m(&spec, &mission, spot(3000.0, 130.0)) < 15.0);
    let mut unknown = mission.clone();
    unknown.params.clear();
    let note = judged(&judge(&spec, &unknown)).expect_err("not judged");
    assert!(note.contains("NAV_LOITER_RAD is not known"), "{note}");
}
