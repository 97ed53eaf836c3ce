//! A scenario as the objective and the planner read it.

use std::sync::Arc;

use geo::Polygon;

use crate::cost::{CostModel, Leg, Margins, PaperOptions};
use crate::geodesy::{Amsl, EastNorth, LatLon, LocalFrame, PlanPoint};
use crate::numeric::bspline::uniform_parameters;
use crate::path::Flight;
use crate::spec::AltitudeReference;
use crate::spec::{
    Airframe, Area, Autopilot, EndPoint, Finish, Link, MissionOptions, MissionSpec, Mover,
    OnLinkLoss, Placement, Scenario, Separation, TerrainSource, Vehicle,
};
use crate::world::{Disc, Ground, Stations, Terrain, World};

/// Samples at which a result is judged.
pub(super) const JUDGED_SAMPLES: usize = 2001;

/// The paper's vehicles have one speed throughout: they reach it in no time, m/s^2.
const AT_ONCE_MPS2: f64 = 1e6;

/// A scenario and what is made of it.
///
/// Objective and planner read planning coordinates alone, which a scenario has from the
/// beginning. The geodetic side of a mission is needed by type only: it is laid around
/// latitude 0, longitude 0, and nothing here reads it.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The scenario.
    pub scenario: Scenario,
    pub(super) spec: MissionSpec,
    pub(super) world: World,
    objective: PaperOptions,
}

impl Setting {
    /// Lays out a scenario that is searched with some reading of the objective.
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

    /// The leg of a vehicle; all begin at once.
    pub(super) fn leg(&self, vehicle: usize) -> Leg {
        let stations = &self.world.stations[vehicle];
        Leg {
            from: stations.start,
            to: stations.goal,
            start_s: 0.0,
        }
    }

    /// The paper's objective of one vehicle, as it is searched.
    pub(super) fn model(&self, vehicle: usize, earlier: &[Flight], samples: usize) -> CostModel {
        CostModel::new(
            &self.world,
            &self.spec,
            vehicle,
            self.leg(vehicle),
            earlier,
            Margins::default(),
            &uniform_parameters(samples),
        )
        .with_paper(self.objective)
    }

    /// The same, finely, for the question whether a path is safe: with the ground itself as
    /// limit, because what keeps the least height between 101 samples may miss it by
    /// centimetres between 2001.
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
    let on_ground = |at: EastNorth| PlanPoint {
        at,
        amsl: Amsl(scenario.surface.height_m(at)),
    };
    World {
        frame,
        // For verdicts on missions, of which there are none here; searches read the grid.
        terrain: Terrain::Flat(Amsl(0.0)),
        // As fine as a grid may be: 98 m on a map of 100 km.
        ground: Arc::new(Ground::sample_by(&area, 1.0, height)),
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
        stations: scenario
            .vehicles
            .iter()
            .map(|mover| Stations {
                home: on_ground(mover.start.at),
                start: mover.start,
                goal: mover.goal,
                goal_ground: on_ground(mover.goal.at).amsl,
            })
            .collect(),
    }
}

fn mission(scenario: &Scenario, frame: &LocalFrame) -> MissionSpec {
    MissionSpec {
        name: scenario.name.clone(),
        frame: *frame,
        area: Area {
            south_west: frame.from_plan(scenario.south_west),
            north_east: frame.from_plan(scenario.north_east),
            min_agl: scenario.min_agl,
            max_amsl: scenario.max_amsl,
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
        separation: Separation {
            distance_m: 1000.0,
            time_slack_s: 0.0,
            vertical_m: None,
        },
        planner: scenario.planner.clone(),
        mission: MissionOptions {
            altitude: AltitudeReference::Amsl,
            tolerance_m: 5.0,
            max_items: 200,
            fence: false,
        },
        wind: None,
        on_link_loss: OnLinkLoss::Continue,
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
        airframe: Airframe::Copter,
        link: Link::Sim,
        home: frame.from_plan(mover.start.at),
        start: end(mover.start),
        goal: end(mover.goal),
        finish: Finish::Loiter,
        speed_mps: mover.speed_mps,
        max_load_factor: mover.max_load_factor,
        // Eq. 27, and no limit by vertical speed.
        max_climb_rad: None,
        max_descent_rad: None,
        climb_mps: 1e6,
        descent_mps: 1e6,
        accel_mps2: AT_ONCE_MPS2,
        depart_s: 0.0,
        return_amsl: None,
    }
}
