//! The command line: arguments, progress, exit codes.

mod args;
mod check;
mod convert;
mod evaluate;
mod fly;
mod folder;
mod plan;
mod print;
mod replan;
mod review;
mod study;
mod terrain;
mod transfer;
mod usage;
mod vehicles;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use crate::cli::print::failure::Failure;
use args::{Arguments, Command};

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
        Command::Upload(arguments) => transfer::upload::run(arguments),
        Command::Fly(arguments) => fly::run(arguments),
        Command::Replan(arguments) => replan::run(arguments),
        Command::Download(arguments) => transfer::download::run(arguments),
        Command::Convert(arguments) => convert::run(arguments),
        Command::Vehicles(arguments) => vehicles::run(arguments),
        Command::Terrain(command) => terrain::run(command),
        Command::Evaluate(arguments) => evaluate::run(arguments),
        Command::Study(arguments) => study::run_study(arguments),
        Command::Schema => print::console::out(crate::spec::json_schema().trim_end()),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Arguments::command(), "sortie", &mut script);
            print::console::out(String::from_utf8_lossy(&script).trim_end())
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if !failure.message.is_empty() {
                print::console::note(&failure.message);
            }
            failure.code.into()
        }
    }
}
