//! The verdict against dense sampling by simple code of its own: sampling never finds
//! anything worse than was reported, and not anything much better either.

use crate::support;
use crate::support::missions;
use missions::{land, mission, speed, takeoff, waypoint};
use proptest::prelude::*;
use sortie::autopilot::{CornerLaw, Cornering, Turn};
use sortie::geodesy::{Amsl, EastNorth, LatLon, LocalFrame, PlanPoint};
use sortie::mission::VehicleMission;
use sortie::numeric::SpeedProfile;
use sortie::spec::*;
use sortie::verify::{Limit, Review, review};
use sortie::world::{Terrain, TerrainGrid, World};
use support::{copter, empty_spec, place};

const SPEED_MPS: f64 = 15.0;
const ACCEL_MPS2: f64 = 2.5;
/// Default of `WPNAV_RADIUS`.
const ACCEPT_M: f64 = 2.0;
/// Between samples: in space they are looked at alone, in time the straight line between two
/// is flown, which cuts an arc by the square of this over eight radii, a third of a millimetre.
const STEP_M: f64 = 2.0;
const FINE_STEP_M: f64 = 0.5;
/// Behind its stop over the goal a vehicle may be late by as much as this, in steps of time.
const LATE_STEPS: usize = 18;
const EVERY_S: f64 = 0.25;

/// A corner of a random mission: leg length, change of course, altitude.
type Bend = (f64, f64, f64);

fn bends() -> impl Strategy<Value = (f64, f64, f64, Vec<Bend>)> {
    let bend = (500.0..1500.0, -1.1..1.1, 560.0..720.0_f64);
    (
        -1500.0..1500.0,
        -1500.0..1500.0,
        0.0..std::f64::consts::TAU,
        prop::collection::vec(bend, 2..6),
    )
}

/// The points of a random mission, in whole quarters of a metre and 1e-7 degrees.
fn points(
    frame: &LocalFrame,
    (east_m, north_m, course, bends): &(f64, f64, f64, Vec<Bend>),
) -> Vec<(LatLon, f64)> {
    let (mut at, mut course) = (
        EastNorth {
            east_m: *east_m,
            north_m: *north_m,
        },
        *course,
    );
    let mut points = vec![(at, 640.0)];
    for (length_m, turn, amsl_m) in bends {
        course += turn;
        at = EastNorth {
            east_m: at.east_m + length_m * course.cos(),
            north_m: at.north_m + length_m * course.sin(),
        };
        points.push((at, *amsl_m));
    }
    let round = |deg: f64| (deg * 1e7).round() / 1e7;
    points
        .into_iter()
        .map(|(at, amsl_m)| {
            let LatLon { lat_deg, lon_deg } = frame.from_plan(at);
            (
                place(round(lat_deg), round(lon_deg)),
                (amsl_m * 4.0).round() / 4.0,
            )
        })
        .collect()
}

/// Samples of the horizontal flight, at most `step_m` apart: legs with their corners rounded as far
/// as the flown law of corners says.
fn rounded(frame: &LocalFrame, points: &[(LatLon, f64)], step_m: f64) -> Vec<PlanPoint> {
    let knots: Vec<PlanPoint> = points
        .iter()
        .map(|(place, amsl_m)| PlanPoint {
            at: frame.to_plan(*place),
            amsl: Amsl(*amsl_m),
        })
        .collect();
    let mut samples = Vec::new();
    let mut from = knots[0];
    for trio in knots.windows(3) {
        let (into, out) = (unit(trio[0], trio[1]), unit(trio[1], trio[2]));
        let turn = (into.0 * out.1 - into.1 * out.0).atan2(into.0 * out.0 + into.1 * out.1);
        let corner = Turn {
            angle_rad: turn.abs(),
            speed_mps: SPEED_MPS,
            radius_m: ACCEPT_M,
        };
        let cut_m = Cornering::new(CornerLaw::Overlap, ACCEL_MPS2).taken_m(&corner);
        let radius_m = cut_m / (0.5 * turn.abs()).tan();
        let entry = between(trio[1], trio[0], cut_m);
        let exit = between(trio[1], trio[2], cut_m);
        line(from, entry, step_m, &mut samples);
        // The centre lies on the bisector; the arc is the pencil of directions between the ends.
        let (bx, by) = (out.0 - into.0, out.1 - into.1);
        let scale = radius_m / (0.5 * turn).cos() / bx.hypot(by).max(1e-12);
        let centre = (
            trio[1].at.east_m + bx * scale,
            trio[1].at.north_m + by * scale,
        );
        let start = (entry.at.north_m - centre.1).atan2(entry.at.east_m - centre.0);
        let count = (radius_m * turn.abs() / step_m).ceil().max(1.0);
        let mut index = 0.0;
        while index < count {
            let share = index / count;
            let angle = start + turn * share;
            samples.push(PlanPoint::new(
                centre.0 + radius_m * angle.cos(),
                centre.1 + radius_m * angle.sin(),
                Amsl(entry.amsl.0 + (exit.amsl.0 - entry.amsl.0) * share),
            ));
            index += 1.0;
        }
        from = exit;
    }
    line(from, knots[knots.len() - 1], step_m, &mut samples);
    samples.push(knots[knots.len() - 1]);
    samples
}

/// Samples of the legs as far as their corners.
fn legs(frame: &LocalFrame, points: &[(LatLon, f64)]) -> Vec<PlanPoint> {
    let mut samples = Vec::new();
    for pair in points.windows(2) {
        let knot = |(place, amsl_m): (LatLon, f64)| PlanPoint {
            at: frame.to_plan(place),
            amsl: Amsl(amsl_m),
        };
        line(knot(pair[0]), knot(pair[1]), STEP_M, &mut samples);
    }
    samples
}

fn unit(a: PlanPoint, b: PlanPoint) -> (f64, f64) {
    let length_m = a.at.distance_m(b.at);
    (
        (b.at.east_m - a.at.east_m) / length_m,
        (b.at.north_m - a.at.north_m) / length_m,
    )
}

/// The point so far from `a` toward `b`.
fn between(a: PlanPoint, b: PlanPoint, from_a_m: f64) -> PlanPoint {
    mix(a, b, from_a_m / a.at.distance_m(b.at))
}

fn mix(a: PlanPoint, b: PlanPoint, share: f64) -> PlanPoint {
    PlanPoint::new(
        a.at.east_m + (b.at.east_m - a.at.east_m) * share,
        a.at.north_m + (b.at.north_m - a.at.north_m) * share,
        Amsl(a.amsl.0 + (b.amsl.0 - a.amsl.0) * share),
    )
}

fn line(a: PlanPoint, b: PlanPoint, step_m: f64, samples: &mut Vec<PlanPoint>) {
    let count = (a.at.distance_m(b.at) / step_m).ceil().max(1.0);
    let mut index = 0.0;
    while index < count {
        samples.push(mix(a, b, index / count));
        index += 1.0;
    }
}

/// Where the vehicle is at every step from takeoff to touchdown, and the first step behind its stop.
fn timed(points: &[(LatLon, f64)], frame: &LocalFrame, ground_m: f64) -> (Vec<PlanPoint>, usize) {
    let path = rounded(frame, points, FINE_STEP_M);
    let mut along_m = vec![0.0];
    for pair in path.windows(2) {
        along_m.push(along_m[along_m.len() - 1] + pair[0].at.distance_m(pair[1].at));
    }
    let length_m = along_m[along_m.len() - 1];
    let profile = SpeedProfile::new(length_m, SPEED_MPS, ACCEL_MPS2);
    let (first, last) = (path[0], path[path.len() - 1]);
    let up_s = (first.amsl.0 - ground_m) / 5.0;
    let down_s = (last.amsl.0 - ground_m - 10.0) / 3.0;
    let end_s = up_s + profile.duration_s() + down_s + 20.0;
    let mut samples = Vec::new();
    let (mut t_s, mut next, mut stop) = (0.0, 0, 0);
    while t_s <= end_s {
        let level_s = t_s - up_s;
        let falling_s = level_s - profile.duration_s();
        samples.push(if level_s < 0.0 {
            PlanPoint {
                amsl: Amsl(ground_m + 5.0 * t_s),
                ..first
            }
        } else if falling_s < 0.0 {
            let s_m = profile.distance_at_m(level_s);
            while next + 2 < path.len() && along_m[next + 1] < s_m {
                next += 1;
            }
            stop = samples.len() + 1;
            let share = (s_m - along_m[next]) / (along_m[next + 1] - along_m[next]);
            mix(path[next], path[next + 1], share)
        } else if falling_s < down_s {
            PlanPoint {
                amsl: Amsl(last.amsl.0 - 3.0 * falling_s),
                ..last
            }
        } else {
            PlanPoint {
                amsl: Amsl(ground_m + 10.0 - 0.5 * (falling_s - down_s)),
                ..last
            }
        });
        t_s += EVERY_S;
    }
    (samples, stop)
}

/// The nearest that two come if either is later than the other by so many steps, and behind
/// its stop by more.
fn together_m(
    (one, one_stop): &(Vec<PlanPoint>, usize),
    (other, other_stop): &(Vec<PlanPoint>, usize),
    slack_steps: usize,
) -> f64 {
    let later = |step, stop| slack_steps + if step >= stop { LATE_STEPS } else { 0 };
    let pairs = one.iter().enumerate().flat_map(|(here, place)| {
        let from = here.saturating_sub(slack_steps + LATE_STEPS);
        let until = (here + later(here, *one_stop)).min(other.len().saturating_sub(1));
        (from..=until)
            .filter(move |&there| there + later(there, *other_stop) >= here)
            .map(move |there| place.distance_m(other[there]))
    });
    least(pairs)
}

fn encoded(vehicle: &Vehicle, home_m: f64, points: &[(LatLon, f64)]) -> VehicleMission {
    let mut items = vec![takeoff(points[0].0, points[0].1), speed(15.0)];
    items.extend(
        points[1..]
            .iter()
            .map(|&(place, amsl_m)| waypoint(place, amsl_m)),
    );
    items.push(land(points[points.len() - 1].0));
    mission(vehicle, home_m, items)
}

/// A vehicle whose start and goal are the ends of the points.
fn flyer(id: &str, sysid: u8, points: &[(LatLon, f64)]) -> Vehicle {
    let end = |(place, amsl_m): (LatLon, f64)| EndPoint {
        place,
        altitude: Placement::Amsl(Amsl(amsl_m)),
    };
    let mut vehicle = copter(id, sysid, points[0].0, points[points.len() - 1].0);
    vehicle.start = end(points[0]);
    vehicle.goal = end(points[points.len() - 1]);
    vehicle
}

fn hills() -> Terrain {
    let hill = |lat, lon, height_m, radius_m| Hill {
        place: place(lat, lon),
        height_m,
        radius_m,
    };
    Terrain::Analytic {
        base: Amsl(400.0),
        hills: vec![
            hill(36.30, -84.25, 90.0, 500.0),
            hill(36.31, -84.27, 150.0, 900.0),
            hill(36.29, -84.22, 120.0, 300.0),
            hill(36.32, -84.24, 140.0, 250.0),
        ],
    }
}

/// Rough ground on a grid of 3 arc seconds, every node its own height.
fn rough() -> Terrain {
    let (rows, columns) = (241_u32, 301_u32);
    let mut heights_m = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (x, y) = (f64::from(column), f64::from(row));
            let wave = (x * 0.13).sin() * 50.0 + (y * 0.17 + x * 0.05).sin() * 40.0;
            let noise = (x * 12.9898 + y * 78.233).sin() * 43_758.545_3;
            #[expect(clippy::cast_possible_truncation, reason = "grids are float32")]
            heights_m.push((450.0 + wave + 25.0 * (noise - noise.floor())) as f32);
        }
    }
    Terrain::Grid(TerrainGrid {
        raised_m: 0.0,
        north_west: place(36.40, -84.375),
        row_step_deg: 1.0 / 1200.0,
        column_step_deg: 1.0 / 1200.0,
        rows: 241,
        columns: 301,
        heights_m,
    })
}

fn value(review: &Review, limit: Limit) -> f64 {
    review
        .margins
        .iter()
        .find(|margin| margin.limit == limit)
        .unwrap_or_else(|| panic!("no margin {limit} among {:#?}", review.margins))
        .value
}

/// The least of many values.
fn least(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::INFINITY, f64::min)
}

/// Sampling finds nothing worse, and nothing better by more than `loose`.
fn agree(reported: f64, sampled: f64, loose: f64) -> Result<(), TestCaseError> {
    prop_assert!(
        reported <= sampled + 0.002,
        "reported {reported}, sampling found {sampled}"
    );
    prop_assert!(
        reported >= sampled - loose,
        "reported {reported}, sampling found only {sampled}"
    );
    Ok(())
}

fn compare_in_space(
    terrain: Terrain,
    shape: &(f64, f64, f64, Vec<Bend>),
    rough_m: f64,
) -> Result<(), TestCaseError> {
    let frame = LocalFrame::new(place(36.30, -84.25));
    let points = points(&frame, shape);
    let mut spec = empty_spec(vec![flyer("alpha", 1, &points)]);
    let axis = place(36.305, -84.262);
    spec.threats.push(Threat {
        id: "radar".to_owned(),
        kind: String::new(),
        place: axis,
        radius_m: 700.0,
    });
    let ground_m = terrain.height(points[0].0).expect("ground at home").0;
    let world = World::new(&spec, terrain).expect("ground at the stations");
    let mission = encoded(&spec.vehicles[0], ground_m, &points);
    let review = review(&spec, &world, &[(0, &mission)]);
    let mut samples = rounded(&frame, &points, STEP_M);
    samples.extend(legs(&frame, &points));
    let above_m = |sample: &PlanPoint| {
        let ground = world
            .terrain
            .height(frame.from_plan(sample.at))
            .expect("ground on the way");
        sample.amsl.0 - ground.0
    };
    agree(
        value(&review, Limit::TerrainClearance),
        least(samples.iter().map(above_m)),
        rough_m,
    )?;
    let around = LocalFrame::new(axis);
    let outside_m = |sample: &PlanPoint| {
        let at = around.to_plan(frame.from_plan(sample.at));
        at.east_m.hypot(at.north_m) - 700.0
    };
    agree(
        value(&review, Limit::Threat("radar".to_owned())),
        least(samples.iter().map(outside_m)),
        1.0,
    )
}

fn compare_in_time(
    one: &(f64, f64, f64, Vec<Bend>),
    two: &(f64, f64, f64, Vec<Bend>),
    slack_s: f64,
) -> Result<(), TestCaseError> {
    let ground_m = 400.0;
    let frame = LocalFrame::new(place(36.30, -84.25));
    // Straight on: copters slow down for corners, which the second implementation times.
    let ends = |points: Vec<(LatLon, f64)>| vec![points[0], points[points.len() - 1]];
    let (first, second) = (ends(points(&frame, one)), ends(points(&frame, two)));
    let mut spec = empty_spec(vec![flyer("alpha", 1, &first), flyer("beta", 2, &second)]);
    spec.separation.time_slack_s = slack_s;
    let world = World::new(&spec, Terrain::Flat(Amsl(ground_m))).expect("flat");
    let missions = [
        encoded(&spec.vehicles[0], ground_m, &first),
        encoded(&spec.vehicles[1], ground_m, &second),
    ];
    let review = review(&spec, &world, &[(0, &missions[0]), (1, &missions[1])]);
    let [one, other] = [&first, &second].map(|points| timed(points, &frame, ground_m));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole steps of a few seconds"
    )]
    let slack_steps = (slack_s / EVERY_S) as usize;
    let found_m = together_m(&one, &other, slack_steps);
    // Both move at most 15 m/s across and 5 up, and meet at most half a step from a sample.
    agree(
        value(&review, Limit::Separation),
        found_m,
        2.0 * 15.9 * 0.5 * EVERY_S + 0.2,
    )
}

#[test]
fn a_vehicle_that_lands_is_late_behind_its_stop() {
    // Beta comes down beside alpha's route: late by its stop it is nearer.
    let alpha = vec![
        (500.0, 1.089_730_829_770_374, 560.0),
        (1_099.498_203_760_75, 0.0, 560.0),
        (999.583_310_927_542_8, 0.0, 560.0),
    ];
    let beta = vec![(500.0, 0.893_941_363_358_851, 560.0), (500.0, 0.0, 560.0)];
    let alpha = (0.0, 1_319.818_419_793_021_8, 4.097_264_302_931_427, alpha);
    let beta = (0.0, 0.0, 5.216_669_152_386_733, beta);
    compare_in_time(&alpha, &beta, 0.0).expect("one separation");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn sampling_over_hills_agrees_with_the_verdict(shape in bends()) {
        compare_in_space(hills(), &shape, 0.1)?;
    }

    #[test]
    fn sampling_over_a_rough_grid_agrees_with_the_verdict(shape in bends()) {
        compare_in_space(rough(), &shape, 0.5)?;
    }

    #[test]
    fn sampling_in_time_agrees_with_the_separation_of_the_verdict(
        one in bends(),
        two in bends(),
        slack_s in prop::sample::select(vec![0.0, 0.25, 5.0, 20.0]),
    ) {
        compare_in_time(&one, &two, slack_s)?;
    }
}
