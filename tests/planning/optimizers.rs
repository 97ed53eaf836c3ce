//! The algorithms on functions whose minimum is known.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use sortie::numeric::Seed;
use sortie::optimize::{
    AbcParameters, Algorithm, DeParameters, FoaParameters, IffoParameters, MfoaParameters,
    MsfoaParameters, Outcome, Problem, PsoParameters, PublishedParameters, SearchSeed, SearchSeeds,
    minimise,
};

#[derive(Clone, Copy)]
enum Function {
    /// Sum of squares around 0.3.
    Sphere,
    /// Rosenbrock's valley, over [-2, 2]; minimum 0 at 1.
    Rosenbrock,
    /// Rastrigin's field of pits, over [-2, 2]; minimum 0 at 0.
    Rastrigin,
}

struct Analytic {
    function: Function,
    dimension: usize,
    calls: AtomicUsize,
    left_the_cube: AtomicBool,
}

impl Analytic {
    fn new(function: Function, dimension: usize) -> Self {
        Self {
            function,
            dimension,
            calls: AtomicUsize::new(0),
            left_the_cube: AtomicBool::new(false),
        }
    }

    fn cost(&self, row: &[f64]) -> f64 {
        let wide: Vec<f64> = row.iter().map(|s| 4.0 * s - 2.0).collect();
        match self.function {
            Function::Sphere => row.iter().map(|s| (s - 0.3).powi(2)).sum(),
            Function::Rosenbrock => wide
                .windows(2)
                .map(|x| 100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2))
                .sum(),
            Function::Rastrigin => wide
                .iter()
                .map(|x| x * x + 10.0 * (1.0 - (std::f64::consts::TAU * x).cos()))
                .sum(),
        }
    }
}

impl Problem for Analytic {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
        self.calls.fetch_add(costs.len(), Ordering::Relaxed);
        for (cost, row) in costs.iter_mut().zip(candidates.chunks(self.dimension)) {
            if !row.iter().all(|s| (0.0..=1.0).contains(s)) {
                self.left_the_cube.store(true, Ordering::Relaxed);
            }
            *cost = self.cost(row);
        }
    }
}

fn default_parameters() -> Algorithm {
    Algorithm::Msfoa(MsfoaParameters {
        swarms: 5,
        flies: 16,
        threshold: 1000.0,
        step: 0.4,
        group: 1,
        racing: true,
        offspring: true,
        restarts: true,
    })
}

fn three_msfoa() -> [Algorithm; 3] {
    [
        default_parameters(),
        Algorithm::MsfoaLiteral(PublishedParameters::literal()),
        Algorithm::MsfoaLiteral(PublishedParameters::dwindle()),
    ]
}

fn rivals() -> [Algorithm; 6] {
    [
        Algorithm::Foa(FoaParameters::default()),
        Algorithm::Pso(PsoParameters::default()),
        Algorithm::De(DeParameters::default()),
        Algorithm::Abc(AbcParameters::default()),
        Algorithm::Iffo(IffoParameters::default()),
        Algorithm::Mfoa(MfoaParameters::default()),
    ]
}

fn all_algorithms() -> Vec<Algorithm> {
    let without_offspring = Algorithm::MsfoaLiteral(PublishedParameters {
        offspring: false,
        ..PublishedParameters::literal()
    });
    let reciprocal = Algorithm::Foa(FoaParameters {
        reciprocal: true,
        ..FoaParameters::default()
    });
    let midpoint = Algorithm::De(DeParameters {
        midpoint: true,
        ..DeParameters::default()
    });
    three_msfoa()
        .into_iter()
        .chain(rivals())
        .chain([without_offspring, reciprocal, midpoint])
        .collect()
}

fn run(problem: &Analytic, algorithm: &Algorithm, budget: usize, seed: u64) -> Outcome {
    let mut rng = Seed(seed).stream("test", 0);
    minimise(
        problem,
        algorithm,
        SearchSeeds::default(),
        budget,
        &mut rng,
        &|_| (),
    )
}

#[test]
fn every_algorithm_spends_its_budget_exactly_and_never_leaves_the_cube() {
    for algorithm in all_algorithms() {
        for budget in [0, 1, 7, 205, 1003, 5000] {
            let problem = Analytic::new(Function::Rastrigin, 6);
            let outcome = run(&problem, &algorithm, budget, 1);
            assert_eq!(outcome.evaluations, budget, "{algorithm:?}");
            assert_eq!(problem.calls.load(Ordering::Relaxed), budget);
            assert!(!problem.left_the_cube.load(Ordering::Relaxed));
            assert_eq!(outcome.finalists.is_empty(), budget == 0);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_trace_and_another_seed_another() {
    for algorithm in all_algorithms() {
        let outcome = |seed| {
            run(
                &Analytic::new(Function::Rosenbrock, 8),
                &algorithm,
                4000,
                seed,
            )
        };
        assert_eq!(outcome(5), outcome(5));
        assert_ne!(outcome(5).trace, outcome(6).trace);
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    for algorithm in all_algorithms() {
        let outcome = |threads| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool")
                .install(|| run(&Analytic::new(Function::Rastrigin, 10), &algorithm, 6000, 9))
        };
        let one = outcome(1);
        assert_eq!(one, outcome(2));
        assert_eq!(one, outcome(8));
    }
}

#[test]
fn the_trace_falls_and_ends_at_the_first_finalist() {
    for algorithm in all_algorithms() {
        let problem = Analytic::new(Function::Rastrigin, 6);
        let outcome = run(&problem, &algorithm, 5000, 2);
        assert!(
            outcome.trace.windows(2).all(
                |pair| pair[0].best > pair[1].best && pair[0].evaluations < pair[1].evaluations
            )
        );
        let last = outcome.trace.last().expect("something was found");
        let best = &outcome.finalists[0];
        assert_eq!(last.best.to_bits(), best.cost.to_bits());
        assert_eq!(problem.cost(&best.position).to_bits(), best.cost.to_bits());
        assert!(outcome.finalists.is_sorted_by(|a, b| a.cost <= b.cost));
    }
}

#[test]
fn the_default_finds_the_bottom_of_a_curved_valley() {
    let outcome = run(
        &Analytic::new(Function::Rosenbrock, 8),
        &default_parameters(),
        40_000,
        3,
    );
    assert!(
        outcome.finalists[0].cost < 1e-6,
        "{}",
        outcome.finalists[0].cost
    );
}

/// A chain of points, drawn to places and to one another: what it costs is a sum over points and
/// links, and each pair of variables changes few of them.
struct Chain {
    tells_parts: bool,
}

impl Chain {
    const POINTS: usize = 20;

    /// What a point costs, and its link to the next.
    fn costs(row: &[f64], point: usize) -> f64 {
        let square = |a: f64, b: f64| (a - b) * (a - b);
        let wanted = 0.5 + 0.3 * f64::from(u8::try_from(point).expect("few points")).sin();
        let linked = |axis: usize| {
            let here = row[2 * point + axis];
            let next = row.get(2 * point + 2 + axis).copied();
            square(here, wanted) + 3.0 * next.map_or(0.0, |next| square(here, next))
        };
        linked(0) + linked(1)
    }
}

impl Problem for Chain {
    fn dimension(&self) -> usize {
        2 * Self::POINTS
    }

    fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
        for (cost, row) in costs.iter_mut().zip(candidates.chunks(self.dimension())) {
            *cost = (0..Self::POINTS).map(|point| Self::costs(row, point)).sum();
        }
    }

    fn groups(&self) -> usize {
        if self.tells_parts { Self::POINTS } else { 1 }
    }

    fn evaluate_parts(&self, candidates: &[f64], costs: &mut [f64], parts: &mut [f64]) {
        self.evaluate(candidates, costs);
        if !self.tells_parts {
            parts.copy_from_slice(costs);
            return;
        }
        let rows = candidates.chunks(self.dimension());
        for (parts, row) in parts.chunks_mut(Self::POINTS).zip(rows) {
            for (point, part) in parts.iter_mut().enumerate() {
                let touched = point.saturating_sub(1)..=point;
                *part = touched.map(|point| Self::costs(row, point)).sum();
            }
        }
    }
}

#[test]
fn a_problem_that_tells_the_parts_of_its_costs_is_searched_faster() {
    let found = |tells_parts, budget| {
        let problem = Chain { tells_parts };
        let algorithm = default_parameters();
        let rng = &mut Seed(5).stream("test", 0);
        let outcome = minimise(
            &problem,
            &algorithm,
            SearchSeeds::default(),
            budget,
            rng,
            &|_| (),
        );
        outcome.finalists[0].cost
    };
    let bottom = found(false, 30_000);
    let (parts, whole) = (found(true, 3000) - bottom, found(false, 3000) - bottom);
    assert!(0.0 < parts && parts < 0.3 * whole, "{parts} {whole}");
}

/// A way down to 0.9 in both variables with a wall across it that may be lower at first.
struct Walled {
    height: f64,
    lower: Option<Box<Walled>>,
}

impl Walled {
    fn cost(&self, row: &[f64]) -> f64 {
        let wall = (1.0 - ((row[0] - 0.5) / 0.3).abs()).max(0.0);
        (row[0] - 0.9).abs() + (row[1] - 0.9).abs() + self.height * wall
    }

    fn search(&self, seed: u64) -> Outcome {
        let start = SearchSeed {
            mean: vec![0.15, 0.9],
            scale: vec![0.03; 2],
            class: 0,
        };
        let starts = SearchSeeds {
            given: std::slice::from_ref(&start),
            redraw: None,
        };
        let Algorithm::Msfoa(parameters) = default_parameters() else {
            unreachable!()
        };
        let alone = Algorithm::Msfoa(MsfoaParameters {
            swarms: 1,
            ..parameters
        });
        let mut rng = Seed(seed).stream("walled", 0);
        minimise(self, &alone, starts, 4000, &mut rng, &|_| ())
    }
}

impl Problem for Walled {
    fn dimension(&self) -> usize {
        2
    }

    fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
        for (cost, row) in costs.iter_mut().zip(candidates.chunks_exact(2)) {
            *cost = self.cost(row);
        }
    }

    fn relaxed(&self) -> Option<&dyn Problem> {
        let lower = self.lower.as_deref()?;
        Some(lower)
    }
}

#[test]
fn a_search_that_is_eased_at_first_gets_over_walls_and_ends_with_the_problem_itself() {
    let walled = |height, lower| Walled { height, lower };
    let high = walled(10.0, None);
    let relaxed = walled(10.0, Some(Box::new(walled(0.1, None))));
    for seed in 0..5 {
        let stuck = high.search(seed).finalists[0].cost;
        assert!(stuck > 0.4, "{stuck}");
        let outcome = relaxed.search(seed);
        assert!(
            outcome.finalists[0].cost < 1e-3,
            "{:?}",
            outcome.finalists[0]
        );
        for found in &outcome.finalists {
            let cost = high.cost(&found.position);
            assert_eq!(found.cost.to_bits(), cost.to_bits(), "{found:?}");
        }
        assert!(outcome.trace.is_sorted_by(|a, b| a.best > b.best));
        assert_eq!(outcome.evaluations, 4000);
        // What the lower wall costs is in no trace.
        assert!(
            outcome.trace[0].evaluations > 1000,
            "{:?}",
            outcome.trace[0]
        );
    }
}

#[test]
fn the_default_begins_where_it_is_told_and_stays_near_with_a_small_scale() {
    let start = SearchSeed {
        mean: vec![0.3; 4],
        scale: vec![1e-4; 4],
        class: 1,
    };
    let problem = Analytic::new(Function::Sphere, 4);
    let mut rng = Seed(1).stream("test", 0);
    let algorithm = Algorithm::Msfoa(MsfoaParameters {
        swarms: 1,
        flies: 16,
        threshold: 1000.0,
        step: 0.4,
        group: 1,
        racing: true,
        offspring: true,
        restarts: true,
    });
    let outcome = minimise(
        &problem,
        &algorithm,
        SearchSeeds {
            given: &[start],
            redraw: None,
        },
        64,
        &mut rng,
        &|_| (),
    );
    assert!(outcome.trace[0].best < 1e-6);
}

#[test]
fn the_default_beats_the_letter_and_dwindling_beats_a_constant_step() {
    let median = |algorithm: &Algorithm| {
        let mut costs: Vec<f64> = (0..9)
            .map(|seed| {
                let problem = Analytic::new(Function::Sphere, 16);
                run(&problem, algorithm, 10_000, seed).finalists[0].cost
            })
            .collect();
        costs.sort_by(f64::total_cmp);
        costs[4]
    };
    let [default, literal, dwindle] = three_msfoa().map(|algorithm| median(&algorithm));
    assert!(dwindle < literal, "{dwindle} {literal}");
    assert!(default < dwindle, "{default} {dwindle}");
}

#[test]
fn the_rivals_approach_the_bottom_as_far_as_their_steps_allow() {
    // FOA steps over the whole map for ever; of 16 variables it hits few.
    let limits = [0.3, 1e-3, 1e-6, 1e-4, 1e-3, 1e-5];
    for (algorithm, limit) in rivals().into_iter().zip(limits) {
        let problem = Analytic::new(Function::Sphere, 6);
        let first = run(&problem, &algorithm, 100, 4).finalists[0].cost;
        let cost = run(&problem, &algorithm, 20_000, 4).finalists[0].cost;
        assert!(
            cost < limit && cost < first,
            "{algorithm:?}: {first} to {cost}"
        );
    }
}

#[test]
fn an_iteration_of_msfoa_costs_two_evaluations_a_fly_or_one_without_offspring() {
    let printed = PublishedParameters::literal();
    assert_eq!(printed.evaluations(200), 5 + 200 * 200);
    let barren = PublishedParameters {
        offspring: false,
        ..printed
    };
    assert_eq!(barren.evaluations(200), 5 + 200 * 100);
}
