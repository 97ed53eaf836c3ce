//! Any text as a mission spec: no panic, and every problem is somewhere in the text.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use sortie::spec::{SpecFile, TerrainSource};
use sortie::world;

fuzz_target!(|data: &[u8]| {
    let text = String::from_utf8_lossy(data).into_owned();
    match SpecFile::parse(Path::new("/nowhere/spec.yaml"), text) {
        Err(error) => {
            assert!(!error.issues.is_empty());
            let _ = error.to_string();
        }
        Ok(file) => {
            let area = file.spec.area;
            let span_deg = (area.north_east.lat_deg - area.south_west.lat_deg)
                .max(area.north_east.lon_deg - area.south_west.lon_deg);
            // The ground of a continent takes its time; this is about reading.
            if span_deg < 0.2 && !matches!(file.spec.terrain, TerrainSource::File(_)) {
                let _ = world::load(&file);
            }
        }
    }
});
