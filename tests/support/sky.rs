//! A fleet and the ground station that watches it, under one virtual clock.
#![allow(dead_code, unreachable_pub, missing_docs)]

use std::path::Path;
use std::sync::Arc;

use sortie::dispatch::{Dispatched, dispatch};
use sortie::flight::*;
use sortie::link::*;
use sortie::mission::VehicleMission;
use sortie::report::plan_json;
use sortie::simulator::{Surroundings, Vehicle};
use sortie::spec::{MissionSpec, OnLinkLoss, SpecFile, Vehicle as Spec, Wind};
use sortie::world::World;

use super::{copter, empty_spec, place, world};

pub const US: Address = Address {
    system: 245,
    component: 190,
};

/// A fleet that is planned, and its vehicles.
pub struct Planned {
    pub spec: MissionSpec,
    pub world: World,
    pub dispatched: Dispatched,
}

/// A copter on its way of a kilometre to the east.
pub fn lane(id: &str, sysid: u8, lat_deg: f64) -> Spec {
    let (start, goal) = (place(lat_deg, -84.26), place(lat_deg + 0.002, -84.248));
    copter(id, sysid, start, goal)
}

pub fn plan(vehicles: Vec<Spec>, on_link_loss: OnLinkLoss) -> Planned {
    let mut spec = empty_spec(vehicles);
    spec.on_link_loss = on_link_loss;
    spec.planner.evaluations = 1000;
    let world = world(&spec);
    let dispatched = dispatch(&spec, &world, 1, &|_| {});
    assert!(
        dispatched.review.passes(),
        "{:?}",
        dispatched.review.margins
    );
    Planned {
        spec,
        world,
        dispatched,
    }
}

/// A spec, planned.
pub fn plan_spec(spec: MissionSpec) -> Planned {
    let world = world(&spec);
    let dispatched = dispatch(&spec, &world, 1, &|_| {});
    let failed = dispatched.review.margins.iter().filter(|margin| !margin.ok);
    let failed: Vec<_> = failed.collect();
    assert!(failed.is_empty(), "{failed:?}");
    Planned {
        spec,
        world,
        dispatched,
    }
}

/// A shipped mission, planned after a change of its spec.
pub fn plan_shipped(name: &str, change: impl FnOnce(&mut MissionSpec)) -> Planned {
    let missions = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions");
    let path = missions.join(name).with_extension("yaml");
    let file = SpecFile::read(&path).expect("the spec");
    let world = sortie::world::load(&file).expect("the terrain");
    let mut spec = file.spec;
    change(&mut spec);
    let world = World::new(&spec, world.terrain).expect("ground");
    let dispatched = dispatch(&spec, &world, 1, &|_| {});
    let failed = dispatched.review.margins.iter().filter(|margin| !margin.ok);
    let failed: Vec<_> = failed.collect();
    assert!(failed.is_empty(), "{name}: {failed:?}");
    Planned {
        spec,
        world,
        dispatched,
    }
}

impl Planned {
    pub fn references(&self) -> Vec<ReferenceTrajectory> {
        let missions = self.dispatched.missions.iter();
        missions
            .zip(&self.dispatched.review.tracks)
            .map(|((_, mission), track)| ReferenceTrajectory::new(mission, track, &self.world))
            .collect()
    }

    /// Vehicles that stand at home with the parameters of the plan.
    pub fn vehicles(&self) -> Vec<Vehicle> {
        self.vehicles_in(self.spec.wind)
    }

    /// The same in a wind of our own.
    pub fn vehicles_in(&self, wind: Option<Wind>) -> Vec<Vehicle> {
        self.vehicles_with(wind, (0.0, 0))
    }

    /// The same with noise of a standard deviation in metres, drawn from a seed.
    pub fn vehicles_with(&self, wind: Option<Wind>, (noise_m, seed): (f64, u64)) -> Vec<Vehicle> {
        let terrain = Arc::new(self.world.terrain.clone());
        let missions = self.dispatched.missions.iter();
        missions
            .map(|(index, mission)| {
                let this = &self.spec.vehicles[*index];
                let surroundings = Surroundings {
                    terrain: Some(Arc::clone(&terrain)),
                    params: parameters(mission),
                    wind,
                    noise_m,
                    seed,
                    heading_rad: this
                        .wing
                        .and_then(|wing| wing.takeoff_heading_rad)
                        .unwrap_or(0.0),
                };
                let profile = this.autopilot.into();
                Vehicle::within(
                    profile,
                    this.sysid,
                    Some(mission.home),
                    surroundings,
                    Time(0),
                )
                .on(this.airframe)
            })
            .collect()
    }

    pub fn fleet(&self, set_params: bool, upload: bool) -> Fleet<'_> {
        self.fleet_launched(set_params, upload, None)
    }

    /// The same, that may be launched at a time only.
    pub fn fleet_launched(
        &self,
        set_params: bool,
        upload: bool,
        launch: Option<Launch>,
    ) -> Fleet<'_> {
        let options = Options {
            launch,
            ..self.options(set_params)
        };
        self.fleet_with(options, upload)
    }

    pub fn options(&self, set_params: bool) -> Options {
        Options {
            speedup: 1.0,
            set_params,
            force: false,
            on_alarm: self.spec.answers(),
            position_s: 0.2,
            launch: None,
        }
    }

    pub fn fleet_with(&self, options: Options, upload: bool) -> Fleet<'_> {
        self.fleet_started(options, upload, &[])
    }

    /// The same; each is started so many seconds after T0, those without a number at T0.
    pub fn fleet_started(&self, options: Options, upload: bool, starts_s: &[f64]) -> Fleet<'_> {
        self.fleet_from(Time(0), options, upload, starts_s)
    }

    /// The same of a ground station that begins at a time.
    pub fn fleet_from(
        &self,
        now: Time,
        options: Options,
        upload: bool,
        starts_s: &[f64],
    ) -> Fleet<'_> {
        let itineraries = self.itineraries();
        let missions = self.dispatched.missions.iter().zip(self.references());
        let assignments = missions
            .enumerate()
            .map(|(link, ((index, mission), reference))| Assignment {
                vehicle: &self.spec.vehicles[*index].id,
                sysid: self.spec.vehicles[*index].sysid,
                link,
                mission,
                reference,
                start_s: starts_s.get(link).copied().unwrap_or(0.0),
                upload,
                itinerary: itineraries[*index].clone(),
            })
            .collect();
        Fleet::new(assignments, options, US, now).watched(&self.spec, &self.world)
    }

    /// What each vehicle does on its way, by its plan.
    pub fn itineraries(&self) -> Vec<Itinerary> {
        let (spec, world) = self.dispatched.planned_spec(&self.spec, &self.world);
        let mut document = plan_json("", spec, world, &self.dispatched.plan, true);
        if let Some(tasks) = &self.dispatched.tasks {
            document.add_tasks(tasks);
        }
        let text = serde_json::to_vec(&document).expect("JSON");
        itineraries(&text, &self.spec).expect("a plan of the spec")
    }

    pub fn judge(&self, sky: &Sky<'_>) -> FlightReport {
        judge(&self.spec, &self.world, &self.record(sky))
    }

    pub fn record(&self, sky: &Sky<'_>) -> Record {
        let plans = self.dispatched.missions.iter().zip(self.references());
        let plans = plans.map(|((_, mission), reference)| Plan {
            items: mission.items.len(),
            reference,
            from_s: 0.0,
        });
        let flights = sky.fleet.flown().zip(plans).zip(self.itineraries()).map(
            |(((id, flown), plan), itinerary)| Flight {
                vehicle: id.to_owned(),
                plans: vec![plan],
                flown: flown.clone(),
                itinerary,
            },
        );
        Record {
            flights: flights.collect(),
            ..Record::default()
        }
    }
}

pub fn parameters(mission: &VehicleMission) -> Vec<(String, f32)> {
    let params = mission.params.iter();
    params.map(|p| (p.name.clone(), p.value)).collect()
}

/// What becomes of a message to a system: none passes it on, else it is lost and these answer.
pub type Uplink = Box<dyn FnMut(Time, u8, &Message) -> Option<Vec<(Address, Message)>>>;
/// What becomes of a message from a vehicle.
pub type Downlink = Box<dyn FnMut(Time, Address, Message) -> Vec<(Address, Message)>>;

/// Vehicles, each on a link of its own, and the ground station that watches them, under one clock.
pub struct Sky<'a> {
    pub fleet: Fleet<'a>,
    pub vehicles: Vec<Vehicle>,
    pub now: Time,
    /// How much faster than this clock the time of the vehicles goes.
    pub speedup: u64,
    /// How much of each 20 ms they live, and what they lost, milliseconds.
    pub lives_ms: u64,
    lost_ms: u64,
    /// System ids that cannot be heard and do not hear.
    pub cut: Vec<u8>,
    pub events: Vec<Event>,
    /// What was heard, as ground stations capture it.
    pub capture: Vec<u8>,
    /// Hostile peers on the links.
    pub up: Option<Uplink>,
    pub down: Option<Downlink>,
}

impl<'a> Sky<'a> {
    pub fn new(fleet: Fleet<'a>, vehicles: Vec<Vehicle>) -> Self {
        Self {
            fleet,
            vehicles,
            now: Time(0),
            speedup: 1,
            lives_ms: 20,
            lost_ms: 0,
            cut: Vec::new(),
            events: Vec::new(),
            capture: Vec::new(),
            up: None,
            down: None,
        }
    }

    fn hear(&mut self, link: usize, from: Address, message: &Message) {
        let stamp = 1000 * self.now.0 + 1_700_000_000_000_000;
        self.capture.extend(stamp.to_be_bytes());
        self.capture.extend(Encoder::new(from).encode(message));
        self.fleet.handle(self.now, (link, from), message);
    }

    pub fn step(&mut self) {
        self.now = self.now + 20;
        let own = self.vehicles_now();
        self.fleet.handle_timeout(self.now);
        while let Some((system, message)) = self.fleet.poll_transmit() {
            let answers = self
                .up
                .as_mut()
                .and_then(|up| up(self.now, system, &message));
            if let Some(answers) = answers {
                for (from, answer) in answers {
                    self.hear(usize::from(system) - 1, from, &answer);
                }
                continue;
            }
            for vehicle in &mut self.vehicles {
                if vehicle.address().system == system && !self.cut.contains(&system) {
                    vehicle.handle(own, US, &message);
                }
            }
        }
        for link in 0..self.vehicles.len() {
            self.vehicles[link].handle_timeout(own);
            let from = self.vehicles[link].address();
            while let Some(message) = self.vehicles[link].poll_transmit() {
                if self.cut.contains(&from.system) {
                    continue;
                }
                let heard = match &mut self.down {
                    Some(down) => down(self.now, from, message),
                    None => vec![(from, message)],
                };
                for (from, message) in heard {
                    self.hear(link, from, &message);
                }
            }
        }
        self.events
            .extend(std::iter::from_fn(|| self.fleet.poll_event()));
    }

    /// The time of the vehicles.
    fn vehicles_now(&mut self) -> Time {
        self.lost_ms += 20 - self.lives_ms;
        Time((self.now.0 - self.lost_ms) * self.speedup)
    }

    /// Until so many seconds after T0.
    pub fn fly_to(&mut self, t_s: f64) {
        while self.fleet.t_s(self.now).unwrap_or(-1.0) < t_s {
            assert!(self.fleet.outcome().is_none(), "{:?}", self.events);
            assert!(self.now.0 < 3_600_000, "no T0 within an hour");
            self.step();
        }
    }

    pub fn fly_out(&mut self) -> Outcome {
        while self.fleet.outcome().is_none() {
            assert!(self.now.0 < 3_600_000, "still flying after an hour");
            self.step();
        }
        self.fleet.outcome().expect("it is over").clone()
    }

    pub fn says(&self, vehicle: &str, text: &str) -> bool {
        let of = |event: &&Event| event.vehicle.as_deref() == Some(vehicle);
        self.events
            .iter()
            .filter(of)
            .any(|event| event.text.contains(text))
    }

    pub fn order(&mut self, index: usize, command: u16) {
        let target = self.vehicles[index].address();
        let order = Command::new(command, []);
        let message = Message::Flight(FlightMessage::Command { target, order });
        let other = Address {
            system: 255,
            component: 190,
        };
        self.vehicles[index].handle(self.now, other, &message);
    }

    pub fn end(&self, index: usize) -> End {
        self.fleet
            .flown()
            .nth(index)
            .expect("a vehicle")
            .1
            .end
            .clone()
    }
}
