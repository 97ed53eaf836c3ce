//! Laws of taut paths, and a corner whose shortest way is known.

use std::path::Path;

use proptest::prelude::*;

use super::*;
use crate::cost::{EarlierFlights, Margins, RouteEnds};
use crate::geodesy::{Amsl, EastNorth};
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
