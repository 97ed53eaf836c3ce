//! The cheapest order of places between a first and a last one.
//!
//! Up to [`MAX_EXACT`] places the dynamic program of Held and Karp (1962) over subsets is exact.
//! Above, the nearest unvisited place and then exchanges (a part reversed, or moved) until none is
//! better, from several beginnings; the bound is that of Held and Karp (1970), spanning trees with
//! prices on places.

use rand::RngExt;

use crate::numeric::Seed;

/// Most places between the ends that are ordered exactly.
pub const MAX_EXACT: usize = 12;
/// Beginnings of the exchanges besides the first.
const KICKS: u32 = 60;
/// Steps of the bound.
const STEPS: u32 = 600;
/// Steps without a better bound after which they become shorter.
const PATIENCE: u32 = 12;
/// An exchange is better by this share of the cost at least.
const EPSILON: f64 = 1e-12;

/// An order of places.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// Indices of the places between the ends, from 0.
    pub order: Vec<usize>,
    /// What it costs.
    pub cost: f64,
    /// No order costs less.
    pub bound: f64,
}

/// The order of `costs.len() - 2` places: `costs[a][b]` is the cost from a to b, 0 the first place,
/// the last index the last one. None for fewer than two places, or rows of another length.
#[must_use]
pub fn best_order(costs: &[Vec<f64>]) -> Option<Sequence> {
    let count = costs.len().checked_sub(2)?;
    if costs.iter().any(|row| row.len() != costs.len()) {
        return None;
    }
    let path = match count {
        0 => vec![0, 1],
        1..=MAX_EXACT => exact(costs, count),
        _ => improved(costs, nearest(costs, count)),
    };
    let cost = cost_of(costs, &path);
    let bound = match count {
        0..=MAX_EXACT => cost,
        _ => bound(costs, cost).min(cost),
    };
    Some(Sequence {
        order: path[1..=count].iter().map(|place| place - 1).collect(),
        cost,
        bound,
    })
}

fn cost_of(costs: &[Vec<f64>], path: &[usize]) -> f64 {
    path.windows(2).map(|pair| costs[pair[0]][pair[1]]).sum()
}

/// All subsets of the places, by where they are left.
fn exact(costs: &[Vec<f64>], count: usize) -> Vec<usize> {
    let all = (1_usize << count) - 1;
    // Cost of the best way over a subset that ends at one of its places, and the place before.
    let mut best = vec![vec![(f64::INFINITY, usize::MAX); count]; all + 1];
    for last in 0..count {
        best[1 << last][last] = (costs[0][last + 1], usize::MAX);
    }
    for subset in 1..=all {
        for last in (0..count).filter(|last| subset >> last & 1 == 1) {
            let so_far = best[subset][last].0;
            for next in (0..count).filter(|next| subset >> next & 1 == 0) {
                let cost = so_far + costs[last + 1][next + 1];
                let entry = &mut best[subset | 1 << next][next];
                if cost < entry.0 {
                    *entry = (cost, last);
                }
            }
        }
    }
    let total = |last: &usize| best[all][*last].0 + costs[last + 1][count + 1];
    let mut at = (0..count)
        .min_by(|a, b| total(a).total_cmp(&total(b)))
        .unwrap_or(0);
    let (mut path, mut subset) = (vec![count + 1], all);
    while at != usize::MAX {
        path.push(at + 1);
        let before = best[subset][at].1;
        subset &= !(1 << at);
        at = before;
    }
    path.push(0);
    path.reverse();
    path
}

/// Always on to the nearest place that is left.
fn nearest(costs: &[Vec<f64>], count: usize) -> Vec<usize> {
    let mut path = vec![0];
    let mut left: Vec<usize> = (1..=count).collect();
    while !left.is_empty() {
        let row = &costs[path[path.len() - 1]];
        let found = (0..left.len()).min_by(|a, b| row[left[*a]].total_cmp(&row[left[*b]]));
        path.push(left.remove(found.unwrap_or(0)));
    }
    path.push(count + 1);
    path
}

/// Reverses and moves parts of the path as long as that is better; then again from there with two
/// neighbouring parts swapped, [`KICKS`] times.
fn improved(costs: &[Vec<f64>], path: Vec<usize>) -> Vec<usize> {
    let mut rng = Seed(0).stream("order", 0);
    let mut best = settled(costs, path);
    let mut cost = cost_of(costs, &best);
    for _ in 0..KICKS {
        let mut cuts: [usize; 3] = std::array::from_fn(|_| rng.random_range(1..best.len()));
        cuts.sort_unstable();
        let [from, middle, to] = cuts;
        let mut other = best.clone();
        other[from..to].rotate_left(middle - from);
        let other = settled(costs, other);
        let at = cost_of(costs, &other);
        if at < cost {
            (best, cost) = (other, at);
        }
    }
    best
}

/// No exchange makes this path better.
fn settled(costs: &[Vec<f64>], mut path: Vec<usize>) -> Vec<usize> {
    while let Some(better) = exchange(costs, &path) {
        path = better;
    }
    path
}

/// The first better path with a part reversed or moved on.
fn exchange(costs: &[Vec<f64>], path: &[usize]) -> Option<Vec<usize>> {
    let last = path.len() - 1;
    let least = cost_of(costs, path) * EPSILON;
    // Cost up to each place, and back from it.
    let (mut onward, mut back) = (vec![0.0], vec![0.0]);
    for at in 0..last {
        onward.push(onward[at] + costs[path[at]][path[at + 1]]);
        back.push(back[at] + costs[path[at + 1]][path[at]]);
    }
    let between = |a: usize, b: usize| costs[path[a]][path[b]];
    for from in 1..last {
        for to in from + 1..=last {
            let before = onward[to] - onward[from - 1];
            let within = back[to - 1] - back[from];
            let reversed = between(from - 1, to - 1) + within + between(from, to);
            if before - reversed > least {
                let mut other = path.to_vec();
                other[from..to].reverse();
                return Some(other);
            }
            // Parts from..middle and middle..to swapped.
            for middle in from + 1..to {
                let first = onward[middle - 1] - onward[from];
                let second = onward[to - 1] - onward[middle];
                let joints =
                    between(from - 1, middle) + between(to - 1, from) + between(middle - 1, to);
                if before - (first + second + joints) > least {
                    let mut other = path.to_vec();
                    other[from..to].rotate_left(middle - from);
                    return Some(other);
                }
            }
        }
    }
    None
}

/// No order costs less: one is a spanning tree with two ends at every place but the first and the
/// last, and a price on every end at a place changes all orders alike. `known` is what an order
/// costs: with it steps have the length of Held, Wolfe, Crowder (1974).
fn bound(costs: &[Vec<f64>], known: f64) -> f64 {
    let count = costs.len();
    let cheaper = |a: usize, b: usize| costs[a][b].min(costs[b][a]);
    let ends = |place: usize| {
        if place == 0 || place + 1 == count {
            1.0
        } else {
            2.0
        }
    };
    let mut prices = vec![0.0; count];
    let (mut best, mut share, mut since) = (0.0_f64, 2.0, 0);
    for _ in 0..STEPS {
        let (tree, degrees) = spanning_tree(count, |a, b| cheaper(a, b) + prices[a] + prices[b]);
        let paid: f64 = (0..count).map(|place| prices[place] * ends(place)).sum();
        let off: Vec<f64> = (0..count)
            .map(|place| degrees[place] - ends(place))
            .collect();
        let squares: f64 = off.iter().map(|off| off * off).sum();
        (best, since) = if tree - paid > best {
            (tree - paid, 0)
        } else {
            (best, since + 1)
        };
        if since == PATIENCE {
            (share, since) = (share * 0.5, 0);
        }
        let missing = known - (tree - paid);
        if squares == 0.0 || missing <= 0.0 {
            break;
        }
        for (price, off) in prices.iter_mut().zip(off) {
            *price += share * missing / squares * off;
        }
    }
    best
}

/// Length of the shortest spanning tree (Prim 1957), and how many of its edges end at each place.
fn spanning_tree(count: usize, cost: impl Fn(usize, usize) -> f64) -> (f64, Vec<f64>) {
    let mut degrees = vec![0.0; count];
    let mut left: Vec<(usize, f64, usize)> = (1..count).map(|b| (b, cost(0, b), 0)).collect();
    let mut total = 0.0;
    while !left.is_empty() {
        let nearest = (0..left.len()).min_by(|a, b| left[*a].1.total_cmp(&left[*b].1));
        let (place, edge, to) = left.swap_remove(nearest.unwrap_or(0));
        total += edge;
        degrees[place] += 1.0;
        degrees[to] += 1.0;
        for entry in &mut left {
            let other = cost(place, entry.0);
            if other < entry.1 {
                (entry.1, entry.2) = (other, place);
            }
        }
    }
    (total, degrees)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn matrix(count: usize) -> impl Strategy<Value = Vec<Vec<f64>>> {
        let size = count + 2;
        prop::collection::vec(prop::collection::vec(0.0..10.0_f64, size), size)
    }

    /// Every order, one by one, but for those whose beginning costs too much already with the cheapest way to each stop
    /// that is left.
    fn cheapest(
        (costs, least): (&[Vec<f64>], &[f64]),
        path: &mut Vec<usize>,
        so_far: f64,
        best: &mut f64,
    ) {
        let count = costs.len() - 2;
        let last = path[path.len() - 1];
        if path.len() == count + 1 {
            *best = best.min(so_far + costs[last][count + 1]);
            return;
        }
        let left: Vec<usize> = (1..=count).filter(|stop| !path.contains(stop)).collect();
        let to_all: f64 = left.iter().map(|&stop| least[stop]).sum();
        for next in left {
            let cost = so_far + costs[last][next];
            if cost + to_all - least[next] < *best {
                path.push(next);
                cheapest((costs, least), path, cost, best);
                path.pop();
            }
        }
    }

    fn brute(costs: &[Vec<f64>]) -> f64 {
        let to = |stop: usize| {
            let others = costs.iter().enumerate().filter(|(from, _)| *from != stop);
            others
                .map(|(_, row)| row[stop])
                .fold(f64::INFINITY, f64::min)
        };
        let least: Vec<f64> = (0..costs.len()).map(to).collect();
        let mut best = f64::INFINITY;
        cheapest((costs, &least), &mut vec![0], 0.0, &mut best);
        best
    }

    /// Places in a square, with distances.
    fn distances(at: &[(f64, f64)]) -> Vec<Vec<f64>> {
        let row = |a: &(f64, f64)| at.iter().map(|b| (a.0 - b.0).hypot(a.1 - b.1)).collect();
        at.iter().map(row).collect()
    }

    fn is_whole(found: &Sequence, count: usize) -> bool {
        let mut order = found.order.clone();
        order.sort_unstable();
        order == (0..count).collect::<Vec<_>>()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn no_order_of_up_to_eight_stops_costs_less(costs in (1_usize..=8).prop_flat_map(matrix)) {
            let found = best_order(&costs).expect("square");
            prop_assert!(is_whole(&found, costs.len() - 2));
            let path: Vec<usize> = std::iter::once(0).chain(found.order.iter().map(|place| place + 1))
                .chain([costs.len() - 1]).collect();
            prop_assert!((cost_of(&costs, &path) - found.cost).abs() < 1e-9);
            prop_assert!((found.cost - brute(&costs)).abs() < 1e-9);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        #[test]
        fn no_order_of_twelve_stops_costs_less(at in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 14)) {
            let costs = distances(&at);
            let found = best_order(&costs).expect("square");
            prop_assert!((found.cost - brute(&costs)).abs() < 1e-9);
            // The bound for more places holds here too.
            prop_assert!(bound(&costs, found.cost) <= found.cost + 1e-9);
        }
    }

    /// Places of a seed in the unit square, `together` of them in one corner.
    fn scattered(seed: u64, count: usize, together: usize) -> Vec<(f64, f64)> {
        let mut rng = Seed(seed).stream("scattered", 0);
        let at = |index: usize| match index < together {
            true => (0.0, 0.0),
            false => (rng.random(), rng.random()),
        };
        let mut scattered: Vec<(f64, f64)> = (0..count).map(at).collect();
        scattered.rotate_left(together / 2);
        scattered
    }

    #[test]
    fn forty_stops_are_within_a_twentieth_of_their_bound() {
        for seed in 0..20 {
            for together in [0, 6] {
                let found = best_order(&distances(&scattered(seed, 42, together))).expect("square");
                assert!(is_whole(&found, 40));
                assert!(found.bound <= found.cost);
                let ratio = found.cost / found.bound;
                assert!(ratio < 1.05, "seed {seed}, {together} together: {ratio}");
            }
        }
    }
}
