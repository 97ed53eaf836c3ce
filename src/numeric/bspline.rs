//! Clamped uniform cubic B-splines (section 3 of the paper's path representation).

/// `samples` parameters, evenly spread from exactly 0 to exactly 1; at least 2.
#[must_use]
pub fn uniform_parameters(samples: usize) -> Vec<f64> {
    let last = samples.max(2) - 1;
    #[expect(clippy::cast_precision_loss, reason = "far fewer than 2^52 samples")]
    let at = |index: usize| index as f64 / last as f64;
    (0..=last).map(at).collect()
}

/// The basis of a clamped uniform cubic B-spline at fixed parameters.
///
/// Every row has four weights that are at least 0 and sum to 1, so a curve
/// stays in the hull of its control points; at parameters 0 and 1 it is exactly
/// the first and the last of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    control_points: usize,
    first: Vec<usize>,
    /// The four weights of a row stand in four columns, so that rows which share
    /// their control points are worked off side by side.
    weights: [Vec<f64>; 4],
}

impl Basis {
    /// The basis of `control_points` points, ends included, at ascending `parameters` in `[0, 1]`.
    ///
    /// # Panics
    /// With fewer than 4 control points: there is no cubic through them. A
    /// checked spec has at least 2 free ones.
    #[must_use]
    pub fn new(control_points: usize, parameters: &[f64]) -> Self {
        assert!(control_points >= 4, "a cubic needs 4 control points");
        let mut basis = Self {
            control_points,
            first: Vec::with_capacity(parameters.len()),
            weights: [(); 4].map(|()| Vec::with_capacity(parameters.len())),
        };
        for &parameter in parameters {
            let (first, weights) = row(control_points, parameter);
            basis.first.push(first);
            for (column, weight) in basis.weights.iter_mut().zip(weights) {
                column.push(weight);
            }
        }
        basis
    }

    /// The basis at [`uniform_parameters`].
    ///
    /// # Panics
    /// As [`Self::new`].
    #[must_use]
    pub fn uniform(control_points: usize, samples: usize) -> Self {
        Self::new(control_points, &uniform_parameters(samples))
    }

    /// The basis at every `step`-th parameter, the first included.
    #[must_use]
    pub fn every(&self, step: usize) -> Self {
        let weights = [0, 1, 2, 3].map(|i| self.weights[i].iter().copied().step_by(step).collect());
        Self {
            control_points: self.control_points,
            first: self.first.iter().copied().step_by(step).collect(),
            weights,
        }
    }

    /// Number of parameters.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.first.len()
    }

    /// Number of control points, ends included.
    #[must_use]
    pub fn control_points(&self) -> usize {
        self.control_points
    }

    /// First control point that counts at sample `k`, and the weights of it and the next three.
    ///
    /// # Panics
    /// When `k` is not a sample.
    #[must_use]
    pub fn row(&self, k: usize) -> (usize, [f64; 4]) {
        (self.first[k], [0, 1, 2, 3].map(|i| self.weights[i][k]))
    }

    /// [`Self::apply`] into a new vector.
    ///
    /// # Panics
    /// When `values` has fewer than [`Self::control_points`] numbers.
    #[must_use]
    pub fn sampled(&self, values: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.samples()];
        self.apply(values, &mut out);
        out
    }

    /// One coordinate of the curve at all samples, from that of the control points.
    ///
    /// # Panics
    /// When `values` has fewer than [`Self::control_points`] numbers.
    pub fn apply(&self, values: &[f64], out: &mut [f64]) {
        let mut from = 0;
        for span in self.first.chunk_by(|a, b| a == b) {
            let to = (from + span.len()).min(out.len());
            let first = span[0];
            let (a, b) = (values[first], values[first + 1]);
            let (c, d) = (values[first + 2], values[first + 3]);
            let [wa, wb, wc, wd] = [0, 1, 2, 3].map(|i| &self.weights[i][from..to]);
            for ((((out, wa), wb), wc), wd) in
                out[from..to].iter_mut().zip(wa).zip(wb).zip(wc).zip(wd)
            {
                *out = wa * a + wb * b + wc * c + wd * d;
            }
            from = to;
        }
    }
}

/// The control points, one coordinate of them, of the same curve with each span halved (Boehm
/// 1980: knots are put in one after the other).
#[must_use]
pub fn halved(control_points: &[f64]) -> Vec<f64> {
    let spans = control_points.len().saturating_sub(3);
    let mut knots = knots(spans);
    let mut points = control_points.to_vec();
    for span in 0..spans {
        // Each span before this one has one more knot by now.
        let last = 2 * span + 3;
        let at = knots[last] + 0.5;
        put_in(at, last, &mut knots, &mut points);
    }
    points
}

/// The control points, one coordinate of them, of the two parts of a curve: up to the end of the span of a number, and from
/// there on.
///
/// # Panics
/// When the curve has no span after that one.
#[must_use]
pub fn split(control_points: &[f64], span: usize) -> [Vec<f64>; 2] {
    let mut knots = knots(control_points.len().saturating_sub(3));
    let mut points = control_points.to_vec();
    let knot = span + 4;
    for last in [knot, knot + 1] {
        put_in(knots[knot], last, &mut knots, &mut points);
    }
    // At a knot that is there three times the curve is at a control point.
    let at = knot - 1;
    [points[..=at].to_vec(), points[at..].to_vec()]
}

/// The knots of a clamped cubic with spans of 1.
fn knots(spans: usize) -> Vec<f64> {
    #[expect(clippy::cast_precision_loss, reason = "few control points")]
    let knot = |i: usize| i.saturating_sub(3).min(spans) as f64;
    (0..spans + 7).map(knot).collect()
}

/// Puts a knot in behind `last`, the last of those that are not greater; the curve stays as it is.
fn put_in(at: f64, last: usize, knots: &mut Vec<f64>, points: &mut Vec<f64>) {
    let finer = |i: usize| {
        let share = match i {
            _ if i + 3 <= last => 1.0,
            _ if i > last => 0.0,
            _ => (at - knots[i]) / (knots[i + 3] - knots[i]),
        };
        match share {
            0.0 => points[i - 1],
            1.0 => points[i],
            _ => share * points[i] + (1.0 - share) * points[i - 1],
        }
    };
    *points = (0..=points.len()).map(finer).collect();
    knots.insert(last + 1, at);
}

/// One row: the span and the four basis functions that are not 0 there, by the
/// recurrence of Cox and de Boor.
fn row(control_points: usize, parameter: f64) -> (usize, [f64; 4]) {
    if parameter <= 0.0 {
        return (0, [1.0, 0.0, 0.0, 0.0]);
    }
    if parameter >= 1.0 {
        return (control_points - 4, [0.0, 0.0, 0.0, 1.0]);
    }
    let spans = control_points - 3;
    #[expect(clippy::cast_precision_loss, reason = "few control points")]
    let spans_f = spans as f64;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 0 and the number of spans"
    )]
    let span = ((parameter * spans_f) as usize).min(spans - 1);
    // Knot `i` of the clamped vector, in units of one span; `span + 3` begins the span.
    #[expect(clippy::cast_precision_loss, reason = "few control points")]
    let knot = |i: usize| (i.saturating_sub(3)).min(spans) as f64;
    let at = parameter * spans_f;
    let mut weights = [1.0, 0.0, 0.0, 0.0];
    for degree in 1..=3 {
        let mut carried = 0.0;
        for (r, weight) in weights.iter_mut().enumerate().take(degree) {
            let right = knot(span + 4 + r);
            let left = knot(span + 4 + r - degree);
            let share = *weight / (right - left);
            *weight = carried + (right - at) * share;
            carried = (at - left) * share;
        }
        weights[degree] = carried;
    }
    (span, weights)
}

#[cfg(test)]
mod tests {
    use super::{Basis, halved, split, uniform_parameters};
    use proptest::prelude::*;

    /// The definition itself: N(i, p) by recursion over the full knot vector.
    fn recursive(knots: &[f64], i: usize, degree: usize, t: f64) -> f64 {
        if degree == 0 {
            return f64::from(u8::from(knots[i] <= t && t < knots[i + 1]));
        }
        let part = |low: f64, high: f64, value: f64| {
            if high > low {
                value / (high - low)
            } else {
                0.0
            }
        };
        part(knots[i], knots[i + degree], t - knots[i]) * recursive(knots, i, degree - 1, t)
            + part(
                knots[i + 1],
                knots[i + degree + 1],
                knots[i + degree + 1] - t,
            ) * recursive(knots, i + 1, degree - 1, t)
    }

    proptest! {
        #[test]
        fn the_parts_of_a_split_curve_are_the_curve(
            control_points in proptest::collection::vec(-100.0..100.0_f64, 5..40),
            (span, t) in (0..36_usize, 0.0..=1.0_f64),
        ) {
            let spans = control_points.len() - 3;
            let first = span % (spans - 1);
            let parts = split(&control_points, first);
            prop_assert_eq!([4 + first, spans + 2 - first], [parts[0].len(), parts[1].len()]);
            let at = |points: &[f64], t: f64| Basis::new(points.len(), &[t]).sampled(points)[0];
            let (before, whole) = (f64::from(u8::try_from(first + 1).expect("few")), f64::from(u8::try_from(spans).expect("few")));
            let of_first = at(&control_points, t * before / whole);
            prop_assert!((at(&parts[0], t) - of_first).abs() < 1e-9);
            let of_second = at(&control_points, (before + t * (whole - before)) / whole);
            prop_assert!((at(&parts[1], t) - of_second).abs() < 1e-9);
        }

        #[test]
        fn a_curve_with_halved_spans_is_the_same(
            control_points in proptest::collection::vec(-100.0..100.0_f64, 4..40), t in 0.0..=1.0_f64
        ) {
            let finer = halved(&control_points);
            prop_assert_eq!(finer.len(), 2 * control_points.len() - 3);
            let at = |points: &[f64]| Basis::new(points.len(), &[t]).sampled(points)[0];
            prop_assert!((at(&finer) - at(&control_points)).abs() < 1e-9);
        }

        #[test]
        fn weights_are_those_of_the_definition_and_a_partition_of_one(
            control_points in 4_u32..33, t in 0.0..1.0_f64
        ) {
            let spans = control_points - 3;
            let knots: Vec<f64> = (0..control_points + 4)
                .map(|i| f64::from(i.saturating_sub(3).min(spans)) / f64::from(spans))
                .collect();
            let control_points = usize::try_from(control_points).unwrap();
            let (first, weights) = Basis::new(control_points, &[t]).row(0);
            for i in 0..control_points {
                let expected = recursive(&knots, i, 3, t);
                let ours = if (first..first + 4).contains(&i) { weights[i - first] } else { 0.0 };
                prop_assert!((ours - expected).abs() < 1e-12, "{i}: {ours} {expected}");
            }
            prop_assert!(weights.iter().all(|w| *w >= 0.0));
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }

        #[test]
        fn a_curve_begins_and_ends_at_its_ends_and_stays_in_the_hull(
            values in prop::collection::vec(-1e5..1e5_f64, 4..33), samples in 2_usize..300
        ) {
            let basis = Basis::uniform(values.len(), samples);
            let mut curve = vec![0.0; samples];
            basis.apply(&values, &mut curve);
            prop_assert_eq!(curve[0].to_bits(), values[0].to_bits());
            prop_assert_eq!(curve[samples - 1].to_bits(), values[values.len() - 1].to_bits());
            let low = values.iter().copied().fold(f64::INFINITY, f64::min) - 1e-9;
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max) + 1e-9;
            prop_assert!(curve.iter().all(|x| (low..=high).contains(x)));
        }
    }

    #[test]
    fn uniform_parameters_hit_both_ends_exactly() {
        for samples in [2, 3, 101, 2001] {
            let parameters = uniform_parameters(samples);
            assert_eq!(parameters.len(), samples);
            assert_eq!(parameters[0].to_bits(), 0.0_f64.to_bits());
            assert_eq!(parameters[samples - 1].to_bits(), 1.0_f64.to_bits());
        }
    }
}
