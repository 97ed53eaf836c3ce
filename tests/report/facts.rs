//! Facts of a review, made up by hand.

use std::fs;
use std::path::{Path, PathBuf};

use sortie::cost::CostTerms;
use sortie::geodesy::{Agl, Amsl, PlanPoint};
use sortie::mission::{Home, Item, VehicleMission, command, frame};
use sortie::path::TimedPoint;
use sortie::plan::{FleetPlan, Route, VehiclePlan};
use sortie::report::{FlownFacts, ReviewInput, flight_html, review_html, review_svg};
use sortie::spec::*;
use sortie::verify::{Limit, Margin, Moment, Review, Sense, Track};
use sortie::world::World;

use crate::support::{copter, empty_spec, place, world};

pub(crate) const IDS: [&str; 3] = ["alpha", "bravo", "charlie"];

/// Names that try to become markup, script, or a place of the template.
pub(crate) const HOSTILE: [&str; 3] = [
    "</script><img src=x onerror=\"window.broken=1\">",
    "\"><svg onload='window.broken=1'></title>{{data}}",
    "<!--<script>&amp;\u{2028}'`${window.broken=1}\\",
];

/// Facts of a review, made up whole: nothing here is planned or verified.
pub(crate) struct Facts {
    pub(crate) spec: MissionSpec,
    pub(crate) world: World,
    pub(crate) plan: FleetPlan,
    pub(crate) missions: Vec<VehicleMission>,
    pub(crate) review: Review,
}

impl Facts {
    pub(crate) fn html(&self) -> String {
        let missions: Vec<_> = self.missions.iter().enumerate().collect();
        review_html(&self.input(&missions))
    }

    /// The page of a flight with these facts.
    pub(crate) fn flight(&self, flown: &[FlownFacts]) -> String {
        let missions: Vec<_> = self.missions.iter().enumerate().collect();
        flight_html(&self.input(&missions), flown)
    }

    pub(crate) fn svg(&self) -> String {
        let missions: Vec<_> = self.missions.iter().enumerate().collect();
        review_svg(&self.input(&missions))
    }

    fn input<'a>(&'a self, missions: &'a [(usize, &'a VehicleMission)]) -> ReviewInput<'a> {
        ReviewInput {
            spec: &self.spec,
            world: &self.world,
            plan: Some(&self.plan),
            missions,
            review: &self.review,
            seed: Some(self.plan.seed),
            spec_sha256: "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
            version: "0.1.0",
        }
    }
}

/// Hills, threats, zones and three vehicles with these names.
pub(crate) fn hilly_spec(ids: [&str; 3]) -> MissionSpec {
    let routes = [
        (place(36.235, -84.335), place(36.365, -84.165)),
        (place(36.36, -84.34), place(36.23, -84.175)),
        (place(36.225, -84.25), place(36.375, -84.262)),
    ];
    let vehicles = ids
        .iter()
        .zip(routes)
        .zip(1..)
        .map(|((id, (start, goal)), sysid)| copter(id, sysid, start, goal))
        .collect();
    let mut spec = empty_spec(vehicles);
    spec.name = "ridge survey".to_owned();
    spec.vehicles[1].autopilot = Autopilot::Px4;
    spec.vehicles[2].depart_s = 30.0;
    let ridge = (0..9).map(|step| {
        let along = f64::from(step) / 8.0;
        Hill {
            place: place(
                36.22 + 0.155 * along,
                -84.345 + 0.13 * along + 0.012 * (9.0 * along).sin(),
            ),
            height_m: 210.0 + 110.0 * (5.0 * along).cos(),
            radius_m: 1300.0 + 500.0 * (3.0 * along).sin(),
        }
    });
    let lone = [
        (36.268, -84.185, 340.0, 1900.0),
        (36.335, -84.205, 190.0, 1500.0),
        (36.245, -84.225, 120.0, 900.0),
        (36.372, -84.16, 260.0, 2300.0),
        (36.30, -84.162, 90.0, 1100.0),
    ]
    .map(|(lat_deg, lon_deg, height_m, radius_m)| Hill {
        place: place(lat_deg, lon_deg),
        height_m,
        radius_m,
    });
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(320.0),
        hills: ridge.chain(lone).collect(),
    };
    spec.threats = [
        ("radar-1", "radar", 36.318, -84.268, 1700.0),
        ("sam-2", "sam", 36.262, -84.205, 1300.0),
        ("radar-3", "radar", 36.342, -84.19, 900.0),
    ]
    .map(|(id, kind, lat_deg, lon_deg, radius_m)| Threat {
        id: id.to_owned(),
        kind: kind.to_owned(),
        place: place(lat_deg, lon_deg),
        radius_m,
    })
    .to_vec();
    let town = [
        (36.245, -84.305),
        (36.262, -84.305),
        (36.268, -84.28),
        (36.25, -84.275),
    ];
    let range = [
        (36.28, -84.352),
        (36.3, -84.35),
        (36.297, -84.325),
        (36.284, -84.33),
    ];
    let corners = |ring: [(f64, f64); 4]| ring.map(|(lat, lon)| place(lat, lon)).to_vec();
    spec.no_fly = vec![
        Zone {
            id: "town".to_owned(),
            polygon: corners(town),
            ceiling: Some(sortie::spec::Placement::Amsl(Amsl(700.0))),
            ..Zone::default()
        },
        Zone {
            id: "range".to_owned(),
            polygon: corners(range),
            ..Zone::default()
        },
    ];
    spec.rally = vec![Rally {
        place: place(36.25, -84.35),
        agl: Agl(80.0),
    }];
    spec
}

/// A curved flight from start to goal, 80 m above ground but for a dip.
fn flight(world: &World, index: usize) -> Vec<TimedPoint> {
    let sites = &world.sites[index];
    let (start, goal) = (sites.start.at, sites.goal.at);
    let bend_m = [3100.0, -2600.0, 2300.0][index % 3];
    let (across_e, across_n) = (goal.north_m - start.north_m, start.east_m - goal.east_m);
    let span_m = start.distance_m(goal);
    let mut t_s = 30.0 * f64::from(u8::try_from(index % 3).expect("small"));
    let mut last: Option<PlanPoint> = None;
    let mut path = Vec::new();
    for step in 0..=300 {
        let share = f64::from(step) / 300.0;
        let aside = bend_m * (std::f64::consts::PI * share).sin() / span_m;
        let mut point = PlanPoint::new(
            start.east_m + (goal.east_m - start.east_m) * share + across_e * aside,
            start.north_m + (goal.north_m - start.north_m) * share + across_n * aside,
            Amsl(0.0),
        );
        let ground = world
            .terrain
            .height(world.frame.from_plan(point.at))
            .expect("ground everywhere");
        let depth_m = if index == 1 { 58.0 } else { 26.0 };
        let dip_m = depth_m * (-((share - 0.62) / 0.03).powi(2)).exp();
        point.amsl = Amsl(ground.0 + 82.0 + 25.0 * (12.0 * share).sin().powi(2) - dip_m);
        if let Some(last) = last {
            t_s += last.distance_m(point) / 15.0;
        }
        last = Some(point);
        path.push(TimedPoint { point, t_s });
    }
    path
}

fn moment(world: &World, timed: &TimedPoint, item: usize) -> Moment {
    Moment {
        place: world.frame.from_plan(timed.point.at),
        amsl: timed.point.amsl,
        t_s: timed.t_s,
        item,
    }
}

/// Takeoff, the path, landing; an item every 12 points.
fn track(world: &World, id: &str, index: usize, path: &[TimedPoint]) -> Track {
    let home = world.sites[index].home;
    let (first, last) = (path[0], path[path.len() - 1]);
    let mut moments = vec![moment(
        world,
        &TimedPoint {
            point: home,
            t_s: first.t_s - 18.0,
        },
        1,
    )];
    moments.extend(
        path.iter()
            .enumerate()
            .map(|(at, timed)| moment(world, timed, 2 + at / 12)),
    );
    let down = world
        .terrain
        .height(world.frame.from_plan(last.point.at))
        .expect("ground everywhere");
    let landed = PlanPoint {
        at: last.point.at,
        amsl: down,
    };
    moments.push(moment(
        world,
        &TimedPoint {
            point: landed,
            t_s: last.t_s + 42.0,
        },
        28,
    ));
    Track {
        vehicle: id.to_owned(),
        moments,
        late_s: Vec::new(),
    }
}

fn mission(vehicle: &Vehicle, home: PlanPoint, track: &Track) -> VehicleMission {
    let integer = |deg: f64| {
        format!("{:.0}", deg * 1e7)
            .parse::<i32>()
            .expect("within range")
    };
    let float = |value: f64| format!("{value:.2}").parse::<f32>().expect("a number");
    let mut items: Vec<Item> = track
        .moments
        .iter()
        .step_by(12)
        .map(|moment| Item {
            command: command::NAV_WAYPOINT,
            frame: frame::GLOBAL,
            autocontinue: true,
            params: [0.0; 4],
            x: integer(moment.place.lat_deg),
            y: integer(moment.place.lon_deg),
            z: float(moment.amsl.0),
        })
        .collect();
    items[0].command = command::NAV_TAKEOFF;
    VehicleMission {
        autopilot_version: None,
        autopilot: vehicle.autopilot,
        airframe: vehicle.airframe,
        home: Home {
            x: integer(vehicle.home.lat_deg),
            y: integer(vehicle.home.lon_deg),
            amsl_m: float(home.amsl.0),
        },
        items,
        fence: Vec::new(),
        is_fence_known: true,
        rally: Vec::new(),
        params: Vec::new(),
        notes: vec!["the fence has no zone with a height: town".to_owned()],
    }
}

pub(crate) fn facts(spec: MissionSpec) -> Facts {
    let world = world(&spec);
    let paths: Vec<Vec<TimedPoint>> = (0..spec.vehicles.len())
        .map(|index| flight(&world, index))
        .collect();
    let tracks: Vec<Track> = spec
        .vehicles
        .iter()
        .enumerate()
        .map(|(index, vehicle)| track(&world, &vehicle.id, index, &paths[index]))
        .collect();
    let missions = spec
        .vehicles
        .iter()
        .zip(&tracks)
        .zip(&world.sites)
        .map(|((vehicle, track), sites)| mission(vehicle, sites.home, track))
        .collect();
    let plan = FleetPlan {
        seed: 7,
        vehicles: paths
            .iter()
            .map(|path| VehiclePlan {
                order: Vec::new(),
                depart_s: 0.0,
                speed_mps: 12.0,
                routes: vec![Route {
                    control_points: path.iter().step_by(50).map(|timed| timed.point).collect(),
                    path: path.clone(),
                }],
                terms: CostTerms {
                    length: 20.6,
                    altitude: 0.42,
                    ..CostTerms::default()
                },
                bound: 19.9,
                estimate: 20.8,
                evaluations: 40_000,
                plans: 1,
                avoids: Vec::new(),
                is_detour: false,
                blocked_by: Vec::new(),
                blocking_set: Vec::new(),
                relaxations: None,
                passes_departing_s: None,
            })
            .collect(),
    };
    let margins = margins(&spec, &world, &tracks);
    let mut review = Review::default();
    review.margins = margins;
    review.tracks = tracks;
    review.assumptions = vec![
        "Corners are flown as arcs of the turn radius; not measured on an autopilot.".to_owned(),
        "Takeoff climbs straight up at the climb speed.".to_owned(),
    ];
    Facts {
        spec,
        world,
        plan,
        missions,
        review,
    }
}

fn margins(spec: &MissionSpec, world: &World, tracks: &[Track]) -> Vec<Margin> {
    let mut margins = Vec::new();
    for (index, track) in tracks.iter().enumerate() {
        let offset = f64::from(u8::try_from(index % 200).expect("small"));
        let mut add =
            |limit: Limit, value: f64, bound: f64, unit, ok, at: Option<Moment>, note: &str| {
                let mut margin = Margin::unjudged(&track.vehicle, limit, note);
                (margin.value, margin.bound) = (value, bound);
                margin.sense = if (value >= bound) == ok {
                    Sense::AtLeast
                } else {
                    Sense::AtMost
                };
                (margin.unit, margin.at, margin.ok) = (unit, at, ok);
                margins.push(margin);
            };
        let (lowest_m, at) = track.moments[1..302]
            .iter()
            .map(|moment| {
                let ground = world.terrain.height(moment.place).expect("ground");
                (moment.amsl.above_ground(ground).0, *moment)
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .expect("a track");
        add(
            Limit::TerrainClearance,
            lowest_m,
            60.0,
            "m",
            lowest_m >= 60.0,
            Some(at),
            "",
        );
        for (number, threat) in spec.threats.iter().enumerate() {
            let value =
                90.0 + 400.0 * f64::from(u8::try_from(number).expect("few")) + 33.3 * offset;
            add(
                Limit::Threat(threat.id.clone()),
                value,
                0.0,
                "m",
                true,
                Some(track.moments[80]),
                "",
            );
        }
        add(
            Limit::Area,
            310.0 + offset,
            0.0,
            "m",
            true,
            Some(track.moments[40]),
            "",
        );
        add(
            Limit::ClimbAngle,
            9.2 + offset % 4.0,
            15.0,
            "deg",
            true,
            Some(track.moments[100]),
            "",
        );
        add(
            Limit::TurnFit,
            0.41,
            1.0,
            "",
            true,
            Some(track.moments[150]),
            "",
        );
        add(Limit::ItemCount, 26.0, 200.0, "items", true, None, "");
        add(
            Limit::Acceptance,
            0.0,
            0.0,
            "rules",
            true,
            None,
            "PX4 counts from 0: one less than here",
        );
    }
    for (a, track) in tracks.iter().enumerate().take(12) {
        for other in tracks.iter().take(12).skip(a + 1) {
            let (nearest_m, at) = nearest(world, track, other);
            let note = "worst shift of departure: 5 s";
            let mut margin = Margin::unjudged(&track.vehicle, Limit::Separation, note);
            margin.other = Some(other.vehicle.clone());
            (margin.value, margin.bound, margin.unit) = (nearest_m, 100.0, "m");
            (margin.at, margin.ok) = (Some(at), nearest_m >= 100.0);
            margins.push(margin);
        }
    }
    margins
}

/// The least distance of two tracks at the same time, at the moments of the first.
fn nearest(world: &World, track: &Track, other: &Track) -> (f64, Moment) {
    let point = |moment: &Moment| PlanPoint {
        at: world.frame.to_plan(moment.place),
        amsl: moment.amsl,
    };
    track
        .moments
        .iter()
        .map(|moment| {
            let then = other
                .moments
                .iter()
                .min_by(|a, b| {
                    (a.t_s - moment.t_s)
                        .abs()
                        .total_cmp(&(b.t_s - moment.t_s).abs())
                })
                .expect("a track");
            (point(moment).distance_m(point(then)), *moment)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .expect("a track")
}

/// The same, every limit kept.
pub(crate) fn passing(mut facts: Facts) -> Facts {
    for margin in facts.review.margins.iter_mut().filter(|margin| !margin.ok) {
        margin.value = margin.bound + 1.4;
        margin.ok = true;
    }
    facts
}

/// Where pages are written, to be looked at.
pub(crate) fn output() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report");
    fs::create_dir_all(&folder).expect("a folder for pages");
    folder
}

/// The facts that the scripts of a page read.
pub(crate) fn data_of(html: &str) -> serde_json::Value {
    let (_, after) = html.split_once("id=\"data\">").expect("the data");
    let (text, _) = after.split_once("</script>").expect("its end");
    serde_json::from_str(text).expect("JSON")
}
