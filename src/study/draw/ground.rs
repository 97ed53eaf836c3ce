//! A map from above: bands of height, threats, starts and goals, legends.

use std::f64::consts::TAU;

use contour::ContourBuilder;
use geo::Coord;

use super::{Drawing, Plot, outline};
use crate::geodesy::EastNorth;
use crate::numeric::as_f64;
use crate::spec::{Cylinder, Scenario};

/// Cells along one side, from above.
const CELLS: usize = 64;
/// Height of a band, metres.
const BAND_M: f64 = 250.0;
/// Height of the darkest colour, metres.
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

fn on_plot(points: &[EastNorth], plot: &Plot) -> Vec<[f64; 2]> {
    let points = points.iter();
    points
        .map(|at| plot.place(at.east_m * 1e-3, at.north_m * 1e-3))
        .collect()
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
    let heights_m = heights_m(scenario);
    let top_m = heights_m.iter().copied().fold(0.0, f64::max);
    drawing.add(&format!(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>",
        plot.at[0],
        plot.at[1],
        plot.size[0],
        plot.size[1],
        tint(0.5 * BAND_M, 1.0)
    ));
    let mut level_m = BAND_M;
    while level_m < top_m {
        let rings = rings(scenario, &heights_m, level_m);
        let shapes = rings.iter().map(|ring| outline(&on_plot(ring, plot)) + "z");
        drawing.add(&format!(
            "<path d=\"{}\" fill=\"{}\" fill-rule=\"evenodd\" stroke=\"#000\" \
             stroke-opacity=\".12\" stroke-width=\".5\"/>",
            shapes.collect::<String>(),
            tint(level_m + 0.5 * BAND_M, 1.0)
        ));
        level_m += BAND_M;
    }
}

/// Legend of the bands, upwards from a point.
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
        let rim = on_plot(&rim(threat), plot);
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

/// Heights at the nodes of a grid, row by row from the south-west.
fn heights_m(scenario: &Scenario) -> Vec<f64> {
    let nodes = (0..=CELLS).flat_map(|row| (0..=CELLS).map(move |column| (column, row)));
    let height_m = |(column, row)| scenario.surface.height_m(at_node(scenario, column, row));
    nodes
        .map(|(column, row)| height_m((as_f64(column), as_f64(row))))
        .collect()
}

/// A point of the map by columns and rows of the grid; beyond the map the nearest on its edge.
fn at_node(scenario: &Scenario, column: f64, row: f64) -> EastNorth {
    let (low, high) = (scenario.south_west, scenario.north_east);
    let cells = as_f64(CELLS);
    let along = |from: f64, to: f64, k: f64| from + (to - from) * k.clamp(0.0, cells) / cells;
    EastNorth {
        east_m: along(low.east_m, high.east_m, column),
        north_m: along(low.north_m, high.north_m, row),
    }
}

/// Closed lines around the ground above a level, along the edge of the map where it is above.
fn rings(scenario: &Scenario, heights_m: &[f64], level_m: f64) -> Vec<Vec<EastNorth>> {
    let lines = ContourBuilder::new(CELLS + 1, CELLS + 1, true).lines(heights_m, &[level_m]);
    let lines = lines
        .into_iter()
        .flatten()
        .flat_map(|line| line.into_inner().0.0);
    // Nodes lie at the centres of the crate's cells.
    let point = |at: Coord| at_node(scenario, at.x - 0.5, at.y - 0.5);
    lines
        .map(|line| line.0.into_iter().map(point).collect())
        .collect()
}

/// Starts as dots, goals as squares.
pub(in crate::study) fn ends(
    drawing: &mut Drawing,
    scenario: &Scenario,
    plot: &Plot,
    colours: &[&str],
) {
    for (vehicle, colour) in scenario.vehicles.iter().zip(colours.iter().cycle()) {
        let ends = on_plot(&[vehicle.start.at, vehicle.goal.at], plot);
        let ([x, y], [u, v]) = (ends[0], ends[1]);
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
    fn rings_enclose_higher_ground() {
        let text = include_str!("../../../missions/paper/s1.yaml");
        let scenario = Scenario::parse(Path::new("s1.yaml"), text).unwrap();
        let heights_m = heights_m(&scenario);
        let above_1500 = rings(&scenario, &heights_m, 1500.0);
        // Five summits above 1500 m; at most two share a ring.
        assert!((4..=5).contains(&above_1500.len()), "{}", above_1500.len());
        for at in above_1500.iter().flatten() {
            assert!((scenario.surface.height_m(*at) - 1500.0).abs() < 60.0);
        }
        // All of the map is above -1 m: one ring, its edge.
        assert_eq!(rings(&scenario, &heights_m, -1.0).len(), 1);
    }
}
