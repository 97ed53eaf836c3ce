//! Paths in a layer over the ground, over the sea, and down to a drop.

use crate::support;

use sortie::dispatch::{Dispatched, dispatch};
use sortie::geodesy::{Agl, Amsl};
use sortie::plan::violations;
use sortie::spec::*;
use sortie::verify::Limit;
use support::plans::{EAST, WEST};
use support::{copter, empty_spec, place, world};

/// A copter from west to east past a hill, which the straight line crosses.
fn hilly(height_m: f64, radius_m: f64) -> MissionSpec {
    let middle = place(
        f64::midpoint(WEST.lat_deg, EAST.lat_deg),
        f64::midpoint(WEST.lon_deg, EAST.lon_deg),
    );
    over(vec![Hill {
        place: middle,
        height_m,
        radius_m,
    }])
}

/// A copter from west to east over hills on a plain.
fn over(hills: Vec<Hill>) -> MissionSpec {
    let mut spec = empty_spec(vec![copter("alpha", 1, WEST, EAST)]);
    let base = Amsl(400.0);
    spec.terrain = TerrainSource::Analytic { base, hills };
    spec
}

/// A ridge across the whole area, of hills from south to north.
fn ridge_of((count, apart_deg): (u32, f64), height_m: f64, radius_m: f64) -> MissionSpec {
    let hills = (0..count).map(|k| Hill {
        place: place(36.20 + apart_deg * f64::from(k), -84.25),
        height_m,
        radius_m,
    });
    over(hills.collect())
}

/// A ridge that a free path leaves high.
fn ridge() -> MissionSpec {
    ridge_of((51, 0.004), 80.0, 1000.0)
}

fn dispatched(spec: &MissionSpec) -> Dispatched {
    dispatch(spec, &world(spec), spec.planner.seed, &|_| ())
}

/// The greatest height above ground and the least altitude along the planned path, metres.
fn extremes_m(spec: &MissionSpec, of: &Dispatched) -> (f64, f64) {
    let world = world(spec);
    let path = &of.plan.vehicles[0].routes[0].path;
    let agl_m = |point: &sortie::geodesy::PlanPoint| {
        let place = world.frame.from_plan(point.at);
        point.amsl.0 - world.terrain.height(place).expect("known").0
    };
    let highest = path.iter().map(|timed| agl_m(&timed.point));
    let lowest = path.iter().map(|timed| timed.point.amsl.0);
    (
        highest.fold(f64::NEG_INFINITY, f64::max),
        lowest.fold(f64::INFINITY, f64::min),
    )
}

#[test]
fn a_path_stays_in_the_layer_between_least_and_greatest_height() {
    let mut spec = ridge();
    let free = dispatched(&spec);
    assert!(free.review.passes());
    let (highest_m, _) = extremes_m(&spec, &free);
    assert!(highest_m > 115.0, "{highest_m}");
    spec.vehicles[0].altitudes.max_agl = Some(Agl(115.0));
    let limited = dispatched(&spec);
    assert!(limited.review.passes(), "{:?}", limited.review.margins);
    let (highest_m, _) = extremes_m(&spec, &limited);
    assert!(highest_m <= 115.0, "{highest_m}");
    let margins = &limited.review.margins;
    assert!(
        margins
            .iter()
            .any(|margin| margin.limit == Limit::MaxHeight)
    );
    let (free, limited) = (&free.plan.vehicles[0], &limited.plan.vehicles[0]);
    assert!(limited.terms.total() >= limited.bound && limited.bound >= 0.0);
    assert!(limited.terms.total() >= 0.999 * free.terms.total());
}

#[test]
fn the_same_path_comes_again_from_the_same_seed() {
    let mut spec = ridge();
    spec.vehicles[0].altitudes.max_agl = Some(Agl(120.0));
    let (one, two) = (dispatched(&spec), dispatched(&spec));
    assert_eq!(one.missions, two.missions);
}

#[test]
fn a_path_keeps_the_least_altitude() {
    let mut spec = hilly(10.0, 1000.0);
    let end = EndPoint {
        place: WEST,
        altitude: Placement::Amsl(Amsl(650.0)),
    };
    spec.vehicles[0].start = end;
    spec.vehicles[0].goal = EndPoint { place: EAST, ..end };
    let (_, lowest_m) = extremes_m(&spec, &dispatched(&spec));
    assert!(lowest_m < 550.0, "{lowest_m}");
    spec.vehicles[0].altitudes.min_amsl = Some(Amsl(600.0));
    let limited = dispatched(&spec);
    assert!(limited.review.passes(), "{:?}", limited.review.margins);
    let (_, lowest_m) = extremes_m(&spec, &limited);
    assert!(lowest_m >= 600.0, "{lowest_m}");
}

#[test]
fn ground_too_steep_for_a_thin_layer_is_named() {
    // A wall across the whole area, steeper than any climb, and too little height above it to climb to and fro along it.
    let mut spec = ridge_of((60, 0.0035), 300.0, 350.0);
    spec.vehicles[0].altitudes.max_agl = Some(Agl(60.0));
    spec.planner.evaluations = 1000;
    let world = world(&spec);
    let failed = dispatched(&spec);
    assert!(!failed.review.passes());
    let found = violations(&spec, &world, &spec.vehicles[0], &failed.plan.vehicles[0]);
    let layer = found
        .iter()
        .find(|violation| violation.what.contains("greatest height"));
    let layer = layer.unwrap_or_else(|| panic!("{found:?}"));
    assert!(
        layer.how.contains("min_agl_m and max_agl_m close the way"),
        "{layer:?}"
    );
}

#[test]
fn a_goal_below_the_least_height_is_reached_from_above() {
    let mut spec = hilly(100.0, 2000.0);
    spec.vehicles[0].goal.altitude = Placement::Agl(Agl(3.0));
    let dropped = dispatched(&spec);
    assert!(dropped.review.passes(), "{:?}", dropped.review.margins);
    let last = dropped.plan.vehicles[0].routes[0]
        .path
        .last()
        .expect("a path");
    assert!((last.point.amsl.0 - 460.0).abs() < 1.0, "{last:?}");
}
