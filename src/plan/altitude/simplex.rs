//! The linear algebra of the dual simplex behind [`crate::plan::altitude`], laid out for vectors.

use fearless_simd::prelude::*;

/// Entries of a row in terms of the basis below this cannot leave it.
const MIN_EXCHANGE: f64 = 1e-9;
/// Numbers are padded to a multiple of this.
pub(crate) const PAD: usize = 8;

/// A constraint that may be active.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Constraint {
    /// The floor at a sample.
    Floor(usize),
    /// The rise after a sample.
    Up(usize),
    /// The drop after a sample.
    Down(usize),
    /// The base of a control point.
    Base(usize),
    /// The ceiling at a sample.
    Ceiling(usize),
}

/// Active constraints and the inverse of their matrix.
#[derive(Clone, Debug, Default)]
pub(crate) struct Basis {
    pub(crate) active: Vec<Constraint>,
    /// Row by row, each padded with zeros to [`Self::stride`]; column `i` belongs to
    /// `active[i]`.
    pub(crate) inverse: Vec<f64>,
}

impl Basis {
    /// Numbers of a row of the inverse.
    pub(crate) fn stride(&self) -> usize {
        self.active.len().next_multiple_of(PAD)
    }

    /// A row vector, given by its entries other than 0, times the inverse; padded with zeros.
    #[inline(always)]
    pub(crate) fn times<S: Simd>(
        &self,
        simd: S,
        row: impl Iterator<Item = (usize, f64)>,
        out: &mut Vec<f64>,
    ) {
        let (stride, lanes) = (self.stride(), S::f64s::LEN);
        out.clear();
        out.resize(stride, 0.0);
        for (j, weight) in row {
            let inverse = self.inverse[j * stride..][..stride].chunks_exact(lanes);
            for (out, m) in out.chunks_exact_mut(lanes).zip(inverse) {
                let sum = load(simd, out) + load(simd, m) * weight;
                sum.store_slice(out);
            }
        }
    }

    /// The inverse times a column vector, added to `out`.
    #[inline(always)]
    pub(crate) fn add_times(&self, column: &[f64], out: &mut [f64]) {
        for (out, row) in out.iter_mut().zip(self.inverse.chunks_exact(self.stride())) {
            for (m, x) in row.iter().zip(column) {
                *out += m * x;
            }
        }
    }

    /// The constraint that leaves for one with this row in terms of the basis: least
    /// ratio of dual value and entry, the first of equals. None if there is no limit.
    #[inline(always)]
    pub(crate) fn leaving<S: Simd>(simd: S, row: &[f64], dual: &[f64]) -> Option<usize> {
        let lanes = S::f64s::LEN;
        let mut least = (None, 1.0, 0.0);
        for (first, entries) in (0..).step_by(lanes).zip(row.chunks_exact(lanes)) {
            let mut positive = load(simd, entries).simd_gt(MIN_EXCHANGE).to_bitmask();
            while positive != 0 {
                let i = first + positive.trailing_zeros() as usize;
                let (entry, dual) = (row[i], dual[i]);
                // dual / entry < least.1 / least.2, without a division.
                if dual * least.2 < least.1 * entry {
                    least = (Some(i), dual, entry);
                }
                positive &= positive - 1;
            }
        }
        least.0
    }

    /// Puts a constraint, violated by so much, in the place of the one that leaves; moves
    /// the altitudes `z` of the free control points. `row` is used up.
    #[inline(always)]
    pub(crate) fn exchange<S: Simd>(
        &mut self,
        simd: S,
        leaving: usize,
        entering: Constraint,
        row: &mut [f64],
        dual: &mut [f64],
    ) {
        let (stride, lanes) = (self.stride(), S::f64s::LEN);
        let divisor = row[leaving];
        let ratio = dual[leaving] / divisor;
        let shares = row.chunks_exact(lanes);
        for (dual, share) in dual.chunks_exact_mut(lanes).zip(shares) {
            let less = (load(simd, dual) - load(simd, share) * ratio).max(0.0);
            less.store_slice(dual);
        }
        dual[leaving] = ratio;
        row[leaving] = 0.0;
        for inverse in self.inverse.chunks_exact_mut(stride) {
            let entry = inverse[leaving] / divisor;
            let shares = row.chunks_exact(lanes);
            for (m, share) in inverse.chunks_exact_mut(lanes).zip(shares) {
                let less = load(simd, m) - load(simd, share) * entry;
                less.store_slice(m);
            }
            inverse[leaving] = entry;
        }
        self.active[leaving] = entering;
    }

    /// Moves the free control points along the column of a constraint that has just entered, by
    /// how far it was violated.
    pub(crate) fn shift(&self, entered: usize, violation: f64, z: &mut [f64]) {
        for (inverse, z) in self.inverse.chunks_exact(self.stride()).zip(z) {
            *z += violation * inverse[entered];
        }
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, numbers: &[f64]) -> S::f64s {
    S::f64s::from_slice(simd, numbers)
}

/// The first of the greatest numbers, if they are above a limit; their count must be a multiple
/// of [`PAD`].
#[inline(always)]
pub(crate) fn greatest<S: Simd>(simd: S, values: &[f64], above: f64) -> Option<(usize, f64)> {
    let lanes = S::f64s::LEN;
    let mut most = S::f64s::splat(simd, f64::NEG_INFINITY);
    for chunk in values.chunks_exact(lanes) {
        most = load(simd, chunk).max(most);
    }
    if !most.simd_gt(above).any_true() {
        return None;
    }
    let most = most
        .as_slice()
        .iter()
        .fold(f64::NEG_INFINITY, |a, &b| if b > a { b } else { a });
    for (index, chunk) in values.chunks_exact(lanes).enumerate() {
        let found = load(simd, chunk).simd_ge(most);
        if found.any_true() {
            let within = found.to_bitmask().trailing_zeros() as usize;
            return Some((index * lanes + within, most));
        }
    }
    None
}
