//! Which constraints a spline violates, and by how much.

use fearless_simd::prelude::*;

use super::simplex::{Constraint, PAD, greatest};
use super::{AltitudeLp, Demand, Workspace};

/// Parts of the path in which violations are looked for apart.
const STRETCHES: usize = 4;
/// Violation that counts as none, metres.
pub(crate) const TOLERANCE_M: f64 = 1e-6;

impl AltitudeLp {
    /// By how much every constraint is violated, metres: floors, rises, drops, each padded
    /// to a multiple of [`PAD`].
    #[inline(always)]
    fn measure<S: Simd>(&self, simd: S, demand: &Demand, with_slopes: bool, work: &mut Workspace) {
        let count = self.rows.len();
        self.spans.sample(simd, &work.z, &mut work.samples);
        let padded = count.next_multiple_of(PAD);
        let kinds = if with_slopes { 3 } else { 1 };
        if work.gaps.len() != kinds * padded {
            work.gaps.clear();
            work.gaps.resize(kinds * padded, f64::NEG_INFINITY);
        }
        let (floors, slopes) = work.gaps.split_at_mut(padded);
        for ((gap, floor), altitude) in floors.iter_mut().zip(&work.floor).zip(&work.samples) {
            *gap = floor - altitude;
        }
        let (ups, downs) = slopes.split_at_mut(slopes.len() / 2);
        let rises = work.samples[1..].iter().zip(&work.samples);
        let limits = demand.up_m.iter().zip(&demand.down_m);
        for (((up, down), (b, a)), (up_m, down_m)) in
            ups.iter_mut().zip(downs).zip(rises).zip(limits)
        {
            *up = b - a - up_m;
            *down = a - b - down_m;
        }
    }

    /// The most violated constraints, one of each stretch of the path, and the most violated
    /// base: those of other stretches hardly feel one another, so one look serves them all.
    #[inline(always)]
    pub(crate) fn most_violated<S: Simd>(
        &self,
        simd: S,
        demand: &Demand,
        with_slopes: bool,
        work: &mut Workspace,
    ) {
        self.measure(simd, demand, with_slopes, work);
        work.entering.clear();
        let padded = self.rows.len().next_multiple_of(PAD);
        let mut from = 0;
        for stretch in 1..=STRETCHES {
            let to = (padded * stretch / STRETCHES).next_multiple_of(PAD);
            let mut worst = (Constraint::Floor(0), TOLERANCE_M);
            for (kind, gaps) in work.gaps.chunks_exact(padded).enumerate() {
                if let Some((index, violation)) = greatest(simd, &gaps[from..to], worst.1) {
                    let k = from + index;
                    let constraint = match kind {
                        0 => Constraint::Floor(k),
                        1 => Constraint::Up(k),
                        _ => Constraint::Down(k),
                    };
                    worst = (constraint, violation);
                }
            }
            if worst.1 > TOLERANCE_M {
                work.entering.push(worst.0);
            }
            from = to;
        }
        let mut deepest = (0, -TOLERANCE_M);
        for (control, &z) in work.z.iter().enumerate().take(self.controls - 1).skip(1) {
            if z < deepest.1 {
                deepest = (control, z);
            }
        }
        if deepest.0 > 0 {
            work.entering.push(Constraint::Base(deepest.0));
        }
        if !work.ceilings.is_empty() {
            work.push_above();
        } else if work.ceiling.is_finite() {
            let heights = work.samples.iter().enumerate();
            let highest = heights.max_by(|a, b| a.1.total_cmp(b.1));
            let over = highest.filter(|(_, z)| **z > work.ceiling + TOLERANCE_M);
            work.entering
                .extend(over.map(|(k, _)| Constraint::Ceiling(k)));
        }
    }

    /// By how much a constraint is violated now, metres.
    #[inline(always)]
    pub(crate) fn violation(
        &self,
        constraint: Constraint,
        demand: &Demand,
        work: &Workspace,
    ) -> f64 {
        let altitude = |k: usize| {
            let (first, weights) = &self.rows[k];
            (0..4).map(|i| weights[i] * work.z[first + i]).sum::<f64>()
        };
        match constraint {
            Constraint::Floor(k) => work.floor[k] - altitude(k),
            Constraint::Up(k) => altitude(k + 1) - altitude(k) - demand.up_m[k],
            Constraint::Down(k) => altitude(k) - altitude(k + 1) - demand.down_m[k],
            Constraint::Base(control) => -work.z[control],
            Constraint::Ceiling(k) => altitude(k) - work.ceiling_at(k),
        }
    }
}

impl Workspace {
    /// The samples that are most above their ceilings, one of each stretch of the path.
    fn push_above(&mut self) {
        let count = self.samples.len();
        let stretch = count.div_ceil(STRETCHES).max(1);
        for from in (0..count).step_by(stretch) {
            let samples = from..count.min(from + stretch);
            let above = samples.map(|k| (k, self.samples[k] - self.ceilings[k]));
            let worst = above.max_by(|a, b| a.1.total_cmp(&b.1));
            let worst = worst.filter(|(_, above)| *above > TOLERANCE_M);
            self.entering
                .extend(worst.map(|(k, _)| Constraint::Ceiling(k)));
        }
    }
}
