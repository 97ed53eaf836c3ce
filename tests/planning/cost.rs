//! Laws of the objective.

use crate::support;

use std::sync::{Arc, LazyLock};

use proptest::prelude::*;
use sortie::cost::{
    Batch, Controls, CostModel, CostTerms, Dispatch, EarlierFlights, Margins, PaperOptions,
    RouteEnds, Scratch, ThreatForm,
};
use sortie::geodesy::{Agl, Amsl, LatLon, PlanPoint};
use sortie::numeric::bspline::uniform_parameters;
use sortie::path::{Flight, flight, route_start_s};
use sortie::spec::{
    EndPoint, Finish, Hill, MissionSpec, Objective, Placement, TerrainSource, Threat, Weights, Zone,
};
use sortie::world::World;
use support::{EAST, WEST, copter, empty_spec, place, world};

const FREE: usize = 8;

/// Shares of the way to the control points of a straight path.
fn shares() -> impl Iterator<Item = f64> {
    (0..10_u8).map(|i| f64::from(i) / 9.0)
}

/// Control points of one candidate, ends included.
#[derive(Clone, Debug)]
struct Path {
    east_m: Vec<f64>,
    north_m: Vec<f64>,
    amsl_m: Vec<f64>,
}

impl Path {
    /// Evenly spread control points on the straight line: the straight path.
    fn straight(leg: &RouteEnds) -> Self {
        let coordinate = |from: f64, to: f64| -> Vec<f64> {
            shares().map(|share| from + (to - from) * share).collect()
        };
        Self {
            east_m: coordinate(leg.from.at.east_m, leg.to.at.east_m),
            north_m: coordinate(leg.from.at.north_m, leg.to.at.north_m),
            amsl_m: coordinate(leg.from.amsl.0, leg.to.amsl.0),
        }
    }

    /// The straight path with its free control points moved.
    fn moved(leg: &RouteEnds, by: &[[f64; 3]]) -> Self {
        let mut path = Self::straight(leg);
        for (i, by) in by.iter().take(FREE).enumerate() {
            path.east_m[i + 1] += by[0];
            path.north_m[i + 1] += by[1];
            path.amsl_m[i + 1] += by[2];
        }
        path
    }

    fn controls(&self) -> Controls<'_> {
        Controls {
            east_m: &self.east_m,
            north_m: &self.north_m,
            amsl_m: &self.amsl_m,
        }
    }

    fn points(&self, samples: usize) -> Vec<PlanPoint> {
        let basis = sortie::numeric::Basis::uniform(FREE + 2, samples);
        let mut out = [vec![0.0; samples], vec![0.0; samples], vec![0.0; samples]];
        for (values, out) in [&self.east_m, &self.north_m, &self.amsl_m]
            .iter()
            .zip(&mut out)
        {
            basis.apply(values, out);
        }
        (0..samples)
            .map(|k| PlanPoint::new(out[0][k], out[1][k], Amsl(out[2][k])))
            .collect()
    }
}

fn leg(world: &World, spec: &MissionSpec, vehicle: usize) -> RouteEnds {
    let sites = &world.sites[vehicle];
    RouteEnds {
        from: sites.start,
        to: sites.goal,
        start_s: route_start_s(&spec.vehicles[vehicle], sites),
    }
}

/// The model of the last vehicle at `samples` samples, others flying before it.
fn model(
    spec: &MissionSpec,
    world: &World,
    earlier: &[Flight],
    samples: usize,
) -> (CostModel, RouteEnds) {
    let vehicle = spec.vehicles.len() - 1;
    let leg = leg(world, spec, vehicle);
    let parameters = uniform_parameters(samples);
    let model = CostModel::new(
        world,
        spec,
        vehicle,
        leg,
        &EarlierFlights::from(earlier.to_vec()),
        Margins::default(),
        &parameters,
    );
    (model, leg)
}

const SOUTH: LatLon = LatLon {
    lat_deg: 36.225,
    lon_deg: -84.25,
};
const NORTH: LatLon = LatLon {
    lat_deg: 36.375,
    lon_deg: -84.25,
};

fn hill(lat_deg: f64, lon_deg: f64, height_m: f64, radius_m: f64) -> Hill {
    Hill {
        place: place(lat_deg, lon_deg),
        height_m,
        radius_m,
    }
}

fn threat(lat_deg: f64, lon_deg: f64, radius_m: f64) -> Threat {
    Threat {
        id: "radar".to_owned(),
        kind: "radar".to_owned(),
        place: place(lat_deg, lon_deg),
        radius_m,
    }
}

/// Ridges, ten threats, zones with and without a height, one vehicle crossing before.
fn rough_spec() -> MissionSpec {
    let mut spec = empty_spec(vec![
        copter("first", 1, SOUTH, NORTH),
        copter("second", 2, WEST, EAST),
    ]);
    let hills = (0..24)
        .map(|i: u32| {
            let angle = f64::from(i) * 2.4;
            let reach = 0.009 * f64::from(i).sqrt();
            hill(
                36.30 + reach * angle.sin(),
                -84.25 + 1.8 * reach * angle.cos(),
                80.0 + 23.0 * f64::from(i % 7),
                600.0 + 170.0 * f64::from(i % 5),
            )
        })
        .collect();
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(400.0),
        hills,
    };
    spec.threats = (0..10)
        .map(|i: u32| {
            let angle = f64::from(i) * 1.9;
            let mut threat = threat(
                36.30 + 0.05 * angle.sin(),
                -84.25 + 0.06 * angle.cos(),
                500.0 + 100.0 * f64::from(i),
            );
            threat.id = format!("radar-{i}");
            threat
        })
        .collect();
    let zone = |id: &str, below: Option<Amsl>, corners: &[(f64, f64)]| Zone {
        id: id.to_owned(),
        polygon: corners.iter().map(|(lat, lon)| place(*lat, *lon)).collect(),
        ceiling: below.map(sortie::spec::Placement::Amsl),
        ..Zone::default()
    };
    spec.no_fly = vec![
        zone(
            "notch",
            None,
            &[
                (36.31, -84.30),
                (36.31, -84.27),
                (36.34, -84.27),
                (36.325, -84.285),
                (36.34, -84.30),
            ],
        ),
        zone(
            "low",
            Some(Amsl(600.0)),
            &[(36.26, -84.24), (36.29, -84.22), (36.26, -84.20)],
        ),
    ];
    spec
}

fn first_flight(spec: &MissionSpec, world: &World) -> Flight {
    let leg = leg(world, spec, 0);
    flight(
        &spec.vehicles[0],
        &world.sites[0],
        &[Path::straight(&leg).points(101)],
    )
}

fn moves(reach_m: f64) -> impl Strategy<Value = Vec<[f64; 3]>> {
    prop::collection::vec(
        [-reach_m..reach_m, -reach_m..reach_m, -100.0..400.0_f64],
        FREE,
    )
}

#[test]
fn a_clean_straight_path_costs_its_length_and_its_height_above_the_minimum() {
    let spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    let world = world(&spec);
    for samples in [11, 101, 2001] {
        let (model, leg) = model(&spec, &world, &[], samples);
        let terms = model.terms(&Path::straight(&leg).controls());
        let length_km = leg.from.distance_m(leg.to) / 1000.0;
        assert!(terms.is_clean(), "{terms:?}");
        assert!((terms.length - length_km).abs() < 1e-9);
        // 80 m above ground where 60 are wanted, weight 1 per km.
        assert!(
            (terms.altitude - 0.020 * length_km).abs() < 1e-6,
            "{terms:?}"
        );
    }
}

/// The rough world is slow to sample, so it is made once.
static ROUGH: LazyLock<(MissionSpec, World, Vec<Flight>)> = LazyLock::new(|| {
    let spec = rough_spec();
    let world = world(&spec);
    let mut staying = spec.clone();
    staying.vehicles[0].finish = Finish::Loiter;
    staying.vehicles[0].depart_s = 300.0;
    let earlier = vec![first_flight(&spec, &world), first_flight(&staying, &world)];
    (spec, world, earlier)
});

fn rough(objective: Objective, samples: usize) -> (CostModel, RouteEnds) {
    let (spec, world, earlier) = &*ROUGH;
    let mut spec = spec.clone();
    spec.planner.objective = objective;
    model(&spec, world, earlier, samples)
}

fn paper_options() -> impl Strategy<Value = PaperOptions> {
    (
        prop::bool::ANY,
        prop::bool::ANY,
        prop_oneof![Just(ThreatForm::Quartic), Just(ThreatForm::Linear)],
        0.1..5.0_f64,
    )
        .prop_map(|(literal, over_ground, threat_form, collision_km)| {
            let options = if literal {
                PaperOptions::literal()
            } else {
                PaperOptions::default()
            };
            PaperOptions {
                altitude_over_ground: over_ground,
                threat_form,
                collision_km,
                collision_min: 5.0,
                ..options
            }
        })
}

fn weighted(by: [f64; 7]) -> Weights {
    Weights {
        length: by[0],
        altitude: by[1],
        threat: by[2],
        terrain: by[3],
        turn: by[4],
        climb: by[5],
        collision: by[6],
    }
}

fn objective() -> impl Strategy<Value = Objective> {
    prop_oneof![2 => Just(Objective::Operational), 1 => Just(Objective::Paper)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_fast_totals_are_the_reference_to_the_bit(
        many in prop::collection::vec(prop_oneof![moves(300.0), moves(6000.0), moves(40_000.0)], 1..20),
        near in moves(200.0), spread in prop::bool::ANY,
        samples in 2_usize..160, objective in objective(), weights in prop::array::uniform7(0.0..3.0_f64),
        vertical_m in prop::option::of(10.0..300.0_f64), options in paper_options(),
    ) {
        let (spec, world, earlier) = &*ROUGH;
        let mut spec = spec.clone();
        spec.planner.objective = objective;
        spec.planner.weights = weighted(weights);
        spec.separation.vertical_m = vertical_m;
        let (model, leg) = model(&spec, world, earlier, samples);
        let model = model.with_paper(options);
        let mut batch = Batch::new(FREE + 2);
        let mut expected = Vec::new();
        for moves in &many {
            let moves = if spread { moves } else { &near };
            let path = Path::moved(&leg, moves);
            batch.push(&path.controls());
            expected.push(model.terms(&path.controls()));
        }
        for dispatch in Dispatch::all() {
            let model = model.clone().with_dispatch(dispatch);
            let terms = model.judge(&batch);
            let mut fast = vec![0.0; batch.len()];
            model.totals(&batch, &mut Scratch::default(), &mut fast);
            for ((terms, expected), fast) in terms.iter().zip(&expected).zip(fast) {
                prop_assert_eq!(terms, expected, "{}", dispatch.name());
                let (total, exact) = (terms.total(), expected.total());
                prop_assert_eq!(total.to_bits(), exact.to_bits());
                prop_assert!(exact.is_finite());
                prop_assert_eq!(fast.to_bits(), exact.to_bits());
            }
        }
    }

    #[test]
    fn every_term_is_finite_and_at_least_zero(moves in moves(40_000.0), objective in objective()) {
        let (model, leg) = rough(objective, 101);
        let terms = model.terms(&Path::moved(&leg, &moves).controls());
        for term in [
            terms.length, terms.altitude, terms.threat, terms.terrain, terms.turn, terms.climb, terms.collision,
        ] {
            prop_assert!(term.is_finite() && term >= 0.0, "{terms:?}");
        }
    }

    #[test]
    fn a_finer_sampling_changes_the_operational_terms_ever_less(moves in moves(1500.0)) {
        let at = |samples| {
            let (model, leg) = rough(Objective::Operational, samples);
            model.terms(&Path::moved(&leg, &moves).controls())
        };
        // As in a search, as results are judged, and finer.
        let (coarse, middle, fine) = (at(101), at(2001), at(8001));
        let is_cusp = fine.turn > 300.0;
        for (what, pick) in TERMS {
            let (coarse, middle, fine) = (pick(&coarse), pick(&middle), pick(&fine));
            // At a cusp the curvature has no bound, and its mean no limit; the way stands still
            // there while it goes on climbing, for less than a sample.
            if is_cusp && ["turn", "climb"].contains(&what) {
                continue;
            }
            let (first, second) = ((coarse - fine).abs(), (middle - fine).abs());
            prop_assert!(second <= 0.06 * fine + 0.05, "{what} {middle} {fine}");
            prop_assert!(second <= first + 0.02 * fine + 0.02, "{what} {coarse} {middle} {fine}");
            if ["length", "altitude"].contains(&what) {
                prop_assert!(first <= 0.01 * fine + 0.001, "{what} {coarse} {fine}");
            }
        }
    }

    #[test]
    fn a_threat_is_never_worth_crossing(
        radius_m in 500.0..3000.0_f64, offset in -0.8..0.8_f64, reach in 1.0..4.0_f64
    ) {
        let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
        let lat_deg = WEST.lat_deg + offset * radius_m / 111_000.0;
        spec.threats = vec![threat(lat_deg, -84.25, radius_m)];
        let world = world(&spec);
        let (model, leg) = model(&spec, &world, &[], 101);
        let through = model.terms(&Path::straight(&leg).controls());
        prop_assert!(through.threat > 0.0);
        let side = if offset > 0.0 { -1.0 } else { 1.0 };
        let bow: Vec<[f64; 3]> = (1..=8)
            .map(|i| [0.0, side * reach * radius_m * (f64::from(i) * 0.349).sin(), 0.0])
            .collect();
        let detour = model.terms(&Path::moved(&leg, &bow).controls());
        if detour.is_clean() && detour.length < 1.4 * through.length {
            prop_assert!(through.total() > detour.total(), "{through:?} {detour:?}");
        }
    }

    #[test]
    fn whether_a_turn_is_too_tight_does_not_depend_on_the_sampling(bend_m in 50.0..6000.0_f64) {
        let spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
        let world = world(&spec);
        let radius_m = sortie::path::VehicleLimits::of(&spec.vehicles[0]).turn_radius_m;
        let (_, leg) = model(&spec, &world, &[], 2);
        // A zigzag: every second control point aside.
        let zigzag: Vec<[f64; 3]> = (0..8_i32)
            .map(|i| [0.0, if i % 2 == 0 { bend_m } else { -bend_m }, 0.0])
            .collect();
        let path = Path::moved(&leg, &zigzag);
        let tightest_m = tightest_radius_m(&path.points(8001));
        for samples in [101, 301, 1001, 2001] {
            let (model, _) = model(&spec, &world, &[], samples);
            let turn = model.terms(&path.controls()).turn;
            if tightest_m > 1.3 * radius_m {
                prop_assert!(turn <= 0.0, "{turn} at {samples} samples, {tightest_m} m");
            }
            if tightest_m < 0.7 * radius_m && samples > 300 {
                prop_assert!(turn > 0.0, "{samples} samples, {tightest_m} m");
            }
        }
    }

    #[test]
    fn margins_only_ever_add(moves in moves(1000.0), margin in 0.0..60.0_f64) {
        let (spec, world, earlier) = &*ROUGH;
        let (plain, leg) = rough(Objective::Operational, 101);
        let margins = Margins {
            clearance_m: margin,
            line_m: 0.0,
            under_m: margin,
            threat_m: margin,
            separation_m: margin,
            shift_s: 0.3 * margin,
            turn_fraction: 0.1,
            climb_fraction: 0.1,
        };
        let strict = CostModel::new(world, spec, 1, leg, &earlier.clone().into(), margins, &uniform_parameters(101));
        let path = Path::moved(&leg, &moves);
        let (plain, strict) = (plain.terms(&path.controls()), strict.terms(&path.controls()));
        for (what, pick) in TERMS {
            prop_assert!(pick(&strict) >= pick(&plain) * (1.0 - 1e-9), "{what} {plain:?} {strict:?}");
        }
    }
}

type Pick = fn(&CostTerms) -> f64;

const TERMS: [(&str, Pick); 7] = [
    ("length", |terms| terms.length),
    ("altitude", |terms| terms.altitude),
    ("threat", |terms| terms.threat),
    ("terrain", |terms| terms.terrain),
    ("turn", |terms| terms.turn),
    ("climb", |terms| terms.climb),
    ("collision", |terms| terms.collision),
];

/// Least radius of the circles through three neighbours of a dense polyline.
fn tightest_radius_m(points: &[PlanPoint]) -> f64 {
    points
        .windows(3)
        .map(|three| {
            let side = |i: usize, j: usize| three[i].at.distance_m(three[j].at);
            let cross = (three[1].at.east_m - three[0].at.east_m)
                * (three[2].at.north_m - three[0].at.north_m)
                - (three[1].at.north_m - three[0].at.north_m)
                    * (three[2].at.east_m - three[0].at.east_m);
            side(0, 1) * side(1, 2) * side(0, 2) / (2.0 * cross.abs()).max(1e-12)
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn ground_without_data_is_a_wall_at_every_altitude() {
    let spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    let mut world = world(&spec);
    for objective in [Objective::Operational, Objective::Paper] {
        let mut spec = spec.clone();
        spec.planner.objective = objective;
        let (whole, leg) = model(&spec, &world, &[], 101);
        let over = |height_m: f64| Path::moved(&leg, &[[0.0, 0.0, height_m]; 8]);
        let clean = whole.terms(&over(0.0).controls());
        assert!(clean.is_clean(), "{clean:?}");
        let intact = world.ground.clone();
        Arc::make_mut(&mut world.ground).heights_m.fill(f32::NAN);
        let (void, _) = model(&spec, &world, &[], 101);
        for height_m in [-400.0, 0.0, 500.0, 1020.0, 2000.0, 9000.0] {
            let terms = void.terms(&over(height_m).controls());
            assert!(
                terms.terrain > 0.0 && terms.total().is_finite(),
                "{height_m}: {terms:?}"
            );
            let mut batch = Batch::new(FREE + 2);
            batch.push(&over(height_m).controls());
            assert_eq!(void.judge(&batch), [terms]);
        }
        world.ground = intact;
    }
}

#[test]
fn a_zone_with_a_height_is_closed_below_it_only_and_the_ceiling_counts_as_terrain() {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    spec.no_fly = vec![Zone {
        id: "town".to_owned(),
        polygon: vec![
            place(36.28, -84.26),
            place(36.32, -84.26),
            place(36.32, -84.24),
            place(36.28, -84.24),
        ],
        ceiling: Some(sortie::spec::Placement::Amsl(Amsl(700.0))),
        ..Zone::default()
    }];
    let world = world(&spec);
    let (model, leg) = model(&spec, &world, &[], 201);
    let raised = |by_m: f64| model.terms(&Path::moved(&leg, &[[0.0, 0.0, by_m]; 8]).controls());
    let (low, over, above) = (raised(0.0), raised(300.0), raised(1100.0));
    // 0.02 degrees of longitude at 36.3 N are 1.797 km.
    assert!((low.threat - 100.0 * 1.1 * 1.797).abs() < 0.3, "{low:?}");
    assert!(over.is_clean(), "{over:?}");
    assert!(above.threat <= 0.0 && above.terrain > 0.0, "{above:?}");
}

#[test]
fn leaving_the_area_costs_what_a_zone_costs() {
    let spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    let world = world(&spec);
    let (model, leg) = model(&spec, &world, &[], 101);
    let inside = model.terms(&Path::moved(&leg, &[[0.0, 5000.0, 0.0]; 8]).controls());
    let outside = model.terms(&Path::moved(&leg, &[[0.0, 15_000.0, 0.0]; 8]).controls());
    assert!(inside.threat <= 0.0, "{inside:?}");
    assert!(
        outside.threat > 0.5 * 110.0 * leg.from.distance_m(leg.to) / 1000.0,
        "{outside:?}"
    );
}

/// Two copters whose straight paths cross in the middle at the same time.
fn crossing() -> MissionSpec {
    let mut spec = empty_spec(vec![
        copter("first", 1, SOUTH, NORTH),
        copter("second", 2, WEST, EAST),
    ]);
    let shift_s = 250.0;
    // Both reach the middle when they are as far from it: the shorter leg waits.
    let half = |from: LatLon| {
        let middle = spec.frame.to_plan(place(36.30, -84.25));
        spec.frame.to_plan(from).distance_m(middle) / 15.0
    };
    let (south_s, west_s) = (half(SOUTH), half(WEST));
    spec.vehicles[0].depart_s = shift_s + west_s.max(south_s) - south_s;
    spec.vehicles[1].depart_s = shift_s + west_s.max(south_s) - west_s;
    spec
}

fn collision_of(spec: &MissionSpec, samples: usize) -> f64 {
    let world = world(spec);
    let earlier = [first_flight(spec, &world)];
    let (model, leg) = model(spec, &world, &earlier, samples);
    model.terms(&Path::straight(&leg).controls()).collision
}

#[test]
fn two_that_cross_at_once_collide_at_every_sampling_and_time_or_height_keeps_them_apart() {
    let spec = crossing();
    for samples in [11, 101, 2001] {
        assert!(collision_of(&spec, samples) > 0.0, "{samples}");
    }
    // 100 m at 15 m/s seen across the diagonal, and the slack: 15 s suffice, 8 do not.
    let mut later = spec.clone();
    later.vehicles[1].depart_s += 8.0;
    assert!(collision_of(&later, 101) > 0.0);
    later.vehicles[1].depart_s += 7.0;
    assert!(collision_of(&later, 101) <= 0.0);
    let mut higher = spec.clone();
    let altitude = Placement::Agl(Agl(150.0));
    higher.vehicles[1].start = EndPoint {
        altitude,
        ..spec.vehicles[1].start
    };
    higher.vehicles[1].goal = EndPoint {
        altitude,
        ..spec.vehicles[1].goal
    };
    // 70 m above: too near by distance, apart by a vertical limit of 50 m.
    let before_s = (150.0 - 80.0) / 5.0;
    higher.vehicles[1].depart_s -= before_s;
    assert!(collision_of(&higher, 101) > 0.0);
    higher.separation.vertical_m = Some(50.0);
    assert!(collision_of(&higher, 101) <= 0.0);
    higher.separation.vertical_m = Some(90.0);
    assert!(collision_of(&higher, 101) > 0.0);
}

#[test]
fn one_that_loiters_is_in_the_way_for_ever_and_what_follows_the_route_counts() {
    let mut spec = empty_spec(vec![
        copter("first", 1, SOUTH, EAST),
        copter("second", 2, WEST, EAST),
    ]);
    spec.vehicles[1].depart_s = 20_000.0;
    assert!(collision_of(&spec, 101) <= 0.0, "landed long ago");
    spec.vehicles[0].finish = Finish::Loiter;
    assert!(collision_of(&spec, 101) > 0.0);
    // The other way round: the first passes long after the second has arrived.
    let mut spec = empty_spec(vec![
        copter("first", 1, WEST, EAST),
        copter("second", 2, SOUTH, place(36.30, -84.25)),
    ]);
    spec.vehicles[0].depart_s = 20_000.0;
    assert!(collision_of(&spec, 101) <= 0.0, "landed long before");
    spec.vehicles[1].finish = Finish::Loiter;
    assert!(collision_of(&spec, 101) > 0.0);
}

#[test]
fn a_copter_turns_no_tighter_than_its_load_factor_and_its_acceleration_allow() {
    let mut vehicle = copter("alpha", 1, WEST, EAST);
    let radius_m =
        |vehicle: &sortie::spec::Vehicle| sortie::path::VehicleLimits::of(vehicle).turn_radius_m;
    // 15 m/s: 225 / 2.5 by acceleration, 225 / (9.80665 * sqrt(0.44)) = 34.59 by load.
    assert!((radius_m(&vehicle) - 90.0).abs() < 1e-9);
    vehicle.accel_mps2 = 10.0;
    assert!((radius_m(&vehicle) - 34.59).abs() < 0.01);
}

#[test]
fn a_zone_with_a_floor_is_flown_under_and_one_above_ground_follows_the_hills() {
    let square = || {
        vec![
            place(36.28, -84.26),
            place(36.32, -84.26),
            place(36.32, -84.24),
            place(36.28, -84.24),
        ]
    };
    // 0.02 degrees of longitude at 36.3 N are 1.797 km.
    let through = 100.0 * 1.1 * 1.797;
    let threat = |floor, ceiling, by_m: f64| {
        let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
        let base = Amsl(400.0);
        let hill = Hill {
            place: place(36.30, -84.25),
            height_m: 300.0,
            radius_m: 400.0,
        };
        spec.terrain = TerrainSource::Analytic {
            base,
            hills: vec![hill],
        };
        spec.no_fly = vec![Zone {
            floor,
            ceiling,
            ..Zone::closed("tma".to_owned(), square())
        }];
        let world = world(&spec);
        let (model, leg) = model(&spec, &world, &[], 401);
        model
            .terms(&Path::moved(&leg, &[[0.0, 0.0, by_m]; 8]).controls())
            .threat
    };
    let amsl = |amsl_m| Some(Placement::Amsl(Amsl(amsl_m)));
    let agl = |agl_m| Some(Placement::Agl(Agl(agl_m)));
    assert!(threat(amsl(900.0), None, 0.0) <= 0.0);
    assert!((threat(amsl(600.0), None, 300.0) - through).abs() < 0.3);
    assert!(threat(amsl(600.0), amsl(700.0), 300.0) <= 0.0);
    // Over the plain 480 m are 80 m above ground, over the hill far below its summit: the part
    // of the way where the ground is above 400 m + 20 m is in the zone up to 60 m above ground.
    let near = threat(None, agl(60.0), 0.0);
    let wide_km = 2.0 * 0.4 * (300.0_f64 / 20.0).ln().sqrt();
    assert!((near - 100.0 * 1.1 * wide_km).abs() < 3.0, "{near}");
    let away = threat(agl(60.0), None, 0.0);
    assert!((away + near - through).abs() < 0.6, "{away}");
}
