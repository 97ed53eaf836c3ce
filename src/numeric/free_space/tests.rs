use proptest::prelude::*;

use super::{FreeSpace, Sights};
use crate::numeric::geometry::{Point, Ring, distance};

const AREA: [Point; 4] = [[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]];
const ENDS: [Point; 2] = [[1.5, 50.25], [98.5, 49.75]];

fn shortest_m(closed: &[Vec<Point>]) -> Option<f64> {
    let space = FreeSpace::new(&AREA, closed, &ENDS)?;
    let found = Sights::new(space).shortest(0, 1, 100_000)?;
    let walked: f64 = found
        .corners
        .windows(2)
        .map(|pair| distance(pair[0], pair[1]))
        .sum();
    assert!(
        (walked - found.length_m).abs() < 1e-9,
        "{walked} {}",
        found.length_m
    );
    Some(found.length_m)
}

/// Dijkstra over all pairs of corners that see each other.
fn by_all_pairs_m(closed: &[Vec<Point>]) -> Option<f64> {
    let rings: Vec<Ring> = closed.iter().map(|ring| Ring::new(ring)).collect();
    // Along an edge is free: the inside is not.
    let shrunk: Vec<Ring> = closed.iter().map(|ring| Ring::new(&shrunk(ring))).collect();
    let mut corners = ENDS.to_vec();
    corners.extend(closed.iter().flatten());
    // Where edges cross there are corners as well.
    let edges: Vec<(Point, Point)> = rings.iter().flat_map(Ring::edges).collect();
    for (index, &(a, b)) in edges.iter().enumerate() {
        corners.extend(
            edges[..index]
                .iter()
                .filter_map(|&(c, d)| crossing(a, b, c, d)),
        );
    }
    let is_free = |a: Point, b: Point| {
        let mut scratch = Vec::new();
        let in_area = [a, b]
            .iter()
            .flatten()
            .all(|value| (0.0..=100.0).contains(value));
        in_area
            && shrunk.iter().all(|ring| {
                ring.inside_fraction((a, b), (0.0, 1.0), &mut scratch) * distance(a, b) < 1e-6
            })
    };
    let mut to_m = vec![f64::INFINITY; corners.len()];
    let mut open: Vec<usize> = (0..corners.len()).collect();
    to_m[0] = 0.0;
    while let Some(place) = (0..open.len()).min_by(|a, b| to_m[open[*a]].total_cmp(&to_m[open[*b]]))
    {
        let node = open.swap_remove(place);
        if node == 1 || to_m[node].is_infinite() {
            break;
        }
        for &other in &open {
            let by_m = to_m[node] + distance(corners[node], corners[other]);
            if by_m < to_m[other] && is_free(corners[node], corners[other]) {
                to_m[other] = by_m;
            }
        }
    }
    to_m[1].is_finite().then_some(to_m[1])
}

/// A convex polygon, a little smaller.
fn shrunk(ring: &[Point]) -> Vec<Point> {
    let count = f64::from(u32::try_from(ring.len()).expect("few corners"));
    let middle = [0, 1].map(|axis| ring.iter().map(|at| at[axis]).sum::<f64>() / count);
    let toward = |at: &Point| [0, 1].map(|axis| at[axis] + 1e-8 * (middle[axis] - at[axis]));
    ring.iter().map(toward).collect()
}

fn crossing(a: Point, b: Point, c: Point, d: Point) -> Option<Point> {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]]);
    let cross = u[0] * v[1] - u[1] * v[0];
    let w = [c[0] - a[0], c[1] - a[1]];
    let (s, t) = (
        (w[0] * v[1] - w[1] * v[0]) / cross,
        (w[0] * u[1] - w[1] * u[0]) / cross,
    );
    let is_within = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    is_within.then(|| [a[0] + s * u[0], a[1] + s * u[1]])
}

fn polygon(center: Point, radius: f64, corners: u32, turn: f64) -> Vec<Point> {
    (0..corners)
        .map(|corner| {
            let angle = turn + std::f64::consts::TAU * f64::from(corner) / f64::from(corners);
            [
                center[0] + radius * angle.cos(),
                center[1] + radius * angle.sin(),
            ]
        })
        .collect()
}

#[test]
fn in_the_open_it_is_the_straight_line() {
    let found = shortest_m(&[]).expect("a path");
    assert!((found - distance(ENDS[0], ENDS[1])).abs() < 1e-9);
}

#[test]
fn a_wall_from_edge_to_edge_leaves_no_path() {
    let wall = vec![[49.0, -1.0], [51.0, -1.0], [51.0, 101.0], [49.0, 101.0]];
    assert_eq!(shortest_m(&[wall]), None);
}

#[test]
fn walls_open_by_turns_are_followed_around_every_end() {
    let wall = |west: f64, south: f64, north: f64| {
        vec![
            [west, south],
            [west + 2.0, south],
            [west + 2.0, north],
            [west, north],
        ]
    };
    let walls = [
        wall(20.0, -1.0, 90.0),
        wall(50.0, 10.0, 101.0),
        wall(80.0, -1.0, 90.0),
    ];
    let found = shortest_m(&walls).expect("a path");
    let by_hand = [
        ENDS[0],
        [20.0, 90.0],
        [22.0, 90.0],
        [50.0, 10.0],
        [52.0, 10.0],
        [80.0, 90.0],
        [82.0, 90.0],
        ENDS[1],
    ];
    let expected: f64 = by_hand
        .windows(2)
        .map(|pair| distance(pair[0], pair[1]))
        .sum();
    assert!((found - expected).abs() < 1e-6, "{found} {expected}");
}

#[test]
fn a_place_that_is_closed_has_no_path() {
    let over_start = polygon(ENDS[0], 1.0, 8, 0.0);
    assert_eq!(shortest_m(&[over_start]), None);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// Against Dijkstra over the whole visibility graph, obstacles overlapping.
    #[test]
    fn the_path_is_that_of_the_whole_visibility_graph(
        all in prop::collection::vec(
            (6.0..94.0_f64, 2.0..98.0_f64, 1.0..18.0_f64, 3..7_u32, 0.0..6.0_f64), 0..9),
    ) {
        let closed: Vec<Vec<Point>> = all
            .iter()
            .map(|&(x, y, radius, corners, turn)| polygon([x, y], radius.min(x - 3.0).min(97.0 - x), corners, turn))
            .collect();
        match (shortest_m(&closed), by_all_pairs_m(&closed)) {
            (Some(found), Some(expected)) => {
                prop_assert!((found - expected).abs() < 1e-4, "{found} against {expected}");
            }
            (found, expected) => prop_assert_eq!(found, expected),
        }
    }
}
