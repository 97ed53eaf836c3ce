//! Control points of a path, and the part of the plane in which they are searched.

use crate::cost::Controls;
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::numeric::bspline::{halved, split};

/// The part of the plane in which control points are searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    pub south_west: EastNorth,
    pub north_east: EastNorth,
}

impl Frame {
    /// A place from two numbers of [0, 1].
    pub(crate) fn position(&self, east: f64, north: f64) -> EastNorth {
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
    pub(crate) fn positions(&self, numbers: &[f64]) -> impl Iterator<Item = EastNorth> {
        let pairs = numbers.chunks_exact(2);
        pairs.map(|pair| self.position(pair[0], pair[1]))
    }

    /// The numbers of places, in pairs.
    pub(crate) fn shares(&self, positions: impl IntoIterator<Item = EastNorth>) -> Vec<f64> {
        let pair = |at: EastNorth| {
            let (east, north) = self.share(at);
            [east, north]
        };
        positions.into_iter().flat_map(pair).collect()
    }

    /// A distance in metres as steps of the two numbers, for `numbers` numbers in pairs.
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
    pub(crate) fn reset(&mut self, from: PlanPoint, to: PlanPoint, controls: usize) {
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

    /// The same curve with its spans halved.
    pub(crate) fn halved(&self) -> Self {
        Self {
            east_m: halved(&self.east_m),
            north_m: halved(&self.north_m),
            amsl_m: halved(&self.amsl_m),
        }
    }

    /// The parts before and after the knot behind the span of a number.
    pub(crate) fn split(&self, span: usize) -> [Self; 2] {
        let [east_m, north_m, amsl_m] =
            [&self.east_m, &self.north_m, &self.amsl_m].map(|values| split(values, span));
        let [east_a, east_b] = east_m;
        let [north_a, north_b] = north_m;
        let [amsl_a, amsl_b] = amsl_m;
        let part = |east_m, north_m, amsl_m| Self {
            east_m,
            north_m,
            amsl_m,
        };
        [part(east_a, north_a, amsl_a), part(east_b, north_b, amsl_b)]
    }

    /// How many spans it has.
    pub(crate) fn spans(&self) -> usize {
        self.east_m.len().saturating_sub(3)
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
