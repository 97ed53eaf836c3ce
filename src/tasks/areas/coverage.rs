//! What of an area is seen, counted on cells of the real ground.
//!
//! A camera looks straight down and sees a place if this lies within half of its angle of view on
//! both sides, across and along the line. The height above that place counts, not the one above the
//! ground below the camera.

use geo::{BoundingRect, Contains, Point, Polygon};
use rayon::prelude::*;

use crate::geodesy::{EastNorth, PlanPoint};
use crate::numeric::geometry::point_segment_distance;
use crate::spec::{Sensor, Sweep, SweepShape};
use crate::world::World;

/// Cells in the narrower side of what is seen at once.
const CELLS_PER_SIGHT: f64 = 24.0;
/// Most cells of an area, about.
const MAX_CELLS: f64 = 60_000.0;
/// Smallest side of a cell, metres.
const MIN_SIDE_M: f64 = 0.5;
/// What is seen from more than this many times the height asked for counts as not seen: pictures
/// from there are too coarse.
pub(super) const MAX_ABOVE: f64 = 1.5;
/// Distances of pictures may be shorter than planned by this share: rounding.
const EPSILON: f64 = 1e-9;

/// A place of an area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Its middle.
    pub at: EastNorth,
    /// The ground there, metres above the sea.
    pub ground_m: f64,
}

/// The places of an area, on a square grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// In rows from south to north, each from west to east.
    pub cells: Vec<Cell>,
    /// Index of the first cell of each row, and one more.
    rows: Vec<usize>,
    /// Side of a cell, metres.
    pub side_m: f64,
    first_north_m: f64,
}

/// A part of a flight with the sensor switched on, without a rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Straight pieces, in order.
    pub legs: Vec<(PlanPoint, PlanPoint)>,
    /// Distance between pictures, metres; none for a sensor that sees all the time.
    pub trigger_m: Option<f64>,
    /// Whether there is a picture at its begin, and at its end.
    pub ends: [bool; 2],
}

/// Cells next to each other that are not seen often enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// The cell of the gap that is nearest to its middle.
    pub at: EastNorth,
    /// Its size, square metres.
    pub area_m2: f64,
    /// Its extent to the east and to the north, metres.
    pub size_m: [f64; 2],
}

impl Cells {
    /// The places that a task wants to be seen; none without a sensor, or where the ground is not
    /// known.
    #[must_use]
    pub fn of(sweep: &Sweep, world: &World) -> Option<Self> {
        let sensor = sweep.sensor?;
        let sight_m = sensor.swath_m(sweep.agl.0);
        let sight_m = sight_m.min(sensor.picture_m(sweep.agl.0).unwrap_or(sight_m));
        match &sweep.shape {
            SweepShape::Survey { polygon, holes, .. } => {
                let ring = |corners| world.frame.outline(corners).exterior().clone();
                let holes = holes.iter().map(|hole| ring(hole)).collect();
                let area = Polygon::new(ring(polygon), holes);
                let bounds = area.bounding_rect()?;
                let (low, high) = (bounds.min().x_y(), bounds.max().x_y());
                let holds = |at: EastNorth| area.contains(&Point::new(at.east_m, at.north_m));
                Self::within((low, high), sight_m, holds, world)
            }
            SweepShape::Corridor { line, width_m } => {
                let line: Vec<EastNorth> = line.iter().map(|at| world.frame.to_plan(*at)).collect();
                let half_m = width_m / 2.0;
                let east = line.iter().map(|at| at.east_m);
                let north = line.iter().map(|at| at.north_m);
                let low = |values: &mut dyn Iterator<Item = f64>| {
                    values.fold(f64::INFINITY, f64::min) - half_m
                };
                let high = |values: &mut dyn Iterator<Item = f64>| {
                    values.fold(f64::NEG_INFINITY, f64::max) + half_m
                };
                let low = (low(&mut east.clone()), low(&mut north.clone()));
                let high = (high(&mut east.clone()), high(&mut north.clone()));
                Self::within(
                    (low, high),
                    sight_m,
                    |at| is_in_strip(&line, half_m, at),
                    world,
                )
            }
            SweepShape::Search(_) => None,
        }
    }

    fn within(
        (low, high): ((f64, f64), (f64, f64)),
        sight_m: f64,
        holds: impl Fn(EastNorth) -> bool + Sync,
        world: &World,
    ) -> Option<Self> {
        let box_m2 = (high.0 - low.0) * (high.1 - low.1);
        let min_m = (box_m2 / MAX_CELLS).sqrt().max(MIN_SIDE_M);
        let side_m = (sight_m / CELLS_PER_SIGHT).max(min_m);
        let middles = |low: f64, high: f64| {
            let count = whole((high - low) / side_m) + 1;
            (0..count).map(move |index| low + (f64::from(index) + 0.5) * side_m)
        };
        let norths: Vec<f64> = middles(low.1, high.1).collect();
        let row = |&north_m: &f64| -> Option<Vec<Cell>> {
            let at = middles(low.0, high.0).map(|east_m| EastNorth { east_m, north_m });
            let cells = at.filter(|at| holds(*at)).map(|at| {
                let ground = world.terrain.height_at(&world.frame, at).ok()?;
                let ground_m = ground.0;
                Some(Cell { at, ground_m })
            });
            cells.collect()
        };
        let found: Vec<Vec<Cell>> = norths.par_iter().map(row).collect::<Option<_>>()?;
        let mut rows = vec![0];
        for row in &found {
            rows.push(rows[rows.len() - 1] + row.len());
        }
        Some(Self {
            cells: found.concat(),
            rows,
            side_m,
            first_north_m: low.1 + 0.5 * side_m,
        })
    }

    /// Indices of the cells that are no further than `reach_m` from a leg, sideways and beyond its
    /// ends.
    pub(super) fn near(
        &self,
        from: EastNorth,
        to: EastNorth,
        reach_m: f64,
    ) -> impl Iterator<Item = usize> + '_ {
        let length_m = from.distance_m(to).max(1e-9);
        let (de, dn) = (
            (to.east_m - from.east_m) / length_m,
            (to.north_m - from.north_m) / length_m,
        );
        let row_of = |north_m: f64| whole(((north_m - self.first_north_m) / self.side_m).max(0.0));
        let last = u32::try_from(self.rows.len() - 1).unwrap_or(u32::MAX);
        let first_row = row_of(from.north_m.min(to.north_m) - reach_m)
            .saturating_sub(1)
            .min(last);
        let last_row = (row_of(from.north_m.max(to.north_m) + reach_m) + 1).min(last);
        let [west_m, east_m] = [
            from.east_m.min(to.east_m) - reach_m,
            from.east_m.max(to.east_m) + reach_m,
        ];
        (first_row..last_row).flat_map(move |row| {
            let row = row as usize;
            let cells = &self.cells[self.rows[row]..self.rows[row + 1]];
            let (mut low_m, mut high_m) = (west_m, east_m);
            if let (Some(cell), true) = (cells.first(), dn.abs() > 1e-3) {
                // Sideways distance is (e - e0) dn - (n - n0) de.
                let middle_m = from.east_m + (cell.at.north_m - from.north_m) * de / dn;
                let half_m = reach_m / dn.abs();
                (low_m, high_m) = (low_m.max(middle_m - half_m), high_m.min(middle_m + half_m));
            }
            let begin = cells.partition_point(|cell| cell.at.east_m < low_m);
            let end = cells.partition_point(|cell| cell.at.east_m <= high_m);
            (begin..end.max(begin)).map(move |index| self.rows[row] + index)
        })
    }
}

/// Whether a place is within a strip along a line, which ends square at both ends.
fn is_in_strip(line: &[EastNorth], half_m: f64, at: EastNorth) -> bool {
    let point = |at: EastNorth| [at.east_m, at.north_m];
    let legs = line.len() - 1;
    line.windows(2).enumerate().any(|(leg, pair)| {
        let (from, to) = (pair[0], pair[1]);
        let length_m = from.distance_m(to);
        let along = ((at.east_m - from.east_m) * (to.east_m - from.east_m)
            + (at.north_m - from.north_m) * (to.north_m - from.north_m))
            / length_m;
        let is_beyond = (leg == 0 && along < 0.0) || (leg + 1 == legs && along > length_m);
        !is_beyond && point_segment_distance(point(at), point(from), point(to)) <= half_m
    })
}

/// For each cell the number of passes that see it as often as the sensor is to, from no higher
/// than pictures of the height asked for allow.
#[must_use]
pub fn seen_by(cells: &Cells, sensor: &Sensor, agl_m: f64, passes: &[Pass]) -> Vec<u32> {
    let of_pass = |pass: &Pass| seen_from(cells, sensor, agl_m, pass);
    let each: Vec<Vec<usize>> = passes.par_iter().map(of_pass).collect();
    let mut counts = vec![0; cells.cells.len()];
    for cell in each.concat() {
        counts[cell] += 1;
    }
    counts
}

/// The cells that one pass sees often enough.
fn seen_from(cells: &Cells, sensor: &Sensor, agl_m: f64, pass: &Pass) -> Vec<usize> {
    let max_above_m = MAX_ABOVE * agl_m;
    let along = sensor.along.map_or(0.0, |(tangent, _)| tangent);
    let reach_m = max_above_m * sensor.across.max(along);
    let mut pictures: std::collections::BTreeMap<usize, (f64, f64)> =
        std::collections::BTreeMap::new();
    let last = pass.legs.len().saturating_sub(1);
    for (number, &(from, to)) in pass.legs.iter().enumerate() {
        let leg = Leg::new(from, to);
        for index in cells.near(from.at, to.at, reach_m) {
            let Some((first_m, last_m)) = leg.sees(&cells.cells[index], sensor, max_above_m) else {
                continue;
            };
            let highest_m = leg.highest_m(first_m, last_m) - cells.cells[index].ground_m;
            let max_m = sensor.pictures_apart_m(highest_m.max(agl_m));
            if pass.trigger_m > max_m && max_m.is_some() {
                continue;
            }
            let (length_m, count) = pictures.entry(index).or_default();
            *length_m += last_m - first_m;
            let begins = pass.ends[0] && number == 0 && first_m <= 0.0;
            let ends = pass.ends[1] && number == last && last_m >= leg.length_m;
            *count += f64::from(u8::from(begins) + u8::from(ends));
        }
    }
    let needed = f64::from(sensor.pictures());
    let is_enough = |(length_m, count): &(f64, f64)| match (sensor.along, pass.trigger_m) {
        (None, _) => true,
        // Where between two pictures the first one falls is not known.
        (Some(_), Some(trigger_m)) => (length_m / trigger_m + EPSILON).floor() + count >= needed,
        (Some(_), None) => false,
    };
    let enough = pictures.iter().filter(|(_, of)| is_enough(of));
    enough.map(|(index, _)| *index).collect()
}

/// A straight piece of a pass.
pub(super) struct Leg {
    from: PlanPoint,
    length_m: f64,
    /// Direction, east and north.
    pub(super) course: [f64; 2],
    /// Rise over run.
    slope: f64,
}

impl Leg {
    pub(super) fn new(from: PlanPoint, to: PlanPoint) -> Self {
        let length_m = from.at.distance_m(to.at);
        let per_m = 1.0 / length_m.max(1e-9);
        Self {
            from,
            length_m,
            course: [
                (to.at.east_m - from.at.east_m) * per_m,
                (to.at.north_m - from.at.north_m) * per_m,
            ],
            slope: (to.amsl.0 - from.amsl.0) * per_m,
        }
    }

    /// Its greatest altitude on a part of it.
    fn highest_m(&self, first_m: f64, last_m: f64) -> f64 {
        self.from.amsl.0 + (self.slope * first_m).max(self.slope * last_m)
    }

    /// From a place to the leg abeam of it, east and north, metres, and the altitude of the leg there;
    /// none further before its begin and beyond its end than `beyond_m`.
    pub(super) fn abeam(&self, at: EastNorth, beyond_m: f64) -> Option<((f64, f64), f64)> {
        let [east_m, north_m] = [
            at.east_m - self.from.at.east_m,
            at.north_m - self.from.at.north_m,
        ];
        let along_m = east_m * self.course[0] + north_m * self.course[1];
        let away_m = (
            along_m * self.course[0] - east_m,
            along_m * self.course[1] - north_m,
        );
        let amsl_m = self.from.amsl.0 + self.slope * along_m.clamp(0.0, self.length_m);
        let abeam = -beyond_m..=self.length_m + beyond_m;
        abeam.contains(&along_m).then_some((away_m, amsl_m))
    }

    /// From where until where on the leg a cell is seen, metres from its begin.
    fn sees(&self, cell: &Cell, sensor: &Sensor, max_above_m: f64) -> Option<(f64, f64)> {
        if self.length_m < 1e-6 {
            return None;
        }
        let [east_m, north_m] = [
            cell.at.east_m - self.from.at.east_m,
            cell.at.north_m - self.from.at.north_m,
        ];
        let abeam_m = east_m * self.course[0] + north_m * self.course[1];
        let aside_m = (east_m * self.course[1] - north_m * self.course[0]).abs();
        let above_m = self.from.amsl.0 - cell.ground_m;
        let mut span = (0.0, self.length_m);
        // Height above the cell at `u` is above_m + slope u.
        let is_held = at_least((self.slope, above_m), aside_m / sensor.across, &mut span)
            && at_least((-self.slope, -above_m), -max_above_m, &mut span);
        if !is_held {
            return None;
        }
        match sensor.along {
            None => (span.0..=span.1).contains(&abeam_m).then_some(span),
            Some((tangent, _)) => {
                let (ahead, behind) = (tangent * self.slope - 1.0, tangent * self.slope + 1.0);
                let is_held = at_least((ahead, tangent * above_m + abeam_m), 0.0, &mut span)
                    && at_least((behind, tangent * above_m - abeam_m), 0.0, &mut span);
                is_held.then_some(span)
            }
        }
    }
}

/// Narrows a span to where `slope u + value` is at least `least`; whether anything is left.
fn at_least((slope, value): (f64, f64), least: f64, span: &mut (f64, f64)) -> bool {
    if slope.abs() < 1e-12 {
        return value >= least;
    }
    let limit = (least - value) / slope;
    if slope > 0.0 {
        span.0 = span.0.max(limit);
    } else {
        span.1 = span.1.min(limit);
    }
    span.0 <= span.1
}

/// The gaps of an area, the largest first: cells beside each other that `is_missing`.
#[must_use]
pub fn gaps(cells: &Cells, is_missing: &[bool]) -> Vec<Gap> {
    let mut open: Vec<bool> = is_missing.to_vec();
    let mut gaps = Vec::new();
    for first in 0..open.len() {
        if !std::mem::take(&mut open[first]) {
            continue;
        }
        let (mut members, mut next) = (vec![first], 0);
        while let Some(&index) = members.get(next) {
            next += 1;
            let at = cells.cells[index].at;
            let reach_m = 1.1 * cells.side_m;
            for other in cells.near(at, at, reach_m).collect::<Vec<_>>() {
                if std::mem::take(&mut open[other]) {
                    members.push(other);
                }
            }
        }
        gaps.push(gap(cells, &members));
    }
    gaps.sort_by(|one, other| other.area_m2.total_cmp(&one.area_m2));
    gaps
}

fn gap(cells: &Cells, members: &[usize]) -> Gap {
    let at = || members.iter().map(|&index| cells.cells[index].at);
    let extent = |of: fn(&EastNorth) -> f64| {
        let values = at().map(|at| of(&at));
        let least = values.clone().fold(f64::INFINITY, f64::min);
        (least, values.fold(f64::NEG_INFINITY, f64::max))
    };
    let (west_m, east_m) = extent(|at| at.east_m);
    let (south_m, north_m) = extent(|at| at.north_m);
    let middle = EastNorth {
        east_m: f64::midpoint(west_m, east_m),
        north_m: f64::midpoint(south_m, north_m),
    };
    let nearest =
        at().min_by(|one, other| one.distance_m(middle).total_cmp(&other.distance_m(middle)));
    Gap {
        at: nearest.unwrap_or(middle),
        area_m2: f64::from(u32::try_from(members.len()).unwrap_or(u32::MAX))
            * cells.side_m
            * cells.side_m,
        size_m: [
            east_m - west_m + cells.side_m,
            north_m - south_m + cells.side_m,
        ],
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of rows and columns"
)]
fn whole(value: f64) -> u32 {
    value.clamp(0.0, 1e6) as u32
}
