//! Splines fitted to polylines, with the control points spread evenly or bunched.

use geo::{LineString, SimplifyIdx};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::geodesy::EastNorth;
use crate::plan::altitude::Row;

/// Weight that keeps each control point near its own place on the polyline.
const RIDGE: f64 = 1e-3;
/// How far from an extreme of the ground a control point may lie that is meant for it, as a share
/// of the length.
const NEARBY: f64 = 0.02;
/// Steps in which a warp is integrated.
const WARP_STEPS: usize = 256;

/// A polyline by its arc length.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    points: Vec<EastNorth>,
    /// Length up to each point, metres.
    lengths_m: Vec<f64>,
}

impl Line {
    /// From at least one point.
    pub(crate) fn new(points: Vec<EastNorth>) -> Self {
        let mut lengths_m = Vec::with_capacity(points.len());
        let mut sum = 0.0;
        let mut previous = points.first().copied();
        for &point in &points {
            sum += previous.map_or(0.0, |previous| previous.distance_m(point));
            lengths_m.push(sum);
            previous = Some(point);
        }
        Self { points, lengths_m }
    }

    /// Whole length, metres.
    pub(crate) fn length_m(&self) -> f64 {
        self.lengths_m.last().copied().unwrap_or(0.0)
    }

    /// Shares of the length at which it bends, where it is further than `off_m` off the straight
    /// (Douglas and Peucker 1973).
    pub(crate) fn corners(&self, off_m: f64) -> Vec<f64> {
        let positions = self.points.iter().map(|at| (at.east_m, at.north_m));
        let left = LineString::from_iter(positions).simplify_idx(off_m);
        let inner = left.get(1..left.len().saturating_sub(1)).unwrap_or(&[]);
        let share = |&point: &usize| self.lengths_m[point] / self.length_m().max(1e-9);
        inner.iter().map(share).collect()
    }

    /// The point at a share of the length.
    pub(crate) fn at(&self, share: f64) -> EastNorth {
        let along_m = share * self.length_m();
        let after = self
            .lengths_m
            .partition_point(|&length| length < along_m)
            .clamp(1, (self.points.len() - 1).max(1));
        let (Some(&a), Some(&b)) = (self.points.get(after - 1), self.points.get(after)) else {
            return self.points[0];
        };
        let step_m = self.lengths_m[after] - self.lengths_m[after - 1];
        let part = if step_m > 0.0 {
            ((along_m - self.lengths_m[after - 1]) / step_m).clamp(0.0, 1.0)
        } else {
            0.0
        };
        EastNorth {
            east_m: a.east_m + (b.east_m - a.east_m) * part,
            north_m: a.north_m + (b.north_m - a.north_m) * part,
        }
    }
}

/// How the spline's parameter runs along a polyline: control points gather where it
/// runs fast.
#[derive(Clone, Debug)]
pub(crate) struct Warp {
    /// Share of the length at even parameters, of [`WARP_STEPS`] + 1 of them mostly.
    shares: Vec<f64>,
}

impl Warp {
    /// Parameter even in arc length.
    pub(crate) fn even() -> Self {
        Self::of(|_| 1.0)
    }

    /// One to three random bumps of parameter density: height 1 to 8, width 0.03 to
    /// 0.12, at one of `summits` (60 %) or anywhere.
    pub(crate) fn random(summits: &[f64], rng: &mut ChaCha8Rng) -> Self {
        let bumps: Vec<(f64, f64, f64)> = (0..rng.random_range(1..=3))
            .map(|_| {
                let height = rng.random_range(1.0..8.0);
                let width = rng.random_range(0.03..0.12);
                let anywhere = rng.random_range(0.0..1.0);
                let at_summit = rng.random_bool(0.6);
                let which = rng.random_range(0..summits.len().max(1));
                match summits.get(which) {
                    Some(&summit) if at_summit => (height, summit, width),
                    _ => (height, anywhere, width),
                }
            })
            .collect();
        Self::of(|share| {
            bumps.iter().fold(1.0, |sum, (height, at, width)| {
                sum + height * (-((share - at) / width).powi(2)).exp()
            })
        })
    }

    /// Control points that weigh most at the parameters `peaks` lie at extremes of the ground,
    /// shares of the length and heights there, one at each, and the others halve the widest gaps;
    /// all at random nearby. Where extremes are as many as control points or more, between a
    /// quarter of the points and all are so used, for the extremes that stand out.
    pub(crate) fn at_extremes(
        peaks: &[f64],
        extremes: &[(f64, f64)],
        rng: &mut ChaCha8Rng,
    ) -> Self {
        let most = match extremes.len() >= peaks.len() {
            true => rng.random_range((peaks.len() / 4).max(1)..=peaks.len().max(1)),
            false => extremes.len(),
        };
        let mut stations = vec![0.0, 1.0];
        stations.extend(
            outstanding(extremes, most, rng)
                .iter()
                .map(|(share, _)| share + rng.random_range(-NEARBY..NEARBY))
                .map(|share| share.clamp(NEARBY / 4.0, 1.0 - NEARBY / 4.0)),
        );
        stations.sort_by(f64::total_cmp);
        while stations.len() < peaks.len() + 2 {
            let gaps = stations.windows(2).map(|pair| (pair[0], pair[1] - pair[0]));
            let widest = gaps.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
            stations.push(widest.0 + widest.1 * rng.random_range(0.35..0.65));
            stations.sort_by(f64::total_cmp);
        }
        let parameters = [&[0.0], peaks, &[1.0]].concat();
        let knots: Vec<(f64, f64)> = parameters.into_iter().zip(stations).collect();
        Self::through(&knots)
    }

    /// Straight between parameters and shares of the length that belong together, from (0, 0)
    /// to (1, 1).
    fn through(knots: &[(f64, f64)]) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "hundreds of steps")]
        let parameter = |step: usize| step as f64 / WARP_STEPS as f64;
        let share = |parameter: f64| {
            let after = knots.partition_point(|knot| knot.0 < parameter);
            let after = after.clamp(1, knots.len() - 1);
            let (low, high) = (knots[after - 1], knots[after]);
            let part = (parameter - low.0) / (high.0 - low.0).max(1e-9);
            low.1 + (high.1 - low.1) * part.clamp(0.0, 1.0)
        };
        Self {
            shares: (0..=WARP_STEPS).map(parameter).map(share).collect(),
        }
    }

    fn of(density: impl Fn(f64) -> f64) -> Self {
        Self::of_steps(WARP_STEPS, density)
    }

    /// Control points gather around `corners`, shares of the length, within `width` of each: so
    /// many of them that a corner has `each` more than a straight piece as long, of `controls`
    /// in all.
    pub(crate) fn at_corners(corners: &[f64], width: f64, (each, controls): (f64, usize)) -> Self {
        /// Steps over the width of a corner.
        const STEPS: f64 = 8.0;
        #[expect(clippy::cast_precision_loss, reason = "a few hundred")]
        let (controls, count) = (controls as f64, corners.len() as f64);
        // A bump of height 1 has the area of its width times the root of pi.
        let spread = (controls - each * count).max(0.25 * controls);
        let height = each / spread / (width * std::f64::consts::PI.sqrt());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to thousands"
        )]
        let steps = (STEPS / width).clamp(256.0, 8192.0) as usize;
        Self::of_steps(steps, |share| {
            corners.iter().fold(1.0, |sum, corner| {
                let away = (share - corner) / width;
                sum + height * (-away * away).exp()
            })
        })
    }

    fn of_steps(steps: usize, density: impl Fn(f64) -> f64) -> Self {
        #[expect(clippy::cast_precision_loss, reason = "thousands of steps")]
        let share = |step: usize| step as f64 / steps as f64;
        let mut parameters = vec![0.0];
        let mut sum = 0.0;
        for step in 0..steps {
            sum += 0.5 * (density(share(step)) + density(share(step + 1)));
            parameters.push(sum);
        }
        let mut after = 1;
        let shares = (0..=steps)
            .map(|step| {
                let target = share(step) * sum;
                while after < steps && parameters[after] < target {
                    after += 1;
                }
                let (low, high) = (parameters[after - 1], parameters[after]);
                let part = ((target - low) / (high - low)).clamp(0.0, 1.0);
                share(after - 1) + part * (share(after) - share(after - 1))
            })
            .collect();
        Self { shares }
    }

    /// Share of the length at a parameter of [0, 1].
    fn share(&self, parameter: f64) -> f64 {
        let steps = self.shares.len() - 1;
        #[expect(clippy::cast_precision_loss, reason = "thousands of steps")]
        let at = parameter.clamp(0.0, 1.0) * steps as f64;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the steps"
        )]
        let step = (at.floor() as usize).min(steps - 1);
        #[expect(clippy::cast_precision_loss, reason = "thousands of steps")]
        let part = at - step as f64;
        self.shares[step] + part * (self.shares[step + 1] - self.shares[step])
    }
}

/// At most `most` extremes, shares of the length and heights: those between which the ground
/// rises or falls most, about. They go in pairs, so that tops and bottoms alternate.
fn outstanding(extremes: &[(f64, f64)], most: usize, rng: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
    let mut left = extremes.to_vec();
    while left.len() > most + 1 {
        let rises = left
            .windows(2)
            .map(|pair| (pair[0].1 - pair[1].1).abs() * rng.random_range(0.5..2.0));
        let least = rises.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let at = least.map_or(0, |(at, _)| at);
        left.drain(at..at + 2);
    }
    if left.len() > most {
        left.remove(rng.random_range(0..left.len()));
    }
    left
}

/// Least squares for one spline and its samples.
pub(crate) struct Fitter {
    rows: Vec<Row>,
    parameters: Vec<f64>,
    controls: usize,
    /// Parameter at which each control point weighs most.
    peaks: Vec<f64>,
    normal: Option<Cholesky<f64, Dyn>>,
}

impl Fitter {
    /// For samples at `parameters` with weights `rows`, and `controls` control points.
    pub(crate) fn new(rows: Vec<Row>, parameters: Vec<f64>, controls: usize) -> Self {
        let free = controls - 2;
        let mut normal = DMatrix::identity(free, free) * RIDGE;
        let mut peaks = vec![(0.0, 0.0); controls];
        for ((first, weights), &parameter) in rows.iter().zip(&parameters) {
            for (i, a) in weights.iter().enumerate() {
                if *a > peaks[first + i].0 {
                    peaks[first + i] = (*a, parameter);
                }
                for (j, b) in weights.iter().enumerate() {
                    let inner = 1..=free;
                    if inner.contains(&(first + i)) && inner.contains(&(first + j)) {
                        normal[(first + i - 1, first + j - 1)] += a * b;
                    }
                }
            }
        }
        Self {
            rows,
            parameters,
            controls,
            peaks: peaks.into_iter().map(|peak| peak.1).collect(),
            normal: normal.cholesky(),
        }
    }

    /// Weights of the control points in each sample.
    pub(crate) fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Parameter at which each free control point weighs most.
    pub(crate) fn peaks(&self) -> &[f64] {
        &self.peaks[1..self.controls - 1]
    }

    /// Control points, ends included.
    pub(crate) fn controls(&self) -> usize {
        self.controls
    }

    /// The spline of free control points between two ends, sample by sample.
    pub(crate) fn samples(
        &self,
        (from, to): (EastNorth, EastNorth),
        free: &[EastNorth],
    ) -> Vec<EastNorth> {
        let control = |index: usize| match index {
            0 => from,
            last if last + 1 == self.controls => to,
            inner => free[inner - 1],
        };
        let sample = |(first, weights): &Row| {
            let mut sum = EastNorth {
                east_m: 0.0,
                north_m: 0.0,
            };
            for (i, weight) in weights.iter().enumerate() {
                let at = control(first + i);
                sum.east_m += weight * at.east_m;
                sum.north_m += weight * at.north_m;
            }
            sum
        };
        self.rows.iter().map(sample).collect()
    }

    /// The free control points of the spline nearest to a polyline.
    pub(crate) fn fit(&self, line: &Line, warp: &Warp) -> Vec<EastNorth> {
        let positions: Vec<EastNorth> = self
            .peaks
            .iter()
            .map(|&parameter| line.at(warp.share(parameter)))
            .collect();
        let targets: Vec<EastNorth> = self
            .parameters
            .iter()
            .map(|&parameter| line.at(warp.share(parameter)))
            .collect();
        let ends = (line.at(0.0), line.at(1.0));
        let solve = |of: fn(&EastNorth) -> f64| {
            let free = self.controls - 2;
            let mut right = DVector::from_fn(free, |j, _| RIDGE * of(&positions[j + 1]));
            for ((first, weights), target) in self.rows.iter().zip(&targets) {
                let mut rest = of(target);
                for (i, weight) in weights.iter().enumerate() {
                    if first + i == 0 {
                        rest -= weight * of(&ends.0);
                    } else if first + i + 1 == self.controls {
                        rest -= weight * of(&ends.1);
                    }
                }
                for (i, weight) in weights.iter().enumerate() {
                    if (1..=free).contains(&(first + i)) {
                        right[first + i - 1] += weight * rest;
                    }
                }
            }
            match &self.normal {
                Some(normal) => normal.solve(&right),
                None => DVector::from_fn(free, |j, _| of(&positions[j + 1])),
            }
        };
        let (east, north) = (solve(|p| p.east_m), solve(|p| p.north_m));
        east.iter()
            .zip(north.iter())
            .map(|(&east_m, &north_m)| EastNorth { east_m, north_m })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::Seed;

    fn line() -> Line {
        let at = |east_m, north_m| EastNorth { east_m, north_m };
        Line::new(vec![at(0.0, 0.0), at(300.0, 400.0), at(300.0, 900.0)])
    }

    #[test]
    fn a_line_is_measured_by_its_arc_length() {
        let line = line();
        assert!((line.length_m() - 1000.0).abs() < 1e-9);
        let quarter = line.at(0.25);
        assert!((quarter.east_m - 150.0).hypot(quarter.north_m - 200.0) < 1e-9);
        assert!((line.at(1.0).north_m - 900.0).abs() < 1e-9);
        let lone = Line::new(vec![EastNorth {
            east_m: 5.0,
            north_m: 6.0,
        }]);
        assert!((lone.at(0.7).east_m - 5.0).abs() < 1e-12);
    }

    #[test]
    fn control_points_lie_at_the_extremes_that_stand_out() {
        let mut rng = Seed(5).stream("test", 0);
        let ground = [(0.2, 900.0), (0.3, 895.0), (0.35, 897.0), (0.5, 0.0)];
        let peaks = [0.25, 0.5, 0.75];
        for _ in 0..50 {
            let warp = Warp::at_extremes(&peaks, &ground[3..], &mut rng);
            let is_near = |peak: &f64| (warp.share(*peak) - 0.5).abs() <= NEARBY;
            assert!(peaks.iter().any(is_near), "{warp:?}");
            // The notch goes with one of the tops beside it.
            let left = outstanding(&ground, 2, &mut rng);
            assert!(left == [ground[0], ground[3]] || left == [ground[2], ground[3]]);
        }
    }

    #[test]
    fn a_warp_runs_from_end_to_end_without_turning_back() {
        let mut rng = Seed(4).stream("test", 0);
        for _ in 0..50 {
            let warp = Warp::random(&[0.3, 0.8], &mut rng);
            assert!(warp.share(0.0).abs() < 1e-12);
            assert!((warp.share(1.0) - 1.0).abs() < 1e-12);
            assert!(warp.shares.is_sorted());
        }
        for extremes in [0, 1, 5, 40] {
            let extremes: Vec<(f64, f64)> = (1..=extremes)
                .map(|k| (f64::from(k) / 41.0, 100.0 * f64::from(k % 2)))
                .collect();
            let warp = Warp::at_extremes(&[0.1, 0.4, 0.6, 0.9], &extremes, &mut rng);
            assert!(warp.share(0.0).abs() < 1e-12);
            assert!((warp.share(1.0) - 1.0).abs() < 1e-12);
            assert!(warp.shares.is_sorted());
        }
        let even = Warp::even();
        assert!((0..=10).all(|i| {
            let u = f64::from(i) / 10.0;
            (even.share(u) - u).abs() < 1e-9
        }));
    }
}
