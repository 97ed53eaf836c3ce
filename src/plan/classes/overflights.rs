//! Lines over, under and around zones with heights: exact in the plane, however narrow the gaps.
//!
//! Corners of zones and threats, start and goal are joined by straight edges. An edge costs its
//! length and the altitude over what it crosses, with the climb before it and the descent behind
//! it; closed ground cannot be crossed. The cheapest line through every edge stands for the zones
//! that it flies over and the sides of those that it passes.

mod edge;

use std::collections::BTreeSet;
use std::f64::consts::PI;

use rayon::prelude::*;

use super::field::Prices;
use super::obstacles::{Obstacles, scramble};
use crate::geodesy::{Amsl, EastNorth};
use crate::numeric::geometry::{Point, Ring, distance};
use crate::path::VehicleLimits;
use crate::plan::route_context::RouteContext;
use crate::world::PlanZone;

/// Numbers of the nodes at the ends.
const START: usize = 0;
const GOAL: usize = 1;
/// Most nodes, those that are least far around: edges between more of them take too long. Of a fleet
/// of more vehicles than a few each has fewer.
const MAX_NODES: [usize; 2] = [1000, 260];
const FEW_VEHICLES: usize = 10;
/// Lines pass corners at this distance, metres.
pub(crate) const AWAY_M: f64 = 1.0;
/// Corners of a threat.
const THREAT_CORNERS: u32 = 8;
/// Costs above that of the cheapest line that are worth a look, as a factor.
const DETOUR: f64 = 1.15;

/// A zone and what it closes in the plane, margins included.
struct Closure<'a> {
    zone: &'a PlanZone,
    ring: Ring,
    number: u64,
    /// Whether nothing passes under it, and nothing over it below the ceiling.
    is_closed: bool,
}

/// What a straight flight between two nodes costs, infinite where it crosses closed ground, and the
/// zones that it flies over.
#[derive(Clone)]
struct Edge {
    cost: f64,
    crossed: Vec<usize>,
}

/// Least costs from a node to all others, and the node before each.
struct Tree {
    cost: Vec<f64>,
    before: Vec<Option<usize>>,
}

struct Graph<'a> {
    context: &'a RouteContext<'a>,
    zones: Vec<Closure<'a>>,
    nodes: Vec<Point>,
    /// Whether a node is in a zone: a path over it is up there already.
    is_over: Vec<bool>,
    prices: Prices,
    /// Lines that cost no less are not looked for.
    most: f64,
    slopes: (f64, f64),
}

/// Whether any zone near a route can be flown over or under.
pub(crate) fn has_overflights(context: &RouteContext<'_>) -> bool {
    let near = context.near_box();
    let (low, high) = (near.south_west, near.north_east);
    let max_amsl = context.world.max_amsl;
    let zones = context.world.zones.iter();
    let mut open = zones.filter(|zone| zone.is_open_below(max_amsl));
    open.any(|zone| {
        let (zone_low, zone_high) = Ring::around(&zone.outline).bounds();
        zone_low[0] <= high.east_m
            && zone_high[0] >= low.east_m
            && zone_low[1] <= high.north_m
            && zone_high[1] >= low.north_m
    })
}

/// The cheapest line of each kind that costs less than `most`, at most `count`, cheapest first, at a
/// distance from corners.
pub(crate) fn overflight_lines(
    context: &RouteContext<'_>,
    count: usize,
    (most, away_m): (f64, f64),
) -> Vec<Vec<EastNorth>> {
    Graph::new(context, (most, away_m)).lines(count)
}

impl<'a> Graph<'a> {
    /// Of lines that cost less than `most`.
    fn new(context: &'a RouteContext<'a>, (most, away_m): (f64, f64)) -> Self {
        let (margin_m, max_amsl) = (context.margins.threat_m, context.world.max_amsl);
        let closure = |(index, zone): (u64, &'a PlanZone)| Closure {
            zone,
            ring: Ring::around(&zone.outline).outset(zone.buffer_m + margin_m),
            number: scramble(!index),
            is_closed: !zone.is_open_below(max_amsl),
        };
        let zones: Vec<Closure<'a>> = (0..).zip(&context.world.zones).map(closure).collect();
        let nodes = nodes(context, &zones, (most, away_m));
        let is_in = |node: &Point| zones.iter().any(|closure| closure.ring.contains(*node));
        let limits = VehicleLimits::of(context.vehicle());
        let high = Amsl(context.ends.from.amsl.0.max(context.ends.to.amsl.0));
        Self {
            is_over: nodes.iter().map(is_in).collect(),
            prices: context.prices(),
            most,
            slopes: (limits.climb.at(high), limits.descent.at(high)),
            context,
            zones,
            nodes,
        }
    }

    /// The cheapest line through each edge, one of each kind.
    fn lines(&self, count: usize) -> Vec<Vec<EastNorth>> {
        let edges = self.edges();
        let (from, to) = (self.tree(&edges, START), self.tree(&edges, GOAL));
        let (start, goal) = self.context.ends_at();
        let obstacles = Obstacles::at(self.zones.iter().map(Closure::middle), start, goal);
        let mut seen = BTreeSet::new();
        let mut lines = Vec::new();
        for [a, b] in self.through_edges(&edges, (&from, &to)) {
            if lines.len() >= count {
                break;
            }
            let mut chain = from.back_from(a);
            chain.reverse();
            chain.extend(to.back_from(b));
            let points: Vec<EastNorth> = chain.iter().map(|&node| self.at(node)).collect();
            let steps = chain.windows(2);
            let crossed: BTreeSet<usize> = steps
                .flat_map(|pair| &edges[self.number(pair[0], pair[1])].crossed)
                .copied()
                .collect();
            let numbers = crossed.into_iter().map(|zone| self.zones[zone].number);
            let kind = numbers.fold(obstacles.signature(&points), u64::wrapping_add);
            if seen.insert(kind) {
                lines.push(points);
            }
        }
        lines
    }

    /// The edges whose cheapest line is worth a look, that of the cheapest first.
    fn through_edges(&self, edges: &[Edge], (from, to): (&Tree, &Tree)) -> Vec<[usize; 2]> {
        let count = self.nodes.len();
        let most = self.most.min(DETOUR * from.cost[GOAL]);
        let pairs = (0..count).flat_map(|a| (0..count).map(move |b| [a, b]));
        let through = |[a, b]: [usize; 2]| {
            let cost = from.cost[a] + edges[self.number(a, b)].cost + to.cost[b];
            (cost, [a, b])
        };
        let mut lines: Vec<(f64, [usize; 2])> = pairs
            .map(through)
            .filter(|(cost, _)| cost.is_finite() && *cost <= most)
            .collect();
        lines.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        lines.into_iter().map(|line| line.1).collect()
    }

    /// The edges between all nodes, those from the first one first. They lead onward alone, and
    /// no further around than is worth a look.
    fn edges(&self) -> Vec<Edge> {
        let count = self.nodes.len();
        let (start, goal) = (self.at(START), self.at(GOAL));
        let most = self.most.min(DETOUR * self.edge([START, GOAL]).cost);
        let east_m = goal.east_m - start.east_m;
        let north_m = goal.north_m - start.north_m;
        let along = |at: EastNorth| at.east_m * east_m + at.north_m * north_m;
        let edge = |number: usize| {
            let (a, b) = (number / count, number % count);
            let (p, q) = (self.at(a), self.at(b));
            let min_m = start.distance_m(p) + p.distance_m(q) + q.distance_m(goal);
            let is_onward = (along(p), a) < (along(q), b);
            match is_onward && self.prices.length * min_m / 1000.0 <= most {
                true => self.edge([a, b]),
                false => Edge::closed(),
            }
        };
        let onward: Vec<Edge> = (0..count * count).into_par_iter().map(edge).collect();
        let either = |number: usize| {
            let back = self.number(number % count, number / count);
            match onward[number].cost.is_finite() {
                true => onward[number].clone(),
                false => onward[back].clone(),
            }
        };
        (0..count * count).map(either).collect()
    }

    /// Dijkstra's algorithm over all pairs.
    fn tree(&self, edges: &[Edge], root: usize) -> Tree {
        let count = self.nodes.len();
        let mut tree = Tree {
            cost: vec![f64::INFINITY; count],
            before: vec![None; count],
        };
        let mut is_done = vec![false; count];
        tree.cost[root] = 0.0;
        loop {
            let open = (0..count).filter(|&node| !is_done[node] && tree.cost[node].is_finite());
            let Some(node) = open.min_by(|&a, &b| tree.cost[a].total_cmp(&tree.cost[b])) else {
                return tree;
            };
            is_done[node] = true;
            for next in 0..count {
                let cost = tree.cost[node] + edges[self.number(node, next)].cost;
                if cost < tree.cost[next] {
                    tree.cost[next] = cost;
                    tree.before[next] = Some(node);
                }
            }
        }
    }

    /// The number of the edge from one node to another.
    fn number(&self, from: usize, to: usize) -> usize {
        from * self.nodes.len() + to
    }

    fn at(&self, node: usize) -> EastNorth {
        let [east_m, north_m] = self.nodes[node];
        EastNorth { east_m, north_m }
    }
}

impl Closure<'_> {
    fn middle(&self) -> EastNorth {
        let (low, high) = self.ring.bounds();
        EastNorth {
            east_m: 0.5 * (low[0] + high[0]),
            north_m: 0.5 * (low[1] + high[1]),
        }
    }
}

impl Tree {
    /// The nodes from one back to the root.
    fn back_from(&self, node: usize) -> Vec<usize> {
        std::iter::successors(Some(node), |&node| self.before[node]).collect()
    }
}

/// Start, goal and the corners that a line of less than `most` may pass: of more than are allowed
/// those that are least far around.
fn nodes(
    context: &RouteContext<'_>,
    zones: &[Closure<'_>],
    (most, away_m): (f64, f64),
) -> Vec<Point> {
    let (start, goal) = context.ends_at();
    let ends = [point(start), point(goal)];
    let length = context.prices().length;
    let area = Ring::around(&context.world.area);
    let around_m = |node: &Point| distance(ends[0], *node) + distance(*node, ends[1]);
    let is_open = |node: &Point| {
        let mut closed = zones.iter().filter(|closure| closure.is_closed);
        !closed.any(|closure| closure.ring.contains(*node))
    };
    let mut corners = corners(context, zones, away_m);
    corners.retain(|node| {
        length * around_m(node) / 1000.0 < most && area.contains(*node) && is_open(node)
    });
    let count = MAX_NODES[usize::from(context.spec.vehicles.len() > FEW_VEHICLES)];
    if corners.len() > count {
        let mut all_m: Vec<f64> = corners.iter().map(around_m).collect();
        all_m.sort_by(f64::total_cmp);
        corners.retain(|node| around_m(node) < all_m[count]);
    }
    [&ends[..], &corners].concat()
}

/// Corners of zones and threats, a little away from them.
fn corners(context: &RouteContext<'_>, zones: &[Closure<'_>], away_m: f64) -> Vec<Point> {
    let mut corners: Vec<Point> = Vec::new();
    for closure in zones {
        corners.extend(closure.ring.outset(away_m).corners());
    }
    let half_rad = PI / f64::from(THREAT_CORNERS);
    for threat in &context.world.threats {
        let radius_m = (threat.radius_m + context.margins.threat_m + away_m) / half_rad.cos();
        let [east_m, north_m] = point(threat.center);
        corners.extend((0..THREAT_CORNERS).map(|corner| {
            let (sin, cos) = (2.0 * half_rad * f64::from(corner)).sin_cos();
            [east_m + radius_m * cos, north_m + radius_m * sin]
        }));
    }
    corners
}

fn point(at: EastNorth) -> Point {
    [at.east_m, at.north_m]
}
