//! Where mean sea level lies: the EGM96 geoid over the WGS84 ellipsoid.
//!
//! The grid is NGA's, of 15 arc-minutes and in whole centimetres (`EGM96.md` in
//! this folder has its origin). Bilinear values are within 1 cm of PROJ's; the model
//! itself is good to about half a metre, and up to 5 cm more goes with the grid.

use std::io::Read;
use std::sync::LazyLock;

use super::LatLon;

const ROWS: usize = 721;
const COLUMNS: usize = 1440;
/// Nodes in a degree.
const PER_DEGREE: f64 = 4.0;

static EGM96: LazyLock<Geoid> = LazyLock::new(|| {
    Geoid::decode(include_bytes!("egm96.zlib")).expect("the grid is part of the program and tested")
});

/// Heights of mean sea level above the WGS84 ellipsoid.
#[derive(Debug)]
pub struct Geoid {
    /// Centimetres, row by row from the north pole, each from Greenwich eastwards.
    nodes_cm: Vec<i16>,
}

impl Geoid {
    /// The Earth Gravitational Model 1996, which elevation files and autopilots mean by
    /// mean sea level. It is decoded once, at the first call (10 ms).
    #[must_use]
    pub fn egm96() -> &'static Self {
        &EGM96
    }

    /// How far mean sea level lies above the ellipsoid at a place (below, if negative), metres.
    #[must_use]
    pub fn undulation_m(&self, place: LatLon) -> f64 {
        let (row, down) = cell((90.0 - place.lat_deg) * PER_DEGREE, ROWS - 2);
        let (column, right) = cell(place.lon_deg.rem_euclid(360.0) * PER_DEGREE, COLUMNS - 1);
        let east = (column + 1) % COLUMNS;
        let node = |row: usize, column: usize| f64::from(self.nodes_cm[row * COLUMNS + column]);
        let along = |row| node(row, column) + (node(row, east) - node(row, column)) * right;
        (along(row) + (along(row + 1) - along(row)) * down) / 100.0
    }

    /// The least and the greatest undulation between two corners, metres; the eastern longitude may be above 180.
    #[must_use]
    pub fn undulations_m(&self, south_west: LatLon, north_east: LatLon) -> [f64; 2] {
        // Bilinear values are extreme at nodes and where lines of the grid meet the bounds.
        let steps = |from: f64, to: f64| {
            let nodes =
                (1..).map(move |step| ((from * PER_DEGREE).floor() + f64::from(step)) / PER_DEGREE);
            let inside = nodes.take_while(move |node| *node < to);
            std::iter::once(from)
                .chain(inside)
                .chain(std::iter::once(to))
        };
        let lons = || steps(south_west.lon_deg, north_east.lon_deg);
        let grid = steps(south_west.lat_deg, north_east.lat_deg)
            .flat_map(|lat_deg| lons().map(move |lon_deg| LatLon { lat_deg, lon_deg }));
        grid.map(|place| self.undulation_m(place)).fold(
            [f64::INFINITY, f64::NEG_INFINITY],
            |[least, most], value| [least.min(value), most.max(value)],
        )
    }

    /// Undoes the differences; `None` unless there is a whole grid.
    fn decode(coded: &[u8]) -> Option<Self> {
        let mut bytes = Vec::with_capacity(2 * ROWS * COLUMNS);
        let mut reader = flate2::read::ZlibDecoder::new(coded);
        reader.read_to_end(&mut bytes).ok()?;
        if bytes.len() != 2 * ROWS * COLUMNS {
            return None;
        }
        let mut nodes_cm = Vec::with_capacity(ROWS * COLUMNS);
        let mut bends = vec![0_i16; COLUMNS];
        for row in bytes.chunks_exact(2 * COLUMNS) {
            let (mut height, mut slope) = (0_i16, 0_i16);
            for (bend, change) in bends.iter_mut().zip(row.chunks_exact(2)) {
                *bend = bend.wrapping_add(i16::from_le_bytes([change[0], change[1]]));
                slope = slope.wrapping_add(*bend);
                height = height.wrapping_add(slope);
                nodes_cm.push(height);
            }
        }
        Some(Self { nodes_cm })
    }
}

/// The cell that holds a coordinate, no further than `last`, and the fraction within it.
fn cell(at: f64, last: usize) -> (usize, f64) {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a cast of a float saturates, and NaN becomes 0"
    )]
    let index = (at as usize).min(last);
    #[expect(clippy::cast_precision_loss, reason = "at most 1439")]
    let start = index as f64;
    (index, (at - start).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(lat_deg: f64, lon_deg: f64) -> f64 {
        Geoid::egm96().undulation_m(LatLon { lat_deg, lon_deg })
    }

    #[test]
    fn the_grid_is_whole_and_within_the_known_extremes() {
        let nodes = &Geoid::egm96().nodes_cm;
        assert_eq!(nodes.len(), ROWS * COLUMNS);
        // The low south of India and the high of New Guinea.
        let (least, most) = (nodes.iter().min(), nodes.iter().max());
        assert_eq!((least, most), (Some(&-10_699), Some(&8_539)));
        let poles = [&nodes[..COLUMNS], &nodes[nodes.len() - COLUMNS..]];
        assert!(poles[0].iter().all(|node| *node == 1361));
        assert!(poles[1].iter().all(|node| *node == -2953));
    }

    #[test]
    fn a_damaged_grid_is_none() {
        assert!(Geoid::decode(b"").is_none() && Geoid::decode(&[7; 99]).is_none());
        let whole = include_bytes!("egm96.zlib");
        assert!(Geoid::decode(&whole[..whole.len() / 2]).is_none());
    }

    #[test]
    fn the_geoid_is_one_around_the_earth() {
        for lat_deg in [-90.0, -45.1, 0.0, 36.3, 90.0] {
            assert!((at(lat_deg, 180.0) - at(lat_deg, -180.0)).abs() < 1e-12);
            assert!((at(lat_deg, -1e-9) - at(lat_deg, 1e-9)).abs() < 1e-6);
            assert!((at(lat_deg, -84.25) - at(lat_deg, 275.75)).abs() < 1e-9);
        }
        assert!((at(90.0, 12.0) - 13.61).abs() < 1e-9 && (at(-90.0, 99.9) + 29.53).abs() < 1e-9);
    }
}
