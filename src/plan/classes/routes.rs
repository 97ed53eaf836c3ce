//! The routes of one route: a line in every class, and what the ground under them costs.

use std::sync::Arc;

use rayon::prelude::*;

use super::field::{Field, Reading, Relief};
use super::grid::Grid;
use super::narrow_zones;
use super::obstacles::Obstacles;
use super::{HomotopyClass, classes_of_fields};
use crate::geodesy::EastNorth;
use crate::plan::route_context::RouteContext;
use crate::world::World;

/// A gap between threats of fewer cells than this asks for a grid twice as fine.
const GAP_CELLS: f64 = 3.0;
/// A gap beside a zone of fewer cells than this may be closed by the nodes beside it.
const ZONE_GAP_CELLS: f64 = 2.0;
/// A line through such a gap bends where it is this many cells off the straight.
const TIGHT_CELLS: f64 = 0.5;
/// Evaluations from which on a fine grid pays: a coarse one misses narrow classes.
const FINE: usize = 4000;
/// Most classes.
const MAX_CLASSES: usize = 60;

/// Classes, cheapest first, and the straight line.
pub(crate) struct HomotopyClasses {
    pub classes: Vec<HomotopyClass>,
    /// The fields in which classes were found, without threats; none if none was looked for.
    pub grounds: Vec<Field>,
    /// Only where zones are thin, or the gaps beside them: how far off the straight a bend of a
    /// line is that a path has to follow, metres. Nothing draws it into a gap that it misses.
    pub tight_m: Option<f64>,
}

/// The routes of all three fields, on a grid that suits the budget.
pub(crate) fn homotopy_classes(context: &RouteContext<'_>, budget: usize) -> HomotopyClasses {
    let (start, goal) = (context.ends.from.at, context.ends.to.at);
    if !context.options.classes {
        return HomotopyClasses {
            classes: vec![straight(start, goal, 0)],
            grounds: Vec::new(),
            tight_m: None,
        };
    }
    let nodes = if budget >= FINE { 81 } else { 41 };
    let prices = context.prices();
    let (near, whole) = (context.near_box(), context.frame());
    let search = |south_west, north_east| {
        let corners = (south_west, north_east);
        let (grid, tight_m) = Narrows::of(context, corners).grid(corners, nodes);
        let relief = Relief::new(
            (context.world, context.layer()),
            grid,
            &prices,
            Reading::Conservative,
        );
        let rises = relief.rises(context.layer(), context.slope(), &prices);
        let climbs = context
            .climbs()
            .and_then(|ends| relief.climbs(ends, &prices));
        let climbs = climbs.map(Arc::new);
        let fields: Vec<Field> = (context.options.slope_factors)
            .par_iter()
            .map(|factor| Field {
                rises: rises.clone(),
                climbs: climbs.clone(),
                ..relief.field(factor * context.slope(), &prices)
            })
            .collect();
        // Over flat ground they are all the same.
        let is_one = fields.iter().all(|field| field.cost == fields[0].cost);
        let obstacles = Obstacles::of(if is_one { &fields[..1] } else { &fields }, start, goal);
        let mut found = classes_of_fields((&fields, is_one), &obstacles, start, goal);
        found.truncate(MAX_CLASSES);
        let class = obstacles.signature(&[start, goal]);
        // Straight through a thin wall is short, but no way: it does not stand for those that are.
        let class = class.wrapping_add(u64::from(tight_m.is_some()));
        found.push(straight(start, goal, class));
        HomotopyClasses {
            tight_m,
            classes: found,
            grounds: fields.iter().map(|field| relief.ground(field)).collect(),
        }
    };
    let found = search(near.south_west, near.north_east);
    // Where no way nearby is clean, one far around may be.
    if near != whole && found.classes[0].cost > 2.0 * context.straight_km() {
        return search(whole.south_west, whole.north_east);
    }
    found
}

/// The narrowest things of a box of the map, metres.
struct Narrows {
    between_threats_m: f64,
    zone_m: f64,
    between_zones_m: f64,
}

impl Narrows {
    fn of(context: &RouteContext<'_>, within: (EastNorth, EastNorth)) -> Self {
        let world = context.world;
        Self {
            between_threats_m: narrowest_gap_m(world),
            zone_m: narrow_zones::narrowest_zone_m(world, within),
            // What is narrower lets nobody through.
            between_zones_m: narrow_zones::narrowest_gap_m(
                world,
                within,
                2.0 * context.margins.threat_m,
            ),
        }
    }

    /// A grid over the box that shows them, and [`HomotopyClasses::tight_m`].
    fn grid(&self, corners: (EastNorth, EastNorth), nodes: usize) -> (Grid, Option<f64>) {
        let grid = Grid::over(corners.0, corners.1, nodes);
        let cell_m = grid.spacing_m;
        let narrow_m = ZONE_GAP_CELLS * cell_m;
        let is_tight = self.between_zones_m < narrow_m || self.zone_m < narrow_m;
        let is_narrow = self.between_threats_m < GAP_CELLS * cell_m;
        let finer = match self.between_zones_m {
            gap_m if gap_m < 0.5 * narrow_m => 4,
            gap_m if gap_m < narrow_m || is_narrow => 2,
            _ => 1,
        };
        let tight_m = is_tight.then_some(TIGHT_CELLS * cell_m);
        if finer == 1 {
            return (grid, tight_m);
        }
        let finer = Grid::over(corners.0, corners.1, finer * (nodes - 1) + 1);
        (finer, tight_m)
    }
}

/// The least distance between the rims of two threats that do not touch, metres.
fn narrowest_gap_m(world: &World) -> f64 {
    let mut min_m = f64::INFINITY;
    for (index, one) in world.threats.iter().enumerate() {
        for other in &world.threats[..index] {
            let gap_m = one.center.distance_m(other.center) - one.radius_m - other.radius_m;
            if gap_m > 0.0 {
                min_m = min_m.min(gap_m);
            }
        }
    }
    min_m
}

/// The straight line as a line.
fn straight(start: EastNorth, goal: EastNorth, signature: u64) -> HomotopyClass {
    HomotopyClass {
        signature,
        cost: start.distance_m(goal) / 1000.0,
        line: vec![start, goal],
        field: 0,
    }
}
