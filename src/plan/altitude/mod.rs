//! The lowest spline over a floor: altitudes decoded exactly instead of searched.
//!
//! Over a fixed horizontal spline the altitude of every sample is linear in the
//! altitudes of the control points, so the lowest flight that clears a floor and
//! climbs and descends no faster than it may is a linear program in a handful of
//! variables,
//!
//! ```text
//! min sum_k w_k (B z)_k   subject to   (B z)_k >= floor_k,
//!                                      -down_k <= (B z)_{k+1} - (B z)_k <= up_k,
//!                                      z >= base,
//! ```
//!
//! solved by a revised dual simplex whose basis inverse is as small as the number of
//! free control points. The dual simplex starts from any dual feasible basis: that of the
//! neighbour solved just before, or else always the same one (one sample below each
//! control point). A caller that solves several marks where neighbours begin
//! ([`Workspace::begin_anew`]), so that equal batches give equal bytes on any thread.
//! Where slopes and floor cannot be met together the slopes are given up: the objective
//! will tell.
//!
//! Where a lower flight is not the cheaper one, `least_cost` then improves the altitudes by the true objective.

mod edges;
pub(super) mod floor;
pub(super) mod least_cost;
pub(super) mod simplex;
mod spans;
mod violated;

use fearless_simd::{Level, dispatch, prelude::*};
use nalgebra::DMatrix;

use simplex::{Basis, Constraint};
use spans::Spans;
use violated::TOLERANCE_M;

/// The weights of one sample: index of the first of four control points, and the
/// weight of each.
pub(super) type Row = (usize, [f64; 4]);

/// Where an end point weighs more than this the floor constrains only as far as a flight at
/// the slope limits reaches it: the free control points could meet more only by leaping.
const END_WEIGHT: f64 = 0.85;

/// Space over a floor that is above its ceiling, metres.
const OVER_CEILING_M: f64 = 10.0;

/// Finds the lowest spline over a floor, for one fixed parametrisation.
#[derive(Clone, Debug)]
pub(super) struct AltitudeLp {
    rows: Vec<Row>,
    /// The weights once more, as splines are sampled by them.
    spans: Spans,
    /// Whether the floor at a sample constrains, however high it is.
    binding: Vec<bool>,
    controls: usize,
    first: Option<Basis>,
    /// No sample may be higher, if the floor allows that, metres; mostly infinite: paths as low
    /// as they can be seldom rise so high.
    ceiling_m: f64,
    level: Level,
}

/// What a path has to keep, sample by sample.
#[derive(Clone, Debug, Default)]
pub(super) struct Demand {
    /// Lowest altitude at each sample, metres.
    pub floor_m: Vec<f64>,
    /// Highest altitude at each sample, metres; empty if nothing but [`AltitudeLp::under`] limits it.
    pub ceiling_m: Vec<f64>,
    /// Greatest rise from each sample to the next, metres.
    pub up_m: Vec<f64>,
    /// Greatest drop from each sample to the next, metres, positive.
    pub down_m: Vec<f64>,
    /// What altitude costs at each sample, not negative.
    pub weights: Vec<f64>,
    /// Ground under each sample, metres above the sea; once filled the floor before slopes raised it.
    pub ground_m: Vec<f64>,
    /// Scratch space for where pieces cross the edges of zones.
    pub crossings: Vec<(f64, i32)>,
}

/// What [`AltitudeLp::solve`] works in, kept between calls to save allocations.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace {
    cost: Vec<f64>,
    /// Altitudes of all control points, over base.
    z: Vec<f64>,
    /// Altitudes of the samples, over base.
    samples: Vec<f64>,
    /// Floor over base; nothing where it does not bind.
    floor: Vec<f64>,
    /// Ceiling over base.
    ceiling: f64,
    /// The same sample by sample; empty where it is the same everywhere.
    ceilings: Vec<f64>,
    /// By how much each constraint is violated: floors, rises, drops.
    gaps: Vec<f64>,
    dual: Vec<f64>,
    entering_row: Vec<f64>,
    bounds: Vec<f64>,
    /// Constraints to be let into the basis.
    entering: Vec<Constraint>,
    basis: Basis,
    /// Whether `basis` solved a neighbour, so that the next one may begin with it.
    solved: bool,
}

impl Workspace {
    /// The next floor begins with the first basis, not with that of the last one solved.
    pub(super) fn begin_anew(&mut self) {
        self.solved = false;
    }

    /// The ceiling at a sample, over base.
    fn ceiling_at(&self, sample: usize) -> f64 {
        self.ceilings.get(sample).copied().unwrap_or(self.ceiling)
    }
}

impl AltitudeLp {
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
        let mut lp = Self {
            spans: Spans::new(&rows),
            rows,
            binding,
            controls,
            first: None,
            ceiling_m: f64::INFINITY,
            level: Level::new(),
        };
        lp.first = lp.interpolation();
        lp
    }

    /// The same under a ceiling.
    pub(super) fn under(mut self, ceiling_m: f64) -> Self {
        self.ceiling_m = ceiling_m;
        self
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
        let mut basis = Basis {
            active: active.into_iter().map(Constraint::Floor).collect(),
            inverse: Vec::new(),
        };
        let stride = basis.stride();
        for row in inverse.row_iter() {
            basis.inverse.extend(row.iter());
            basis
                .inverse
                .resize(basis.inverse.len().next_multiple_of(stride), 0.0);
        }
        Some(basis)
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

    /// One coordinate at all samples, from that of the control points.
    pub(super) fn sample(&self, controls: &[f64], samples: &mut Vec<f64>) {
        dispatch!(self.level, simd => self.spans.sample(simd, controls, samples));
    }

    /// Fills the free altitudes of `amsl_m`, whose first and last are given.
    pub(super) fn solve(&self, demand: &Demand, amsl_m: &mut [f64], work: &mut Workspace) {
        dispatch!(self.level, simd => self.solve_by(simd, demand, amsl_m, work));
    }

    #[inline(always)]
    fn solve_by<S: Simd>(
        &self,
        simd: S,
        demand: &Demand,
        amsl_m: &mut [f64],
        work: &mut Workspace,
    ) {
        let (low, high) = demand
            .floor_m
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &h| {
                (low.min(h), high.max(h))
            });
        let base = low - (high - low) - 100.0;
        self.price_controls(&demand.weights, work);
        work.floor.clear();
        work.floor
            .extend(demand.floor_m.iter().map(|floor_m| floor_m - base));
        self.unbind_ends(
            demand,
            (amsl_m[0], amsl_m[self.controls - 1]),
            &mut work.floor,
        );
        // What cannot be met together is given up, the ceiling first.
        let is_open = self.ceiling_m.is_infinite() && demand.ceiling_m.is_empty();
        let first = usize::from(is_open);
        for (with_slopes, with_ceiling) in [(true, true), (true, false), (false, false)]
            .into_iter()
            .skip(first)
        {
            work.ceiling = match with_ceiling {
                true => self.ceiling_m - base,
                false => f64::INFINITY,
            };
            work.ceilings.clear();
            if with_ceiling {
                self.lay_ceilings(demand, (amsl_m[0], amsl_m[self.controls - 1]), base, work);
            }
            self.start(simd, demand, amsl_m, base, work);
            if self.exchange_until_feasible(simd, demand, with_slopes, work) {
                work.solved = with_slopes;
                let last = self.controls - 1;
                for (altitude, z) in amsl_m[1..last].iter_mut().zip(&work.z[1..last]) {
                    *altitude = base + z;
                }
                return;
            }
        }
        work.solved = false;
        self.lift(&demand.floor_m, amsl_m);
    }

    /// Near the ends the floor binds only as far as a flight at the slope limits reaches it.
    #[inline(always)]
    fn unbind_ends(&self, demand: &Demand, (from_m, to_m): (f64, f64), floor: &mut [f64]) {
        let samples = floor.len();
        let mut risen_m = from_m;
        for k in (0..samples).take_while(|&k| !self.binding[k]) {
            if k > 0 {
                risen_m += demand.up_m[k - 1];
            }
            if k == 0 || demand.floor_m[k] > risen_m {
                floor[k] = f64::NEG_INFINITY;
            }
        }
        let mut to_go_m = to_m;
        for k in (0..samples).rev().take_while(|&k| !self.binding[k]) {
            if k + 1 < samples {
                to_go_m += demand.down_m[k];
            }
            if k + 1 == samples || demand.floor_m[k] > to_go_m {
                floor[k] = f64::NEG_INFINITY;
            }
        }
    }

    /// The ceilings over base, not below the floor; at the ends and near them only as far as a
    /// flight at the slope limits comes down to them.
    fn lay_ceilings(
        &self,
        demand: &Demand,
        (from_m, to_m): (f64, f64),
        base: f64,
        work: &mut Workspace,
    ) {
        let top_m = self.ceiling_m;
        let ceilings = demand.ceiling_m.iter().map(|m| m.min(top_m) - base);
        work.ceilings.extend(ceilings);
        let Some(last) = work.ceilings.len().checked_sub(1) else {
            return;
        };
        let mut sunk_m = from_m - base;
        for k in (0..=last).take_while(|&k| !self.binding[k]) {
            if k > 0 {
                sunk_m -= demand.down_m[k - 1];
            }
            if k == 0 || work.ceilings[k] < sunk_m {
                work.ceilings[k] = f64::INFINITY;
            }
        }
        let mut to_rise_m = to_m - base;
        for k in (0..=last).rev().take_while(|&k| !self.binding[k]) {
            if k < last {
                to_rise_m -= demand.up_m[k];
            }
            if k == last || work.ceilings[k] < to_rise_m {
                work.ceilings[k] = f64::INFINITY;
            }
        }
        for (ceiling, floor) in work.ceilings.iter_mut().zip(&work.floor) {
            // Where no path is low enough, one that is little higher must be found quickly.
            if *ceiling < *floor {
                *ceiling = *floor + OVER_CEILING_M;
            }
        }
    }

    /// What the altitude of each control point costs.
    #[inline(always)]
    fn price_controls(&self, weights: &[f64], work: &mut Workspace) {
        work.cost.clear();
        work.cost.resize(self.controls, 0.0);
        self.spans.add_shares(&self.rows, weights, &mut work.cost);
    }

    /// Keeps the basis of the neighbour solved before, if there is one, else loads the
    /// first one, or, if neither is dual feasible, the cold one: all at base. That always
    /// is, because altitude costs are not negative.
    #[inline(always)]
    fn start<S: Simd>(
        &self,
        simd: S,
        demand: &Demand,
        amsl_m: &[f64],
        base: f64,
        work: &mut Workspace,
    ) {
        let (free, last) = (self.controls - 2, self.controls - 1);
        work.z.clear();
        work.z.resize(self.controls, 0.0);
        work.z[0] = amsl_m[0] - base;
        work.z[last] = amsl_m[last] - base;
        if std::mem::take(&mut work.solved) && self.touches(simd, demand, work) {
            return;
        }
        if let Some(first) = &self.first {
            work.basis.active.clone_from(&first.active);
            work.basis.inverse.clone_from(&first.inverse);
            if self.touches(simd, demand, work) {
                return;
            }
        }
        work.basis.active.clear();
        work.basis.active.extend((1..last).map(Constraint::Base));
        work.basis.inverse.clear();
        let stride = work.basis.stride();
        work.basis.inverse.resize(free * stride, 0.0);
        for i in 0..free {
            work.basis.inverse[i * stride + i] = 1.0;
        }
        self.price(simd, work);
    }

    /// Altitudes in the basis; false if it is not dual feasible, or holds a floor that
    /// does not bind.
    #[inline(always)]
    fn touches<S: Simd>(&self, simd: S, demand: &Demand, work: &mut Workspace) -> bool {
        self.price(simd, work);
        if work.dual.iter().any(|&y| y < 0.0) {
            return false;
        }
        let last = self.controls - 1;
        let ends = |k: usize| self.weight(k, 0) * work.z[0] + self.weight(k, last) * work.z[last];
        work.bounds.clear();
        for active in &work.basis.active {
            work.bounds.push(match *active {
                Constraint::Floor(k) => work.floor[k] - ends(k),
                Constraint::Up(k) => ends(k + 1) - ends(k) - demand.up_m[k],
                Constraint::Down(k) => ends(k) - ends(k + 1) - demand.down_m[k],
                Constraint::Base(_) => 0.0,
                Constraint::Ceiling(k) => ends(k) - work.ceiling_at(k),
            });
        }
        if work.bounds.iter().any(|bound| !bound.is_finite()) {
            return false;
        }
        work.z[1..last].fill(0.0);
        work.basis.add_times(&work.bounds, &mut work.z[1..last]);
        true
    }

    /// Dual values of the basis.
    #[inline(always)]
    fn price<S: Simd>(&self, simd: S, work: &mut Workspace) {
        let prices = &work.cost[1..self.controls - 1];
        work.basis
            .times(simd, prices.iter().copied().enumerate(), &mut work.dual);
    }

    /// Dual simplex; false if the constraints contradict one another, or if it does not
    /// end within a bound far above what it needs.
    #[inline(always)]
    fn exchange_until_feasible<S: Simd>(
        &self,
        simd: S,
        demand: &Demand,
        with_slopes: bool,
        work: &mut Workspace,
    ) -> bool {
        for _ in 0..10 * self.controls + 30 {
            self.most_violated(simd, demand, with_slopes, work);
            if work.entering.is_empty() {
                return true;
            }
            for n in 0..work.entering.len() {
                let entering = work.entering[n];
                let violation = self.violation(entering, demand, work);
                if violation > TOLERANCE_M && !self.exchange(simd, (entering, violation), work) {
                    return false;
                }
            }
        }
        false
    }

    /// Lets a violated constraint into the basis; false if none can leave for it, which is
    /// then because the constraints contradict one another.
    #[inline(always)]
    fn exchange<S: Simd>(
        &self,
        simd: S,
        (entering, violation): (Constraint, f64),
        work: &mut Workspace,
    ) -> bool {
        let last = self.controls - 1;
        // The entering row in terms of the basis.
        let (basis, row) = (&mut work.basis, &mut work.entering_row);
        let minus = |entry: (usize, f64)| (entry.0, -entry.1);
        match entering {
            Constraint::Floor(k) => basis.times(simd, self.free_weights(k), row),
            Constraint::Up(k) => {
                let next = self.free_weights(k + 1).map(minus);
                basis.times(simd, self.free_weights(k).chain(next), row);
            }
            Constraint::Down(k) => {
                let this = self.free_weights(k).map(minus);
                basis.times(simd, this.chain(self.free_weights(k + 1)), row);
            }
            Constraint::Ceiling(k) => basis.times(simd, self.free_weights(k).map(minus), row),
            Constraint::Base(control) => {
                basis.times(simd, std::iter::once((control - 1, 1.0)), row);
            }
        }
        let Some(leaving) = Basis::leaving(simd, row, &work.dual) else {
            return false;
        };
        basis.exchange(simd, leaving, entering, row, &mut work.dual);
        basis.shift(leaving, violation, &mut work.z[1..last]);
        true
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

#[cfg(test)]
mod tests;
