//! PSO: particle swarm optimisation with a falling inertia weight (Table 1: w from
//! 0.9 to 0.4, c1 = c2 = 2).
//!
//! What is left open, and how it is read here:
//!
//! - `v = w v + c1 r1 (p - x) + c2 r2 (g - x)`, r1 and r2 drawn for each variable;
//!   w falls linearly over the iterations, to 0.4 in the last one.
//! - Speed is limited to 0.2 of the map an iteration, a limit the paper does not print;
//!   [`PsoParameters::max_speed`] may be infinite.
//! - Positions are clamped to the map, and a clamped variable stops.
//! - Particles begin uniform and at rest; evaluating them is the first iteration.
//! - The best of all is brought up to date once in an iteration.
//! - One iteration evaluates M particles; NC follows from the budget.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{Evaluator, Problem, population};

/// Parameters of Table 1, and the speed limit it lacks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PsoParameters {
    /// Particles, M.
    pub population: usize,
    /// Inertia weight at the beginning and at the end.
    pub inertia: [f64; 2],
    /// Acceleration towards a particle's own best and towards the best of all.
    pub acceleration: [f64; 2],
    /// Most a variable changes in one iteration.
    pub max_speed: f64,
}

impl Default for PsoParameters {
    fn default() -> Self {
        Self {
            population: 100,
            inertia: [0.9, 0.4],
            acceleration: [2.0, 2.0],
            max_speed: 0.2,
        }
    }
}

/// One particle.
struct Particle {
    position: Vec<f64>,
    speed: Vec<f64>,
    best: Vec<f64>,
    best_cost: f64,
}

/// Runs until the budget is spent.
pub(super) fn search<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    parameters: &PsoParameters,
    rng: &mut ChaCha8Rng,
) {
    let dimension = evaluator.dimension();
    let count = parameters.population.max(1);
    let mut swarm: Vec<Particle> = (0..count)
        .map(|_| {
            let position = population::uniform(dimension, rng);
            Particle {
                best: position.clone(),
                speed: vec![0.0; dimension],
                best_cost: f64::INFINITY,
                position,
            }
        })
        .collect();
    // Moves between the first evaluation of all and the last.
    let moves = evaluator.budget().div_ceil(count).saturating_sub(1);
    let [first, last] = parameters.inertia;
    look(evaluator, &mut swarm);
    for iteration in 1..=moves {
        let inertia = first + (last - first) * population::share(iteration - 1, moves - 1);
        let Some(best) = evaluator.best().map(|best| best.position.clone()) else {
            return;
        };
        for particle in &mut swarm {
            particle.fly(inertia, &best, parameters, rng);
        }
        look(evaluator, &mut swarm);
    }
}

/// Evaluates all particles; each remembers its best.
fn look<P: Problem + ?Sized>(evaluator: &mut Evaluator<'_, P>, swarm: &mut [Particle]) {
    let rows: Vec<f64> = swarm
        .iter()
        .flat_map(|particle| particle.position.iter().copied())
        .collect();
    let costs = evaluator.evaluate(&rows);
    for (particle, cost) in swarm.iter_mut().zip(costs) {
        if cost < particle.best_cost {
            particle.best_cost = cost;
            particle.best.clone_from(&particle.position);
        }
    }
}

impl Particle {
    fn fly(
        &mut self,
        inertia: f64,
        best: &[f64],
        parameters: &PsoParameters,
        rng: &mut ChaCha8Rng,
    ) {
        let limit = parameters.max_speed;
        let [own, common] = parameters.acceleration;
        for (j, &best) in best.iter().enumerate() {
            let (r1, r2): (f64, f64) = (rng.random(), rng.random());
            let x = self.position[j];
            let speed =
                inertia * self.speed[j] + own * r1 * (self.best[j] - x) + common * r2 * (best - x);
            let speed = speed.clamp(-limit, limit);
            let to = (x + speed).clamp(0.0, 1.0);
            let is_clamped = !(0.0..=1.0).contains(&(x + speed));
            self.speed[j] = if is_clamped { 0.0 } else { speed };
            self.position[j] = to;
        }
    }
}
