//! The ground as the report draws it: a small grid and its shading.

use base64::prelude::{BASE64_STANDARD, Engine};
use rayon::prelude::*;
use serde::Serialize;

use crate::geodesy::EastNorth;
use crate::world::World;

/// Most nodes along one side of the grid.
const MAX_NODES: u32 = 180;

/// A rectangle of planning coordinates, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(in crate::report) struct Bounds {
    pub(in crate::report) west: f64,
    pub(in crate::report) south: f64,
    pub(in crate::report) east: f64,
    pub(in crate::report) north: f64,
}

/// Heights at the nodes of a grid over the bounds, row by row from the
/// south-west, in decimetres above the sea; none where there is no data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(in crate::report) struct Relief {
    pub(in crate::report) columns: u32,
    pub(in crate::report) rows: u32,
    pub(in crate::report) heights_dm: Vec<Option<i32>>,
}

impl Bounds {
    /// A rectangle around nothing.
    pub(in crate::report) const NONE: Self = Self {
        west: f64::INFINITY,
        south: f64::INFINITY,
        east: f64::NEG_INFINITY,
        north: f64::NEG_INFINITY,
    };

    pub(in crate::report) fn include(&mut self, at: EastNorth) {
        self.west = self.west.min(at.east_m);
        self.south = self.south.min(at.north_m);
        self.east = self.east.max(at.east_m);
        self.north = self.north.max(at.north_m);
    }

    pub(in crate::report) fn width_m(&self) -> f64 {
        self.east - self.west
    }

    pub(in crate::report) fn height_m(&self) -> f64 {
        self.north - self.south
    }

    /// The same with a margin on every side.
    pub(in crate::report) fn padded(&self, by_m: f64) -> Self {
        Self {
            west: self.west - by_m,
            south: self.south - by_m,
            east: self.east + by_m,
            north: self.north + by_m,
        }
    }

    /// The nearest place inside.
    pub(in crate::report) fn clamp(&self, at: EastNorth) -> EastNorth {
        EastNorth {
            east_m: at.east_m.clamp(self.west, self.east),
            north_m: at.north_m.clamp(self.south, self.north),
        }
    }
}

impl Relief {
    /// The terrain over the bounds, from its source.
    pub(in crate::report) fn sample(world: &World, bounds: &Bounds) -> Self {
        let longer_m = bounds.width_m().max(bounds.height_m()).max(1.0);
        let nodes = |length_m: f64| {
            let share = (length_m / longer_m * f64::from(MAX_NODES - 1)).round();
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "between 1 and MAX_NODES"
            )]
            let cells = share.clamp(1.0, f64::from(MAX_NODES - 1)) as u32;
            cells + 1
        };
        let mut relief = Self {
            columns: nodes(bounds.width_m()),
            rows: nodes(bounds.height_m()),
            heights_dm: Vec::new(),
        };
        let height_dm = |column: u32, row: u32| {
            let at = relief.node(bounds, column, row);
            let height = world.terrain.height_at(&world.frame, at).ok();
            height.and_then(|amsl| decimetres(amsl.0))
        };
        let rows: Vec<Vec<_>> = (0..relief.rows)
            .into_par_iter()
            .map(|row| {
                (0..relief.columns)
                    .map(|column| height_dm(column, row))
                    .collect()
            })
            .collect();
        relief.heights_dm = rows.concat();
        relief
    }

    pub(in crate::report) fn node(&self, bounds: &Bounds, column: u32, row: u32) -> EastNorth {
        EastNorth {
            east_m: bounds.west
                + bounds.width_m() * f64::from(column) / f64::from(self.columns - 1),
            north_m: bounds.south + bounds.height_m() * f64::from(row) / f64::from(self.rows - 1),
        }
    }

    /// Height in metres at a node; `None` outside and in voids.
    pub(in crate::report) fn at(&self, column: i64, row: i64) -> Option<f64> {
        let (columns, rows) = (i64::from(self.columns), i64::from(self.rows));
        if !(0..columns).contains(&column) || !(0..rows).contains(&row) {
            return None;
        }
        let index = usize::try_from(row * columns + column).ok()?;
        let height_dm = *self.heights_dm.get(index)?;
        height_dm.map(|height_dm| f64::from(height_dm) / 10.0)
    }

    /// Lowest and highest ground, metres; `None` without any data.
    pub(in crate::report) fn range_m(&self) -> Option<(f64, f64)> {
        let known = || self.heights_dm.iter().flatten();
        Some((
            f64::from(*known().min()?) / 10.0,
            f64::from(*known().max()?) / 10.0,
        ))
    }

    /// Shaded relief as a transparent picture, light from the north-west: it
    /// darkens slopes turned away and lightens those turned to the light, so
    /// that it lies over any colour. Voids stay clear.
    pub(in crate::report) fn shading(&self, bounds: &Bounds) -> String {
        let step_east_m = bounds.width_m() / f64::from(self.columns - 1);
        let step_north_m = bounds.height_m() / f64::from(self.rows - 1);
        let (low_m, high_m) = self.range_m().unwrap_or((0.0, 0.0));
        // Slopes are stretched until the whole relief rises by an eighth of the
        // width: gentle hills must be seen as well as steep ones.
        let stretch = (0.13 * bounds.width_m() / (high_m - low_m).max(20.0)).clamp(1.0, 9.0);
        let mut pixels = Vec::with_capacity(self.heights_dm.len());
        for row in (0..i64::from(self.rows)).rev() {
            for column in 0..i64::from(self.columns) {
                let slope = |before: Option<f64>, after: Option<f64>, step_m: f64| {
                    let here = self.at(column, row)?;
                    let (b, a) = (before.unwrap_or(here), after.unwrap_or(here));
                    let steps = f64::from(u8::from(before.is_some()) + u8::from(after.is_some()));
                    (steps > 0.0).then(|| stretch * (a - b) / (steps * step_m))
                };
                let east = slope(
                    self.at(column - 1, row),
                    self.at(column + 1, row),
                    step_east_m,
                );
                let north = slope(
                    self.at(column, row - 1),
                    self.at(column, row + 1),
                    step_north_m,
                );
                pixels.push(match (east, north) {
                    (Some(east), Some(north)) => shade(east, north),
                    _ => CLEAR,
                });
            }
        }
        data_uri(self.columns, self.rows, &pixels)
    }
}

/// A shade: 128 is clear, lower darkens, higher lightens, up to opaque.
type Shade = u8;

/// No shade at all.
const CLEAR: Shade = 128;

/// A `data:` URI of a picture as PNG, its rows from the top. It is not compressed:
/// compressors choose by processor, and the report has the same bytes everywhere.
fn data_uri(columns: u32, rows: u32, shades: &[Shade]) -> String {
    let dark_or_light = |shade| {
        if shade < CLEAR {
            [28, 38, 48]
        } else {
            [255; 3]
        }
    };
    let colours: Vec<u8> = (0..=Shade::MAX).flat_map(dark_or_light).collect();
    let opacity = |shade: Shade| shade.abs_diff(CLEAR).saturating_mul(2);
    let opacities: Vec<u8> = (0..=Shade::MAX).map(opacity).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, columns, rows);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(colours);
    encoder.set_trns(opacities);
    encoder.set_compression(png::Compression::NoCompression);
    encoder.set_filter(png::Filter::NoFilter);
    let written = encoder.write_header().and_then(|mut image| {
        image.write_image_data(shades)?;
        image.finish()
    });
    written.expect("two rows and columns at least, in memory");
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(&file))
}

/// The shade of a slope (rise over run to the east and to the north).
fn shade(east: f64, north: f64) -> Shade {
    let length = (1.0 + east * east + north * north).sqrt();
    // Light from the north-west, 45 degrees up: (-1/2, 1/2, sqrt(1/2)).
    let lit = (0.5 * east - 0.5 * north + std::f64::consts::FRAC_1_SQRT_2) / length
        - std::f64::consts::FRAC_1_SQRT_2;
    let shade = f64::from(CLEAR) + (lit * 80.0).clamp(-46.0, 60.0);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between 82 and 188"
    )]
    let shade = shade.round() as Shade;
    shade
}

/// The next of 1, 2, 5, 10, 20, 50, ... at or above.
pub(in crate::report) fn round_step(least: f64) -> f64 {
    let decade = 10_f64.powf(least.max(1e-3).log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|step| step * decade)
        .find(|step| *step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

fn decimetres(height_m: f64) -> Option<i32> {
    let height_dm = (height_m * 10.0).round();
    // Deeper than any ocean or higher than any mountain is no ground at all.
    #[expect(clippy::cast_possible_truncation, reason = "within 2e5")]
    (height_dm.abs() < 2e5).then_some(height_dm as i32)
}

#[cfg(test)]
mod tests {
    use super::{CLEAR, round_step, shade};

    #[test]
    fn slopes_to_the_north_west_are_lit_and_others_lie_in_the_shade() {
        // A slope that rises to the south-east faces the north-west.
        assert!(shade(0.3, -0.3) > CLEAR + 10);
        assert!(shade(-0.3, 0.3) < CLEAR - 10);
        assert_eq!(shade(0.0, 0.0), CLEAR);
    }

    #[test]
    fn steps_are_round() {
        for (least, step) in [
            (0.9, 1.0),
            (1.0, 1.0),
            (13.0, 20.0),
            (430.0, 500.0),
            (0.03, 0.05),
        ] {
            assert!((round_step(least) - step).abs() < 1e-9 * step);
        }
    }
}
