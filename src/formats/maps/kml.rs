//! `fleet.kml` for Google Earth and similar programs (OGC KML 2.2).
//!
//! Altitudes are absolute, which KML defines as above the EGM96 sea level: our AMSL.

use std::fmt::Write;

use super::drawing::{Drawing, DrawnItem, MapPoint};
use super::outline::{circle, ring};
use crate::geodesy::{Amsl, LatLon};
use crate::path::TimedPoint;
use crate::spec::{MissionSpec, Placement, StopAction};
use crate::world::World;

/// Line colours of the vehicles in turn (`aabbggrr`), distinct for colour-blind eyes too.
const COLOURS: [&str; 6] = [
    "ffb27200", "ff009fe6", "ff739e00", "ffa779cc", "ff005ed5", "ffe9b456",
];

/// The fleet as KML text; `paths` are vehicle ids with their paths, planned from `seed`.
#[must_use]
pub fn write(
    spec: &MissionSpec,
    world: &World,
    paths: &[(&str, &[TimedPoint])],
    seed: u64,
) -> String {
    let mut kml = Kml::default();
    kml.begin(&spec.name);
    kml.open("Folder");
    kml.leaf("name", "Airspace");
    kml.leaf("description", &format!("seed {seed}"));
    let ceiling = spec.area.max_amsl;
    kml.polygon("area", "area", &ring(spec.area.outline()), None);
    for threat in &spec.threats {
        let name = format!("{} ({})", threat.id, threat.kind);
        kml.polygon(&name, "threat", &circle(world, threat), Some(ceiling));
    }
    for zone in &spec.no_fly {
        // KML has one reference for all corners: a ceiling above ground is drawn as none.
        let top = match zone.ceiling {
            Some(Placement::Amsl(top)) => top,
            _ => ceiling,
        };
        kml.polygon(&zone.id, "zone", &ring(zone.outline()), Some(top));
    }
    kml.close("Folder");
    for (index, (vehicle, sites)) in spec.vehicles.iter().zip(&world.sites).enumerate() {
        kml.open("Folder");
        kml.leaf("name", &vehicle.id);
        for (_, path) in paths.iter().filter(|(id, _)| *id == vehicle.id) {
            kml.path(&vehicle.id, index % COLOURS.len(), world, path);
        }
        for (name, site) in [
            ("home", sites.home),
            ("start", sites.start),
            ("goal", sites.goal),
        ] {
            let point = MapPoint::of(world, site);
            kml.placemark(&format!("{} {name}", vehicle.id), point);
        }
        for (stop, site) in vehicle.stops.iter().zip(&sites.stops) {
            let point = MapPoint::of(world, *site);
            let actions: Vec<&str> = stop.actions.iter().map(StopAction::key).collect();
            let done = match actions.is_empty() {
                true => String::new(),
                false => format!(" ({})", actions.join(", ")),
            };
            kml.placemark(&format!("{} stop {}{done}", vehicle.id, stop.id), point);
        }
        kml.close("Folder");
    }
    kml.end();
    kml.text
}

/// One mission as KML text: items, the route between them, fence and rally points.
///
/// Points of unknown altitude lie on the ground; one of them puts the whole route there.
#[must_use]
pub fn write_mission(name: &str, drawing: &Drawing<'_>) -> String {
    let mut kml = Kml::default();
    kml.begin(name);
    kml.open("Folder");
    kml.leaf("name", "Fence and rally points");
    for outline in &drawing.outlines {
        let style = if outline.inclusion { "area" } else { "zone" };
        kml.polygon(&outline.name, style, &outline.ring, None);
    }
    for (what, points) in [("fence", &drawing.returns), ("rally", &drawing.rally)] {
        for point in points {
            kml.item(&format!("{what} {}", point.name()), point);
        }
    }
    kml.close("Folder");
    kml.open("Folder");
    kml.leaf("name", "Mission");
    kml.line_string("route", 0, &drawing.route());
    if let Some(home) = drawing.home {
        kml.placemark("home", home);
    }
    for item in &drawing.items {
        kml.item(&item.name(), item);
    }
    kml.close("Folder");
    kml.end();
    kml.text
}

/// Indented XML.
#[derive(Default)]
struct Kml {
    text: String,
    depth: usize,
}

impl Kml {
    fn line(&mut self, content: &str) {
        let indent = 2 * self.depth;
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{:indent$}{content}", "");
    }

    fn begin(&mut self, name: &str) {
        self.line("<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
        self.open("kml xmlns=\"http://www.opengis.net/kml/2.2\"");
        self.open("Document");
        self.leaf("name", name);
        self.styles();
    }

    fn end(&mut self) {
        self.close("Document");
        self.close("kml");
    }

    /// Opens an element; attributes may follow the name.
    fn open(&mut self, element: &str) {
        self.line(&format!("<{element}>"));
        self.depth += 1;
    }

    fn close(&mut self, element: &str) {
        self.depth -= 1;
        self.line(&format!("</{element}>"));
    }

    fn leaf(&mut self, element: &str, text: &str) {
        self.line(&format!("<{element}>{}</{element}>", escaped(text)));
    }

    fn styles(&mut self) {
        for (id, line, fill) in [
            ("area", "ff808080", None),
            ("threat", "ff0000c0", Some("400000ff")),
            ("zone", "ff0070ff", Some("400090ff")),
        ] {
            self.style(id, line, fill);
        }
        for (index, colour) in COLOURS.iter().enumerate() {
            let curtain = format!("40{}", &colour[2..]);
            self.style(&format!("path-{index}"), colour, Some(&curtain));
        }
    }

    fn style(&mut self, id: &str, line: &str, fill: Option<&str>) {
        self.open(&format!("Style id=\"{id}\""));
        self.line(&format!(
            "<LineStyle><color>{line}</color><width>3</width></LineStyle>"
        ));
        self.line(&match fill {
            Some(fill) => format!("<PolyStyle><color>{fill}</color></PolyStyle>"),
            None => "<PolyStyle><fill>0</fill></PolyStyle>".to_owned(),
        });
        self.close("Style");
    }

    fn start_placemark(&mut self, name: &str, style: Option<&str>) {
        self.open("Placemark");
        self.leaf("name", name);
        if let Some(style) = style {
            self.leaf("styleUrl", &format!("#{style}"));
        }
    }

    /// An outline on the ground, or a body from the ground to its top.
    fn polygon(&mut self, name: &str, style: &str, ring: &[LatLon], top: Option<Amsl>) {
        self.start_placemark(name, Some(style));
        self.open("Polygon");
        if top.is_some() {
            self.leaf("extrude", "1");
            self.leaf("altitudeMode", "absolute");
        } else {
            self.leaf("altitudeMode", "clampToGround");
        }
        self.open("outerBoundaryIs");
        self.open("LinearRing");
        let tuples: Vec<String> = ring
            .iter()
            .map(|&place| coordinates(place, top.unwrap_or(Amsl(0.0))))
            .collect();
        self.leaf("coordinates", &tuples.join(" "));
        self.close("LinearRing");
        self.close("outerBoundaryIs");
        self.close("Polygon");
        self.close("Placemark");
    }

    /// A path with a curtain down to the ground.
    fn path(&mut self, name: &str, colour: usize, world: &World, path: &[TimedPoint]) {
        let points = path.iter().map(|sample| MapPoint::of(world, sample.point));
        self.line_string(&format!("{name} path"), colour, &points.collect::<Vec<_>>());
    }

    /// A line of at least two points, with a curtain down to the ground if altitudes are known.
    fn line_string(&mut self, name: &str, colour: usize, points: &[MapPoint]) {
        let [first, _, ..] = points else { return };
        self.start_placemark(name, Some(&format!("path-{colour}")));
        self.open("LineString");
        if first.amsl.is_some() {
            self.leaf("extrude", "1");
        }
        self.leaf("altitudeMode", altitude_mode(*first));
        let tuples: Vec<String> = points.iter().map(|point| coordinates_of(*point)).collect();
        self.leaf("coordinates", &tuples.join(" "));
        self.close("LineString");
        self.close("Placemark");
    }

    fn placemark(&mut self, name: &str, point: MapPoint) {
        self.start_placemark(name, None);
        self.point(point);
        self.close("Placemark");
    }

    fn point(&mut self, point: MapPoint) {
        self.open("Point");
        self.leaf("altitudeMode", altitude_mode(point));
        self.leaf("coordinates", &coordinates_of(point));
        self.close("Point");
    }

    /// An item with its fields as description; nothing if it has no place.
    fn item(&mut self, name: &str, drawn: &DrawnItem<'_>) {
        let Some(point) = drawn.point else { return };
        let item = drawn.item;
        self.start_placemark(name, None);
        let [a, b, c, d] = item.params;
        self.leaf(
            "description",
            &format!(
                "command {}, frame {}, parameters {a} {b} {c} {d}, altitude {} m",
                item.command, item.frame, item.z
            ),
        );
        self.point(point);
        self.close("Placemark");
    }
}

fn altitude_mode(point: MapPoint) -> &'static str {
    match point.amsl {
        Some(_) => "absolute",
        None => "clampToGround",
    }
}

fn coordinates_of(point: MapPoint) -> String {
    coordinates(point.place, point.amsl.unwrap_or(Amsl(0.0)))
}

/// KML puts the longitude first and allows no spaces within a tuple.
fn coordinates(place: LatLon, amsl: Amsl) -> String {
    format!("{:.7},{:.7},{:.2}", place.lon_deg, place.lat_deg, amsl.0)
}

/// Text without markup, and without the characters that XML 1.0 cannot hold.
fn escaped(text: &str) -> String {
    text.chars()
        .filter(|&c| c >= ' ' || matches!(c, '\t' | '\n'))
        .filter(|&c| c != '\u{fffe}' && c != '\u{ffff}')
        .fold(String::with_capacity(text.len()), |mut safe, c| {
            match c {
                '&' => safe.push_str("&amp;"),
                '<' => safe.push_str("&lt;"),
                '>' => safe.push_str("&gt;"),
                '"' => safe.push_str("&quot;"),
                _ => safe.push(c),
            }
            safe
        })
}
