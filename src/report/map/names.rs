//! Names on the map: all of vehicles, and those of obstacles that are free.

use std::fmt::Write as _;

use super::labels::{Anchor, Labels, Side};
use super::obstacle::{Area, Obstacle};
use super::{MAX_NAMES, PAPER, THREAT, View, WIDTH, ZONE, one};
use crate::numeric::geometry::{box_misses, closest_points, distance};
use crate::report::COLOURS;
use crate::report::scene::{Scene, VehicleShape};
use crate::report::words::escaped;

/// Size of names in the picture, and as the style of the page has them.
const NAME_SIZE: f64 = 15.0;
const PAGE_NAME_SIZE: f64 = 22.0;
/// With more obstacles than this, a name that is free nowhere is not written, else on a path.
const MAX_ON_PATHS: usize = 30;
/// Corners of the polygon that a circle is placed by.
const CIRCLE_CORNERS: u16 = 48;

/// The name of a threat or zone.
struct ObstacleName<'a> {
    /// Its index among the obstacles: threats first, then zones.
    index: usize,
    class: &'a str,
    colour: &'a str,
    name: &'a str,
    /// Between which heights it is closed.
    heights: &'a str,
    /// How near a flight comes to it, on the picture.
    approach: f64,
}

/// Places and writes the names; the scripts of the page do so again for its own size.
pub(super) fn write_names(svg: &mut String, view: &View, scene: &Scene, inline: bool) {
    let size = if inline { PAGE_NAME_SIZE } else { NAME_SIZE };
    let frame = Area {
        left: 4.0,
        top: 4.0,
        right: WIDTH - 4.0,
        bottom: view.height - 4.0,
    };
    let mut labels = Labels::new(frame, size);
    // The north arrow and the scale bar.
    labels.avoid((970.0, 38.0), 50.0);
    labels.leave_free(Area {
        left: 0.0,
        top: view.height - 50.0,
        right: 270.0,
        bottom: view.height,
    });
    if scene.vehicles.len() <= MAX_NAMES {
        for vehicle in &scene.vehicles {
            labels.pass(path(view, vehicle).into_iter());
            labels.avoid(view.at(&vehicle.start), size);
            labels.avoid(view.at(&vehicle.goal), size);
            for stop in &vehicle.stops {
                labels.avoid(view.at(&stop.at), size);
            }
        }
        for (index, vehicle) in scene.vehicles.iter().enumerate() {
            write_vehicle(svg, &mut labels, view, (index, vehicle));
        }
    }
    let obstacles = obstacles(view, scene);
    for name in obstacle_names(view, scene, &obstacles) {
        let forms = [name.name.to_owned() + name.heights, name.name.to_owned()];
        let forms = &forms[..if name.heights.is_empty() { 1 } else { 2 }];
        let on_paths = obstacles.len() <= MAX_ON_PATHS;
        let found = labels.place_free(&obstacles, name.index, forms, on_paths);
        // The scripts place it where there is space after a zoom.
        if found.is_some() || inline {
            write_obstacle(svg, &name, &obstacles[name.index], found);
        }
    }
}

fn path(view: &View, vehicle: &VehicleShape) -> Vec<(f64, f64)> {
    let track = &vehicle.track;
    let fixes = track.e.iter().zip(&track.n);
    fixes.map(|(e, n)| (view.x(*e), view.y(*n))).collect()
}

fn write_vehicle(
    svg: &mut String,
    labels: &mut Labels,
    view: &View,
    (index, vehicle): (usize, &VehicleShape),
) {
    let (start, goal) = (view.at(&vehicle.start), view.at(&vehicle.goal));
    // Away from the goal, so that the name does not lie on the path.
    let left = goal.0 > start.0 && start.0 > 190.0 || start.0 > WIDTH - 190.0;
    let (side, word) = if left {
        (Side::Left, "left")
    } else {
        (Side::Right, "right")
    };
    let anchor = labels.place(start, side, &vehicle.id);
    let attributes = format!("class=\"of-vehicle\" data-side=\"{word}\"");
    let colour = COLOURS[index % COLOURS.len()][0];
    write_text(svg, &attributes, (start, anchor), colour);
    svg.push_str(&escaped(&vehicle.id));
    svg.push_str("</text>");
}

fn write_obstacle(
    svg: &mut String,
    name: &ObstacleName<'_>,
    obstacle: &Obstacle,
    found: Option<(Anchor, usize)>,
) {
    let at = obstacle.middle();
    let (anchor, form) = found.unwrap_or((Anchor::full(at), 0));
    let hidden = if found.is_some() {
        ""
    } else {
        " visibility=\"hidden\""
    };
    let attributes = format!(
        "class=\"{}\" data-obstacle=\"{}\"{hidden}",
        name.class, name.index
    );
    write_text(svg, &attributes, (at, anchor), name.colour);
    svg.push_str(&escaped(name.name));
    if !name.heights.is_empty() {
        let hidden = if form == 0 { "" } else { " display=\"none\"" };
        let _ = write!(svg, "<tspan{hidden}>{}</tspan>", escaped(name.heights));
    }
    svg.push_str("</text>");
}

/// The opening tag of a name, with the point that it belongs to and where it stands.
fn write_text(
    svg: &mut String,
    attributes: &str,
    (at, anchor): ((f64, f64), Anchor),
    colour: &str,
) {
    let _ = write!(
        svg,
        "<text {attributes} data-at=\"{} {}\" x=\"{}\" y=\"{}\" dy=\".35em\" text-anchor=\"middle\" font-size=\"{}\" font-weight=\"600\" \
         fill=\"{colour}\" stroke=\"{PAPER}\" stroke-width=\"3.5\" stroke-linejoin=\"round\" paint-order=\"stroke\">",
        one(at.0),
        one(at.1),
        one(anchor.x),
        one(anchor.y),
        one(anchor.share * NAME_SIZE),
    );
}

/// The outlines of threats, then of zones, on the picture.
fn obstacles(view: &View, scene: &Scene) -> Vec<Obstacle> {
    let of_threats = scene.threats.iter().map(|threat| {
        let (x, y) = (view.x(threat.at[0]), view.y(threat.at[1]));
        let radius = threat.radius_m * view.scale;
        let corner = |index: u16| {
            let angle = std::f64::consts::TAU * f64::from(index) / f64::from(CIRCLE_CORNERS);
            (x + radius * angle.cos(), y + radius * angle.sin())
        };
        (0..=CIRCLE_CORNERS).map(corner).collect()
    });
    let of_zones = scene.zones.iter().map(|zone| {
        let corners = zone.ring.iter();
        corners.map(|[e, n]| (view.x(*e), view.y(*n))).collect()
    });
    of_threats.chain(of_zones).map(Obstacle::new).collect()
}

/// Names of obstacles in the order in which they are placed: the nearest to a flight first.
fn obstacle_names<'a>(
    view: &View,
    scene: &'a Scene,
    obstacles: &[Obstacle],
) -> Vec<ObstacleName<'a>> {
    let of_threats = scene.threats.iter().enumerate().map(|(index, threat)| {
        let name = threat.id.as_str();
        (index, "of-threat", THREAT, name, "")
    });
    let zones = scene.zones.iter().enumerate();
    let of_zones = zones.filter_map(|(index, zone)| {
        let (index, name) = (scene.threats.len() + index, zone.name.as_deref()?);
        Some((index, "of-zone", ZONE, name, zone.heights.as_str()))
    });
    let paths: Vec<_> = scene.vehicles.iter().map(|of| path(view, of)).collect();
    let names = of_threats.chain(of_zones);
    let mut names: Vec<ObstacleName<'_>> = names
        .map(|(index, class, colour, name, heights)| ObstacleName {
            index,
            class,
            colour,
            name,
            heights,
            approach: approach(&obstacles[index], &paths),
        })
        .collect();
    names.sort_by(|a, b| a.approach.total_cmp(&b.approach));
    names
}

/// The smallest distance from paths to an obstacle; 0 of one that a path crosses.
fn approach(obstacle: &Obstacle, paths: &[Vec<(f64, f64)>]) -> f64 {
    let Area {
        left,
        top,
        right,
        bottom,
    } = obstacle.area;
    let mut nearest = f64::INFINITY;
    for leg in paths.iter().flat_map(|path| path.windows(2)) {
        let leg = ([leg[0].0, leg[0].1], [leg[1].0, leg[1].1]);
        if obstacle.holds((leg.0[0], leg.0[1])) {
            return 0.0;
        }
        let low = [left - nearest, top - nearest];
        if box_misses((low, [right + nearest, bottom + nearest]), leg) {
            continue;
        }
        for edge in obstacle.ring.windows(2) {
            let edge = ([edge[0].0, edge[0].1], [edge[1].0, edge[1].1]);
            let (on_leg, on_edge) = closest_points(leg, edge);
            nearest = nearest.min(distance(on_leg, on_edge));
        }
    }
    nearest
}
