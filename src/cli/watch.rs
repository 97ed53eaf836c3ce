//! `sortie watch`: a flight that goes on is attached to, one whose ground station crashed is taken
//! over from its record.

use super::args;
use super::fly;
use super::folder::runs;
use super::print::failure::Failure;

pub(super) fn run(arguments: &args::Watch) -> Result<(), Failure> {
    if !arguments.dir.is_dir() {
        let message = format!(
            "{}: not a folder; name the one that `sortie plan` wrote",
            arguments.dir.display()
        );
        return Err(Failure::new(Failure::INPUT, message));
    }
    if fly::attach(&runs::folder(&arguments.dir))? {
        return Ok(());
    }
    let plan = fly::read_folder(arguments.dir.clone())?;
    fly::watch(&plan, &arguments.link, arguments.json)
}
