//! `sortie study fleet`.

use crate::cli::args;
use crate::cli::print::console::{out_json_text, out_text};
use crate::cli::print::failure::Failure;
use crate::cli::print::progress::Progress;
use crate::report::json_text;
use crate::study::{FleetError, FleetFolder};

pub(super) fn run(arguments: &args::FleetStudy) -> Result<(), Failure> {
    let folder = FleetFolder::new(arguments.out.as_deref(), Failure::VERDICT.number())?;
    let progress = Progress::start();
    let growth = folder.grow(
        &arguments.sizes,
        arguments.evaluations,
        arguments.compare_to,
        &|vehicles, evaluations| {
            progress.say(&format!(
                "{vehicles} vehicles, {evaluations} evaluations each"
            ));
        },
    )?;
    drop(progress);
    let (document, table) = (json_text(&growth), growth.table());
    folder.keep([("fleet.json", &document), ("fleet.md", &table)])?;
    if arguments.json {
        return out_json_text(&document);
    }
    out_text(&format!(
        "deliveries over the Cumberland Mountains, {} evaluations a plan, {} threads\n\n{}",
        growth.evaluations_a_plan,
        growth.threads,
        table.trim_end()
    ))
}

impl From<FleetError> for Failure {
    fn from(error: FleetError) -> Self {
        match error {
            FleetError::Store(error) => error.into(),
            FleetError::Ground(error) => error.into(),
            FleetError::Plan { .. } => Self::new(Self::OUTPUT, error.to_string()),
        }
    }
}
