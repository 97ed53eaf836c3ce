//! Drawings: a plane with axes, and what is put on it.

use std::fmt::Write;

/// Colours of lines, in order; readable beside each other and in print.
pub(super) const COLOURS: [&str; 8] = [
    "#c1272d", "#0000a7", "#008176", "#b8860b", "#7b3294", "#4d4d4d", "#e66101", "#1f9ede",
];

/// A drawing under construction; sizes in pixels.
pub(super) struct Drawing {
    width: f64,
    height: f64,
    body: String,
}

/// A part of a drawing with axes of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plot {
    /// Left and top edge.
    pub(super) at: [f64; 2],
    /// Width and height.
    pub(super) size: [f64; 2],
    /// Range of x, left to right.
    pub(super) x: [f64; 2],
    /// Range of y, bottom to top.
    pub(super) y: [f64; 2],
}

impl Plot {
    /// Where a value is in the drawing.
    pub(super) fn place(&self, x: f64, y: f64) -> [f64; 2] {
        let share = |value: f64, [from, to]: [f64; 2]| (value - from) / (to - from);
        [
            self.at[0] + self.size[0] * share(x, self.x),
            self.at[1] + self.size[1] * (1.0 - share(y, self.y)),
        ]
    }
}

impl Drawing {
    /// An empty drawing.
    pub(super) fn new(width: f64, height: f64) -> Self {
        Self {
            width,
            height,
            body: String::new(),
        }
    }

    /// Adds raw markup.
    pub(super) fn add(&mut self, markup: &str) {
        self.body.push_str(markup);
        self.body.push('\n');
    }

    /// A line through points of a plot; what leaves the plot is cut by its clip.
    pub(super) fn line(&mut self, points: &[[f64; 2]], colour: &str, width: f64) {
        let points = path(points);
        self.add(&format!(
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" \
             stroke-width=\"{width}\" stroke-linejoin=\"round\"/>"
        ));
    }

    /// A filled shape.
    pub(super) fn fill(&mut self, points: &[[f64; 2]], colour: &str, opacity: f64) {
        let points = path(points);
        self.add(&format!(
            "<polygon points=\"{points}\" fill=\"{colour}\" fill-opacity=\"{opacity}\"/>"
        ));
    }

    /// A text; `anchor` is start, middle or end.
    pub(super) fn text(&mut self, at: [f64; 2], size: f64, anchor: &str, text: &str) {
        let text = escaped(text);
        self.add(&format!(
            "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\">{text}</text>",
            at[0], at[1]
        ));
    }

    /// Frame, ticks and names of the axes of a plot.
    pub(super) fn axes(&mut self, plot: &Plot, x_name: &str, y_name: &str) {
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
        for value in ticks(plot.y) {
            let [_, y] = plot.place(plot.x[0], value);
            self.line(&[[left - 4.0, y], [left, y]], "#333", 1.0);
            self.text([left - 7.0, y + 4.0], 11.0, "end", &label(value));
        }
        self.text([middle, bottom + 32.0], 12.0, "middle", x_name);
        let (x, y) = (left - 44.0, top + height / 2.0);
        self.add(&format!(
            "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" font-size=\"12\" \
             text-anchor=\"middle\">{}</text>",
            escaped(y_name)
        ));
    }

    /// The whole SVG document.
    pub(super) fn finish(self) -> String {
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

fn path(points: &[[f64; 2]]) -> String {
    points.iter().fold(String::new(), |mut text, [x, y]| {
        let _ = write!(text, "{x:.1},{y:.1} ");
        text
    })
}

/// Text safe inside markup.
pub(super) fn escaped(text: &str) -> String {
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
        assert_eq!(
            ticks([0.0, 100.0])
                .iter()
                .map(|tick| label(*tick))
                .collect::<Vec<_>>(),
            ["0", "20", "40", "60", "80", "100"]
        );
        assert!(
            ticks([380.0, 2100.0])
                .iter()
                .all(|tick| (380.0..=2100.0).contains(tick))
        );
    }

    #[test]
    fn a_plot_has_its_corners_where_they_belong() {
        let plot = Plot {
            at: [10.0, 20.0],
            size: [100.0, 50.0],
            x: [0.0, 2.0],
            y: [0.0, 1.0],
        };
        assert_eq!(
            plot.place(0.0, 0.0).map(f64::to_bits),
            [10.0, 70.0].map(f64::to_bits)
        );
        assert_eq!(
            plot.place(2.0, 1.0).map(f64::to_bits),
            [110.0, 20.0].map(f64::to_bits)
        );
    }
}
