//! The law of the kernel: whatever the world, the path and the processor's instructions,
//! it gives the bits of the plain reference.

use crate::support;

use std::sync::{Arc, LazyLock};

use geo::{Coord, LineString, Polygon};
use proptest::prelude::*;
use rand::{Rng, RngExt};
use sortie::cost::{
    Batch, Controls, CostModel, Dispatch, Margins, PaperOptions, RouteEnds, Scratch, ThreatForm,
};
use sortie::geodesy::{Agl, Amsl, EastNorth, PlanPoint};
use sortie::numeric::bspline::uniform_parameters;
use sortie::numeric::{Basis, Seed};
use sortie::path::{Flight, time_route};
use sortie::spec::{Finish, MissionSpec, Objective, Placement, Weights};
use sortie::world::{Disc, Ground, PlanZone, World};
use support::{EAST, WEST, copter, empty_spec, world};

/// Half a side of the map, metres.
const HALF_M: f64 = 10_000.0;

/// An empty world to be filled.
static EMPTY: LazyLock<(MissionSpec, World)> = LazyLock::new(|| {
    let spec = empty_spec(vec![copter("first", 1, WEST, EAST)]);
    let world = world(&spec);
    (spec, world)
});

/// What a world is made of; the rest is drawn.
#[derive(Clone, Debug)]
struct Shape {
    seed: u64,
    nodes: (usize, usize),
    spacing_m: f64,
    /// One node in so many has no data.
    voids: Option<u32>,
    threats: usize,
    zones: usize,
    corners: usize,
    earlier: usize,
    samples: usize,
    controls: usize,
    objective: Objective,
    has_angles: bool,
    vertical_m: Option<f64>,
    finish: Finish,
}

fn shapes() -> impl Strategy<Value = Shape> {
    let world = (
        any::<u64>(),
        (2_usize..40, 2_usize..40),
        20.0..2000.0_f64,
        prop::option::of(10_u32..300),
        (0_usize..14, 0_usize..4, 3_usize..7),
    );
    let flight = (
        0_usize..4,
        2_usize..140,
        2_usize..12,
        prop_oneof![2 => Just(Objective::Operational), 1 => Just(Objective::Paper)],
        prop::bool::ANY,
        prop::option::of(10.0..300.0_f64),
        prop_oneof![Just(Finish::Land), Just(Finish::Loiter)],
    );
    (world, flight).prop_map(|(world, flight)| Shape {
        seed: world.0,
        nodes: world.1,
        spacing_m: world.2,
        voids: world.3,
        threats: world.4.0,
        zones: world.4.1,
        corners: world.4.2,
        earlier: flight.0,
        samples: flight.1,
        controls: flight.2,
        objective: flight.3,
        has_angles: flight.4,
        vertical_m: flight.5,
        finish: flight.6,
    })
}

/// A place on the map or somewhat beyond it.
fn anywhere(rng: &mut impl Rng) -> [f64; 2] {
    [(); 2].map(|()| rng.random_range(-1.2 * HALF_M..1.2 * HALF_M))
}

fn at([east_m, north_m]: [f64; 2]) -> EastNorth {
    EastNorth { east_m, north_m }
}

/// Corners around a middle, in order but at any distances: concave as often as not.
fn polygon(middle: [f64; 2], reach_m: f64, corners: usize, rng: &mut impl Rng) -> Polygon<f64> {
    let outline = (0..corners).map(|i| {
        #[expect(clippy::cast_precision_loss, reason = "few corners")]
        let angle_rad = std::f64::consts::TAU * i as f64 / corners as f64;
        let away_m = reach_m * rng.random_range(0.3..1.0);
        Coord {
            x: middle[0] + away_m * angle_rad.cos(),
            y: middle[1] + away_m * angle_rad.sin(),
        }
    });
    Polygon::new(LineString::from_iter(outline), Vec::new())
}

fn made(shape: &Shape, rng: &mut impl Rng) -> (MissionSpec, World) {
    let (mut spec, mut world) = EMPTY.clone();
    let (columns, rows) = shape.nodes;
    let heights_m = (0..columns * rows)
        .map(|_| match shape.voids {
            Some(one_in) if rng.random_ratio(1, one_in) => f32::NAN,
            _ => rng.random_range(-50.0..900.0),
        })
        .collect();
    world.ground = Arc::new(Ground {
        south_west: at(anywhere(rng)),
        spacing_m: shape.spacing_m,
        columns,
        rows,
        heights_m,
    });
    world.threats = (0..shape.threats)
        .map(|_| Disc {
            center: at(anywhere(rng)),
            radius_m: rng.random_range(50.0..5000.0),
        })
        .collect();
    world.zones = (0..shape.zones)
        .map(|_| {
            let mut zone = PlanZone::closed(polygon(
                anywhere(rng),
                rng.random_range(200.0..6000.0),
                shape.corners,
                rng,
            ));
            let mut height = || match rng.random_range(0..3) {
                0 => None,
                1 => Some(Placement::Amsl(Amsl(rng.random_range(0.0..1500.0)))),
                _ => Some(Placement::Agl(Agl(rng.random_range(0.0..400.0)))),
            };
            (zone.floor, zone.ceiling) = (height(), height());
            zone.buffered(f64::from(rng.random_range(0_u8..2)) * rng.random_range(1.0..800.0))
        })
        .collect();
    world.area = polygon([0.0, 0.0], 1.6 * HALF_M, shape.corners + 1, rng);
    world.min_agl = Agl(rng.random_range(0.0..150.0));
    world.max_amsl = Amsl(rng.random_range(600.0..1500.0));
    spec.planner.objective = shape.objective;
    spec.planner.control_points = shape.controls;
    let mut weight = || rng.random_range(0.0..3.0);
    spec.planner.weights = Weights {
        length: weight(),
        altitude: weight(),
        threat: weight(),
        terrain: weight(),
        turn: weight(),
        climb: weight(),
        collision: weight(),
    };
    spec.separation.vertical_m = shape.vertical_m;
    let vehicle = &mut spec.vehicles[0];
    vehicle.finish = shape.finish;
    if !shape.has_angles {
        (vehicle.max_climb_rad, vehicle.max_descent_rad) = (None, None);
    }
    (spec, world)
}

/// Control points of a path: all east, all north, all altitudes.
fn path(leg: &RouteEnds, controls: usize, rng: &mut impl Rng) -> [Vec<f64>; 3] {
    let ends = [
        (leg.from.at.east_m, leg.to.at.east_m),
        (leg.from.at.north_m, leg.to.at.north_m),
        (leg.from.amsl.0, leg.to.amsl.0),
    ];
    // Nearly straight, winding, anywhere; now and then one that stands still at first.
    let reach_m = [1.0, 300.0, 3000.0, 30_000.0][rng.random_range(0..4_usize)];
    let stands = rng.random_ratio(1, 5);
    let all = controls + 2;
    let mut axis = 0;
    ends.map(|(from, to)| {
        axis += 1;
        let by = if axis == 3 { 0.1 * reach_m } else { reach_m };
        (0..all)
            .map(|i| {
                #[expect(clippy::cast_precision_loss, reason = "few control points")]
                let straight = from + (to - from) * i as f64 / (all - 1) as f64;
                match i {
                    0 => from,
                    _ if i == all - 1 => to,
                    _ if stands && i < 5 => from,
                    _ => straight + rng.random_range(-by..by),
                }
            })
            .collect()
    })
}

/// A flight over a few places, at a time when the other flies too.
fn flight(rng: &mut impl Rng) -> Flight {
    let points: Vec<PlanPoint> = (0..rng.random_range(2..30))
        .map(|_| {
            let [east_m, north_m] = anywhere(rng);
            PlanPoint::new(east_m, north_m, Amsl(rng.random_range(400.0..900.0)))
        })
        .collect();
    let starts_s = rng.random_range(-200.0..600.0);
    Flight {
        points: time_route(&points, starts_s, rng.random_range(5.0..60.0), 2.5),
        route_starts_s: vec![starts_s],
        loiters: false,
        lingers: Vec::new(),
    }
}

fn paper_options(rng: &mut impl Rng) -> PaperOptions {
    let base = if rng.random_bool(0.5) {
        PaperOptions::literal()
    } else {
        PaperOptions::default()
    };
    PaperOptions {
        altitude_over_ground: rng.random_bool(0.5),
        threat_form: if rng.random_bool(0.5) {
            ThreatForm::Quartic
        } else {
            ThreatForm::Linear
        },
        collision_km: rng.random_range(0.1..8.0),
        collision_min: 5.0,
        ..base
    }
}

fn margins(rng: &mut impl Rng) -> Margins {
    Margins {
        clearance_m: rng.random_range(0.0..40.0),
        line_m: 0.0,
        under_m: rng.random_range(0.0..40.0),
        threat_m: rng.random_range(0.0..100.0),
        separation_m: rng.random_range(0.0..50.0),
        shift_s: rng.random_range(0.0..20.0),
        turn_fraction: rng.random_range(0.0..0.2),
        climb_fraction: rng.random_range(0.0..0.2),
    }
}

/// A model in a world of some shape, and paths for it.
fn contest(
    shape: &Shape,
    candidates: usize,
    rng: &mut impl Rng,
) -> (CostModel, Vec<[Vec<f64>; 3]>) {
    let (spec, world) = made(shape, rng);
    let place = |[east_m, north_m]: [f64; 2], amsl_m| PlanPoint::new(east_m, north_m, Amsl(amsl_m));
    let leg = RouteEnds {
        from: place(anywhere(rng), rng.random_range(100.0..900.0)),
        to: place(anywhere(rng), rng.random_range(100.0..900.0)),
        start_s: rng.random_range(0.0..60.0),
    };
    let earlier: Vec<Flight> = (0..shape.earlier).map(|_| flight(rng)).collect();
    let parameters = uniform_parameters(shape.samples);
    let margins = margins(rng);
    let model = CostModel::new(&world, &spec, 0, leg, &earlier.into(), margins, &parameters)
        .with_paper(paper_options(rng));
    let paths = (0..candidates).map(|_| path(&leg, shape.controls, rng));
    let paths = paths.collect();
    (model, paths)
}

fn controls([east_m, north_m, amsl_m]: &[Vec<f64>; 3]) -> Controls<'_> {
    Controls {
        east_m,
        north_m,
        amsl_m,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn in_any_world_every_level_gives_the_bits_of_the_reference(
        shape in shapes(), candidates in 1_usize..20,
    ) {
        let rng = &mut Seed(shape.seed).stream("world", 0);
        let (model, paths) = contest(&shape, candidates, rng);
        let mut batch = Batch::new(shape.controls + 2);
        let mut expected = Vec::new();
        for path in &paths {
            batch.push(&controls(path));
            expected.push(model.terms(&controls(path)));
        }
        for dispatch in Dispatch::all() {
            let model = model.clone().with_dispatch(dispatch);
            let mut fast = vec![0.0; batch.len()];
            model.totals(&batch, &mut Scratch::default(), &mut fast);
            for ((terms, expected), fast) in model.judge(&batch).iter().zip(&expected).zip(fast) {
                prop_assert_eq!(terms, expected, "{}", dispatch.name());
                let exact = expected.total();
                prop_assert_eq!(terms.total().to_bits(), exact.to_bits());
                prop_assert!(exact.is_finite(), "{:?}", expected);
                prop_assert_eq!(fast.to_bits(), exact.to_bits());
            }
        }
    }

    #[test]
    fn what_runs_up_along_a_path_ends_at_its_total_and_a_control_point_moves_only_its_own_blocks(
        shape in shapes(), candidates in 1_usize..20, control in any::<prop::sample::Index>(),
    ) {
        let rng = &mut Seed(shape.seed).stream("world", 0);
        let (model, mut paths) = contest(&shape, candidates, rng);
        // The last path is the first with one control point moved.
        let control = 1 + control.index(shape.controls);
        let mut moved = paths[0].clone();
        for axis in &mut moved {
            axis[control] += rng.random_range(-500.0..500.0);
        }
        paths.push(moved);
        let mut batch = Batch::new(shape.controls + 2);
        for path in &paths {
            batch.push(&controls(path));
        }
        let blocks = model.blocks();
        let terms = model.judge(&batch);
        let mut levels = Vec::new();
        for dispatch in Dispatch::all() {
            let model = model.clone().with_dispatch(dispatch);
            let (mut totals, mut along) = (vec![0.0; batch.len()], vec![0.0; batch.len() * blocks]);
            model.totals_along(&batch, &mut Scratch::default(), &mut totals, &mut along);
            for ((terms, total), along) in terms.iter().zip(&totals).zip(along.chunks(blocks)) {
                prop_assert_eq!(total.to_bits(), terms.total().to_bits());
                if shape.objective == Objective::Operational {
                    let at_the_end = along[blocks - 1] + terms.collision;
                    prop_assert_eq!(at_the_end.to_bits(), total.to_bits());
                    prop_assert!(along.is_sorted(), "{:?}", along);
                } else {
                    prop_assert!(along.iter().all(|&total| total == 0.0));
                }
            }
            levels.push(along);
        }
        for along in &levels[1..] {
            let same = along.iter().zip(&levels[0]).all(|(a, b)| a.to_bits() == b.to_bits());
            prop_assert!(same);
        }
        let basis = Basis::new(shape.controls + 2, &uniform_parameters(shape.samples));
        let shares = |&k: &usize| {
            let (first, _) = basis.row(k);
            (first..first + 4).contains(&control)
        };
        let mut samples = (0..shape.samples).filter(shares);
        let Some(first) = samples.next() else { return Ok(()) };
        let (first, last) = model.blocks_of(first, samples.next_back().unwrap_or(first));
        let costs = |path: usize| {
            let along = &levels[0][path * blocks..][..blocks];
            let before = std::iter::once(0.0).chain(along.iter().copied());
            along.iter().zip(before).map(|(to, from)| to - from).collect::<Vec<f64>>()
        };
        let rounding = 1e-9 * (terms[0].total().abs() + terms[candidates].total().abs());
        let pairs = costs(0).into_iter().zip(costs(candidates));
        for (block, (was, is)) in pairs.enumerate() {
            if block < first || block > last {
                prop_assert!((was - is).abs() <= rounding, "{block}: {was} {is}");
            }
        }
    }
}
