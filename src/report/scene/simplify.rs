//! Fewer points for the same motion, so that a fleet fits on one page.

/// A place in planning coordinates and time: east, north, altitude (m), time
/// (s), and the row of the item being flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::report) struct Fix {
    pub(in crate::report) east_m: f64,
    pub(in crate::report) north_m: f64,
    pub(in crate::report) amsl_m: f64,
    pub(in crate::report) t_s: f64,
    pub(in crate::report) item: usize,
}

/// Smallest tolerance, metres: below what a page can show.
const MIN_TOLERANCE_M: f64 = 0.1;

/// Fewer fixes for the same motion, and how far the motion between them is from any of the
/// others at most, metres.
///
/// The two ends, the last fix of every item, and the highest and lowest fix stay. The
/// tolerance grows from a decimetre until at most `max_fixes` are left, or only those.
pub(in crate::report) fn simplify(fixes: &[Fix], max_fixes: usize) -> (Vec<Fix>, f64) {
    let corners = corners(fixes);
    let max_fixes = max_fixes.max(corners.len());
    let mut tolerance_m = MIN_TOLERANCE_M;
    loop {
        let (simplified, error_m) = within(fixes, &corners, tolerance_m);
        if simplified.len() <= max_fixes || tolerance_m > 1e9 {
            return (simplified, error_m);
        }
        tolerance_m *= 1.6;
    }
}

/// Indices, ascending, of the fixes that stay.
fn corners(fixes: &[Fix]) -> Vec<usize> {
    let by_altitude = |a: &usize, b: &usize| fixes[*a].amsl_m.total_cmp(&fixes[*b].amsl_m);
    let item_ends = (1..fixes.len()).filter(|at| fixes[at - 1].item != fixes[*at].item);
    let mut corners: Vec<usize> = item_ends
        .map(|at| at - 1)
        .chain((0..fixes.len()).min_by(by_altitude))
        .chain((0..fixes.len()).max_by(by_altitude))
        .chain([0, fixes.len().saturating_sub(1)])
        .collect();
    corners.sort_unstable();
    corners.dedup();
    corners
}

/// Douglas and Peucker 1973 between the corners, with the distance taken at equal times, so
/// that speeds survive and not only the line. Also returns the largest error, metres.
fn within(fixes: &[Fix], corners: &[usize], tolerance_m: f64) -> (Vec<Fix>, f64) {
    let mut stays = vec![false; fixes.len()];
    corners
        .iter()
        .filter(|at| **at < fixes.len())
        .for_each(|at| stays[*at] = true);
    let mut open: Vec<(usize, usize)> = corners.windows(2).map(|two| (two[0], two[1])).collect();
    let mut largest_m: f64 = 0.0;
    while let Some((first, last)) = open.pop() {
        let errors = (first + 1..last)
            .map(|at| (at, error_m(&fixes[first], &fixes[at], &fixes[last])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        match errors {
            Some((at, error_m)) if error_m > tolerance_m => {
                stays[at] = true;
                open.extend([(first, at), (at, last)]);
            }
            Some((_, error_m)) => largest_m = largest_m.max(error_m),
            None => {}
        }
    }
    let simplified = fixes.iter().zip(stays);
    let simplified = simplified.filter_map(|(fix, stays)| stays.then_some(*fix));
    (simplified.collect(), largest_m)
}

/// How far a fix is from the straight motion between two others at its time.
fn error_m(from: &Fix, at: &Fix, to: &Fix) -> f64 {
    let span_s = to.t_s - from.t_s;
    let share = if span_s > 0.0 {
        (at.t_s - from.t_s) / span_s
    } else {
        0.0
    };
    let off = |a: f64, x: f64, b: f64| x - (a + (b - a) * share);
    off(from.east_m, at.east_m, to.east_m)
        .hypot(off(from.north_m, at.north_m, to.north_m))
        .hypot(off(from.amsl_m, at.amsl_m, to.amsl_m))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{Fix, simplify};

    fn fixes(motion: impl Fn(f64) -> (f64, f64)) -> Vec<Fix> {
        (0..=200)
            .map(|step| {
                let t_s = f64::from(step);
                let (east_m, north_m) = motion(t_s);
                Fix {
                    east_m,
                    north_m,
                    amsl_m: 100.0,
                    t_s,
                    item: 1,
                }
            })
            .collect()
    }

    /// Distance from a fix to the nearest of the legs, metres.
    fn distance_m(fix: &Fix, line: &[Fix]) -> f64 {
        let point = |fix: &Fix| nalgebra::Vector3::new(fix.east_m, fix.north_m, fix.amsl_m);
        let to_leg = |leg: &[Fix]| {
            let (from, to) = (point(&leg[0]), point(&leg[1]));
            let along = to - from;
            let u = (point(fix) - from).dot(&along) / along.norm_squared().max(1e-300);
            (from + along * u.clamp(0.0, 1.0) - point(fix)).norm()
        };
        line.windows(2).map(to_leg).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn steady_straight_flight_needs_its_ends_alone_but_a_stop_stays() {
        assert_eq!(simplify(&fixes(|t_s| (15.0 * t_s, 0.0)), 50).0.len(), 2);
        let stopping = fixes(|t_s| (15.0 * t_s.clamp(60.0, 120.0), 0.0));
        let (stopping, error_m) = simplify(&stopping, 50);
        let times: Vec<f64> = stopping.iter().map(|fix| fix.t_s).collect();
        assert_eq!(times, [0.0, 60.0, 120.0, 200.0]);
        assert!(error_m < 1e-9);
        assert_eq!(simplify(&[], 50), (Vec::new(), 0.0));
    }

    #[test]
    fn no_more_fixes_stay_than_allowed_and_the_ends_do() {
        let wavy = fixes(|t_s| (15.0 * t_s, 300.0 * (t_s / 7.0).sin()));
        let (few, error_m) = simplify(&wavy, 20);
        assert!(few.len() <= 20 && few.len() > 8, "{}", few.len());
        assert!(error_m > 1.0);
        assert_eq!((few[0], few[few.len() - 1]), (wavy[0], wavy[200]));
    }

    proptest! {
        #[test]
        fn every_fix_lies_within_the_error_of_the_simplified_track(
            steps in prop::collection::vec(
                (-200.0..200.0_f64, -200.0..200.0_f64, -30.0..30.0_f64, 0.0..60.0_f64, 0..2_usize),
                1..300,
            ),
            max_fixes in 2..100_usize,
        ) {
            let mut at = Fix { east_m: 0.0, north_m: 0.0, amsl_m: 300.0, t_s: 0.0, item: 1 };
            let track: Vec<Fix> = steps
                .iter()
                .map(|(east_m, north_m, up_m, time_s, items)| {
                    at.east_m += east_m;
                    at.north_m += north_m;
                    at.amsl_m += up_m;
                    at.t_s += time_s;
                    at.item += items;
                    at
                })
                .collect();
            let (simplified, error_m) = simplify(&track, max_fixes);
            let altitude_m = |fixes: &[Fix]| {
                let altitudes = fixes.iter().map(|fix| fix.amsl_m);
                altitudes.fold((f64::MAX, f64::MIN), |(a, b), z| (a.min(z), b.max(z)))
            };
            prop_assert_eq!(altitude_m(&track), altitude_m(&simplified));
            for (before, after) in track.iter().zip(&track[1..]) {
                prop_assert!(before.item == after.item || simplified.contains(before));
            }
            if simplified.len() > 1 {
                for fix in &track {
                    let off_m = distance_m(fix, &simplified);
                    prop_assert!(off_m <= error_m + 1e-6, "{} m of {} m", off_m, error_m);
                }
            }
        }
    }
}
