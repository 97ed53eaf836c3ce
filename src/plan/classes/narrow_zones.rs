//! What of the zones lies between the nodes of a grid.

use geo::Area;

use super::grid::Grid;
use crate::geodesy::EastNorth;
use crate::numeric::geometry::{Point, Ring, closest_points, distance};
use crate::world::{PlanZone, World};

/// Half of the king's moves: the others are these backwards.
const MOVES: [(isize, isize); 4] = [(1, 0), (0, 1), (1, 1), (1, -1)];
/// Cosine of the angle of a corner that is as sharp as a wall is thin.
const SHARP: f64 = 0.7;

/// Nodes beside a zone that have to count as if it reached to them: a move to a neighbour
/// crosses the zone, though neither of the two nodes lies in it. The nearer one is taken, so a
/// wall however thin is closed, and a gap in it or between two is left open. A corner that is
/// cut does not count.
pub(crate) fn crossed_nodes(grid: &Grid, zone: &PlanZone) -> Vec<usize> {
    let ring = closed_ring(zone);
    let at = |node: usize| {
        let at = grid.at(node);
        [at.east_m, at.north_m]
    };
    let mut crossed_nodes = Vec::new();
    for node in nodes_near(grid, &ring) {
        let from = at(node);
        if ring.contains(from) {
            continue;
        }
        for step in MOVES {
            let Some(other) = grid.step(node, step) else {
                continue;
            };
            let to = at(other);
            if ring.is_far_from(from, to) || ring.contains(to) || !is_crossed(&ring, (from, to)) {
                continue;
            }
            let is_nearer = ring.boundary_distance(from) <= ring.boundary_distance(to);
            crossed_nodes.push(if is_nearer { node } else { other });
        }
    }
    crossed_nodes.sort_unstable();
    crossed_nodes.dedup();
    crossed_nodes
}

/// Whether a segment whose ends are outside crosses a ring, and not just a corner of it.
fn is_crossed(ring: &Ring, segment: (Point, Point)) -> bool {
    let crossed: Vec<(usize, (Point, Point))> = (ring.edges().enumerate())
        .filter(|(_, edge)| cross(segment, *edge))
        .collect();
    let [(first, one), (second, other)] = crossed[..] else {
        return crossed.len() > 2;
    };
    let count = ring.corners().len();
    let is_next = second == first + 1 || (first == 0 && second == count - 1);
    if !is_next {
        return true;
    }
    let along = |(a, b): (Point, Point)| [b[0] - a[0], b[1] - a[1]];
    let (into, out) = (along(one), along(other));
    let lengths = into[0].hypot(into[1]) * out[0].hypot(out[1]);
    -(into[0] * out[0] + into[1] * out[1]) > SHARP * lengths
}

/// Whether two segments cross; an end on the other one counts on one side only.
fn cross((a, b): (Point, Point), (c, d): (Point, Point)) -> bool {
    let side = |from: Point, to: Point, at: Point| {
        (to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0]) >= 0.0
    };
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
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

/// The least distance between two closed zones that touch a box, or such a zone and a threat, that is wider
/// than `min_m`; metres.
pub(crate) fn narrowest_gap_m(world: &World, within: (EastNorth, EastNorth), min_m: f64) -> f64 {
    let rings: Vec<Ring> = closed(world)
        .map(closed_ring)
        .filter(|ring| touches(ring, within))
        .collect();
    let mut narrowest_m = f64::INFINITY;
    let found = |gap_m: f64, narrowest_m: &mut f64| {
        if gap_m > min_m {
            *narrowest_m = narrowest_m.min(gap_m);
        }
    };
    for (index, one) in rings.iter().enumerate() {
        for other in &rings[..index] {
            // Boxes that are further apart hold no narrower gap.
            if apart_m(one, other) < narrowest_m {
                found(distance_m(one, other), &mut narrowest_m);
            }
        }
        for threat in &world.threats {
            let center = [threat.center.east_m, threat.center.north_m];
            let gap_m = one.boundary_distance(center) - threat.radius_m;
            found(gap_m, &mut narrowest_m);
        }
    }
    narrowest_m
}

/// What a zone closes in the plane, with mitred corners.
fn closed_ring(zone: &PlanZone) -> Ring {
    Ring::around(&zone.outline).outset(zone.buffer_m)
}

/// Distance between the boxes around two rings, metres.
fn apart_m(one: &Ring, other: &Ring) -> f64 {
    let ((low, high), (other_low, other_high)) = (one.bounds(), other.bounds());
    let gap = |axis: usize| {
        (other_low[axis] - high[axis])
            .max(low[axis] - other_high[axis])
            .max(0.0)
    };
    gap(0).hypot(gap(1))
}

/// Whether the box around a ring touches a box, given by its corners in the south west and north east.
fn touches(ring: &Ring, (south_west, north_east): (EastNorth, EastNorth)) -> bool {
    let (low, high) = ring.bounds();
    low[0] <= north_east.east_m
        && high[0] >= south_west.east_m
        && low[1] <= north_east.north_m
        && high[1] >= south_west.north_m
}

/// The zones that nobody may fly over or under, at any time.
fn closed(world: &World) -> impl Iterator<Item = &PlanZone> {
    world
        .zones
        .iter()
        .filter(|zone| zone.is_closed_throughout())
}

/// The least breadth of a closed zone that touches a box, metres; infinite if there are none.
pub(crate) fn narrowest_zone_m(world: &World, within: (EastNorth, EastNorth)) -> f64 {
    let breadth_m = |zone: &PlanZone| {
        let edges_m = Ring::around(&zone.outline)
            .edges()
            .map(|(a, b)| distance(a, b))
            .sum::<f64>();
        2.0 * (zone.outline.unsigned_area() / edges_m.max(1e-9) + zone.buffer_m)
    };
    closed(world)
        .filter(|zone| touches(&closed_ring(zone), within))
        .map(breadth_m)
        .fold(f64::INFINITY, f64::min)
}

fn distance_m(one: &Ring, other: &Ring) -> f64 {
    let pairs = one
        .edges()
        .flat_map(|edge| other.edges().map(move |to| (edge, to)));
    pairs
        .map(|(edge, to)| closest_points(edge, to))
        .map(|(a, b)| distance(a, b))
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use geo::{LineString, Polygon};
    use proptest::prelude::*;

    use super::crossed_nodes;
    use crate::geodesy::EastNorth;
    use crate::numeric::geometry::Ring;
    use crate::plan::classes::grid::Grid;
    use crate::world::PlanZone;

    /// 21 by 21 nodes, a hundred metres apart.
    fn grid() -> Grid {
        let corner = |side_m: f64| EastNorth {
            east_m: side_m,
            north_m: side_m,
        };
        Grid::over(corner(0.0), corner(2000.0), 21)
    }

    /// A strip around the line between two places, as wide.
    fn strip(from: (f64, f64), to: (f64, f64), width_m: f64) -> PlanZone {
        let (x, y) = (to.0 - from.0, to.1 - from.1);
        let half = 0.5 * width_m / x.hypot(y);
        let corner = |at: (f64, f64), side: f64| (at.0 - side * half * y, at.1 + side * half * x);
        let corners = vec![
            corner(from, 1.0),
            corner(from, -1.0),
            corner(to, -1.0),
            corner(to, 1.0),
        ];
        PlanZone::closed(Polygon::new(LineString::from(corners), vec![]))
    }

    /// Nodes that moves lead to from one, past what the zones close.
    fn reached(zones: &[PlanZone], from: usize) -> Vec<bool> {
        let grid = grid();
        let mut is_open: Vec<bool> = (0..grid.len())
            .map(|node| {
                let at = grid.at(node);
                !zones
                    .iter()
                    .any(|zone| Ring::around(&zone.outline).contains([at.east_m, at.north_m]))
            })
            .collect();
        for node in zones.iter().flat_map(|zone| crossed_nodes(&grid, zone)) {
            is_open[node] = false;
        }
        let mut reached = vec![false; grid.len()];
        let mut ahead = vec![from];
        while let Some(node) = ahead.pop() {
            if !is_open[node] || std::mem::replace(&mut reached[node], true) {
                continue;
            }
            let steps = (-1..=1).flat_map(|east| (-1..=1).map(move |north| (east, north)));
            ahead.extend(steps.filter_map(|step| grid.step(node, step)));
        }
        reached
    }

    proptest! {
        /// From west to east, whatever the slant of a wall from south to north.
        #[test]
        fn a_wall_of_any_width_is_closed(
            south in 300.0..1700.0_f64, north in 300.0..1700.0_f64, width_m in 0.01..150.0_f64
        ) {
            let wall = strip((south, -100.0), (north, 2100.0), width_m);
            let reached = reached(&[wall], 0);
            prop_assert!(reached[0]);
            prop_assert!(!reached[20]);
        }

        #[test]
        fn a_gap_of_two_cells_in_a_wall_stays_open(
            east in 300.0..1700.0_f64, gap in 300.0..1500.0_f64, width_m in 0.01..50.0_f64
        ) {
            let walls = [
                strip((east, -100.0), (east, gap), width_m),
                strip((east, gap + 200.0), (east, 2100.0), width_m),
            ];
            prop_assert!(reached(&walls, 0)[20]);
        }
    }

    #[test]
    fn nodes_inside_a_zone_add_nothing() {
        let block = strip((1000.0, 520.0), (1000.0, 1480.0), 760.0);
        assert_eq!(crossed_nodes(&grid(), &block), Vec::<usize>::new());
    }
}
