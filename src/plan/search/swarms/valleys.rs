//! Valleys beside the one that was found.
//!
//! Ground that is dear to climb but nowhere closed parts valleys that homotopy classes do not tell
//! apart: over the rim of a plateau, and around it. Swarms that begin in one of them end there. So
//! lines that swing out less or more than the one that was found, or to its other side, are
//! evaluated where limits are cheap to break. Where their cost has a minimum of its own that is
//! hardly above what was found, and breaks limits by little, a search goes on from there.

use crate::geodesy::EastNorth;
use crate::optimize::{Candidate, Problem, SearchSeed};
use crate::plan::route_context::RouteContext;
use crate::plan::search::problem::Horizontal;

/// How far lines swing out from the straight one, in eighths of what was found.
const OFFSETS: std::ops::RangeInclusive<i32> = -8..=12;
/// What was found, in eighths.
const FOUND: i32 = 8;
/// A minimum is looked into that costs less than this share of what was found.
const NEAR: f64 = 1.002;
/// The way to it costs at least this share of the dearer of both: else it is the same valley.
const RIDGE: f64 = 1.001;
/// It costs less than this many times what was found while limits are dear: straight through walls
/// costs more.
const BROKEN: f64 = 2.0;
/// A path that keeps the limits costs the same whether these are cheap or dear.
const CLEAN: f64 = 1.0 + 1e-6;
/// Minima that are looked into.
const MAX: usize = 2;
/// Ends that are nearer have no line from which to swing out, metres.
const SHORTEST_M: f64 = 1.0;

/// Seeds in other valleys than that of the best finalist, cheapest first; mostly none. Their steps
/// are those of the first of the `seeds` that it was found from.
pub(super) fn other_valleys(
    context: &RouteContext<'_>,
    problem: &Horizontal<'_>,
    finalists: &[Candidate],
    seeds: &[SearchSeed],
) -> Vec<SearchSeed> {
    let ends = context.ends_at();
    let best = finalists.iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
    let (Some(best), Some(first), Some(relaxed)) = (best, seeds.first(), problem.relaxed()) else {
        return Vec::new();
    };
    if !context.options.valleys || ends.0.distance_m(ends.1) < SHORTEST_M {
        return Vec::new();
    }
    let found = best.position.as_slice();
    let offset = |eighths: i32| offset(problem, ends, found, f64::from(eighths) / f64::from(FOUND));
    let rows: Vec<f64> = OFFSETS.flat_map(offset).collect();
    let mut costs = vec![0.0; OFFSETS.count()];
    let mut dear = costs.clone();
    relaxed.evaluate(&rows, &mut costs);
    problem.evaluate(&rows, &mut dear);
    let starts = OFFSETS.zip(rows.chunks_exact(found.len()));
    let starts: Vec<(i32, &[f64])> = starts.collect();
    let place = starts.iter().position(|start| start.0 == FOUND);
    // What breaks limits itself is searched for by other means.
    let place = place.filter(|&place| best.cost <= CLEAN * costs[place]);
    let mut minima = place.map_or_else(Vec::new, |place| other_minima(&costs, place));
    minima.retain(|&at| dear[at] < BROKEN * best.cost);
    minima.truncate(MAX);
    let seed = |&at: &usize| SearchSeed {
        mean: starts[at].1.to_vec(),
        scale: first.scale.clone(),
        class: at as u64,
    };
    minima.iter().map(seed).collect()
}

/// Control points some times as far from the straight line between the ends.
fn offset(
    problem: &Horizontal<'_>,
    (from, to): (EastNorth, EastNorth),
    found: &[f64],
    times: f64,
) -> Vec<f64> {
    let (east_m, north_m) = (to.east_m - from.east_m, to.north_m - from.north_m);
    let square = east_m * east_m + north_m * north_m;
    let moved = |at: EastNorth| {
        let along = (at.east_m - from.east_m) * east_m + (at.north_m - from.north_m) * north_m;
        let share = along / square;
        let foot = EastNorth {
            east_m: from.east_m + share * east_m,
            north_m: from.north_m + share * north_m,
        };
        EastNorth {
            east_m: foot.east_m + times * (at.east_m - foot.east_m),
            north_m: foot.north_m + times * (at.north_m - foot.north_m),
        }
    };
    let frame = &problem.frame;
    frame.shares(frame.positions(found).map(moved))
}

/// Indices of costs that are least nearby and hardly above the one at `found`, with a ridge before
/// them: cheapest first.
fn other_minima(costs: &[f64], found: usize) -> Vec<usize> {
    let is_min = |at: usize| {
        let before = at.checked_sub(1).map(|before| costs[before]);
        before.is_none_or(|cost| costs[at] < cost)
            && costs.get(at + 1).is_none_or(|cost| costs[at] <= *cost)
    };
    let has_ridge = |at: usize| {
        let between = &costs[at.min(found)..=at.max(found)];
        let highest = between.iter().copied().fold(0.0, f64::max);
        highest > RIDGE * costs[at].max(costs[found])
    };
    let mut minima: Vec<usize> = (0..costs.len())
        .filter(|&at| at != found && costs[at] < NEAR * costs[found])
        .filter(|&at| is_min(at) && has_ridge(at))
        .collect();
    minima.sort_by(|&a, &b| costs[a].total_cmp(&costs[b]));
    minima
}

#[cfg(test)]
mod tests {
    use super::other_minima;

    #[test]
    fn only_minima_behind_a_ridge_and_hardly_dearer_are_other_valleys() {
        let found = 5;
        assert_eq!(
            other_minima(&[9.0, 5.0, 4.9, 6.0, 5.5, 5.0, 7.0], found),
            [2]
        );
        // Without a ridge it is the same valley, and what is dearer is not worth a look.
        assert!(other_minima(&[9.0, 6.0, 4.9, 4.95, 4.98, 5.0, 7.0], found).is_empty());
        assert!(other_minima(&[9.0, 6.0, 5.1, 6.0, 5.5, 5.0, 7.0], found).is_empty());
        // The cheapest first, to both sides.
        let both = [4.8, 6.0, 4.7, 6.0, 5.5, 5.0, 7.0, 4.6, 8.0];
        assert_eq!(other_minima(&both, found), [7, 2, 0]);
    }
}
