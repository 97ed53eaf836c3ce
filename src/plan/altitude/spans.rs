//! Splines sampled in whole vectors: samples that share their control points are worked off
//! side by side. [`crate::numeric::Basis::apply`] is the plain form.

use fearless_simd::prelude::*;

use super::Row;
use super::simplex::PAD;

/// The weights of the samples of a spline, span by span.
#[derive(Clone, Debug)]
pub(crate) struct Spans {
    /// One column for each of the four weights of a sample, and zeros behind them.
    columns: [Vec<f64>; 4],
    /// First control point, and first and last sample but one, of the samples that share
    /// their control points.
    spans: Vec<(usize, usize, usize)>,
    samples: usize,
}

impl Spans {
    pub(crate) fn new(rows: &[Row]) -> Self {
        let mut spans: Vec<(usize, usize, usize)> = Vec::new();
        for (k, (first, _)) in rows.iter().enumerate() {
            match spans.last_mut() {
                Some(span) if span.0 == *first => span.2 = k + 1,
                _ => spans.push((*first, k, k + 1)),
            }
        }
        Self {
            columns: [0, 1, 2, 3].map(|i| {
                let weights = rows.iter().map(|row| row.1[i]);
                weights.chain([0.0; PAD]).collect()
            }),
            spans,
            samples: rows.len(),
        }
    }

    /// One coordinate at all samples, from that of the control points.
    #[inline(always)]
    pub(crate) fn sample<S: Simd>(&self, simd: S, controls: &[f64], out: &mut Vec<f64>) {
        let lanes = S::f64s::LEN;
        out.resize(self.samples + PAD, 0.0);
        for &(first, from, to) in &self.spans {
            let four = &controls[first..first + 4];
            let splat = (
                S::f64s::splat(simd, four[0]),
                S::f64s::splat(simd, four[1]),
                S::f64s::splat(simd, four[2]),
                S::f64s::splat(simd, four[3]),
            );
            // What is written beyond a span is written again by the next one.
            for at in (from..to).step_by(lanes) {
                let [a, b, c, d] = &self.columns;
                let sum = weights(simd, a, at) * splat.0
                    + weights(simd, b, at) * splat.1
                    + weights(simd, c, at) * splat.2
                    + weights(simd, d, at) * splat.3;
                sum.store_slice(&mut out[at..at + lanes]);
            }
        }
        out.truncate(self.samples);
    }

    /// What each control point costs, from what a unit of each sample costs, added to `costs`;
    /// `rows` are those of [`Self::new`].
    #[inline(always)]
    pub(crate) fn add_shares(&self, rows: &[Row], of_samples: &[f64], costs: &mut [f64]) {
        for &(first, from, to) in &self.spans {
            let Some(costs) = costs[first..].first_chunk_mut::<4>() else {
                continue;
            };
            let mut sums = *costs;
            for ((_, row), weight) in rows[from..to].iter().zip(&of_samples[from..to]) {
                for (sum, share) in sums.iter_mut().zip(row) {
                    *sum += weight * share;
                }
            }
            *costs = sums;
        }
    }
}

/// The next weights of a column.
#[inline(always)]
fn weights<S: Simd>(simd: S, column: &[f64], from: usize) -> S::f64s {
    S::f64s::from_slice(simd, &column[from..from + S::f64s::LEN])
}
