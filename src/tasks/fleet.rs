//! Who does which task of a fleet, and which stops its vehicle gets for it.
//!
//! A way is estimated by the shortest path past all that is closed at every altitude, flown at the
//! planned speed from rest to rest. Where a plan uses more than that, the estimate for its vehicle
//! is raised by [`Assigner::learn`], and the tasks are assigned again.

use super::assignment::{Assigned, Assignment, Carrier, Job, Spent, Visit, Way};
use crate::geodesy::PlanPoint;
use crate::numeric::SpeedProfile;
use crate::path::{TimedPoint, flight, route_ends, route_start_s, way_speed_mps};
use crate::plan::least_lengths_m;
use crate::spec::{MAX_STOPS, MissionSpec, Order, Stop, Vehicle};
use crate::world::World;

/// Nearer than this there is no route between two places, metres.
const LEAST_ROUTE_M: f64 = 10.0;
/// Parts of a budget.
const BUDGET: f64 = 1e9;
/// Units of time in a second.
const PER_SECOND: f64 = 10.0;
/// How long ways may take at first, in thousandths of their estimates.
const SLOWEST: u64 = 1030;
/// By how much more where a window was missed.
const SLOWER: u64 = 30;
/// Raised estimates are raised by this more.
const SURPLUS: f64 = 1.01;

/// The tasks of a fleet as they are assigned.
#[derive(Clone, Debug)]
pub struct FleetTasks {
    /// The spec with the tasks as stops of the vehicles that do them, in a fixed order.
    pub spec: MissionSpec,
    /// Its world.
    pub world: World,
    /// The tasks of each vehicle, in the order in which it begins them.
    pub done: Vec<Vec<AssignedTask>>,
    /// The tasks that no vehicle does, in the order of the spec.
    pub left: Vec<TaskLeft>,
    /// What each vehicle is estimated to use on its ways and in all, as parts of what it may.
    estimated: Vec<(f64, f64)>,
}

/// A task and the stops that its vehicle makes for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssignedTask {
    /// Name in the spec.
    pub id: String,
    /// Index of its first stop among those of the vehicle.
    pub first: usize,
    /// Index of its last stop.
    pub last: usize,
}

/// A task that no vehicle does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskLeft {
    /// Name in the spec.
    pub id: String,
    /// Why.
    pub why: String,
}

/// Assigns the tasks of a fleet to its vehicles.
#[derive(Clone, Debug)]
pub struct Assigner<'a> {
    spec: &'a MissionSpec,
    world: &'a World,
    seed: u64,
    /// All places: those of tasks, then start, stops and goal of each vehicle.
    points: Vec<PlanPoint>,
    /// Index of the place of each stop of each task.
    task_sites: Vec<Vec<usize>>,
    /// Index of the start of each vehicle.
    starts: Vec<usize>,
    lengths_m: Vec<Vec<f64>>,
    /// How much more each vehicle uses on its ways than the shortest ones would.
    factors: Vec<f64>,
    /// How long the ways of each vehicle may take, in thousandths of their estimates.
    slowest: Vec<u64>,
}

impl<'a> Assigner<'a> {
    /// Of a spec whose stops are in the order in which they are visited; none without tasks.
    #[must_use]
    pub fn new(spec: &'a MissionSpec, world: &'a World, seed: u64) -> Option<Self> {
        if spec.tasks.is_empty() {
            return None;
        }
        let mut points: Vec<PlanPoint> = Vec::new();
        let mut index_of = |point: &PlanPoint| {
            let known = points.iter().position(|known| known == point);
            known.unwrap_or_else(|| {
                points.push(*point);
                points.len() - 1
            })
        };
        let sites = world.tasks.iter();
        let task_sites = sites
            .map(|sites| sites.iter().map(&mut index_of).collect())
            .collect();
        let mut starts = Vec::new();
        for stations in &world.stations {
            starts.push(points.len());
            points.push(stations.start);
            points.extend(&stations.stops);
            points.push(stations.goal);
        }
        Some(Self {
            spec,
            world,
            seed,
            task_sites,
            starts,
            lengths_m: least_lengths_m(spec, world, &points),
            points,
            factors: vec![1.0; spec.vehicles.len()],
            slowest: vec![SLOWEST; spec.vehicles.len()],
        })
    }

    /// The tasks as they are assigned by what is known.
    #[must_use]
    pub fn assign(&self) -> FleetTasks {
        let jobs = self.jobs();
        let ways: Vec<Vec<Vec<Option<Way>>>> = (0..self.spec.vehicles.len())
            .map(|vehicle| self.ways(vehicle))
            .collect();
        let carriers: Vec<Carrier<'_>> = ways
            .iter()
            .enumerate()
            .map(|(vehicle, ways)| self.carrier(vehicle, ways))
            .collect();
        let assignment = Assignment {
            vehicles: &carriers,
            jobs: &jobs,
        };
        let assigned = assignment.assign(self.seed).unwrap_or_else(|| Assigned {
            visits: vec![Vec::new(); carriers.len()],
            left: (0..self.spec.tasks.len()).collect(),
            cost: 0,
        });
        let left = assigned.left.iter().map(|&task| TaskLeft {
            id: self.spec.tasks[task].id.clone(),
            why: self.why(&assignment, task),
        });
        let estimated = assigned.visits.iter().enumerate().map(|(vehicle, visits)| {
            let spent = assignment.go(vehicle, visits.iter().copied());
            let spent = spent.unwrap_or_default();
            let rest = float(spent.rest * carriers[vehicle].rest_uses);
            (float(spent.uses) - rest, float(spent.uses))
        });
        let mut tasks = FleetTasks {
            spec: self.spec.clone(),
            world: self.world.clone(),
            done: vec![Vec::new(); carriers.len()],
            left: left.collect(),
            estimated: estimated.collect(),
        };
        for (vehicle, visits) in assigned.visits.iter().enumerate() {
            let waits = assignment.waits(vehicle, visits);
            self.expand(&mut tasks, vehicle, (visits, &waits));
        }
        tasks
    }

    /// Raises the estimates of vehicles whose plans use more than they may: each by its index, and
    /// what its plan uses as a share of that. Whether a vehicle with tasks is among them.
    pub fn learn(&mut self, tasks: &FleetTasks, used: &[(usize, f64)]) -> bool {
        let mut learns = false;
        for &(index, share) in used {
            let (on_ways, in_all) = tasks.estimated[index];
            if on_ways > 0.0 && !tasks.done[index].is_empty() {
                let on_rests = in_all - on_ways;
                let planned = share * BUDGET - self.overhead(index) - on_rests;
                self.factors[index] *= (planned / on_ways).max(1.0) * SURPLUS;
                learns = true;
            }
        }
        learns
    }

    /// The tasks in their order, then the stops of each vehicle.
    fn jobs(&self) -> Vec<Job> {
        let fleet = &self.spec.vehicles;
        let tasks = self.spec.tasks.iter().zip(&self.task_sites);
        let tasks = tasks.enumerate().map(|(index, (task, sites))| Job {
            visits: visits(&task.stops, sites.iter().copied()),
            vehicles: (fleet.iter().enumerate())
                .map(|(vehicle, own)| task.is_for(own) && self.is_in_layer(vehicle, index))
                .collect(),
        });
        let own = fleet.iter().enumerate().map(|(index, vehicle)| Job {
            visits: visits(&vehicle.stops, self.own_first() + 1..),
            vehicles: (0..fleet.len()).map(|other| other == index).collect(),
        });
        tasks.chain(own).collect()
    }

    /// Number of places of tasks: the places of a vehicle have the numbers after them.
    fn own_first(&self) -> usize {
        self.starts.first().copied().unwrap_or(self.points.len())
    }

    /// Whether the limits of altitude of a vehicle hold the places of a task.
    fn is_in_layer(&self, vehicle: usize, task: usize) -> bool {
        let Some(layer) = self.world.layers.get(vehicle) else {
            return true;
        };
        let stops = &self.spec.tasks[task].stops;
        stops.iter().zip(&self.world.tasks[task]).all(|(stop, at)| {
            let ground = self.world.terrain.height(stop.end.place);
            let agl_m = ground.map_or(f64::INFINITY, |ground| at.amsl.above_ground(ground).0);
            agl_m <= layer.max_agl_m && at.amsl.0 >= layer.min_amsl_m
        })
    }

    /// The ways of a vehicle between the places of tasks, and its own start, stops and goal.
    fn ways(&self, vehicle: usize) -> Vec<Vec<Option<Way>>> {
        let (first, stops) = (
            self.starts[vehicle],
            self.spec.vehicles[vehicle].stops.len(),
        );
        let tasks = self.own_first();
        let sites: Vec<usize> = (0..tasks).chain(first..first + stops + 2).collect();
        let way = |from: usize, to: usize| self.way(vehicle, (sites[from], sites[to]), tasks);
        let row = |from| (0..sites.len()).map(|to| way(from, to)).collect();
        (0..sites.len()).map(row).collect()
    }

    fn way(&self, vehicle: usize, (from, to): (usize, usize), tasks: usize) -> Option<Way> {
        if from == to {
            return Some(Way { time: 0, uses: 0 });
        }
        let ends = (self.points[from], self.points[to]);
        let has_task = from < tasks || to < tasks;
        if has_task && ends.0.at.distance_m(ends.1.at) < LEAST_ROUTE_M {
            return None;
        }
        let own = &self.spec.vehicles[vehicle];
        let duration_s = duration_s(own, ends, self.lengths_m[from][to]);
        let used = self.used(vehicle, duration_s, ends) * self.factors[vehicle];
        Some(Way {
            time: whole(duration_s * PER_SECOND),
            uses: whole(used),
        })
    }

    /// What a way uses, as parts of what its vehicle may.
    fn used(&self, vehicle: usize, duration_s: f64, (from, to): (PlanPoint, PlanPoint)) -> f64 {
        let Some(endurance) = &self.spec.vehicles[vehicle].endurance else {
            return 0.0;
        };
        if duration_s <= 0.0 {
            return 0.0;
        }
        let [east_mps, north_mps] = self.wind_mps();
        let air_mps = ((to.at.east_m - from.at.east_m) / duration_s - east_mps)
            .hypot((to.at.north_m - from.at.north_m) / duration_s - north_mps);
        let up_mps = (to.amsl.0 - from.amsl.0) / duration_s;
        let used = endurance.capacity.used(duration_s, air_mps, up_mps);
        BUDGET * used / endurance.usable()
    }

    fn wind_mps(&self) -> [f64; 2] {
        self.spec.wind.map_or([0.0; 2], |wind| wind.velocity_mps())
    }

    fn carrier<'w>(&self, vehicle: usize, ways: &'w [Vec<Option<Way>>]) -> Carrier<'w> {
        let own = &self.spec.vehicles[vehicle];
        let [east_mps, north_mps] = self.wind_mps();
        let rest = own.endurance.as_ref().map_or(0.0, |endurance| {
            let used = (endurance.capacity).used(1.0 / PER_SECOND, east_mps.hypot(north_mps), 0.0);
            BUDGET * used / endurance.usable()
        });
        Carrier {
            ways,
            start: self.own_first(),
            goal: self.own_first() + own.stops.len() + 1,
            own: Some(self.spec.tasks.len() + vehicle),
            budget: match own.endurance {
                Some(_) => u64::from(whole(BUDGET - self.overhead(vehicle))),
                None => u64::MAX,
            },
            rest_uses: whole(rest).into(),
            most_visits: MAX_STOPS,
            begins: whole(route_start_s(own, &self.world.stations[vehicle]) * PER_SECOND).into(),
            slowest: self.slowest[vehicle],
            wait_step: 10,
        }
    }

    /// What takeoff, landing and return use, as parts of what a vehicle may use.
    fn overhead(&self, vehicle: usize) -> f64 {
        let (own, stations) = (&self.spec.vehicles[vehicle], &self.world.stations[vehicle]);
        let stops: Vec<Stop> = Vec::new();
        let (own, mut stations) = (
            Vehicle {
                stops,
                ..own.clone()
            },
            stations.clone(),
        );
        stations.stops.clear();
        let ends = route_ends(&own, &stations);
        let routes: Vec<Vec<PlanPoint>> = ends.iter().map(|ends| vec![ends.0, ends.1]).collect();
        let flown = flight(&own, &stations, &routes);
        let used = |pair: &[TimedPoint]| {
            let duration_s = pair[1].t_s - pair[0].t_s;
            match duration_s.is_finite() {
                true => self.used(vehicle, duration_s, (pair[0].point, pair[1].point)),
                false => 0.0,
            }
        };
        let moving = flown.points.windows(2);
        let moving = moving.skip_while(|pair| pair[0].point == pair[1].point);
        let whole: f64 = moving.map(used).sum();
        let straight = (stations.start, stations.goal);
        let straight_m = straight.0.distance_m(straight.1);
        let route = self.used(vehicle, duration_s(&own, straight, straight_m), straight);
        (whole - route).max(0.0)
    }

    /// Expects longer ways of these vehicles, whose plans miss windows.
    pub fn hurry(&mut self, late: &[usize]) {
        for &vehicle in late {
            self.slowest[vehicle] += SLOWER;
        }
    }

    /// Why a task found no vehicle.
    fn why(&self, assignment: &Assignment<'_>, task: usize) -> String {
        let fleet = self.spec.vehicles.iter().enumerate();
        let alone = fleet.filter_map(|(vehicle, own)| {
            let spent: Spent = assignment.alone(vehicle, task)?;
            Some((float(spent.uses) + self.overhead(vehicle), own))
        });
        let Some((uses, vehicle)) = alone.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return match self.has_window(task) {
                true => "no vehicle is there in its window, runs its actions and may fly there",
                false => "no vehicle runs its actions and may fly to its places",
            }
            .to_owned();
        };
        match &vehicle.endurance {
            Some(endurance) if uses > BUDGET => format!(
                "out of reach: with it alone {} uses about {:.0} of {:.0} {}",
                vehicle.id,
                uses / BUDGET * endurance.usable(),
                endurance.usable(),
                endurance.capacity.unit()
            ),
            _ if self.has_window(task) => {
                "no vehicle has the time in its window, and enough endurance left for it".to_owned()
            }
            _ => "no vehicle has enough endurance left for it".to_owned(),
        }
    }

    fn has_window(&self, task: usize) -> bool {
        let mut stops = self.spec.tasks[task].stops.iter();
        stops.any(|stop| stop.window_s.is_some())
    }

    /// Gives a vehicle its stops. Visits at one place that follow each other become one stop.
    fn expand(
        &self,
        tasks: &mut FleetTasks,
        vehicle: usize,
        (visits, waits): (&[(usize, usize)], &[u64]),
    ) {
        let count = self.spec.tasks.len();
        let place = |visit: &(usize, usize)| match visit.0 < count {
            true => (0, self.task_sites[visit.0][visit.1]),
            // Stops of its own are never merged.
            false => (1, visit.1),
        };
        let (mut stops, mut points) = (Vec::<Stop>::new(), Vec::new());
        let mut next = 0;
        for group in visits.chunk_by(|one, other| place(one) == place(other)) {
            let waits = &waits[next..next + group.len()];
            next += group.len();
            let mut group: Vec<_> = group.iter().copied().zip(waits.iter().copied()).collect();
            group.sort_unstable();
            for &((job, position), _) in group.iter().filter(|visit| visit.0.0 < count) {
                let done = &mut tasks.done[vehicle];
                match position {
                    0 => done.push(AssignedTask {
                        id: self.spec.tasks[job].id.clone(),
                        first: stops.len(),
                        last: stops.len(),
                    }),
                    _ => (done.iter_mut())
                        .filter(|task| task.id == self.spec.tasks[job].id)
                        .for_each(|task| task.last = stops.len()),
                }
            }
            let (first, position) = group[0].0;
            if first < count {
                let parts = group.iter().map(|&((job, at), wait)| Stop {
                    wait_s: float(wait) / PER_SECOND,
                    ..self.spec.tasks[job].stops[at].clone()
                });
                let merged = parts.reduce(|mut merged, part| {
                    merged.join(&part);
                    merged
                });
                stops.extend(merged);
                points.push(self.world.tasks[first][position]);
            } else {
                stops.push(self.spec.vehicles[vehicle].stops[position].clone());
                points.push(self.world.stations[vehicle].stops[position]);
            }
        }
        let own = &mut tasks.spec.vehicles[vehicle];
        (own.stops, own.order) = (stops, Order::Fixed);
        tasks.world.stations[vehicle].stops = points;
    }
}

/// The visits of stops at places.
fn visits(stops: &[Stop], sites: impl Iterator<Item = usize>) -> Vec<Visit> {
    let visit = |(stop, place): (&Stop, usize)| Visit {
        place,
        rest: whole(stop.rest_s() * PER_SECOND),
        window: (stop.window_s).map(|window| {
            let units = |s: f64| u64::from(whole(s * PER_SECOND));
            // Actions begin a second after the vehicle has come to rest.
            let last_s = window.most - f64::from(u8::from(!stop.actions.is_empty()));
            (units(window.least), units(last_s))
        }),
    };
    stops.iter().zip(sites).map(visit).collect()
}

/// How long a vehicle flies from rest to rest over a length.
fn duration_s(vehicle: &Vehicle, (from, to): (PlanPoint, PlanPoint), length_m: f64) -> f64 {
    let speed_mps = way_speed_mps(vehicle, from, to);
    let level_s = SpeedProfile::new(length_m, speed_mps, vehicle.accel_mps2).duration_s();
    let rise_m = to.amsl.0 - from.amsl.0;
    let upright_s = (rise_m / vehicle.climb_mps).max(-rise_m / vehicle.descent_mps);
    level_s.max(upright_s)
}

/// Rounded up, within the range.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "limited to the range before"
)]
fn whole(value: f64) -> u32 {
    value.ceil().clamp(0.0, f64::from(u32::MAX)) as u32
}

#[expect(clippy::cast_precision_loss, reason = "sums of parts of a budget")]
fn float(value: u64) -> f64 {
    value as f64
}
