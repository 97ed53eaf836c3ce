//! A scenario of the paper as the objective and the planner read it.

use std::sync::Arc;

use geo::Polygon;

use crate::cost::{Controls, CostModel, EarlierFlights, Margins, PaperOptions, RouteEnds};
use crate::geodesy::{Amsl, EastNorth, LatLon, LocalFrame, PlanPoint};
use crate::numeric::Basis;
use crate::numeric::bspline::uniform_parameters;
use crate::path::{Flight, time_route};
use crate::spec::AltitudeReference;
use crate::spec::{
    Airframe, AltitudeLimits, Area, Autopilot, Buffers, EndPoint, Finish, Link, MissionOptions,
    MissionSpec, Mover, OnAlarm, OnLinkLoss, OnWay, Order, Placement, Retiming, Scenario,
    Separation, TerrainSource, Vehicle,
};
use crate::world::{Departure, Disc, Ground, Layer, Terrain, VehicleSites, World};

/// Control points by coordinate, ends included: metres east, north and up.
pub(super) type Spline = [Vec<f64>; 3];

pub(super) fn controls(spline: &Spline) -> Controls<'_> {
    let [east_m, north_m, amsl_m] = spline;
    Controls {
        east_m,
        north_m,
        amsl_m,
    }
}

/// Eq. 33: a point of the unit cube as a spline. First all free values east, then all north,
/// then all altitudes, each as a share of the map.
pub(super) struct Encoding {
    /// Start and goal; low and high edge of the map, by coordinate.
    axes: [[f64; 4]; 3],
    free: usize,
}

impl Encoding {
    pub(super) fn dimension(&self) -> usize {
        3 * self.free
    }

    pub(super) fn spline(&self, candidate: &[f64]) -> Spline {
        let mut parts = candidate.chunks_exact(self.free);
        self.axes.map(|[from, to, low, high]| {
            let free = parts.next().unwrap_or_default();
            let free = free.iter().map(|share| low + share * (high - low));
            std::iter::once(from).chain(free).chain([to]).collect()
        })
    }
}

/// Samples at which a result is judged.
pub(super) const JUDGED_SAMPLES: usize = 2001;

/// The paper's vehicles have one speed throughout: they reach it in no time, m/s^2.
const AT_ONCE_MPS2: f64 = 1e6;

/// A scenario as spec and world.
///
/// Objective and planner read only planning coordinates, which a scenario states itself. The
/// geodetic side of a mission lies around latitude 0, longitude 0, and nothing reads it.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The scenario.
    pub scenario: Scenario,
    pub(super) spec: MissionSpec,
    pub(super) world: World,
    objective: PaperOptions,
}

impl Setting {
    /// A scenario that is searched with a reading of the objective.
    #[must_use]
    pub fn new(scenario: Scenario, objective: PaperOptions) -> Self {
        let frame = LocalFrame::new(LatLon {
            lat_deg: 0.0,
            lon_deg: 0.0,
        });
        let spec = mission(&scenario, &frame);
        let world = world(&scenario, frame);
        Self {
            scenario,
            spec,
            world,
            objective,
        }
    }

    /// The leg of a vehicle; all vehicles depart at once.
    pub(super) fn leg(&self, vehicle: usize) -> RouteEnds {
        let sites = &self.world.sites[vehicle];
        RouteEnds {
            from: sites.start,
            to: sites.goal,
            start_s: 0.0,
        }
    }

    pub(super) fn encoding(&self, vehicle: usize) -> Encoding {
        let RouteEnds { from, to, .. } = self.leg(vehicle);
        let (low, high) = (self.scenario.south_west, self.scenario.north_east);
        Encoding {
            axes: [
                [from.at.east_m, to.at.east_m, low.east_m, high.east_m],
                [from.at.north_m, to.at.north_m, low.north_m, high.north_m],
                [from.amsl.0, to.amsl.0, 0.0, self.scenario.max_amsl.0],
            ],
            free: self.spec.planner.control_points,
        }
    }

    /// The flight along a spline as later vehicles see it: one point for each sample of the
    /// search.
    pub(super) fn flight(&self, vehicle: usize, spline: &Spline) -> Flight {
        let basis = Basis::uniform(spline[0].len(), self.spec.planner.samples);
        let [east, north, amsl] = [0, 1, 2].map(|axis: usize| basis.sampled(&spline[axis]));
        let points: Vec<PlanPoint> = amsl
            .into_iter()
            .zip(east.into_iter().zip(north))
            .map(|(amsl_m, (east_m, north_m))| PlanPoint::new(east_m, north_m, Amsl(amsl_m)))
            .collect();
        let vehicle = &self.spec.vehicles[vehicle];
        Flight {
            points: time_route(&points, 0.0, vehicle.speed_mps, vehicle.accel_mps2),
            route_starts_s: vec![0.0],
            loiters: false,
            lingers: Vec::new(),
        }
    }

    /// The paper's objective of one vehicle, as it is searched.
    pub(super) fn model(&self, vehicle: usize, earlier: &[Flight], samples: usize) -> CostModel {
        CostModel::new(
            &self.world,
            &self.spec,
            vehicle,
            self.leg(vehicle),
            &EarlierFlights::from(earlier.to_vec()),
            Margins::default(),
            &uniform_parameters(samples),
        )
        .with_paper(self.objective)
    }

    /// The objective that judges whether a path is safe, at 2001 samples. Its limit is the
    /// ground itself: a path that keeps the minimum height at 101 samples may miss it by
    /// centimetres between them.
    pub(super) fn judge(&self, vehicle: usize, earlier: &[Flight]) -> CostModel {
        self.model(vehicle, earlier, JUDGED_SAMPLES)
            .with_paper(PaperOptions {
                terrain_from_min_agl: false,
                ..PaperOptions::default()
            })
    }
}

fn world(scenario: &Scenario, frame: LocalFrame) -> World {
    let (low, high) = (scenario.south_west, scenario.north_east);
    let area = Polygon::new(
        vec![
            (low.east_m, low.north_m),
            (high.east_m, low.north_m),
            (high.east_m, high.north_m),
            (low.east_m, high.north_m),
        ]
        .into(),
        Vec::new(),
    );
    let height = |at: EastNorth| {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "heights need no more than f32"
        )]
        let height_m = scenario.surface.height_m(at) as f32;
        height_m
    };
    World {
        tasks: Vec::new(),
        own: Vec::new(),
        frame,
        // Only verification reads the terrain; searches read the grid.
        terrain: Terrain::Flat(Amsl(0.0)),
        // As fine as a grid may be: 98 m on a map of 100 km.
        ground: Arc::new(Ground::sample_by(&area, 1.0, height)),
        wider_voids: None,
        threats: scenario
            .threats
            .iter()
            .map(|threat| Disc {
                center: threat.center,
                radius_m: threat.radius_m,
            })
            .collect(),
        zones: Vec::new(),
        area,
        min_agl: scenario.min_agl,
        max_amsl: scenario.max_amsl,
        layers: vec![Layer::UNLIMITED; scenario.vehicles.len()],
        sites: sites(scenario),
    }
}

/// Where the vehicles of a scenario are.
fn sites(scenario: &Scenario) -> Vec<VehicleSites> {
    let on_ground = |at: EastNorth| PlanPoint {
        at,
        amsl: Amsl(scenario.surface.height_m(at)),
    };
    let vehicles = scenario.vehicles.iter();
    vehicles
        .map(|mover| VehicleSites {
            departure: Departure::Ground,
            home: on_ground(mover.start.at),
            start: mover.start,
            goal: mover.goal,
            landing: mover.goal.at,
            landing_rad: None,
            goal_ground: on_ground(mover.goal.at).amsl,
            stops: Vec::new(),
        })
        .collect()
}

fn mission(scenario: &Scenario, frame: &LocalFrame) -> MissionSpec {
    MissionSpec {
        version: 1,
        name: scenario.name.clone(),
        frame: *frame,
        area: Area {
            south_west: frame.from_plan(scenario.south_west),
            north_east: frame.from_plan(scenario.north_east),
            min_agl: scenario.min_agl,
            max_amsl: scenario.max_amsl,
            altitudes: AltitudeLimits::default(),
        },
        terrain: TerrainSource::Flat(Amsl(0.0)),
        threats: Vec::new(),
        no_fly: Vec::new(),
        rally: Vec::new(),
        vehicles: scenario
            .vehicles
            .iter()
            .zip(1..)
            .map(|(mover, sysid)| vehicle(mover, sysid, frame))
            .collect(),
        tasks: Vec::new(),
        separation: Separation {
            distance_m: 1000.0,
            time_slack_s: 0.0,
            vertical_m: None,
        },
        buffers: Buffers::NONE,
        planner: scenario.planner.clone(),
        mission: MissionOptions {
            altitude: AltitudeReference::Amsl,
            tolerance_m: 5.0,
            max_items: 200,
            fence: false,
        },
        wind: None,
        on_link_loss: OnLinkLoss::Continue,
        on_alarm: OnAlarm::default(),
    }
}

fn vehicle(mover: &Mover, sysid: u8, frame: &LocalFrame) -> Vehicle {
    let end = |point: PlanPoint| EndPoint {
        place: frame.from_plan(point.at),
        altitude: Placement::Amsl(point.amsl),
    };
    Vehicle {
        id: mover.id.clone(),
        sysid,
        autopilot: Autopilot::ArduPilot,
        autopilot_version: None,
        airframe: Airframe::Copter,
        link: Link::Sim,
        home: frame.from_plan(mover.start.at),
        start: end(mover.start),
        goal: end(mover.goal),
        stops: Vec::new(),
        order: Order::Fixed,
        on_way: OnWay::default(),
        finish: Finish::Loiter,
        speed_mps: mover.speed_mps,
        max_load_factor: mover.max_load_factor,
        // Eq. 27, and no limit by vertical speed.
        max_climb_rad: None,
        max_descent_rad: None,
        climb_mps: 1e6,
        descent_mps: 1e6,
        accel_mps2: AT_ONCE_MPS2,
        max_airspeed_mps: None,
        depart_s: 0.0,
        retiming: Retiming::default(),
        altitudes: AltitudeLimits::default(),
        endurance: None,
        fence_points: None,
        return_amsl: None,
        wind: None,
        wing: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::CostTerms;
    use std::path::Path;

    /// Seven control points from start to goal, each offset by `pushed` of its share of the leg.
    fn spline(leg: &RouteEnds, pushed: impl Fn(f64) -> [f64; 3]) -> Spline {
        let (from, to) = (leg.from, leg.to);
        let axis = |axis: usize, a: f64, b: f64| -> Vec<f64> {
            (0..7)
                .map(|k| f64::from(k) / 6.0)
                .map(|share| a + share * (b - a) + pushed(share)[axis])
                .collect()
        };
        [
            axis(0, from.at.east_m, to.at.east_m),
            axis(1, from.at.north_m, to.at.north_m),
            axis(2, from.amsl.0, to.amsl.0),
        ]
    }

    fn terms(model: &CostModel, spline: &Spline) -> CostTerms {
        model.terms(&controls(spline))
    }

    #[test]
    fn in_the_stress_map_straight_flights_collide_and_turns_and_climbs_are_limited() {
        let text = include_str!("../../missions/paper/stress.yaml");
        let scenario = Scenario::parse(Path::new("stress.yaml"), text).unwrap();
        let setting = Setting::new(scenario, PaperOptions::default());
        let leg = setting.leg(0);
        let line = [leg.from, leg.to];
        let straight = Flight {
            points: time_route(&line, 0.0, 400.0, AT_ONCE_MPS2),
            route_starts_s: vec![0.0],
            loiters: false,
            lingers: Vec::new(),
        };
        // Sampled as the study does.
        let samples: Vec<PlanPoint> = (0..=100)
            .map(|k| f64::from(k) / 100.0)
            .map(|share| {
                let mix = |a: f64, b: f64| a + share * (b - a);
                PlanPoint::new(
                    mix(leg.from.at.east_m, leg.to.at.east_m),
                    mix(leg.from.at.north_m, leg.to.at.north_m),
                    Amsl(mix(leg.from.amsl.0, leg.to.amsl.0)),
                )
            })
            .collect();
        let first = Flight {
            points: time_route(&samples, 0.0, 400.0, AT_ONCE_MPS2),
            ..straight
        };
        let second = setting.model(1, &[first], 101);
        let flat = |_: f64| [0.0; 3];
        let of_straight = terms(&second, &spline(&setting.leg(1), flat));
        assert!(of_straight.collision > 0.0, "{of_straight:?}");
        assert!(of_straight.turn <= 0.0 && of_straight.climb <= 0.0);
        let alone = setting.model(0, &[], 101);
        let zigzag = |share: f64| [0.0, 30_000.0 * (share * 9.425).sin(), 0.0];
        assert!(terms(&alone, &spline(&leg, zigzag)).turn > 0.0);
        let steep = |share: f64| [0.0, 0.0, 60_000.0 * share * (1.0 - share)];
        assert!(terms(&alone, &spline(&leg, steep)).climb > 0.0);
    }
}
