//! The search of one route: seeds, swarms, and the judgement of the finalists.

pub(super) mod corridor;
pub(super) mod detour;
pub(super) mod fit;
mod judgement;
pub(super) mod objective;
mod overflight;
pub(super) mod polish;
pub(super) mod problem;
pub(super) mod published;
pub(super) mod rests;
pub(super) mod seeds;
mod swarms;
mod taut;
pub(super) mod tighten;

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

pub(super) use self::judgement::{JUDGED_SAMPLES, judged_route, straight};
use self::judgement::{along, found_among};
use self::published::published;
use self::swarms::swarms;
use super::classes::routes::{HomotopyClasses, homotopy_classes};
use super::memo::Memo;
use super::route_context::RouteContext;
use super::spline::Spline;
use crate::cost::CostTerms;
use crate::geodesy::EastNorth;
use crate::numeric::Seed;
use crate::optimize::TracePoint;
use crate::spec;
use crate::world::World;

/// Homotopy classes of one vehicle's routes: other flights do not change them, so that all its
/// plans share them.
#[derive(Default)]
pub(super) struct KnownClasses(Mutex<BTreeMap<(usize, usize), Arc<HomotopyClasses>>>);

impl KnownClasses {
    /// Those of a route, by its number and budget; made where they are not known.
    fn of(
        &self,
        route: (usize, usize),
        make: impl FnOnce() -> HomotopyClasses,
    ) -> Arc<HomotopyClasses> {
        let known = |classes: &BTreeMap<_, _>| classes.get(&route).cloned();
        if let Some(classes) = self.0.lock().ok().and_then(|classes| known(&classes)) {
            return classes;
        }
        let made = Arc::new(make());
        if let Ok(mut classes) = self.0.lock() {
            classes.insert(route, Arc::clone(&made));
        }
        made
    }
}

/// Searches that were made for one fleet, so that none is made twice.
#[derive(Default)]
pub struct KnownSearches(Memo<Found>);

/// The means of one search.
#[derive(Clone, Copy)]
pub(super) struct Run<'a> {
    /// Evaluations allowed.
    pub budget: usize,
    pub seed: Seed,
    /// Number of the random stream.
    pub stream: u64,
    /// Classes that other plans of the vehicle share, and the number of the route.
    pub classes: Option<(&'a KnownClasses, usize)>,
    /// What other plans of the fleet have found.
    pub known: Option<&'a KnownSearches>,
    pub watch: &'a (dyn Fn(TracePoint) + Sync),
}

/// Result of the search of one route.
#[derive(Clone)]
pub(super) struct Found {
    pub spline: Spline,
    /// Judged finely, without margins.
    pub terms: CostTerms,
    /// The same with the margins that verification asked for.
    pub strict: CostTerms,
    /// Evaluations spent, those of seeds included.
    pub evaluations: usize,
}

impl Found {
    /// Routes that keep all limits first, then by their cost.
    fn by_limits(&self, other: &Self) -> Ordering {
        let is_broken = |found: &Self| !found.strict.is_clean();
        let by_cost = || self.strict.total().total_cmp(&other.strict.total());
        is_broken(self).cmp(&is_broken(other)).then_with(by_cost)
    }
}

/// Searches one route within a budget; where that finds no path that keeps the limits, once more
/// through the corridors of free space. What is found is polished.
pub(super) fn search(context: &RouteContext<'_>, run: Run<'_>) -> Found {
    if context.is_cancelled() {
        return found_among(context, Vec::new(), 0);
    }
    match run.known {
        Some(KnownSearches(memo)) => {
            let of = (run.budget, run.seed, run.stream);
            memo.of(context, of, || searched(context, run))
        }
        None => searched(context, run),
    }
}

fn searched(context: &RouteContext<'_>, run: Run<'_>) -> Found {
    let first = search_classes(context, run);
    let (found, is_drawn) = corridor::or_through_corridors(context, run, first);
    let found = polished(context, found);
    if is_drawn {
        return found;
    }
    corridor::nearer_to_bound(context, run, &found).unwrap_or(found)
}

/// What was found drawn taut and polished, or a line over zones where that costs less.
fn polished(context: &RouteContext<'_>, found: Found) -> Found {
    overflight::polished_or_overflight(context, taut::taut(context, found))
}

/// Searches one route from the classes of the soft fields.
///
/// Ground without data has no rim that a few samples could feel, so the search keeps a cell of
/// the ground away from it. Only if that finds no path it searches once more up to the rim.
fn search_classes(context: &RouteContext<'_>, run: Run<'_>) -> Found {
    let up_to_voids = || found(context, context, run);
    let Some(wider) = &context.world.wider_voids else {
        return up_to_voids();
    };
    let world = World {
        ground: Arc::clone(wider),
        ..context.world.clone()
    };
    let away = RouteContext {
        world: &world,
        ..*context
    };
    let first = found(context, &away, run);
    if first.terms.is_clean() {
        return first;
    }
    let second = up_to_voids();
    let evaluations = first.evaluations + second.evaluations;
    let is_better = second.terms.is_clean() || second.terms.total() < first.terms.total();
    Found {
        evaluations,
        ..if is_better { second } else { first }
    }
}

/// The search of one route, judged on another context.
fn found(judged_on: &RouteContext<'_>, context: &RouteContext<'_>, run: Run<'_>) -> Found {
    let (splines, evaluations) = match context.spec.planner.algorithm {
        spec::Algorithm::Msfoa => {
            let make = || homotopy_classes(context, run.budget);
            // With wider voids the same route is searched in two worlds.
            let shared = (run.classes).filter(|_| context.world.wider_voids.is_none());
            let homotopy = match shared {
                Some((known, route)) => known.of((route, run.budget), make),
                None => Arc::new(make()),
            };
            swarms(context, run, &homotopy, Vec::new())
        }
        algorithm => published(context, algorithm, run),
    };
    found_among(judged_on, splines, evaluations)
}

/// The same way in the plane at the altitudes that the route's margins now ask for, if it
/// then keeps all of them: what is too low by a hand's breadth need not be searched again.
pub(super) fn lifted(context: &RouteContext<'_>, outline: &[EastNorth]) -> Option<Found> {
    let found = along(context, outline);
    (found.strict.is_clean()).then(|| polish::polished_as_is(context, found))
}
