//! Fleets of any size over the shipped terrain: deliveries from ten depots to goals in all
//! directions, so that routes cross everywhere. A copter may take off every two seconds, or up
//! to ten minutes later. Each fleet is the beginning of every larger one.

use std::fmt::Write;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::geodesy::EastNorth;
use crate::numeric::Seed;
use crate::numeric::as_f64;
use crate::world::World;

/// The elevation of the area: path relative to the mission, and content.
pub const DELIVERY_TERRAIN: (&str, &[u8]) = (
    "terrain/jacksboro.tif",
    include_bytes!("../../../missions/terrain/jacksboro.tif"),
);

/// Largest fleet.
pub const MAX_DELIVERIES: usize = 3000;

/// Depots, each with a square of pads.
const DEPOTS: usize = 10;
const PADS_A_SIDE: usize = 3;
const PAD_SPACING_M: f64 = 150.0;
const DEPOT_SPACING_M: f64 = 5000.0;
/// Interval between departures, which take turns among the depots, seconds.
const EVERY_S: f64 = 2.0;
/// Length of each departure window, seconds.
const WINDOW_S: f64 = 600.0;
/// Smallest distances of a goal from its depot, from pads and from other goals, metres.
const MIN_ROUTE_M: f64 = 15_000.0;
const MIN_FROM_PAD_M: f64 = 400.0;
const MIN_FROM_GOAL_M: f64 = 220.0;
/// Smallest distance of pads and goals from the border of the area and from threats, metres.
const MIN_FROM_BORDER_M: f64 = 500.0;

/// A mission spec and its table of vehicles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Deliveries {
    /// The spec.
    pub spec: String,
    /// The table, which the spec calls `NAME.csv`.
    pub table: String,
}

/// A mission of one vehicle over the same ground, to load the ground.
#[must_use]
pub fn delivery_ground() -> String {
    format!(
        "{}vehicles:\n  - {{id: a, sysid: 1, autopilot: ardupilot, link: sim, speed_mps: 15, finish: land,\n     \
         start: {{lat: 36.375, lon: -84.135, agl_m: 80}}, goal: {{lat: 36.245, lon: -84.345, agl_m: 80}}}}\n",
        ground(1, "deliveries")
    )
}

/// The mission of a fleet over the ground of [`delivery_ground`], with the evaluations of each
/// plan. The same numbers give the same text.
#[must_use]
pub fn deliveries(world: &World, vehicles: usize, evaluations: usize) -> Deliveries {
    let vehicles = vehicles.clamp(1, MAX_DELIVERIES);
    let name = format!("fleet-{vehicles}");
    let mut draft = Draft {
        world,
        rng: Seed(1).stream("deliveries", 0),
        pads: Vec::new(),
        goals: Vec::new(),
    };
    draft.place_depots();
    Deliveries {
        spec: spec(&name, vehicles, evaluations),
        table: draft.table(vehicles),
    }
}

/// The part that all fleets have in common.
fn ground(version: u8, name: &str) -> String {
    format!(
        "sortie: {version}\n\
         name: {name}\n\
         \n\
         origin: {{lat: 36.30, lon: -84.25}}\n\
         area:\n  \
           south_west: {{lat: 36.18, lon: -84.40}}\n  \
           north_east: {{lat: 36.43, lon: -84.10}}\n  \
           min_agl_m: 60\n  \
           max_amsl_m: 1500\n\
         terrain: {{file: {}}}\n\
         threats:\n  \
           - {{id: radar-cross,    kind: radar,   lat: 36.318, lon: -84.232, radius_m: 1500}}\n  \
           - {{id: radar-caney,    kind: radar,   lat: 36.268, lon: -84.305, radius_m: 1200}}\n  \
           - {{id: battery-valley, kind: battery, lat: 36.352, lon: -84.172, radius_m: 900}}\n",
        DELIVERY_TERRAIN.0
    )
}

fn spec(name: &str, vehicles: usize, evaluations: usize) -> String {
    format!(
        "# yaml-language-server: $schema=schema.json\n\
         #\n\
         # Deliveries over the Cumberland Mountains: {vehicles} copters from ten depots, one takes off\n\
         # every two seconds, or up to ten minutes later, and their ways of 15 to 30 km cross\n\
         # everywhere. The table beside this file says from where to where; both were made by\n\
         # `sortie study fleet`.\n\
         \n\
         {}\n\
         # In order of priority: each keeps apart from all before it.\n\
         fleet:\n  \
           id: d{{n:04}}\n  \
           csv: {name}.csv\n  \
           defaults:\n    \
             autopilot: ardupilot\n    \
             link: \"udpout:127.0.0.1:{{14550+n}}\"\n    \
             start: {{agl_m: 80}}\n    \
             goal: {{agl_m: 80}}\n    \
             finish: land\n    \
             speed_mps: 15\n    \
             max_airspeed_mps: 18\n    \
             max_load_factor: 1.2\n    \
             max_climb_deg: 15\n    \
             max_descent_deg: 12\n    \
             climb_mps: 5\n    \
             descent_mps: 4\n\
         \n\
         # Nearer than 50 m across and 25 m in height is too near, even if one is 5 s early or late.\n\
         separation: {{distance_m: 50, vertical_m: 25, time_slack_s: 5}}\n\
         \n\
         # For each plan. Forty times as many make the fleet less than 3 % cheaper.\n\
         planner: {{seed: 1, evaluations: {evaluations}, control_points: 8}}\n\
         mission: {{altitude: amsl, tolerance_m: 5, fence: true}}\n",
        ground(2, name)
    )
}

struct Draft<'a> {
    world: &'a World,
    rng: ChaCha8Rng,
    /// Depot by depot.
    pads: Vec<EastNorth>,
    goals: Vec<EastNorth>,
}

impl Draft<'_> {
    /// A random place of the area.
    fn anywhere(&mut self) -> EastNorth {
        let ground = &self.world.ground;
        let side = |nodes: usize| as_f64(nodes - 1) * ground.spacing_m;
        EastNorth {
            east_m: ground.south_west.east_m + self.rng.random_range(0.0..side(ground.columns)),
            north_m: ground.south_west.north_m + self.rng.random_range(0.0..side(ground.rows)),
        }
    }

    /// Whether a copter can take off and land at a place: within the area, away from threats,
    /// and with no ground around that rises faster than a copter climbs or descends.
    fn is_open(&self, at: EastNorth) -> bool {
        let around = |radius_m: f64| {
            (0..12_u8).map(move |k| {
                let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / 12.0).sin_cos();
                EastNorth {
                    east_m: at.east_m + radius_m * cos,
                    north_m: at.north_m + radius_m * sin,
                }
            })
        };
        let world = self.world;
        let height_m = world.ground.height_m(at);
        let is_inside = around(MIN_FROM_BORDER_M).all(|near| world.in_area(near));
        let is_safe = world
            .threats
            .iter()
            .all(|disc| disc.center.distance_m(at) > disc.radius_m + MIN_FROM_BORDER_M);
        is_inside
            && is_safe
            && [100.0, 200.0, 400.0, 700.0, 1000.0, 1500.0]
                .iter()
                .all(|&radius_m| {
                    around(radius_m)
                        .filter(|near| world.in_area(*near))
                        .all(|near| world.ground.height_m(near) < height_m + 8.0 + 0.14 * radius_m)
                })
    }

    fn place_depots(&mut self) {
        let mut depots: Vec<EastNorth> = Vec::new();
        while depots.len() < DEPOTS {
            let at = self.anywhere();
            let pads: Vec<EastNorth> = (0..PADS_A_SIDE * PADS_A_SIDE)
                .map(|pad| EastNorth {
                    east_m: at.east_m + as_f64(pad % PADS_A_SIDE) * PAD_SPACING_M,
                    north_m: at.north_m + as_f64(pad / PADS_A_SIDE) * PAD_SPACING_M,
                })
                .collect();
            let is_apart = depots
                .iter()
                .all(|other| other.distance_m(at) > DEPOT_SPACING_M);
            if is_apart && pads.iter().all(|&pad| self.is_open(pad)) {
                depots.push(at);
                self.pads.extend(pads);
            }
        }
    }

    /// A new goal for a vehicle from a pad.
    fn place_goal(&mut self, pad: EastNorth) -> EastNorth {
        let mut tries = 0;
        loop {
            let at = self.anywhere();
            // A full area takes more goals nearer to each other.
            let spacing_m = MIN_FROM_GOAL_M * 0.8_f64.powi(tries / 20_000);
            tries += 1;
            let is_apart = |from: &[EastNorth], min_m: f64| {
                from.iter().all(|other| other.distance_m(at) > min_m)
            };
            if pad.distance_m(at) > MIN_ROUTE_M
                && is_apart(&self.pads, MIN_FROM_PAD_M)
                && is_apart(&self.goals, spacing_m)
                && self.is_open(at)
            {
                self.goals.push(at);
                return at;
            }
        }
    }

    fn table(&mut self, vehicles: usize) -> String {
        let mut text =
            "start_lat,start_lon,goal_lat,goal_lon,depart_window_s_from,depart_window_s_to\n"
                .to_owned();
        for index in 0..vehicles {
            let (depot, turn) = (index % DEPOTS, index / DEPOTS);
            let pads = PADS_A_SIDE * PADS_A_SIDE;
            let pad = self.pads[depot * pads + turn % pads];
            let goal = self.place_goal(pad);
            let degrees = |at: EastNorth| {
                let at = self.world.frame.from_plan(at);
                format!("{:.5},{:.5}", at.lat_deg, at.lon_deg)
            };
            let (from, to) = (degrees(pad), degrees(goal));
            let opens_s = as_f64(index) * EVERY_S;
            let closes_s = opens_s + WINDOW_S;
            let _ = writeln!(text, "{from},{to},{opens_s},{closes_s}");
        }
        text
    }
}
