//! Optimisers over the unit cube, independent of what is optimised.

mod abc;
mod cma_es;
mod de;
mod evaluator;
mod fly;
mod foa;
mod iffo;
mod mfoa;
mod msfoa;
mod msfoa_published;
mod population;
mod pso;

pub use abc::AbcParameters;
pub use de::DeParameters;
pub use evaluator::{Evaluator, TracePoint};
pub use fly::Mapping;
pub use foa::FoaParameters;
pub use iffo::IffoParameters;
pub use mfoa::MfoaParameters;
pub use msfoa::{MIN_RELAXED_BUDGET, MsfoaParameters, SearchSeed};
pub use msfoa_published::{Parents, PublishedParameters, Step};
pub use pso::PsoParameters;

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
    /// A cost is never NaN.
    fn evaluate(&self, candidates: &[f64], costs: &mut [f64]);

    /// The relaxed problem, if there is one: the same variables with violated limits that cost
    /// less. A search may begin with it, and ends with the problem itself.
    fn relaxed(&self) -> Option<&dyn Problem> {
        None
    }

    /// Groups of neighbouring variables, equally many in each, with a known part of the cost that
    /// they may change. A single one where nothing is known.
    fn groups(&self) -> usize {
        1
    }

    /// Exact costs of a batch, and in `parts`, `costs.len()` rows of [`Self::groups`], what of
    /// each cost each group may change. Parts overlap where several groups change the same.
    fn evaluate_parts(&self, candidates: &[f64], costs: &mut [f64], parts: &mut [f64]) {
        self.evaluate(candidates, costs);
        for (parts, cost) in parts.chunks_exact_mut(self.groups()).zip(costs) {
            parts.fill(*cost);
        }
    }
}

/// The algorithms, with their parameters.
#[derive(Clone, Debug, PartialEq)]
pub enum Algorithm {
    /// Sub-swarms in given seeds, adapted steps, racing: the default.
    Msfoa(MsfoaParameters),
    /// Algorithm 2 of the paper, with a constant or a shrinking local step.
    MsfoaLiteral(PublishedParameters),
    /// Fruit fly optimisation, one swarm.
    Foa(FoaParameters),
    /// Particle swarm optimisation.
    Pso(PsoParameters),
    /// Differential evolution.
    De(DeParameters),
    /// Artificial bee colony.
    Abc(AbcParameters),
    /// Improved fruit fly optimisation.
    Iffo(IffoParameters),
    /// Multi-swarm fruit fly optimisation.
    Mfoa(MfoaParameters),
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
    /// The best cost by number of evaluations, one point for each improvement.
    pub trace: Vec<TracePoint>,
}

/// New seeds from a position: other encodings of nearly the same path, from which a search gets
/// further.
pub type Redraw<'a> = dyn Fn(&[f64], &mut ChaCha8Rng) -> Vec<SearchSeed> + 'a;

/// Where the sub-swarms of [`Algorithm::Msfoa`] begin, and begin again.
#[derive(Clone, Copy, Default)]
pub struct SearchSeeds<'a> {
    /// The most promising first.
    pub given: &'a [SearchSeed],
    /// What a swarm that gains nothing any more makes of its best place.
    pub redraw: Option<&'a Redraw<'a>>,
}

/// Minimises a problem within a budget of evaluations.
///
/// All numbers are drawn on the calling thread from `rng`; only evaluations run
/// in parallel, so the outcome does not depend on the number of threads.
/// Only the sub-swarms of [`Algorithm::Msfoa`] begin at `seeds`; all others start at
/// random, as printed.
#[must_use]
pub fn minimise<P: Problem + ?Sized>(
    problem: &P,
    algorithm: &Algorithm,
    seeds: SearchSeeds<'_>,
    budget: usize,
    rng: &mut ChaCha8Rng,
    watch: &(dyn Fn(TracePoint) + Sync),
) -> Outcome {
    let mut evaluator = Evaluator::new(problem, budget, watch);
    let evaluating = &mut evaluator;
    let mut finalists = Vec::new();
    match algorithm {
        Algorithm::Msfoa(of) => finalists = msfoa::search(evaluating, of, seeds, rng),
        Algorithm::MsfoaLiteral(of) => finalists = msfoa_published::search(evaluating, of, rng),
        Algorithm::Foa(of) => foa::search(evaluating, of, rng),
        Algorithm::Pso(of) => pso::search(evaluating, of, rng),
        Algorithm::De(of) => de::search(evaluating, of, rng),
        Algorithm::Abc(of) => abc::search(evaluating, of, rng),
        Algorithm::Iffo(of) => iffo::search(evaluating, of, rng),
        Algorithm::Mfoa(of) => finalists = mfoa::search(evaluating, of, rng),
    }
    finalists.extend(evaluator.best().cloned());
    finalists.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    finalists.dedup_by(|a, b| a.position == b.position);
    Outcome {
        finalists,
        evaluations: evaluator.spent(),
        trace: evaluator.into_trace(),
    }
}
