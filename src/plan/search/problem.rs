//! One vehicle's path as something to minimise.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::cost::{Batch, CostModel, Margins, Scratch};
use crate::geodesy::{EastNorth, PlanPoint};
use crate::numeric::Basis;
use crate::optimize::Problem;
use crate::plan::altitude::floor::{FloorMaker, SampledLine};
use crate::plan::altitude::{AltitudeLp, Demand, Row, Workspace};
use crate::plan::route_context::RouteContext;
use crate::plan::spline::{Frame, Spline};
use crate::spec::{Objective, Placement};
use crate::world::PlanZone;

/// Altitude over the floor that keeps the path clear between samples, metres.
const BETWEEN_SAMPLES_M: f64 = 3.0;

/// A path sampled at given parameters: its objective, and the altitude decoder.
pub(crate) struct Sampled<'a> {
    basis: Basis,
    model: CostModel,
    altitude_lp: AltitudeLp,
    floor: FloorMaker<'a>,
    /// Samples count alike, whatever the distance between them (the paper's sums).
    even: bool,
    from: PlanPoint,
    to: PlanPoint,
    controls: usize,
    /// Rooms that are not in use.
    buffers: Mutex<Vec<Buffers>>,
    /// Once it is set, nothing is evaluated any more.
    cancel: Option<&'a AtomicBool>,
}

/// What one thread decodes and evaluates in.
#[derive(Default)]
pub(crate) struct Buffers {
    spline: Spline,
    east_m: Vec<f64>,
    north_m: Vec<f64>,
    demand: Demand,
    lengths_m: Vec<f64>,
    altitude_lp: Workspace,
    batch: Batch,
    scratch: Scratch,
    /// Costs as they run up along the paths of the batch.
    along: Vec<f64>,
}

impl<'a> Sampled<'a> {
    /// The samples of a route at `parameters` of [0, 1]; `margins` are those of the
    /// objective.
    pub(crate) fn new(context: &RouteContext<'a>, margins: Margins, parameters: &[f64]) -> Self {
        Self::above(context, margins, parameters, BETWEEN_SAMPLES_M)
    }

    /// The same, with decoded altitudes `above_m` metres over the floor.
    pub(crate) fn above(
        context: &RouteContext<'a>,
        margins: Margins,
        parameters: &[f64],
        above_m: f64,
    ) -> Self {
        let controls = context.controls();
        let basis = Basis::new(controls, parameters);
        let rows = (0..parameters.len()).map(|k| basis.row(k)).collect();
        Self {
            altitude_lp: AltitudeLp::new(rows, controls).under(ceiling_m(context)),
            model: context.model(margins, parameters),
            floor: context.floor(above_m, margins.climb_fraction),
            even: context.spec.planner.objective == Objective::Paper,
            from: context.ends.from,
            to: context.ends.to,
            controls,
            basis,
            buffers: Mutex::default(),
            cancel: context.cancel,
        }
    }

    /// The same with violated limits `factor` times dearer.
    pub(crate) fn with_penalties(mut self, factor: f64) -> Self {
        self.model = self.model.with_penalties(factor);
        self
    }

    /// Whether the search is to end; costs are then those of paths that nobody takes.
    fn is_cancelled(&self, costs: &mut [f64]) -> bool {
        const COST: f64 = 1e12;
        let is_cancelled = (self.cancel).is_some_and(|cancel| cancel.load(Ordering::Relaxed));
        if is_cancelled {
            costs.fill(COST);
        }
        is_cancelled
    }

    /// Works in a room that was used before, if there is one.
    fn with_buffers(&self, act: impl FnOnce(&mut Buffers)) {
        let free = self
            .buffers
            .lock()
            .ok()
            .and_then(|mut buffers| buffers.pop());
        let mut buffer = free.unwrap_or_default();
        act(&mut buffer);
        if let Ok(mut buffers) = self.buffers.lock() {
            buffers.push(buffer);
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
    pub(crate) fn decode(&self, free: impl Iterator<Item = EastNorth>, buffer: &mut Buffers) {
        let spline = &mut buffer.spline;
        self.outline(free, spline);
        let samples = self.basis.samples();
        self.altitude_lp.sample(&spline.east_m, &mut buffer.east_m);
        self.altitude_lp
            .sample(&spline.north_m, &mut buffer.north_m);
        let line = SampledLine {
            east_m: &buffer.east_m,
            north_m: &buffer.north_m,
            ends_m: (self.from.amsl.0, self.to.amsl.0),
        };
        self.floor
            .fill(&line, &mut buffer.demand, &mut buffer.lengths_m);
        let weights = &mut buffer.demand.weights;
        weights.clear();
        if self.even {
            weights.resize(samples, 1.0);
        } else {
            let length = |k: usize| buffer.lengths_m.get(k).copied().unwrap_or(0.0);
            weights.extend(
                (0..samples).map(|k| 0.5 * (length(k) + if k > 0 { length(k - 1) } else { 0.0 })),
            );
        }
        self.altitude_lp
            .solve(&buffer.demand, &mut spline.amsl_m, &mut buffer.altitude_lp);
    }

    /// The decoded spline of free control points in the plane.
    pub(crate) fn spline(&self, free: impl Iterator<Item = EastNorth>) -> Spline {
        let mut buffer = Buffers::default();
        self.decode(free, &mut buffer);
        buffer.spline
    }
}

/// Height under the ceiling that keeps rounding below it, metres.
pub(super) const UNDER_CEILING_M: f64 = 0.05;
/// A lid this near to the ceiling needs care that a path over it stays below, metres.
const NEAR_CEILING_M: f64 = 10.0;

/// The ceiling of decoded altitudes, metres: infinite but where a zone's lid is near it. The ends
/// may touch it.
fn ceiling_m(context: &RouteContext<'_>) -> f64 {
    let top_m = context.world.max_amsl.0;
    let near = top_m - NEAR_CEILING_M..=top_m;
    let mut zones = context.world.zones.iter();
    let is_near = |zone: &PlanZone| matches!(zone.ceiling, Some(Placement::Amsl(lid)) if near.contains(&lid.0));
    if !zones.any(is_near) {
        return f64::INFINITY;
    }
    let ends_m = context.ends.from.amsl.0.max(context.ends.to.amsl.0);
    (top_m - UNDER_CEILING_M).max(ends_m)
}

/// Search of the horizontal control points alone: the altitude is decoded.
pub(crate) struct Horizontal<'a> {
    pub sampled: Sampled<'a>,
    pub frame: Frame,
    /// First and last block of the objective in which each free control point moves the path;
    /// none if only whole paths are compared.
    windows: Vec<(usize, usize)>,
    /// The same with other penalties, to begin with.
    relaxed: Option<Box<Horizontal<'a>>>,
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
            relaxed: None,
        }
    }

    /// A search that may begin with another of the same path.
    pub(crate) fn after_relaxed(self, relaxed: Option<Self>) -> Self {
        Self {
            relaxed: relaxed.map(Box::new),
            ..self
        }
    }

    /// Decodes candidates into the batch of a room.
    fn decode(&self, candidates: &[f64], buffer: &mut Buffers) {
        buffer.batch.clear(self.sampled.controls);
        // Candidates of one call lie near each other: each begins where the one before
        // ended, the first where all do, so that equal calls give equal bytes.
        buffer.altitude_lp.begin_anew();
        for candidate in candidates.chunks_exact(self.dimension()) {
            self.sampled.decode(self.frame.positions(candidate), buffer);
            buffer.batch.push(&buffer.spline.controls());
        }
    }
}

impl Problem for Horizontal<'_> {
    fn dimension(&self) -> usize {
        2 * (self.sampled.controls - 2)
    }

    fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
        if self.sampled.is_cancelled(costs) {
            return;
        }
        self.sampled.with_buffers(|buffer| {
            self.decode(candidates, buffer);
            self.sampled
                .model
                .totals(&buffer.batch, &mut buffer.scratch, costs);
        });
    }

    fn relaxed(&self) -> Option<&dyn Problem> {
        let relaxed = self.relaxed.as_deref()?;
        Some(relaxed)
    }

    fn groups(&self) -> usize {
        self.windows.len().max(1)
    }

    /// The part of a control point is what its blocks cost, and all collisions: a detour makes
    /// the whole way behind it later. What its altitude moves beyond them is not seen.
    fn evaluate_parts(&self, candidates: &[f64], costs: &mut [f64], parts: &mut [f64]) {
        if self.sampled.is_cancelled(costs) {
            return parts.fill(0.0);
        }
        if self.windows.is_empty() {
            self.evaluate(candidates, costs);
            parts.copy_from_slice(costs);
            return;
        }
        let model = &self.sampled.model;
        let blocks = model.blocks();
        self.sampled.with_buffers(|buffer| {
            self.decode(candidates, buffer);
            buffer.along.resize(costs.len() * blocks, 0.0);
            model.totals_along(&buffer.batch, &mut buffer.scratch, costs, &mut buffer.along);
            let along = buffer.along.chunks_exact(blocks).zip(costs);
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
            let at = self.frame.position(candidate[j], candidate[free + j]);
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

    fn evaluate(&self, candidates: &[f64], costs: &mut [f64]) {
        self.sampled.with_buffers(|buffer| {
            buffer.batch.clear(self.sampled.controls);
            for candidate in candidates.chunks_exact(self.dimension()) {
                self.spline(candidate, &mut buffer.spline);
                buffer.batch.push(&buffer.spline.controls());
            }
            self.sampled
                .model
                .totals(&buffer.batch, &mut buffer.scratch, costs);
        });
    }
}

#[cfg(test)]
mod tests;
