//! One vehicle's path as something to minimise.

use std::sync::Mutex;

use super::route_context::Course;
use crate::cost::{Batch, Controls, CostModel, Margins, Scratch};
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::Basis;
use crate::optimize::Problem;
use crate::plan::altitude::floor::{FloorMaker, Track};
use crate::plan::altitude::{AltitudeLp, Demand, Row, Workspace};
use crate::spec::Objective;

/// Altitude over the floor that keeps the path clear between samples, metres.
const BETWEEN_SAMPLES_M: f64 = 3.0;

/// The part of the plane in which control points are searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    pub south_west: EastNorth,
    pub north_east: EastNorth,
}

impl Frame {
    /// A place from two numbers of [0, 1].
    pub(crate) fn place(&self, east: f64, north: f64) -> EastNorth {
        EastNorth {
            east_m: self.south_west.east_m
                + east * (self.north_east.east_m - self.south_west.east_m),
            north_m: self.south_west.north_m
                + north * (self.north_east.north_m - self.south_west.north_m),
        }
    }

    /// The two numbers of a place, clamped to [0, 1].
    pub(crate) fn share(&self, at: EastNorth) -> (f64, f64) {
        let share = |value: f64, low: f64, high: f64| {
            ((value - low) / (high - low).max(1e-9)).clamp(0.0, 1.0)
        };
        (
            share(at.east_m, self.south_west.east_m, self.north_east.east_m),
            share(at.north_m, self.south_west.north_m, self.north_east.north_m),
        )
    }

    /// Places from numbers in pairs.
    pub(crate) fn places(&self, numbers: &[f64]) -> impl Iterator<Item = EastNorth> {
        let pairs = numbers.chunks_exact(2);
        pairs.map(|pair| self.place(pair[0], pair[1]))
    }

    /// The numbers of places, in pairs.
    pub(crate) fn shares(&self, places: impl IntoIterator<Item = EastNorth>) -> Vec<f64> {
        let pair = |at: EastNorth| {
            let (east, north) = self.share(at);
            [east, north]
        };
        places.into_iter().flat_map(pair).collect()
    }

    /// A distance in metres as steps of the two numbers, for so many numbers in pairs.
    pub(crate) fn scale(&self, distance_m: f64, numbers: usize) -> Vec<f64> {
        let width_m = self.north_east.east_m - self.south_west.east_m;
        let height_m = self.north_east.north_m - self.south_west.north_m;
        let pair = [
            distance_m / width_m.max(1e-9),
            distance_m / height_m.max(1e-9),
        ];
        pair.into_iter().cycle().take(numbers).collect()
    }
}

/// Control points of one spline by coordinate, ends included.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Spline {
    pub east_m: Vec<f64>,
    pub north_m: Vec<f64>,
    pub amsl_m: Vec<f64>,
}

impl Spline {
    /// Only the ends, and zeros between them.
    fn reset(&mut self, from: PlanPoint, to: PlanPoint, controls: usize) {
        let ends = |values: &mut Vec<f64>, first: f64, last: f64| {
            values.clear();
            values.resize(controls, 0.0);
            values[0] = first;
            values[controls - 1] = last;
        };
        ends(&mut self.east_m, from.at.east_m, to.at.east_m);
        ends(&mut self.north_m, from.at.north_m, to.at.north_m);
        ends(&mut self.amsl_m, from.amsl.0, to.amsl.0);
    }

    /// Of these control points, ends included.
    pub(crate) fn through(points: &[PlanPoint]) -> Self {
        Self {
            east_m: points.iter().map(|point| point.at.east_m).collect(),
            north_m: points.iter().map(|point| point.at.north_m).collect(),
            amsl_m: points.iter().map(|point| point.amsl.0).collect(),
        }
    }

    pub(crate) fn controls(&self) -> Controls<'_> {
        Controls {
            east_m: &self.east_m,
            north_m: &self.north_m,
            amsl_m: &self.amsl_m,
        }
    }

    /// The control points.
    pub(crate) fn points(&self) -> Vec<PlanPoint> {
        self.east_m
            .iter()
            .zip(&self.north_m)
            .zip(&self.amsl_m)
            .map(|((&east, &north), &amsl)| PlanPoint::new(east, north, Amsl(amsl)))
            .collect()
    }
}

/// A path sampled at given parameters: its objective, and the altitude decoder.
pub(crate) struct Sampled<'a> {
    basis: Basis,
    model: CostModel,
    lowest: AltitudeLp,
    floor: FloorMaker<'a>,
    /// Samples count alike, whatever the distance between them (the paper's sums).
    even: bool,
    from: PlanPoint,
    to: PlanPoint,
    controls: usize,
    /// Rooms that are not in use.
    rooms: Mutex<Vec<Room>>,
}

/// What one thread decodes and evaluates in.
#[derive(Default)]
pub(crate) struct Room {
    spline: Spline,
    east_m: Vec<f64>,
    north_m: Vec<f64>,
    demand: Demand,
    lengths_m: Vec<f64>,
    lowest: Workspace,
    batch: Batch,
    scratch: Scratch,
    /// Costs as they run up along the paths of the batch.
    along: Vec<f64>,
}

impl<'a> Sampled<'a> {
    /// The samples of a course at `parameters` of [0, 1]; `margins` are those of the
    /// objective.
    pub(crate) fn new(course: &Course<'a>, margins: Margins, parameters: &[f64]) -> Self {
        Self::above(course, margins, parameters, BETWEEN_SAMPLES_M)
    }

    /// The same, with so many metres over the floor in the altitudes that are decoded.
    pub(crate) fn above(
        course: &Course<'a>,
        margins: Margins,
        parameters: &[f64],
        above_m: f64,
    ) -> Self {
        let controls = course.controls();
        let basis = Basis::new(controls, parameters);
        let rows = (0..parameters.len()).map(|k| basis.row(k)).collect();
        Self {
            lowest: AltitudeLp::new(rows, controls),
            model: course.model(margins, parameters),
            floor: course.floor(above_m, margins.climb_fraction),
            even: course.spec.planner.objective == Objective::Paper,
            from: course.leg.from,
            to: course.leg.to,
            controls,
            basis,
            rooms: Mutex::default(),
        }
    }

    /// The same with violated limits so many times dearer.
    pub(crate) fn with_penalties(mut self, factor: f64) -> Self {
        self.model = self.model.with_penalties(factor);
        self
    }

    /// Works in a room that was used before, if there is one.
    fn in_room(&self, act: impl FnOnce(&mut Room)) {
        let kept = self.rooms.lock().ok().and_then(|mut rooms| rooms.pop());
        let mut room = kept.unwrap_or_default();
        act(&mut room);
        if let Ok(mut rooms) = self.rooms.lock() {
            rooms.push(room);
        }
    }

    /// Weights of the control points in each sample.
    pub(crate) fn rows(&self) -> Vec<Row> {
        (0..self.basis.samples())
            .map(|k| self.basis.row(k))
            .collect()
    }

    /// First and last block of the objective that a control point has a share in.
    fn window(&self, control: usize) -> (usize, usize) {
        let shares = |k: &usize| {
            let (first, _) = self.basis.row(*k);
            (first..first + 4).contains(&control)
        };
        let mut samples = (0..self.basis.samples()).filter(shares);
        let first = samples.next().unwrap_or(0);
        self.model.blocks_of(first, samples.last().unwrap_or(first))
    }

    /// A spline in the plane between the ends, through its free control points.
    fn outline(&self, free: impl Iterator<Item = EastNorth>, spline: &mut Spline) {
        spline.reset(self.from, self.to, self.controls);
        for (j, at) in free.enumerate() {
            spline.east_m[j + 1] = at.east_m;
            spline.north_m[j + 1] = at.north_m;
        }
    }

    /// The lowest spline over free control points in the plane.
    pub(crate) fn decode(&self, free: impl Iterator<Item = EastNorth>, room: &mut Room) {
        let spline = &mut room.spline;
        self.outline(free, spline);
        let samples = self.basis.samples();
        self.lowest.sample(&spline.east_m, &mut room.east_m);
        self.lowest.sample(&spline.north_m, &mut room.north_m);
        let track = Track {
            east_m: &room.east_m,
            north_m: &room.north_m,
            ends_m: (self.from.amsl.0, self.to.amsl.0),
        };
        self.floor
            .fill(&track, &mut room.demand, &mut room.lengths_m);
        let weights = &mut room.demand.weights;
        weights.clear();
        if self.even {
            weights.resize(samples, 1.0);
        } else {
            let length = |k: usize| room.lengths_m.get(k).copied().unwrap_or(0.0);
            weights.extend(
                (0..samples).map(|k| 0.5 * (length(k) + if k > 0 { length(k - 1) } else { 0.0 })),
            );
        }
        self.lowest
            .solve(&room.demand, &mut spline.amsl_m, &mut room.lowest);
    }

    /// The decoded spline of free control points in the plane.
    pub(crate) fn spline(&self, free: impl Iterator<Item = EastNorth>) -> Spline {
        let mut room = Room::default();
        self.decode(free, &mut room);
        room.spline
    }
}

/// Search of the horizontal control points alone: the altitude is decoded.
pub(crate) struct Horizontal<'a> {
    pub sampled: Sampled<'a>,
    pub frame: Frame,
    /// First and last block of the objective in which each free control point moves the path;
    /// none if only whole paths are told apart.
    windows: Vec<(usize, usize)>,
    /// The same with other penalties, to begin with.
    eased: Option<Box<Horizontal<'a>>>,
}

impl<'a> Horizontal<'a> {
    /// The search of a sampled path, in `windows` or as a whole. The paper's sums are a whole.
    pub(crate) fn new(sampled: Sampled<'a>, frame: Frame, windows: bool) -> Self {
        let free = match windows && !sampled.even {
            true => 1..sampled.controls - 1,
            false => 0..0,
        };
        Self {
            windows: free.map(|control| sampled.window(control)).collect(),
            sampled,
            frame,
            eased: None,
        }
    }

    /// A search that may begin with another of the same path.
    pub(crate) fn begun_with(self, eased: Option<Self>) -> Self {
        Self {
            eased: eased.map(Box::new),
            ..self
        }
    }

    /// Decodes candidates into the batch of a room.
    fn decode(&self, candidates: &[f64], room: &mut Room) {
        room.batch.clear(self.sampled.controls);
        // Candidates of one call lie near each other: each begins where the one before
        // ended, the first where all do, so that equal calls give equal bytes.
        room.lowest.begin_anew();
        for candidate in candidates.chunks_exact(self.dimension()) {
            self.sampled.decode(self.frame.places(candidate), room);
            room.batch.push(&room.spline.controls());
        }
    }
}

impl Problem for Horizontal<'_> {
    fn dimension(&self) -> usize {
        2 * (self.sampled.controls - 2)
    }

    fn evaluate(&self, candidates: &[f64], cutoff: f64, costs: &mut [f64]) {
        self.sampled.in_room(|room| {
            self.decode(candidates, room);
            self.sampled
                .model
                .totals(&room.batch, cutoff, &mut room.scratch, costs);
        });
    }

    fn eased(&self) -> Option<&dyn Problem> {
        let eased = self.eased.as_deref()?;
        Some(eased)
    }

    fn groups(&self) -> usize {
        self.windows.len().max(1)
    }

    /// The part of a control point is what its blocks cost, and all collisions: a detour makes
    /// the whole way behind it later. What its altitude moves beyond them is not seen.
    fn evaluate_parts(&self, candidates: &[f64], costs: &mut [f64], parts: &mut [f64]) {
        if self.windows.is_empty() {
            self.evaluate(candidates, f64::INFINITY, costs);
            parts.copy_from_slice(costs);
            return;
        }
        let model = &self.sampled.model;
        let blocks = model.blocks();
        self.sampled.in_room(|room| {
            self.decode(candidates, room);
            room.along.resize(costs.len() * blocks, 0.0);
            model.totals_along(&room.batch, &mut room.scratch, costs, &mut room.along);
            let along = room.along.chunks_exact(blocks).zip(costs);
            let rows = parts.chunks_exact_mut(self.windows.len()).zip(along);
            for (parts, (along, cost)) in rows {
                let collisions = *cost - along[blocks - 1];
                for (part, &(first, last)) in parts.iter_mut().zip(&self.windows) {
                    let before = if first > 0 { along[first - 1] } else { 0.0 };
                    *part = along[last] - before + collisions;
                }
            }
        });
    }
}

/// Search of all three coordinates, as in the paper: first all east, then all north,
/// then all altitudes (Eq. 33).
pub(crate) struct Spatial<'a> {
    pub sampled: Sampled<'a>,
    pub frame: Frame,
    /// Lowest and highest altitude of a control point, metres above the sea.
    pub amsl_m: (f64, f64),
}

impl Spatial<'_> {
    /// The spline of a candidate.
    pub(crate) fn spline(&self, candidate: &[f64], spline: &mut Spline) {
        let sampled = &self.sampled;
        spline.reset(sampled.from, sampled.to, sampled.controls);
        let free = sampled.controls - 2;
        for j in 0..free {
            let at = self.frame.place(candidate[j], candidate[free + j]);
            spline.east_m[j + 1] = at.east_m;
            spline.north_m[j + 1] = at.north_m;
            spline.amsl_m[j + 1] =
                self.amsl_m.0 + candidate[2 * free + j] * (self.amsl_m.1 - self.amsl_m.0);
        }
    }
}

impl Problem for Spatial<'_> {
    fn dimension(&self) -> usize {
        3 * (self.sampled.controls - 2)
    }

    fn evaluate(&self, candidates: &[f64], cutoff: f64, costs: &mut [f64]) {
        self.sampled.in_room(|room| {
            room.batch.clear(self.sampled.controls);
            for candidate in candidates.chunks_exact(self.dimension()) {
                self.spline(candidate, &mut room.spline);
                room.batch.push(&room.spline.controls());
            }
            self.sampled
                .model
                .totals(&room.batch, cutoff, &mut room.scratch, costs);
        });
    }
}

#[cfg(test)]
mod tests;
