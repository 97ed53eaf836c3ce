//! Fleets: from their compact form to files, and the ways in which vehicles meet.

#[allow(unreachable_pub)]
#[path = "../support/command.rs"]
mod command;
mod meetings;
mod retiming;
mod table;
