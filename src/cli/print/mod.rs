//! What a person reads on the terminal: tables, progress, failures.

pub(super) mod console;
pub(super) mod failure;
pub(super) mod flight;
pub(super) mod overview;
pub(super) mod printer;
pub(super) mod progress;
pub(super) mod table;
