//! The plan view: a picture of its own, and the map of the page.
//!
//! Every shape carries plain attributes, so that it looks right anywhere, and
//! a class, so that the page can adapt it to light, dark and zoom.

mod contour;
mod labels;
mod legend;
mod names;
mod obstacle;

use std::fmt::Write as _;

use crate::report::scene::{Bounds, Scene, VehicleShape, round_step};
use crate::report::words::{self, escaped};
use crate::report::{COLOURS, ReviewInput};
use contour::{Contours, Line};
use names::write_names;

/// Width of the map in units of its own.
const WIDTH: f64 = 1000.0;
/// With more vehicles than this, names would hide the paths.
const MAX_NAMES: usize = 40;

const PAPER: &str = "#eef0ea";
const INK: &str = "#27313a";
const THREAT: &str = "#b3261e";
const ZONE: &str = "#6a3d9a";

/// From planning coordinates to the picture.
struct View {
    bounds: Bounds,
    scale: f64,
    height: f64,
}

/// A picture of the whole review for a document: SVG that needs nothing else.
#[must_use]
pub fn review_svg(input: &ReviewInput<'_>) -> String {
    let scene = Scene::new(input);
    let view = View::new(scene.bounds);
    let (top, bottom) = (84.0, legend::height(&scene.vehicles) + 24.0);
    let passes = input.review.passes();
    let (word, colour) = if passes {
        ("PASS", "#17703f")
    } else {
        ("FAIL", THREAT)
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-20 0 {} {}\" \
         font-family=\"system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif\">\
         <rect x=\"-20\" width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\
         <text x=\"0\" y=\"36\" font-size=\"26\" font-weight=\"600\" fill=\"{INK}\">{}</text>\
         <text x=\"0\" y=\"64\" font-size=\"16\" fill=\"{INK}\"><tspan font-weight=\"700\" fill=\"{colour}\">{word}</tspan>\u{2002}{}</text>\
         <g transform=\"translate(0 {top})\">",
        one(WIDTH + 40.0),
        one(top + view.height + bottom),
        escaped(&input.spec.name),
        escaped(&words::headline(input.review)),
    );
    svg.push_str(&plan_view(input, &scene, false));
    svg.push_str("</g>");
    let _ = write!(
        svg,
        "<g transform=\"translate(0 {})\">",
        one(top + view.height + 34.0)
    );
    svg.push_str(&legend::legend(&scene.vehicles));
    svg.push_str("</g></svg>\n");
    svg
}

/// The map alone: the root of a picture, or inline in a page.
pub(in crate::report) fn plan_view(input: &ReviewInput<'_>, scene: &Scene, inline: bool) -> String {
    let view = View::new(scene.bounds);
    let contours = Contours::new(&scene.relief, &scene.bounds);
    let label = format!("Plan view of {}", input.spec.name);
    let mut svg = format!(
        "<svg {}viewBox=\"0 0 {WIDTH} {}\" {}role=\"img\" aria-label=\"{}\">",
        if inline {
            "id=\"plan\" class=\"plan\" "
        } else {
            ""
        },
        one(view.height),
        if inline {
            String::new()
        } else {
            format!("width=\"{WIDTH}\" height=\"{}\" ", one(view.height))
        },
        escaped(&label),
    );
    svg.push_str(
        "<defs><pattern id=\"hatch\" width=\"7\" height=\"7\" patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\">\
         <path class=\"hatch\" d=\"M0 0V7\" stroke=\"#6a3d9a\" stroke-width=\"2.4\" stroke-opacity=\".45\"/></pattern></defs>",
    );
    ground(&mut svg, &view, scene, &contours);
    obstacles(&mut svg, &view, scene);
    let names = scene.vehicles.len() <= MAX_NAMES;
    for (index, vehicle) in scene.vehicles.iter().enumerate() {
        flight(&mut svg, &view, index, vehicle, names);
    }
    for (index, vehicle) in scene.vehicles.iter().enumerate().filter(|_| names) {
        stations(&mut svg, &view, index, vehicle);
        stops(&mut svg, &view, index, vehicle);
    }
    write_names(&mut svg, &view, scene, inline);
    if inline {
        svg.push_str("<g id=\"moving\"></g>");
    }
    furniture(&mut svg, &view, &contours);
    svg.push_str("</svg>");
    svg
}

impl View {
    fn new(bounds: Bounds) -> Self {
        let scale = WIDTH / bounds.width_m().max(1.0);
        Self {
            bounds,
            scale,
            height: bounds.height_m() * scale,
        }
    }

    fn x(&self, east_m: f64) -> f64 {
        (east_m - self.bounds.west) * self.scale
    }

    fn y(&self, north_m: f64) -> f64 {
        (self.bounds.north - north_m) * self.scale
    }

    /// The place of a station.
    fn at(&self, point: &[f64; 3]) -> (f64, f64) {
        (self.x(point[0]), self.y(point[1]))
    }

    /// SVG path data through points, each step relative to the last in tenths.
    fn path(&self, points: impl Iterator<Item = (f64, f64)>) -> String {
        let mut data = String::new();
        let mut last = (0.0, 0.0);
        for (number, (east_m, north_m)) in points.enumerate() {
            let at = (tenth(self.x(east_m)), tenth(self.y(north_m)));
            let (dx, dy) = (one(at.0 - last.0), one(at.1 - last.1));
            let gap = if dy.starts_with('-') { "" } else { " " };
            let letter = match number {
                0 => "M",
                1 => "l",
                _ if dx.starts_with('-') => "",
                _ => " ",
            };
            let _ = write!(data, "{letter}{dx}{gap}{dy}");
            last = at;
        }
        data
    }

    fn ring(&self, ring: &[[f64; 2]]) -> String {
        self.path(ring.iter().map(|[east_m, north_m]| (*east_m, *north_m))) + "z"
    }
}

fn ground(svg: &mut String, view: &View, scene: &Scene, contours: &Contours) {
    let height = one(view.height);
    let _ = write!(
        svg,
        "<rect class=\"paper\" width=\"{WIDTH}\" height=\"{height}\" fill=\"{PAPER}\"/>\
         <image width=\"{WIDTH}\" height=\"{height}\" preserveAspectRatio=\"none\" href=\"{}\"/>",
        scene.relief.shading(&scene.bounds)
    );
    for (class, width, opacity, lines) in [
        ("contour", ".7", ".16", &contours.plain),
        ("contour", "1.2", ".26", &contours.index),
    ] {
        let data: String = lines
            .iter()
            .map(|line: &Line| view.path(line.iter().map(|at| (at.east_m, at.north_m))))
            .collect();
        let _ = write!(
            svg,
            "<path class=\"{class}\" d=\"{data}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"{width}\" stroke-opacity=\"{opacity}\"/>"
        );
    }
    let _ = write!(
        svg,
        "<path class=\"area\" d=\"{}\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"1.4\" stroke-dasharray=\"2 5\" stroke-linecap=\"round\"/>",
        view.ring(&scene.area)
    );
}

/// Areas that tasks cover, zones, threats, violations and rally points.
fn obstacles(svg: &mut String, view: &View, scene: &Scene) {
    for (id, outline) in &scene.covered {
        let _ = write!(
            svg,
            "<path class=\"covered\" d=\"{}\" fill=\"{INK}\" fill-opacity=\".05\" stroke=\"{INK}\" stroke-width=\"1.5\" stroke-dasharray=\"6 3\"><title>{}</title></path>",
            view.ring(outline),
            escaped(id),
        );
    }
    for zone in &scene.zones {
        let data = view.ring(&zone.ring);
        let _ = write!(
            svg,
            "<path class=\"zone\" d=\"{data}\" fill=\"url(#hatch)\" stroke=\"{ZONE}\" stroke-width=\"1.5\"><title>{}{}</title></path>",
            escaped(zone.name.as_ref().unwrap_or(&zone.id)),
            escaped(&zone.heights),
        );
    }
    for threat in &scene.threats {
        let _ = write!(
            svg,
            "<circle class=\"threat\" cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{THREAT}\" fill-opacity=\".15\" stroke=\"{THREAT}\" stroke-width=\"1.5\"><title>{}</title></circle>",
            one(view.x(threat.at[0])),
            one(view.y(threat.at[1])),
            one(threat.radius_m * view.scale),
            escaped(&threat.id),
        );
    }
    for (at, what) in &scene.violations {
        let _ = write!(
            svg,
            "<path class=\"violation\" d=\"M{} {}l14 14m0-14l-14 14\" fill=\"none\" stroke=\"{THREAT}\" stroke-width=\"3.5\" stroke-linecap=\"round\"><title>{}</title></path>",
            one(view.x(at[0]) - 7.0),
            one(view.y(at[1]) - 7.0),
            escaped(what),
        );
    }
    for [east_m, north_m] in &scene.rally {
        let _ = write!(
            svg,
            "<path class=\"rally\" d=\"M{} {}l6 10h-12z\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"1.5\"/>",
            one(view.x(*east_m)),
            one(view.y(*north_m) - 6.0),
        );
    }
}

fn flight(svg: &mut String, view: &View, index: usize, vehicle: &VehicleShape, cased: bool) {
    let (class, colour) = (index % COLOURS.len(), COLOURS[index % COLOURS.len()][0]);
    let track = &vehicle.track;
    let data = view.path(track.e.iter().zip(&track.n).map(|(e, n)| (*e, *n)));
    let _ = write!(svg, "<g class=\"flight\" data-vehicle=\"{index}\">");
    if cased {
        let _ = write!(
            svg,
            "<path class=\"casing\" d=\"{data}\" fill=\"none\" stroke=\"{PAPER}\" stroke-opacity=\".75\" stroke-width=\"5\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>"
        );
    }
    for planned in vehicle.flown.iter().flat_map(|flown| &flown.planned) {
        let planned = view.path(
            planned
                .iter()
                .map(|[east_m, north_m, _]| (*east_m, *north_m)),
        );
        let _ = write!(
            svg,
            "<path class=\"planned v{class}\" d=\"{planned}\" fill=\"none\" stroke=\"{colour}\" stroke-opacity=\".35\" stroke-width=\"8\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>"
        );
    }
    let _ = write!(
        svg,
        "<path class=\"track v{class}\" d=\"{data}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2.6\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>"
    );
    if !vehicle.waypoints.is_empty() {
        // Dots are strokes without length: they keep their size when zoomed.
        let mut dots = String::new();
        for (east_m, north_m, ..) in &vehicle.waypoints {
            let _ = write!(
                dots,
                "M{} {}h0",
                one(view.x(*east_m)),
                one(view.y(*north_m))
            );
        }
        for (class, colour, width) in [("dots v", colour, "6.4"), ("pips v", PAPER, "3")] {
            let _ = write!(
                svg,
                "<path class=\"{class}{}\" d=\"{dots}\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>",
                index % COLOURS.len()
            );
        }
    }
    svg.push_str("</g>");
}

/// Start (disc), goal (ring), and home (square) where it is apart.
fn stations(svg: &mut String, view: &View, index: usize, vehicle: &VehicleShape) {
    let (class, colour) = (index % COLOURS.len(), COLOURS[index % COLOURS.len()][0]);
    let (start, goal) = (view.at(&vehicle.start), view.at(&vehicle.goal));
    let home = view.at(&vehicle.home);
    let mut dot = |(x, y): (f64, f64), name: &str, colour: &str, width: &str, cap: &str| {
        let _ = write!(
            svg,
            "<path class=\"{name} v{class}\" d=\"M{} {}h0\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"{cap}\"/>",
            one(x),
            one(y)
        );
    };
    if (home.0 - start.0).hypot(home.1 - start.1) > 4.0 {
        dot(home, "home", colour, "10", "square");
    }
    dot(start, "start", colour, "13", "round");
    dot(goal, "goal", colour, "15", "round");
    dot(goal, "goal-eye", PAPER, "8", "round");
}

/// Stops (hollow squares), each with what is done there as its title.
fn stops(svg: &mut String, view: &View, index: usize, vehicle: &VehicleShape) {
    let (class, colour) = (index % COLOURS.len(), COLOURS[index % COLOURS.len()][0]);
    for stop in &vehicle.stops {
        let (x, y) = view.at(&stop.at);
        let (at, title) = (
            format!("M{} {}h0", one(x), one(y)),
            escaped(&format!("{}: {}", vehicle.id, stop.text)),
        );
        for (name, colour, width) in [("stop", colour, "11"), ("stop-eye", PAPER, "6")] {
            let _ = write!(
                svg,
                "<path class=\"{name} v{class}\" d=\"{at}\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linecap=\"square\"><title>{title}</title></path>"
            );
        }
    }
}

/// Scale bar and north arrow; the page moves them when it zooms.
fn furniture(svg: &mut String, view: &View, contours: &Contours) {
    let bar_m = round_step(0.11 * view.bounds.width_m());
    let bar = bar_m * view.scale;
    let text = if bar_m >= 1000.0 {
        format!("{} km", words::number(bar_m / 1000.0, 1))
    } else {
        format!("{} m", words::number(bar_m, 1))
    };
    let spacing = if contours.interval_m > 0.0 {
        format!("contours every {} m", words::number(contours.interval_m, 1))
    } else {
        String::new()
    };
    let bottom = one(view.height - 22.0);
    let _ = write!(
        svg,
        "<g id=\"furniture\" fill=\"{INK}\" font-size=\"14\">\
         <path id=\"bar\" class=\"ink\" d=\"M22 {bottom}v6h{}v-6\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"2\"/>\
         <text x=\"22\" y=\"{}\" class=\"small\" stroke=\"{PAPER}\" stroke-width=\"3\" paint-order=\"stroke\"><tspan id=\"bar-text\">{text}</tspan><tspan id=\"interval\" dx=\"1em\">{spacing}</tspan></text>\
         <path class=\"ink-fill\" d=\"M970 16l9 26-9-6-9 6z\"/>\
         <text x=\"970\" y=\"60\" class=\"small\" text-anchor=\"middle\" font-weight=\"700\" stroke=\"{PAPER}\" stroke-width=\"3\" paint-order=\"stroke\">N</text></g>",
        one(bar),
        one(view.height - 32.0),
    );
}

fn tenth(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

/// Coordinates are clamped to this: nothing farther out is visible.
const MAX_COORDINATE: f64 = 1e6;

/// A number with one decimal at most, and no sign on a zero.
fn one(value: f64) -> String {
    let value = tenth(value.clamp(-MAX_COORDINATE, MAX_COORDINATE)) + 0.0;
    format!("{value}")
}
