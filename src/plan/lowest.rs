//! The lowest spline over a floor: altitudes decoded exactly instead of searched.
//!
//! Over a fixed horizontal spline the altitude of every sample is linear in the
//! altitudes of the control points, so the lowest flight that clears a floor is a
//! linear program in a handful of variables,
//!
//! ```text
//! min sum_k w_k (B z)_k   subject to   (B z)_k >= floor_k,  z >= base,
//! ```
//!
//! solved by a revised dual simplex whose basis inverse is as small as the number of
//! free control points. The dual simplex starts from any dual feasible basis; it is
//! always the same one here (one sample below each control point), so that equal
//! candidates give equal bytes whatever was solved before.

use nalgebra::DMatrix;

/// The weights of one sample: index of the first of four control points, and the
/// weight of each.
pub(super) type Row = (usize, [f64; 4]);

/// A sample where an end point weighs more than this does not constrain: the free
/// control points could meet it only by leaping.
const END_WEIGHT: f64 = 0.85;
/// Violation of the floor that counts as none, metres.
const TOLERANCE_M: f64 = 1e-4;
/// Entries of a row in terms of the basis below this are no pivots.
const PIVOT: f64 = 1e-9;

/// Finds the lowest spline over a floor, for one fixed parametrisation.
#[derive(Clone, Debug)]
pub(super) struct LowestSpline {
    rows: Vec<Row>,
    /// Whether a sample constrains.
    binding: Vec<bool>,
    controls: usize,
    /// The constraints of the first basis, and the inverse of their matrix by columns.
    first: Option<Basis>,
}

/// What [`LowestSpline::solve`] works in, kept between calls to save allocations.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace {
    cost: Vec<f64>,
    bound: Vec<f64>,
    x: Vec<f64>,
    dual: Vec<f64>,
    pivot_row: Vec<f64>,
    basis: Basis,
}

/// Active constraints and the inverse of their matrix. Constraint `k` is the floor
/// at sample `k`; constraint `samples + j` is the base of free control point `j`.
#[derive(Clone, Debug, Default)]
struct Basis {
    active: Vec<usize>,
    /// Column `i` belongs to `active[i]`.
    inverse: Vec<f64>,
}

impl LowestSpline {
    /// For a spline of `controls` control points, ends included, and the weights of
    /// its samples.
    pub(super) fn new(rows: Vec<Row>, controls: usize) -> Self {
        let end_weight = |(first, weights): &Row| {
            (0..4)
                .filter(|i| first + i == 0 || first + i + 1 == controls)
                .map(|i| weights[i])
                .sum::<f64>()
        };
        let binding = rows
            .iter()
            .map(|row| end_weight(row) <= END_WEIGHT)
            .collect();
        let mut lowest = Self {
            rows,
            binding,
            controls,
            first: None,
        };
        lowest.first = lowest.interpolation();
        lowest
    }

    /// The basis in which one sample below each free control point touches the floor.
    fn interpolation(&self) -> Option<Basis> {
        let free = self.controls - 2;
        let peak = |control: usize| {
            (0..self.rows.len())
                .filter(|&k| self.binding[k])
                .max_by(|&a, &b| {
                    self.weight(a, control)
                        .total_cmp(&self.weight(b, control))
                        .then(b.cmp(&a))
                })
        };
        let active: Vec<usize> = (1..=free).map(peak).collect::<Option<_>>()?;
        let matrix = DMatrix::from_fn(free, free, |i, j| self.weight(active[i], j + 1));
        let inverse = matrix.try_inverse()?;
        Some(Basis {
            active,
            inverse: inverse.as_slice().to_vec(),
        })
    }

    /// Weight of a control point in a sample.
    fn weight(&self, sample: usize, control: usize) -> f64 {
        let (first, weights) = &self.rows[sample];
        control
            .checked_sub(*first)
            .and_then(|i| weights.get(i))
            .copied()
            .unwrap_or(0.0)
    }

    /// Free control points of a sample: index among the free ones, and weight.
    fn free_weights(&self, sample: usize) -> impl Iterator<Item = (usize, f64)> {
        let (first, weights) = self.rows[sample];
        let last = self.controls - 1;
        (0..4)
            .filter(move |i| first + i > 0 && first + i < last)
            .map(move |i| (first + i - 1, weights[i]))
    }

    /// Fills the free altitudes of `amsl_m`, whose first and last are given.
    ///
    /// `floor_m` and `weights` (not negative) have one entry for each sample.
    pub(super) fn solve(
        &self,
        floor_m: &[f64],
        weights: &[f64],
        amsl_m: &mut [f64],
        work: &mut Workspace,
    ) {
        let (low, high) = floor_m
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &h| {
                (low.min(h), high.max(h))
            });
        let base = low - (high - low) - 100.0;
        self.load(floor_m, weights, amsl_m, base, work);
        if self.start(work) && self.pivot_until_feasible(work) {
            for (altitude, x) in amsl_m[1..].iter_mut().zip(&work.x) {
                *altitude = base + x;
            }
        } else {
            self.lift(floor_m, amsl_m);
        }
    }

    /// Costs of the free control points, and bounds with the end points moved over.
    fn load(
        &self,
        floor_m: &[f64],
        weights: &[f64],
        amsl_m: &[f64],
        base: f64,
        work: &mut Workspace,
    ) {
        let free = self.controls - 2;
        work.cost.clear();
        work.cost.resize(free, 0.0);
        work.bound.clear();
        let last = self.controls - 1;
        for (k, (first, row)) in self.rows.iter().enumerate() {
            let mut bound = floor_m[k] - base;
            for (i, weight) in row.iter().enumerate() {
                let control = first + i;
                if control == 0 || control == last {
                    bound -= weight * (amsl_m[control] - base);
                } else {
                    work.cost[control - 1] += weights[k] * weight;
                }
            }
            work.bound.push(if self.binding[k] {
                bound
            } else {
                f64::NEG_INFINITY
            });
        }
        work.bound.resize(self.rows.len() + free, 0.0);
    }

    /// Loads the first basis, or the cold one (all at base) if that is not dual
    /// feasible. False if neither is: a control point that costs less than nothing.
    fn start(&self, work: &mut Workspace) -> bool {
        if let Some(first) = &self.first {
            work.basis.clone_from(first);
            self.price(work);
            if work.dual.iter().all(|&y| y >= 0.0) {
                return true;
            }
        }
        let free = self.controls - 2;
        work.basis.active.clear();
        work.basis
            .active
            .extend(self.rows.len()..self.rows.len() + free);
        work.basis.inverse.clear();
        work.basis.inverse.resize(free * free, 0.0);
        for i in 0..free {
            work.basis.inverse[i * free + i] = 1.0;
        }
        self.price(work);
        work.dual.iter().all(|&y| y >= 0.0)
    }

    /// Primal and dual values of the basis.
    fn price(&self, work: &mut Workspace) {
        let free = self.controls - 2;
        work.x.clear();
        work.x.resize(free, 0.0);
        work.dual.clear();
        for (i, &constraint) in work.basis.active.iter().enumerate() {
            let column = &work.basis.inverse[i * free..(i + 1) * free];
            let bound = work.bound[constraint];
            for (x, m) in work.x.iter_mut().zip(column) {
                *x += bound * m;
            }
            let dual = work.cost.iter().zip(column).map(|(c, m)| c * m).sum();
            work.dual.push(dual);
        }
    }

    /// The most violated constraint and by how much.
    fn most_violated(&self, work: &Workspace) -> Option<(usize, f64)> {
        let mut worst = (usize::MAX, TOLERANCE_M);
        for (k, &bound) in work.bound[..self.rows.len()].iter().enumerate() {
            let value: f64 = self.free_weights(k).map(|(j, w)| w * work.x[j]).sum();
            if bound - value > worst.1 {
                worst = (k, bound - value);
            }
        }
        for (j, &x) in work.x.iter().enumerate() {
            if -x > worst.1 {
                worst = (self.rows.len() + j, -x);
            }
        }
        (worst.0 != usize::MAX).then_some(worst)
    }

    /// Dual simplex; false if it does not end within a bound far above what it needs.
    fn pivot_until_feasible(&self, work: &mut Workspace) -> bool {
        let free = self.controls - 2;
        for _ in 0..10 * free + 50 {
            let Some((entering, violation)) = self.most_violated(work) else {
                return true;
            };
            // The entering row in terms of the basis.
            work.pivot_row.clear();
            for column in work.basis.inverse.chunks_exact(free) {
                work.pivot_row.push(if entering < self.rows.len() {
                    self.free_weights(entering)
                        .map(|(j, w)| w * column[j])
                        .sum()
                } else {
                    column[entering - self.rows.len()]
                });
            }
            let leaving = (0..free)
                .filter(|&i| work.pivot_row[i] > PIVOT)
                .min_by(|&a, &b| {
                    let ratio = |i: usize| work.dual[i] / work.pivot_row[i];
                    ratio(a).total_cmp(&ratio(b))
                });
            let Some(leaving) = leaving else {
                return false;
            };
            exchange(work, leaving, entering, violation);
        }
        false
    }

    /// The fallback: every control point as high as the floor anywhere it reaches.
    /// Clears the floor because the weights of a sample are a mean.
    fn lift(&self, floor_m: &[f64], amsl_m: &mut [f64]) {
        let last = self.controls - 1;
        amsl_m[1..last].fill(f64::NEG_INFINITY);
        for (k, &floor) in floor_m.iter().enumerate() {
            for (j, weight) in self.free_weights(k) {
                if weight > 0.0 {
                    amsl_m[j + 1] = amsl_m[j + 1].max(floor);
                }
            }
        }
    }
}

/// One pivot: constraint `entering`, violated by so much, replaces the active one at
/// `leaving`.
fn exchange(work: &mut Workspace, leaving: usize, entering: usize, violation: f64) {
    let free = work.x.len();
    let pivot = work.pivot_row[leaving];
    let ratio = work.dual[leaving] / pivot;
    let (before, rest) = work.basis.inverse.split_at_mut(leaving * free);
    let (column, after) = rest.split_at_mut(free);
    column.iter_mut().for_each(|m| *m /= pivot);
    for (x, m) in work.x.iter_mut().zip(column.iter()) {
        *x += violation * m;
    }
    let others = before.chunks_exact_mut(free).enumerate().chain(
        after
            .chunks_exact_mut(free)
            .enumerate()
            .map(|(i, other)| (leaving + 1 + i, other)),
    );
    for (i, other) in others {
        let share = work.pivot_row[i];
        work.dual[i] = (work.dual[i] - ratio * share).max(0.0);
        for (m, p) in other.iter_mut().zip(column.iter()) {
            *m -= share * p;
        }
    }
    work.dual[leaving] = ratio;
    work.basis.active[leaving] = entering;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::Basis;
    use proptest::prelude::*;

    fn rows(controls: usize, samples: usize) -> Vec<Row> {
        let basis = Basis::uniform(controls, samples);
        (0..samples).map(|k| basis.row(k)).collect()
    }

    fn altitudes(rows: &[Row], z: &[f64]) -> Vec<f64> {
        rows.iter()
            .map(|(first, w)| (0..4).map(|i| w[i] * z[first + i]).sum())
            .collect()
    }

    fn solve(rows: &[Row], floor: &[f64], weights: &[f64], ends: (f64, f64)) -> Vec<f64> {
        let controls = rows.last().expect("rows").0 + 4;
        let mut z = vec![0.0; controls];
        (z[0], z[controls - 1]) = ends;
        LowestSpline::new(rows.to_vec(), controls).solve(
            floor,
            weights,
            &mut z,
            &mut Workspace::default(),
        );
        z
    }

    #[test]
    fn over_a_flat_floor_the_path_is_flat() {
        let rows = rows(10, 101);
        let z = solve(&rows, &[460.0; 101], &[1.0; 101], (460.0, 460.0));
        assert!(z.iter().all(|z| (z - 460.0).abs() < 1e-3), "{z:?}");
    }

    proptest! {
        /// A law of linear programs: no feasible point costs less.
        #[test]
        fn no_spline_over_the_floor_is_lower(
            peaks in prop::collection::vec((0.15..0.85_f64, 50.0..900.0_f64, 0.02..0.3_f64), 1..5),
            speeds in prop::collection::vec(0.2..3.0_f64, 101),
            moves in prop::collection::vec(prop::collection::vec(-40.0..40.0_f64, 8), 40),
        ) {
            let rows = rows(10, 101);
            let floor: Vec<f64> = (0..101).map(|k| {
                let u = f64::from(k) / 100.0;
                100.0 + peaks.iter()
                    .map(|(at, height, width)| height * (-((u - at) / width).powi(2)).exp())
                    .sum::<f64>()
            }).collect();
            let z = solve(&rows, &floor, &speeds, (floor[0] + 20.0, floor[100] + 20.0));
            let lowest = LowestSpline::new(rows.clone(), 10);
            let height = |z: &[f64]| -> f64 {
                altitudes(&rows, z).iter().zip(&speeds).map(|(a, w)| a * w).sum()
            };
            let short_by = |z: &[f64]| -> f64 {
                altitudes(&rows, z).iter().zip(&floor).zip(&lowest.binding)
                    .filter(|(_, binding)| **binding)
                    .map(|((a, h), _)| h - a)
                    .fold(f64::NEG_INFINITY, f64::max)
            };
            prop_assert!(short_by(&z) < 1e-3);
            for change in &moves {
                let mut other = z.clone();
                for (value, change) in other[1..9].iter_mut().zip(change) {
                    *value += change;
                }
                // Lifted as far as it is short: feasible.
                let lift = short_by(&other).max(0.0) / (1.0 - END_WEIGHT);
                other[1..9].iter_mut().for_each(|value| *value += lift);
                prop_assert!(height(&other) >= height(&z) - 0.1, "{} < {}", height(&other), height(&z));
            }
        }

        #[test]
        fn the_fallback_clears_the_floor(floor in prop::collection::vec(0.0..500.0_f64, 101)) {
            let rows = rows(10, 101);
            let lowest = LowestSpline::new(rows.clone(), 10);
            let mut z = vec![500.0; 10];
            lowest.lift(&floor, &mut z);
            for ((altitude, h), _) in altitudes(&rows, &z).iter().zip(&floor).zip(0..) {
                prop_assert!(*altitude >= h - 1e-9);
            }
        }
    }
}
