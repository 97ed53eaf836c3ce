//! ArduPilot's terrain database: `N36W085.DAT`, one file for each degree square.
//!
//! A file is made of blocks of 2048 bytes, each 28 heights to the north and 32 to the
//! east, metres above mean sea level; neighbours overlap by four of them, so that every
//! place is inside one block (`AP_Terrain.h`, `struct grid_block`). The corners of the
//! blocks follow ArduPilot's own arithmetic (`Location::offset`), which is no geodesy:
//! the vehicle looks for a block at the place it computes itself and takes no other that
//! is more than 5 cm off. A block whose `version_minor` is 0 is not armed with.

mod location;

use std::collections::BTreeSet;

use location::{Location, PER_DEGREE, corner_of, distance_m, e7, offset};

use crate::geodesy::LatLon;
use crate::spec::Area;
use crate::world::Terrain;

/// `IO_BLOCK_SIZE`.
const BLOCK_BYTES: usize = 2048;
/// What the checksum covers: all fields before `version_minor`.
const CHECKED_BYTES: usize = 1821;
/// Heights in a block, north and east.
const NORTH: usize = 28;
const EAST: usize = 32;
/// Heights from one block to the next.
const STEP_NORTH: u16 = 24;
const STEP_EAST: u16 = 28;
/// Heights sent at once over MAVLink, in both directions: one bit of the bitmap.
const PATCH: usize = 4;
/// One file of the database.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DatFile {
    /// Its name on the vehicle's card, in `APM/TERRAIN`.
    pub name: String,
    /// Its bytes; blocks that are not needed are zero, which the vehicle takes for absent.
    pub bytes: Vec<u8>,
}

/// The database of an area.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Database {
    /// Its files, from the south-west.
    pub files: Vec<DatFile>,
    /// Blocks written.
    pub blocks: usize,
    /// Patches of 4 by 4 heights of the area that were left out, since the terrain has
    /// no data there. The vehicle asks its ground station for them, and has no height
    /// without an answer.
    pub missing: usize,
}

/// One block of one degree square.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Key {
    /// South-west corner of the square, degrees.
    lat_deg: i32,
    lon_deg: i32,
    north: u16,
    east: u16,
}

/// The database of an area and one block around it, a height every `spacing_m` metres,
/// which must be the vehicle's `TERRAIN_SPACING`.
#[must_use]
pub fn write(terrain: &Terrain, area: &Area, spacing_m: u16) -> Database {
    let mut database = Database {
        files: Vec::new(),
        blocks: 0,
        missing: 0,
    };
    let mut square = None;
    for key in keys(area, spacing_m) {
        let name = name(key.lat_deg, key.lon_deg);
        if square != Some((key.lat_deg, key.lon_deg)) {
            square = Some((key.lat_deg, key.lon_deg));
            let bytes = Vec::new();
            database.files.push(DatFile { name, bytes });
        }
        let Some(file) = database.files.last_mut() else {
            continue;
        };
        let (block, missing) = block(terrain, area, key, spacing_m);
        let stride = usize::from(east_blocks(key.lat_deg, key.lon_deg, spacing_m));
        let start = BLOCK_BYTES * (stride * usize::from(key.north) + usize::from(key.east));
        if file.bytes.len() < start + BLOCK_BYTES {
            file.bytes.resize(start + BLOCK_BYTES, 0);
        }
        file.bytes[start..start + BLOCK_BYTES].copy_from_slice(&block);
        database.blocks += 1;
        database.missing += missing;
    }
    database
}

/// The blocks in which the vehicle looks for places of the area, or within a block of it.
fn keys(area: &Area, spacing_m: u16) -> BTreeSet<Key> {
    let margin_m = i32::from(STEP_EAST) * i32::from(spacing_m);
    let corner = |place: LatLon, away_m: i32| {
        let (lat, lon) = (e7(place.lat_deg), e7(place.lon_deg));
        let away = offset(Location { lat, lon }, away_m, away_m);
        Location {
            lat: away.lat.clamp(-90 * PER_DEGREE, 90 * PER_DEGREE - 1),
            lon: away.lon.clamp(-180 * PER_DEGREE, 180 * PER_DEGREE - 1),
        }
    };
    let south_west = corner(area.south_west, -margin_m);
    let north_east = corner(area.north_east, margin_m);
    let squares = |from: i32, to: i32| from.div_euclid(PER_DEGREE)..=to.div_euclid(PER_DEGREE);
    // The part of a range within a square.
    let within = |square: i32, from: i32, to: i32| {
        let first = square * PER_DEGREE;
        (from.max(first), to.min(first + PER_DEGREE - 1))
    };
    let mut keys = BTreeSet::new();
    for lat_deg in squares(south_west.lat, north_east.lat) {
        for lon_deg in squares(south_west.lon, north_east.lon) {
            let (south, north) = within(lat_deg, south_west.lat, north_east.lat);
            let (west, east) = within(lon_deg, south_west.lon, north_east.lon);
            // Metres to the east depend on the latitude, so all corners are asked.
            let corners = [(south, west), (south, east), (north, west), (north, east)];
            let corners: Vec<Key> = corners
                .into_iter()
                .filter_map(|(lat, lon)| key(Location { lat, lon }, spacing_m))
                .collect();
            let range = |index: fn(&Key) -> u16| {
                let all = corners.iter().map(index);
                all.clone().min().unwrap_or(1)..=all.max().unwrap_or(0)
            };
            for north in range(|key| key.north) {
                keys.extend(range(|key| key.east).map(|east| Key {
                    lat_deg,
                    lon_deg,
                    north,
                    east,
                }));
            }
        }
    }
    keys
}

/// The block in which the vehicle looks for a place (`AP_Terrain::calculate_grid_info`).
fn key(at: Location, spacing_m: u16) -> Option<Key> {
    let (lat_deg, lon_deg) = (at.lat.div_euclid(PER_DEGREE), at.lon.div_euclid(PER_DEGREE));
    let (north_m, east_m) = distance_m(corner_of(lat_deg, lon_deg), at);
    let spacing_m = f32::from(spacing_m);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast of a float saturates"
    )]
    let index = |along_m: f32, step: u16| (along_m / spacing_m) as u32 / u32::from(step);
    Some(Key {
        lat_deg,
        lon_deg,
        north: u16::try_from(index(north_m, STEP_NORTH)).ok()?,
        east: u16::try_from(index(east_m, STEP_EAST)).ok()?,
    })
}

/// A block, and how many of its patches lack a height of the area.
///
/// Each height is that of the place for which the vehicle reads it: its
/// distance in metres from the corner of the *square* by the vehicle's arithmetic. Counted from the corner of
/// the block, as ground stations do, it would be up to 40 m away at 60 degrees north.
fn block(terrain: &Terrain, area: &Area, key: Key, spacing_m: u16) -> ([u8; BLOCK_BYTES], usize) {
    let square = corner_of(key.lat_deg, key.lon_deg);
    let post = |north: u32, east: u32| {
        let metres = |posts: u32| i32::try_from(posts * u32::from(spacing_m)).unwrap_or(i32::MAX);
        offset(square, metres(north), metres(east))
    };
    let first = (
        u32::from(key.north) * u32::from(STEP_NORTH),
        u32::from(key.east) * u32::from(STEP_EAST),
    );
    let corner = post(first.0, first.1);
    let mut bitmap = (1_u64 << (NORTH / PATCH * (EAST / PATCH))) - 1;
    let mut missing = 0_u64;
    let mut heights_m = Vec::with_capacity(NORTH * EAST);
    for (north, row) in (0..NORTH).zip(first.0..) {
        for (east, column) in (0..EAST).zip(first.1..) {
            let place = post(row, column);
            let height_m = height_m(terrain, place);
            if height_m.is_none() {
                let patch = 1 << (north / PATCH * (EAST / PATCH) + east / PATCH);
                bitmap &= !patch;
                missing |= if place.is_in(area) { patch } else { 0 };
            }
            heights_m.push(height_m.unwrap_or(0));
        }
    }
    let mut bytes = Vec::with_capacity(BLOCK_BYTES);
    bytes.extend(bitmap.to_le_bytes());
    bytes.extend(corner.lat.to_le_bytes());
    bytes.extend(corner.lon.to_le_bytes());
    bytes.extend([0, 0]); // the checksum
    bytes.extend(1_u16.to_le_bytes()); // version
    bytes.extend(spacing_m.to_le_bytes());
    bytes.extend(heights_m.iter().flat_map(|height_m| height_m.to_le_bytes()));
    bytes.extend(key.north.to_le_bytes());
    bytes.extend(key.east.to_le_bytes());
    bytes.extend(i16::try_from(key.lon_deg).unwrap_or_default().to_le_bytes());
    bytes.extend(i8::try_from(key.lat_deg).unwrap_or_default().to_le_bytes());
    let checksum = crc16(&bytes[..CHECKED_BYTES]);
    bytes[16..18].copy_from_slice(&checksum.to_le_bytes());
    bytes.push(1); // version_minor
    let mut block = [0; BLOCK_BYTES];
    block[..bytes.len()].copy_from_slice(&bytes);
    (block, missing.count_ones() as usize)
}

/// Where the ground stands highest above what the vehicle reads from a database.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hidden {
    /// Where.
    pub place: LatLon,
    /// By how much, metres.
    pub height_m: f64,
}

/// Most posts that [`hidden`] compares.
const MAX_POINTS: usize = 1 << 20;

/// The worst that lies between the heights of a database: at the posts of the elevation
/// file within the area (evenly thinned if there are more than a million), by how much
/// the ground is above the bilinear height that the vehicle has. `None` for ground that
/// comes from no file, and without any.
#[must_use]
pub fn hidden(terrain: &Terrain, area: &Area, spacing_m: u16) -> Option<Hidden> {
    let Terrain::Grid(grid) = terrain else {
        return None;
    };
    let inside = |from: f64, at: f64, to: f64| (from..=to).contains(&at);
    let rows: Vec<usize> = (0..grid.rows)
        .filter(|row| {
            let (south, north) = (area.south_west.lat_deg, area.north_east.lat_deg);
            inside(south, grid.row_lat_deg(*row), north)
        })
        .collect();
    let columns: Vec<usize> = (0..grid.columns)
        .filter(|column| {
            let (west, east) = (area.south_west.lon_deg, area.north_east.lon_deg);
            inside(west, grid.column_lon_deg(*column), east)
        })
        .collect();
    let step = (rows.len() * columns.len()).div_ceil(MAX_POINTS).max(1);
    let posts = rows
        .iter()
        .flat_map(|row| columns.iter().map(move |column| (*row, *column)))
        .step_by(step);
    let mut worst: Option<Hidden> = None;
    for (row, column) in posts {
        let place = LatLon {
            lat_deg: grid.row_lat_deg(row),
            lon_deg: grid.column_lon_deg(column),
        };
        let known = grid
            .node_m(row, column)
            .zip(read_m(terrain, place, spacing_m));
        if let Some((ground_m, read_m)) = known {
            let height_m = ground_m - read_m;
            if worst.is_none_or(|worst| height_m > worst.height_m) {
                worst = Some(Hidden { place, height_m });
            }
        }
    }
    worst
}

/// The height that the vehicle has for a place (`AP_Terrain::height_amsl`).
fn read_m(terrain: &Terrain, place: LatLon, spacing_m: u16) -> Option<f64> {
    let at = Location {
        lat: e7(place.lat_deg),
        lon: e7(place.lon_deg),
    };
    let square = corner_of(at.lat.div_euclid(PER_DEGREE), at.lon.div_euclid(PER_DEGREE));
    let (north_m, east_m) = distance_m(square, at);
    let posts = |along_m: f32| f64::from(along_m / f32::from(spacing_m));
    let (north, east) = (posts(north_m), posts(east_m));
    let post_m = |up: i32, right: i32| {
        #[expect(clippy::cast_possible_truncation, reason = "posts within a degree")]
        let (row, column) = (north.floor() as i32 + up, east.floor() as i32 + right);
        let spacing = i32::from(spacing_m);
        height_m(terrain, offset(square, row * spacing, column * spacing)).map(f64::from)
    };
    let (up, right) = (north - north.floor(), east - east.floor());
    let south_m = post_m(0, 0)? * (1.0 - right) + post_m(0, 1)? * right;
    let north_m = post_m(1, 0)? * (1.0 - right) + post_m(1, 1)? * right;
    Some(south_m * (1.0 - up) + north_m * up)
}

/// The ground at a place, to the nearest metre.
fn height_m(terrain: &Terrain, at: Location) -> Option<i16> {
    let degrees = |e7: i32| f64::from(e7) / f64::from(PER_DEGREE);
    let place = LatLon::new(degrees(at.lat), degrees(at.lon)).ok()?;
    let ground = terrain.height(place).ok()?;
    #[expect(
        clippy::cast_possible_truncation,
        reason = "ground lies within 9000 m of the sea"
    )]
    let height_m = ground.0.round() as i16;
    Some(height_m)
}

/// CRC-16 of polynomial 0x1021 from 0, as XMODEM has it (`crc16_ccitt` of ArduPilot).
fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |crc, byte| {
        (0..8).fold(crc ^ (u16::from(*byte) << 8), |crc, _| {
            let shifted = crc << 1;
            if crc & 0x8000 == 0 {
                shifted
            } else {
                shifted ^ 0x1021
            }
        })
    })
}

/// Blocks from one row to the next in a file (`AP_Terrain::east_blocks`).
fn east_blocks(lat_deg: i32, lon_deg: i32, spacing_m: u16) -> u16 {
    let square = corner_of(lat_deg, lon_deg);
    let spacing = i32::from(spacing_m);
    let next = Location {
        lon: square.lon + PER_DEGREE,
        ..square
    };
    // Room for two more.
    let room = offset(
        next,
        0,
        2 * spacing * i32::try_from(EAST).unwrap_or(i32::MAX),
    );
    let (_, east_m) = distance_m(square, room);
    let blocks = east_m / (f32::from(spacing_m) * f32::from(STEP_EAST));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast of a float saturates"
    )]
    let blocks = blocks as u16;
    blocks
}

fn name(lat_deg: i32, lon_deg: i32) -> String {
    let (north, east) = (
        if lat_deg < 0 { 'S' } else { 'N' },
        if lon_deg < 0 { 'W' } else { 'E' },
    );
    format!(
        "{north}{:02}{east}{:03}.DAT",
        lat_deg.unsigned_abs(),
        lon_deg.unsigned_abs()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of CRC-16/XMODEM.
    #[test]
    fn the_checksum_is_that_of_xmodem() {
        assert_eq!(crc16(b"123456789"), 0x31c3);
    }

    #[test]
    fn files_are_named_after_their_south_west_corner() {
        assert_eq!(name(36, -85), "N36W085.DAT");
        assert_eq!(name(-1, 7), "S01E007.DAT");
    }

    #[test]
    fn every_place_is_inside_its_block() {
        for (lat, lon) in [
            (36.3, -84.25),
            (-35.36, 149.16),
            (0.0001, -0.0001),
            (69.99, 20.5),
        ] {
            let at = Location {
                lat: e7(lat),
                lon: e7(lon),
            };
            let key = key(at, 100).expect("a block");
            let along = |index: u16, step: u16| i32::from(index) * i32::from(step) * 100;
            let square = corner_of(key.lat_deg, key.lon_deg);
            let corner = offset(
                square,
                along(key.north, STEP_NORTH),
                along(key.east, STEP_EAST),
            );
            let (north_m, east_m) = distance_m(corner, at);
            // Overlaps make good for the metres that ArduPilot's plane is off.
            assert!((-50.0..2450.0).contains(&north_m), "{north_m}");
            assert!((-50.0..2850.0).contains(&east_m), "{east_m}");
        }
    }
}
