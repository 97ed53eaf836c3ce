//! Search, and nothing but search: it must not know what is optimised.

mod adapted;
mod evaluator;
mod literal;
mod msfoa;

pub use evaluator::{Evaluator, TracePoint};
pub use literal::{LiteralParameters, Step};
pub use msfoa::{MsfoaParameters, Start};

use rand_chacha::ChaCha8Rng;

/// What an algorithm minimises: costs of points in the unit cube.
///
/// There is no randomness in it, so batches may be evaluated in any order and
/// on any number of threads with the same result.
pub trait Problem: Sync {
    /// Number of decision variables; each lies in `[0, 1]`.
    fn dimension(&self) -> usize;

    /// Costs of a batch.
    ///
    /// `candidates` is row-major, `costs.len()` rows of [`Self::dimension`].
    /// A cost above `cutoff` need not be exact, only above `cutoff`; pass
    /// `f64::INFINITY` for exact costs. A cost is never NaN.
    fn evaluate(&self, candidates: &[f64], cutoff: f64, costs: &mut [f64]);
}

/// The algorithms, with their parameters.
#[derive(Clone, Debug, PartialEq)]
pub enum Algorithm {
    /// Sub-swarms in given starts, adapted steps, racing: the default.
    Msfoa(MsfoaParameters),
    /// Algorithm 2 of the paper, with a constant or a shrinking local step.
    MsfoaLiteral(LiteralParameters),
}

/// A point and its cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Its place in the unit cube.
    pub position: Vec<f64>,
    /// What it costs.
    pub cost: f64,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The best points of the sub-swarms, best first; the first is the best of
    /// all that were evaluated. Empty only if the budget was.
    pub finalists: Vec<Candidate>,
    /// Evaluations spent: never more than the budget.
    pub evaluations: usize,
    /// The best cost after so many evaluations, one point for each improvement.
    pub trace: Vec<TracePoint>,
}

/// Minimises a problem within a budget of evaluations.
///
/// All numbers are drawn on the calling thread from `rng`; only evaluations run
/// in parallel, so the outcome does not depend on the number of threads.
/// `starts` are where the sub-swarms of [`Algorithm::Msfoa`] begin, the most
/// promising first; the literal algorithm starts at random, as printed.
#[must_use]
pub fn minimise<P: Problem + ?Sized>(
    problem: &P,
    algorithm: &Algorithm,
    starts: &[Start],
    budget: usize,
    rng: &mut ChaCha8Rng,
    watch: &(dyn Fn(TracePoint) + Sync),
) -> Outcome {
    let mut evaluator = Evaluator::new(problem, budget, watch);
    let mut finalists = match algorithm {
        Algorithm::Msfoa(parameters) => msfoa::search(&mut evaluator, parameters, starts, rng),
        Algorithm::MsfoaLiteral(parameters) => literal::search(&mut evaluator, parameters, rng),
    };
    finalists.extend(evaluator.best().cloned());
    finalists.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    finalists.dedup_by(|a, b| a.position == b.position);
    Outcome {
        finalists,
        evaluations: evaluator.spent(),
        trace: evaluator.into_trace(),
    }
}
