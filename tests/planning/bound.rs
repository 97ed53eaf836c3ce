//! The proven bound: exact where the answer is known, and below all that passes.

use crate::support;

use proptest::prelude::*;
use sortie::geodesy::{Amsl, EastNorth};
use sortie::spec::*;
use support::plans::{EAST, WEST, plan};
use support::{copter, empty_spec, place, threat};

/// Tangent, arc, tangent around a disc, kilometres.
fn around_km(from: EastNorth, to: EastNorth, center: EastNorth, radius_m: f64) -> f64 {
    let (a, b) = (from.distance_m(center), to.distance_m(center));
    let direction = |at: EastNorth| (at.north_m - center.north_m).atan2(at.east_m - center.east_m);
    let between = (direction(from) - direction(to)).abs();
    let between = between.min(std::f64::consts::TAU - between);
    let arc = between - (radius_m / a).acos() - (radius_m / b).acos();
    let tangents = (a * a - radius_m * radius_m).sqrt() + (b * b - radius_m * radius_m).sqrt();
    (tangents + radius_m * arc) / 1000.0
}

/// What two ends 20 m over the lowest altitude of flat ground add, kilometres: the cheapest way down
/// and up, `2/3 h sqrt(2 h)` each up to the square of its slope.
fn ends_km() -> f64 {
    let height_km = 0.02_f64;
    2.0 * 2.0 / 3.0 * height_km * (2.0 * height_km).sqrt()
}

fn quick(mut spec: MissionSpec) -> MissionSpec {
    spec.planner.evaluations = 300;
    spec
}

#[test]
fn around_a_threat_the_bound_is_two_tangents_and_an_arc() {
    let mut spec = quick(empty_spec(vec![copter("alpha", 1, WEST, EAST)]));
    spec.threats = vec![threat("radar-1", place(36.302, -84.25), 3000.0)];
    let (world, plan) = plan(&spec);
    let (sites, disc) = (world.sites[0].clone(), world.threats[0]);
    let exact_km = around_km(sites.start.at, sites.goal.at, disc.center, disc.radius_m);
    let share = plan.vehicles[0].bound / (exact_km + ends_km());
    assert!((0.9995..=1.0).contains(&share), "{share}");
}

#[test]
fn ground_that_reaches_the_ceiling_is_gone_around() {
    let mut spec = quick(empty_spec(vec![copter("alpha", 1, WEST, EAST)]));
    let top = place(36.302, -84.25);
    let hill = Hill {
        place: top,
        height_m: 900.0,
        radius_m: 3000.0,
    };
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(400.0),
        hills: vec![hill],
    };
    spec.area.max_amsl = Amsl(900.0);
    let (world, plan) = plan(&spec);
    // 400 + 900 exp(-d^2/r^2) + 60 = 900.
    let radius_m = 3000.0 * (900.0_f64 / 440.0).ln().sqrt();
    let sites = world.sites[0].clone();
    let center = world.frame.to_plan(top);
    let exact_km = around_km(sites.start.at, sites.goal.at, center, radius_m);
    let share = plan.vehicles[0].bound / exact_km;
    assert!((0.998..=1.0).contains(&share), "{share}");
}

#[test]
fn a_zone_that_can_be_flown_over_costs_no_more_than_the_way_around_and_nothing_if_it_is_low() {
    let mut spec = quick(empty_spec(vec![copter("alpha", 1, WEST, EAST)]));
    let corners = [
        (36.25, -84.27),
        (36.25, -84.23),
        (36.35, -84.23),
        (36.35, -84.27),
    ];
    let zone = |below: Option<Amsl>| Zone {
        id: "town".to_owned(),
        polygon: corners.map(|(lat, lon)| place(lat, lon)).to_vec(),
        ceiling: below.map(Placement::Amsl),
        ..Zone::default()
    };
    let mut bound = |below| {
        spec.no_fly = vec![zone(below)];
        plan(&spec).1.vehicles[0].bound
    };
    let (low, over, around) = (
        bound(Some(Amsl(450.0))),
        bound(Some(Amsl(900.0))),
        bound(None),
    );
    let straight_km = {
        let (world, _) = plan(&empty_spec(vec![copter("alpha", 1, WEST, EAST)]));
        world.sites[0].start.distance_m(world.sites[0].goal) / 1000.0
    };
    let min_km = straight_km + ends_km();
    assert!((low - min_km).abs() < 0.02 * ends_km(), "{low} {min_km}");
    assert!(min_km < over && over <= around + 1e-9, "{over}");
    assert!(around > 1.02 * straight_km, "{around} {straight_km}");
}

/// Across the whole area, over flat ground: up and down at the limits, by hand.
#[test]
fn over_a_zone_that_nobody_can_pass_beside_the_bound_is_the_climb() {
    let mut spec = quick(empty_spec(vec![copter("alpha", 1, WEST, EAST)]));
    let corners = [
        (36.20, -84.26),
        (36.20, -84.24),
        (36.40, -84.24),
        (36.40, -84.26),
    ];
    spec.no_fly = vec![Zone {
        id: "belt".to_owned(),
        polygon: corners.map(|(lat, lon)| place(lat, lon)).to_vec(),
        ceiling: Some(Placement::Amsl(Amsl(700.0))),
        ..Zone::default()
    }];
    let (world, plan) = plan(&spec);
    let sites = world.sites[0].clone();
    let straight_m = sites.start.at.distance_m(sites.goal.at);
    // 700 m is 240 m above the least height over 400 m, and 220 m above the ends.
    let side_m2 = |slope_deg: f64| 240.0 * 240.0 / (2.0 * slope_deg.to_radians().tan());
    let altitude = 1e-6 * (side_m2(15.0) + side_m2(10.0));
    let exact = straight_m.hypot(440.0) / 1000.0 + altitude;
    let share = plan.vehicles[0].bound / exact;
    assert!((0.998..=1.0).contains(&share), "{share}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    /// Whatever optimiser found it: what keeps all limits costs no less than the bound.
    #[test]
    fn no_plan_that_passes_costs_less_than_its_bound(
        seed in 0_u64..1000,
        algorithm in prop::sample::select(vec![
            Algorithm::Msfoa, Algorithm::De, Algorithm::Pso, Algorithm::Iffo,
        ]),
        threats in prop::collection::vec((36.24..36.36_f64, -84.32..-84.18_f64, 300.0..2500.0_f64), 0..5),
        hills in prop::collection::vec((36.22..36.38_f64, -84.32..-84.18_f64, 200.0..900.0_f64), 0..4),
        lids in prop::collection::vec(
            (36.27..36.33_f64, -84.29..-84.21_f64, 0.005..0.05_f64, 500.0..790.0_f64), 0..4
        ),
    ) {
        let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
        spec.planner.seed = seed;
        spec.planner.algorithm = algorithm;
        spec.planner.evaluations = 4000;
        spec.area.max_amsl = Amsl(800.0);
        spec.threats = threats
            .iter()
            .enumerate()
            .map(|(index, &(lat, lon, radius_m))| threat(&format!("t{index}"), place(lat, lon), radius_m))
            .collect();
        spec.terrain = TerrainSource::Analytic {
            base: Amsl(400.0),
            hills: hills.iter().map(|&(lat, lon, height_m)| Hill {
                place: place(lat, lon), height_m, radius_m: 1200.0,
            }).collect(),
        };
        spec.no_fly = lids
            .iter()
            .enumerate()
            .map(|(index, &(lat, lon, half, top_m))| Zone {
                id: format!("z{index}"),
                polygon: [(-1.0, -0.3), (-1.0, 0.3), (1.0, 0.3), (1.0, -0.3)]
                    .map(|(north, east)| place(lat + half * north, lon + half * east))
                    .to_vec(),
                ceiling: Some(Placement::Amsl(Amsl(top_m))),
                ..Zone::default()
            })
            .collect();
        let (world, plan) = plan(&spec);
        let (vehicle, sites) = (&plan.vehicles[0], &world.sites[0]);
        let straight_km = sites.start.distance_m(sites.goal) / 1000.0;
        prop_assert!(vehicle.bound >= straight_km);
        prop_assert!(vehicle.estimate >= vehicle.bound);
        if vehicle.terms.is_clean() {
            prop_assert!(vehicle.gap().is_some_and(|gap| gap >= 0.0), "{:?}", vehicle.gap());
            prop_assert!(vehicle.terms.total() >= vehicle.bound);
        } else {
            prop_assert!(vehicle.gap().is_none());
        }
    }
}
