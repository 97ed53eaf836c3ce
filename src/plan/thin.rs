//! What of the zones lies between the nodes of a grid.

use super::field::Grid;
use crate::numeric::geometry::{Point, Ring, closest_points};
use crate::world::{PlanZone, World};

/// Half of the king's moves, each with where the nodes lie that tell from it whether the zone
/// is met there anyway; the other moves are these backwards.
const MOVES: [(Step, &[Step]); 4] = [
    ((1, 0), &[(0, 1), (0, -1), (1, 1), (1, -1)]),
    ((0, 1), &[(1, 0), (-1, 0), (1, 1), (-1, 1)]),
    ((1, 1), &[(1, 0), (0, 1)]),
    ((1, -1), &[(1, 0), (0, -1)]),
];

type Step = (isize, isize);

/// Nodes beside a zone that have to count as if it reached to them: a move to a neighbour
/// crosses the zone, and no node there lies in it. The nearer of the two is taken, so a wall
/// however thin is closed, and a gap in it or between two is left open.
pub(super) fn beside(grid: &Grid, zone: &PlanZone) -> Vec<usize> {
    let ring = ring(zone);
    let at = |node: usize| {
        let at = grid.at(node);
        [at.east_m, at.north_m]
    };
    let is_in = |node: usize| ring.contains(at(node));
    let mut beside = Vec::new();
    let mut crossings = Vec::new();
    for node in nodes_near(grid, &ring) {
        if is_in(node) {
            continue;
        }
        for (step, tellers) in MOVES {
            let Some(other) = grid.step(node, step) else {
                continue;
            };
            let (from, to) = (at(node), at(other));
            if ring.is_far_from(from, to) || is_in(other) {
                continue;
            }
            let inside = ring.inside_fraction((from, to), (0.0, 1.0), &mut crossings);
            if inside <= 0.0 {
                continue;
            }
            let told = tellers.iter().filter_map(|&step| grid.step(node, step));
            // A diagonal that squeezes through between two nodes of a zone crosses it.
            let told = told.filter(|&node| is_in(node)).count();
            if told == 0 || (tellers.len() == 2 && told == 2) {
                let is_nearer = ring.boundary_distance(from) <= ring.boundary_distance(to);
                beside.push(if is_nearer { node } else { other });
            }
        }
    }
    beside.sort_unstable();
    beside.dedup();
    without_tips(grid, beside, is_in)
}

/// The nodes without those groups of neighbours of which each is also next to a node of the
/// zone: there only a corner of it pokes out.
fn without_tips(grid: &Grid, mut nodes: Vec<usize>, is_in: impl Fn(usize) -> bool) -> Vec<usize> {
    let near = |node: usize| {
        let steps = (-1..=1).flat_map(|east| (-1..=1).map(move |north| (east, north)));
        steps.filter_map(move |step| grid.step(node, step))
    };
    let mut kept: Vec<usize> = nodes
        .iter()
        .copied()
        .filter(|&node| !near(node).any(&is_in))
        .collect();
    let mut next = 0;
    while let Some(&node) = kept.get(next) {
        let joined = near(node).filter(|other| nodes.binary_search(other).is_ok());
        let new: Vec<usize> = joined.filter(|other| !kept.contains(other)).collect();
        kept.extend(new);
        next += 1;
    }
    nodes.retain(|node| kept.contains(node));
    nodes
}

/// The nodes of the box around a ring, and those next to it.
fn nodes_near(grid: &Grid, ring: &Ring) -> impl Iterator<Item = usize> + use<> {
    let range = |axis: usize, from_m: f64, count: usize| {
        let (low, high) = (ring.bounds().0[axis], ring.bounds().1[axis]);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "cut off at the grid"
        )]
        let index = |at_m: f64| ((at_m - from_m) / grid.spacing_m).max(0.0) as usize;
        index(low - grid.spacing_m)..(index(high) + 2).min(count)
    };
    let columns = range(0, grid.south_west.east_m, grid.columns);
    let rows = range(1, grid.south_west.north_m, grid.rows);
    let width = grid.columns;
    rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
}

/// The least distance between two closed zones, or such a zone and a threat, that is wider than
/// `least_m`; metres.
pub(super) fn narrowest_gap_m(world: &World, least_m: f64) -> f64 {
    let closed = world.zones.iter().filter(|zone| zone.below.is_none());
    let rings: Vec<Ring> = closed.map(ring).collect();
    let mut narrowest_m = f64::INFINITY;
    let mut found = |gap_m: f64| {
        if gap_m > least_m {
            narrowest_m = narrowest_m.min(gap_m);
        }
    };
    for (index, one) in rings.iter().enumerate() {
        for other in &rings[..index] {
            found(distance_m(one, other));
        }
        for threat in &world.threats {
            let center = [threat.center.east_m, threat.center.north_m];
            found(one.boundary_distance(center) - threat.radius_m);
        }
    }
    narrowest_m
}

fn distance_m(one: &Ring, other: &Ring) -> f64 {
    let apart_m = |(a, b): (Point, Point)| (a[0] - b[0]).hypot(a[1] - b[1]);
    let pairs = one
        .edges()
        .flat_map(|edge| other.edges().map(move |to| (edge, to)));
    pairs
        .map(|(edge, to)| apart_m(closest_points(edge, to)))
        .fold(f64::INFINITY, f64::min)
}

fn ring(zone: &PlanZone) -> Ring {
    let corners = zone.outline.exterior().coords();
    let corners: Vec<Point> = corners.map(|corner| [corner.x, corner.y]).collect();
    Ring::new(&corners)
}
