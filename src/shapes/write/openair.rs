//! Shapes as OpenAir. A zone comes out no smaller: holes are filled, floors rounded down and ceilings
//! up to whole feet.

use super::Rewritten;
use crate::geodesy::LatLon;
use crate::shapes::heights::{FOOT_M, NAUTICAL_MILE_M};
use crate::shapes::{Geometry, Height, Shape};

/// Classes that a record begins with; any other shape is prohibited airspace.
const CLASSES: [&str; 13] = [
    "A", "B", "C", "D", "E", "F", "CTR", "GP", "P", "Q", "R", "RMZ", "TMZ",
];

/// The text of a file.
pub(super) fn write(shapes: &[Shape]) -> Rewritten {
    let mut rewritten = Rewritten::default();
    for shape in shapes {
        if let Some(record) = record(shape, &mut rewritten) {
            rewritten.text += &record;
        }
    }
    rewritten
}

fn record(shape: &Shape, rewritten: &mut Rewritten) -> Option<String> {
    if shape.keep_in {
        rewritten.leave_out(shape, "a zone to stay in: OpenAir has none");
        return None;
    }
    let class = shape
        .classes
        .iter()
        .find(|class| CLASSES.contains(&class.as_str()));
    let class = class.map_or("P", String::as_str);
    let mut record = format!("AC {class}\nAN {}\n", one_line(&shape.name));
    let is_below_sea = |of: &Height| matches!(of, Height::Amsl(metres) if *metres < 0.0);
    if shape.floor.iter().chain(&shape.ceiling).any(is_below_sea) {
        rewritten.enlarge(
            shape,
            "from the ground, or up to the sea: OpenAir has no heights below it",
        );
    }
    // Closed from the ground where it begins below the sea.
    let floor = shape.floor.filter(|floor| !is_below_sea(floor));
    let floor = floor.map_or("GND".to_owned(), |floor| limit(floor, f64::floor));
    let top = shape
        .ceiling
        .map_or("UNLIM".to_owned(), |top| limit(top, f64::ceil));
    record += &format!("AL {floor}\nAH {top}\n");
    if shape.active != (None, None) {
        rewritten.enlarge(
            shape,
            "always active: OpenAir as it is written here has no times",
        );
    }
    match &shape.geometry {
        Geometry::Circle { center, radius_m } => {
            let miles = (radius_m / NAUTICAL_MILE_M * 1e4).ceil() / 1e4;
            record += &format!("V X={}\nDC {miles}\n", place(center));
        }
        Geometry::Polygon { outer, holes } => {
            if !holes.is_empty() {
                rewritten.enlarge(shape, "without its holes: OpenAir has none");
            }
            for corner in outer {
                record += &format!("DP {}\n", place(corner));
            }
        }
        Geometry::Line(_) | Geometry::Point(_) => {
            rewritten.leave_out(shape, "a line or a place: OpenAir has areas");
            return None;
        }
    }
    Some(record + "\n")
}

fn limit(of: Height, round: fn(f64) -> f64) -> String {
    // What differs from a whole number by rounding alone is one.
    let whole = |value: f64| match (value - value.round()).abs() < 1e-6 {
        true => value.round(),
        false => round(value),
    };
    match of {
        Height::Amsl(metres) if metres < 0.0 => "0ft AMSL".to_owned(),
        Height::Amsl(metres) => format!("{}ft AMSL", whole(metres / FOOT_M)),
        Height::Agl(metres) => format!("{}ft AGL", whole(metres / FOOT_M)),
        Height::FlightLevel(level) => format!("FL{}", whole(level)),
    }
}

/// Degrees, and minutes to two centimetres.
fn place(at: &LatLon) -> String {
    let part = |degrees: f64, width: usize, signs: [char; 2]| {
        let units = (degrees.abs() * 60.0 * 1e5).round();
        let whole = (units / 6e6).trunc();
        let minutes = (units - whole * 6e6) / 1e5;
        let sign = signs[usize::from(degrees < 0.0)];
        format!("{whole:0width$}:{minutes:08.5} {sign}")
    };
    format!(
        "{} {}",
        part(at.lat_deg, 2, ['N', 'S']),
        part(at.lon_deg, 3, ['E', 'W'])
    )
}

fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}
