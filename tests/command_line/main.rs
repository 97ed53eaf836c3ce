//! The command line as its users meet it.

#[path = "../support/mod.rs"]
mod support;

mod cli;
mod migrate;
mod whole_line;
