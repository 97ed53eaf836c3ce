//! Zones of one format in another.

use std::fs;
use std::path::Path;

use serde::Serialize;

use crate::cli::args;
use crate::cli::folder::replace;
use crate::cli::print::console::{note, out, out_json};
use crate::cli::print::failure::Failure;
use crate::numeric::text::escaped;
use crate::shapes::{self, ShapesError};

/// The report of a conversion.
#[derive(Debug, Serialize)]
struct Report {
    input: String,
    output: String,
    shapes: usize,
    open: usize,
    refused: Vec<String>,
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

/// Writes the shapes of a file as GeoJSON; shapes that cannot be read are reported.
pub(super) fn run(arguments: &args::Convert) -> Result<(), Failure> {
    let (input, output) = (&arguments.input, &arguments.output);
    if output.extension().is_none_or(|ending| ending != "geojson") {
        let message = format!(
            "{}: zones are written as .geojson, which keeps all their heights",
            output.display()
        );
        return Err(Failure::new(Failure::USAGE, message));
    }
    let bad = |what: String| Failure::new(Failure::INPUT, format!("{}: {what}", input.display()));
    let bytes = fs::read(input).map_err(|error| bad(error.to_string()))?;
    let collection = shapes::read(&input.to_string_lossy(), &bytes)
        .map_err(|error: ShapesError| bad(error.to_string()))?;
    replace::write_file(output, shapes::write(&collection.shapes).as_bytes())?;
    let refused = collection.refused.iter();
    let report = Report {
        input: input.display().to_string(),
        output: output.display().to_string(),
        shapes: collection.shapes.len(),
        open: collection.open,
        refused: refused
            .map(|of| format!("{}: {}", escaped(&of.name), escaped(&of.why)))
            .collect(),
    };
    if arguments.json {
        return out_json(&report);
    }
    for refused in &report.refused {
        note(&format!("refused: {refused}"));
    }
    out(&format!(
        "{}: {} shapes; {} that forbid nothing, {} refused",
        report.output,
        report.shapes,
        report.open,
        report.refused.len()
    ))
}
