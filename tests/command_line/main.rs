//! The command line as its users meet it.

#[path = "../support/mod.rs"]
mod support;

mod airspace;
mod begin;
mod cli;
mod documents;
mod many_zones;
mod migrate;
mod whole_line;
mod windows;
