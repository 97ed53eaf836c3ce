//! Homotopy classes: which sides of the obstacles a path can take.
//!
//! Obstacles are the persistent maxima of the cost fields, so no list of peaks or
//! threats is needed and any terrain will do. Shortest path trees from both ends
//! over the same field give, for every node, the cheapest path through it; paths
//! that pass the obstacles on different sides differ in a signature, the sum of the
//! random numbers of the obstacles whose rays they cross (signed by the direction:
//! homology in the plane without the obstacles). One pass so finds every class that
//! has one via point.

pub(super) mod corridors;
pub(super) mod field;
pub(super) mod free_space;
pub(super) mod grid;
pub(super) mod narrow_zones;
pub(super) mod obstacles;
pub(super) mod overflights;
pub(super) mod routes;
pub(super) mod taut_line;

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use rayon::prelude::*;

use crate::geodesy::EastNorth;
use field::{Field, Rises};
use grid::Grid;
use obstacles::Obstacles;

/// Classes this much dearer than the cheapest are not worth a look.
const DETOUR: f64 = 2.2;
/// A bound that is so little above counts as equal.
const ROUNDING: f64 = 1.0 + 1e-9;
/// A path in the plane that stands for its class.
#[derive(Clone, Debug)]
pub(super) struct HomotopyClass {
    /// Sum of the numbers of the obstacle rays that its lines cross.
    pub signature: u64,
    /// Its cost in the field it was found in.
    pub cost: f64,
    /// Index of that field.
    pub field: usize,
    /// From end to end.
    pub line: Vec<EastNorth>,
}

/// Shortest paths from one node to all others.
struct Tree {
    cost: Vec<f64>,
    parent: Vec<usize>,
    /// Signature of the path from the root.
    signature: Vec<u64>,
    /// What a whole way with this path costs at least: as much as its part up to a node and the climb from the other end to
    /// that node.
    whole: Vec<f64>,
}

impl Tree {
    /// Goes on to a node from the one before, across rays of obstacles; `climb` is what a way to it from the other end costs
    /// at least.
    fn go_on_to(&mut self, node: usize, crossing: u64, climb: Option<f64>) {
        let parent = self.parent[node];
        self.signature[node] = self.signature[parent].wrapping_add(crossing);
        if let Some(climb) = climb {
            // Where the floor is closed it is no number.
            self.whole[node] = self.whole[parent].max(self.cost[node] + climb);
        }
    }
}

/// A step to another node: columns and rows.
type Step = (isize, isize);

/// King's moves, knight's moves and the two longer ones between them, one of each kind, with
/// the nodes that it passes beside its ends.
const KINDS: [(Step, &[Step]); 5] = [
    ((1, 0), &[]),
    ((1, 1), &[]),
    ((2, 1), &[(1, 0), (1, 1)]),
    ((3, 1), &[(1, 0), (2, 1)]),
    ((3, 2), &[(1, 1), (2, 1)]),
];
/// No move leads further than this along an axis.
const REACH: usize = 3;

/// A move in one of 32 directions; nodes are given by their offset in the grid.
struct Move {
    step: Step,
    length_km: f64,
    to: isize,
    /// Nodes it passes beside its ends, if any: they lie in the box of these.
    passed: Option<[isize; 2]>,
}

impl Move {
    /// The move of a step over a grid.
    fn new(step: Step, passed: &[Step], grid: &Grid) -> Self {
        let (columns, rows) = step;
        #[expect(clippy::cast_precision_loss, reason = "at most three cells")]
        let cells = (columns as f64).hypot(rows as f64);
        let number = |(columns, rows): Step| rows * grid.columns.cast_signed() + columns;
        Self {
            step,
            length_km: cells * grid.spacing_m / 1000.0,
            to: number(step),
            passed: match passed {
                &[one, other] => Some([number(one), number(other)]),
                _ => None,
            },
        }
    }

    /// The cost of a way to a node and on to the next, the rise between them included.
    fn cost_after(&self, before: f64, field: &Field, (from, to): (usize, usize)) -> f64 {
        let cost = before + self.cost(&field.cost, from, to);
        let rise = |rises: &Rises| rises.cost(from, to, self.length_km);
        field
            .rises
            .as_ref()
            .map_or(cost, |rises| cost + rise(rises))
    }

    /// Its kilometres from a node to the next, times the mean cost of what it passes.
    fn cost(&self, costs: &[f64], from: usize, to: usize) -> f64 {
        let ends = 0.5 * (costs[from] + costs[to]);
        match self.passed {
            None => self.length_km * ends,
            Some([one, other]) => {
                let passed = |number| costs[from.wrapping_add_signed(number)];
                self.length_km * (ends + passed(one) + passed(other)) / 3.0
            }
        }
    }
}

/// All moves over a grid.
fn moves(grid: &Grid) -> Vec<Move> {
    let mut all: Vec<Move> = Vec::new();
    for (step, passed) in KINDS {
        for (sx, sy) in [(1, 1), (1, -1), (-1, 1), (-1, -1)] {
            for swap in [false, true] {
                let turn = |(x, y): Step| {
                    if swap {
                        (sx * y, sy * x)
                    } else {
                        (sx * x, sy * y)
                    }
                };
                if all.iter().all(|known| known.step != turn(step)) {
                    let passed: Vec<Step> = passed.iter().map(|&step| turn(step)).collect();
                    all.push(Move::new(turn(step), &passed, grid));
                }
            }
        }
    }
    all
}

/// Dijkstra's algorithm from a node, as far as classes on the way to another one are worth a look: no
/// path costs less than its way to any of its nodes and `onward`, the least that it costs from there
/// to the end. `climbs` are what a way to a node costs at least, from the root and from the end. Costs are not
/// negative, so their bits sort as they do.
fn tree(
    field: &Field,
    (root, end): (usize, usize),
    obstacles: &Obstacles,
    (onward, climbs): (impl Fn(usize) -> f64, Option<[&[f64]; 2]>),
) -> Tree {
    let grid = &field.grid;
    let moves = moves(grid);
    let mut tree = Tree {
        cost: vec![f64::INFINITY; grid.len()],
        parent: vec![usize::MAX; grid.len()],
        signature: vec![0; grid.len()],
        whole: vec![0.0; grid.len()],
    };
    tree.cost[root] = 0.0;
    let mut queue = BinaryHeap::from([Reverse((0_u64, root))]);
    let mut settled = vec![false; grid.len()];
    while let Some(Reverse((_, node))) = queue.pop() {
        let most = DETOUR * tree.cost[end];
        if settled[end] && tree.cost[node] > most {
            break;
        }
        if settled[node] {
            continue;
        }
        if settled[end] && tree.cost[node] + onward(node) > most * ROUNDING {
            continue;
        }
        settled[node] = true;
        let parent = tree.parent[node];
        if parent != usize::MAX {
            let crossing = obstacles.crossing(grid.at(parent), grid.at(node));
            tree.go_on_to(node, crossing, climbs.map(|[_, others]| others[node]));
        }
        let at_edge = grid.is_near_edge(node, REACH);
        for movement in &moves {
            if at_edge && grid.step(node, movement.step).is_none() {
                continue;
            }
            let next = node.wrapping_add_signed(movement.to);
            if settled[next] {
                continue;
            }
            let cost = movement.cost_after(tree.cost[node], field, (node, next));
            let cost = climbs.map_or(cost, |[own, _]| cost.max(own[next]));
            if cost < tree.cost[next] {
                tree.cost[next] = cost;
                tree.parent[next] = node;
                queue.push(Reverse((cost.to_bits(), next)));
            }
        }
    }
    for (cost, _) in tree.cost.iter_mut().zip(settled).filter(|of| !of.1) {
        *cost = f64::INFINITY;
    }
    tree
}

/// The cheapest path of every class of fields over one grid, each with the index of its field;
/// cheapest first. Fields that are all one are searched once.
pub(super) fn classes_of_fields(
    (fields, is_one): (&[Field], bool),
    obstacles: &Obstacles,
    start: EastNorth,
    goal: EastNorth,
) -> Vec<HomotopyClass> {
    let distinct = if is_one { &fields[..1] } else { fields };
    let found: Vec<Vec<HomotopyClass>> = distinct
        .par_iter()
        .map(|field| classes_of_field(field, obstacles, start, goal))
        .collect();
    let of_field = |field: usize| {
        let classes = found[field.min(found.len() - 1)].iter().cloned();
        classes.map(move |class| HomotopyClass { field, ..class })
    };
    let mut classes: Vec<HomotopyClass> = (0..fields.len()).flat_map(of_field).collect();
    classes.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    classes
}

/// The cheapest path of every class of a field, as if that were the first; cheapest first.
fn classes_of_field(
    field: &Field,
    obstacles: &Obstacles,
    start: EastNorth,
    goal: EastNorth,
) -> Vec<HomotopyClass> {
    let grid = &field.grid;
    let ends = (grid.nearest(start), grid.nearest(goal));
    let min_per_km = field.cost.iter().copied().fold(f64::INFINITY, f64::min);
    let end = grid.at(ends.1);
    let straight = |node: usize| min_per_km * grid.at(node).distance_m(end) / 1000.0;
    let climbs = field.climbs.as_deref();
    let climbs = climbs.map(|climbs| [climbs.from_start.as_slice(), &climbs.from_goal]);
    let from_start = tree(field, ends, obstacles, (straight, climbs));
    let known = |node: usize| from_start.cost[node];
    let climbs = climbs.map(|[from_start, from_goal]| [from_goal, from_start]);
    let from_goal = tree(field, (ends.1, ends.0), obstacles, (known, climbs));
    let mut cheapest: BTreeMap<u64, (f64, usize)> = BTreeMap::new();
    for node in 0..grid.len() {
        let cost = from_start.cost[node] + from_goal.cost[node];
        let cost = cost.max(from_start.whole[node]).max(from_goal.whole[node]);
        // The way from the goal is flown backwards: its crossings count negative.
        let class = from_start.signature[node].wrapping_sub(from_goal.signature[node]);
        let entry = cheapest.entry(class).or_insert((cost, node));
        if cost < entry.0 {
            *entry = (cost, node);
        }
    }
    let least = cheapest
        .values()
        .map(|entry| entry.0)
        .fold(f64::INFINITY, f64::min);
    let mut classes: Vec<HomotopyClass> = cheapest
        .into_iter()
        .filter(|(_, (cost, _))| *cost <= DETOUR * least)
        .map(|(signature, (cost, via))| HomotopyClass {
            signature,
            cost,
            field: 0,
            line: through(grid, &from_start, &from_goal, via, start, goal),
        })
        .collect();
    classes.sort_by(|a, b| {
        a.cost
            .total_cmp(&b.cost)
            .then(a.signature.cmp(&b.signature))
    });
    classes
}

/// The path through a node, with the exact ends.
fn through(
    grid: &Grid,
    from_start: &Tree,
    from_goal: &Tree,
    via: usize,
    start: EastNorth,
    goal: EastNorth,
) -> Vec<EastNorth> {
    let climb = |tree: &Tree| {
        let mut nodes = vec![via];
        let mut node = via;
        while tree.parent[node] != usize::MAX {
            node = tree.parent[node];
            nodes.push(node);
        }
        nodes
    };
    let mut nodes = climb(from_start);
    nodes.reverse();
    nodes.extend(climb(from_goal).into_iter().skip(1));
    let mut line: Vec<EastNorth> = nodes.into_iter().map(|node| grid.at(node)).collect();
    // The first and last node stand for the ends.
    line[0] = start;
    if line.len() == 1 {
        line.push(goal);
    } else {
        let last = line.len() - 1;
        line[last] = goal;
    }
    line
}

#[cfg(test)]
mod tests {
    use super::field::Climbs;
    use super::*;
    use std::sync::Arc;

    const START: EastNorth = EastNorth {
        east_m: 0.0,
        north_m: 10_000.0,
    };
    const GOAL: EastNorth = EastNorth {
        east_m: 20_000.0,
        north_m: 10_000.0,
    };

    /// A square of 20 km with round walls.
    fn field(walls: &[(f64, f64, f64)]) -> Field {
        let corner = |east_m, north_m| EastNorth { east_m, north_m };
        let grid = Grid::over(corner(0.0, 0.0), corner(20_000.0, 20_000.0), 41);
        let cost = (0..grid.len())
            .map(|node| {
                let at = grid.at(node);
                let inside = |&(east_m, north_m, radius_m): &(f64, f64, f64)| {
                    at.distance_m(EastNorth { east_m, north_m }) < radius_m
                };
                if walls.iter().any(inside) { 100.0 } else { 1.0 }
            })
            .collect();
        Field {
            grid,
            cost,
            rises: None,
            climbs: None,
        }
    }

    fn classes(walls: &[(f64, f64, f64)]) -> Vec<HomotopyClass> {
        let field = field(walls);
        let obstacles = Obstacles::of(std::slice::from_ref(&field), START, GOAL);
        classes_of_field(&field, &obstacles, START, GOAL)
    }

    #[test]
    fn in_the_open_there_is_one_class_and_it_is_straight() {
        let classes = classes(&[]);
        assert_eq!(classes.len(), 1);
        assert!((classes[0].cost - 20.0).abs() < 1e-9);
        assert_eq!(classes[0].line.first(), Some(&START));
        assert_eq!(classes[0].line.last(), Some(&GOAL));
    }

    #[test]
    fn one_wall_gives_two_classes_and_two_walls_aside_give_three() {
        assert_eq!(classes(&[(10_000.0, 10_000.0, 3000.0)]).len(), 2);
        let both = [(6000.0, 9000.0, 2000.0), (14_000.0, 11_000.0, 2000.0)];
        // Between them, left of both, right of both; the fourth would be a detour to no node.
        assert_eq!(classes(&both).len(), 3);
    }

    /// A ridge 700 m above both ends from edge to edge, 10 m above them in the south, and climbs of one in fifty.
    #[test]
    fn a_ridge_too_high_to_climb_on_the_straight_way_is_crossed_where_it_is_low() {
        let mut field = field(&[]);
        let obstacles = Obstacles::of(std::slice::from_ref(&field), START, GOAL);
        let climb_km = |node: usize| {
            let at = field.grid.at(node);
            let is_ridge = (at.east_m - 10_000.0).abs() < 600.0;
            let rise_m = if at.north_m < 3000.0 { 10.0 } else { 700.0 };
            if is_ridge { rise_m / 50.0 } else { 0.0 }
        };
        let from: Vec<f64> = (0..field.grid.len()).map(climb_km).collect();
        let climbs = Climbs {
            from_start: from.clone(),
            from_goal: from,
        };
        field.climbs = Some(Arc::new(climbs));
        let best = &classes_of_field(&field, &obstacles, START, GOAL)[0];
        let ridge = best.line.iter();
        let ridge = ridge.filter(|at| (at.east_m - 10_000.0).abs() < 600.0);
        assert!(ridge.clone().count() > 0);
        assert!(
            ridge.clone().all(|at| at.north_m < 3000.0),
            "{:?}",
            best.line
        );
        // The way through the low part, and not the climb to the high one.
        assert!((24.0..26.0).contains(&best.cost), "{}", best.cost);
    }

    #[test]
    fn the_signature_of_a_line_is_that_of_its_class() {
        let field = field(&[(7000.0, 9000.0, 2500.0), (13_000.0, 12_000.0, 2500.0)]);
        let obstacles = Obstacles::of(std::slice::from_ref(&field), START, GOAL);
        let classes = classes_of_field(&field, &obstacles, START, GOAL);
        assert!(classes.len() >= 3);
        for class in classes {
            assert_eq!(obstacles.signature(&class.line), class.signature);
        }
    }

    #[test]
    fn walls_that_touch_leave_no_path_between_them() {
        let walls = [(10_000.0, 8500.0, 2000.0), (10_000.0, 11_500.0, 2000.0)];
        for class in classes(&walls) {
            assert!(
                class
                    .line
                    .iter()
                    .filter(|at| (at.east_m - 10_000.0).abs() < 600.0)
                    .all(|at| (at.north_m - 10_000.0).abs() > 3000.0),
                "a way through costs {}",
                class.cost
            );
        }
    }

    #[test]
    fn there_are_32_moves_and_each_reaches_the_node_of_its_step() {
        let grid = field(&[]).grid;
        let moves = moves(&grid);
        assert_eq!(moves.len(), 32);
        let middle = grid.len() / 2;
        for movement in moves {
            let to = middle.wrapping_add_signed(movement.to);
            assert_eq!(grid.step(middle, movement.step), Some(to));
        }
    }
}
