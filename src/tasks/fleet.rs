//! Who does which task of a fleet, and which stops its vehicle gets for it.
//!
//! A way is estimated by the shortest path past all that is closed at every altitude, flown at the
//! planned speed from rest to rest. Where a plan uses more than that, the estimate for its vehicle
//! is raised by [`Assigner::learn`], and the tasks are assigned again.

mod estimate;
mod expand;
mod in_time;
mod route_estimates;
mod unassigned;

use in_time::InTime;
use route_estimates::Trial;

use super::areas::{Layout, SweepLine, lay_out};
use super::assignment::{Assigned, Assignment, Carrier, Form, Job, Visit};
use crate::geodesy::{Amsl, PlanPoint};
use crate::plan::min_lengths_m;
use crate::spec::{MissionSpec, Stop, Sweep, Task};
use crate::world::World;

/// Places of visits and loads as near as this are one, metres: there is no way from one to the other.
const SAME_PLACE_M: f64 = 1.0;
/// Parts of a budget.
const BUDGET: f64 = 1e9;
/// Units of time in a second.
const PER_SECOND: f64 = 10.0;
/// How long ways may take, in thousandths of their estimates.
const SLOWEST: u64 = 1030;

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

impl FleetTasks {
    /// Takes a spec and its world that have more stops than those of the tasks.
    pub(crate) fn add_stops(&mut self, (spec, world): (MissionSpec, World)) {
        let fleets = self.spec.vehicles.iter().zip(&spec.vehicles);
        for ((own, with_more), tasks) in fleets.zip(&mut self.done) {
            let is_own = |stop: &Stop| own.stops.iter().any(|known| known.id == stop.id);
            let all = with_more.stops.iter().enumerate();
            let now: Vec<usize> = (all.filter(|(_, stop)| is_own(stop)))
                .map(|(index, _)| index)
                .collect();
            let moved = |index: usize| now.get(index).copied().unwrap_or(index);
            for task in tasks {
                (task.first, task.last) = (moved(task.first), moved(task.last));
            }
        }
        (self.spec, self.world) = (spec, world);
    }
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
    /// Of a task with lines: those that it flies, in this order, from 1; negative ones from their
    /// end to their begin.
    pub lines: Vec<i32>,
}

/// A task that no vehicle does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskLeft {
    /// Name in the spec.
    pub id: String,
    /// Why.
    pub why: String,
}

/// What one vehicle does as a whole: a task, or a line of one.
#[derive(Clone, Debug)]
struct Unit {
    task: usize,
    line: Option<usize>,
    /// Index of each of its places.
    sites: Vec<usize>,
}

/// Assigns the tasks of a fleet to its vehicles.
#[derive(Clone, Debug)]
pub struct Assigner<'a> {
    spec: &'a MissionSpec,
    world: &'a World,
    seed: u64,
    /// All places: those of tasks, then start, stops and goal of each vehicle.
    points: Vec<PlanPoint>,
    /// What is assigned: in order of the tasks, and of the lines of each.
    units: Vec<Unit>,
    /// The lines of each task; none of those without.
    layouts: Vec<Option<Layout>>,
    /// Index of the start of each vehicle.
    starts: Vec<usize>,
    lengths_m: Vec<Vec<f64>>,
    /// How much more each vehicle uses on its ways than the shortest ones would.
    factors: Vec<f64>,
    /// By how much each vehicle may be later than estimated, seconds: its plans missed windows by that.
    later_s: Vec<f64>,
    /// How the tasks are assigned, by what did not pass before.
    trial: Trial,
    /// The times of zones that places lie in; none: these are not minded.
    in_time: Option<InTime>,
}

/// Places of visits and loads.
#[derive(Default)]
struct Sites {
    points: Vec<PlanPoint>,
    /// Depth of the drop below each, metres.
    depths_m: Vec<f64>,
}

impl Sites {
    /// The index of a place. Drops of other depths there are no one stop, and no way leads from one to the
    /// other.
    fn index_of(&mut self, point: PlanPoint, drop_m: f64) -> usize {
        let mut known = self.points.iter().zip(&self.depths_m);
        let known = known.position(|(known, depth_m)| {
            known.distance_m(point) <= SAME_PLACE_M && depth_m.total_cmp(&drop_m).is_eq()
        });
        known.unwrap_or_else(|| {
            self.points.push(point);
            self.depths_m.push(drop_m);
            self.points.len() - 1
        })
    }
}

impl<'a> Assigner<'a> {
    /// Of a spec whose stops are in the order in which they are visited; none without tasks.
    #[must_use]
    pub fn new(spec: &'a MissionSpec, world: &'a World, seed: u64) -> Option<Self> {
        (!spec.tasks.is_empty()).then(|| Self::of(spec, world, seed))
    }

    /// Of any spec.
    #[must_use]
    pub fn of(spec: &'a MissionSpec, world: &'a World, seed: u64) -> Self {
        let mut sites = Sites::default();
        let mut units = Vec::new();
        for (task, points) in world.tasks.iter().enumerate() {
            if spec.tasks[task].sweep.is_none() {
                let stops = points.iter().zip(&spec.tasks[task].stops);
                let sites = stops.map(|(at, stop)| sites.index_of(*at, stop.drop_m));
                units.push(Unit {
                    task,
                    line: None,
                    sites: sites.collect(),
                });
            }
        }
        let mut points = sites.points;
        let tasks = spec.tasks.iter();
        let layouts = tasks.map(|task| Some(lay_out(task.sweep.as_ref()?, world)));
        let layouts: Vec<Option<Layout>> = layouts.collect();
        for (task, layout) in layouts.iter().enumerate() {
            let lines = layout.iter().flat_map(|layout| &layout.lines).enumerate();
            for (number, line) in lines {
                // Places of lines are never those of others: they are flown at their own speed.
                let first = points.len();
                points.extend(over_ground(line, spec.tasks[task].sweep.as_ref(), world));
                units.push(Unit {
                    task,
                    line: Some(number),
                    sites: (first..points.len()).collect(),
                });
            }
        }
        let mut starts = Vec::new();
        for sites in &world.sites {
            starts.push(points.len());
            points.push(sites.start);
            points.extend(&sites.stops);
            points.push(sites.goal);
        }
        Self {
            spec,
            world,
            seed,
            units,
            layouts,
            starts,
            lengths_m: min_lengths_m(spec, world, &points),
            points,
            factors: vec![1.0; spec.vehicles.len()],
            later_s: vec![0.0; spec.vehicles.len()],
            trial: Trial::default(),
            in_time: None,
        }
    }

    /// The tasks as they are assigned by what is known.
    #[must_use]
    pub fn assign(&self) -> FleetTasks {
        let jobs = self.jobs();
        let fleet = 0..self.spec.vehicles.len();
        let known: Vec<_> = fleet
            .map(|vehicle| (self.ways(vehicle), self.closed(vehicle)))
            .collect();
        let carriers: Vec<Carrier<'_>> = (known.iter().enumerate())
            .map(|(vehicle, (ways, closed))| self.carrier(vehicle, ways, closed))
            .collect();
        let assignment = Assignment {
            vehicles: &carriers,
            jobs: &jobs,
        };
        let assigned = assignment.assign(self.seed).unwrap_or_else(|| Assigned {
            visits: vec![Vec::new(); carriers.len()],
            left: (0..self.units.len()).collect(),
            cost: 0,
        });
        let left = self.left(&assignment, &assigned.left);
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
            left,
            estimated: estimated.collect(),
        };
        for (vehicle, visits) in assigned.visits.iter().enumerate() {
            let waits = assignment.waits(vehicle, visits);
            self.expand(&mut tasks, vehicle, (visits, &waits));
        }
        tasks
    }

    /// The tasks in their order, then the stops of each vehicle.
    fn jobs(&self) -> Vec<Job> {
        let fleet = &self.spec.vehicles;
        let units = self.units.iter().map(|unit| {
            let task = &self.spec.tasks[unit.task];
            let vehicles = fleet
                .iter()
                .enumerate()
                .map(|(vehicle, own)| task.is_for(own) && self.is_in_layer(vehicle, unit.task));
            Job {
                visits: match self.line(unit) {
                    Some(_) => unit.sites.iter().map(|place| at_line(*place)).collect(),
                    None => visits(&task.stops, unit.sites.iter().copied(), &|stop| {
                        self.longest_stay_s(task, stop)
                    }),
                },
                form: match self.line(unit) {
                    Some(line) if line.is_reversible => Form::EitherWay,
                    Some(_) => Form::Together,
                    None => Form::Open,
                },
                vehicles: vehicles.collect(),
            }
        });
        let own = fleet.iter().enumerate().map(|(index, vehicle)| Job {
            visits: visits(&vehicle.stops, self.own_first() + 1.., &|stop| {
                vehicle.stay_s(stop)
            }),
            form: Form::Open,
            vehicles: (0..fleet.len()).map(|other| other == index).collect(),
        });
        units.chain(own).collect()
    }

    fn line(&self, unit: &Unit) -> Option<&SweepLine> {
        self.layouts[unit.task].as_ref()?.lines.get(unit.line?)
    }

    /// Number of places of tasks: the places of a vehicle have the numbers after them.
    fn own_first(&self) -> usize {
        self.starts.first().copied().unwrap_or(self.points.len())
    }

    /// How long any vehicle that may do a task stays at a place of it, seconds.
    fn longest_stay_s(&self, task: &Task, stop: &Stop) -> f64 {
        let able = self.spec.vehicles.iter().filter(|own| task.is_for(own));
        let stays_s = able.map(|own| own.stay_s(stop));
        stays_s.fold(stop.rest_s(), f64::max)
    }

    /// Whether the limits of altitude of a vehicle hold the places of a task.
    fn is_in_layer(&self, vehicle: usize, task: usize) -> bool {
        let Some(layer) = self.world.layers.get(vehicle) else {
            return true;
        };
        let stops = &self.spec.tasks[task].stops;
        let sweep = self.spec.tasks[task].sweep.as_ref();
        if sweep.is_some_and(|sweep| sweep.agl.0 > layer.max_agl_m) {
            return false;
        }
        stops.iter().zip(&self.world.tasks[task]).all(|(stop, at)| {
            let ground = self.world.terrain.height(stop.end.place);
            let agl_m = ground.map_or(f64::INFINITY, |ground| at.amsl.above_ground(ground).0);
            agl_m <= layer.max_agl_m && at.amsl.0 >= layer.min_amsl_m
        })
    }
}

/// Where a line is flown, at its height above the ground; without data at that of its task.
fn over_ground(line: &SweepLine, sweep: Option<&Sweep>, world: &World) -> Vec<PlanPoint> {
    let agl_m = sweep.map_or(0.0, |sweep| sweep.agl.0);
    let at = line.points.iter().map(|&at| {
        let ground = world.terrain.height_at(&world.frame, at);
        PlanPoint {
            at,
            amsl: Amsl(ground.map_or(0.0, |ground| ground.0) + agl_m),
        }
    });
    at.collect()
}

/// The rest at a corner of a line.
fn at_line(place: usize) -> Visit {
    Visit {
        place,
        rest: whole(PER_SECOND),
        window: None,
        depth: None,
    }
}

/// The visits of stops at places.
fn visits(
    stops: &[Stop],
    sites: impl Iterator<Item = usize>,
    stay_s: &dyn Fn(&Stop) -> f64,
) -> Vec<Visit> {
    let visit = |(stop, place): (&Stop, usize)| Visit {
        place,
        rest: whole(stay_s(stop) * PER_SECOND),
        window: (stop.window_s).map(|window| {
            let units = |s: f64| u64::from(whole(s * PER_SECOND));
            // Actions begin a second after the vehicle has come to rest.
            let last_s = window.most - f64::from(u8::from(!stop.actions.is_empty()));
            (units(window.least), units(last_s))
        }),
        depth: Some(stop.drop_m.to_bits()),
    };
    stops.iter().zip(sites).map(visit).collect()
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
