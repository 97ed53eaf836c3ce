//! Stops of a vehicle for what it does.

use super::{AssignedTask, Assigner, FleetTasks, PER_SECOND, Unit, float};
use crate::geodesy::{Agl, EastNorth, PlanPoint};
use crate::path::VehicleLimits;
use crate::spec::{Arrival, EndPoint, Order, Placement, Stop, StopAction, Sweep, Vehicle};
use crate::tasks::areas::{Sampled, lifted};

/// The part of the slope limits that lines use: their altitudes are smooth curves.
const SLOPES: f64 = 0.8;
/// Ends of lines are this much higher than they need be, metres, where the greatest height allows.
const ABOVE_M: f64 = 1.0;
/// Encoding raises a point by less than this, metres.
const ENCODED_M: f64 = 0.25;

/// What turns a camera straight down again after what a vehicle does before a line.
fn looks_down(vehicle: &Vehicle, before: &[Stop]) -> Vec<StopAction> {
    let (mut points_at, mut is_turned, mut is_steered) = (false, false, false);
    let at_stops = before.iter().flat_map(|stop| &stop.actions);
    for action in vehicle.on_way.start.iter().chain(at_stops) {
        match *action {
            StopAction::Gimbal { pitch_deg, yaw_deg } => {
                (is_steered, is_turned) = (true, (pitch_deg, yaw_deg) != (-90, 0));
            }
            StopAction::Roi(_) => (points_at, is_turned) = (true, is_steered),
            StopAction::RoiNone => points_at = false,
            _ => {}
        }
    }
    let down = StopAction::Gimbal {
        pitch_deg: -90,
        yaw_deg: 0,
    };
    let no_longer = points_at.then_some(StopAction::RoiNone);
    no_longer
        .into_iter()
        .chain(is_turned.then_some(down))
        .collect()
}

/// Stops and where they are.
#[derive(Default)]
struct Stops {
    stops: Vec<Stop>,
    points: Vec<PlanPoint>,
}

impl Assigner<'_> {
    /// Gives a vehicle its stops. Visits at one place that follow each other become one stop.
    pub(super) fn expand(
        &self,
        tasks: &mut FleetTasks,
        vehicle: usize,
        (visits, waits): (&[(usize, usize)], &[u64]),
    ) {
        let count = self.units.len();
        let place = |visit: &(usize, usize)| match self.units.get(visit.0) {
            Some(unit) if unit.line.is_some() => (2, unit.sites[visit.1], 0),
            Some(unit) => {
                let drop_m = self.spec.tasks[unit.task].stops[visit.1].drop_m;
                (0, unit.sites[visit.1], drop_m.to_bits())
            }
            // Stops of its own are never merged.
            None => (1, visit.1, 0),
        };
        let mut made = Stops::default();
        let mut next = 0;
        for group in visits.chunk_by(|one, other| place(one) == place(other)) {
            let waits = &waits[next..next + group.len()];
            next += group.len();
            let mut group: Vec<_> = group.iter().copied().zip(waits.iter().copied()).collect();
            group.sort_unstable();
            for &(visit, _) in group.iter().filter(|visit| visit.0.0 < count) {
                self.note(&mut tasks.done[vehicle], visit, made.stops.len());
            }
            let (first, position) = group[0].0;
            let Some(unit) = self.units.get(first) else {
                let own = &self.spec.vehicles[vehicle];
                made.stops.push(own.stops[position].clone());
                made.points.push(self.world.sites[vehicle].stops[position]);
                continue;
            };
            if unit.line.is_some() {
                self.on_line(
                    &mut made,
                    vehicle,
                    (unit, position),
                    visits.get(next.wrapping_sub(2)),
                );
                continue;
            }
            let parts = group.iter().map(|&((job, at), wait)| Stop {
                wait_s: float(wait) / PER_SECOND,
                ..self.spec.tasks[self.units[job].task].stops[at].clone()
            });
            let merged = parts.reduce(|mut merged, part| {
                merged.join(&part);
                merged
            });
            made.stops.extend(merged);
            made.points.push(self.points[unit.sites[position]]);
        }
        self.lift(&mut made, vehicle);
        let own = &mut tasks.spec.vehicles[vehicle];
        (own.stops, own.order) = (made.stops, Order::Fixed);
        tasks.world.sites[vehicle].stops = made.points;
    }

    /// Notes who does a task, or a line of one.
    fn note(&self, done: &mut Vec<AssignedTask>, (job, position): (usize, usize), stop: usize) {
        let unit = &self.units[job];
        let id = &self.spec.tasks[unit.task].id;
        let last = unit.sites.len() - 1;
        let number = unit
            .line
            .map(|line| i32::try_from(line + 1).unwrap_or(i32::MAX));
        let number = number.map(|number| if position == 0 { number } else { -number });
        match (number, done.last_mut()) {
            (Some(number), Some(task)) if task.id == *id => {
                if !task.lines.iter().any(|line| line.abs() == number.abs()) {
                    task.lines.push(number);
                }
                task.last = stop;
            }
            (None, _) if position > 0 => (done.iter_mut())
                .filter(|task| task.id == *id)
                .for_each(|task| task.last = stop),
            _ if position == 0 || position == last => done.push(AssignedTask {
                id: id.clone(),
                first: stop,
                last: stop,
                lines: number.into_iter().collect(),
            }),
            _ => {}
        }
    }

    /// The stop at the end or at a corner of a line.
    fn on_line(
        &self,
        made: &mut Stops,
        vehicle: usize,
        (unit, position): (&Unit, usize),
        before: Option<&(usize, usize)>,
    ) {
        let task = &self.spec.tasks[unit.task];
        let (Some(sweep), Some(layout), Some(line)) =
            (&task.sweep, &self.layouts[unit.task], unit.line)
        else {
            return;
        };
        let of_unit = |visit: &&(usize, usize)| self.units.get(visit.0).is_some();
        let before = before.filter(of_unit).map(|visit| &self.units[visit.0]);
        let is_on = before.is_some_and(|before| std::ptr::eq(before, unit));
        let follows = before.is_some_and(|before| before.line.is_some());
        // A line is entered at its first place or at its last one, and left at the other.
        let is_end = is_on && [0, unit.sites.len() - 1].contains(&position);
        let own = &self.spec.vehicles[vehicle];
        let trigger_m = layout.trigger_m.filter(|_| !is_on || is_end);
        let speed_mps = sweep.speed_mps.filter(|_| !is_on || is_end);
        made.stops.push(Stop {
            id: format!("{}.{}.{}", task.id, line + 1, position + 1),
            end: self.end_point(unit.sites[position], sweep),
            drop_m: 0.0,
            hold_s: 0.0,
            acceptance_radius_m: None,
            heading_rad: None,
            actions: match (is_on, sweep.sensor) {
                (false, Some(_)) => looks_down(own, &made.stops),
                _ => Vec::new(),
            },
            speed_mps: speed_mps.map(|speed_mps| if is_end { own.speed_mps } else { speed_mps }),
            window_s: None,
            wait_s: 0.0,
            arrives: match (is_on, follows) {
                (true, _) => Arrival::OnLine(sweep.agl),
                (false, true) => Arrival::Straight,
                (false, false) => Arrival::Planned,
            },
            trigger_m: trigger_m.map(|trigger_m| if is_end { 0.0 } else { trigger_m }),
        });
        made.points.push(self.points[unit.sites[position]]);
    }

    fn end_point(&self, site: usize, sweep: &Sweep) -> EndPoint {
        EndPoint {
            place: self.world.frame.from_plan(self.points[site].at),
            altitude: Placement::Agl(Agl(sweep.agl.0)),
        }
    }

    /// Raises the ends of lines to where climbs and descents allow what lies between.
    fn lift(&self, made: &mut Stops, vehicle: usize) {
        let is_line = |stop: &Stop| stop.arrives != Arrival::Planned;
        let mut first = 0;
        while first < made.stops.len() {
            let rest = made.stops.get(first + 1..).unwrap_or_default();
            let joined = rest.iter().take_while(|stop| is_line(stop)).count();
            if joined > 0 {
                self.lift_chain(made, (first, first + joined), vehicle);
            }
            first += joined + 1;
        }
    }

    fn lift_chain(&self, made: &mut Stops, (first, last): (usize, usize), vehicle: usize) {
        let layer = self.world.layers.get(vehicle);
        let max_m = layer.map_or(f64::INFINITY, |layer| layer.max_agl_m);
        let vehicle = &self.spec.vehicles[vehicle];
        let stops = &made.stops[first..=last];
        let fastest = stops.iter().filter_map(|stop| stop.speed_mps);
        let flown = Vehicle {
            speed_mps: fastest.fold(vehicle.speed_mps, f64::max),
            ..vehicle.clone()
        };
        let limits = VehicleLimits::of(&flown);
        let high = self.world.max_amsl;
        let slopes = (
            SLOPES * limits.climb.at(high),
            SLOPES * limits.descent.at(high),
        );
        let at: Vec<EastNorth> = made.points[first..=last]
            .iter()
            .map(|point| point.at)
            .collect();
        let legs = at.windows(2).zip(&stops[1..]).map(|(pair, stop)| Sampled {
            from: pair[0],
            to: pair[1],
            above_m: match stop.arrives {
                Arrival::OnLine(agl) => agl.0 + ABOVE_M.min((max_m - agl.0 - ENCODED_M).max(0.0)),
                _ => self.world.min_agl.0 + ABOVE_M,
            },
        });
        let points = lifted(&legs.collect::<Vec<_>>(), self.world, slopes);
        let mut sampled = points.iter();
        for point in &mut made.points[first..=last] {
            let found = sampled
                .by_ref()
                .find(|sample| sample.at.distance_m(point.at) < 1e-6);
            if let Some(found) = found.filter(|found| found.amsl.0.is_finite()) {
                point.amsl = found.amsl;
            }
        }
    }
}
