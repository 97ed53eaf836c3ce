//! The linear algebra of the dual simplex behind [`super::lowest`], laid out for vectors.

use fearless_simd::prelude::*;

/// Entries of a row in terms of the basis below this are no pivots.
const PIVOT: f64 = 1e-9;
/// Numbers are padded to a multiple of this.
pub(super) const PAD: usize = 8;

/// A constraint that may be active.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Constraint {
    /// The floor at a sample.
    Floor(usize),
    /// The rise after a sample.
    Up(usize),
    /// The drop after a sample.
    Down(usize),
    /// The base of a control point.
    Base(usize),
}

/// Active constraints and the inverse of their matrix.
#[derive(Clone, Debug, Default)]
pub(super) struct Basis {
    pub(super) active: Vec<Constraint>,
    /// Row by row; column `i` belongs to `active[i]`.
    pub(super) inverse: Vec<f64>,
}

impl Basis {
    /// A row vector, given by its entries other than 0, times the inverse.
    #[inline(always)]
    pub(super) fn times(&self, row: impl Iterator<Item = (usize, f64)>, out: &mut Vec<f64>) {
        let free = self.active.len();
        out.clear();
        out.resize(free, 0.0);
        for (j, weight) in row {
            let inverse = &self.inverse[j * free..][..free];
            for (out, m) in out.iter_mut().zip(inverse) {
                *out += weight * m;
            }
        }
    }

    /// The inverse times a column vector, added to `out`.
    #[inline(always)]
    pub(super) fn add_times(&self, column: &[f64], out: &mut [f64]) {
        for (out, row) in out.iter_mut().zip(self.inverse.chunks_exact(column.len())) {
            for (m, x) in row.iter().zip(column) {
                *out += m * x;
            }
        }
    }

    /// The constraint that leaves for one with this row in terms of the basis: least
    /// ratio of dual value and entry, the first of equals. None if there is no limit.
    #[inline(always)]
    pub(super) fn leaving(row: &[f64], dual: &[f64]) -> Option<usize> {
        let mut least = (None, 1.0, 0.0);
        for (i, (&entry, &dual)) in row.iter().zip(dual).enumerate() {
            // dual / entry < least.1 / least.2, without a division.
            if entry > PIVOT && dual * least.2 < least.1 * entry {
                least = (Some(i), dual, entry);
            }
        }
        least.0
    }

    /// Puts a constraint, violated by so much, in the place of the one that leaves; moves
    /// the altitudes `z` of the free control points. `row` is used up.
    #[inline(always)]
    pub(super) fn exchange(
        &mut self,
        leaving: usize,
        (entering, violation): (Constraint, f64),
        row: &mut [f64],
        dual: &mut [f64],
        z: &mut [f64],
    ) {
        let free = self.active.len();
        let pivot = row[leaving];
        let ratio = dual[leaving] / pivot;
        for (dual, share) in dual.iter_mut().zip(&*row) {
            *dual = (*dual - ratio * share).max(0.0);
        }
        dual[leaving] = ratio;
        row[leaving] = 0.0;
        for (inverse, z) in self.inverse.chunks_exact_mut(free).zip(z) {
            let entry = inverse[leaving] / pivot;
            *z += violation * entry;
            for (m, share) in inverse.iter_mut().zip(&*row) {
                *m -= share * entry;
            }
            inverse[leaving] = entry;
        }
        self.active[leaving] = entering;
    }
}

/// The first of the greatest numbers, of which there are a multiple of [`PAD`].
#[inline(always)]
pub(super) fn greatest<S: Simd>(simd: S, values: &[f64]) -> (usize, f64) {
    let lanes = S::f64s::LEN;
    let mut most = S::f64s::splat(simd, f64::NEG_INFINITY);
    for chunk in values.chunks_exact(lanes) {
        most = S::f64s::from_slice(simd, chunk).max(most);
    }
    let most = most
        .as_slice()
        .iter()
        .fold(f64::NEG_INFINITY, |a, &b| if b > a { b } else { a });
    for (index, chunk) in values.chunks_exact(lanes).enumerate() {
        let found = S::f64s::from_slice(simd, chunk).simd_ge(most);
        if found.any_true() {
            return (
                index * lanes + found.to_bitmask().trailing_zeros() as usize,
                most,
            );
        }
    }
    (0, most)
}
