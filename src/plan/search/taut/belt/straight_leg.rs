//! Control points on a straight leg between two turns.

use super::Vector;

/// Steps behind an arc that are as long as those on it, before they grow.
const NEAR_STEPS: usize = 3;
/// The first step behind an arc is 0.85 to 1.7 times as long as those on it: with others the spline turns tighter.
const LONGER_STEP: f64 = 0.3;

/// Control points on a straight leg, near those at its ends as near as these are to each other, and
/// wider apart between them.
pub(super) fn leg(
    (begin, first_m): (Vector, f64),
    (end, last_m): (Vector, f64),
    span_m: f64,
) -> Vec<Vector> {
    let length_m = (end - begin).norm();
    let (mut from_m, mut to_m) = (vec![0.0], vec![length_m]);
    let (mut first_m, mut last_m) = (first_m.min(span_m), last_m.min(span_m));
    let (mut begun_m, mut left_m) = (0.0, length_m);
    let mut counts = [0, 0];
    while left_m - begun_m > first_m.min(last_m) * 2.0 && (first_m < span_m || last_m < span_m) {
        let (is_first, is_last) = (first_m <= last_m, last_m <= first_m);
        if is_first {
            begun_m += first_m;
            from_m.push(begun_m);
            first_m = grown_m(first_m, &mut counts[0], span_m);
        }
        if is_last {
            if left_m - begun_m > last_m {
                left_m -= last_m;
                to_m.push(left_m);
            }
            last_m = grown_m(last_m, &mut counts[1], span_m);
        }
    }
    let gap_m = left_m - begun_m;
    let pieces = gap_m / first_m.max(last_m).max(1e-3);
    // Points nearer to each other would turn tighter.
    let pieces = (if first_m < span_m {
        (pieces + LONGER_STEP).floor()
    } else {
        pieces.ceil()
    })
    .clamp(1.0, 1000.0);
    let mut all_m = from_m;
    let mut piece = 1.0;
    while piece < pieces {
        all_m.push(begun_m + gap_m * piece / pieces);
        piece += 1.0;
    }
    all_m.extend(to_m.into_iter().rev());
    let inner = all_m.len().saturating_sub(1);
    let along = (end - begin) / length_m.max(1e-9);
    all_m[1..inner].iter().map(|m| begin + along * *m).collect()
}

/// The next step from an arc: some are as long as those on it, then each is twice as long.
fn grown_m(step_m: f64, count: &mut usize, span_m: f64) -> f64 {
    *count += 1;
    if *count < NEAR_STEPS {
        return step_m;
    }
    (2.0 * step_m).min(span_m)
}
