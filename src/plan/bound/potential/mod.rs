//! A bound in altitude too, with a proof that others can check.
//!
//! A potential is a function of place and altitude. If along no path that keeps the limits it rises
//! faster than the cost, no path from start to goal costs less than it rises between them. Here it
//! is linear in the triangles of a mesh, and in the height over a floor between levels of it. The
//! floor is flat over each triangle and nowhere above the lowest altitude; a km at a height over it
//! costs at least `length + altitude * (height - how far the floor may lie below)`. Slopes are
//! limited as those of the vehicle, so the price of a rise is that of the flattest climb.
//!
//! A potential that rises too fast somewhere is scaled down until it does not: every one is a
//! proof. How good it is depends on the mesh, and on how long [`solve`] looked for it.

mod best;
mod closed;
mod floor;
mod gauge;
mod mesh;
mod refine;
mod solve;

use std::ops::RangeInclusive;

use super::{Plain, TOLERANCE, VehicleRoutes, point};
use crate::geodesy::{Amsl, PlanPoint};
use crate::numeric::geometry::{Point, distance};
use crate::path::VehicleLimits;
use crate::spec::{MissionSpec, Objective};
use crate::world::{Terrain, World};
use best::best_of;
use closed::Closures;
use floor::Floor;
use mesh::{Mesh, count};
use refine::{Coarse, refined};
use solve::{Prices, Solver};

/// Cells from start to goal on each mesh, one after the other, and the steps on it.
const MESHES: [(usize, usize); 5] = [(20, 3000), (40, 3000), (80, 2500), (160, 2000), (320, 1200)];
/// Fewest cells from start to goal.
const MIN_CELLS: usize = 4;
/// Most values of a potential: a finer mesh is left out.
const MAX_VALUES: usize = 400_000;
/// Paths this much longer than the proven bound are looked at: a bound beyond is cut off.
const LONGEST: f64 = 1.12;
/// Levels, as a share of what the floor varies.
const LEVELS: [f64; 5] = [0.0, 0.06, 0.15, 0.3, 0.6];
/// A floor that varies by no more needs no levels, metres.
const FLAT_M: f64 = 5.0;
/// Potentials are whole millimetres.
const PER_KM: f64 = 1e6;
/// Routes that are shorter have no mesh, metres.
const SHORTEST_M: f64 = 100.0;

/// A proof that no path of a route costs less than a bound.
#[derive(Clone, Debug)]
pub struct RouteCertificate {
    /// Start and goal.
    pub ends: [PlanPoint; 2],
    /// Proven: no path that keeps the limits costs less.
    pub bound: f64,
    /// Paths that are longer cost more than this: the mesh ends where they are.
    pub longest_m: f64,
    /// Slopes of paths, rise over run: steepest descent (negative) and climb.
    pub slopes: RangeInclusive<f64>,
    /// Rows across the line from start to goal, and nodes in each.
    pub size: [usize; 2],
    /// The nodes of start and goal.
    pub end_nodes: [usize; 2],
    /// Planning coordinates of the nodes, row by row, metres.
    pub nodes: Vec<Point>,
    /// The floor at each node, metres above the sea; empty where there are no levels.
    pub floor_m: Vec<f64>,
    /// Heights over the floor, metres.
    pub levels_m: Vec<f64>,
    /// The potential, level by level, node by node, km.
    pub potential_km: Vec<f64>,
}

/// What is proven of a route.
#[derive(Clone, Debug)]
pub struct RouteBound {
    /// No path that keeps the limits costs less.
    pub bound: f64,
    /// Proves it; without one, the ends do.
    pub certificate: Option<RouteCertificate>,
}

/// How long to look for the certificates of a vehicle.
pub struct CertifyBudget<'a> {
    /// Most cells of a mesh from start to goal.
    pub cells: usize,
    /// Gets the share that is done.
    pub progress: &'a (dyn Fn(f64) + Sync),
    /// Whether the time for a share of the whole is over: the best bound by then is taken.
    pub is_over: &'a (dyn Fn(f64) -> bool + Sync),
}

/// What is proven of the routes of a vehicle. A route that is too short, and one for the objective
/// of the paper, has no certificate.
pub(in crate::plan) fn certify(
    (spec, world): (&MissionSpec, &World),
    vehicle: usize,
    routes: &VehicleRoutes,
    budget: &CertifyBudget<'_>,
) -> Vec<RouteBound> {
    let limits = VehicleLimits::of(&spec.vehicles[vehicle]);
    let top_m = world.max_amsl.0;
    let slopes = -limits.descent.max_by_shape(top_m)..=limits.climb.max_by_shape(top_m);
    let all = count(routes.len());
    let certificate = |(index, ends): (usize, (PlanPoint, PlanPoint))| {
        if spec.planner.objective == Objective::Paper
            || ends.0.at.distance_m(ends.1.at) < SHORTEST_M
        {
            return None;
        }
        let proven = super::proven(spec, world, &[vec![ends]])[0];
        let route = Route {
            spec,
            world,
            closures: Closures::new(spec, world),
            ends,
            longest_m: 1000.0 * proven / spec.planner.weights.length * LONGEST,
            plain: Plain::new(spec, world),
            slopes: slopes.clone(),
            cells: budget.cells,
        };
        let progress = |share: f64| (budget.progress)((count(index) + share) / all);
        let is_over = || (budget.is_over)((count(index) + 1.0) / all);
        route.certificate(&progress, &is_over)
    };
    let plain = Plain::new(spec, world);
    let route = |(index, &ends): (usize, &(PlanPoint, PlanPoint))| {
        let certificate = certificate((index, ends));
        let bound = match &certificate {
            Some(found) => found.bound,
            None => plain.least(ends, 0.0),
        };
        RouteBound { bound, certificate }
    };
    routes.iter().enumerate().map(route).collect()
}

/// What a certificate is made for.
struct Route<'a> {
    spec: &'a MissionSpec,
    world: &'a World,
    closures: Closures<'a>,
    ends: (PlanPoint, PlanPoint),
    longest_m: f64,
    plain: Plain,
    slopes: RangeInclusive<f64>,
    /// Most cells from start to goal.
    cells: usize,
}

/// A mesh and where paths may be on it.
struct Stage {
    mesh: Mesh,
    floor: Option<Floor>,
    used: Vec<bool>,
}

impl Route<'_> {
    fn certificate(
        &self,
        progress: &dyn Fn(f64),
        is_over: &dyn Fn() -> bool,
    ) -> Option<RouteCertificate> {
        let meshes = self.meshes();
        let steps = |(cells, steps): &(usize, usize)| count(cells * cells * steps);
        let total: f64 = meshes.iter().map(steps).sum();
        let (mut done, mut before, mut levels_km) = (0.0, None, None);
        let mut found: Option<RouteCertificate> = None;
        for (cells, steps) in meshes {
            // The first mesh takes little time, and is always finished.
            let is_first = found.is_none();
            let is_over = || !is_first && is_over();
            if is_over() {
                break;
            }
            let stage = self.stage(cells);
            let levels_km = levels_km
                .get_or_insert_with(|| levels_km_of(&stage))
                .clone();
            if stage.mesh.nodes.len() * levels_km.len() > MAX_VALUES {
                break;
            }
            let prices = self.prices(&stage, &levels_km);
            let solver = Solver::new(&prices);
            let rank = solver.rank_of_prisms();
            let mut solver = match &before {
                None => self.started(solver),
                Some(coarse) => refined(solver, coarse),
            };
            let balance = 1.25e3 / self.longest_m;
            let cost = count(cells * cells);
            let said = |step: usize| progress((done + cost * count(step)) / total);
            let best = best_of(&mut solver, (balance, steps), &said, &is_over);
            done += cost * count(steps);
            let flows = std::mem::take(&mut solver.flows);
            let coarse = Coarse {
                potential: std::mem::take(&mut solver.potential),
                flows,
                rank,
                levels_km: levels_km.clone(),
                mesh: stage.mesh.clone(),
                floor_m: stage.floor.as_ref().map(|floor| floor.nodes_m.clone()),
            };
            let (bound, potential) = self.judged(&best.potential, &prices);
            if found.as_ref().is_none_or(|found| found.bound < bound) {
                found = Some(self.document(&coarse, bound, potential));
            }
            before = Some(coarse);
        }
        found
    }

    /// Cells and steps of each mesh. None is finer than the terrain: a floor that follows the corners of a
    /// cell is far below it in a triangle that is smaller.
    fn meshes(&self) -> Vec<(usize, usize)> {
        let straight_m = self.ends.0.at.distance_m(self.ends.1.at);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a length of some cells, cut off"
        )]
        let whole = |cells: f64| cells as usize;
        let most = match &self.world.terrain {
            Terrain::Grid(grid) => whole(straight_m / floor::diagonal_m(grid)).max(MIN_CELLS),
            _ => usize::MAX,
        };
        let asked = MESHES.iter().filter(|(cells, _)| *cells <= self.cells);
        let mut meshes: Vec<_> = asked
            .map(|&(cells, steps)| (cells.min(most), steps))
            .collect();
        meshes.dedup_by_key(|mesh| mesh.0);
        meshes
    }

    fn stage(&self, cells: usize) -> Stage {
        let ends = [self.ends.0.at, self.ends.1.at].map(point);
        let mesh = Mesh::new(ends, self.longest_m, cells, self.closures.discs());
        let mut used = self.closures.open(&mesh, self.longest_m);
        let floor = Floor::new(self.world, &mesh, &used);
        if let Some(floor) = &floor {
            let Amsl(top_m) = self.world.max_amsl;
            for (used, corners) in used.iter_mut().zip(&mesh.triangles) {
                let (min_m, _) = extent(corners.map(|node| floor.nodes_m[node]));
                *used &= min_m <= top_m;
            }
        }
        Stage { mesh, floor, used }
    }

    fn prices<'a>(&self, stage: &'a Stage, levels_km: &'a [f64]) -> Prices<'a> {
        let km = |metres: &Vec<f64>| {
            metres
                .iter()
                .map(|value| value / 1000.0)
                .collect::<Vec<f64>>()
        };
        let (nodes, triangles) = (stage.mesh.nodes.len(), stage.mesh.triangles.len());
        let floor_km = stage
            .floor
            .as_ref()
            .map_or(vec![0.0; nodes], |floor| km(&floor.nodes_m));
        let below_km = stage
            .floor
            .as_ref()
            .map_or(vec![0.0; triangles], |floor| km(&floor.below_m));
        let weights = &self.spec.planner.weights;
        let end = |which: usize, point: PlanPoint| {
            let node = stage.mesh.ends[which];
            (node, (point.amsl.0 / 1000.0 - floor_km[node]).max(0.0))
        };
        Prices {
            is_open: self.open_prisms(stage, levels_km, &floor_km),
            ends: [end(0, self.ends.0), end(1, self.ends.1)],
            mesh: &stage.mesh,
            levels_km,
            floor_km,
            below_km,
            slopes: self.slopes.clone(),
            price: (weights.length, weights.altitude),
        }
    }

    /// Level by level: where a path may be between a level and the next, or above the last.
    fn open_prisms(&self, stage: &Stage, levels_km: &[f64], floor_km: &[f64]) -> Vec<bool> {
        let mut is_open = Vec::with_capacity(levels_km.len() * stage.used.len());
        for (level, bottom_km) in levels_km.iter().enumerate() {
            let top_km = levels_km.get(level + 1);
            for (corners, used) in stage.mesh.triangles.iter().zip(&stage.used) {
                let Some(top_km) = top_km.filter(|_| *used) else {
                    is_open.push(*used);
                    continue;
                };
                let (min_km, max_km) = extent(corners.map(|node| floor_km[node]));
                let (min_m, max_m) = (1000.0 * (min_km + bottom_km), 1000.0 * (max_km + top_km));
                let lid_m = self
                    .closures
                    .lid_m(corners.map(|node| stage.mesh.nodes[node]));
                is_open.push(min_m <= self.world.max_amsl.0 && max_m >= lid_m);
            }
        }
        is_open
    }

    /// Begins with the way along the line from start to goal.
    fn started<'a>(&self, mut solver: Solver<'a>) -> Solver<'a> {
        let ends = [self.ends.0.at, self.ends.1.at].map(point);
        let straight_m = distance(ends[0], ends[1]);
        let along_km = |at: &Point| {
            let dot = |axis: usize| (at[axis] - ends[0][axis]) * (ends[1][axis] - ends[0][axis]);
            (dot(0) + dot(1)) / straight_m / 1000.0
        };
        let level: Vec<f64> = solver.mesh().nodes.iter().map(along_km).collect();
        solver.start_at(level.repeat(solver.levels()));
        solver
    }

    /// The bound that a potential proves, and the potential in whole millimetres.
    fn judged(&self, potential: &[f64], prices: &Prices<'_>) -> (f64, Vec<f64>) {
        let whole = |value: &f64| (value * PER_KM).round() / PER_KM;
        let rounded: Vec<f64> = potential.iter().map(whole).collect();
        let mut solver = Solver::new(prices);
        solver.start_at(rounded);
        let length = self.spec.planner.weights.length;
        let proven = solver.proven().min(length * self.longest_m / 1000.0);
        let bound = proven * (1.0 - TOLERANCE.0) - length * TOLERANCE.1 / 1000.0;
        // Without levels it is a length in the plane.
        let plane_m = match prices.levels_km.len() {
            1 => 1000.0 * bound.max(0.0) / length,
            _ => 0.0,
        };
        let by_ends = self.plain.least(self.ends, plane_m);
        (bound.max(by_ends), solver.potential)
    }

    fn document(&self, found: &Coarse, bound: f64, potential_km: Vec<f64>) -> RouteCertificate {
        RouteCertificate {
            ends: [self.ends.0, self.ends.1],
            bound,
            longest_m: self.longest_m,
            slopes: self.slopes.clone(),
            size: [found.mesh.rows, found.mesh.columns],
            end_nodes: found.mesh.ends,
            nodes: found.mesh.nodes.clone(),
            floor_m: found.floor_m.clone().unwrap_or_default(),
            levels_m: found.levels_km.iter().map(|level| level * 1000.0).collect(),
            potential_km,
        }
    }
}

/// Levels over the floor of a coarse mesh, km.
fn levels_km_of(stage: &Stage) -> Vec<f64> {
    let Some(floor) = &stage.floor else {
        return vec![0.0];
    };
    let used = stage
        .mesh
        .triangles
        .iter()
        .zip(&stage.used)
        .filter(|(_, used)| **used);
    let heights = used.flat_map(|(corners, _)| corners.map(|node| floor.nodes_m[node]));
    let (min_m, max_m) = extent(heights);
    let varies_m = max_m - min_m;
    if varies_m.is_nan() || varies_m <= FLAT_M || varies_m.is_infinite() {
        return vec![0.0];
    }
    // Whole metres.
    LEVELS
        .iter()
        .map(|share| (share * varies_m).ceil() / 1000.0)
        .collect()
}

/// The least and the greatest of some numbers.
fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let all = (f64::INFINITY, f64::NEG_INFINITY);
    let wider = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
    values.into_iter().fold(all, wider)
}
