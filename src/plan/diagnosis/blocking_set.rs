//! Blocking sets: obstacles that provably close every path between two points.

use geo::Polygon;

use crate::geodesy::{Agl, EastNorth};
use crate::numeric::barrier::{Capsule, Chains};
use crate::numeric::geometry::Point;
use crate::spec::{MissionSpec, Placement};
use crate::world::{Ground, PlanZone, World};

/// An obstacle that no vehicle may fly through, at any height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockingElement {
    /// The threat of this index.
    Threat(usize),
    /// The zone of this index.
    Zone(usize),
    /// The edge of the area.
    Edge,
    /// Ground that leaves no room under the ceiling.
    Ground,
    /// Ground of unknown height.
    Void,
}

impl BlockingElement {
    /// What it is called: a threat or zone by its id.
    #[must_use]
    pub fn name(self, spec: &MissionSpec) -> String {
        let buffers = &spec.buffers;
        let named = |kind: &str, id: Option<&String>| match id {
            Some(id) => format!("{kind} {id}"),
            None => kind.to_owned(),
        };
        match self {
            Self::Threat(index) => named("threat", spec.threats.get(index).map(|of| &of.id)),
            Self::Zone(index) => named("zone", spec.no_fly.get(index).map(|of| &of.id)),
            Self::Edge => "the edge of the area".to_owned(),
            Self::Ground => format!(
                "ground less than {} m under the ceiling",
                spec.area.min_agl.0 + buffers.terrain_m + buffers.ceiling_m
            ),
            Self::Void => "ground of unknown height".to_owned(),
        }
    }
}

/// All that nobody may fly through, whatever a vehicle can do: what of it touches each other
/// may close every way between two places.
///
/// A proof, on the ground as the search reads it. Walls may be as thin as they like.
#[derive(Debug)]
pub struct BlockingSets {
    /// What each piece is of.
    of: Vec<BlockingElement>,
    chains: Chains,
}

impl BlockingSets {
    /// Of a world.
    #[must_use]
    pub fn of(world: &World) -> Self {
        let mut pieces = Vec::new();
        for (index, disc) in world.threats.iter().enumerate() {
            let piece = Capsule::disc(point(disc.center), disc.radius_m);
            pieces.push((BlockingElement::Threat(index), piece));
        }
        for (index, zone) in world.zones.iter().enumerate() {
            // What may be open at some time, or over or under which there may be a way, proves nothing.
            let is_always_closed = zone.is_whole && zone.active_s.is_none();
            if is_always_closed && leaves_no_room(world, zone) {
                let edges = edges(&zone.outline, zone.buffer_m);
                pieces.extend(edges.map(|edge| (BlockingElement::Zone(index), edge)));
            }
        }
        pieces.extend(edges(&world.area, 0.0).map(|edge| (BlockingElement::Edge, edge)));
        // What a coarse grid makes of the ground proves nothing.
        if world.ground.shows(&world.terrain) {
            let highest_m = world.max_amsl.0 - world.min_agl.0;
            pieces.extend(Shores::of(&world.ground, highest_m).pieces());
        }
        let (of, capsules) = pieces.into_iter().unzip();
        Self {
            of,
            chains: Chains::of(capsules),
        }
    }

    /// What closes every way from one place to another, in a row around one of them, each once;
    /// nothing if that is not proven.
    #[must_use]
    pub fn between(&self, from: EastNorth, to: EastNorth) -> Vec<BlockingElement> {
        let chain = self.chains.between(point(from), point(to));
        let mut found: Vec<BlockingElement> = Vec::new();
        for piece in chain.unwrap_or_default() {
            if !found.contains(&self.of[piece]) {
                found.push(self.of[piece]);
            }
        }
        found
    }
}

/// Whether a zone leaves nobody room over or under it, between the least height above ground and the
/// ceiling, or the greatest height above ground that any vehicle may have.
fn leaves_no_room(world: &World, zone: &PlanZone) -> bool {
    let layers = world.layers.iter().map(|layer| layer.max_agl_m);
    let max_agl_m = layers.fold(f64::NEG_INFINITY, f64::max);
    let min_agl_m = world.min_agl.0;
    // Not known where the grid does not show its source.
    let shows = world.ground.shows(&world.terrain);
    let (low_m, high_m) = match shows {
        true => zone.ground_range_m(&world.ground),
        false => (f64::NEG_INFINITY, f64::INFINITY),
    };
    let is_over = match zone.ceiling {
        None => true,
        Some(Placement::Amsl(top)) => top > world.max_amsl || top.0 > high_m + max_agl_m,
        Some(Placement::Agl(Agl(top_m))) => top_m > max_agl_m || low_m + top_m > world.max_amsl.0,
    };
    let is_under = match zone.floor {
        None => true,
        Some(Placement::Amsl(bottom)) => bottom.0 < low_m + min_agl_m,
        Some(Placement::Agl(Agl(bottom_m))) => bottom_m < min_agl_m,
    };
    is_over && is_under
}

fn point(at: EastNorth) -> Point {
    [at.east_m, at.north_m]
}

/// The edges of an outline, with what is within a radius of them, metres.
fn edges(outline: &Polygon<f64>, radius: f64) -> impl Iterator<Item = Capsule> + '_ {
    outline.exterior().lines().map(move |line| {
        let ends = (line.start.x_y().into(), line.end.x_y().into());
        Capsule {
            radius,
            ..Capsule::segment(ends)
        }
    })
}

/// The rims of ground that is closed: too high, or of unknown height.
struct Shores<'a> {
    ground: &'a Ground,
    /// Ground higher than this is too high, metres above the sea.
    highest_m: f64,
}

/// Whether a cell of the ground is closed all over.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Cell {
    Open,
    High,
    Void,
}

impl<'a> Shores<'a> {
    fn of(ground: &'a Ground, highest_m: f64) -> Self {
        Self { ground, highest_m }
    }

    /// The closed parts of the lines between nodes, without those amid closed cells: what
    /// touches these has to get there first.
    fn pieces(&self) -> Vec<(BlockingElement, Capsule)> {
        let (columns, rows) = (self.ground.columns, self.ground.rows);
        let mut pieces = Vec::new();
        for row in 0..rows {
            for column in 0..columns {
                if column + 1 < columns {
                    let sides = [(column, row.wrapping_sub(1)), (column, row)];
                    pieces.extend(self.piece((column, row), (column + 1, row), sides));
                }
                if row + 1 < rows {
                    let sides = [(column.wrapping_sub(1), row), (column, row)];
                    pieces.extend(self.piece((column, row), (column, row + 1), sides));
                }
            }
        }
        pieces
    }

    /// The closed part of the line between two nodes, `sides` which these cells lie.
    fn piece(
        &self,
        from: (usize, usize),
        to: (usize, usize),
        sides: [(usize, usize); 2],
    ) -> Option<(BlockingElement, Capsule)> {
        let sides = sides.map(|(column, row)| self.cell(column, row));
        if !sides.contains(&Cell::Open) {
            return None;
        }
        let (start, end) = (self.at(from), self.at(to));
        if sides.contains(&Cell::Void) {
            return Some((BlockingElement::Void, Capsule::segment((start, end))));
        }
        // Between nodes the ground is straight.
        let (low, high) = (self.above_m(from), self.above_m(to));
        let share = low / (low - high);
        let level = [0, 1].map(|axis| start[axis] + share * (end[axis] - start[axis]));
        let closed = match (low > 0.0, high > 0.0) {
            (true, true) => (start, end),
            (true, false) => (start, level),
            (false, true) => (end, level),
            (false, false) => return None,
        };
        Some((BlockingElement::Ground, Capsule::segment(closed)))
    }

    /// How far a node is too high, metres; not a number where there are no data.
    fn above_m(&self, (column, row): (usize, usize)) -> f64 {
        let height_m = self.ground.heights_m[row * self.ground.columns + column];
        f64::from(height_m) - self.highest_m
    }

    fn cell(&self, column: usize, row: usize) -> Cell {
        if column >= self.ground.columns - 1 || row >= self.ground.rows - 1 {
            return Cell::Open;
        }
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
        let above_m = corners.map(|(east, north)| self.above_m((column + east, row + north)));
        if above_m.iter().any(|above_m| above_m.is_nan()) {
            Cell::Void
        } else if above_m.iter().all(|above_m| *above_m > 0.0) {
            Cell::High
        } else {
            Cell::Open
        }
    }

    fn at(&self, (column, row): (usize, usize)) -> Point {
        #[expect(clippy::cast_precision_loss, reason = "at most a few thousand")]
        let (column, row) = (column as f64, row as f64);
        let ground = self.ground;
        [
            ground.south_west.east_m + column * ground.spacing_m,
            ground.south_west.north_m + row * ground.spacing_m,
        ]
    }
}
