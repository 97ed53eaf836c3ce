//! The ground of a map as it is drawn: bands of height from above, and a view from the
//! south-west.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::{Drawing, Plot, outline};
use crate::geodesy::EastNorth;
use crate::spec::{Cylinder, Scenario};
use crate::study::stats::as_f64;

/// Cells along one side, from above.
const CELLS: i32 = 64;
/// Height of a band, metres.
const BAND_M: f64 = 250.0;
/// Height that has the darkest colour, metres.
const SUMMIT_M: f64 = 3000.0;
/// Colour of threats.
pub(in crate::study) const DANGER: &str = "#c1272d";

/// A plot of a map in km.
pub(in crate::study) fn plot(scenario: &Scenario, at: [f64; 2], side: f64) -> Plot {
    let (low, high) = (scenario.south_west, scenario.north_east);
    Plot {
        at,
        size: [side, side],
        x: [low.east_m * 1e-3, high.east_m * 1e-3],
        y: [low.north_m * 1e-3, high.north_m * 1e-3],
        log: false,
    }
}

/// Colour of a height, `light` times as bright.
pub(in crate::study) fn tint(height_m: f64, light: f64) -> String {
    const STOPS: [[f64; 3]; 4] = [
        [228.0, 238.0, 214.0],
        [240.0, 228.0, 182.0],
        [214.0, 178.0, 134.0],
        [158.0, 116.0, 84.0],
    ];
    let at = (height_m / SUMMIT_M).clamp(0.0, 0.999) * 3.0;
    let (below, above) = match at {
        at if at < 1.0 => (STOPS[0], STOPS[1]),
        at if at < 2.0 => (STOPS[1], STOPS[2]),
        _ => (STOPS[2], STOPS[3]),
    };
    let mix = |k: usize| (light * (below[k] + at.fract() * (above[k] - below[k]))).min(255.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 0 to 255"
    )]
    let part = |k: usize| mix(k).round() as u8;
    format!("#{:02x}{:02x}{:02x}", part(0), part(1), part(2))
}

/// The ground from above.
pub(in crate::study) fn bands(drawing: &mut Drawing, scenario: &Scenario, plot: &Plot) {
    let grid = Grid::new(scenario);
    drawing.add(&format!(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>",
        plot.at[0],
        plot.at[1],
        plot.size[0],
        plot.size[1],
        tint(0.5 * BAND_M, 1.0)
    ));
    let mut level_m = BAND_M;
    while level_m < grid.top_m() {
        let shapes: Vec<String> = grid
            .rings(level_m)
            .iter()
            .map(|ring| {
                let points: Vec<[f64; 2]> = ring
                    .iter()
                    .map(|at| plot.place(at.east_m * 1e-3, at.north_m * 1e-3))
                    .collect();
                outline(&points) + "z"
            })
            .collect();
        drawing.add(&format!(
            "<path d=\"{}\" fill=\"{}\" fill-rule=\"evenodd\" stroke=\"#000\" \
             stroke-opacity=\".12\" stroke-width=\".5\"/>",
            shapes.concat(),
            tint(level_m + 0.5 * BAND_M, 1.0)
        ));
        level_m += BAND_M;
    }
}

/// What the colours of the bands mean, upwards from a place.
pub(in crate::study) fn key(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    let mut height_m = 0.0;
    while height_m < SUMMIT_M {
        let bottom = y - height_m / BAND_M * 9.0;
        let corners = [
            [x, bottom],
            [x + 14.0, bottom],
            [x + 14.0, bottom - 9.0],
            [x, bottom - 9.0],
        ];
        drawing.fill(&corners, &tint(height_m + 0.5 * BAND_M, 1.0), 1.0);
        height_m += BAND_M;
    }
    for km in 0..=3 {
        let at = y - f64::from(km) * 36.0;
        drawing.text([x + 18.0, at + 4.0], 11.0, "start", &format!("{km} km"));
    }
}

/// Threats from above.
pub(in crate::study) fn threats(drawing: &mut Drawing, scenario: &Scenario, plot: &Plot) {
    for threat in &scenario.threats {
        let rim: Vec<[f64; 2]> = rim(threat)
            .into_iter()
            .map(|at| plot.place(at.east_m * 1e-3, at.north_m * 1e-3))
            .collect();
        drawing.fill(&rim, DANGER, 0.25);
        drawing.line(&[&rim[..], &rim[..1]].concat(), DANGER, 1.0);
    }
}

pub(in crate::study) fn rim(threat: &Cylinder) -> Vec<EastNorth> {
    (0..40)
        .map(|k| {
            let angle = f64::from(k) * TAU / 40.0;
            EastNorth {
                east_m: threat.center.east_m + threat.radius_m * angle.cos(),
                north_m: threat.center.north_m + threat.radius_m * angle.sin(),
            }
        })
        .collect()
}

/// Heights at the nodes of a grid, and a ring of nothing around it.
struct Grid<'a> {
    scenario: &'a Scenario,
    heights_m: Vec<f64>,
}

/// An edge of the grid: from a node to the east, or else to the north.
type Edge = (i32, i32, bool);

impl<'a> Grid<'a> {
    fn new(scenario: &'a Scenario) -> Self {
        let nodes = (0..=CELLS).flat_map(|row| (0..=CELLS).map(move |column| (column, row)));
        Self {
            scenario,
            heights_m: nodes
                .map(|(column, row)| scenario.surface.height_m(node(scenario, column, row)))
                .collect(),
        }
    }

    fn top_m(&self) -> f64 {
        self.heights_m.iter().copied().fold(0.0, f64::max)
    }

    fn height_m(&self, column: i32, row: i32) -> f64 {
        let inside = 0..=CELLS;
        if inside.contains(&column) && inside.contains(&row) {
            let index = usize::try_from(row * (CELLS + 1) + column);
            index.map_or(f64::MIN, |index| self.heights_m[index])
        } else {
            f64::MIN
        }
    }

    /// Closed lines around all that is higher than a level, which they have to their left.
    fn rings(&self, level_m: f64) -> Vec<Vec<EastNorth>> {
        let mut steps = BTreeMap::new();
        for row in -1..=CELLS {
            for column in -1..=CELLS {
                self.steps(column, row, level_m, &mut steps);
            }
        }
        let mut rings = Vec::new();
        while let Some((first, mut next)) = steps.pop_first() {
            let mut ring = vec![self.crossing(first, level_m)];
            while next != first {
                ring.push(self.crossing(next, level_m));
                let Some(after) = steps.remove(&next) else {
                    break;
                };
                next = after;
            }
            rings.push(ring);
        }
        rings
    }

    /// How lines cross one cell, by the edge they come from: around it, from each edge that
    /// leaves the high side to the next that returns to it.
    fn steps(&self, column: i32, row: i32, level_m: f64, steps: &mut BTreeMap<Edge, Edge>) {
        let corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
            .map(|(right, up)| self.height_m(column + right, row + up) > level_m);
        let edges: [Edge; 4] = [
            (column, row, true),
            (column + 1, row, false),
            (column, row + 1, true),
            (column, row, false),
        ];
        for k in 0..4 {
            if corners[k] && !corners[(k + 1) % 4] {
                let back = (1..4)
                    .map(|more| (k + more) % 4)
                    .find(|&at| !corners[at] && corners[(at + 1) % 4]);
                if let Some(back) = back {
                    steps.insert(edges[k], edges[back]);
                }
            }
        }
    }

    /// Where a line of a level crosses an edge.
    fn crossing(&self, (column, row, eastward): Edge, level_m: f64) -> EastNorth {
        let (to_column, to_row) = if eastward {
            (column + 1, row)
        } else {
            (column, row + 1)
        };
        let (a, b) = (self.height_m(column, row), self.height_m(to_column, to_row));
        let share = ((level_m - a) / (b - a)).clamp(0.0, 1.0);
        let (from, to) = (
            node(self.scenario, column, row),
            node(self.scenario, to_column, to_row),
        );
        EastNorth {
            east_m: from.east_m + share * (to.east_m - from.east_m),
            north_m: from.north_m + share * (to.north_m - from.north_m),
        }
    }
}

/// A node of the grid; beyond the map the nearest on its edge.
fn node(scenario: &Scenario, column: i32, row: i32) -> EastNorth {
    let along = |from: f64, to: f64, k: i32| {
        from + (to - from) * f64::from(k.clamp(0, CELLS)) / f64::from(CELLS)
    };
    let (low, high) = (scenario.south_west, scenario.north_east);
    EastNorth {
        east_m: along(low.east_m, high.east_m, column),
        north_m: along(low.north_m, high.north_m, row),
    }
}

/// Starts as dots, goals as squares.
pub(in crate::study) fn ends(
    drawing: &mut Drawing,
    scenario: &Scenario,
    plot: &Plot,
    colours: &[&str],
) {
    for (vehicle, colour) in scenario.vehicles.iter().zip(colours.iter().cycle()) {
        let at = |at: EastNorth| plot.place(at.east_m * 1e-3, at.north_m * 1e-3);
        let ([x, y], [u, v]) = (at(vehicle.start.at), at(vehicle.goal.at));
        drawing.add(&format!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{colour}\"/>\
             <rect x=\"{:.1}\" y=\"{:.1}\" width=\"7\" height=\"7\" fill=\"#111\"/>",
            u - 3.5,
            v - 3.5
        ));
    }
}

/// Draws the sample of a line of a legend, its left end given.
pub(in crate::study) type Sample<'a> = &'a dyn Fn(&mut Drawing, [f64; 2]);

/// Lines of a legend, each with a sample drawn by `sample` at its left.
pub(in crate::study) fn legend(
    drawing: &mut Drawing,
    [x, y]: [f64; 2],
    lines: &[(&str, Sample<'_>)],
) {
    for (index, (text, sample)) in lines.iter().enumerate() {
        let y = y + 18.0 * as_f64(index);
        sample(drawing, [x, y - 4.0]);
        drawing.text([x + 30.0, y], 11.0, "start", text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn bands_ring_what_is_higher() {
        let text = include_str!("../../../missions/paper/s1.yaml");
        let scenario = Scenario::parse(Path::new("s1.yaml"), text).unwrap();
        let grid = Grid::new(&scenario);
        let rings = grid.rings(1500.0);
        // Five summits above 1500 m, two of which hang together at most.
        assert!((4..=5).contains(&rings.len()), "{}", rings.len());
        for at in rings.iter().flatten() {
            assert!((scenario.surface.height_m(*at) - 1500.0).abs() < 60.0);
        }
        // Counted around, the high side to the left, every ring has a positive area.
        for ring in &rings {
            let next = ring.iter().cycle().skip(1);
            let twice: f64 = ring
                .iter()
                .zip(next)
                .map(|(a, b)| a.east_m * b.north_m - b.east_m * a.north_m)
                .sum();
            assert!(twice > 0.0);
        }
        // All of the map is above -1 m: one ring, its edge.
        assert_eq!(grid.rings(-1.0).len(), 1);
    }
}
