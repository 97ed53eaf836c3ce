//! `fleet.kml`: what flies where, for Google Earth and its kin (OGC KML 2.2).
//!
//! Altitudes are absolute, which KML defines as above the EGM96 sea level: our AMSL.

use std::fmt::Write;

use super::shape::{circle, ring};
use crate::geodesy::{Amsl, LatLon, PlanPoint};
use crate::path::TimedPoint;
use crate::spec::MissionSpec;
use crate::world::World;

/// Line colours of the vehicles in turn (`aabbggrr`), told apart by colour-blind eyes too.
const COLOURS: [&str; 6] = [
    "ffb27200", "ff009fe6", "ff739e00", "ffa779cc", "ff005ed5", "ffe9b456",
];

/// The fleet as KML text; `paths` are vehicle ids with their paths.
#[must_use]
pub fn write(spec: &MissionSpec, world: &World, paths: &[(&str, &[TimedPoint])]) -> String {
    let mut kml = Kml::default();
    kml.text
        .push_str("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    kml.open("kml xmlns=\"http://www.opengis.net/kml/2.2\"");
    kml.open("Document");
    kml.leaf("name", &spec.name);
    kml.styles();
    kml.open("Folder");
    kml.leaf("name", "Airspace");
    let ceiling = world.max_amsl;
    kml.polygon("area", "area", &ring(spec.area.outline()), None);
    for (threat, disc) in spec.threats.iter().zip(&world.threats) {
        let name = format!("{} ({})", threat.id, threat.kind);
        kml.polygon(&name, "threat", &circle(world, disc), Some(ceiling));
    }
    for zone in &spec.no_fly {
        let top = zone.below.unwrap_or(ceiling);
        kml.polygon(&zone.id, "zone", &ring(zone.polygon.clone()), Some(top));
    }
    kml.close("Folder");
    for (index, (vehicle, stations)) in spec.vehicles.iter().zip(&world.stations).enumerate() {
        kml.open("Folder");
        kml.leaf("name", &vehicle.id);
        for (_, path) in paths.iter().filter(|(id, _)| *id == vehicle.id) {
            kml.path(&vehicle.id, index % COLOURS.len(), world, path);
        }
        for (name, station) in [
            ("home", stations.home),
            ("start", stations.start),
            ("goal", stations.goal),
        ] {
            kml.point(&format!("{} {name}", vehicle.id), world, station);
        }
        kml.close("Folder");
    }
    kml.close("Document");
    kml.close("kml");
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
        let places: Vec<String> = ring
            .iter()
            .map(|&place| coordinates(place, top.unwrap_or(Amsl(0.0))))
            .collect();
        self.leaf("coordinates", &places.join(" "));
        self.close("LinearRing");
        self.close("outerBoundaryIs");
        self.close("Polygon");
        self.close("Placemark");
    }

    /// A path with a curtain down to the ground.
    fn path(&mut self, name: &str, colour: usize, world: &World, path: &[TimedPoint]) {
        self.start_placemark(&format!("{name} path"), Some(&format!("path-{colour}")));
        self.open("LineString");
        self.leaf("extrude", "1");
        self.leaf("altitudeMode", "absolute");
        let places: Vec<String> = path
            .iter()
            .map(|sample| coordinates(world.frame.from_plan(sample.point.at), sample.point.amsl))
            .collect();
        self.leaf("coordinates", &places.join(" "));
        self.close("LineString");
        self.close("Placemark");
    }

    fn point(&mut self, name: &str, world: &World, point: PlanPoint) {
        self.start_placemark(name, None);
        self.open("Point");
        self.leaf("altitudeMode", "absolute");
        let place = world.frame.from_plan(point.at);
        self.leaf("coordinates", &coordinates(place, point.amsl));
        self.close("Point");
        self.close("Placemark");
    }
}

/// Longitude comes first, no spaces within.
fn coordinates(place: LatLon, amsl: Amsl) -> String {
    format!("{:.7},{:.7},{:.2}", place.lon_deg, place.lat_deg, amsl.0)
}

/// Text without markup, and without characters that XML 1.0 has no way to write.
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
