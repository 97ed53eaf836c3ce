//! Where neighbouring lines, or pictures, are further apart than their overlap allows.

use super::coverage::{Cells, Leg, MAX_ABOVE, Pass};
use crate::geodesy::EastNorth;
use crate::spec::Sensor;

/// Lines are neighbours up to this angle between them, as the cosine of 10 degrees.
const PARALLEL: f64 = 0.985;

/// A leg that passes a cell.
struct Abeam {
    /// From the cell to the leg, east and north, metres.
    away_m: [f64; 2],
    course: [f64; 2],
    /// Height of the leg above the cell, metres.
    above_m: f64,
}

/// For each cell whether it lies between neighbouring lines that are further apart than the side
/// overlap allows, with the area to be seen between them.
#[must_use]
pub fn far_apart(cells: &Cells, sensor: &Sensor, agl_m: f64, passes: &[Pass]) -> Vec<bool> {
    let mut abeam: Vec<Vec<Abeam>> = Vec::new();
    abeam.resize_with(cells.cells.len(), Vec::new);
    let max_above_m = MAX_ABOVE * agl_m;
    // The first and the last picture of a line show what lies beyond its ends.
    let beyond_m = sensor.picture_m(agl_m).unwrap_or(0.0) / 2.0;
    let reach_m = sensor.swath_m(max_above_m);
    for &(from, to) in passes.iter().flat_map(|pass| &pass.legs) {
        let leg = Leg::new(from, to);
        for index in cells.near(from.at, to.at, reach_m) {
            let found = leg.abeam(cells.cells[index].at, beyond_m);
            let Some(((east_m, north_m), amsl_m)) = found else {
                continue;
            };
            let above_m = amsl_m - cells.cells[index].ground_m;
            if above_m <= max_above_m && east_m.hypot(north_m) <= reach_m {
                abeam[index].push(Abeam {
                    away_m: [east_m, north_m],
                    course: leg.course,
                    above_m,
                });
            }
        }
    }
    let is_apart = |(index, legs): (usize, &Vec<Abeam>)| {
        let Some((apart_m, middle_m, above_m)) = neighbours(legs) else {
            return false;
        };
        let at = cells.cells[index].at;
        let middle = EastNorth {
            east_m: at.east_m + middle_m[0],
            north_m: at.north_m + middle_m[1],
        };
        let is_at = |index: usize| cells.cells[index].at.distance_m(middle) <= 1.5 * cells.side_m;
        apart_m > sensor.lines_apart_m(above_m.max(agl_m))
            && cells.near(middle, middle, 1.5 * cells.side_m).any(is_at)
    };
    abeam.iter().enumerate().map(is_apart).collect()
}

/// How far the nearest legs on both sides are apart, the middle between them, and the height of the
/// higher one.
fn neighbours(legs: &[Abeam]) -> Option<(f64, [f64; 2], f64)> {
    let length_m = |leg: &Abeam| leg.away_m[0].hypot(leg.away_m[1]);
    let nearest = legs
        .iter()
        .min_by(|one, other| length_m(one).total_cmp(&length_m(other)))?;
    let [east, north] = nearest.course;
    let is_parallel =
        |leg: &&Abeam| (leg.course[0] * east + leg.course[1] * north).abs() > PARALLEL;
    let right_m = |leg: &Abeam| leg.away_m[0] * north - leg.away_m[1] * east;
    let sides = || {
        legs.iter()
            .filter(is_parallel)
            .map(|leg| (right_m(leg), leg.above_m))
    };
    let right = sides()
        .filter(|side| side.0 > 0.0)
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let left = sides()
        .filter(|side| side.0 <= 0.0)
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    let middle_m = f64::midpoint(left.0, right.0);
    Some((
        right.0 - left.0,
        [middle_m * north, -middle_m * east],
        left.1.max(right.1),
    ))
}
