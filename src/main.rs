//! The `sortie` command.

fn main() -> std::process::ExitCode {
    sortie::cli::run(std::env::args_os())
}
