//! Statistics of runs.
//!
//! Written here because no dependency has rank-sum and Friedman tests (statrs 0.18 has neither),
//! and a crate for the normal tail alone would change the published digits of p.

use std::f64::consts::SQRT_2;

use crate::numeric::as_f64;

/// Best, average, median, deviation and worst of some costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Lowest.
    pub best: f64,
    /// Mean.
    pub average: f64,
    /// Median.
    pub median: f64,
    /// Standard deviation of the sample (n - 1); 0 of one.
    pub deviation: f64,
    /// Highest.
    pub worst: f64,
}

impl Summary {
    /// `None` without costs.
    #[must_use]
    pub fn of(costs: &[f64]) -> Option<Self> {
        let mut sorted = costs.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (&best, &worst) = (sorted.first()?, sorted.last()?);
        let average = sorted.iter().sum::<f64>() / as_f64(sorted.len());
        let squares: f64 = sorted.iter().map(|cost| (cost - average).powi(2)).sum();
        Some(Self {
            best,
            average,
            median: median(&sorted),
            deviation: (squares / as_f64(sorted.len().saturating_sub(1).max(1))).sqrt(),
            worst,
        })
    }
}

/// Median of ascending numbers, at least one.
fn median(sorted: &[f64]) -> f64 {
    let middle = sorted.len() / 2;
    if sorted.len() % 2 == 1 {
        sorted[middle]
    } else {
        0.5 * (sorted[middle - 1] + sorted[middle])
    }
}

/// Wilcoxon's rank-sum test of two samples, both sides: the normal approximation with
/// correction for ties and continuity. `None` where a sample is empty or all are equal.
#[must_use]
pub fn rank_sum_p(a: &[f64], b: &[f64]) -> Option<f64> {
    let pooled: Vec<f64> = a.iter().chain(b).copied().collect();
    let (ranks, ties) = ranks(&pooled);
    let (n, m, all) = (as_f64(a.len()), as_f64(b.len()), as_f64(pooled.len()));
    let u = ranks[..a.len()].iter().sum::<f64>() - n * (n + 1.0) / 2.0;
    let variance = n * m / 12.0 * (all + 1.0 - ties / (all * (all - 1.0)));
    if variance.is_nan() || variance <= 0.0 {
        return None;
    }
    let z = ((u - n * m / 2.0).abs() - 0.5).max(0.0) / variance.sqrt();
    Some(2.0 * upper_tail(z))
}

/// Friedman's test: mean rank of each column over all rows, and the p of equal columns
/// (chi squared, its tail by Wilson and Hilferty). Rows are blocks, all of one length.
#[must_use]
pub fn friedman(rows: &[Vec<f64>]) -> Option<(Vec<f64>, f64)> {
    let columns = rows.first()?.len();
    if columns < 2 || rows.iter().any(|row| row.len() != columns) {
        return None;
    }
    let (n, k) = (as_f64(rows.len()), as_f64(columns));
    let mut mean = vec![0.0; columns];
    let mut tied = 0.0;
    for row in rows {
        let (ranks, ties) = ranks(row);
        tied += ties;
        for (mean, rank) in mean.iter_mut().zip(ranks) {
            *mean += rank / n;
        }
    }
    let spread: f64 = mean
        .iter()
        .map(|rank| (rank - (k + 1.0) / 2.0).powi(2))
        .sum();
    let scale = 1.0 - tied / (n * k * (k * k - 1.0));
    if scale <= 0.0 {
        return None;
    }
    let chi = 12.0 * n / (k * (k + 1.0)) * spread / scale;
    let ninth = 2.0 / (9.0 * (k - 1.0));
    let z = ((chi / (k - 1.0)).cbrt() - (1.0 - ninth)) / ninth.sqrt();
    Some((mean, upper_tail(z)))
}

/// Ranks from 1, equal numbers sharing theirs, and the sum of t^3 - t over ties.
fn ranks(values: &[f64]) -> (Vec<f64>, f64) {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let (mut ties, mut before) = (0.0, 0);
    for group in order.chunk_by(|&a, &b| values[a].total_cmp(&values[b]).is_eq()) {
        let t = as_f64(group.len());
        for &index in group {
            ranks[index] = as_f64(before) + (t + 1.0) / 2.0;
        }
        ties += t * t * t - t;
        before += group.len();
    }
    (ranks, ties)
}

/// P(Z > z) of the normal distribution: the complementary error function by its
/// Chebyshev fit (Numerical Recipes, erfcc), good to 1.2e-7 of itself.
fn upper_tail(z: f64) -> f64 {
    let x = z.abs() / SQRT_2;
    let t = 1.0 / (1.0 + 0.5 * x);
    const FIT: [f64; 10] = [
        -1.265_512_23,
        1.000_023_68,
        0.374_091_96,
        0.096_784_18,
        -0.186_288_06,
        0.278_868_07,
        -1.135_203_98,
        1.488_515_87,
        -0.822_152_23,
        0.170_872_77,
    ];
    let sum = FIT.iter().rev().fold(0.0, |sum, c| sum * t + c);
    let half = 0.5 * t * (-x * x + sum).exp();
    if z < 0.0 { 1.0 - half } else { half }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_of_known_numbers() {
        let summary = Summary::of(&[4.0, 1.0, 3.0, 2.0]).unwrap();
        assert!((summary.average - 2.5).abs() < 1e-12 && (summary.median - 2.5).abs() < 1e-12);
        assert!((summary.deviation - (5.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((summary.best - 1.0).abs() < 1e-12 && (summary.worst - 4.0).abs() < 1e-12);
        assert!(Summary::of(&[]).is_none());
    }

    #[test]
    fn normal_tails_are_those_of_the_tables() {
        for (z, p) in [
            (0.0, 0.5),
            (1.0, 0.158_655_254),
            (1.959_963_985, 0.025),
            (-1.0, 0.841_344_746),
            (3.0, 0.001_349_898),
        ] {
            assert!((upper_tail(z) - p).abs() < 1e-7, "{z}");
        }
    }

    #[test]
    fn rank_sums_of_separate_equal_and_tied_samples() {
        // By hand: U = 0, mean 12.5, variance 25 * 11 / 12, z = 12 / 4.787.
        let (low, high) = ([1.0, 2.0, 3.0, 4.0, 5.0], [6.0, 7.0, 8.0, 9.0, 10.0]);
        assert!((rank_sum_p(&low, &high).unwrap() - 0.012_186).abs() < 1e-5);
        assert!((rank_sum_p(&low, &low).unwrap() - 1.0).abs() < 1e-6);
        assert!(rank_sum_p(&[1.0, 1.0], &[1.0]).is_none());
        assert!(rank_sum_p(&[], &low).is_none());
    }

    #[test]
    fn friedman_ranks_the_columns() {
        let rows: Vec<Vec<f64>> = (0..10)
            .map(|k| vec![3.0, 1.0 + f64::from(k) * 0.1, 9.0])
            .collect();
        let (ranks, p) = friedman(&rows).unwrap();
        assert!((ranks[0] - 2.0).abs() < 1e-12 && (ranks[1] - 1.0).abs() < 1e-12);
        // Chi squared is 20 with 2 degrees: exp(-10).
        assert!(p < 2e-4);
        assert!(friedman(&[vec![1.0, 1.0]]).is_none());
    }
}
