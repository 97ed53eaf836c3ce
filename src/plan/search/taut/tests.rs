//! Laws of taut paths, and a corner whose shortest way is known.

use std::path::Path;

use proptest::prelude::*;

use super::*;
use crate::cost::{EarlierFlights, Margins, RouteEnds};
use crate::geodesy::{Amsl, EastNorth};
use crate::plan::classes::taut_line::Bend;
use crate::spec::{MissionSpec, SpecFile};
use crate::world::{Disc, PlanZone, Terrain, World};

/// Distance from threats and zones beyond their buffers, metres.
const MARGIN_M: f64 = 0.5;

/// The first shipped mission, its objective the length alone, and its flat world without its threat.
fn empty() -> (MissionSpec, World) {
    let text = include_str!("../../../../missions/first.yaml").to_owned();
    let mut spec = SpecFile::parse(Path::new("first.yaml"), text)
        .expect("a shipped mission")
        .spec;
    spec.planner.weights.altitude = 0.0;
    let mut world = World::new(&spec, Terrain::Flat(Amsl(584.0))).expect("ground");
    world.threats.clear();
    (spec, world)
}

fn with_context<T>(
    (spec, world): (&MissionSpec, &World),
    act: impl FnOnce(&RouteContext<'_>) -> T,
) -> T {
    let sites = &world.sites[0];
    act(&RouteContext {
        world,
        spec,
        index: 0,
        ends: RouteEnds {
            from: sites.start,
            to: sites.goal,
            start_s: 0.0,
        },
        earlier: EarlierFlights::none(),
        margins: Margins {
            threat_m: MARGIN_M,
            ..Margins::default()
        },
        extra: &[],
        options: crate::plan::SearchOptions::default(),
        at_edges: false,
        cancel: None,
    })
}

/// A place by its share of the way from start to goal, and metres to the left of it.
fn left_of((from, to): (EastNorth, EastNorth), share: f64, left_m: f64) -> EastNorth {
    let (east_m, north_m) = (to.east_m - from.east_m, to.north_m - from.north_m);
    let length_m = east_m.hypot(north_m);
    EastNorth {
        east_m: from.east_m + share * east_m - left_m * north_m / length_m,
        north_m: from.north_m + share * north_m + left_m * east_m / length_m,
    }
}

/// A path that swings out to the left.
fn swung(context: &RouteContext<'_>, by_m: f64) -> Found {
    let point = |number: u32| {
        let share = f64::from(number) / 9.0;
        let left_m = by_m * (share * std::f64::consts::PI).sin();
        left_of(context.ends_at(), share, left_m)
    };
    along(context, &(1..9).map(point).collect::<Vec<_>>())
}

#[test]
fn past_a_corner_a_taut_path_is_as_long_as_the_shortest_way_around_it() {
    const BUFFER_M: f64 = 10.0;
    let (spec, mut world) = empty();
    let ends = (world.sites[0].start.at, world.sites[0].goal.at);
    let corner = left_of(ends, 0.4, 300.0);
    let outline = [
        corner,
        left_of(ends, 0.3, -600.0),
        left_of(ends, 0.5, -600.0),
    ];
    let ring = outline.map(|at| (at.east_m, at.north_m)).to_vec();
    let zone = PlanZone::closed(geo::Polygon::new(ring.into(), Vec::new()));
    world.zones = vec![zone.buffered(BUFFER_M)];
    let (before, after) = with_context((&spec, &world), |context| {
        let found = swung(context, 500.0);
        assert!(found.strict.is_clean(), "{:?}", found.strict);
        (found.strict, taut(context, found).strict)
    });
    // Tangents to the circle around the corner, and its arc between them.
    let radius_m = BUFFER_M + MARGIN_M;
    let legs_m = [ends.0.distance_m(corner), corner.distance_m(ends.1)];
    let straight_m = ends.0.distance_m(ends.1);
    let cosine = (legs_m[0].powi(2) + legs_m[1].powi(2) - straight_m.powi(2))
        / (2.0 * legs_m[0] * legs_m[1]);
    let at_corner_rad = std::f64::consts::TAU - cosine.acos();
    let arc_rad = at_corner_rad
        - legs_m
            .iter()
            .map(|leg| (radius_m / leg).acos())
            .sum::<f64>();
    let tangents_m = legs_m.map(|leg| (leg * leg - radius_m * radius_m).sqrt());
    let min_km = (tangents_m[0] + tangents_m[1] + radius_m * arc_rad) / 1000.0;
    assert!(after.is_clean(), "{after:?}");
    assert!(before.total() > 1.02 * min_km, "{before:?} {min_km}");
    assert!(after.total() >= min_km, "{after:?} {min_km}");
    assert!(after.total() < 1.003 * min_km, "{after:?} {min_km}");
}

/// The shorter way around a zone at the edge of the area leads outside.
#[test]
fn a_taut_line_stays_in_the_area() {
    let (spec, mut world) = empty();
    let ends = (world.sites[0].start.at, world.sites[0].goal.at);
    let polygon = |corners: [(f64, f64); 4]| {
        let ring = corners.map(|(share, left_m)| {
            let at = left_of(ends, share, left_m);
            (at.east_m, at.north_m)
        });
        geo::Polygon::new(ring.to_vec().into(), Vec::new())
    };
    world.area = polygon([(-0.1, -20.0), (1.1, -20.0), (1.1, 900.0), (-0.1, 900.0)]);
    let block = polygon([(0.45, -15.0), (0.55, -15.0), (0.55, 60.0), (0.45, 60.0)]);
    world.zones = vec![PlanZone::closed(block).buffered(10.0)];
    with_context((&spec, &world), |context| {
        let around: Vec<EastNorth> = [0.0, 0.44, 0.45, 0.5, 0.55, 0.56, 1.0]
            .map(|share| {
                left_of(
                    ends,
                    share,
                    if share * (1.0 - share) > 0.2 {
                        80.0
                    } else {
                        0.0
                    },
                )
            })
            .to_vec();
        let (line, _) = taut_line(context, &finely(&around), 20.0).expect("a line");
        for bend in &line {
            let at = geo::Point::new(bend.at.east_m, bend.at.north_m);
            assert!(geo::Intersects::intersects(&world.area, &at), "{bend:?}");
        }
        let length_m = Line::new(line.iter().map(|bend| bend.at).collect()).length_m();
        assert!(length_m < Line::new(around).length_m(), "{length_m}");
    });
}

/// Corners of two walls, 20 m apart, with buffers of 10 m and turns of 10 m: the plain belt passes one of
/// them too near or turns too tightly.
#[test]
fn a_mended_belt_keeps_its_distance_and_its_radius() {
    const RADIUS_M: f64 = 10.0;
    let at = |east_m: f64, north_m: f64| EastNorth { east_m, north_m };
    let around = [
        (0.0, -60.0, 0.0),
        (0.0, 0.0, 10.0),
        (8.0, 0.0, 10.0),
        (34.0, -5.0, 10.0),
        (60.0, 40.0, 0.0),
    ];
    let bends = around.map(|(east_m, north_m, radius_m)| Bend {
        at: at(east_m, north_m),
        around: (at(east_m, north_m), radius_m),
        circles: 0.0,
    });
    let line: Vec<Bend> = outside(&bends);
    let free = Rounded::new(&line, RADIUS_M)
        .mend(RADIUS_M, 20.0)
        .expect("a belt");
    let misfits = |free: &[EastNorth]| {
        let all = [&[line[0].at], free, &[line[line.len() - 1].at]].concat();
        let basis = crate::numeric::Basis::uniform(all.len(), 30_001);
        let of =
            |axis: fn(&EastNorth) -> f64| basis.sampled(&all.iter().map(axis).collect::<Vec<_>>());
        let path: Vec<EastNorth> = (of(|at| at.east_m).into_iter().zip(of(|at| at.north_m)))
            .map(|(east_m, north_m)| at(east_m, north_m))
            .collect();
        let missing_m = line.iter().map(|bend| {
            let away_m = path.iter().map(|point| point.distance_m(bend.around.0));
            bend.around.1 - away_m.fold(f64::INFINITY, f64::min)
        });
        let tightest_m = path
            .windows(3)
            .map(mend::radius_of)
            .fold(f64::INFINITY, f64::min);
        (missing_m.fold(0.0, f64::max), RADIUS_M - tightest_m)
    };
    let plain = belt::controls(&line, &vec![1.03 * RADIUS_M; line.len()], 20.0).expect("a belt");
    let (missing_m, tighter_m) = misfits(&plain);
    assert!(
        missing_m > 0.02 || tighter_m > 0.02,
        "{missing_m} {tighter_m}"
    );
    let (missing_m, tighter_m) = misfits(&free);
    assert!(
        missing_m < 0.02 && tighter_m < 0.02,
        "{missing_m} {tighter_m}"
    );
}

/// Bends moved outward to their circles, halfway between the courses before and behind them.
fn outside(bends: &[Bend]) -> Vec<Bend> {
    let mut all = bends.to_vec();
    for (index, three) in bends.windows(3).enumerate() {
        let [before, here, after] = [0, 1, 2].map(|which| three[which].at);
        let unit = |a: EastNorth, b: EastNorth| {
            let length_m = a.distance_m(b);
            (
                (b.east_m - a.east_m) / length_m,
                (b.north_m - a.north_m) / length_m,
            )
        };
        let (into, out) = (unit(before, here), unit(here, after));
        let away = (into.0 - out.0, into.1 - out.1);
        let share = three[1].around.1 / away.0.hypot(away.1);
        all[index + 1].at = EastNorth {
            east_m: here.east_m + share * away.0,
            north_m: here.north_m + share * away.1,
        };
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_taut_path_costs_no_more_than_what_was_found_and_keeps_all_limits(
        threats in prop::collection::vec((0.15..0.85_f64, -300.0..300.0_f64, 30.0..250.0_f64), 1..6),
        by_m in -800.0..800.0_f64,
    ) {
        let (spec, mut world) = empty();
        let ends = (world.sites[0].start.at, world.sites[0].goal.at);
        let disc = |&(share, left_m, radius_m): &(f64, f64, f64)| Disc {
            center: left_of(ends, share, left_m),
            radius_m,
        };
        world.threats = threats.iter().map(disc).collect();
        with_context((&spec, &world), |context| {
            let found = swung(context, by_m);
            prop_assume!(found.strict.is_clean());
            let before = found.strict.total();
            let after = taut(context, found);
            prop_assert!(after.strict.is_clean());
            prop_assert!(after.strict.total() <= before);
            Ok(())
        })?;
    }
}
