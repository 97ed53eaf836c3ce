//! How cheap a route can be at best: proven, and estimated.
//!
//! **Proven.** Threats, zones without a height, ground that leaves no room under the ceiling and
//! all outside of the area are closed at any altitude. [`closed`] approximates them from inside,
//! so that the rest of the plane holds every path that passes. The shortest path in it, bends
//! included but turns not limited, is no longer than any of them, and neither is its length in
//! three dimensions with the difference in altitude of its ends. A zone that can be flown over is
//! passed on one side, or costs the climb over it ([`lids`]). Over level ground, ends above the
//! lowest altitude cost what is cheapest between them ([`level_ground`]). No other term of the
//! objective is negative. Lengths are those of the objective: in planning coordinates.
//!
//! **Estimated.** [`estimate`] solves the relaxed problem on a grid. It errs upward.

mod closed;
mod closed_ground;
mod estimate;
mod level_ground;
mod level_set;
mod lids;
mod potential;

pub(super) use estimate::estimate;
pub(super) use potential::certify;
pub use potential::{CertifyBudget, RouteBound, RouteCertificate};

use lids::{Climbs, Lid, lids};
use rayon::prelude::*;

use crate::geodesy::{EastNorth, PlanPoint};
use crate::numeric::free_space::{FreeSpace, Sights};
use crate::numeric::geometry::{Point, Ring};
use crate::spec::{MissionSpec, Objective};
use crate::world::{Terrain, World};

/// Most steps of the search for the shortest path.
const MAX_STEPS: usize = 2_000_000;
/// Taken off the length for rounding and for what the objective does not see between its
/// samples: a share, and metres.
const TOLERANCE: (f64, f64) = (1e-6, 0.1);

/// Most closed polygons, and most ends of routes, for which zones that can be flown over are looked
/// at.
const MAX_CLOSED: usize = 400;
const MAX_SITES: usize = 64;

/// Start and goal of each route of a vehicle.
pub(super) type VehicleRoutes = Vec<(PlanPoint, PlanPoint)>;

/// Proven for each vehicle by the ends of its routes: no path that keeps its limits costs less.
pub(super) fn proven(spec: &MissionSpec, world: &World, routes: &[VehicleRoutes]) -> Vec<f64> {
    let passages = match spec.planner.objective {
        Objective::Operational => Passages::new(spec, world, routes),
        // The paper's objective reads threats at a few samples alone: its paths may cut them.
        Objective::Paper => Passages::open(spec, world),
    };
    let mut place = 0;
    routes
        .iter()
        .map(|routes| {
            let costs = routes.iter().map(|&ends| {
                place += 2;
                passages.least(place - 2, ends)
            });
            costs.sum()
        })
        .collect()
}

/// Shortest paths past what is closed, and past more and more of the zones that can be flown over.
/// A path crosses none of these zones, or one of them first in their order: it then passes all
/// before that one, and climbs over it.
struct Passages {
    /// Past the first zones, none of them to begin with; none where nothing is known.
    past: Vec<Option<Sights>>,
    lids: Vec<Lid>,
    climbs: Climbs,
    plain: Plain,
}

impl Passages {
    /// Without anything that is closed.
    fn open(spec: &MissionSpec, world: &World) -> Self {
        Self {
            past: vec![None],
            lids: Vec::new(),
            climbs: Climbs::new(spec, world),
            plain: Plain::new(spec, world),
        }
    }

    fn new(spec: &MissionSpec, world: &World, routes: &[VehicleRoutes]) -> Self {
        let sites = sites(routes);
        let area = Ring::around(&world.area);
        let mut closed = closed::closed_rings(spec, world);
        let past =
            |closed: &[Vec<Point>]| FreeSpace::new(area.corners(), closed, &sites).map(Sights::new);
        let first = past(&closed);
        let is_small = closed.len() <= MAX_CLOSED && sites.len() <= MAX_SITES;
        let lids = match is_small && first.is_some() {
            true => lids(spec, world),
            false => Vec::new(),
        };
        let mut all = vec![first];
        for lid in &lids {
            closed.push(lid.ring.clone());
            all.push(past(&closed));
        }
        Self {
            past: all,
            lids,
            ..Self::open(spec, world)
        }
    }

    /// What a route between two ends costs at least, the first of them being site number `site`.
    fn least(&self, site: usize, (from, to): (PlanPoint, PlanPoint)) -> f64 {
        let mut least = f64::INFINITY;
        let mut plane_m = 0.0;
        for (number, sights) in self.past.iter().enumerate() {
            if let Some(sights) = sights {
                match sights.shortest(site, site + 1, MAX_STEPS) {
                    Some(found) => plane_m = found.length_m,
                    // None passes these zones: all cross one of them.
                    None if number > 0 => break,
                    None => {}
                }
            }
            let proven_m = (plane_m * (1.0 - TOLERANCE.0) - TOLERANCE.1).max(0.0);
            let straight_m = from.at.distance_m(to.at);
            let (rise_m, altitude) = match self.lids.get(number) {
                Some(lid) => {
                    let above_m = |end: PlanPoint| (lid.top_m - end.amsl.0).max(0.0);
                    let climb = self.climbs.over(lid, (from, to));
                    (above_m(from) + above_m(to), climb * (1.0 - TOLERANCE.0))
                }
                None => (0.0, 0.0),
            };
            let rise_m = rise_m.max((to.amsl.0 - from.amsl.0).abs());
            let length_m = proven_m.hypot(rise_m).max(straight_m.hypot(rise_m));
            let over = self.plain.length * length_m / 1000.0 + altitude;
            least = least.min(over.max(self.plain.least((from, to), proven_m)));
        }
        least
    }
}

/// What a path costs at least by its ends and its length in the plane, whatever lies between.
struct Plain {
    /// Cost of a kilometre.
    length: f64,
    /// Over level ground: what a kilometre costs more a km higher, and the lowest altitude,
    /// metres above mean sea level.
    level: Option<(f64, f64)>,
}

impl Plain {
    fn new(spec: &MissionSpec, world: &World) -> Self {
        let weights = &spec.planner.weights;
        let level = match (&world.terrain, spec.planner.objective) {
            (Terrain::Flat(ground), Objective::Operational) => {
                Some((weights.altitude, world.min_agl.over(*ground).0))
            }
            _ => None,
        };
        Self {
            length: weights.length,
            level,
        }
    }

    /// Of a path that is no shorter than this in the plane.
    fn least(&self, (from, to): (PlanPoint, PlanPoint), plane_m: f64) -> f64 {
        let plane_m = plane_m.max(from.at.distance_m(to.at));
        let straight_km = plane_m.hypot(to.amsl.0 - from.amsl.0) / 1000.0;
        let known_km = match self.level {
            Some((altitude, floor_m)) if self.length > 0.0 => {
                let height_km = |end: PlanPoint| (end.amsl.0 - floor_m) / 1000.0;
                let heights_km = (height_km(from), height_km(to));
                level_ground::least(plane_m / 1000.0, heights_km, altitude / self.length)
            }
            _ => 0.0,
        };
        self.length * straight_km.max(known_km * (1.0 - TOLERANCE.0))
    }
}

/// No path that keeps the limits is shorter: for each two of these places, metres, in three
/// dimensions.
pub(super) fn shortest_m(spec: &MissionSpec, world: &World, sites: &[PlanPoint]) -> Vec<Vec<f64>> {
    let ends: VehicleRoutes = sites
        .chunks(2)
        .map(|two| (two[0], two[two.len() - 1]))
        .collect();
    let sights = sights(spec, world, &[ends]);
    let between = |one: usize, other: usize| {
        let (from, to) = (sites[one], sites[other]);
        let plane_m = (sights.as_ref())
            .and_then(|sights| sights.shortest(one.min(other), one.max(other), MAX_STEPS))
            .map_or(0.0, |found| found.length_m);
        plane_m
            .hypot(to.amsl.0 - from.amsl.0)
            .max(from.distance_m(to))
    };
    let row = |one| (0..sites.len()).map(|other| between(one, other)).collect();
    (0..sites.len()).into_par_iter().map(row).collect()
}

/// Sights past all that is closed, with a place at each end of each route.
fn sights(spec: &MissionSpec, world: &World, routes: &[VehicleRoutes]) -> Option<Sights> {
    let sites = sites(routes);
    let area = Ring::around(&world.area);
    let closed = closed::closed_rings(spec, world);
    FreeSpace::new(area.corners(), &closed, &sites).map(Sights::new)
}

/// Both ends of each route.
fn sites(routes: &[VehicleRoutes]) -> Vec<Point> {
    let routes = routes.iter().flatten();
    let ends = routes.flat_map(|&(from, to)| [from.at, to.at]);
    ends.map(point).collect()
}

fn point(at: EastNorth) -> Point {
    [at.east_m, at.north_m]
}
