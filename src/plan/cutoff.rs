//! Whether there is any way at all between two places.

use geo::{BoundingRect, Contains, Rect, coord};

use crate::geodesy::EastNorth;
use crate::world::{PlanZone, World};

/// The parts of a world between which nobody can fly, whatever a vehicle can do: threats, zones
/// and ground that leaves no room under the ceiling lie between them.
///
/// A proof on the ground as the search reads it: its cells are cut into smaller ones, and such a
/// cell is closed only where all of it is. What leads past a corner is open.
#[derive(Debug)]
pub struct Parts {
    south_west: EastNorth,
    spacing_m: f64,
    columns: usize,
    rows: usize,
    /// The number of its part for each cell, row by row; 0 where it is closed.
    part: Vec<usize>,
}

/// Cells along the longer side at least, as far as whole cells of the ground allow.
const CELLS: usize = 2048;

impl Parts {
    /// Of a world.
    #[must_use]
    pub fn of(world: &World) -> Self {
        let ground = &world.ground;
        let (columns, rows) = (ground.columns - 1, ground.rows - 1);
        let finer = (CELLS / columns.max(rows)).max(1);
        let mut parts = Self {
            south_west: ground.south_west,
            spacing_m: ground.spacing_m / count(finer),
            columns: columns * finer,
            rows: rows * finer,
            part: vec![0; columns * rows * finer * finer],
        };
        let cells = parts.part.len();
        let is_open: Vec<bool> = (0..cells)
            .map(|cell| !parts.is_closed(world, cell))
            .collect();
        let mut number = 0;
        for cell in 0..cells {
            if is_open[cell] && parts.part[cell] == 0 {
                number += 1;
                parts.fill(cell, number, &is_open);
            }
        }
        parts
    }

    /// Whether no way leads from one place to another. A place in a closed cell is part of
    /// every part beside it.
    #[must_use]
    pub fn are_apart(&self, from: EastNorth, to: EastNorth) -> bool {
        let (from, to) = (self.cell_at(from), self.cell_at(to));
        let (here, there) = (self.around(from), self.around(to));
        from != to && !here.iter().any(|part| there.contains(part))
    }

    fn cell_at(&self, at: EastNorth) -> usize {
        let index = |offset_m: f64, cells: usize| {
            let cell = (offset_m / self.spacing_m).floor().max(0.0);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "cut off at the last cell"
            )]
            let cell = cell as usize;
            cell.min(cells - 1)
        };
        let column = index(at.east_m - self.south_west.east_m, self.columns);
        let row = index(at.north_m - self.south_west.north_m, self.rows);
        row * self.columns + column
    }

    /// The parts that a cell belongs to or, if it is closed, lies beside.
    fn around(&self, cell: usize) -> Vec<usize> {
        if self.part[cell] > 0 {
            return vec![self.part[cell]];
        }
        let beside = self.beside(cell);
        beside
            .map(|cell| self.part[cell])
            .filter(|part| *part > 0)
            .collect()
    }

    /// Up to eight cells that share a side or a corner with one.
    fn beside(&self, cell: usize) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        let (row, column) = (cell / columns, cell % columns);
        let near = |at: usize, count: usize| at.saturating_sub(1)..=(at + 1).min(count - 1);
        near(row, rows)
            .flat_map(move |row| near(column, columns).map(move |column| row * columns + column))
            .filter(move |other| *other != cell)
    }

    fn fill(&mut self, from: usize, number: usize, is_open: &[bool]) {
        let mut ahead = vec![from];
        self.part[from] = number;
        while let Some(cell) = ahead.pop() {
            for other in self.beside(cell) {
                if is_open[other] && self.part[other] == 0 {
                    self.part[other] = number;
                    ahead.push(other);
                }
            }
        }
    }

    /// Whether nobody can be anywhere in a cell, at any height.
    fn is_closed(&self, world: &World, cell: usize) -> bool {
        let corners = self.corners(cell);
        let [from, ..] = corners;
        let is_outside = |area: Rect| from.east_m > area.max().x || from.north_m > area.max().y;
        // The ground begins where the area does, and may end after it.
        if world.area.bounding_rect().is_some_and(is_outside) {
            return true;
        }
        // Bilinear ground is nowhere lower than at its lowest corner; of no data nothing is proven.
        let is_too_high =
            |at: &EastNorth| world.ground.height_m(*at) + world.min_agl.0 > world.max_amsl.0;
        if corners.iter().all(is_too_high) {
            return true;
        }
        let mut threats = world.threats.iter();
        // A disc that holds the corners of a cell holds the cell.
        if threats.any(|disc| corners.iter().all(|at| disc.contains(*at))) {
            return true;
        }
        let mut zones = world.zones.iter();
        zones.any(|zone| is_in_zone(zone, world, &corners))
    }

    /// South-west, south-east, north-west, north-east.
    fn corners(&self, cell: usize) -> [EastNorth; 4] {
        let (row, column) = (cell / self.columns, cell % self.columns);
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(east, north)| EastNorth {
            east_m: self.south_west.east_m + count(column + east) * self.spacing_m,
            north_m: self.south_west.north_m + count(row + north) * self.spacing_m,
        })
    }
}

/// A number of cells as a number.
#[expect(clippy::cast_precision_loss, reason = "a few thousand a side")]
fn count(cells: usize) -> f64 {
    cells as f64
}

/// Whether a zone that is closed up to the ceiling holds a cell, given by its corners.
fn is_in_zone(zone: &PlanZone, world: &World, corners: &[EastNorth; 4]) -> bool {
    let reaches_up = zone.below.is_none_or(|below| below > world.max_amsl);
    let [from, .., to] = *corners;
    reaches_up
        && zone.contains(from)
        && zone.outline.contains(&Rect::new(
            coord! {x: from.east_m, y: from.north_m},
            coord! {x: to.east_m, y: to.north_m},
        ))
}
