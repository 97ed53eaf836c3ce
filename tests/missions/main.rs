//! Mission items: acceptance, encoding, files and conversions.

#[path = "../support/mod.rs"]
mod support;

mod airframes;
mod convert_command;
mod formats_corpus;
mod formats_golden;
mod formats_maps;
mod mission_accept;
mod mission_build;
mod without_spec;
