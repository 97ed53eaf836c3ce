//! One leg of one vehicle's plan, and what its search needs to know of it.

use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, Ordering};

use geo::BoundingRect;

use super::search_options::SearchOptions;
use super::spline::{Frame, Spline};
use crate::cost::{CostModel, EarlierFlights, Margins, RouteEnds};
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::bspline::uniform_parameters;
use crate::path::VehicleLimits;
use crate::plan::altitude::floor::{FloorMaker, Slopes};
use crate::plan::classes::field::Prices;
use crate::spec::{MissionSpec, Objective, Vehicle};
use crate::world::{Layer, World};

/// A spec whose paths have `free` control points between their ends.
pub(crate) fn with_free_controls(spec: &MissionSpec, free: usize) -> Cow<'_, MissionSpec> {
    if spec.planner.control_points == free {
        return Cow::Borrowed(spec);
    }
    let mut spec = spec.clone();
    spec.planner.control_points = free;
    Cow::Owned(spec)
}

/// A spec whose vehicle has the speed of one of its routes ([`Vehicle::on_route`]).
pub(crate) fn on_route(spec: &MissionSpec, index: usize, route: usize) -> Cow<'_, MissionSpec> {
    match spec.vehicles[index].on_route(route) {
        Cow::Borrowed(_) => Cow::Borrowed(spec),
        Cow::Owned(vehicle) => {
            let mut spec = spec.clone();
            spec.vehicles[index] = vehicle;
            Cow::Owned(spec)
        }
    }
}

/// Share of the straight distance that routes may swing out, before the whole area is
/// looked at.
const NEAR: f64 = 0.75;

/// From where to where one vehicle is to fly, among which earlier flights.
#[derive(Clone, Copy)]
pub(crate) struct RouteContext<'a> {
    pub world: &'a World,
    pub spec: &'a MissionSpec,
    pub index: usize,
    pub ends: RouteEnds,
    pub earlier: &'a EarlierFlights,
    pub margins: Margins,
    /// Parameters at which the path is sampled besides the even ones.
    pub extra: &'a [f64],
    pub options: SearchOptions,
    /// Whether decoded altitudes are over zones from edge to edge, between samples too.
    pub at_edges: bool,
    /// Set once the search is to end.
    pub cancel: Option<&'a AtomicBool>,
}

impl<'a> RouteContext<'a> {
    /// Whether the search is to end.
    pub(crate) fn is_cancelled(&self) -> bool {
        (self.cancel).is_some_and(|cancel| cancel.load(Ordering::Relaxed))
    }

    /// The same without a margin to what is closed in the plane, over and under zones from edge to edge: for lines that
    /// are exact.
    pub(crate) fn as_exact(&self) -> Self {
        Self {
            margins: Margins {
                threat_m: 0.0,
                ..self.margins
            },
            extra: &[],
            at_edges: true,
            ..*self
        }
    }

    /// The vehicle that flies it.
    pub(crate) fn vehicle(&self) -> &'a Vehicle {
        &self.spec.vehicles[self.index]
    }

    /// Its limits of altitude besides the least height above ground and the ceiling.
    pub(crate) fn layer(&self) -> Layer {
        self.world.layer(self.index)
    }

    /// Its ends in the plane.
    pub(crate) fn ends_at(&self) -> (EastNorth, EastNorth) {
        (self.ends.from.at, self.ends.to.at)
    }

    /// Control points of the spline, ends included.
    pub(crate) fn controls(&self) -> usize {
        self.spec.planner.control_points + 2
    }

    /// Samples of the search: those of the spec, but not so few that a spline could hide
    /// its bends between them. The paper's sums depend on their number, which so stays.
    pub(crate) fn samples(&self) -> usize {
        let planner = &self.spec.planner;
        match planner.objective {
            Objective::Operational => planner.samples.max(3 * self.controls()),
            Objective::Paper => planner.samples,
        }
    }

    /// Even parameters and the extra ones, in order.
    pub(crate) fn parameters(&self, samples: usize) -> Vec<f64> {
        let mut parameters = uniform_parameters(samples);
        parameters.extend(
            self.extra
                .iter()
                .copied()
                .filter(|u| (0.0..=1.0).contains(u)),
        );
        parameters.sort_by(f64::total_cmp);
        parameters.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        parameters
    }

    /// The objective, sampled at some parameters.
    pub(crate) fn model(&self, margins: Margins, parameters: &[f64]) -> CostModel {
        CostModel::new(
            self.world,
            self.spec,
            self.index,
            self.ends,
            self.earlier,
            margins,
            parameters,
        )
    }

    /// What the altitude has to clear, and `above_m` more, with slope limits smaller by
    /// `climb_fraction`.
    pub(crate) fn floor(&self, above_m: f64, climb_fraction: f64) -> FloorMaker<'a> {
        /// Keeps rounding from turning a limit that is met into one that is broken.
        const TOLERANCE: f64 = 1e-3;
        let margins = Margins {
            clearance_m: self.margins.clearance_m + above_m,
            under_m: self.margins.under_m + above_m,
            ..self.margins
        };
        let layer = self.layer();
        let floor = FloorMaker::new(
            (self.world, layer),
            margins.within_m(layer.max_agl_m - self.world.min_agl.0),
            Slopes::new(
                VehicleLimits::of(self.vehicle()),
                1.0 - climb_fraction - TOLERANCE,
            ),
        );
        match self.at_edges {
            true => floor.over_edges(&self.ends, self.margins.threat_m),
            false => floor.with_margin(&self.ends, self.margins.threat_m),
        }
    }

    /// The smaller of the vehicle's slope limits, at its higher end.
    pub(crate) fn slope(&self) -> f64 {
        let limits = VehicleLimits::of(self.vehicle());
        let high = Amsl(self.ends.from.amsl.0.max(self.ends.to.amsl.0));
        limits.climb.at(high).min(limits.descent.at(high))
    }

    /// The ends of the route with the steepest climb from each, that from the goal flown backwards; none under the
    /// paper's objective, which prices slopes itself.
    pub(crate) fn climbs(&self) -> Option<[(PlanPoint, f64); 2]> {
        let limits = VehicleLimits::of(self.vehicle());
        let (from, to) = (self.ends.from, self.ends.to);
        let high = Amsl(from.amsl.0.max(to.amsl.0));
        let climbs = [(from, limits.climb.at(high)), (to, limits.descent.at(high))];
        (self.spec.planner.objective == Objective::Operational).then_some(climbs)
    }

    /// The box around the area.
    pub(crate) fn frame(&self) -> Frame {
        let corner = |(east_m, north_m): (f64, f64)| EastNorth { east_m, north_m };
        let (from, to) = (self.ends.from.at, self.ends.to.at);
        match self.world.area.bounding_rect() {
            Some(rect) => Frame {
                south_west: corner(rect.min().x_y()),
                north_east: corner(rect.max().x_y()),
            },
            None => Frame {
                south_west: corner((from.east_m.min(to.east_m), from.north_m.min(to.north_m))),
                north_east: corner((from.east_m.max(to.east_m), from.north_m.max(to.north_m))),
            },
        }
    }

    /// The part of the area around start and goal in which good routes are expected.
    pub(crate) fn near_box(&self) -> Frame {
        let whole = self.frame();
        let (from, to) = (self.ends.from.at, self.ends.to.at);
        let reach_m = NEAR * from.distance_m(to);
        let range = |a: f64, b: f64, low: f64, high: f64| {
            (
                (a.min(b) - reach_m).max(low),
                (a.max(b) + reach_m).min(high),
            )
        };
        let (west, east) = range(
            from.east_m,
            to.east_m,
            whole.south_west.east_m,
            whole.north_east.east_m,
        );
        let (south, north) = range(
            from.north_m,
            to.north_m,
            whole.south_west.north_m,
            whole.north_east.north_m,
        );
        Frame {
            south_west: EastNorth {
                east_m: west,
                north_m: south,
            },
            north_east: EastNorth {
                east_m: east,
                north_m: north,
            },
        }
    }

    /// Straight distance from end to end, kilometres.
    pub(crate) fn straight_km(&self) -> f64 {
        self.ends.from.distance_m(self.ends.to) / 1000.0
    }

    /// Control points evenly along the straight line: what an empty budget plans.
    pub(crate) fn straight(&self) -> Spline {
        let (from, to) = (self.ends.from, self.ends.to);
        let last = self.controls() - 1;
        let along = |a: f64, b: f64| {
            (0..=last)
                .map(|j| {
                    #[expect(clippy::cast_precision_loss, reason = "few control points")]
                    let share = j as f64 / last as f64;
                    a + share * (b - a)
                })
                .collect()
        };
        Spline {
            east_m: along(from.at.east_m, to.at.east_m),
            north_m: along(from.at.north_m, to.at.north_m),
            amsl_m: along(from.amsl.0, to.amsl.0),
        }
    }

    /// Proven: no path costs less, because none is shorter than the straight line and no
    /// other term is negative.
    pub(crate) fn bound(&self) -> f64 {
        self.straight_km() * self.spec.planner.weights.length
    }

    /// What the objective costs in the plane.
    pub(crate) fn prices(&self) -> Prices {
        let planner = &self.spec.planner;
        match planner.objective {
            Objective::Operational => Prices {
                length: planner.weights.length,
                altitude: planner.weights.altitude,
                above_ground: true,
                threat: (110.0, 100.0),
                closed: 110.0,
            },
            Objective::Paper => {
                // Sums over samples, as if these were even.
                #[expect(clippy::cast_precision_loss, reason = "hundreds of samples")]
                let per_km = planner.samples as f64 / self.straight_km().max(1e-3);
                Prices {
                    length: planner.weights.length,
                    altitude: planner.weights.altitude * per_km,
                    above_ground: false,
                    threat: (10.0, 5.0),
                    closed: 110.0,
                }
            }
        }
    }
}
