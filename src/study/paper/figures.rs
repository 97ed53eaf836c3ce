//! The paper's figures: 1 the maps, 2 to 4 the best paths, 5 to 7 the convergence.

use super::contestants::{Contestant, Role};
use super::convergence::convergence;
use super::record::Record;
use super::results::Results;
use crate::numeric::Basis;
use crate::numeric::as_f64;
use crate::study::document::Figure;
use crate::study::draw::ground::{DANGER, bands, ends, key, legend, plot, threats};
use crate::study::draw::view::view;
use crate::study::draw::{COLOURS, Drawing, Plot};
use crate::study::setting::Setting;

/// Points of a drawn path.
const PATH_POINTS: usize = 121;

/// All figures of a study: file name, caption, SVG.
pub(super) fn figures(results: &Results<'_>, settings: &[Setting]) -> Vec<Figure> {
    let mut all = vec![(
        "figure1.svg".to_owned(),
        "The maps, in three dimensions and from above: terrain, threats, starts (dots) and \
         goals (squares)."
            .to_owned(),
        maps(settings),
    )];
    for (number, setting) in (2..).zip(settings) {
        let name = &setting.scenario.name;
        all.push((
            format!("figure{number}.svg"),
            format!(
                "{name}: the paths of each contestant's best run, with J at 101 and at 2001 \
                 samples. A broken line breaks a limit at 2001 samples."
            ),
            paths(results, setting),
        ));
    }
    for (number, setting) in (2 + settings.len()..).zip(settings) {
        let name = &setting.scenario.name;
        all.push((
            format!("figure{number}.svg"),
            format!(
                "{name}: average over the runs of the best cost so far, summed over the vehicles, \
                 within one standard deviation. Left at equal iterations, where MSFOA spends \
                 twice the evaluations; right at equal evaluations."
            ),
            convergence(results, name),
        ));
    }
    all
}

/// Figure 1: a row for each map.
fn maps(settings: &[Setting]) -> String {
    let row = 420.0;
    let mut drawing = Drawing::new(1090.0, row * as_f64(settings.len()));
    for (index, setting) in settings.iter().enumerate() {
        let top = row * as_f64(index);
        let scenario = &setting.scenario;
        view(&mut drawing, scenario, [10.0, top + 25.0]);
        let plot = plot(scenario, [660.0, top + 30.0], 335.0);
        bands(&mut drawing, scenario, &plot);
        threats(&mut drawing, scenario, &plot);
        ends(&mut drawing, scenario, &plot, &COLOURS);
        drawing.axes(&plot, "east, km", "north, km");
        key(&mut drawing, [1015.0, top + 300.0]);
        drawing.text([1015.0, top + 182.0], 11.0, "start", "altitude");
        drawing.text([20.0, top + 24.0], 15.0, "start", &scenario.name);
    }
    drawing.finish()
}

/// Columns of figures 2 to 4, and the size of a panel.
const COLUMNS: usize = 4;
const PANEL: [f64; 2] = [290.0, 318.0];

/// Figures 2 to 4: a small map for each contestant.
fn paths(results: &Results<'_>, setting: &Setting) -> String {
    let scenario = &setting.scenario;
    let shown: Vec<(&Contestant, &Record)> = results
        .contestants
        .iter()
        .filter(|contestant| matches!(contestant.role, Role::Paper | Role::Own))
        .filter_map(|contestant| Some((contestant, results.best(contestant, &scenario.name)?)))
        .collect();
    let rows = (shown.len() + 1).div_ceil(COLUMNS);
    let mut drawing = Drawing::new(
        PANEL[0] * as_f64(COLUMNS) + 20.0,
        PANEL[1] * as_f64(rows) + 14.0,
    );
    let corner = |index: usize| {
        [
            PANEL[0] * as_f64(index % COLUMNS),
            PANEL[1] * as_f64(index / COLUMNS),
        ]
    };
    let plot_at = |[left, top]: [f64; 2]| plot(scenario, [left + 50.0, top + 42.0], 235.0);
    for (index, (contestant, record)) in shown.iter().enumerate() {
        let at = corner(index);
        let plot = plot_at(at);
        let ground = format!("ground-{}", scenario.name);
        if index == 0 {
            drawing.add(&format!("<g id=\"{ground}\">"));
            bands(&mut drawing, scenario, &plot);
            threats(&mut drawing, scenario, &plot);
            drawing.add("</g>");
        } else {
            let [left, top] = at;
            drawing.add(&format!(
                "<use href=\"#{ground}\" x=\"{left}\" y=\"{top}\"/>"
            ));
        }
        panel(&mut drawing, &plot, record);
        ends(&mut drawing, scenario, &plot, &COLOURS);
        let is_left = index % COLUMNS == 0;
        let is_low = index + COLUMNS >= shown.len();
        drawing.axes(
            &plot,
            if is_low { "east, km" } else { "" },
            if is_left { "north, km" } else { "" },
        );
        let title = contestant.title();
        drawing.text([plot.at[0], plot.at[1] - 22.0], 12.0, "start", &title);
        let cost = format!("J = {:.1}, finely {:.1}", record.total, record.fine_total);
        drawing.text([plot.at[0], plot.at[1] - 7.0], 11.0, "start", &cost);
    }
    let [left, top] = corner(shown.len());
    meanings(&mut drawing, setting, [left + 60.0, top + 60.0]);
    drawing.finish()
}

/// The paths of one run.
fn panel(drawing: &mut Drawing, plot: &Plot, record: &Record) {
    for (vehicle, colour) in record.vehicles.iter().zip(COLOURS.iter().cycle()) {
        let curve = curve(&vehicle.control_points, plot);
        if vehicle.safe {
            drawing.line(&curve, colour, 1.8);
        } else {
            drawing.dashes(&curve, colour, 1.8);
        }
    }
}

/// Legend of figures 2 to 4.
fn meanings(drawing: &mut Drawing, setting: &Setting, [x, y]: [f64; 2]) {
    for (index, vehicle) in setting.scenario.vehicles.iter().enumerate() {
        let y = y + 18.0 * as_f64(index);
        let colour = COLOURS[index % COLOURS.len()];
        drawing.line(&[[x, y - 4.0], [x + 24.0, y - 4.0]], colour, 2.0);
        drawing.text([x + 30.0, y], 11.0, "start", &vehicle.id);
    }
    let below = y + 18.0 * as_f64(setting.scenario.vehicles.len());
    legend(
        drawing,
        [x, below],
        &[
            ("breaks a limit at 2001 samples", &|drawing, [x, y]| {
                drawing.dashes(&[[x, y], [x + 24.0, y]], "#111", 1.8);
            }),
            ("goal", &|drawing, [x, y]| {
                let square = [[0.0, 0.0], [7.0, 0.0], [7.0, 7.0], [0.0, 7.0]];
                let corners = square.map(|[dx, dy]| [x + 8.0 + dx, y - 3.5 + dy]);
                drawing.fill(&corners, "#111", 1.0);
            }),
            ("threat", &|drawing, [x, y]| {
                let square = [[0.0, 0.0], [24.0, 0.0], [24.0, 9.0], [0.0, 9.0]];
                let corners = square.map(|[dx, dy]| [x + dx, y - 4.5 + dy]);
                drawing.fill(&corners, DANGER, 0.25);
            }),
        ],
    );
    key(drawing, [x, below + 180.0]);
}

/// A spline on a plot.
fn curve(control_points: &[[f64; 3]], plot: &Plot) -> Vec<[f64; 2]> {
    if control_points.len() < 4 {
        return Vec::new();
    }
    let basis = Basis::uniform(control_points.len(), PATH_POINTS);
    let axis = |axis: usize| {
        let values: Vec<f64> = control_points.iter().map(|point| point[axis]).collect();
        basis.sampled(&values)
    };
    axis(0)
        .into_iter()
        .zip(axis(1))
        .map(|(east_m, north_m)| plot.place(east_m * 1e-3, north_m * 1e-3))
        .collect()
}
