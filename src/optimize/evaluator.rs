//! The budget: every evaluation is counted, and none beyond it is made.

use rayon::prelude::*;

use super::{Candidate, Problem};

/// Candidates, one a row, of one parallel task. Small enough that one swarm fills two threads.
const ROWS_PER_TASK: usize = 8;

/// The best cost known after a number of evaluations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracePoint {
    /// Evaluations made so far, the one that found `best` included.
    pub evaluations: usize,
    /// The least cost so far.
    pub best: f64,
}

/// Evaluates batches of a problem: counts exactly, clips to the budget, and
/// keeps the best point and the trace of convergence.
pub struct Evaluator<'a, P: Problem + ?Sized> {
    problem: &'a P,
    /// Whether the relaxed problem is evaluated, if there is one.
    is_relaxed: bool,
    budget: usize,
    spent: usize,
    best: Option<Candidate>,
    trace: Vec<TracePoint>,
    /// The best and the trace of the problem itself, while the relaxed one is evaluated.
    set_aside: (Option<Candidate>, Vec<TracePoint>),
    watch: &'a (dyn Fn(TracePoint) + Sync),
}

impl<'a, P: Problem + ?Sized> Evaluator<'a, P> {
    /// An evaluator that makes at most `budget` evaluations and reports to `watch`
    /// after every batch.
    #[must_use]
    pub fn new(problem: &'a P, budget: usize, watch: &'a (dyn Fn(TracePoint) + Sync)) -> Self {
        Self {
            problem,
            is_relaxed: false,
            budget,
            spent: 0,
            best: None,
            trace: Vec::new(),
            set_aside: (None, Vec::new()),
            watch,
        }
    }

    /// Number of decision variables.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.problem.dimension()
    }

    /// Evaluations allowed in all.
    #[must_use]
    pub fn budget(&self) -> usize {
        self.budget
    }

    /// Evaluations made.
    #[must_use]
    pub fn spent(&self) -> usize {
        self.spent
    }

    /// Whether the budget is used up.
    #[must_use]
    pub fn is_exhausted(&self) -> bool {
        self.spent >= self.budget
    }

    /// The best point so far.
    #[must_use]
    pub fn best(&self) -> Option<&Candidate> {
        self.best.as_ref()
    }

    /// The trace of convergence.
    #[must_use]
    pub fn into_trace(self) -> Vec<TracePoint> {
        self.trace
    }

    /// Evaluates the relaxed problem from now on, if there is one; the best so far is set aside.
    /// Whether there is.
    pub fn relax(&mut self) -> bool {
        if !self.is_relaxed && self.problem.relaxed().is_some() {
            self.is_relaxed = true;
            self.set_aside = (self.best.take(), std::mem::take(&mut self.trace));
        }
        self.is_relaxed
    }

    /// Evaluates the problem itself again: what the relaxed one cost is forgotten, and the best is
    /// what it was before. Whether it was relaxed.
    pub fn restore(&mut self) -> bool {
        let was_relaxed = std::mem::replace(&mut self.is_relaxed, false);
        if was_relaxed {
            (self.best, self.trace) = std::mem::take(&mut self.set_aside);
        }
        was_relaxed
    }

    /// Groups of variables with known parts of a cost.
    #[must_use]
    pub fn groups(&self) -> usize {
        self.problem.groups()
    }

    /// Costs of the rows of `candidates`, in order. Rows beyond the budget are
    /// not evaluated and cost infinity, as does a row whose cost is not a number.
    #[must_use]
    pub fn evaluate(&mut self, candidates: &[f64]) -> Vec<f64> {
        let count = candidates.len() / self.dimension().max(1);
        let mut candidates = candidates.to_vec();
        let unchanged = |_: usize, (): &mut (), _: &mut [f64]| ();
        let mut sources = vec![(); count];
        let (costs, _) = self.evaluate_generated(&mut candidates, &mut sources, unchanged, false);
        costs
    }

    /// The same of candidates that are generated just before they are evaluated, by `generate` from
    /// their number and one of `sources`; and the parts of each cost that groups of variables may
    /// change, row by row: infinite for rows that are not evaluated. If not `in_parts`, the only part
    /// is the cost.
    #[must_use]
    pub fn evaluate_generated<T: Send>(
        &mut self,
        candidates: &mut [f64],
        sources: &mut [T],
        generate: impl Fn(usize, &mut T, &mut [f64]) + Sync,
        in_parts: bool,
    ) -> (Vec<f64>, Vec<f64>) {
        let (problem, relaxed) = (self.problem, self.relaxed());
        if in_parts {
            let evaluate = |rows: &[f64], costs: &mut [f64], parts: &mut [f64]| match relaxed {
                Some(relaxed) => relaxed.evaluate_parts(rows, costs, parts),
                None => problem.evaluate_parts(rows, costs, parts),
            };
            self.batch(candidates, sources, problem.groups(), generate, evaluate)
        } else {
            let evaluate = |rows: &[f64], costs: &mut [f64], _: &mut [f64]| match relaxed {
                Some(relaxed) => relaxed.evaluate(rows, costs),
                None => problem.evaluate(rows, costs),
            };
            let (costs, _) = self.batch(candidates, sources, 1, generate, evaluate);
            (costs.clone(), costs)
        }
    }

    fn relaxed(&self) -> Option<&'a dyn Problem> {
        self.problem.relaxed().filter(|_| self.is_relaxed)
    }

    fn batch<T: Send>(
        &mut self,
        candidates: &mut [f64],
        sources: &mut [T],
        groups: usize,
        generate: impl Fn(usize, &mut T, &mut [f64]) + Sync,
        evaluate: impl Fn(&[f64], &mut [f64], &mut [f64]) + Sync,
    ) -> (Vec<f64>, Vec<f64>) {
        let dimension = self.dimension().max(1);
        let count = sources.len().min(candidates.len() / dimension);
        let allowed = count.min(self.budget - self.spent);
        let mut costs = vec![f64::INFINITY; count];
        let mut parts = vec![f64::INFINITY; count * groups];
        let generate_all = |first: usize, rows: &mut [f64], sources: &mut [T]| {
            let rows = rows.chunks_exact_mut(dimension).zip(sources);
            for (number, (row, source)) in (first..).zip(rows) {
                generate(number, source, row);
            }
        };
        let (within_budget, beyond_budget) = candidates.split_at_mut(allowed * dimension);
        let (sources, sources_beyond) = sources.split_at_mut(allowed);
        generate_all(allowed, beyond_budget, sources_beyond);
        within_budget
            .par_chunks_mut(ROWS_PER_TASK * dimension)
            .zip(sources.par_chunks_mut(ROWS_PER_TASK))
            .zip(costs[..allowed].par_chunks_mut(ROWS_PER_TASK))
            .zip(parts[..allowed * groups].par_chunks_mut(ROWS_PER_TASK * groups))
            .enumerate()
            .for_each(|(task, (((rows, sources), costs), parts))| {
                generate_all(task * ROWS_PER_TASK, rows, sources);
                evaluate(rows, costs, parts);
            });
        for (number, cost) in costs[..allowed].iter_mut().enumerate() {
            if cost.is_nan() {
                *cost = f64::INFINITY;
            }
            self.fold(
                self.spent + number + 1,
                *cost,
                &candidates[number * dimension..][..dimension],
            );
        }
        self.spent += allowed;
        if let Some(best) = self.set_aside.0.as_ref().or(self.best.as_ref()) {
            (self.watch)(TracePoint {
                evaluations: self.spent,
                best: best.cost,
            });
        }
        (costs, parts)
    }

    fn fold(&mut self, evaluations: usize, cost: f64, position: &[f64]) {
        if self.best.as_ref().is_none_or(|best| cost < best.cost) {
            self.best = Some(Candidate {
                position: position.to_vec(),
                cost,
            });
            self.trace.push(TracePoint {
                evaluations,
                best: cost,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Costs the first variable, NaN beyond 0.9; counts its calls.
    struct Counting(AtomicUsize);

    impl Problem for Counting {
        fn dimension(&self) -> usize {
            2
        }

        fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
            self.0.fetch_add(costs.len(), Ordering::Relaxed);
            for (cost, row) in costs.iter_mut().zip(candidates.chunks(2)) {
                *cost = if row[0] > 0.9 { f64::NAN } else { row[0] };
            }
        }
    }

    #[test]
    fn the_budget_is_never_exceeded_and_every_call_is_counted() {
        let problem = Counting(AtomicUsize::new(0));
        let mut evaluator = Evaluator::new(&problem, 30, &|_| ());
        let batch: Vec<f64> = (0..40).map(|i| f64::from(i) / 100.0).collect();
        let first = evaluator.evaluate(&batch);
        let second = evaluator.evaluate(&batch);
        assert_eq!(evaluator.spent(), 30);
        assert_eq!(problem.0.load(Ordering::Relaxed), 30);
        assert!(first.iter().all(|cost| cost.is_finite()));
        assert_eq!(second.iter().filter(|cost| cost.is_finite()).count(), 10);
        assert!(evaluator.is_exhausted());
    }

    #[test]
    fn a_cost_that_is_no_number_counts_as_infinite_and_the_trace_falls() {
        let problem = Counting(AtomicUsize::new(0));
        let mut evaluator = Evaluator::new(&problem, 100, &|_| ());
        let costs = evaluator.evaluate(&[0.95, 0.0, 0.5, 0.0, 0.7, 0.0, 0.2, 0.0]);
        assert!(costs[0].is_infinite());
        assert_eq!(
            evaluator.best().map(|best| best.position.clone()),
            Some(vec![0.2, 0.0])
        );
        let trace = evaluator.into_trace();
        let points: Vec<usize> = trace.iter().map(|point| point.evaluations).collect();
        assert_eq!(points, [1, 2, 4]);
    }

    /// `Counting`, and half of its costs at first.
    struct Easing(Counting, Half);

    struct Half;

    impl Problem for Half {
        fn dimension(&self) -> usize {
            2
        }

        fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
            for (cost, row) in costs.iter_mut().zip(candidates.chunks(2)) {
                *cost = 0.5 * row[0];
            }
        }
    }

    impl Problem for Easing {
        fn dimension(&self) -> usize {
            2
        }

        fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
            self.0.evaluate(candidates, costs);
        }

        fn relaxed(&self) -> Option<&dyn Problem> {
            Some(&self.1)
        }
    }

    #[test]
    fn costs_of_the_relaxed_problem_are_neither_best_nor_reported() {
        let problem = Easing(Counting(AtomicUsize::new(0)), Half);
        let shown = std::sync::Mutex::new(Vec::new());
        let watch = |point: TracePoint| shown.lock().expect("no panic").push(point.best);
        let mut evaluator = Evaluator::new(&problem, 100, &watch);
        assert_eq!(evaluator.evaluate(&[0.6, 0.0]), [0.6]);
        assert!(evaluator.relax());
        assert_eq!(evaluator.evaluate(&[0.4, 0.0]), [0.2]);
        assert!(evaluator.restore());
        assert_eq!(evaluator.best().map(|best| best.cost), Some(0.6));
        assert_eq!(evaluator.evaluate(&[0.5, 0.0]), [0.5]);
        assert_eq!(evaluator.spent(), 3);
        let costs: Vec<f64> = evaluator.into_trace().iter().map(|at| at.best).collect();
        assert_eq!(costs, [0.6, 0.5]);
        assert_eq!(*shown.lock().expect("no panic"), [0.6, 0.6, 0.5]);
    }
}
