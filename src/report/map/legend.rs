//! The legend under the picture: each vehicle with its length and duration.

use std::fmt::Write as _;

use super::{INK, MAX_NAMES, WIDTH, one};
use crate::report::COLOURS;
use crate::report::scene::VehicleShape;
use crate::report::words::{self, escaped};

const MAX_COLUMNS: u16 = 4;
const LINE: f64 = 26.0;
const SIZE: f64 = 15.0;
/// Width of a letter, as a share of the size: more than on average.
const LETTER: f64 = 0.62;
/// Where the text of an entry begins, and what it leaves free behind it.
const INDENT: f64 = 38.0;
const GAP: f64 = 20.0;

/// Length and duration of what is flown; empty without a track.
fn figures(vehicle: &VehicleShape) -> String {
    vehicle.duration_s().map_or_else(String::new, |duration_s| {
        format!(
            " {} km, {}{}",
            words::number(vehicle.length_m / 1000.0, 1),
            words::clock(duration_s),
            if vehicle.stays() { ", loiters" } else { "" }
        )
    })
}

/// As many columns as the longest entry leaves.
fn columns(vehicles: &[VehicleShape]) -> u16 {
    let letters = |of: &VehicleShape| of.id.chars().count() + 1 + figures(of).chars().count();
    let longest = vehicles.iter().take(MAX_NAMES).map(letters).max();
    let longest = f64::from(u16::try_from(longest.unwrap_or(0)).unwrap_or(u16::MAX));
    let width = INDENT + longest * SIZE * LETTER + GAP;
    let fits = |columns: &u16| f64::from(*columns) * width <= WIDTH;
    (1..=MAX_COLUMNS).rev().find(fits).unwrap_or(1)
}

/// Height of the legend, picture units.
pub(super) fn height(vehicles: &[VehicleShape]) -> f64 {
    let columns = usize::from(columns(vehicles));
    let lines = vehicles.len().min(MAX_NAMES).div_ceil(columns);
    f64::from(u32::try_from(lines).unwrap_or(0)) * LINE + 14.0
}

pub(super) fn legend(vehicles: &[VehicleShape]) -> String {
    let columns = columns(vehicles);
    let width = WIDTH / f64::from(columns);
    let mut svg = String::new();
    for (index, vehicle) in (0..).zip(vehicles.iter().take(MAX_NAMES)) {
        let (column, line): (u16, u16) = (index % columns, index / columns);
        let (x, y) = (f64::from(column) * width, f64::from(line) * LINE);
        let _ = write!(
            svg,
            "<path d=\"M{} {}h26\" stroke=\"{}\" stroke-width=\"3.5\" stroke-linecap=\"round\"/>\
             <text x=\"{}\" y=\"{}\" font-size=\"{SIZE}\" fill=\"{INK}\"><tspan font-weight=\"600\">{}</tspan><tspan fill=\"#5b6670\">\u{2002}{}</tspan></text>",
            one(x + 2.0),
            one(y),
            COLOURS[usize::from(index) % COLOURS.len()][0],
            one(x + INDENT),
            one(y + 5.0),
            escaped(&vehicle.id),
            figures(vehicle),
        );
    }
    svg
}
