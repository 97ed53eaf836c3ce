//! `sortie man`: manual pages, made from the arguments.

use std::fs;
use std::path::Path;

use clap::CommandFactory;

use super::args::Arguments;
use super::print::console::out;
use super::print::failure::Failure;

pub(super) fn run(folder: &Path) -> Result<(), Failure> {
    let write = || {
        fs::create_dir_all(folder)?;
        clap_mangen::generate_to(Arguments::command(), folder)?;
        let files = fs::read_dir(folder)?.filter_map(Result::ok);
        let is_page = |file: &fs::DirEntry| file.path().extension().is_some_and(|of| of == "1");
        Ok(files.filter(is_page).count())
    };
    let pages = write().map_err(|error: std::io::Error| {
        Failure::new(Failure::OUTPUT, format!("{}: {error}", folder.display()))
    })?;
    out(&format!(
        "{}: {pages} pages; `man {}` shows the first",
        folder.display(),
        folder.join("sortie.1").display()
    ))
}
