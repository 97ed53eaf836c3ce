//! Corridors: homotopy classes through free space alone, for routes where the soft fields find no
//! path.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::classes_of_fields;
use super::field::Field;
use super::free_space::{FreeSpace, Passing};
use super::grid::Grid;
use super::narrow_zones;
use super::obstacles::Obstacles;
use super::routes::HomotopyClasses;
use crate::path::VehicleLimits;
use crate::plan::route_context::RouteContext;

/// Nodes along the longer side of the area, coarse to fine: the first that lets a path through.
const NODES: [usize; 2] = [321, 961];
/// Distance that paths keep from walls where they can, in turn radii: a spline needs space to
/// bend, but where that space is a detour the nearer path is better.
const BERTHS: [f64; 2] = [1.5, 0.4];
/// What closed ground costs per kilometre while fits are drawn tight: a wall that slopes.
const STEEP: f64 = 1000.0;
/// Cells that a gap is wide where a grid shows it.
const GAP_CELLS: f64 = 2.0;
/// Most classes.
const MAX_CLASSES: usize = 24;

/// The classes that free space allows, cheapest first; none if there is no path.
pub(crate) fn corridors(context: &RouteContext<'_>) -> Option<HomotopyClasses> {
    (NODES.iter()).find_map(|&nodes| corridors_at(context, nodes, Passing::Any))
}

/// The same on a grid that shows the narrowest gap between zones, where only some of those with a
/// floor or a ceiling are passed; each class once.
pub(crate) fn corridors_of_gaps(
    context: &RouteContext<'_>,
    passing: Passing,
) -> Option<HomotopyClasses> {
    let frame = context.frame();
    let corners = (frame.south_west, frame.north_east);
    let margins_m = 2.0 * context.margins.threat_m;
    let gap_m = narrow_zones::narrowest_gap_m(context.world, corners, margins_m) - margins_m;
    let is_shown = |nodes: &&usize| {
        let grid = Grid::over(corners.0, corners.1, **nodes);
        gap_m >= GAP_CELLS * grid.spacing_m
    };
    let first = NODES.iter().find(is_shown);
    let nodes = *first.or(NODES.last())?;
    let mut found = corridors_at(context, nodes, passing)?;
    let mut seen = BTreeSet::new();
    (found.classes).retain(|class| seen.insert(class.signature));
    Some(found)
}

fn corridors_at(
    context: &RouteContext<'_>,
    nodes: usize,
    passing: Passing,
) -> Option<HomotopyClasses> {
    let (start, goal) = context.ends_at();
    let frame = context.frame();
    let grid = Grid::over(frame.south_west, frame.north_east, nodes);
    let cell_m = grid.spacing_m;
    let radius_m = VehicleLimits::of(context.vehicle()).turn_radius_m;
    let berths_m = BERTHS.map(|radii| (radii * radius_m).max(2.0 * cell_m));
    let reach_m = berths_m
        .iter()
        .fold(0.0, |most: f64, berth_m| most.max(*berth_m));
    let space = FreeSpace::new(context, (grid, reach_m), passing);
    if !space.connects(start, goal) {
        return None;
    }
    let fields: Vec<Field> = berths_m
        .par_iter()
        .map(|berth_m| space.field(context, context.slope(), *berth_m))
        .collect();
    let obstacles = Obstacles::of(&fields, start, goal);
    let mut classes = classes_of_fields((&fields, false), &obstacles, start, goal);
    classes.retain(|class| space.is_free(class.cost));
    classes.truncate(MAX_CLASSES);
    let grounds = fields.into_iter().map(|field| Field {
        cost: field.cost.iter().map(|cost| cost.min(STEEP)).collect(),
        grid: field.grid,
        rises: None,
        climbs: None,
    });
    (!classes.is_empty()).then(|| HomotopyClasses {
        classes,
        grounds: grounds.collect(),
        tight_m: Some(cell_m.max(0.25 * radius_m)),
    })
}
