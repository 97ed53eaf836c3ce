//! The verdict on encoded missions: what passes, what fails, and what the failure names.

#![expect(
    clippy::cast_possible_truncation,
    reason = "missions hold 1e-7 degrees and float32"
)]

use crate::support::missions;
use crate::support::{self, threat};
use missions::{
    GROUND_M, at, delay, land, level, mission, speed, takeoff, waypoint, with_close_posts,
};
use sortie::geodesy::{AboveHome, Agl, Amsl, LatLon, PlanPoint};
use sortie::mission::{Home, Item, VehicleMission, build, command, frame};
use sortie::path::TimedPoint;
use sortie::spec::*;
use sortie::verify::{Limit, Margin, Review, review};
use sortie::world::{Departure, Terrain, TerrainGrid, World};
use support::{copter, empty_spec, place, world};

fn judge(spec: &MissionSpec, missions: &[&VehicleMission]) -> Review {
    judge_in(spec, &world(spec), missions)
}

fn judge_in(spec: &MissionSpec, world: &World, missions: &[&VehicleMission]) -> Review {
    let pairs: Vec<(usize, &VehicleMission)> = missions.iter().copied().enumerate().collect();
    review(spec, world, &pairs)
}

fn failures(review: &Review) -> Vec<String> {
    let failed = review.margins.iter().filter(|margin| !margin.ok);
    failed
        .map(|m| {
            format!(
                "{} {}: {} / {} {}",
                m.vehicle, m.limit, m.value, m.bound, m.note
            )
        })
        .collect()
}

fn find(review: &Review, limit: Limit) -> &Margin {
    review
        .margins
        .iter()
        .find(|margin| margin.limit == limit)
        .unwrap_or_else(|| panic!("no margin {limit} among {:#?}", review.margins))
}

/// Only this margin fails.
fn only_failure(review: &Review, limit: Limit) -> &Margin {
    let margin = find(review, limit);
    assert!(!margin.ok, "the limit is kept: {margin:?}");
    let others: Vec<_> = review
        .margins
        .iter()
        .filter(|m| !m.ok && m.limit != margin.limit)
        .collect();
    assert!(others.is_empty(), "also failed: {others:?}");
    margin
}

/// West to east through the middle of the area, 10 km.
fn west() -> LatLon {
    place(36.30, -84.30)
}
fn middle() -> LatLon {
    place(36.30, -84.25)
}
fn east() -> LatLon {
    place(36.30, -84.20)
}

fn one() -> (MissionSpec, VehicleMission) {
    let vehicle = copter("alpha", 1, west(), east());
    let mission = level(&vehicle, GROUND_M + 80.0, &[west(), middle(), east()]);
    (empty_spec(vec![vehicle]), mission)
}

fn metres_apart(a: LatLon, b: LatLon) -> f64 {
    (a.to_ecef(0.0) - b.to_ecef(0.0)).norm()
}

#[test]
fn a_clean_straight_mission_passes_and_says_by_how_much() {
    let (spec, mission) = one();
    let review = judge(&spec, &[&mission]);
    assert!(review.passes(), "{:#?}", failures(&review));
    let clearance = find(&review, Limit::TerrainClearance);
    assert!((clearance.value - 80.0).abs() < 0.011, "{clearance:?}");
    assert!((find(&review, Limit::Ceiling).value - 480.0).abs() < 0.011);
    let track = &review.tracks[0];
    let (first, last) = (track.moments[0], track.moments[track.moments.len() - 1]);
    assert!(metres_apart(first.place, west()) < 0.1 && metres_apart(last.place, east()) < 0.1);
    assert!((first.amsl.0 - 400.0).abs() < 0.01 && (last.amsl.0 - 400.0).abs() < 0.01);
    // 80 m up at 5 m/s, 8985 m at 15 m/s with one ramp of 6 s, 70 m down at 3 m/s, 10 m at 0.5 m/s.
    let length_m = metres_apart(west(), east());
    let flown_s = 80.0 / 5.0 + length_m / 15.0 + 15.0 / 2.5 + 70.0 / 3.0 + 10.0 / 0.5;
    assert!((last.t_s - flown_s).abs() < 0.1, "{} {flown_s}", last.t_s);
}

/// 600 legs of 300 m and 20 m in turns: six hours, of which no leg may be lost.
#[test]
fn the_track_of_a_long_survey_passes_every_waypoint() {
    let lane = |n: u32| {
        let north = 36.25 + f64::from(n / 2) * 0.000_18;
        let is_east = n.div_ceil(2) % 2 == 1;
        place(north, if is_east { -84.246_66 } else { -84.25 })
    };
    let lanes: Vec<LatLon> = (0..600).map(lane).collect();
    let vehicle = copter("alpha", 1, lanes[0], lanes[599]);
    let mission = level(&vehicle, GROUND_M + 80.0, &lanes);
    let review = judge(&empty_spec(vec![vehicle]), &[&mission]);
    let moments = &review.tracks[0].moments;
    for (n, lane) in lanes.iter().enumerate() {
        let distances = moments.iter().map(|at| metres_apart(at.place, *lane));
        let nearest_m = distances.fold(f64::INFINITY, f64::min);
        assert!(nearest_m < 15.0, "waypoint {n}: {nearest_m} m");
    }
    let length = |places: &mut dyn Iterator<Item = LatLon>| {
        let places: Vec<LatLon> = places.collect();
        let legs = places.windows(2).map(|pair| metres_apart(pair[0], pair[1]));
        legs.sum::<f64>()
    };
    let planned_m = length(&mut lanes.iter().copied());
    let flown_m = length(&mut moments.iter().map(|at| at.place));
    assert!(
        (flown_m / planned_m - 1.0).abs() < 0.03,
        "{flown_m} {planned_m}"
    );
}

/// Flying 80 m above home over ground that is 60 m at least below: 20 m of error may be made.
#[test]
fn a_mission_above_home_says_which_home_it_assumes_and_what_an_error_costs() {
    let (mut spec, mission) = one();
    assert!(
        find(&judge(&spec, &[&mission]), Limit::TerrainClearance)
            .note
            .is_empty()
    );
    spec.mission.altitude = AltitudeReference::Relative;
    let mut above_home = mission;
    for item in &mut above_home.items {
        if frame::canonical(item.frame) == frame::GLOBAL {
            item.frame = frame::GLOBAL_RELATIVE_ALT;
            item.z -= GROUND_M as f32;
        }
    }
    let review = judge(&spec, &[&above_home]);
    let clearance = find(&review, Limit::TerrainClearance);
    let spare_m = clearance.value - clearance.bound;
    assert_eq!(
        clearance.note,
        format!(
            "altitudes are above home, assumed at 400.0 m: 80.0 m minus as much as it lies lower than that, {spare_m:.1} m to spare"
        )
    );
    let assumed = |words: &str| review.assumptions.iter().any(|line| line.contains(words));
    assert!(assumed(
        "altitudes above home count from the ground under the home row"
    ));
}

#[test]
fn a_leg_through_a_threat_fails_and_names_item_place_and_time() {
    let (mut spec, mission) = one();
    let axis = place(36.31, -84.22);
    spec.threats.push(Threat {
        id: "radar-1".to_owned(),
        kind: "radar".to_owned(),
        place: axis,
        radius_m: 1500.0,
    });
    let review = judge(&spec, &[&mission]);
    let margin = only_failure(&review, Limit::Threat("radar-1".to_owned()));
    // One hundredth of a degree of latitude at 36.3 N (WGS84): 1109.6 m.
    assert!((margin.value - (1109.6 - 1500.0)).abs() < 0.5, "{margin:?}");
    let worst = margin.at.expect("a place");
    assert_eq!(worst.item, 4, "takeoff 1, speed 2, middle 3, east 4");
    assert!((worst.place.lon_deg + 84.22).abs() < 1e-4);
    let along_m = metres_apart(west(), worst.place);
    assert!((worst.t_s - (16.0 + along_m / 15.0 + 3.0)).abs() < 0.1);
    // The same threat a little smaller is passed.
    spec.threats[0].radius_m = 1109.0;
    assert!(judge(&spec, &[&mission]).passes());
}

#[test]
fn a_leg_between_two_fine_waypoints_that_cuts_a_hill_fails_at_the_hill() {
    let (mut spec, mission) = one();
    let summit = place(36.30, -84.225);
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(GROUND_M),
        hills: vec![Hill {
            place: summit,
            height_m: 60.0,
            radius_m: 300.0,
        }],
    };
    let review = judge(&spec, &[&mission]);
    let margin = only_failure(&review, Limit::TerrainClearance);
    assert!((margin.value - 20.0).abs() < 0.02, "{margin:?}");
    let worst = margin.at.expect("a place");
    assert_eq!(worst.item, 4);
    assert!(metres_apart(worst.place, summit) < 5.0);
}

#[test]
fn steep_hills_beside_a_leg_leave_its_clearance_and_one_on_it_fails_it() {
    let (mut spec, mission) = one();
    let hill = |lat, lon| Hill {
        place: place(lat, lon),
        height_m: 100.0,
        radius_m: 1.0,
    };
    // Thirty metres beside the legs and further, a thousand of them.
    let mut hills: Vec<Hill> = (0..1000)
        .map(|index| f64::from(index) * 1e-4)
        .map(|along| hill(36.3003 + along / 10.0, -84.30 + along))
        .collect();
    let terrain = |hills: &[Hill]| TerrainSource::Analytic {
        base: Amsl(GROUND_M),
        hills: hills.to_vec(),
    };
    spec.terrain = terrain(&hills);
    let review = judge(&spec, &[&mission]);
    assert!(review.passes(), "{:#?}", failures(&review));
    let margin = find(&review, Limit::TerrainClearance);
    assert!((margin.value - 80.0).abs() < 0.01, "{margin:?}");
    // The leg is straight in the plane: it bows from the parallel by a foot.
    hills.push(hill(36.300_002_61, -84.225));
    spec.terrain = terrain(&hills);
    let review = judge(&spec, &[&mission]);
    let margin = only_failure(&review, Limit::TerrainClearance);
    // The flight may be a millimetre beside the line, where it is 86 to 1 steep.
    assert!((-20.1..=-20.0).contains(&margin.value), "{margin:?}");
    let worst = margin.at.expect("a place");
    assert!(metres_apart(worst.place, place(36.30, -84.225)) < 2.0);
}

#[test]
fn a_waypoint_moved_onto_another_path_fails_the_pair_and_names_both() {
    let south = |lon| place(36.28, lon);
    let alpha = copter("alpha", 1, west(), east());
    let beta = copter("beta", 2, south(-84.30), south(-84.20));
    let mut spec = empty_spec(vec![alpha.clone(), beta.clone()]);
    // The way round by the middle takes beta 35 s longer.
    spec.separation.time_slack_s = 40.0;
    let height_m = GROUND_M + 80.0;
    let first = level(&alpha, height_m, &[west(), middle(), east()]);
    let apart = level(
        &beta,
        height_m,
        &[south(-84.30), south(-84.25), south(-84.20)],
    );
    let passed = judge(&spec, &[&first, &apart]);
    assert!(passed.passes(), "{:#?}", failures(&passed));
    let kept = find(&passed, Limit::Separation);
    assert!((kept.value - 2219.0).abs() < 2.0, "{kept:?}");
    let moved = level(&beta, height_m, &[south(-84.30), middle(), south(-84.20)]);
    let review = judge(&spec, &[&first, &moved]);
    let margin = only_failure(&review, Limit::Separation);
    assert_eq!(
        (margin.vehicle.as_str(), margin.other.as_deref()),
        ("alpha", Some("beta"))
    );
    let worst = margin.at.expect("a place");
    assert!(
        margin.value < 100.0 && [3, 4].contains(&worst.item),
        "{margin:?}"
    );
    assert!(metres_apart(worst.place, middle()) < 600.0);
    assert!(margin.note.contains("beta at item"), "{}", margin.note);
}

#[test]
fn a_departure_delay_separates_crossing_vehicles_until_the_slack_eats_it() {
    let (north, south) = (place(36.345, -84.25), place(36.255, -84.25));
    let alpha = copter("alpha", 1, west(), east());
    let mut beta = copter("beta", 2, north, south);
    beta.depart_s = 40.0;
    let mut spec = empty_spec(vec![alpha.clone(), beta.clone()]);
    let height_m = GROUND_M + 80.0;
    let first = level(&alpha, height_m, &[west(), east()]);
    let mut late = level(&beta, height_m, &[north, south]);
    late.items.insert(0, delay(40.0));
    let passed = judge(&spec, &[&first, &late]);
    assert!(passed.passes(), "{:#?}", failures(&passed));
    // Crossing at right angles with 15 m/s each, t apart: the least distance is 15 t / sqrt 2.
    let from_middle_m = metres_apart(north, middle()) - metres_apart(west(), middle());
    let apart_s = 40.0 + from_middle_m / 15.0;
    let expected_m = 15.0 * (apart_s - 5.0) / 2_f64.sqrt();
    let value_m = find(&passed, Limit::Separation).value;
    assert!((value_m - expected_m).abs() < 1.0, "{value_m} {expected_m}");
    spec.separation.time_slack_s = apart_s - 2.0;
    let review = judge(&spec, &[&first, &late]);
    let margin = only_failure(&review, Limit::Separation);
    assert!(
        (margin.value - 15.0 * 2.0 / 2_f64.sqrt()).abs() < 1.0,
        "{margin:?}"
    );
}

#[test]
fn a_px4_copter_may_be_later_after_every_leg() {
    let (north, south) = (place(36.345, -84.25), place(36.255, -84.25));
    let quarter = place(36.30, -84.28);
    // Alpha is first at the crossing, on its second leg; beta is not nearer for being later still.
    let apart_m = |autopilot: Autopilot| {
        let mut alpha = copter("alpha", 1, west(), east());
        let mut beta = copter("beta", 2, north, south);
        (alpha.autopilot, beta.autopilot) = (autopilot, autopilot);
        beta.depart_s = 40.0;
        let mut first = level(&alpha, GROUND_M + 80.0, &[west(), quarter, east()]);
        let mut late = level(&beta, GROUND_M + 80.0, &[north, south]);
        late.items.insert(0, delay(40.0));
        for mission in [&mut first, &mut late] {
            mission.params.push(missions::quick_takeoff());
        }
        find(
            &judge(&empty_spec(vec![alpha, beta]), &[&first, &late]),
            Limit::Separation,
        )
        .value
    };
    let nearer_m = apart_m(Autopilot::ArduPilot) - apart_m(Autopilot::Px4);
    // Its climb, and two legs.
    let expected_m = 15.0 * (12.0 + 2.0 * 1.5) / 2_f64.sqrt();
    assert!(
        (nearer_m - expected_m).abs() < 1.0,
        "{nearer_m} {expected_m}"
    );
}

#[test]
fn vertical_separation_counts_where_the_spec_has_one() {
    let (north, south) = (place(36.345, -84.25), place(36.255, -84.25));
    let alpha = copter("alpha", 1, west(), east());
    let mut beta = copter("beta", 2, north, south);
    beta.start.altitude = Placement::Agl(Agl(130.0));
    beta.goal.altitude = Placement::Agl(Agl(130.0));
    let mut spec = empty_spec(vec![alpha.clone(), beta.clone()]);
    spec.separation.time_slack_s = 100.0;
    let low = level(&alpha, GROUND_M + 80.0, &[west(), east()]);
    let high = level(&beta, GROUND_M + 130.0, &[north, south]);
    let three = judge(&spec, &[&low, &high]);
    assert!((only_failure(&three, Limit::Separation).value - 50.0).abs() < 0.05);
    spec.separation.vertical_m = Some(30.0);
    let two = judge(&spec, &[&low, &high]);
    assert!(two.passes(), "{:#?}", failures(&two));
    spec.separation.vertical_m = Some(60.0);
    let margin_m = only_failure(&judge(&spec, &[&low, &high]), Limit::Separation).value;
    assert!(margin_m < 0.1, "{margin_m}");
}

#[test]
fn landed_vehicles_do_not_count_and_loitering_ones_stay_for_ever() {
    let alpha = copter("alpha", 1, west(), middle());
    let mut beta = copter("beta", 2, east(), middle());
    beta.depart_s = 2000.0;
    let mut spec = empty_spec(vec![alpha.clone(), beta.clone()]);
    let height_m = GROUND_M + 80.0;
    let first = level(&alpha, height_m, &[west(), middle()]);
    let mut second = level(&beta, height_m, &[east(), middle()]);
    second.items.insert(0, delay(2000.0));
    let passed = judge(&spec, &[&first, &second]);
    assert!(passed.passes(), "{:#?}", failures(&passed));
    let pair = find(&passed, Limit::Separation);
    assert_eq!(pair.unit, "s");
    assert!(pair.value > 1000.0 && pair.note.contains("never in the air"));
    spec.vehicles[0].finish = Finish::Loiter;
    let mut staying = first.clone();
    let last = staying.items.len() - 1;
    staying.items[last] = at(
        command::NAV_LOITER_UNLIM,
        frame::GLOBAL,
        middle(),
        height_m,
        0.0,
    );
    let margin_m = only_failure(&judge(&spec, &[&staying, &second]), Limit::Separation).value;
    assert!(margin_m < 0.1);
}

fn void_grid() -> Terrain {
    let (rows, columns) = (21, 31);
    let mut heights_m = vec![GROUND_M as f32; rows * columns];
    // The column at 84.23 W on the way has no data.
    heights_m[10 * columns + 17] = f32::NAN;
    Terrain::Grid(TerrainGrid {
        raised_m: 0.0,
        north_west: place(36.40, -84.40),
        row_step_deg: 0.01,
        column_step_deg: 0.01,
        rows,
        columns,
        heights_m,
    })
}

#[test]
fn missing_elevation_on_the_way_fails_with_the_place_and_no_number() {
    let (mut spec, _) = one();
    let vehicle = spec.vehicles[0].clone();
    spec.terrain = TerrainSource::File("void.hgt".into());
    let world = World::new(&spec, void_grid()).expect("ground under the stations");
    let mission = level(&vehicle, GROUND_M + 80.0, &[west(), middle(), east()]);
    let review = judge_in(&spec, &world, &[&mission]);
    let margin = only_failure(&review, Limit::TerrainClearance);
    assert!(margin.value.is_nan());
    let worst = margin.at.expect("a place");
    assert_eq!(worst.item, 4);
    assert!(
        (-84.24..=-84.22).contains(&worst.place.lon_deg),
        "{worst:?}"
    );
    assert!(
        margin.note.contains("no elevation data at 36.3"),
        "{}",
        margin.note
    );
}

#[test]
fn one_path_in_four_references_has_one_clearance() {
    let hill = Hill {
        place: place(36.303, -84.235),
        height_m: 70.0,
        radius_m: 900.0,
    };
    let (mut spec, _) = one();
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(GROUND_M),
        hills: vec![hill],
    };
    let world = world(&spec);
    let vehicle = spec.vehicles[0].clone();
    let home_m = world.sites[0].home.amsl.0;
    // Fine steps, so that linear in altitude and linear above ground are nearly the same path.
    let places: Vec<LatLon> = (0..=90)
        .map(|i| place(36.30, -84.30 + 0.1 * f64::from(i) / 90.0))
        .collect();
    let fly = |frame: u8, reference: &dyn Fn(LatLon, f64) -> f64| {
        let mut items = vec![takeoff(west(), home_m + 80.0), speed(15.0)];
        for &place in &places[1..] {
            let ground_m = world.terrain.height(place).unwrap().0;
            items.push(at(
                command::NAV_WAYPOINT,
                frame,
                place,
                reference(place, ground_m + 80.0),
                0.0,
            ));
        }
        items.push(land(east()));
        with_close_posts(mission(&vehicle, home_m, items))
    };
    let above_ground = |place: LatLon, amsl_m: f64| amsl_m - world.terrain.height(place).unwrap().0;
    let above_home = |_: LatLon, amsl_m: f64| Amsl(amsl_m).above_home(Amsl(home_m)).0;
    let values: Vec<f64> = [
        (
            frame::GLOBAL,
            &(|_, amsl_m| amsl_m) as &dyn Fn(LatLon, f64) -> f64,
        ),
        (5, &|_, amsl_m| amsl_m),
        (frame::GLOBAL_RELATIVE_ALT, &above_home),
        (6, &above_home),
        (frame::GLOBAL_TERRAIN_ALT, &above_ground),
        (11, &above_ground),
    ]
    .into_iter()
    .map(|(frame, reference)| {
        let review = judge_in(&spec, &world, &[&fly(frame, reference)]);
        assert!(review.passes(), "frame {frame}: {:#?}", failures(&review));
        assert_eq!(
            review
                .assumptions
                .iter()
                .any(|text| text.contains("follow the terrain")),
            [10, 11].contains(&frame)
        );
        find(&review, Limit::TerrainClearance).value
    })
    .collect();
    for value in &values {
        assert!((value - values[0]).abs() < 0.3, "{values:?}");
    }
    assert!((values[0] - values[2]).abs() < 0.011 && (values[4] - 80.0).abs() < 0.011);
    assert!((AboveHome(80.0).over(Amsl(home_m)).0 - home_m - 80.0).abs() < 1e-9);
}

#[test]
fn altitudes_above_home_are_above_the_ground_there_whatever_the_home_row_says() {
    let (spec, mut mission) = one();
    for item in &mut mission.items {
        if item.z > 0.0 {
            item.frame = frame::GLOBAL_RELATIVE_ALT;
            item.z = 80.0;
        }
    }
    assert!(judge(&spec, &[&mission]).passes());
    mission.home.amsl_m -= 30.0;
    let review = judge(&spec, &[&mission]);
    assert!((find(&review, Limit::TerrainClearance).value - 80.0).abs() < 0.01);
    let home = find(&review, Limit::HomeAltitude);
    assert!(!home.ok && (home.value - 30.0).abs() < 0.01, "{home:?}");
    // A wide tolerance is none for the altitude of home.
    let mut wide = spec.clone();
    wide.mission.tolerance_m = 50.0;
    mission.home.amsl_m = GROUND_M as f32 + 6.0;
    let review = judge(&wide, &[&mission]);
    let home = only_failure(&review, Limit::HomeAltitude);
    assert!((home.bound - 5.0).abs() < 1e-9, "{home:?}");
    mission.home = Home {
        x: 0,
        y: 0,
        amsl_m: 0.0,
    };
    assert!(!find(&judge(&spec, &[&mission]), Limit::HomePosition).ok);
}

#[test]
fn returning_to_launch_fails_without_a_return_altitude_and_its_leg_is_judged_with_one() {
    let (mut spec, mut mission) = one();
    let last = mission.items.len() - 1;
    mission.items[last] = Item::without_place(command::NAV_RETURN_TO_LAUNCH, [0.0; 4]);
    spec.vehicles[0].finish = Finish::Return;
    let review = judge(&spec, &[&mission]);
    let margin = find(&review, Limit::ItemsJudged);
    assert!(
        !margin.ok && margin.note.contains("return_amsl_m"),
        "{margin:?}"
    );
    assert_eq!(margin.at.expect("a place").item, last + 1);
    spec.vehicles[0].return_amsl = Some(Amsl(600.0));
    let review = judge(&spec, &[&mission]);
    assert!(review.passes(), "{:#?}", failures(&review));
    assert!((find(&review, Limit::Ceiling).value - 600.0).abs() < 0.01);
    let end = review.tracks[0].moments.last().copied().expect("a track");
    assert!(metres_apart(end.place, west()) < 0.1);
    // From a home in the north the way back alone crosses a hill.
    spec.vehicles[0].home = place(36.33, -84.30);
    let vehicle = &spec.vehicles[0];
    let mut mission = level(vehicle, 480.0, &[vehicle.home, west(), east()]);
    mission.items[last] = Item::without_place(command::NAV_RETURN_TO_LAUNCH, [0.0; 4]);
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(GROUND_M),
        hills: vec![Hill {
            place: place(36.315, -84.25),
            height_m: 250.0,
            radius_m: 150.0,
        }],
    };
    let review = judge(&spec, &[&mission]);
    let clearance = only_failure(&review, Limit::TerrainClearance);
    assert_eq!(clearance.at.expect("a place").item, last + 1);
    let told = |review: &Review, text: &str| {
        let mut assumptions = review.assumptions.iter();
        assumptions.any(|assumption| assumption.contains(text))
    };
    assert!(told(&review, "RTL_ALT"));
    assert!(!told(&judge(&one().0, &[&one().1]), "RTL_ALT"));
}

#[test]
fn legs_to_the_start_and_to_the_landing_keep_the_minimum_height_too() {
    let hill = |lon| TerrainSource::Analytic {
        base: Amsl(GROUND_M),
        hills: vec![Hill {
            place: place(36.30, lon),
            height_m: 78.0,
            radius_m: 200.0,
        }],
    };
    let (before, beyond) = (place(36.30, -84.33), place(36.30, -84.17));
    let (mut spec, _) = one();
    spec.vehicles[0].home = before;
    let height_m = GROUND_M + 80.0;
    let joined = level(&spec.vehicles[0], height_m, &[before, west(), east()]);
    assert!(judge(&spec, &[&joined]).passes());
    spec.terrain = hill(-84.315);
    let review = judge(&spec, &[&joined]);
    let margin = only_failure(&review, Limit::TerrainClearance);
    assert!((margin.value - 2.0).abs() < 0.02, "{margin:?}");
    assert_eq!(margin.at.expect("a place").item, 3);
    // A landing beyond the goal: the leg there is flown at the height of the goal.
    let (mut spec, mut mission) = one();
    spec.terrain = hill(-84.185);
    let last = mission.items.len() - 1;
    mission.items[last] = land(beyond);
    let review = judge(&spec, &[&mission]);
    let margin = find(&review, Limit::TerrainClearance);
    assert!(!margin.ok && (margin.value - 2.0).abs() < 0.02);
    assert_eq!(margin.at.expect("a place").item, last + 1);
    assert!(find(&review, Limit::GroundContact).ok);
}

#[test]
fn a_vehicle_that_only_goes_up_and_down_has_no_clearance_to_pass_with() {
    let (spec, mut mission) = one();
    mission.items = vec![takeoff(west(), 480.0), speed(15.0), land(west())];
    let review = judge(&spec, &[&mission]);
    let margin = find(&review, Limit::TerrainClearance);
    assert!(!margin.ok && margin.note.contains("flies nowhere"));
}

#[test]
fn what_is_left_of_a_leg_that_was_begun_is_not_judged_by_its_slope() {
    let (spec, mut mission) = one();
    let at = |lon| place(36.30, lon);
    let over = |lon, agl_m| {
        let world = world(&spec);
        PlanPoint {
            at: world.frame.to_plan(at(lon)),
            amsl: Amsl(GROUND_M + agl_m),
        }
    };
    let mut failing = Vec::new();
    // 9 m before a waypoint that lies 6 m below it, and a leg behind that as steep.
    for next_lon in [-84.2, -84.24995] {
        let here = over(-84.2501, 66.0);
        mission.items = vec![
            speed(15.0),
            waypoint(at(-84.25), GROUND_M + 60.0),
            waypoint(at(next_lon), GROUND_M + 57.0),
            waypoint(east(), GROUND_M + 57.0),
            land(east()),
        ];
        let mut world = world(&spec);
        world.sites[0].departure = Departure::Airborne {
            point: here,
            course_rad: std::f64::consts::FRAC_PI_2,
            speed_mps: 5.0,
            at_s: 600.0,
        };
        let review = judge_in(&spec, &world, &[&mission]);
        failing.push(!find(&review, Limit::DescentAngle).ok);
    }
    assert_eq!(failing, [false, true]);
}

#[test]
fn a_vehicle_that_begins_in_its_landing_descent_is_judged_by_its_column() {
    let (mut spec, mut mission) = one();
    spec.vehicles.push(copter("bravo", 2, west(), east()));
    spec.separation.distance_m = 50.0;
    mission.items = vec![speed(15.0), land(east())];
    let mut world = world(&spec);
    let over = PlanPoint {
        at: world.frame.to_plan(east()),
        amsl: Amsl(GROUND_M + 40.0),
    };
    world.sites[0].departure = Departure::Airborne {
        point: over,
        course_rad: 0.0,
        speed_mps: 0.0,
        at_s: 600.0,
    };
    // Above it before it has landed, 10 km on the way.
    let other = level(&spec.vehicles[1], GROUND_M + 60.0, &[west(), east()]);
    let review = judge_in(&spec, &world, &[&mission, &other]);
    let own = |limit: Limit| {
        let mut margins = review.margins.iter();
        margins.find(|margin| margin.vehicle == "alpha" && margin.limit == limit)
    };
    assert!(
        own(Limit::TerrainClearance).is_none(),
        "{:#?}",
        failures(&review)
    );
    assert!(own(Limit::GroundContact).is_some_and(|margin| margin.ok));
    assert!(!find(&review, Limit::Separation).ok);
    // Where it only comes down to a waypoint it has no landing to come down for.
    mission.items = vec![waypoint(east(), GROUND_M + 40.0), land(east())];
    let review = judge_in(&spec, &world, &[&mission]);
    assert!(!find(&review, Limit::TerrainClearance).ok);
}

#[test]
fn a_wide_acceptance_radius_and_a_precision_landing_fail_on_px4_alone() {
    let (mut spec, mut mission) = one();
    mission.items[2].params[1] = 300.0;
    let last = mission.items.len() - 1;
    mission.items[last].params[1] = 2.0;
    assert!(judge(&spec, &[&mission]).passes());
    spec.vehicles[0].autopilot = Autopilot::Px4;
    mission.autopilot = Autopilot::Px4;
    let review = judge(&spec, &[&mission]);
    assert!(find(&review, Limit::Acceptance).note.contains("precision"));
    assert!(!find(&review, Limit::Acceptance).ok);
    mission.items[last].params[1] = 0.0;
    let review = judge(&spec, &[&mission]);
    let margin = only_failure(&review, Limit::AcceptanceRadius);
    assert!((margin.value - 300.0).abs() < 1e-9 && (margin.bound - 5.0).abs() < 1e-9);
    let worst = margin.at.expect("a place");
    assert!(worst.item == 3 && metres_apart(worst.place, middle()) < 1.0);
    assert!(
        review
            .assumptions
            .iter()
            .any(|text| text.contains("DO_CHANGE_SPEED"))
    );
    for kept in [0.0, 5.0, f32::NAN] {
        mission.items[2].params[1] = kept;
        let review = judge(&spec, &[&mission]);
        assert!(review.passes(), "{kept}: {:#?}", failures(&review));
    }
}

#[test]
fn a_fence_that_lost_a_part_fails_where_the_file_could_hold_it() {
    let (mut spec, _) = one();
    spec.threats.push(Threat {
        id: "radar-1".to_owned(),
        kind: "radar".to_owned(),
        place: place(36.35, -84.22),
        radius_m: 1500.0,
    });
    let corners = [(36.22, -84.34), (36.22, -84.33), (36.23, -84.33)];
    spec.no_fly.push(Zone {
        id: "town".to_owned(),
        polygon: corners.map(|(lat, lon)| place(lat, lon)).to_vec(),
        ..Zone::default()
    });
    let world = world(&spec);
    let routes = [timed(&world, west(), east(), GROUND_M + 80.0)];
    let whole = build(&spec, &world, 0, &routes).expect("a mission");
    assert!(find(&judge(&spec, &[&whole]), Limit::FenceComplete).ok);
    let missing = |fence: Vec<Item>| {
        let mission = VehicleMission {
            fence,
            ..whole.clone()
        };
        let review = judge(&spec, &[&mission]);
        only_failure(&review, Limit::FenceComplete).note.clone()
    };
    assert!(missing(Vec::new()).ends_with("area, zone town, threat radar-1"));
    assert!(missing(whole.fence[..7].to_vec()).ends_with(": threat radar-1"));
    assert!(missing(whole.fence[4..].to_vec()).ends_with(": area"));
    let mut moved = whole.fence.clone();
    moved[5].x += 1000;
    assert!(missing(moved).ends_with(": zone town"));
    let mut smaller = whole.fence.clone();
    smaller[7].params[0] -= 1.0;
    assert!(missing(smaller).ends_with(": threat radar-1"));
    let told_nothing = VehicleMission {
        fence: Vec::new(),
        is_fence_known: false,
        ..whole.clone()
    };
    assert!(judge(&spec, &[&told_nothing]).passes());
    let mut turned = whole.clone();
    turned.fence[..4].rotate_left(1);
    turned.fence[4..7].reverse();
    assert!(judge(&spec, &[&turned]).passes());
}

#[test]
fn a_fence_that_keeps_nobody_in_fails_though_all_of_it_is_there() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let (mut spec, _) = one();
        spec.vehicles[0].autopilot = autopilot;
        let world = world(&spec);
        let routes = [timed(&world, west(), east(), GROUND_M + 80.0)];
        let whole = build(&spec, &world, 0, &routes).expect("a mission");
        assert!(find(&judge(&spec, &[&whole]), Limit::FenceComplete).ok);
        // PX4 keeps inside of any one inclusion, ArduPilot inside of all.
        let mut other = whole.clone();
        let mut wider = whole.fence[..4].to_vec();
        for corner in &mut wider {
            corner.x += if corner.x > 363_000_000 {
                500_000
            } else {
                -500_000
            };
        }
        other.fence.extend(wider);
        let review = judge(&spec, &[&other]);
        let margin = find(&review, Limit::FenceComplete);
        assert_eq!(
            margin.ok,
            autopilot == Autopilot::ArduPilot,
            "{}",
            margin.note
        );
        let switches: &[(&str, f32)] = match autopilot {
            Autopilot::ArduPilot => &[("FENCE_ENABLE", 0.0), ("FENCE_TYPE", 0.0)],
            Autopilot::Px4 => &[("GF_ACTION", 0.0)],
        };
        for (name, value) in switches {
            let mut off = whole.clone();
            let param = off.params.iter_mut().find(|param| param.name == *name);
            param.expect("planned").value = *value;
            let note = only_failure(&judge(&spec, &[&off]), Limit::FenceComplete)
                .note
                .clone();
            assert!(note.contains(name), "{note}");
        }
    }
}

/// What a case does to a clean mission.
type Change<'a> = &'a dyn Fn(&mut VehicleMission);

#[test]
fn what_cannot_be_judged_fails_and_names_the_item_and_the_reason() {
    let (spec, clean) = one();
    let with = |change: &dyn Fn(&mut VehicleMission)| {
        let mut mission = clean.clone();
        change(&mut mission);
        let review = judge(&spec, &[&mission]);
        assert!(!review.passes());
        let margin = find(&review, Limit::ItemsJudged).clone();
        assert!(!margin.ok, "{margin:?}");
        margin.note
    };
    let cases: [(&str, usize, Change<'_>); 9] = [
        ("NAV_GUIDED_ENABLE", 4, &|m| {
            m.items[3].command = 92;
            m.items[3].params[0] = 1.0;
        }),
        // The emergency stop of the motors.
        ("DO_AUX_FUNCTION 31", 4, &|m| {
            let stop = [31.0, 2.0, 0.0, 0.0];
            m.items.insert(3, Item::without_place(218, stop));
        }),
        ("altitude is NaN", 3, &|m| m.items[2].z = f32::NAN),
        ("altitude is inf", 4, &|m| m.items[3].z = f32::INFINITY),
        ("frame 2", 3, &|m| m.items[2].frame = frame::MISSION),
        ("no takeoff before it", 2, &|m| {
            m.items.remove(0);
        }),
        ("km from the origin", 3, &|m| {
            (m.items[2].x, m.items[2].y) = (-363_000_000, 957_500_000)
        }),
        ("time of day", 1, &|m| m.items.insert(0, delay(0.0))),
        ("time of day", 4, &|m| {
            let until = [-1.0, -1.0, 30.0, -1.0];
            m.items
                .insert(3, Item::without_place(command::NAV_DELAY, until));
        }),
    ];
    for (reason, item, change) in cases {
        let note = with(change);
        assert!(
            note.contains(reason) && note.contains(&format!("from item {item} on")),
            "{note}"
        );
    }
}

#[test]
fn a_delay_of_no_seconds_until_any_time_of_day_is_no_wait() {
    let (spec, mut mission) = one();
    let none = Item::without_place(command::NAV_DELAY, [-1.0; 4]);
    mission.items.insert(0, none);
    let review = judge(&spec, &[&mission]);
    assert!(review.passes(), "{:#?}", failures(&review));
}

#[test]
fn px4_takes_an_altitude_of_zero_for_zero() {
    let (mut spec, mut mission) = one();
    spec.vehicles[0].autopilot = Autopilot::Px4;
    mission.autopilot = Autopilot::Px4;
    mission.items[2].z = 0.0;
    let review = judge(&spec, &[&mission]);
    assert!(find(&review, Limit::ItemsJudged).ok);
    assert!(find(&review, Limit::TerrainClearance).value < -390.0);
}

#[test]
fn a_vehicle_without_a_mission_and_a_mission_without_a_vehicle_fail() {
    let (spec, mission) = one();
    let world = world(&spec);
    let none = review(&spec, &world, &[]);
    assert!(!none.passes() && find(&none, Limit::Mission).note == "mission missing");
    assert!(!review(&spec, &world, &[(0, &mission), (7, &mission)]).passes());
    assert!(!review(&spec, &world, &[(0, &mission), (0, &mission)]).passes());
    let empty = VehicleMission {
        items: Vec::new(),
        ..mission
    };
    assert!(!review(&spec, &world, &[(0, &empty)]).passes());
}

#[test]
fn ardupilot_altitudes_are_judged_in_whole_centimetres() {
    let (mut spec, mut mission) = one();
    spec.area.min_agl = Agl(80.0);
    for item in &mut mission.items {
        if item.z > 0.0 {
            item.z = 480.009;
        }
    }
    assert!(judge(&spec, &[&mission]).passes());
    for item in &mut mission.items {
        if item.z > 0.0 {
            // Kept as 479.99: measured on the autopilot, 80.2 reads back as 80.19.
            item.z = 479.998;
        }
    }
    let review = judge(&spec, &[&mission]);
    let value = only_failure(&review, Limit::TerrainClearance).value;
    assert!((value - 79.99).abs() < 1e-6, "{value}");
}

#[test]
fn a_mission_of_another_vehicle_is_noticed() {
    let south = |lon| place(36.28, lon);
    let alpha = copter("alpha", 1, west(), east());
    let beta = copter("beta", 2, south(-84.30), south(-84.20));
    let spec = empty_spec(vec![alpha.clone()]);
    let other = level(&beta, GROUND_M + 80.0, &[south(-84.30), south(-84.20)]);
    let review = judge(&spec, &[&other]);
    for what in [
        Limit::HomePosition,
        Limit::Start,
        Limit::Goal,
        Limit::Finish,
    ] {
        let margin = find(&review, what);
        assert!(!margin.ok && margin.value > 2000.0, "{margin:?}");
    }
}

#[test]
fn climbs_descents_and_turns_are_held_against_their_limits() {
    let (mut spec, _) = one();
    let vehicle = spec.vehicles[0].clone();
    let high = |lat: f64, lon: f64, amsl_m: f64| waypoint(place(lat, lon), amsl_m);
    let fly = |inner: Vec<Item>| {
        let mut items = vec![takeoff(west(), 480.0), speed(15.0)];
        items.extend(inner);
        items.extend([waypoint(east(), 480.0), land(east())]);
        mission(&vehicle, GROUND_M, items)
    };
    // 200 m up over 899 m: 12.5 degrees, 3.3 m/s.
    let steep = fly(vec![high(36.30, -84.29, 680.0), high(36.30, -84.25, 680.0)]);
    let review = judge(&spec, &[&steep]);
    assert!(review.passes(), "{:#?}", failures(&review));
    assert!((find(&review, Limit::ClimbAngle).value - 12.55).abs() < 0.05);
    assert!((find(&review, Limit::ClimbSpeed).value - 3.33).abs() < 0.02);
    spec.vehicles[0].max_climb_rad = Some(12_f64.to_radians());
    let margin = only_failure(&judge(&spec, &[&steep]), Limit::ClimbAngle).clone();
    assert_eq!(margin.at.expect("a place").item, 3);
    spec.vehicles[0].max_climb_rad = None;
    spec.vehicles[0].climb_mps = 3.0;
    assert_eq!(
        only_failure(&judge(&spec, &[&steep]), Limit::ClimbSpeed)
            .at
            .expect("a place")
            .item,
        3
    );
    // A zigzag of 60 m legs with right angles: the turn radius is 90 m.
    let zigzag = fly(vec![
        high(36.3005, -84.2900, 480.0),
        high(36.3005, -84.2893, 480.0),
        high(36.3000, -84.2893, 480.0),
    ]);
    let margin = only_failure(&judge(&spec, &[&zigzag]), Limit::TurnFit).clone();
    assert!(margin.value < -50.0, "{margin:?}");
}

#[test]
fn zones_count_below_their_ceiling_only() {
    let (mut spec, mission) = one();
    let zone = |below: Option<Amsl>| Zone {
        id: "town".to_owned(),
        polygon: vec![
            place(36.29, -84.28),
            place(36.29, -84.27),
            place(36.31, -84.27),
            place(36.31, -84.28),
        ],
        ceiling: below.map(sortie::spec::Placement::Amsl),
        ..Zone::default()
    };
    for (below, ok) in [
        (None, false),
        (Some(Amsl(481.0)), false),
        (Some(Amsl(479.0)), true),
    ] {
        spec.no_fly = vec![zone(below)];
        let review = judge(&spec, &[&mission]);
        assert_eq!(review.passes(), ok, "{below:?}: {:#?}", failures(&review));
        if !ok {
            let margin = only_failure(&review, Limit::Zone("town".to_owned()));
            // Half of the width of a hundredth of a degree: 449 m.
            assert!((margin.value + 449.0).abs() < 2.0, "{margin:?}");
            assert_eq!(margin.at.expect("a place").item, 3);
        }
    }
}

#[test]
fn leaving_the_area_or_the_fence_fails() {
    let (mut spec, mut mission) = one();
    let corner = |lat, lon| Item {
        params: [4.0, 0.0, 0.0, 0.0],
        ..at(
            command::NAV_FENCE_POLYGON_VERTEX_INCLUSION,
            frame::GLOBAL,
            place(lat, lon),
            0.0,
            4.0,
        )
    };
    mission.fence = vec![
        corner(36.29, -84.31),
        corner(36.29, -84.19),
        corner(36.31, -84.19),
        corner(36.31, -84.31),
        at(
            command::NAV_FENCE_CIRCLE_EXCLUSION,
            frame::GLOBAL,
            place(36.308, -84.25),
            0.0,
            500.0,
        ),
    ];
    let review = judge(&spec, &[&mission]);
    assert!(review.passes(), "{:#?}", failures(&review));
    let kept = find(&review, Limit::Fence).value;
    assert!((kept - (887.7 - 500.0)).abs() < 1.0, "{kept}");
    mission.fence[4].params[0] = 900.0;
    only_failure(&judge(&spec, &[&mission]), Limit::Fence);
    mission.fence.pop();
    mission.fence.pop();
    assert!(
        !find(&judge(&spec, &[&mission]), Limit::Fence).ok,
        "three of four corners"
    );
    mission.fence.clear();
    spec.area.north_east.lat_deg = 36.2999;
    let margin = only_failure(&judge(&spec, &[&mission]), Limit::Area).clone();
    assert!((margin.value + 11.1).abs() < 0.5, "{margin:?}");
}

#[test]
fn an_ardupilot_mission_without_a_speed_item_cannot_be_timed() {
    let (spec, mut mission) = one();
    mission.items.remove(1);
    let margin = only_failure(&judge(&spec, &[&mission]), Limit::Speed).clone();
    assert!(
        margin.value.is_nan() && margin.note.contains("WPNAV_SPEED"),
        "{margin:?}"
    );
    mission.items.insert(1, speed(10.0));
    let margin = only_failure(&judge(&spec, &[&mission]), Limit::Speed).clone();
    assert!((margin.value - 5.0).abs() < 1e-6);
}

fn timed(world: &World, from: LatLon, to: LatLon, amsl_m: f64) -> Vec<TimedPoint> {
    let (a, b) = (world.frame.to_plan(from), world.frame.to_plan(to));
    (0..=100)
        .map(|index| {
            let u = f64::from(index) / 100.0;
            // A gentle bow, so that there are corners.
            let bow_m = 300.0 * (u * std::f64::consts::PI).sin();
            let east_m = a.east_m + (b.east_m - a.east_m) * u;
            let north_m = a.north_m + (b.north_m - a.north_m) * u + bow_m;
            TimedPoint {
                point: PlanPoint::new(east_m, north_m, Amsl(amsl_m)),
                t_s: 0.0,
            }
        })
        .collect()
}

#[test]
fn what_the_builder_writes_for_a_good_path_passes_in_every_reference_and_finish() {
    let near = place(36.30, -84.31);
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        for altitude in [
            AltitudeReference::Amsl,
            AltitudeReference::Relative,
            AltitudeReference::Terrain,
        ] {
            if autopilot == Autopilot::Px4 && altitude == AltitudeReference::Terrain {
                continue;
            }
            for finish in [Finish::Land, Finish::Loiter, Finish::Return] {
                for home in [west(), near] {
                    let mut vehicle = copter("alpha", 1, west(), east());
                    vehicle.autopilot = autopilot;
                    vehicle.finish = finish;
                    vehicle.home = home;
                    vehicle.depart_s = 12.5;
                    let mut spec = empty_spec(vec![vehicle]);
                    spec.terrain = TerrainSource::Flat(Amsl(412.37));
                    spec.mission.altitude = altitude;
                    let world = world(&spec);
                    let height_m = 412.37 + 80.0;
                    let mut routes = vec![timed(&world, west(), east(), height_m)];
                    if finish == Finish::Return {
                        routes.push(timed(&world, east(), home, height_m));
                    }
                    let mission = build(&spec, &world, 0, &routes).expect("a mission");
                    let review = judge_in(&spec, &world, &[&mission]);
                    assert!(
                        review.passes(),
                        "{autopilot:?} {altitude:?} {finish:?}: {:#?}",
                        failures(&review)
                    );
                    assert!((review.tracks[0].moments[0].t_s - 12.5).abs() < 1e-9);
                }
            }
        }
    }
}

#[test]
fn a_rally_point_is_clear_of_the_ground_threats_and_zones_and_inside_the_area() {
    let (mut spec, mut mission) = one();
    spec.area.min_agl = Agl(40.0);
    spec.threats.push(Threat {
        id: "mast".to_owned(),
        kind: String::new(),
        place: place(36.31, -84.25),
        radius_m: 300.0,
    });
    // A low zone: whoever lands there comes through it.
    spec.no_fly.push(Zone {
        id: "town".to_owned(),
        polygon: vec![
            place(36.28, -84.28),
            place(36.28, -84.27),
            place(36.29, -84.27),
        ],
        ceiling: Some(sortie::spec::Placement::Amsl(Amsl(420.0))),
        ..Zone::default()
    });
    let mut rally = |at_place, z| {
        mission.rally = vec![at(
            command::NAV_RALLY_POINT,
            frame::GLOBAL_RELATIVE_ALT,
            at_place,
            z,
            0.0,
        )];
        judge(&spec, &[&mission])
    };
    let good = rally(place(36.305, -84.26), 40.9);
    assert!(good.passes(), "{:#?}", failures(&good));
    // ArduPilot keeps whole metres.
    assert!((find(&good, Limit::RallyClearance(1)).value - 40.0).abs() < 1e-6);
    assert!(find(&good, Limit::RallyObstacles(1)).note.contains("mast"));
    let told = good
        .assumptions
        .iter()
        .find(|text| text.contains("RALLY_LIMIT_KM"));
    // 0.04 degrees of longitude and 0.005 of latitude from home at 36.3 N, 84.3 W (WGS84).
    assert!(told.expect("a limit").contains("3.64"), "{told:?}");
    assert!(
        (only_failure(
            &rally(place(36.305, -84.26), 39.0),
            Limit::RallyClearance(1)
        )
        .bound
            - 40.0)
            .abs()
            < 1e-9
    );
    let ceiling_m = spec.area.max_amsl.0;
    let high = rally(place(36.305, -84.26), 5000.0);
    let margin = only_failure(&high, Limit::RallyCeiling(1));
    assert!(margin.value > 5000.0 && (margin.bound - ceiling_m).abs() < 1e-9);
    let masked = rally(place(36.31, -84.252), 60.0);
    let margin = only_failure(&masked, Limit::RallyObstacles(1));
    assert!((margin.value - (179.7 - 300.0)).abs() < 0.5, "{margin:?}");
    let low = rally(place(36.282, -84.272), 100.0);
    assert!(
        only_failure(&low, Limit::RallyObstacles(1))
            .note
            .contains("town")
    );
    only_failure(&rally(place(36.10, -84.26), 60.0), Limit::RallyArea(1));
    // 99 m from a zone that has a buffer of its own.
    let aside = place(36.285, -84.2689);
    assert!(rally(aside, 60.0).passes());
    spec.no_fly[0].buffer_m = 200.0;
    let near = judge(&spec, &[&mission]);
    let margin = only_failure(&near, Limit::RallyObstacles(1));
    assert!((margin.value - 98.8).abs() < 1.0, "{margin:?}");
}

#[test]
fn a_wind_asks_a_copter_for_airspeed_and_says_how_much() {
    let (mut spec, mission) = one();
    spec.wind = Some(Wind {
        from_rad: 1.0,
        speed_mps: 6.5,
    });
    let review = judge(&spec, &[&mission]);
    assert!(review.passes(), "{:#?}", failures(&review));
    let told = |text: &str| review.assumptions.iter().any(|line| line.contains(text));
    assert!(told(
        "against it alpha must fly at 21.5 m/s through the air"
    ));
}

#[test]
fn long_legs_and_followed_terrain_say_how_far_the_autopilot_may_differ() {
    let (mut spec, _) = one();
    let vehicle = spec.vehicles[0].clone();
    let direct = level(&vehicle, GROUND_M + 80.0, &[west(), east()]);
    let review = judge(&spec, &[&direct]);
    // 8985 m: 8985^2 tan(36.3) / 8 R is 1.16 m.
    let told =
        |review: &Review, text: &str| review.assumptions.iter().any(|line| line.contains(text));
    assert!(
        told(&review, "bends the longest, 9.0 km, by up to 1.2 m"),
        "{:?}",
        review.assumptions
    );
    spec.vehicles[0].autopilot = Autopilot::Px4;
    let mut px4 = direct.clone();
    px4.autopilot = Autopilot::Px4;
    assert!(!told(&judge(&spec, &[&px4]), "bends the longest"));
    spec.vehicles[0].autopilot = Autopilot::ArduPilot;
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(GROUND_M),
        hills: vec![Hill {
            place: middle(),
            height_m: 60.0,
            radius_m: 200.0,
        }],
    };
    let mut following = direct;
    for item in &mut following.items {
        if item.command == command::NAV_WAYPOINT {
            item.frame = frame::GLOBAL_TERRAIN_ALT;
            item.z = 80.0;
        }
    }
    let review = judge(&spec, &[&following]);
    // In the middle of four posts around the summit all are 70.7 m away: 60 (1 - exp(-1/8)) is 7.05 m.
    assert!(
        told(&review, "off by up to 7.0 m") || told(&review, "off by up to 7.1 m"),
        "{:?}",
        review.assumptions
    );
}

#[test]
fn the_bend_of_the_map_of_ardupilot_counts_where_it_is_not_small() {
    // 31.4 km, which is 14.2 m; legs half as long bend by 3.6 m.
    let (from, to) = (place(36.30, -84.40), place(36.30, -84.05));
    for (stops, bend_m) in [
        (&[from, to][..], 14.2),
        (&[from, place(36.30, -84.225), to], 0.0),
    ] {
        let (mut spec, _) = one();
        spec.threats
            .push(threat("mast", place(36.3050, -84.24), 100.0));
        spec.vehicles[0] = copter("alpha", 1, from, to);
        let margin_m = |autopilot| {
            let mut spec = spec.clone();
            spec.vehicles[0].autopilot = autopilot;
            let mut mission = level(&spec.vehicles[0], GROUND_M + 80.0, stops);
            mission.autopilot = autopilot;
            let review = judge(&spec, &[&mission]);
            let mut margins = review.margins.iter();
            let of = margins.find(|margin| matches!(margin.limit, Limit::Threat(_)));
            of.expect("a margin").value
        };
        let less_m = margin_m(Autopilot::Px4) - margin_m(Autopilot::ArduPilot);
        assert!((less_m - bend_m).abs() < 0.1, "{less_m} m, not {bend_m}");
    }
}

#[test]
fn zones_count_between_floor_and_ceiling_at_their_times_and_outside_of_their_holes() {
    let (mut spec, mission) = one();
    // The mission flies at 480 m, 80 m above ground.
    let square = |south: f64, west: f64, side: f64| {
        vec![
            place(south, west),
            place(south, west + side),
            place(south + side, west + side),
            place(south + side, west),
        ]
    };
    let amsl = |amsl_m| Some(Placement::Amsl(Amsl(amsl_m)));
    let agl = |agl_m| Some(Placement::Agl(Agl(agl_m)));
    let town = || Zone::closed("town".to_owned(), square(36.29, -84.28, 0.02));
    let whole = square(36.20, -84.41, 0.25);
    let hole = square(36.201, -84.409, 0.248);
    let cases = [
        (
            Zone {
                floor: amsl(481.0),
                ..town()
            },
            true,
        ),
        (
            Zone {
                floor: amsl(479.0),
                ..town()
            },
            false,
        ),
        (
            Zone {
                floor: agl(81.0),
                ..town()
            },
            true,
        ),
        (
            Zone {
                floor: agl(79.0),
                ceiling: agl(81.0),
                ..town()
            },
            false,
        ),
        (
            Zone {
                ceiling: agl(79.0),
                ..town()
            },
            true,
        ),
        (
            Zone {
                active_s: Some((f64::NEG_INFINITY, 0.0)),
                ..town()
            },
            true,
        ),
        (
            Zone {
                active_s: Some((1e5, f64::INFINITY)),
                ..town()
            },
            true,
        ),
        (
            Zone {
                active_s: Some((0.0, 1e5)),
                ..town()
            },
            false,
        ),
        (
            Zone {
                holes: vec![hole],
                ..Zone::closed("town".to_owned(), whole)
            },
            true,
        ),
        (
            Zone {
                circle: Some((place(36.30, -84.27), 500.0)),
                ..town()
            },
            false,
        ),
    ];
    for (zone, ok) in cases {
        spec.no_fly = vec![zone.clone()];
        let review = judge(&spec, &[&mission]);
        assert_eq!(review.passes(), ok, "{zone:?}: {:#?}", failures(&review));
    }
    // It is in the zone from about 139 s to 259 s, departures may be shifted by 5 s, and copters are up to
    // 12 s late from their takeoff on.
    for ((from_s, to_s), ok) in [
        ((0.0, 120.0), true),
        ((0.0, 138.0), false),
        ((250.0, 1e5), false),
        ((274.0, 1e5), false),
        ((300.0, 1e5), true),
    ] {
        let active_s = Some((from_s, to_s));
        spec.no_fly = vec![Zone { active_s, ..town() }];
        let review = judge(&spec, &[&mission]);
        assert_eq!(
            review.passes(),
            ok,
            "{active_s:?}: {:#?}",
            failures(&review)
        );
    }
}
