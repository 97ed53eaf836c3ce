//! Mission items: acceptance, encoding, files and conversions.

#[path = "../support/mod.rs"]
mod support;

mod airframes;
mod at_one_place;
mod commanded_places;
mod commands_without_spec;
mod convert_command;
mod flown_otherwise;
mod formats_corpus;
mod formats_golden;
mod formats_maps;
mod judged;
mod landing_below_home;
mod landing_pattern;
mod long_flight;
mod mission_accept;
mod mission_build;
mod params_without_spec;
mod wing_returns;
mod wings_without_spec;
mod without_spec;
