//! The earth and its elevation: geodesy against outside truth, readers, `sortie terrain`.

#[path = "../support/mod.rs"]
mod support;

mod geodesy_truth;
mod geotiff_tags;
mod narrow_hills;
mod other_formats;
mod projections;
mod terrain;
mod terrain_commands;
mod terrain_folder;
