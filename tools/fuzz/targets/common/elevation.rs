//! One elevation file in memory, read whole or within bounds that the input chooses.

use std::fs::{self, File};
use std::path::PathBuf;

use sortie::geodesy::LatLon;
use sortie::world::{Bounds, read_terrain};

/// Two bytes as a coordinate.
fn degrees(bytes: &[u8], most: f64) -> f64 {
    let number = i16::from_le_bytes([bytes[0], bytes[1]]);
    most * f64::from(number) / f64::from(i16::MAX)
}

/// The first nine bytes say what is asked of the file, the others are the file; with
/// `whole_bytes` it may be filled up with zeros to that size.
pub fn read(name: &str, data: &[u8], whole_bytes: Option<u64>) {
    let Some((asked, bytes)) = data.split_at_checked(9) else {
        return;
    };
    let folder = PathBuf::from(format!("/dev/shm/sortie-fuzz-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder in memory");
    let path = folder.join(name);
    fs::write(&path, bytes).expect("a file in memory");
    if let (1, Some(size)) = (asked[8] & 1, whole_bytes) {
        let file = File::options().write(true).open(&path);
        file.and_then(|file| file.set_len(size))
            .expect("a file in memory");
    }
    let south_west = LatLon {
        lat_deg: degrees(&asked[..2], 90.0),
        lon_deg: degrees(&asked[2..4], 180.0),
    };
    let bounds = Bounds {
        south_west,
        north_east: LatLon {
            lat_deg: south_west.lat_deg + degrees(&asked[4..6], 2.0),
            lon_deg: south_west.lon_deg + degrees(&asked[6..8], 2.0),
        },
    };
    let bounds = (asked[8] & 2 == 0).then_some(bounds);
    match read_terrain(&path, bounds) {
        Ok(grid) => {
            let _ = sortie::world::Terrain::Grid(grid).height(south_west);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    fs::remove_file(&path).expect("it was there");
}
