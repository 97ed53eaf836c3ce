//! MSFOA as it pays: several sub-swarms that start apart and race.
//!
//! From the paper (Shi, Zhang, Xia 2020, section 3.1): sub-swarms that search
//! independently; a global task with big steps (Eq. 7, 8) for a swarm whose cost is
//! above the threshold, a local one below; visual search, by which a swarm keeps the
//! place of its keenest fly; and the competition of offspring, by which swarms
//! exchange what they know (Eq. 14, 18, 19).
//!
//! Beyond it, as measured: swarms begin in given seeds instead of anywhere; local
//! steps are drawn from a distribution that each swarm adapts to what it smells
//! (`cma_es`); at first, and when a swarm begins again, limits are cheap to break, so
//! that swarms get from one good path to another (`Problem::relaxed`); swarms race, so
//! that the budget goes to the promising ones; one that gains nothing any more begins
//! again elsewhere; an offspring takes the first variables from one swarm and the rest
//! from another, which for paths is the first part of one route and the second of
//! another (a mixture in the middle, as printed, would lead between two routes, and
//! there the obstacle stands).

mod race;
mod swarm;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::cma_es::Adapted;
use super::{Candidate, Evaluator, Problem, Redraw, SearchSeeds};
use race::{drop_the_slow, survivors};
use swarm::{Flight, Swarm};

/// Where a sub-swarm begins.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchSeed {
    /// Centre, in the unit cube.
    pub mean: Vec<f64>,
    /// Unit of the steps, per variable.
    pub scale: Vec<f64>,
    /// Seeds of one class lead to the same valley: later rounds keep one of each.
    pub class: u64,
}

/// Parameters of the default algorithm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MsfoaParameters {
    /// Sub-swarms at the beginning of the race.
    pub swarms: usize,
    /// Flies in each sub-swarm, at least 4.
    pub flies: usize,
    /// Cost above which a swarm searches globally.
    pub threshold: f64,
    /// Standard deviation of the first local steps, in units of the scale of a seed.
    pub step: f64,
    /// Variables that belong together: offspring are cut between such groups.
    pub group: usize,
    /// Whether swarms race; otherwise all go on to the end.
    pub racing: bool,
    /// Whether swarms have offspring.
    pub offspring: bool,
    /// Whether a swarm that gains nothing begins again.
    pub restarts: bool,
}

/// Shares of the budget at which the rounds of the race end.
const ROUND_ENDS: [f64; 4] = [0.30, 0.55, 0.75, 1.0];
/// Rounds that search the relaxed problem.
const RELAXED_ROUNDS: usize = 1;
/// Evaluations from which on the relaxed problem is searched first: with fewer a swarm does not
/// get clean again in time, and crowded fleets then have to be planned once more.
pub const MIN_RELAXED_BUDGET: usize = 3500;
/// Evaluations for which a swarm that begins again searches the relaxed problem: without them it
/// mostly comes back to where it was.
const RELAXED_AGAIN: usize = 320;
/// Rounds in which a tired swarm begins in a seed that none has tried.
const FRESH_ROUNDS: usize = 2;
/// How often a tired swarm redraws its best place otherwise; else it stays there with a
/// new shape.
const REDRAWN: f64 = 0.7;
/// Share of the evaluations, as a fraction, after which swarms learn from whole flies.
const WHOLE: (usize, usize) = (4, 5);
/// Swarms that mate at the end of a round.
const PARENTS: usize = 4;

/// Runs until the budget is spent; returns the best of every swarm there was.
pub(super) fn search<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    parameters: &MsfoaParameters,
    seeds: SearchSeeds<'_>,
    rng: &mut ChaCha8Rng,
) -> Vec<Candidate> {
    let parameters = usable(parameters);
    let given = enough_seeds(seeds.given, evaluator.dimension(), parameters.swarms, rng);
    let mut unused = given.iter();
    let mut swarms: Vec<Swarm> = unused
        .by_ref()
        .take(parameters.swarms)
        .map(|seed| Swarm::new(seed, &parameters))
        .collect();
    let mut left_behind = Vec::new();
    // Swarms that stopped for another start: they take part in the race all the same.
    let mut resting = Vec::new();
    let is_relaxed = evaluator.budget() >= MIN_RELAXED_BUDGET && evaluator.relax();
    for (round, end) in ROUND_ENDS.into_iter().enumerate() {
        let last = round + 1 == ROUND_ENDS.len();
        let round_end = share(evaluator.budget(), end);
        while evaluator.spent() < round_end {
            generation(evaluator, &mut swarms, &parameters, rng);
            for swarm in &mut swarms {
                if !(parameters.restarts && swarm.is_tired(parameters.flies)) {
                    continue;
                }
                left_behind.push(swarm.best.clone());
                if let Some(seed) = unused.next().filter(|_| round < FRESH_ROUNDS) {
                    let fresh = Swarm::new(seed, &parameters);
                    resting.push(std::mem::replace(swarm, fresh));
                    continue;
                }
                begin_again(evaluator, swarm, seeds.redraw, &parameters, rng);
                if is_relaxed && round >= RELAXED_ROUNDS {
                    wander(evaluator, swarm, &parameters, rng);
                }
            }
        }
        if !last && parameters.racing {
            swarms.append(&mut resting);
        }
        if round + 1 == RELAXED_ROUNDS && evaluator.restore() {
            judge_again(evaluator, &mut swarms, &mut left_behind);
            judge_again(evaluator, &mut resting, &mut Vec::new());
        }
        if !last && parameters.offspring {
            compete(evaluator, &mut swarms, parameters.group);
        }
        if !last && parameters.racing {
            let keep = survivors(parameters.swarms, round + 1);
            left_behind.extend(drop_the_slow(&mut swarms, keep));
        }
    }
    let running = swarms.into_iter().chain(resting);
    left_behind.extend(running.flat_map(|swarm| [swarm.best, swarm.elite]));
    left_behind.retain(|candidate| candidate.cost.is_finite());
    left_behind
}

/// The parameters, raised to the least counts that the search works with.
fn usable(parameters: &MsfoaParameters) -> MsfoaParameters {
    MsfoaParameters {
        swarms: parameters.swarms.max(1),
        flies: parameters.flies.max(4),
        group: parameters.group.max(1),
        ..*parameters
    }
}

/// The given seeds, and random ones up to a count.
fn enough_seeds(
    given: &[SearchSeed],
    dimension: usize,
    count: usize,
    rng: &mut ChaCha8Rng,
) -> Vec<SearchSeed> {
    let mut seeds = given.to_vec();
    while seeds.len() < count {
        seeds.push(random_seed(dimension, rng));
    }
    seeds
}

/// What swarms found in the relaxed problem is judged by the problem itself, with the mean that
/// each has now; of what they left behind as many as there are swarms.
fn judge_again<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    swarms: &mut [Swarm],
    left_behind: &mut Vec<Candidate>,
) {
    left_behind.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    left_behind.truncate(swarms.len());
    let left = left_behind.iter().map(|left| left.position.as_slice());
    let rows: Vec<&[f64]> = left.chain(swarms.iter().flat_map(Swarm::found)).collect();
    let costs = evaluator.evaluate(&rows.concat());
    let (of_left, of_swarms) = costs.split_at(left_behind.len());
    for (left, cost) in left_behind.iter_mut().zip(of_left) {
        left.cost = *cost;
    }
    for (swarm, costs) in swarms.iter_mut().zip(of_swarms.chunks_exact(3)) {
        swarm.judge_again([costs[0], costs[1], costs[2]]);
    }
}

/// A seed anywhere, of its own class.
fn random_seed(dimension: usize, rng: &mut ChaCha8Rng) -> SearchSeed {
    SearchSeed {
        mean: (0..dimension).map(|_| rng.random()).collect(),
        scale: vec![0.5; dimension],
        class: rng.random(),
    }
}

fn share(budget: usize, part: f64) -> usize {
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a budget times a share of 1"
    )]
    let share = (budget as f64 * part).round() as usize;
    share.min(budget)
}

/// The flies of one generation, swarm after swarm: all numbers are drawn in one order.
fn flights(swarms: &[Swarm], parameters: &MsfoaParameters, rng: &mut ChaCha8Rng) -> Vec<Flight> {
    let flies = parameters.flies;
    let mut flights = Vec::with_capacity(swarms.len() * flies);
    for swarm in swarms {
        let task_is_global = swarm.best.cost.is_finite() && swarm.best.cost > parameters.threshold;
        // Half the flies of a global task keep adapting, so that a swarm that
        // stands near a way out still finds it.
        flights.extend((0..flies).map(|fly| match task_is_global && fly % 2 == 1 {
            true => Flight::Global(swarm.global_fly(rng)),
            false => Flight::Local(swarm.adapted.draw(rng)),
        }));
    }
    flights
}

/// One olfactory and visual search of all swarms, evaluated as one batch.
fn generation<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    swarms: &mut [Swarm],
    parameters: &MsfoaParameters,
    rng: &mut ChaCha8Rng,
) {
    let (dimension, flies) = (evaluator.dimension(), parameters.flies);
    let mut flights = flights(swarms, parameters, rng);
    let mut rows = vec![0.0; flights.len() * dimension];
    let fly = |number: usize, flight: &mut Flight, point: &mut [f64]| match flight {
        Flight::Local(draw) => swarms[number / flies].adapted.take(draw, point),
        Flight::Global(position) => point.copy_from_slice(position),
    };
    // What a window leaves out does not cancel: the last of a cost is found as a whole.
    let in_parts = evaluator.spent() * WHOLE.1 <= evaluator.budget() * WHOLE.0;
    let groups = if in_parts { evaluator.groups() } else { 1 };
    let (costs, parts) = evaluator.evaluate_generated(&mut rows, &mut flights, fly, in_parts);
    let seen = rows
        .par_chunks(flies * dimension)
        .zip(flights.par_chunks(flies));
    let smelt = costs
        .par_chunks(flies)
        .zip(parts.par_chunks(flies * groups));
    let swarms = swarms.par_iter_mut().zip(seen).zip(smelt);
    swarms.for_each(|((swarm, (rows, flights)), (costs, parts))| {
        let before = swarm.best.cost;
        let mut global_gain = false;
        for ((row, flight), cost) in rows.chunks(dimension).zip(flights).zip(costs) {
            global_gain |= matches!(flight, Flight::Global(_))
                && *cost < swarm.best.cost
                && before.is_finite();
            swarm.see(row, *cost);
        }
        swarm.learn(flights, costs, parts);
        if global_gain {
            swarm.adapted.move_to(&swarm.best.position);
        }
    });
}

/// A tired swarm begins in the best redrawing of its keenest fly, or around that with a
/// new shape.
fn begin_again<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    swarm: &mut Swarm,
    redraw: Option<&Redraw<'_>>,
    parameters: &MsfoaParameters,
    rng: &mut ChaCha8Rng,
) {
    let redraw = redraw.filter(|_| rng.random_bool(REDRAWN));
    match redraw {
        Some(redraw) => {
            let drawn = redraw(&swarm.elite.position, rng);
            let rows: Vec<f64> = drawn.iter().flat_map(|seed| &seed.mean).copied().collect();
            let costs = evaluator.evaluate(&rows);
            let best = drawn
                .into_iter()
                .zip(costs)
                .min_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((seed, _)) = best {
                let (class, elite) = (swarm.class, swarm.elite.clone());
                *swarm = Swarm {
                    class,
                    elite,
                    ..Swarm::new(&seed, parameters)
                };
            }
        }
        None => {
            swarm.adapted = Adapted::new(
                &swarm.elite.position,
                &swarm.scale,
                parameters.step,
                parameters.flies,
            );
            swarm.best = swarm.elite.clone();
            swarm.idle = 0;
            swarm.idle_cost = swarm.best.cost;
        }
    }
}

/// A swarm searches the relaxed problem for a while, if enough is left to get clean again.
fn wander<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    swarm: &mut Swarm,
    parameters: &MsfoaParameters,
    rng: &mut ChaCha8Rng,
) {
    let until = evaluator.spent() + RELAXED_AGAIN;
    if until + 2 * RELAXED_AGAIN >= evaluator.budget() || !evaluator.relax() {
        return;
    }
    let elite = swarm.set_out();
    while evaluator.spent() < until {
        generation(evaluator, std::slice::from_mut(swarm), parameters, rng);
    }
    evaluator.restore();
    let rows = [swarm.best.position.as_slice(), swarm.adapted.mean()].concat();
    let costs = evaluator.evaluate(&rows);
    swarm.come_back(elite, [costs[0], costs[1]]);
}

/// Competition of offspring among the best swarms: each takes the best of its
/// children that beats its own keenest fly.
fn compete<P: Problem + ?Sized>(
    evaluator: &mut Evaluator<'_, P>,
    swarms: &mut [Swarm],
    group: usize,
) {
    swarms.sort_by(|a, b| a.elite.cost.total_cmp(&b.elite.cost));
    let dimension = evaluator.dimension();
    let parents = swarms.len().min(PARENTS);
    let mut rows = Vec::new();
    let mut owners = Vec::new();
    for (g, first) in swarms[..parents].iter().enumerate() {
        for second in swarms[..parents].iter().filter(|s| s.class != first.class) {
            for cut in (group..dimension).step_by(group) {
                rows.extend_from_slice(&first.elite.position[..cut]);
                rows.extend_from_slice(&second.elite.position[cut..]);
                owners.push(g);
            }
        }
    }
    let costs = evaluator.evaluate(&rows);
    for (child, &owner) in owners.iter().enumerate() {
        let swarm = &mut swarms[owner];
        if costs[child] < swarm.elite.cost {
            swarm.see(&rows[child * dimension..][..dimension], costs[child]);
            swarm.adapted.move_to(&swarm.best.position);
        }
    }
}
