//! What flying costs per kilometre, on a grid: the relaxed problem that homotopy classes
//! and estimates come from.

use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

use super::grid::Grid;
use super::narrow_zones::crossed_nodes;
use crate::geodesy::{EastNorth, PlanPoint};
use crate::world::{Layer, PlanZone, World};

/// A cost per kilometre at every node of a grid, row by row from the south-west.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    pub grid: Grid,
    pub cost: Vec<f64>,
    /// What the rise from node to node costs; none where altitude is free.
    pub rises: Option<Rises>,
    /// The climbs from both ends; none where every place is reached on a straight way.
    pub climbs: Option<Arc<Climbs>>,
}

/// The least that a way from the start, and one from the goal, costs at each node: it is as long as the climb from there
/// to the floor takes. A way that is shorter has to be made longer, by bends or circles.
#[derive(Clone, Debug)]
pub(crate) struct Climbs {
    pub from_start: Vec<f64>,
    pub from_goal: Vec<f64>,
}

/// What it costs to follow a floor that is steeper than a vehicle flies.
#[derive(Clone, Debug)]
pub(crate) struct Rises {
    floor_m: Arc<Vec<f64>>,
    /// Steepest slope, rise over run.
    slope: f64,
    /// Cost of each metre of rise that is too much.
    per_m: f64,
}

impl Rises {
    /// Over a floor, for a vehicle in a layer: what it cannot climb on its way is as dear as a
    /// detour on which it could.
    pub(crate) fn new(floor_m: Vec<f64>, slope: f64, prices: &Prices) -> Self {
        /// Detours in units of the shortest.
        const DETOURS: f64 = 2.0;
        Self {
            floor_m: Arc::new(floor_m),
            slope,
            per_m: DETOURS * prices.length / (1000.0 * slope),
        }
    }

    /// Cost of a straight move between two nodes.
    pub(crate) fn cost(&self, from: usize, to: usize, length_km: f64) -> f64 {
        let rise_m = (self.floor_m[to] - self.floor_m[from]).abs();
        // Not a number where the floor is closed: that has its own price.
        self.per_m * (rise_m - self.slope * length_km * 1000.0).max(0.0)
    }
}

/// How the objective prices the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prices {
    /// Cost per kilometre of path.
    pub length: f64,
    /// Cost per kilometre of path and kilometre of altitude.
    pub altitude: f64,
    /// Whether that altitude counts from the minimum height over ground or from the sea.
    pub above_ground: bool,
    /// Cost per kilometre inside a threat: at the axis, and how much less at the rim.
    pub threat: (f64, f64),
    /// Cost per kilometre where flying is not allowed at all.
    pub closed: f64,
}

/// What one vehicle may fly over, at the nodes of a grid.
#[derive(Clone, Debug)]
pub(crate) struct Relief {
    pub grid: Grid,
    /// The lowest altitude allowed; NaN where there is none.
    floor_m: Vec<f64>,
    /// The minimum height over ground, from which altitude costs: below the floor over a zone.
    base_m: Vec<f64>,
    /// What threats cost per kilometre.
    threats: Vec<f64>,
    /// What closed places cost per kilometre.
    closed: Vec<f64>,
}

/// How threats and zones meet the nodes of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reading {
    /// Nothing is overlooked: small discs grow until they meet a node, thin zones reach to
    /// those beside them.
    Conservative,
    /// No disc is overrated: a node counts as if it lay half a cell further out.
    Optimistic,
}

impl Relief {
    /// Samples a world.
    pub(crate) fn new(
        (world, layer): (&World, Layer),
        grid: Grid,
        prices: &Prices,
        reading: Reading,
    ) -> Self {
        let mut floor_m = Vec::with_capacity(grid.len());
        let mut threats = Vec::with_capacity(grid.len());
        let mut closed = Vec::with_capacity(grid.len());
        let mut floors = floors((world, layer), &grid);
        if reading == Reading::Conservative {
            for zone in &world.zones {
                for node in crossed_nodes(&grid, zone) {
                    let at = grid.at(node);
                    floors[node] =
                        floors[node].and_then(|floor_m| past(zone, at, floor_m, (world, layer)));
                }
            }
        }
        for (node, floor) in floors.into_iter().enumerate() {
            let at = grid.at(node);
            let of_threats: f64 = world
                .threats
                .iter()
                .map(|threat| {
                    let (smallest_m, further_m) = match reading {
                        Reading::Conservative => (0.75 * grid.spacing_m, 0.0),
                        Reading::Optimistic => (0.0, FRAC_1_SQRT_2 * grid.spacing_m),
                    };
                    let radius_m = threat.radius_m.max(smallest_m);
                    if at.is_beyond(threat.center, radius_m) {
                        return 0.0;
                    }
                    let share = (at.distance_m(threat.center) + further_m) / radius_m;
                    if share < 1.0 {
                        prices.threat.0 - prices.threat.1 * share
                    } else {
                        0.0
                    }
                })
                .sum();
            let is_closed =
                floor.is_none() || (reading == Reading::Conservative && !world.in_area(at));
            floor_m.push(floor.unwrap_or(f64::NAN));
            threats.push(of_threats);
            closed.push(if is_closed { prices.closed } else { 0.0 });
        }
        Self {
            floor_m,
            base_m: base_m(world, &grid),
            threats,
            closed,
            grid,
        }
    }

    /// Of lowest altitudes (NaN where there is none) and what closed places cost, without threats.
    pub(crate) fn of(world: &World, grid: Grid, floor_m: Vec<f64>, closed: Vec<f64>) -> Self {
        Self {
            base_m: base_m(world, &grid),
            threats: vec![0.0; grid.len()],
            grid,
            floor_m,
            closed,
        }
    }

    /// A field of this relief without its threats.
    pub(crate) fn ground(&self, field: &Field) -> Field {
        let costs = field.cost.iter().zip(&self.threats);
        Field {
            grid: field.grid.clone(),
            cost: costs.map(|(cost, threats)| cost - threats).collect(),
            rises: None,
            climbs: None,
        }
    }

    /// The cost of flying as low as a slope limit (rise over run) allows, which makes
    /// valleys beside steep ridges high too.
    pub(crate) fn field(&self, slope: f64, prices: &Prices) -> Field {
        let altitude_m = if slope.is_finite() {
            self.dilated(slope)
        } else {
            self.floor_m.clone()
        };
        let cost = altitude_m
            .iter()
            .zip(&self.base_m)
            .zip(self.threats.iter().zip(&self.closed))
            .map(|((&altitude_m, &base_m), (threats, closed))| {
                let counted_m = if prices.above_ground {
                    altitude_m - base_m
                } else {
                    altitude_m
                };
                let counted_m = if counted_m.is_nan() {
                    0.0
                } else {
                    counted_m.max(0.0)
                };
                prices.length + (threats + closed) + prices.altitude * counted_m / 1000.0
            })
            .collect();
        Field {
            grid: self.grid.clone(),
            cost,
            rises: None,
            climbs: None,
        }
    }

    /// The climbs from a start and a goal, each with its altitude, metres, and the steepest way up from it, rise over run.
    pub(crate) fn climbs(
        &self,
        [start, goal]: [(PlanPoint, f64); 2],
        prices: &Prices,
    ) -> Option<Climbs> {
        let mut is_beyond = false;
        let mut from = |(end, slope): (PlanPoint, f64)| -> Vec<f64> {
            let least = |(node, floor_m): (usize, &f64)| {
                let climb_m = (floor_m - end.amsl.0).max(0.0) / slope;
                is_beyond |= climb_m > self.grid.at(node).distance_m(end.at);
                prices.length * climb_m / 1000.0
            };
            self.floor_m.iter().enumerate().map(least).collect()
        };
        let climbs = Climbs {
            from_start: from(start),
            from_goal: from(goal),
        };
        is_beyond.then_some(climbs)
    }

    /// What a slope limit costs in a layer over the floor.
    pub(crate) fn rises(&self, layer: Layer, slope: f64, prices: &Prices) -> Option<Rises> {
        let is_limited = layer.max_agl_m.is_finite() && slope > 0.0 && prices.length > 0.0;
        is_limited.then(|| Rises::new(self.floor_m.clone(), slope, prices))
    }

    /// The floor raised wherever the slope limit forbids to dive to it: two chamfer
    /// sweeps of `z_i = max(z_i, z_j - slope |ij|)`.
    fn dilated(&self, slope: f64) -> Vec<f64> {
        let mut altitude_m = self.floor_m.clone();
        dilate(&self.grid, slope, &mut altitude_m);
        altitude_m
    }
}

/// Raises the values at the nodes of a grid to `z_i = max(z_i, z_j - slope |ij|)`; those that are
/// no number stay so, and raise none.
pub(crate) fn dilate(grid: &Grid, slope: f64, values: &mut [f64]) {
    let drop_m = slope * grid.spacing_m;
    let diagonal_m = drop_m * std::f64::consts::SQRT_2;
    let before = [
        ((-1, 0), drop_m),
        ((0, -1), drop_m),
        ((-1, -1), diagonal_m),
        ((1, -1), diagonal_m),
    ];
    let mut relax = |node: usize, sign: isize| {
        for ((columns, rows), drop_m) in before {
            if let Some(other) = grid.step(node, (sign * columns, sign * rows)) {
                // f64::max ignores NaN, so voids stay out of it.
                let reach_m = values[other] - drop_m;
                if reach_m > values[node] {
                    values[node] = reach_m;
                }
            }
        }
    };
    for node in 0..grid.len() {
        relax(node, 1);
    }
    for node in (0..grid.len()).rev() {
        relax(node, -1);
    }
}

/// The minimum height over ground at the nodes of a grid, metres above the sea.
fn base_m(world: &World, grid: &Grid) -> Vec<f64> {
    (0..grid.len())
        .map(|node| world.ground.height_m(grid.at(node)) + world.min_agl.0)
        .collect()
}

/// The lowest altitude allowed at the nodes of a grid, as [`floor_at`] has it.
fn floors((world, layer): (&World, Layer), grid: &Grid) -> Vec<Option<f64>> {
    let mut floors = Vec::with_capacity(grid.len());
    let (west_m, east_m) = (grid.at(0).east_m, grid.at(grid.columns - 1).east_m);
    let within = world.zones.iter();
    let within: Vec<&PlanZone> = within
        .filter(|zone| zone.meets_east(west_m, east_m))
        .collect();
    for row in 0..grid.rows {
        let nodes = row * grid.columns..(row + 1) * grid.columns;
        let north_m = grid.at(nodes.start).north_m;
        let zones = within.iter().filter(|zone| zone.spans_north(north_m));
        let zones: Vec<&PlanZone> = zones.copied().collect();
        floors.extend(nodes.map(|node| floor_at((world, layer), &zones, grid.at(node))));
    }
    floors
}

/// The lowest altitude allowed at a place that some zones may hold, metres; `None` where
/// flying is closed, or the ground unknown.
fn floor_at((world, layer): (&World, Layer), zones: &[&PlanZone], at: EastNorth) -> Option<f64> {
    let ground_m = world.ground.height_m(at);
    let mut floor_m = layer.floor_m(ground_m + world.min_agl.0);
    for zone in zones {
        if zone.is_near(at) && zone.holds(at) {
            floor_m = past(zone, at, floor_m, (world, layer))?;
        }
    }
    (floor_m <= layer.ceiling_m(ground_m, world.max_amsl.0)).then_some(floor_m)
}

/// The least altitude allowed from a floor up where a zone is: below the zone if there is room,
/// or else above it; `None` if there is none.
fn past(
    zone: &PlanZone,
    at: EastNorth,
    floor_m: f64,
    (world, layer): (&World, Layer),
) -> Option<f64> {
    let ground_m = world.ground.height_m(at);
    let (from_m, below_m) = zone.closed_m(ground_m);
    let floor_m = if floor_m < from_m {
        floor_m
    } else {
        floor_m.max(below_m)
    };
    (floor_m <= layer.ceiling_m(ground_m, world.max_amsl.0)).then_some(floor_m)
}
