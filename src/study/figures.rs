//! The paper's figures: 1 the maps, 2 to 4 the best paths, 5 to 7 the convergence.

use std::f64::consts::TAU;

use super::contest::{Contestant, Role};
use super::record::Record;
use super::setting::Setting;
use super::stats::{Summary, number};
use super::svg::{COLOURS, Drawing, Plot};
use super::tables::{READINGS, Results};
use crate::geodesy::EastNorth;
use crate::numeric::Basis;
use crate::spec::Scenario;

/// Squares of the drawn ground along one side.
const SQUARES: u32 = 50;
/// Points of a drawn path.
const PATH_POINTS: usize = 201;

/// All figures of a study: file name, caption, SVG.
pub(super) fn figures(
    results: &Results<'_>,
    settings: &[Setting],
) -> Vec<(String, String, String)> {
    let mut all = vec![(
        "figure1.svg".to_owned(),
        "The maps, in three dimensions and from above: terrain, threats, starts and goals."
            .to_owned(),
        maps(settings),
    )];
    for (number, setting) in (2..).zip(settings) {
        let name = &setting.scenario.name;
        all.push((
            format!("figure{number}.svg"),
            format!(
                "{name}: the paths of each contestant's best run; grey are paths that are not \
                 safe at 2001 samples."
            ),
            paths(results, setting),
        ));
    }
    for (number, setting) in (2 + settings.len()..).zip(settings) {
        let name = &setting.scenario.name;
        all.push((
            format!("figure{number}.svg"),
            format!(
                "{name}: average best cost, and for MSFOA one standard deviation, over the \
                 evaluations of each vehicle; left MSFOA with equal iterations, right with equal \
                 evaluations."
            ),
            convergence(results, name),
        ));
    }
    all
}

/// The map in km.
fn plot(scenario: &Scenario, at: [f64; 2], side: f64) -> Plot {
    let (low, high) = (scenario.south_west, scenario.north_east);
    Plot {
        at,
        size: [side, side],
        x: [low.east_m * 1e-3, high.east_m * 1e-3],
        y: [low.north_m * 1e-3, high.north_m * 1e-3],
    }
}

/// Figure 1: a row for each map.
fn maps(settings: &[Setting]) -> String {
    let row = 430.0;
    let mut drawing = Drawing::new(1000.0, row * number(settings.len()));
    for (index, setting) in settings.iter().enumerate() {
        let top = row * number(index);
        let scenario = &setting.scenario;
        relief(&mut drawing, scenario, [20.0, top + 20.0]);
        let plot = plot(scenario, [620.0, top + 30.0], 340.0);
        ground(&mut drawing, scenario, &plot);
        threats(&mut drawing, scenario, &plot);
        ends(&mut drawing, scenario, &plot);
        drawing.axes(&plot, "east, km", "north, km");
        drawing.text([20.0, top + 24.0], 15.0, "start", &scenario.name);
    }
    drawing.finish()
}

/// Colour of a height: green lowland to white summits.
fn tint(share: f64) -> String {
    const STOPS: [[f64; 3]; 4] = [
        [214.0, 230.0, 196.0],
        [236.0, 226.0, 172.0],
        [198.0, 160.0, 118.0],
        [250.0, 248.0, 246.0],
    ];
    let at = share.clamp(0.0, 1.0) * 3.0;
    let (below, above) = match at {
        at if at < 1.0 => (STOPS[0], STOPS[1]),
        at if at < 2.0 => (STOPS[1], STOPS[2]),
        _ => (STOPS[2], STOPS[3]),
    };
    let part = if at < 3.0 { at.fract() } else { 1.0 };
    let mix = |k: usize| below[k] + part * (above[k] - below[k]);
    format!("rgb({:.0},{:.0},{:.0})", mix(0), mix(1), mix(2))
}

/// A node of the drawn grid.
fn node(scenario: &Scenario, column: u32, row: u32) -> EastNorth {
    let (low, high) = (scenario.south_west, scenario.north_east);
    let along = |from: f64, to: f64, k: u32| from + (to - from) * f64::from(k) / f64::from(SQUARES);
    EastNorth {
        east_m: along(low.east_m, high.east_m, column),
        north_m: along(low.north_m, high.north_m, row),
    }
}

/// Height that is drawn white, metres.
const SUMMIT_M: f64 = 3000.0;

/// The ground from above, as coloured squares.
fn ground(drawing: &mut Drawing, scenario: &Scenario, plot: &Plot) {
    drawing.add("<g shape-rendering=\"crispEdges\">");
    for row in 0..SQUARES {
        for column in 0..SQUARES {
            let (a, b) = (
                node(scenario, column, row),
                node(scenario, column + 1, row + 1),
            );
            let middle = EastNorth {
                east_m: 0.5 * (a.east_m + b.east_m),
                north_m: 0.5 * (a.north_m + b.north_m),
            };
            let [x, y] = plot.place(a.east_m * 1e-3, b.north_m * 1e-3);
            let [right, bottom] = plot.place(b.east_m * 1e-3, a.north_m * 1e-3);
            drawing.add(&format!(
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{}\"/>",
                right - x,
                bottom - y,
                tint(scenario.surface.height_m(middle) / SUMMIT_M)
            ));
        }
    }
    drawing.add("</g>");
}

fn threats(drawing: &mut Drawing, scenario: &Scenario, plot: &Plot) {
    for threat in &scenario.threats {
        let rim: Vec<[f64; 2]> = (0..48)
            .map(|k| {
                let angle = f64::from(k) * TAU / 48.0;
                plot.place(
                    (threat.center.east_m + threat.radius_m * angle.cos()) * 1e-3,
                    (threat.center.north_m + threat.radius_m * angle.sin()) * 1e-3,
                )
            })
            .collect();
        drawing.fill(&rim, "#c1272d", 0.25);
        drawing.line(&[&rim[..], &rim[..1]].concat(), "#c1272d", 1.0);
    }
}

/// Starts as dots, goals as squares.
fn ends(drawing: &mut Drawing, scenario: &Scenario, plot: &Plot) {
    for (index, vehicle) in scenario.vehicles.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
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

/// The ground in parallel projection from the south-west, far squares first.
fn relief(drawing: &mut Drawing, scenario: &Scenario, [left, top]: [f64; 2]) {
    let (low, high) = (scenario.south_west, scenario.north_east);
    let project = |at: EastNorth, up_m: f64| {
        let x = (at.east_m - low.east_m) / (high.east_m - low.east_m);
        let y = (at.north_m - low.north_m) / (high.north_m - low.north_m);
        [
            left + 270.0 + 260.0 * (x - y),
            top + 350.0 - 110.0 * (x + y) - up_m * 0.035,
        ]
    };
    let point = |at: EastNorth| project(at, scenario.surface.height_m(at));
    for far in (0..SQUARES).rev() {
        for across in (0..SQUARES).rev() {
            let corners = [
                node(scenario, across, far),
                node(scenario, across + 1, far),
                node(scenario, across + 1, far + 1),
                node(scenario, across, far + 1),
            ];
            let height_m = scenario.surface.height_m(corners[0]);
            // Light from the north-west.
            let rise_m = scenario.surface.height_m(corners[1]) - height_m;
            let shade = (0.5 - rise_m / 1200.0).clamp(0.0, 1.0);
            let shape = corners.map(point);
            drawing.fill(&shape, &tint(height_m / SUMMIT_M), 1.0);
            drawing.fill(&shape, "#000", 0.3 * (1.0 - shade));
        }
    }
    for threat in &scenario.threats {
        let rim = |up_m: f64| -> Vec<[f64; 2]> {
            (0..40)
                .map(|k| {
                    let angle = f64::from(k) * TAU / 40.0;
                    let at = EastNorth {
                        east_m: threat.center.east_m + threat.radius_m * angle.cos(),
                        north_m: threat.center.north_m + threat.radius_m * angle.sin(),
                    };
                    project(at, up_m)
                })
                .collect()
        };
        let (foot, top) = (rim(0.0), rim(scenario.max_amsl.0));
        // The wall between the two outermost points of the rim, and the lid.
        let side = |best: fn(f64, f64) -> bool| {
            (0..foot.len())
                .reduce(|a, b| if best(foot[b][0], foot[a][0]) { b } else { a })
                .unwrap_or(0)
        };
        let (west, east) = (side(|a, b| a < b), side(|a, b| a > b));
        drawing.fill(
            &[foot[west], foot[east], top[east], top[west]],
            "#c1272d",
            0.18,
        );
        drawing.fill(&top, "#c1272d", 0.25);
        drawing.line(&[&top[..], &top[..1]].concat(), "#c1272d", 1.0);
    }
}

/// Figures 2 to 4: a small map for each contestant.
fn paths(results: &Results<'_>, setting: &Setting) -> String {
    let scenario = &setting.scenario;
    let shown: Vec<(&Contestant, &Record)> = results
        .contestants
        .iter()
        .filter(|contestant| matches!(contestant.role, Role::Paper | Role::Own))
        .filter_map(|contestant| Some((contestant, results.best(contestant, &scenario.name)?)))
        .collect();
    let columns = 4;
    let (wide, tall) = (310.0, 330.0);
    let rows = shown.len().div_ceil(columns);
    let mut drawing = Drawing::new(wide * number(columns), tall * number(rows));
    for (index, (contestant, record)) in shown.into_iter().enumerate() {
        let (left, top) = (
            wide * number(index % columns),
            tall * number(index / columns),
        );
        let plot = plot(scenario, [left + 55.0, top + 40.0], 240.0);
        if index == 0 {
            drawing.add(&format!("<g id=\"map-{}\">", scenario.name));
            ground(&mut drawing, scenario, &plot);
            drawing.add("</g>");
        } else {
            // The same ground again.
            drawing.add(&format!(
                "<use href=\"#map-{}\" x=\"{left}\" y=\"{top}\"/>",
                scenario.name
            ));
        }
        threats(&mut drawing, scenario, &plot);
        for (index, vehicle) in record.vehicles.iter().enumerate() {
            let colour = if vehicle.safe {
                COLOURS[index % COLOURS.len()]
            } else {
                "#777"
            };
            drawing.line(&curve(&vehicle.control_points, &plot), colour, 2.0);
        }
        ends(&mut drawing, scenario, &plot);
        drawing.axes(&plot, "", "");
        let title = format!("{}, {}", contestant.label, contestant.protocol.name());
        drawing.text([left + 55.0, top + 18.0], 12.0, "start", &title);
        let cost = format!("J = {:.1}", record.total);
        drawing.text([left + 55.0, top + 33.0], 12.0, "start", &cost);
    }
    drawing.finish()
}

/// A spline on a plot.
fn curve(control_points: &[[f64; 3]], plot: &Plot) -> Vec<[f64; 2]> {
    if control_points.len() < 4 {
        return Vec::new();
    }
    let basis = Basis::uniform(control_points.len(), PATH_POINTS);
    let axis = |axis: usize| {
        let values: Vec<f64> = control_points.iter().map(|point| point[axis]).collect();
        let mut out = vec![0.0; PATH_POINTS];
        basis.apply(&values, &mut out);
        out
    };
    axis(0)
        .into_iter()
        .zip(axis(1))
        .map(|(east_m, north_m)| plot.place(east_m * 1e-3, north_m * 1e-3))
        .collect()
}

/// Sum over the vehicles of the least cost so far, for each run: a row for each run.
fn traces(results: &Results<'_>, contestant: &Contestant, map: &str) -> Vec<Vec<f64>> {
    results
        .cell(contestant, map)
        .map(|record| {
            let points = record.vehicles.iter().map(|vehicle| vehicle.trace.len());
            (0..points.min().unwrap_or(0))
                .map(|k| record.vehicles.iter().map(|vehicle| vehicle.trace[k]).sum())
                .collect()
        })
        .collect()
}

/// Figures 5 to 7: average of the least cost so far.
fn convergence(results: &Results<'_>, map: &str) -> String {
    let mut drawing = Drawing::new(1000.0, 470.0);
    for (index, readings) in [&READINGS[..2], &READINGS[2..]].into_iter().enumerate() {
        let mut shown: Vec<&Contestant> = readings
            .iter()
            .filter_map(|(name, protocol)| results.find(name, *protocol))
            .collect();
        shown.extend(results.seven(readings[0]).into_iter().skip(1));
        let curves: Vec<(&Contestant, f64, Vec<Summary>)> = shown
            .into_iter()
            .map(|contestant| {
                let config = results.config;
                let budget = contestant.budget(config.population, config.iterations);
                let rows = traces(results, contestant, map);
                let points = rows.iter().map(Vec::len).min().unwrap_or(0);
                let column = |k: usize| rows.iter().map(|row| row[k]).collect::<Vec<f64>>();
                let spread = (0..points)
                    .filter_map(|k| Summary::of(&column(k)))
                    .collect();
                (contestant, number(budget), spread)
            })
            .collect();
        let plot = convergence_plot(&curves, 70.0 + 490.0 * number(index));
        for (index, (contestant, budget, spread)) in curves.iter().enumerate() {
            let colour = COLOURS[index % COLOURS.len()];
            let points = number(spread.len().max(1));
            let place = |k: usize, cost: f64| {
                let [x, y] = plot.place(budget * number(k + 1) / points, cost);
                [x, y.clamp(plot.at[1], plot.at[1] + plot.size[1])]
            };
            let edge = |side: f64| {
                spread
                    .iter()
                    .enumerate()
                    .map(move |(k, of)| (k, of.average + side * of.deviation))
            };
            if contestant.name.starts_with("msfoa") {
                let mut band: Vec<[f64; 2]> = edge(1.0).map(|(k, at)| place(k, at)).collect();
                band.extend(
                    edge(-1.0)
                        .map(|(k, at)| place(k, at))
                        .collect::<Vec<_>>()
                        .iter()
                        .rev(),
                );
                drawing.fill(&band, colour, 0.15);
            }
            let line: Vec<[f64; 2]> = edge(0.0).map(|(k, at)| place(k, at)).collect();
            drawing.line(&line, colour, 1.8);
        }
        legend(&mut drawing, &plot, &curves);
        drawing.axes(&plot, "evaluations of each vehicle", "average best cost");
        let title = format!("{map}, MSFOA with equal {}", readings[0].1.name());
        drawing.text([plot.at[0], 22.0], 13.0, "start", &title);
    }
    drawing.finish()
}

/// Names of the curves, in the upper right corner.
fn legend(drawing: &mut Drawing, plot: &Plot, curves: &[(&Contestant, f64, Vec<Summary>)]) {
    let (left, top) = (plot.at[0] + plot.size[0] - 136.0, plot.at[1] + 4.0);
    let bottom = top + 15.0 * number(curves.len()) + 4.0;
    let right = plot.at[0] + plot.size[0] - 2.0;
    let box_of = [[left, top], [right, top], [right, bottom], [left, bottom]];
    drawing.fill(&box_of, "#fff", 0.85);
    for (index, (contestant, ..)) in curves.iter().enumerate() {
        let y = top + 12.0 + 15.0 * number(index);
        let colour = COLOURS[index % COLOURS.len()];
        drawing.line(
            &[[left + 6.0, y - 4.0], [left + 26.0, y - 4.0]],
            colour,
            2.5,
        );
        drawing.text([left + 32.0, y], 11.0, "start", contestant.label);
    }
}

/// Axes that hold the averages of all curves but their first few points.
fn convergence_plot(curves: &[(&Contestant, f64, Vec<Summary>)], left: f64) -> Plot {
    let costs = || {
        curves
            .iter()
            .flat_map(|(_, _, spread)| spread.iter().map(|of| of.average))
    };
    let low = costs().fold(f64::INFINITY, f64::min);
    let high = costs().fold(f64::NEG_INFINITY, f64::max);
    let (low, high) = if low < high { (low, high) } else { (0.0, 1.0) };
    let longest = curves.iter().map(|curve| curve.1).fold(1.0, f64::max);
    let room = 0.03 * (high - low);
    Plot {
        at: [left, 35.0],
        size: [410.0, 380.0],
        x: [0.0, longest],
        y: [low - room, (high + room).min(4.0 * low.max(1.0))],
    }
}
