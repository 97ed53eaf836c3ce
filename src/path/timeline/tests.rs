use super::{flight, landing_shift_s, route_start_s, time_route};
use crate::geodesy::{Amsl, PlanPoint};
use crate::spec::fixtures::copter;
use crate::spec::{Autopilot, Finish, Span, Vehicle};
use crate::world::{Departure, VehicleSites};

fn vehicle(finish: Finish) -> Vehicle {
    Vehicle {
        autopilot: Autopilot::Px4,
        finish,
        depart_s: 30.0,
        ..copter()
    }
}

fn at(east_m: f64, amsl_m: f64) -> PlanPoint {
    PlanPoint::new(east_m, 0.0, Amsl(amsl_m))
}

/// Home at -100 m, start over 0, goal over 1000 m; ground at 100, 120 under the goal.
fn sites() -> VehicleSites {
    VehicleSites {
        departure: Departure::Ground,
        home: at(-100.0, 100.0),
        start: at(0.0, 180.0),
        goal: at(1000.0, 200.0),
        landing: at(1000.0, 200.0).at,
        landing_rad: None,
        goal_ground: Amsl(120.0),
        stops: Vec::new(),
    }
}

fn route() -> Vec<PlanPoint> {
    vec![at(0.0, 180.0), at(500.0, 190.0), at(1000.0, 200.0)]
}

#[test]
fn a_flight_climbs_goes_to_the_start_flies_the_route_and_lands() {
    let (vehicle, sites) = (vehicle(Finish::Land), sites());
    let flight = flight(&vehicle, &sites, &[route()]);
    // 80 m up at 4 m/s, 100 m and 1000 m at 10 m/s with one ramp of 5 s each, 70 m down at 2 m/s and 10 m at 0.7 m/s.
    let start_s = 30.0 + 20.0 + 15.0;
    assert!((flight.route_starts_s[0] - start_s).abs() < 1e-9);
    assert!((route_start_s(&vehicle, &sites) - start_s).abs() < 1e-9);
    let last = flight.points.last().unwrap();
    assert!((last.t_s - (start_s + 105.0 + 35.0 + 10.0 / 0.7)).abs() < 1e-9);
    assert!((last.point.amsl.0 - 120.0).abs() < 1e-9);
    assert!(!flight.loiters);
    assert!(
        flight
            .points
            .windows(2)
            .all(|pair| pair[0].t_s <= pair[1].t_s)
    );
    assert_eq!(flight.position(29.0), None);
    assert_eq!(flight.position(last.t_s + 1.0), None);
    assert_eq!(flight.position(50.0).unwrap(), at(-100.0, 180.0));
}

#[test]
fn between_its_points_a_flight_leaves_the_true_motion_by_no_more_than_a_metre() {
    let flight = flight(&vehicle(Finish::Land), &sites(), &[route()]);
    let profile = crate::numeric::SpeedProfile::new(1000.0, 10.0, 2.0);
    for step in 0..=1050 {
        let since_s = f64::from(step) * 0.1;
        let there = flight.position(flight.route_starts_s[0] + since_s).unwrap();
        let off_m = (there.at.east_m - profile.distance_at_m(since_s)).abs();
        assert!(off_m <= 1.0 + 1e-9, "{off_m} m off after {since_s} s");
    }
}

#[test]
fn one_that_loiters_stays_for_ever_and_one_that_returns_lands_at_home() {
    let sites = sites();
    let stays = flight(&vehicle(Finish::Loiter), &sites, &[route()]);
    assert!(stays.loiters);
    assert_eq!(stays.position(1e9).unwrap(), sites.goal);
    let back = vec![at(1000.0, 200.0), at(-100.0, 250.0)];
    let returns = flight(&vehicle(Finish::Return), &sites, &[route(), back]);
    assert_eq!(returns.route_starts_s.len(), 2);
    let last = returns.points.last().unwrap();
    assert_eq!(last.point, sites.home);
    assert!((last.t_s - (65.0 + 105.0 + 115.0 + 70.0 + 10.0 / 0.7)).abs() < 1e-9);
}

#[test]
fn one_in_the_air_flies_its_route_from_there_and_then_at_the_speed_it_has() {
    let (vehicle, mut sites) = (vehicle(Finish::Land), sites());
    sites.departure = Departure::Airborne {
        point: sites.start,
        course_rad: std::f64::consts::FRAC_PI_2,
        speed_mps: 10.0,
        at_s: 400.0,
    };
    let flight = flight(&vehicle, &sites, &[route()]);
    assert_eq!(flight.route_starts_s, [400.0]);
    assert!((route_start_s(&vehicle, &sites) - 400.0).abs() < 1e-9);
    assert_eq!(flight.points[0].point, sites.start);
    let last = flight.points.last().unwrap();
    assert!((last.t_s - (400.0 + 102.5 + 35.0 + 10.0 / 0.7)).abs() < 1e-9);
}

#[test]
fn a_route_is_timed_by_its_horizontal_length() {
    let timed = time_route(
        &[at(0.0, 0.0), at(300.0, 400.0), at(600.0, 0.0)],
        7.0,
        10.0,
        2.0,
    );
    let times: Vec<f64> = timed.iter().map(|point| point.t_s).collect();
    assert!((times[0] - 7.0).abs() < 1e-12);
    assert!((times[1] - (7.0 + 32.5)).abs() < 1e-12);
    assert!((times[2] - (7.0 + 65.0)).abs() < 1e-12);
}

#[test]
fn a_copter_that_counts_its_height_from_home_lingers_along_its_landing() {
    // Home 100 m above the ground under the goal: all of 80 m are flown slowly, or the last 10 m.
    let sites = VehicleSites {
        home: at(-100.0, 220.0),
        ..sites()
    };
    let vehicle = vehicle(Finish::Land);
    let flight = flight(&vehicle, &sites, &[route()]);
    let top_s = flight.route_starts_s[0] + 105.0;
    // As fast as it goes, 70 m at 2 m/s and 10 m at 0.7 m/s; as slowly, 80 m at 0.7 m/s.
    let fast_s = |down_m: f64| top_s + down_m.min(70.0) / 2.0 + (down_m - 70.0).max(0.0) / 0.7;
    let slow_s = |down_m: f64| top_s + down_m / 0.7;
    let is_at = |t_s: f64, amsl_m: f64| {
        let mut motions = flight.segments();
        motions.any(|motion| {
            let is_there = (motion.at(t_s)[2] - amsl_m).abs() <= 5.0 + 1e-9;
            motion.t0_s <= t_s + 1e-9 && t_s <= motion.t1_s + 1e-9 && is_there
        })
    };
    for step in 0..=80 {
        let down_m = f64::from(step);
        for share in [0.0, 0.3, 0.7, 1.0] {
            let t_s = fast_s(down_m) + share * (slow_s(down_m) - fast_s(down_m));
            assert!(is_at(t_s, 200.0 - down_m), "{down_m} m down, {t_s} s");
        }
    }
    let last_s = flight.lingers.iter().map(|motion| motion.t1_s);
    assert!((last_s.fold(0.0, f64::max) - slow_s(80.0)).abs() < 1e-9);
    // Points are those of the landing that the plan has.
    assert!((flight.points.last().unwrap().t_s - fast_s(80.0)).abs() < 1e-9);
}

#[test]
fn a_copter_whose_home_is_as_high_as_its_landing_or_who_stays_lingers_nowhere() {
    for (finish, home_amsl_m) in [
        (Finish::Land, 120.0),
        (Finish::Return, 220.0),
        (Finish::Loiter, 220.0),
    ] {
        let sites = VehicleSites {
            home: at(-100.0, home_amsl_m),
            ..sites()
        };
        let flight = flight(&vehicle(finish), &sites, &[route()]);
        assert!(flight.lingers.is_empty(), "{finish:?}");
    }
}

#[test]
fn a_landing_is_earlier_by_what_a_lower_home_takes_from_its_slow_end() {
    let shift_s =
        |home_m: f64| landing_shift_s((Amsl(200.0), Amsl(home_m), Amsl(120.0)), 10.0, (2.0, 0.5));
    let is = |found: Span, least: f64, most: f64| {
        assert!((found.least - least).abs() < 1e-9 && (found.most - most).abs() < 1e-9);
    };
    // A metre takes 0.5 s fast and 2 s slowly.
    is(shift_s(120.0), 0.0, 0.0);
    is(shift_s(114.0), -6.0 * 1.5, 0.0);
    is(shift_s(50.0), -10.0 * 1.5, 0.0);
    is(shift_s(150.0), 0.0, 30.0 * 1.5);
    is(shift_s(900.0), 0.0, 70.0 * 1.5);
}
