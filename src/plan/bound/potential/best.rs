//! Steps on one mesh, as long as they pay.

use super::solve::Solver;

/// Steps after which a potential is looked at, and after which the clock is.
const LOOK: usize = 50;
const CLOCK: usize = 10;
/// A bound that rises by no more than this share in these looks is left for the next mesh.
const TRIFLE: f64 = 2e-5;
const MAX_LOOKS: usize = 8;

/// The best potential of a search.
#[derive(Default)]
pub(super) struct Best {
    proven: f64,
    pub(super) potential: Vec<f64>,
    /// What was proven when it last rose by more than a trifle, and looks since then.
    risen: f64,
    looks: usize,
}

impl Best {
    fn look(&mut self, solver: &Solver<'_>) {
        let proven = solver.proven();
        if proven > self.proven || self.potential.is_empty() {
            self.proven = proven;
            self.potential.clone_from(&solver.potential);
        }
        self.looks += 1;
        if self.proven > self.risen * (1.0 + TRIFLE) {
            (self.risen, self.looks) = (self.proven, 0);
        }
    }
}

/// The best potential of some steps, or of fewer where it rises no more or the time is over.
pub(super) fn best_of(
    solver: &mut Solver<'_>,
    (balance, steps): (f64, usize),
    said: &dyn Fn(usize),
    is_over: &dyn Fn() -> bool,
) -> Best {
    let mut best = Best::default();
    for step in 1..=steps {
        solver.step(balance);
        let is_last = step % CLOCK == 0 && is_over();
        if step % LOOK == 0 || is_last {
            best.look(solver);
            said(step);
        }
        if is_last || best.looks >= MAX_LOOKS {
            break;
        }
    }
    best
}
