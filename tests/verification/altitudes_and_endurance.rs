//! Greatest height above ground, least altitude and endurance of encoded missions.

use crate::support;
use crate::support::missions;
use missions::{GROUND_M, level};
use proptest::prelude::*;
use sortie::geodesy::{Agl, Amsl};
use sortie::mission::VehicleMission;
use sortie::spec::*;
use sortie::verify::{Limit, Margin, Review, review};
use sortie::world::{PlanZone, Terrain, TerrainGrid};
use support::{copter, empty_spec, place, world};

/// 9 km to the east at 80 m above the plain, over a hill or hollow.
fn over_hill(
    height_m: f64,
    radius_m: f64,
    altitudes: AltitudeLimits,
) -> (MissionSpec, VehicleMission) {
    let ends = [place(36.30, -84.30), place(36.30, -84.20)];
    let mut vehicle = copter("alpha", 1, ends[0], ends[1]);
    vehicle.altitudes = altitudes;
    let mission = level(&vehicle, GROUND_M + 80.0, &ends);
    let mut spec = empty_spec(vec![vehicle]);
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(GROUND_M),
        hills: vec![Hill {
            place: place(36.301, -84.25),
            height_m,
            radius_m,
        }],
    };
    (spec, mission)
}

fn judged(spec: &MissionSpec, mission: &VehicleMission) -> Review {
    review(spec, &world(spec), &[(0, mission)])
}

fn of(review: &Review, limit: &Limit) -> Option<Margin> {
    let mut margins = review.margins.iter();
    margins.find(|margin| margin.limit == *limit).cloned()
}

fn at_most(agl_m: f64) -> AltitudeLimits {
    AltitudeLimits {
        max_agl: Some(Agl(agl_m)),
        min_amsl: None,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// The greatest height above ground is never below that of dense samples, and reached by them.
    #[test]
    fn the_greatest_height_is_that_of_dense_samples(
        depth_m in 5.0..300.0_f64,
        radius_m in 100.0..2000.0_f64,
    ) {
        let (spec, mission) = over_hill(-depth_m, radius_m, at_most(120.0));
        let margin = of(&judged(&spec, &mission), &Limit::MaxHeight).expect("judged");
        let world = world(&spec);
        let sampled = (0..=20_000).map(|k| {
            let at = place(36.30, -84.30 + 0.1 * f64::from(k) / 20_000.0);
            GROUND_M + 80.0 - world.terrain.height(at).expect("known").0
        });
        let sampled_m = sampled.fold(f64::NEG_INFINITY, f64::max);
        // A leg is straight in the tangent plane, 2 m off the parallel at most.
        let aside_m = 2.0 * depth_m / radius_m + 0.05;
        prop_assert!((margin.value - sampled_m).abs() <= aside_m, "{} {sampled_m}", margin.value);
        prop_assert_eq!(margin.ok, margin.value <= 120.0 + 1e-3);
    }
}

/// A plain that may stand 7 m above the ground.
fn raised_by_7_m() -> Terrain {
    Terrain::Grid(TerrainGrid {
        north_west: place(36.40, -84.40),
        row_step_deg: 0.1,
        column_step_deg: 0.1,
        rows: 3,
        columns: 4,
        heights_m: vec![400.0; 12],
        raised_m: 7.0,
    })
}

#[test]
fn ground_that_may_stand_too_high_makes_the_greatest_height_tighter() {
    let (spec, mission) = over_hill(0.0, 800.0, at_most(115.0));
    let mut world = world(&spec);
    world.terrain = raised_by_7_m();
    let review = review(&spec, &world, &[(0, &mission)]);
    let margin = of(&review, &Limit::MaxHeight).expect("judged");
    assert!((margin.bound - 108.0).abs() < 1e-9, "{margin:?}");
    let mut assumptions = review.assumptions.iter();
    assert!(assumptions.any(|text| text.contains("stands up to 7.0 m above them")));
}

/// Whether a flight at 80 m and a rally point at 80 m keep out of a zone that begins so far above the ground.
fn keeps_under(floor_m: f64) -> (bool, bool) {
    let (mut spec, mut mission) = over_hill(0.0, 800.0, AltitudeLimits::default());
    let centre = place(36.30, -84.25);
    spec.no_fly = vec![Zone {
        id: "above".to_owned(),
        circle: Some((centre, 300.0)),
        floor: Some(Placement::Agl(Agl(floor_m))),
        ..Zone::default()
    }];
    let rally = sortie::mission::command::NAV_RALLY_POINT;
    let over_home = sortie::mission::frame::GLOBAL_RELATIVE_ALT;
    mission.rally = vec![missions::at(rally, over_home, centre, 80.0, 0.0)];
    let mut world = world(&spec);
    world.terrain = raised_by_7_m();
    let review = review(&spec, &world, &[(0, &mission)]);
    let keeps = |limit| of(&review, &limit).is_none_or(|margin| margin.ok);
    let in_flight = keeps(Limit::Zone("above".to_owned()));
    (in_flight, keeps(Limit::RallyObstacles(1)))
}

#[test]
fn the_floor_of_a_zone_above_ground_that_may_stand_too_high_is_as_much_lower() {
    assert_eq!(keeps_under(85.0), (false, false));
    assert_eq!(keeps_under(88.0), (true, true));
}

#[test]
fn paths_are_planned_under_the_floors_that_the_verdict_has() {
    let zone = Zone {
        floor: Some(Placement::Agl(Agl(85.0))),
        ceiling: Some(Placement::Agl(Agl(100.0))),
        ..Zone::default()
    };
    let outline = geo::Polygon::new(geo::LineString::new(Vec::new()), Vec::new());
    let planned = PlanZone::new(outline, &zone, 0.0, &raised_by_7_m());
    assert_eq!(planned.closed_m(400.0), (478.0, 500.0));
}

#[test]
fn without_the_limits_nothing_is_judged_and_with_buffers_they_are_tighter() {
    let (mut spec, mission) = over_hill(-30.0, 800.0, AltitudeLimits::default());
    let without = judged(&spec, &mission);
    for limit in [Limit::MaxHeight, Limit::MinAltitude, Limit::Endurance] {
        assert_eq!(of(&without, &limit), None);
    }
    spec.vehicles[0].altitudes = AltitudeLimits {
        max_agl: Some(Agl(115.0)),
        min_amsl: Some(Amsl(GROUND_M + 75.0)),
    };
    let bare = judged(&spec, &mission);
    spec.buffers.ceiling_m = 10.0;
    spec.buffers.terrain_m = 10.0;
    let buffered = judged(&spec, &mission);
    for (limit, bound) in [
        (Limit::MaxHeight, 105.0),
        (Limit::MinAltitude, GROUND_M + 85.0),
    ] {
        assert!(of(&bare, &limit).expect("judged").ok, "{limit}");
        let margin = of(&buffered, &limit).expect("judged");
        assert!(
            !margin.ok && (margin.bound - bound).abs() < 1e-9,
            "{margin:?}"
        );
        assert!((margin.buffer - 10.0).abs() < 1e-9, "{margin:?}");
    }
}

#[test]
fn ground_of_unknown_height_fails_the_greatest_height() {
    let (spec, mission) = over_hill(10.0, 800.0, at_most(120.0));
    let mut world = world(&spec);
    world.terrain = Terrain::Unknown;
    let review = review(&spec, &world, &[(0, &mission)]);
    let margin = of(&review, &Limit::MaxHeight).expect("judged");
    assert!(!margin.ok && margin.value.is_nan(), "{margin:?}");
}

fn with_endurance(capacity: Capacity, reserve: f64) -> Margin {
    let (mut spec, mission) = over_hill(1.0, 800.0, AltitudeLimits::default());
    spec.vehicles[0].endurance = Some(Endurance { capacity, reserve });
    of(&judged(&spec, &mission), &Limit::Endurance).expect("judged")
}

#[test]
fn endurance_counts_from_takeoff_to_touchdown() {
    // 80 m up at 5 m/s, 8.98 km at 15 m/s with 2.5 m/s^2, 80 m down at 3 m/s.
    let (up_s, down_s) = (80.0 / 5.0, 80.0 / 3.0);
    let run_m = place(36.30, -84.30).chord_m(place(36.30, -84.20));
    let run_s = run_m / 15.0 + 15.0 / 2.5;
    let time = with_endurance(Capacity::Time(1000.0), 0.2);
    // 12 s of it from its takeoff on.
    let late_s = time.value - (up_s + run_s + down_s);
    assert!((12.0..42.0).contains(&late_s), "{time:?}");
    assert!(time.ok && (time.bound - 800.0).abs() < 1e-9);
    assert!(
        time.note.contains("1000 s less a reserve of 20 %"),
        "{time:?}"
    );
    // Late it is over; straight and in time it would not be.
    let over = with_endurance(Capacity::Time(time.value / 0.801), 0.2);
    assert!(!over.ok && !over.note.contains("even straight"), "{over:?}");
    let never = with_endurance(Capacity::Time(600.0), 0.2);
    let straight_s = format!(
        "even straight from place to place it uses {:.0} s",
        up_s + run_s + 70.0 / 3.0 + 10.0 / 0.5
    );
    assert!(never.note.contains(&straight_s), "{never:?} {straight_s}");
    let range = with_endurance(Capacity::Range(9142.0), 0.0);
    assert!(
        (range.value - (run_m + 160.0)).abs() < 3.0,
        "{range:?} {run_m}"
    );
}

#[test]
fn energy_is_power_over_time() {
    let energy = |level: Vec<(f64, f64)>, climbing_w| {
        let energy = Energy {
            wh: 100.0,
            climbing_w,
            climb_mps: 5.0,
            level,
        };
        with_endurance(Capacity::Energy(energy), 0.1).value
    };
    let time_s = with_endurance(Capacity::Time(1000.0), 0.2).value;
    let even = energy(vec![(0.0, 360.0)], 0.0);
    assert!((even - 0.1 * time_s).abs() < 1e-6, "{even} {time_s}");
    // 16 s of climb at 450 W more.
    let climbing = energy(vec![(0.0, 360.0)], 450.0);
    assert!((climbing - even - 2.0).abs() < 0.01, "{climbing} {even}");
    assert!(energy(vec![(0.0, 360.0), (15.0, 180.0)], 0.0) < 0.7 * even);
}

#[test]
fn wind_makes_a_distance_through_the_air_longer() {
    let (mut spec, mission) = over_hill(1.0, 800.0, AltitudeLimits::default());
    spec.vehicles[0].endurance = Some(Endurance {
        capacity: Capacity::Range(20_000.0),
        reserve: 0.2,
    });
    let range_m = |spec: &MissionSpec| {
        of(&judged(spec, &mission), &Limit::Endurance)
            .unwrap()
            .value
    };
    let calm_m = range_m(&spec);
    spec.wind = Some(Wind {
        from_rad: std::f64::consts::FRAC_PI_2,
        speed_mps: 5.0,
    });
    // Against 5 m/s at 15 m/s over the ground: a third more, and the columns.
    let ratio = range_m(&spec) / calm_m;
    assert!((1.3..1.4).contains(&ratio), "{ratio}");
}

#[test]
fn a_copter_that_is_late_hovers_against_the_wind() {
    let (mut spec, mission) = over_hill(1.0, 800.0, AltitudeLimits::default());
    // From the side, so that nothing is flown at less than 5 m/s through the air.
    spec.wind = Some(Wind {
        from_rad: 0.0,
        speed_mps: 5.0,
    });
    let mut used = |capacity| {
        spec.vehicles[0].endurance = Some(Endurance {
            capacity,
            reserve: 0.0,
        });
        let margin = of(&judged(&spec, &mission), &Limit::Endurance);
        margin.expect("judged").value
    };
    let time_s = used(Capacity::Time(5000.0));
    let energy_wh = used(Capacity::Energy(Energy {
        wh: 1000.0,
        climbing_w: 0.0,
        climb_mps: 5.0,
        level: vec![(0.0, 90.0), (4.9, 360.0), (40.0, 360.0)],
    }));
    assert!((energy_wh - 0.1 * time_s).abs() < 1e-6, "{energy_wh}");
    // It does not wait where the air is still for it.
    let range_m = used(Capacity::Range(50_000.0));
    assert!(range_m > 5.0 * time_s, "{range_m} {time_s}");
}
