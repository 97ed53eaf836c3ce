//! Lines of equal height over a relief, by marching squares.
//!
//! The crate `contour` closes its lines along the edge of the grid and knows no voids.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::geodesy::EastNorth;
use crate::report::scene::{Bounds, Relief, round_step};

/// Contour lines at a round interval.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::report) struct Contours {
    /// Metres between lines; 0 without any.
    pub(in crate::report) interval_m: f64,
    /// Every line but the index lines.
    pub(in crate::report) plain: Vec<Line>,
    /// Every fifth line.
    pub(in crate::report) index: Vec<Line>,
}

/// One line, closed where the last point is the first.
pub(in crate::report) type Line = Vec<EastNorth>;

/// An edge of the grid: from a node to the east, or else to the north.
type Edge = (u32, u32, bool);

impl Contours {
    /// About a dozen lines; none over flat or unknown ground.
    pub(in crate::report) fn new(relief: &Relief, bounds: &Bounds) -> Self {
        let mut contours = Self::default();
        let Some((low_m, high_m)) = relief.range_m() else {
            return contours;
        };
        if high_m - low_m < 1.0 {
            return contours;
        }
        contours.interval_m = round_step((high_m - low_m) / 14.0);
        let interval_m = contours.interval_m;
        let first = (low_m / interval_m).ceil();
        let levels = (0..).map(|level: u32| first + f64::from(level));
        let levels: Vec<f64> = levels
            .take_while(|level| level * interval_m < high_m)
            .collect();
        let of_levels: Vec<Vec<Line>> = (levels.par_iter())
            .map(|level| lines(relief, bounds, level * interval_m))
            .collect();
        for (level, lines) in levels.iter().zip(of_levels) {
            if level.rem_euclid(5.0) < 0.5 {
                contours.index.extend(lines);
            } else {
                contours.plain.extend(lines);
            }
        }
        contours
    }
}

/// The lines of one height.
fn lines(relief: &Relief, bounds: &Bounds, height_m: f64) -> Vec<Line> {
    // Heights are whole decimetres: half of one above, no node lies on a line.
    let level_m = height_m + 0.05;
    let crossings = |edges: Vec<Edge>| {
        let edges = edges.into_iter();
        edges
            .map(|edge| crossing(relief, bounds, level_m, edge))
            .collect()
    };
    let chains = chained(&pieces(relief, level_m)).into_iter();
    chains.map(crossings).collect()
}

/// Pairs of edges that the line joins across one cell.
fn pieces(relief: &Relief, level_m: f64) -> Vec<[Edge; 2]> {
    let mut pieces = Vec::new();
    for row in 0..relief.rows - 1 {
        for column in 0..relief.columns - 1 {
            let below = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(right, up)| {
                let height_m = relief.at(i64::from(column) + right, i64::from(row) + up);
                height_m.map(|height_m| height_m < level_m)
            });
            let [Some(sw), Some(se), Some(ne), Some(nw)] = below else {
                continue;
            };
            let sides = [
                (sw != se, (column, row, true)),
                (se != ne, (column + 1, row, false)),
                (ne != nw, (column, row + 1, true)),
                (nw != sw, (column, row, false)),
            ];
            let crossed: Vec<Edge> = sides
                .into_iter()
                .filter_map(|(crossed, edge)| crossed.then_some(edge))
                .collect();
            pieces.extend(crossed.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
        }
    }
    pieces
}

/// Joins pieces that share an edge into long lines.
fn chained(pieces: &[[Edge; 2]]) -> Vec<Vec<Edge>> {
    let mut ends: BTreeMap<Edge, Vec<usize>> = BTreeMap::new();
    for (number, piece) in pieces.iter().enumerate() {
        for edge in piece {
            ends.entry(*edge).or_default().push(number);
        }
    }
    let mut used = vec![false; pieces.len()];
    let mut follow = |mut at: Edge, line: &mut Vec<Edge>| {
        while let Some(next) = ends
            .get(&at)
            .and_then(|numbers| numbers.iter().find(|number| !used[**number]))
        {
            used[*next] = true;
            let [a, b] = pieces[*next];
            at = if a == at { b } else { a };
            line.push(at);
        }
    };
    let mut lines = Vec::new();
    for [first, _] in pieces {
        // Back from the first edge, then on from it: the whole line at once.
        let mut line = Vec::new();
        follow(*first, &mut line);
        line.reverse();
        line.push(*first);
        follow(*first, &mut line);
        if line.len() > 1 {
            lines.push(line);
        }
    }
    lines
}

/// Where the line crosses an edge.
fn crossing(relief: &Relief, bounds: &Bounds, level_m: f64, edge: Edge) -> EastNorth {
    let (column, row, eastward) = edge;
    let (to_column, to_row) = if eastward {
        (column + 1, row)
    } else {
        (column, row + 1)
    };
    let height_m = |column, row| {
        relief
            .at(i64::from(column), i64::from(row))
            .unwrap_or(level_m)
    };
    let (a, b) = (height_m(column, row), height_m(to_column, to_row));
    let share = ((level_m - a) / (b - a)).clamp(0.0, 1.0);
    let (from, to) = (
        relief.node(bounds, column, row),
        relief.node(bounds, to_column, to_row),
    );
    EastNorth {
        east_m: from.east_m + (to.east_m - from.east_m) * share,
        north_m: from.north_m + (to.north_m - from.north_m) * share,
    }
}

#[cfg(test)]
mod tests {
    use super::{Bounds, Contours, Relief};

    const BOUNDS: Bounds = Bounds {
        west: 0.0,
        south: 0.0,
        east: 300.0,
        north: 200.0,
    };

    fn relief(height_dm: impl Fn(i32, i32) -> Option<i32>) -> Relief {
        let nodes = (0..3).flat_map(|row| (0..4).map(move |column| (column, row)));
        Relief {
            columns: 4,
            rows: 3,
            heights_dm: nodes.map(|(column, row)| height_dm(column, row)).collect(),
        }
    }

    #[test]
    fn contours_of_a_plane_are_straight_lines_and_stop_at_a_void() {
        let plane = Contours::new(&relief(|column, _| Some(column * 1000)), &BOUNDS);
        assert!((plane.interval_m - 50.0).abs() < 1e-9);
        let lines: Vec<_> = plane.index.iter().chain(&plane.plain).collect();
        // 0 to 300 m every 50 m, without the last.
        assert_eq!(lines.len(), 6);
        for line in lines {
            assert_eq!(line.len(), 3);
            assert!(
                line.iter()
                    .all(|at| (at.east_m - line[0].east_m).abs() < 1e-9)
            );
        }
        let holed = relief(|column, row| ((column, row) != (1, 0)).then_some(column * 1000));
        let broken = Contours::new(&holed, &BOUNDS);
        let points = broken.index.iter().chain(&broken.plain).map(Vec::len);
        assert!(points.sum::<usize>() < 6 * 3);
    }

    #[test]
    fn a_summit_is_ringed_by_a_closed_line() {
        let hill = relief(|column, row| Some(if (column, row) == (1, 1) { 1000 } else { 0 }));
        let contours = Contours::new(&hill, &BOUNDS);
        let ring = &contours.plain[0];
        assert_eq!(ring.len(), 5);
        assert_eq!(ring[0], ring[4]);
    }

    #[test]
    fn flat_ground_has_no_contours() {
        assert_eq!(
            Contours::new(&relief(|_, _| Some(4000)), &BOUNDS),
            Contours::default()
        );
        assert_eq!(
            Contours::new(&relief(|_, _| None), &BOUNDS),
            Contours::default()
        );
    }
}
