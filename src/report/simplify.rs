//! Fewer points for the same motion, so that a fleet fits on one page.

/// A place in planning coordinates and time: east, north, altitude (m), time
/// (s), and the row of the item being flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fix {
    pub(super) east_m: f64,
    pub(super) north_m: f64,
    pub(super) amsl_m: f64,
    pub(super) t_s: f64,
    pub(super) item: usize,
}

/// Finest error that is kept, metres: below what a page can show.
const FINEST_M: f64 = 0.1;

/// At most `most` fixes (never fewer than the two ends) that keep the motion.
/// The error allowed grows from a decimetre until they are few enough. The last
/// fix of every item stays, as long as those are few. Also tells the error
/// allowed in the end, metres.
pub(super) fn thin(fixes: &[Fix], most: usize) -> (Vec<Fix>, f64) {
    let mut turns: Vec<usize> = (1..fixes.len())
        .filter(|at| fixes[at - 1].item != fixes[*at].item)
        .map(|at| at - 1)
        .collect();
    if turns.len() > most / 2 {
        turns.clear();
    }
    let mut allowed_m = FINEST_M;
    loop {
        let kept = keep(fixes, &turns, allowed_m);
        if kept.len() <= most.max(2) || allowed_m > 1e9 {
            return (kept, allowed_m);
        }
        allowed_m *= 1.6;
    }
}

/// Douglas and Peucker 1973, with the distance taken at equal times, so that
/// speeds survive and not only the line.
fn keep(fixes: &[Fix], turns: &[usize], allowed_m: f64) -> Vec<Fix> {
    if fixes.len() < 3 {
        return fixes.to_vec();
    }
    let mut kept = vec![false; fixes.len()];
    kept[0] = true;
    kept[fixes.len() - 1] = true;
    let mut open = Vec::new();
    let mut first = 0;
    for last in turns.iter().copied().chain([fixes.len() - 1]) {
        kept[last] = true;
        open.push((first, last));
        first = last;
    }
    while let Some((first, last)) = open.pop() {
        let worst = (first + 1..last)
            .map(|at| (at, error_m(&fixes[first], &fixes[at], &fixes[last])))
            .fold(
                (0, allowed_m),
                |worst, next| {
                    if next.1 > worst.1 { next } else { worst }
                },
            );
        if worst.1 > allowed_m {
            kept[worst.0] = true;
            open.push((first, worst.0));
            open.push((worst.0, last));
        }
    }
    fixes
        .iter()
        .zip(kept)
        .filter_map(|(fix, keep)| keep.then_some(*fix))
        .collect()
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
    use super::{Fix, thin};

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

    #[test]
    fn steady_straight_flight_needs_its_ends_alone_but_a_stop_is_kept() {
        assert_eq!(thin(&fixes(|t_s| (15.0 * t_s, 0.0)), 50).0.len(), 2);
        let (stopping, allowed_m) = thin(&fixes(|t_s| (15.0 * t_s.clamp(60.0, 120.0), 0.0)), 50);
        let times: Vec<f64> = stopping.iter().map(|fix| fix.t_s).collect();
        assert_eq!(times, [0.0, 60.0, 120.0, 200.0]);
        assert!((allowed_m - 0.1).abs() < 1e-12);
    }

    #[test]
    fn no_more_fixes_are_left_than_allowed_and_the_ends_stay() {
        let wavy = fixes(|t_s| (15.0 * t_s, 300.0 * (t_s / 7.0).sin()));
        let (few, allowed_m) = thin(&wavy, 20);
        assert!(few.len() <= 20 && few.len() > 8, "{}", few.len());
        assert!(allowed_m > 1.0);
        assert_eq!((few[0], few[few.len() - 1]), (wavy[0], wavy[200]));
    }
}
