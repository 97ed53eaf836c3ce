//! The command line: arguments, progress, exit codes.

mod args;
mod bare;
mod check;
mod console;
mod convert;
mod convert_changes;
mod delivery;
mod download;
mod evaluate;
mod failure;
mod fly;
mod folder;
mod output;
mod overview;
mod plan;
mod progress;
mod replan;
mod review;
mod review_flight;
mod runs;
mod study;
mod study_fleet;
mod table;
mod terrain;
mod terrain_export;
mod terrain_fetch;
mod terrain_transfer;
mod upload;
mod usage;
mod vehicles;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use args::{Arguments, Command};
use failure::Failure;

/// Runs one command and returns its exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let parsed = match Arguments::try_parse_from(arguments) {
        Ok(parsed) => parsed,
        Err(error) => {
            // Help and version go to stdout and are no failure.
            let _ = error.print();
            return if error.use_stderr() {
                Failure::USAGE.into()
            } else {
                ExitCode::SUCCESS
            };
        }
    };
    let done = match &parsed.command {
        Command::Plan(arguments) => plan::run(arguments),
        Command::Check(arguments) => check::run(arguments),
        Command::Review(arguments) => review::run(arguments),
        Command::Upload(arguments) => upload::run(arguments),
        Command::Fly(arguments) => fly::run(arguments),
        Command::Replan(arguments) => replan::run(arguments),
        Command::Download(arguments) => download::run(arguments),
        Command::Convert(arguments) => convert::run(arguments),
        Command::Vehicles(arguments) => vehicles::run(arguments),
        Command::Terrain(command) => terrain::run(command),
        Command::Evaluate(arguments) => evaluate::run(arguments),
        Command::Study(arguments) => study::run_study(arguments),
        Command::Schema => console::out(crate::spec::json_schema().trim_end()),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Arguments::command(), "sortie", &mut script);
            console::out(String::from_utf8_lossy(&script).trim_end())
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if !failure.message.is_empty() {
                console::note(&failure.message);
            }
            failure.code.into()
        }
    }
}
