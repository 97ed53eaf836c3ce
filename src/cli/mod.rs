//! The command line: arguments, progress, exit codes.

mod args;
mod check;
mod convert;
mod costs;
mod fly;
mod folder;
mod links;
mod man;
mod migrate;
mod new;
mod plan;
mod print;
mod replan;
mod review;
mod schema;
mod study;
mod terrain;
mod transfer;
mod usage;
mod vehicles;
mod watch;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches};

use args::{Arguments, Command};
use print::console::{has_document, note, note_lines, out_json, out_text};
use print::failure::Failure;

/// The arguments of a command line. Every option takes a negative number as its value, so that its
/// own message says what is allowed.
fn parsed(arguments: impl IntoIterator<Item = OsString>) -> Result<Arguments, clap::Error> {
    fn with_negative_numbers(command: clap::Command) -> clap::Command {
        let takes_value = |arg: &clap::Arg| !arg.is_positional() && arg.get_action().takes_values();
        command
            .mut_args(|arg| match takes_value(&arg) {
                true => arg.allow_negative_numbers(true),
                false => arg,
            })
            .mut_subcommands(with_negative_numbers)
    }
    let mut command = with_negative_numbers(Arguments::command());
    let matches = command.try_get_matches_from_mut(arguments)?;
    Arguments::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
}

/// Runs one command and returns its exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let wants_json = arguments.iter().any(|argument| argument == "--json");
    let parsed = match parsed(arguments) {
        Ok(parsed) => parsed,
        Err(error) => {
            if error.use_stderr() {
                // Without colours, as the text quotes arguments.
                let text = error.render().to_string();
                if wants_json {
                    let problem = text.split("\n\n").next().unwrap_or_default();
                    let words: Vec<&str> = problem.split_whitespace().collect();
                    let _ = out_json(&Failure::new(Failure::USAGE, words.join(" ")).document());
                }
                note_lines(&text.lines().collect::<Vec<_>>());
                if let Some(next) = args::next_step(error.kind(), &text) {
                    note(next);
                }
                return Failure::USAGE.into();
            }
            // Help and version go to stdout.
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
    };
    match execute(&parsed.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if parsed.command.prints_json() && !has_document() {
                // Where that cannot be written, the lines say it all.
                let _ = out_json(&failure.document());
            }
            if !failure.message.is_empty() {
                note(&failure.message);
            }
            note_lines(&failure.more);
            failure.code.into()
        }
    }
}

fn execute(command: &Command) -> Result<(), Failure> {
    match command {
        Command::Plan(arguments) => plan::run(arguments),
        Command::Check(arguments) => check::run(arguments),
        Command::Certify(arguments) => costs::certify::run(arguments),
        Command::Review(arguments) => review::run(arguments),
        Command::Upload(arguments) => transfer::upload::run(arguments),
        Command::Fly(arguments) => fly::run(arguments),
        Command::Watch(arguments) => watch::run(arguments),
        Command::Replan(arguments) => replan::run(arguments),
        Command::Download(arguments) => transfer::download::run(arguments),
        Command::Convert(arguments) => convert::run(arguments),
        Command::Vehicles(arguments) => vehicles::run(arguments),
        Command::Terrain(command) => terrain::run(command),
        Command::Evaluate(arguments) => costs::evaluate::run(arguments),
        Command::Study(arguments) => study::run_study(arguments),
        Command::Migrate(arguments) => migrate::run(arguments),
        Command::New(arguments) => new::run(arguments),
        Command::Man { folder } => man::run(folder),
        Command::Schema { name } => out_text(&schema::of(*name)),
        Command::Completions { shell } => {
            let mut completions = Vec::new();
            clap_complete::generate(
                *shell,
                &mut Arguments::command(),
                "sortie",
                &mut completions,
            );
            out_text(&String::from_utf8_lossy(&completions))
        }
    }
}
