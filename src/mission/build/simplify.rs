//! From a finely sampled path to as few waypoints as keep it.
//!
//! A copter rounds a waypoint on an arc of its turn radius `R` that touches both
//! legs. With a turn of `phi` the arc uses `R tan(phi/2)` of each leg and passes
//! the waypoint at `R (1/cos(phi/2) - 1)`. So waypoints must be far enough apart
//! for the arcs at both ends of a leg, and what an arc cuts off counts as leaving
//! the path, on top of what the legs themselves leave it.
//!
//! Altitudes are encoded in quarters of a metre, which makes a short leg steeper
//! than the path: legs that come out steeper than the vehicle may climb are avoided.

use super::legs::{Keep, Legs, Point, distance_m};

/// Share of the tolerance that the choice of candidates among the samples uses.
const CANDIDATE_SHARE: f64 = 0.05;
/// By how much less candidates leave the path in the plane where legs must stay closer to it and none fit:
/// legs of turns are short there, and arcs fit on them if they are of nearly the same length.
const FINER: f64 = 8.0;
/// Legs that miss the limits by less keep them, metres.
const MISFIT_M: f64 = 1e-3;

/// Indices of the samples that become waypoints: first and last, those of some indices in ascending
/// order, and others.
///
/// The fewest candidates whose legs and arcs keep the limits. Where none do, those that miss them
/// least, which the verdict rejects. The ends are flown from and to rest.
///
/// `strictness` is by how many times closer than the tolerance legs stay to each sample, at least 1;
/// where it is empty, 1.
pub(crate) fn waypoints(
    (path, strictness): (&[Point], &[f64]),
    through: &[usize],
    keep: &Keep,
) -> Vec<usize> {
    let fewest = |finer: f64| fewest((path, strictness), through, (keep, finer));
    let (found, misfit_m) = fewest(1.0);
    let is_strict = strictness.iter().any(|strict| *strict > 1.0);
    if misfit_m < MISFIT_M || !is_strict {
        return found;
    }
    let (finer, finer_misfit_m) = fewest(FINER);
    match finer_misfit_m < misfit_m {
        true => finer,
        false => found,
    }
}

/// The fewest candidates, and by how much their legs and arcs miss the limits, metres. Where legs must stay
/// closer to the path, candidates leave it in the plane by so much less.
fn fewest(
    (path, strictness): (&[Point], &[f64]),
    through: &[usize],
    (keep, finer): (&Keep, f64),
) -> (Vec<usize>, f64) {
    let slack_m = CANDIDATE_SHARE * keep.tolerance_m;
    let strict = |index: usize| strictness.get(index).copied().unwrap_or(1.0);
    let candidates = douglas_peucker((path, &strict), through, (slack_m, finer));
    let points: Vec<(Point, f64)> = candidates
        .iter()
        .map(|&index| (path[index], strict(index)))
        .collect();
    let is_needed = |index: &usize| through.binary_search(index).is_ok();
    let needed: Vec<bool> = candidates.iter().map(is_needed).collect();
    let (chosen, misfit_m) = Legs::new(&points, &needed, slack_m, keep).fewest();
    let chosen = chosen.into_iter().map(|index| candidates[index]);
    (chosen.collect(), misfit_m)
}

fn flat(point: Point) -> Point {
    Point::new(point.x, point.y, 0.0)
}

/// Indices of a subset of the samples within `tolerance_m` of every sample, some of them given.
fn douglas_peucker(
    (path, strict): (&[Point], &impl Fn(usize) -> f64),
    given: &[usize],
    (tolerance_m, finer): (f64, f64),
) -> Vec<usize> {
    let Some(last) = path.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut chosen = vec![0];
    chosen.extend(given);
    chosen.push(last);
    let mut open: Vec<(usize, usize)> = chosen.windows(2).map(|pair| (pair[0], pair[1])).collect();
    while let Some((from, to)) = open.pop() {
        let farthest = (from + 1..to)
            .map(|index| {
                let strict = strict(index);
                let away_m = distance_m(path[index], path[from], path[to]);
                let aside_m = match strict > 1.0 && finer > 1.0 {
                    true => finer * distance_m(flat(path[index]), flat(path[from]), flat(path[to])),
                    false => 0.0,
                };
                (index, strict * away_m.max(aside_m))
            })
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((index, deviation_m)) = farthest
            && deviation_m > tolerance_m
        {
            chosen.push(index);
            open.extend([(from, index), (index, to)]);
        }
    }
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesy::Amsl;
    use crate::path::VehicleLimits;
    use crate::spec::Vehicle;
    use crate::spec::fixtures::copter;
    use proptest::prelude::*;

    use crate::mission::build::encode::quarter_up;
    use crate::mission::build::legs::Corner;

    /// A copter at 15 m/s with 2.5 m/s^2, so 90 m, that may climb 15 degrees and descend 10.
    fn keep() -> Keep {
        Keep {
            tolerance_m: 5.0,
            limits: VehicleLimits::of(&Vehicle {
                speed_mps: 15.0,
                accel_mps2: 2.5,
                max_climb_rad: Some(15_f64.to_radians()),
                max_descent_rad: Some(10_f64.to_radians()),
                climb_mps: 5.0,
                descent_mps: 3.0,
                ..copter()
            }),
            zero: Some(Amsl(0.0)),
        }
    }

    fn simplified(path: &[Point]) -> Vec<Point> {
        waypoints((path, &[]), &[], &keep())
            .into_iter()
            .map(|index| path[index])
            .collect()
    }

    /// Metres of leg that remain between the arcs, the least over all legs.
    fn min_gap_m(points: &[Point]) -> f64 {
        let heading = |a: Point, b: Point| (b.y - a.y).atan2(b.x - a.x);
        let used = |index: usize| {
            if index == 0 || index + 1 == points.len() {
                return 0.0;
            }
            let turn = heading(points[index], points[index + 1])
                - heading(points[index - 1], points[index]);
            keep().limits.turn_radius_m * (turn.sin().atan2(turn.cos()).abs() / 2.0).tan()
        };
        (1..points.len())
            .map(|index| {
                let leg = points[index] - points[index - 1];
                leg.x.hypot(leg.y) - used(index - 1) - used(index)
            })
            .fold(f64::INFINITY, f64::min)
    }

    fn arc(radius_m: f64, turn_rad: f64, samples: u32) -> Vec<Point> {
        (0..=samples)
            .map(|index| {
                let at = turn_rad * f64::from(index) / f64::from(samples);
                Point::new(radius_m * at.sin(), radius_m * (1.0 - at.cos()), 500.0)
            })
            .collect()
    }

    #[test]
    fn where_a_path_is_strict_its_legs_stay_closer() {
        // A long swell, strict in its second half.
        let path: Vec<Point> = (0..=400)
            .map(|i| {
                let along = f64::from(i) * 10.0;
                Point::new(along, 0.0, 500.0 + 30.0 * (along / 500.0).sin())
            })
            .collect();
        let strictness: Vec<f64> = (0..=400).map(|i| if i < 200 { 1.0 } else { 5.0 }).collect();
        let worst_m = |strictness: &[f64], from: usize| {
            let chosen = waypoints((&path, strictness), &[], &keep());
            let legs = chosen.windows(2).flat_map(|leg| {
                let (a, b) = (leg[0], leg[1]);
                (a..b).map(move |index| (index, a, b))
            });
            let strict = legs.filter(|(index, ..)| *index >= from);
            let away_m = strict.map(|(index, a, b)| distance_m(path[index], path[a], path[b]));
            away_m.fold(0.0, f64::max)
        };
        assert!(worst_m(&[], 200) > 2.0);
        assert!(worst_m(&strictness, 200) <= 1.0);
        assert!(worst_m(&strictness, 0) > 2.0);
    }

    #[test]
    fn a_straight_path_is_two_waypoints() {
        let path: Vec<Point> = (0..=100)
            .map(|i| Point::new(f64::from(i) * 10.0, f64::from(i) * 3.0, 500.0))
            .collect();
        assert_eq!(waypoints((&path, &[]), &[], &keep()), [0, 100]);
    }

    #[test]
    fn a_bend_in_height_alone_gets_a_waypoint_at_the_bend() {
        let path: Vec<Point> = (0..=100)
            .map(|i| Point::new(f64::from(i) * 10.0, 0.0, 500.0 + f64::from((i - 50).max(0))))
            .collect();
        let chosen = waypoints((&path, &[]), &[], &keep());
        assert_eq!(chosen.len(), 3);
        assert!(chosen[1].abs_diff(50) <= 10, "bend at {}", chosen[1]);
    }

    #[test]
    fn an_arc_needs_about_as_many_legs_as_chord_and_cut_allow() {
        // Deviation plus cut is (r + R)(1 - cos(phi/2)) to second order: 5 m at phi = 18.3 degrees.
        let chosen = simplified(&arc(300.0, std::f64::consts::PI, 2000));
        assert!(
            (11..=13).contains(&chosen.len()),
            "{} waypoints",
            chosen.len()
        );
        assert!(min_gap_m(&chosen) >= -1e-9);
    }

    #[test]
    fn an_arc_hardly_wider_than_the_turn_radius_is_refined_until_it_fits() {
        let chosen = simplified(&arc(92.0, std::f64::consts::PI, 2000));
        assert!(min_gap_m(&chosen) >= -1e-6, "gap {}", min_gap_m(&chosen));
    }

    /// The most that a leg as encoded rises beyond a slope, metres.
    fn max_over_m(points: &[Point], slope: f64) -> f64 {
        let encoded_m = |point: &Point| f64::from(quarter_up(point.z));
        points
            .windows(2)
            .map(|leg| {
                let along = leg[1] - leg[0];
                encoded_m(&leg[1]) - encoded_m(&leg[0]) - slope * along.x.hypot(along.y)
            })
            .fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn short_legs_of_a_climb_near_the_limit_are_not_encoded_steeper_than_it() {
        // A small tolerance makes legs short, so that a quarter of a metre matters.
        let keep = Keep {
            tolerance_m: 0.6,
            ..keep()
        };
        for slope in [0.26, 0.262, 0.264] {
            let mut path = arc(300.0, std::f64::consts::PI, 4000);
            for (point, step) in path.iter_mut().zip(0_u16..) {
                let run_m = 300.0 * std::f64::consts::PI * f64::from(step) / 4000.0;
                point.z = 500.1 + slope * run_m;
            }
            let chosen: Vec<Point> = waypoints((&path, &[]), &[], &keep)
                .into_iter()
                .map(|index| path[index])
                .collect();
            assert!(min_gap_m(&chosen) >= -1e-6);
            let over_m = max_over_m(&chosen, 15_f64.to_radians().tan());
            assert!(over_m < 0.02, "{slope}: {over_m} m");
        }
    }

    #[test]
    fn a_turn_that_cannot_be_flown_still_yields_a_mission_through_both_ends() {
        let path = [
            Point::new(0.0, 0.0, 500.0),
            Point::new(30.0, 0.0, 500.0),
            Point::new(0.0, 1.0, 500.0),
        ];
        assert_eq!(waypoints((&path, &[]), &[], &keep()), [0, 1, 2]);
    }

    #[test]
    fn no_shorter_choice_of_samples_keeps_the_same_limits() {
        // Every subset of a small path, one by one.
        let path: Vec<Point> = (0..12)
            .map(|i| {
                let at = f64::from(i) * 60.0;
                Point::new(
                    at,
                    25.0 * (at / 180.0).sin(),
                    500.0 + 8.0 * (at / 100.0).cos(),
                )
            })
            .collect();
        let fits = |subset: &[usize]| {
            let deviation = |a: usize, b: usize| {
                (a + 1..b)
                    .map(|i| distance_m(path[i], path[a], path[b]))
                    .fold(0.0, f64::max)
            };
            let points: Vec<Point> = subset.iter().map(|&i| path[i]).collect();
            let heading = |a: usize, b: usize| {
                let along = path[b] - path[a];
                along.y.atan2(along.x)
            };
            let corners = subset.windows(3).all(|three| {
                let turn_rad = heading(three[1], three[2]) - heading(three[0], three[1]);
                let corner = Corner::of(turn_rad, keep().limits.turn_radius_m);
                let worst = deviation(three[0], three[1]).max(deviation(three[1], three[2]));
                corner.cut_m + worst <= keep().tolerance_m
            });
            corners
                && subset
                    .windows(2)
                    .all(|two| deviation(two[0], two[1]) <= keep().tolerance_m)
                && min_gap_m(&points) >= 0.0
        };
        let fewest = (0_u32..1 << 10)
            .map(|bits| {
                let mut subset = vec![0];
                subset.extend((1..11).filter(|i| bits >> (i - 1) & 1 == 1));
                subset.push(11);
                subset
            })
            .filter(|subset| fits(subset))
            .map(|subset| subset.len())
            .min();
        // The choice of candidates takes a twentieth of the tolerance; this path has no choice that close to it.
        assert_eq!(Some(waypoints((&path, &[]), &[], &keep()).len()), fewest);
    }

    proptest! {
        #[test]
        fn no_sample_is_further_from_the_legs_than_the_tolerance(
            steps in prop::collection::vec((10.0..200.0_f64, -0.5..0.5_f64, -20.0..20.0_f64), 1..60)
        ) {
            let mut path = vec![Point::new(0.0, 0.0, 500.0)];
            let mut heading = 0.0_f64;
            for (length, turn, climb) in steps {
                heading += turn;
                let last = path[path.len() - 1];
                path.push(last + Point::new(length * heading.cos(), length * heading.sin(), climb));
            }
            let chosen = waypoints((&path, &[]), &[], &keep());
            prop_assert_eq!((chosen[0], chosen[chosen.len() - 1]), (0, path.len() - 1));
            for leg in chosen.windows(2) {
                for index in leg[0]..=leg[1] {
                    prop_assert!(distance_m(path[index], path[leg[0]], path[leg[1]]) <= keep().tolerance_m);
                }
            }
        }
    }
}
