//! SVG drawings with axes.

pub(super) mod ground;
pub(super) mod view;

use std::fmt::Write;

/// Colours of lines, in order; distinct on screen and on paper.
pub(in crate::study) const COLOURS: [&str; 8] = [
    "#c1272d", "#0000a7", "#008176", "#b8860b", "#7b3294", "#4d4d4d", "#e66101", "#1f9ede",
];

/// A drawing under construction; sizes in pixels.
pub(in crate::study) struct Drawing {
    width: f64,
    height: f64,
    body: String,
}

/// A part of a drawing with axes of its own.
#[derive(Clone, Copy, Debug)]
pub(in crate::study) struct Plot {
    /// Left and top edge.
    pub(in crate::study) at: [f64; 2],
    /// Width and height.
    pub(in crate::study) size: [f64; 2],
    /// Range of x, left to right.
    pub(in crate::study) x: [f64; 2],
    /// Range of y, bottom to top.
    pub(in crate::study) y: [f64; 2],
    /// Whether y, then above 0, is logarithmic.
    pub(in crate::study) log: bool,
}

impl Plot {
    /// Where a value is in the drawing.
    pub(in crate::study) fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let share = |value: f64, [from, to]: [f64; 2]| (value - from) / (to - from);
        let up = if self.log {
            share(y.ln(), self.y.map(f64::ln))
        } else {
            share(y, self.y)
        };
        [
            self.at[0] + self.size[0] * share(x, self.x),
            self.at[1] + self.size[1] * (1.0 - up),
        ]
    }
}

impl Drawing {
    /// An empty drawing.
    pub(in crate::study) fn new(width: f64, height: f64) -> Self {
        Self {
            width,
            height,
            body: String::new(),
        }
    }

    /// Adds raw markup.
    pub(in crate::study) fn add(&mut self, markup: &str) {
        self.body.push_str(markup);
        self.body.push('\n');
    }

    /// A line through points.
    pub(in crate::study) fn line(&mut self, points: &[[f64; 2]], colour: &str, width: f64) {
        self.add(&format!(
            "<path d=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" \
             stroke-linejoin=\"round\"/>",
            outline(points)
        ));
    }

    /// A broken line through points.
    pub(in crate::study) fn dashes(&mut self, points: &[[f64; 2]], colour: &str, width: f64) {
        self.add(&format!(
            "<path d=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" \
             stroke-dasharray=\"5 3\"/>",
            outline(points)
        ));
    }

    /// A filled shape.
    pub(in crate::study) fn fill(&mut self, points: &[[f64; 2]], colour: &str, opacity: f64) {
        self.add(&format!(
            "<path d=\"{}z\" fill=\"{colour}\" fill-opacity=\"{opacity}\"/>",
            outline(points)
        ));
    }

    /// A text; `anchor` is start, middle or end.
    pub(in crate::study) fn text(&mut self, [x, y]: [f64; 2], size: f64, anchor: &str, text: &str) {
        let text = escaped(text);
        self.add(&format!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\">{text}</text>"
        ));
    }

    /// Frame, ticks and names of the axes of a plot.
    pub(in crate::study) fn axes(&mut self, plot: &Plot, x_name: &str, y_name: &str) {
        let ([left, top], [width, height]) = (plot.at, plot.size);
        let (bottom, middle) = (top + height, left + width / 2.0);
        self.add(&format!(
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" \
             fill=\"none\" stroke=\"#333\"/>"
        ));
        for value in ticks(plot.x) {
            let [x, _] = plot.place(value, plot.y[0]);
            self.line(&[[x, bottom], [x, bottom + 4.0]], "#333", 1.0);
            self.text([x, bottom + 16.0], 11.0, "middle", &label(value));
        }
        let marks = if plot.log {
            log_ticks(plot.y)
        } else {
            ticks(plot.y)
        };
        for value in marks {
            let [_, y] = plot.place(plot.x[0], value);
            self.line(&[[left - 4.0, y], [left, y]], "#333", 1.0);
            self.text([left - 7.0, y + 4.0], 11.0, "end", &label(value));
        }
        self.text([middle, bottom + 32.0], 12.0, "middle", x_name);
        let (x, y) = (left - 40.0, top + height / 2.0);
        self.add(&format!(
            "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" font-size=\"12\" \
             text-anchor=\"middle\">{}</text>",
            escaped(y_name)
        ));
    }

    /// The whole SVG document.
    pub(in crate::study) fn finish(self) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" \
             viewBox=\"0 0 {w} {h}\" font-family=\"sans-serif\" fill=\"#111\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}</svg>\n",
            self.body,
            w = self.width,
            h = self.height
        )
    }
}

/// Path data through points: the first, then steps, in tenths of a pixel.
pub(in crate::study) fn outline(points: &[[f64; 2]]) -> String {
    let mut text = String::new();
    let mut before: Option<[f64; 2]> = None;
    for point in points {
        let at = point.map(|value| (value * 10.0).round());
        let _ = match before {
            None => write!(text, "M{} {}l", at[0] / 10.0, at[1] / 10.0),
            Some([x, y]) => write!(text, "{} {} ", (at[0] - x) / 10.0, (at[1] - y) / 10.0),
        };
        before = Some(at);
    }
    text.truncate(text.trim_end_matches([' ', 'l']).len());
    text
}

/// Text safe inside markup.
pub(in crate::study) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// Round values in a range, about five of them.
fn ticks([from, to]: [f64; 2]) -> Vec<f64> {
    let rough = ((to - from) / 5.0).max(f64::MIN_POSITIVE);
    let unit = 10.0_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * unit)
        .find(|step| *step >= rough * 0.999)
        .unwrap_or(rough);
    let mut value = (from / step).ceil() * step;
    let mut all = Vec::new();
    while value <= to + 1e-9 * step && all.len() < 20 {
        all.push(value);
        value += step;
    }
    all
}

/// Round values in a range above 0 for a logarithmic axis.
fn log_ticks([from, to]: [f64; 2]) -> Vec<f64> {
    let (low, high) = (from.log10().floor(), to.log10().ceil());
    let decades = std::iter::successors(Some(low), |at| Some(at + 1.0)).take_while(|at| *at < high);
    decades
        .flat_map(|at| [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0].map(|k| k * 10.0_f64.powf(at)))
        .filter(|value| (from..=to).contains(value))
        .collect()
}

fn label(value: f64) -> String {
    let text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" {
        "0".to_owned()
    } else {
        short.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let labels = |ticks: Vec<f64>| ticks.into_iter().map(label).collect::<Vec<_>>();
        assert_eq!(
            labels(ticks([0.0, 100.0])),
            ["0", "20", "40", "60", "80", "100"]
        );
        assert_eq!(
            labels(log_ticks([390.0, 850.0])),
            ["400", "500", "600", "800"]
        );
        let inside = 380.0..=2100.0;
        assert!(ticks([380.0, 2100.0]).iter().all(|at| inside.contains(at)));
    }

    #[test]
    fn a_plot_has_its_corners_where_they_belong() {
        for log in [false, true] {
            let plot = Plot {
                at: [10.0, 20.0],
                size: [100.0, 50.0],
                x: [0.0, 2.0],
                y: [1.0, 100.0],
                log,
            };
            let near = |a: [f64; 2], b: [f64; 2]| {
                assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9, "{a:?} {b:?}");
            };
            near(plot.place(0.0, 1.0), [10.0, 70.0]);
            near(plot.place(2.0, 100.0), [110.0, 20.0]);
            near(plot.place(1.0, if log { 10.0 } else { 50.5 }), [60.0, 45.0]);
        }
    }

    #[test]
    fn an_outline_does_not_drift() {
        let points: Vec<[f64; 2]> = (0..3).map(|k| [0.26 * f64::from(k), 1.0]).collect();
        assert_eq!(outline(&points), "M0 1l0.3 0 0.2 0");
        assert_eq!(outline(&points[..1]), "M0 1");
        assert_eq!(outline(&[]), "");
    }
}
