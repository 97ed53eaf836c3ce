//! Any file as an SRTM tile: no panic, and the heights that are read are heights.
#![no_main]

#[path = "common/elevation.rs"]
mod elevation;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let (name, rest) = data.split_at(data.len().min(7));
    let name = String::from_utf8_lossy(name).replace(['/', '\0'], "_");
    elevation::read(&format!("{name}.hgt"), rest, Some(2_884_802));
});
