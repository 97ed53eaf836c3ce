//! Zones of one format in another.

use std::fs;
use std::path::Path;

use serde::Serialize;

use crate::cli::args;
use crate::cli::folder::replace;
use crate::cli::print::console::{note, out, out_json};
use crate::cli::print::failure::Failure;
use crate::numeric::digits::count;
use crate::numeric::text::escaped;
use crate::shapes::{self, Format, Geometry, Refused, Shape, ShapesError};

/// The report of a conversion.
#[derive(Debug, Serialize)]
struct Report {
    input: String,
    output: String,
    shapes: usize,
    /// Shapes that forbid nothing.
    #[serde(rename = "open")]
    unrestricted: usize,
    /// Shapes whose corners have heights, which no format of zones keeps.
    without_heights: usize,
    refused: Vec<String>,
    /// Shapes that came out larger.
    #[serde(rename = "changed")]
    enlarged: Vec<String>,
}

/// The format of a file by its name.
fn format(path: &Path) -> Option<Format> {
    let ending = path.extension()?.to_str()?.to_lowercase();
    match ending.as_str() {
        "geojson" => Some(Format::GeoJson),
        "kml" => Some(Format::Kml),
        "txt" | "openair" => Some(Format::OpenAir),
        _ => None,
    }
}

/// Whether a file holds shapes, not a mission: by its name, and a `.txt` by its content.
pub(super) fn is_shapes(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    match ending.map(str::to_lowercase).as_deref() {
        Some("geojson" | "json" | "kml" | "kmz" | "openair") => true,
        Some("txt") => fs::read(path).is_ok_and(|bytes| {
            let lines = bytes.split(|byte| *byte == b'\n');
            lines.into_iter().any(|line| line.starts_with(b"AC "))
        }),
        _ => false,
    }
}

/// Writes the shapes of a file in another format; what is not read or not kept is reported, and an error where a zone is
/// lost.
pub(super) fn run(arguments: &args::Convert) -> Result<(), Failure> {
    let (input, output) = (&arguments.input, &arguments.output);
    let Some(format) = format(output) else {
        let message = format!(
            "{}: zones are written as .geojson, which keeps all of them, .kml or .txt (OpenAir)",
            output.display()
        );
        return Err(Failure::new(Failure::USAGE, message));
    };
    let bad = |what: String| Failure::new(Failure::INPUT, format!("{}: {what}", input.display()));
    let bytes = fs::read(input).map_err(|error| bad(error.to_string()))?;
    let collection = shapes::read(&input.to_string_lossy(), &bytes)
        .map_err(|error: ShapesError| bad(error.to_string()))?;
    let written = shapes::write_as(format, &collection.shapes);
    replace::write_file(output, written.text.as_bytes())?;
    let refused = collection.refused.iter().chain(&written.left_out);
    let enlarged = written.enlarged.iter();
    let report = Report {
        input: input.display().to_string(),
        output: output.display().to_string(),
        shapes: collection.shapes.len() - written.left_out.len(),
        unrestricted: collection.unrestricted,
        without_heights: collection.without_heights,
        refused: refused
            .map(|of| format!("{}: {}", escaped(&of.name), escaped(&of.why)))
            .collect(),
        enlarged: enlarged
            .map(|(name, how)| format!("{}: {how}", escaped(name)))
            .collect(),
    };
    if arguments.json {
        out_json(&report)?;
        return complete(&report);
    }
    for refused in &report.refused {
        note(&format!("refused: {refused}"));
    }
    for enlarged in &report.enlarged {
        note(&format!("larger: {enlarged}"));
    }
    if report.without_heights > 0 {
        note(&format!(
            "warning: {} of {} shapes: the heights of their corners are not kept (a zone has a floor and a ceiling, in KML an extruded polygon)",
            report.without_heights,
            collection.shapes.len()
        ));
    }
    out(&format!(
        "{}: {}; {} that forbid nothing, {} refused",
        report.output,
        counted(&collection.shapes, &written.left_out),
        report.unrestricted,
        report.refused.len()
    ))?;
    complete(&report)
}

/// The shapes that were written, by kind: only what encloses something is a zone.
fn counted(shapes: &[Shape], left_out: &[Refused]) -> String {
    let is_written = |shape: &&Shape| !left_out.iter().any(|of| of.name == shape.name);
    let mut kinds = [("polygon", 0), ("circle", 0), ("line", 0), ("point", 0)];
    for shape in shapes.iter().filter(is_written) {
        let kind = match shape.geometry {
            Geometry::Polygon { .. } => 0,
            Geometry::Circle { .. } => 1,
            Geometry::Line(_) => 2,
            Geometry::Point(_) => 3,
        };
        kinds[kind].1 += 1;
    }
    let total = kinds.iter().map(|(_, number)| number).sum();
    let kinds = kinds.iter().filter(|(_, number)| *number > 0);
    let kinds: Vec<String> = kinds.map(|(kind, number)| count(*number, kind)).collect();
    match kinds.is_empty() {
        true => count(total, "shape"),
        false => format!("{} ({})", count(total, "shape"), kinds.join(", ")),
    }
}

/// Fails if a zone is not in the output.
fn complete(report: &Report) -> Result<(), Failure> {
    let lost = match report.refused.len() {
        0 => return Ok(()),
        1 => "1 shape is".to_owned(),
        count => format!("{count} shapes are"),
    };
    let message = format!(
        "{lost} not in {}, which was written: zones of {} are lost",
        report.output, report.input
    );
    Err(Failure::new(Failure::INPUT, message))
}
