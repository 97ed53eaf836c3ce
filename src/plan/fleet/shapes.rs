//! A planned vehicle in other shapes: moved control points, another departure or speed.

use super::vehicle::{path_basis, route, sum};
use super::{Planning, Request};
use crate::cost::{Batch, CostModel, CostTerms, EarlierFlights, Margins, RouteEnds};
use crate::geodesy::PlanPoint;
use crate::numeric::Basis;
use crate::path::route_ends;
use crate::plan::route_context::on_route;
use crate::plan::search::JUDGED_SAMPLES;
use crate::plan::spline::Spline;
use crate::plan::{Route, VehiclePlan};
use crate::spec::{Arrival, MissionSpec, Objective};
use crate::world::World;

/// What a vehicle flies, as far as it can be chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Control points of each route, ends included.
    pub control_points: Vec<Vec<PlanPoint>>,
    /// Takeoff, seconds after T0.
    pub depart_s: f64,
}

/// Makes plans of one vehicle at one speed from shapes, and prices them as if it were alone.
pub struct Shaper<'a> {
    spec: MissionSpec,
    world: &'a World,
    index: usize,
    base: VehiclePlan,
    /// The objective of each route, and the points of its path.
    models: Vec<CostModel>,
    bases: Vec<Basis>,
}

impl<'a> Shaper<'a> {
    /// For the vehicle of an index with the numbers of control points, counts and bounds of a
    /// plan, at a speed, m/s. None under the paper's objective, or where the plan lacks routes.
    #[must_use]
    pub fn new(
        spec: &MissionSpec,
        world: &'a World,
        index: usize,
        base: &VehiclePlan,
        speed_mps: f64,
    ) -> Option<Self> {
        let mut spec = spec.clone();
        let vehicle = spec.vehicles.get_mut(index)?;
        vehicle.speed_mps = speed_mps;
        let ends = route_ends(vehicle, world.sites.get(index)?);
        if vehicle
            .stops
            .iter()
            .any(|stop| stop.arrives != Arrival::Planned)
        {
            // Lines over the ground stay where they are.
            return None;
        }
        let controls = base.routes.first()?.control_points.len();
        let is_regular = base.routes.len() == ends.len()
            && base
                .routes
                .iter()
                .all(|route| route.control_points.len() == controls);
        if !is_regular || controls < 4 || spec.planner.objective == Objective::Paper {
            return None;
        }
        spec.planner.control_points = controls - 2;
        let (models, bases) = with_planning(&spec, world, 0, |planning| {
            let of_route = |(from, to): (PlanPoint, PlanPoint)| {
                let ends = RouteEnds {
                    from,
                    to,
                    start_s: 0.0,
                };
                let context = planning.route_context(index, ends, EarlierFlights::none());
                let parameters = context.parameters(JUDGED_SAMPLES);
                let model = context.model(Margins::default(), &parameters);
                (model, path_basis(&context, controls))
            };
            ends.into_iter().map(of_route).unzip()
        });
        Some(Self {
            spec,
            world,
            index,
            base: base.clone(),
            models,
            bases,
        })
    }

    /// The cost of each shape, without other vehicles.
    #[must_use]
    pub fn terms(&self, shapes: &[Shape]) -> Vec<CostTerms> {
        let mut sums = vec![CostTerms::default(); shapes.len()];
        for (number, model) in self.models.iter().enumerate() {
            let mut batch = Batch::new(self.spec.planner.control_points + 2);
            for shape in shapes {
                batch.push(&Spline::through(&shape.control_points[number]).controls());
            }
            for (total, terms) in sums.iter_mut().zip(model.judge(&batch)) {
                *total = sum(total, &terms);
            }
        }
        sums
    }

    /// The plan of a shape that costs `terms`.
    #[must_use]
    pub fn plan(&self, shape: &Shape, terms: CostTerms) -> VehiclePlan {
        let specified_s = self.spec.vehicles[self.index].depart_s;
        let routes = with_planning(&self.spec, self.world, 0, |planning| {
            planning.routes_of(self.index, &shape.control_points, &self.bases)
        });
        let later_s = shape.depart_s - specified_s;
        let later = |mut route: Route| {
            for timed in &mut route.path {
                timed.t_s += later_s;
            }
            route
        };
        VehiclePlan {
            depart_s: shape.depart_s,
            speed_mps: self.spec.vehicles[self.index].speed_mps,
            routes: routes.into_iter().map(later).collect(),
            terms,
            is_detour: true,
            ..self.base.clone()
        }
    }

    /// The spec with the speed of the shapes.
    #[must_use]
    pub fn spec(&self) -> &MissionSpec {
        &self.spec
    }
}

impl Planning<'_> {
    /// The routes along given control points, each at the points of its basis, one after the other
    /// in time.
    pub(super) fn routes_of(
        &self,
        index: usize,
        control_points: &[Vec<PlanPoint>],
        bases: &[Basis],
    ) -> Vec<Route> {
        let ends = route_ends(&self.spec.vehicles[index], &self.world.sites[index]);
        let mut plan = self.empty_plan(index, Vec::new());
        let routes = control_points.iter().zip(bases);
        for (number, (ends, (points, basis))) in ends.into_iter().zip(routes).enumerate() {
            let spec = &*on_route(self.spec, index, number);
            let context = self.context(spec, index, ends, &plan, EarlierFlights::none());
            let spline = Spline::through(points);
            plan.routes.push(route(&context, &spline, basis));
        }
        self.meet(index, &mut plan);
        plan.routes
    }
}

impl VehiclePlan {
    /// Its shape.
    #[must_use]
    pub fn shape(&self) -> Shape {
        Shape {
            control_points: self
                .routes
                .iter()
                .map(|route| route.control_points.clone())
                .collect(),
            depart_s: self.depart_s,
        }
    }
}

/// Most control points of a path that is refined.
const MAX_CONTROLS: usize = 70;

impl VehiclePlan {
    /// The same paths with two to four times as many control points, as far as these are few.
    #[must_use]
    pub fn refined(&self) -> Self {
        let mut plan = self.clone();
        for route in &mut plan.routes {
            let mut spline = Spline::through(&route.control_points);
            while 2 * spline.east_m.len() <= MAX_CONTROLS && spline.east_m.len() >= 4 {
                spline = spline.halved();
            }
            route.control_points = spline.points();
        }
        plan
    }
}

/// Something made with a request that asks for nothing.
fn with_planning<T>(
    spec: &MissionSpec,
    world: &World,
    seed: u64,
    make: impl FnOnce(Planning<'_>) -> T,
) -> T {
    let request = Request::new(seed);
    make(Planning::new(spec, world, &request))
}
