//! Figures 5 to 7: the best cost over the budget, averaged over the runs.

use super::contestants::Contestant;
use super::results::{INTERPRETATIONS, Interpretation, Results};
use crate::numeric::as_f64;
use crate::study::draw::{COLOURS, Drawing, Plot};
use crate::study::stats::Summary;

/// The average best cost of one contestant on one map.
pub(super) struct Curve<'a> {
    pub(super) contestant: &'a Contestant,
    /// Over the runs, after each part of the budget; all parts are alike.
    pub(super) spread: Vec<Summary>,
}

impl<'a> Curve<'a> {
    /// Over all runs of a contestant.
    pub(super) fn new(results: &Results<'_>, contestant: &'a Contestant, map: &str) -> Self {
        let rows: Vec<Vec<f64>> = results
            .cell(contestant, map)
            .map(|record| {
                let points = record.vehicles.iter().map(|vehicle| vehicle.trace.len());
                (0..points.min().unwrap_or(0))
                    .map(|k| record.vehicles.iter().map(|vehicle| vehicle.trace[k]).sum())
                    .collect()
            })
            .collect();
        let points = rows.iter().map(Vec::len).min().unwrap_or(0);
        let column = |k: usize| rows.iter().map(|row| row[k]).collect::<Vec<f64>>();
        Self {
            contestant,
            spread: (0..points)
                .filter_map(|k| Summary::of(&column(k)))
                .collect(),
        }
    }

    /// Share of the budget after which the average is no more than a cost.
    pub(super) fn reaches(&self, cost: f64) -> Option<f64> {
        let first = self.spread.iter().position(|of| of.average <= cost)?;
        Some(as_f64(first + 1) / as_f64(self.spread.len()))
    }
}

/// A plot for each protocol, and a legend.
pub(super) fn convergence(results: &Results<'_>, map: &str) -> String {
    let mut drawing = Drawing::new(1120.0, 440.0);
    let config = results.config;
    let sides = [
        (&INTERPRETATIONS[..2], "iterations", config.iterations),
        (
            &INTERPRETATIONS[2..],
            "evaluations for each vehicle",
            config.population * config.iterations,
        ),
    ];
    let mut shown = Vec::new();
    for (index, (readings, unit, most)) in sides.into_iter().enumerate() {
        let curves = curves(results, readings, map);
        let plot = plot(&curves, as_f64(most), 65.0 + 465.0 * as_f64(index));
        for (curve, colour) in curves.iter().zip(COLOURS.iter().cycle()) {
            band(&mut drawing, &plot, curve, colour);
        }
        for (curve, colour) in curves.iter().zip(COLOURS.iter().cycle()) {
            let average = |of: &Summary| of.average;
            drawing.line(&points(&plot, curve, average), colour, 1.8);
        }
        let name = if index == 0 { "average best cost" } else { "" };
        drawing.axes(&plot, unit, name);
        let title = format!("{map}, equal {}", readings[0].1.name());
        drawing.text([plot.at[0], 24.0], 13.0, "start", &title);
        shown = curves;
    }
    for (index, curve) in shown.iter().enumerate() {
        let y = 48.0 + 18.0 * as_f64(index);
        let colour = COLOURS[index % COLOURS.len()];
        drawing.line(&[[968.0, y - 4.0], [992.0, y - 4.0]], colour, 2.5);
        drawing.text([998.0, y], 11.0, "start", &curve.contestant.label);
    }
    drawing.finish()
}

/// The readings of MSFOA, and the six others.
fn curves<'a>(results: &'a Results<'_>, readings: &[Interpretation], map: &str) -> Vec<Curve<'a>> {
    let msfoa = readings
        .iter()
        .filter_map(|(name, protocol)| results.find(name, *protocol));
    msfoa
        .chain(results.contestants(readings[0]).into_iter().skip(1))
        .map(|contestant| Curve::new(results, contestant, map))
        .collect()
}

/// Where a curve passes, its parts spread over the whole axis.
fn points(plot: &Plot, curve: &Curve<'_>, value: impl Fn(&Summary) -> f64) -> Vec<[f64; 2]> {
    let parts = as_f64(curve.spread.len().max(1));
    curve
        .spread
        .iter()
        .enumerate()
        .map(|(k, of)| {
            let x = plot.x[1] * as_f64(k + 1) / parts;
            plot.place(x, value(of).clamp(plot.y[0], plot.y[1]))
        })
        .collect()
}

/// One standard deviation to both sides.
fn band(drawing: &mut Drawing, plot: &Plot, curve: &Curve<'_>, colour: &str) {
    let mut edge = points(plot, curve, |of| of.average + of.deviation);
    edge.extend(
        points(plot, curve, |of| of.average - of.deviation)
            .iter()
            .rev(),
    );
    drawing.fill(&edge, colour, 0.1);
}

/// Axes that hold the averages of all curves.
fn plot(curves: &[Curve<'_>], most: f64, left: f64) -> Plot {
    let costs = || {
        curves
            .iter()
            .flat_map(|curve| curve.spread.iter().map(|of| of.average))
    };
    let low = costs().fold(f64::INFINITY, f64::min).max(1.0);
    let high = costs().fold(1.0, f64::max);
    let (low, high) = if low < high { (low, high) } else { (1.0, 10.0) };
    Plot {
        at: [left, 35.0],
        size: [410.0, 350.0],
        x: [0.0, most],
        y: [0.94 * low, 1.03 * high.min(6.0 * low)],
        log: true,
    }
}
