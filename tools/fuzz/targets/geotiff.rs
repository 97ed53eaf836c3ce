//! Any file as a GeoTIFF: no panic, and the heights that are read are heights.
#![no_main]

#[path = "common/elevation.rs"]
mod elevation;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| elevation::read("terrain.tif", data, None));
