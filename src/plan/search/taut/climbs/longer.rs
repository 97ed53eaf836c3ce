//! Bends aside and circles that make a line longer.

use std::f64::consts::TAU;

use nalgebra::Vector2;

use super::super::belt::{east_north, vector};
use super::short::Short;
use super::{Climbs, Held, Rounded};
use crate::geodesy::EastNorth;
use crate::numeric::as_f64;
use crate::plan::classes::taut_line::Bend;

/// Places in the part of a line that is too short at which circles are tried, and most circles at one place.
const TRIED: usize = 12;
const MAX_CIRCLES: u32 = 12;
/// Circles are longer than need be by this share.
const LONGER: f64 = 1.01;
/// How much longer than need be a bend aside is, as a factor and in metres: its corners are rounded.
const ASIDE: [f64; 6] = [1.01, 1.03, 1.07, 1.15, 1.4, 2.0];
const MORE_M: f64 = 0.5;
/// Turns aside, in radii of other turns: on a wide one legs are longer, and so less steep as they are encoded.
const WIDE: [f64; 3] = [2.5, 1.6, 1.0];
/// Parts of what is missing that a bend aside adds where there is no space for more, and what is left at most of it where
/// that helps.
const PARTS: [f64; 4] = [0.7, 0.5, 0.3, 0.15];
const HELPS: f64 = 0.93;
/// The same where all that is missing is added.
const HELPS_WHOLE: f64 = 0.0;
/// A place must get so much nearer to the end that making a line longer helped, metres.
const ONWARD_M: f64 = 2.0;
/// Turns are at least so far from the ends of a route, in their radii.
const NEAR_END: f64 = 1.2;
/// Pieces of legs are longer than this, metres.
const MIN_PIECE_M: f64 = 1.0;

impl Climbs<'_> {
    /// A line made longer where it is too short: by a bend aside, by circles, or where there is no space for either by a
    /// part of what is missing.
    pub(super) fn longer(&self, held: &Held, short: &Short) -> Option<Held> {
        let whole = &held.line;
        let pieces = self.pieces(&whole.line, short);
        let whole_way = (held, short, HELPS_WHOLE);
        let mut ways = (ASIDE.iter()).flat_map(|times| WIDE.iter().map(move |wide| (wide, times)));
        let aside = ways.find_map(|(wide, times)| {
            let by_m = times * short.by_m + MORE_M;
            self.first(whole_way, &pieces, |piece| {
                self.aside(whole, *piece, (by_m, wide * self.radius_m))
            })
        });
        aside
            .or_else(|| self.with_circles(held, short))
            .or_else(|| {
                PARTS.iter().find_map(|part| {
                    self.first((held, short, HELPS), &pieces, |piece| {
                        self.aside(whole, *piece, (part * short.by_m, self.radius_m))
                    })
                })
            })
    }

    /// The same by as few circles as there is space for.
    fn with_circles(&self, held: &Held, short: &Short) -> Option<Held> {
        let whole = &held.line;
        let tried: Vec<(usize, EastNorth)> = (0..TRIED)
            .filter_map(|number| {
                let share = (as_f64(number) + 0.5) / as_f64(TRIED);
                self.place(
                    &whole.line,
                    short.from_m - share * (short.from_m - short.to_m),
                )
            })
            .collect();
        (1..=MAX_CIRCLES)
            .map(|circles| (circles, LONGER * short.by_m / (TAU * f64::from(circles))))
            .take_while(|(circles, radius_m)| *circles == 1 || *radius_m >= self.radius_m)
            .find_map(|(circles, radius_m)| {
                let radius_m = radius_m.max(self.radius_m);
                self.first((held, short, HELPS_WHOLE), &tried, |place| {
                    self.circles(whole, *place, (circles, radius_m))
                })
            })
    }

    /// The first line, by places from the end of the part that is too short, that turns no tighter and with which the next
    /// part that is too short is nearer to the end, or no more is left of this one than a share.
    fn first<T>(
        &self,
        (held, short, max_left): (&Held, &Short, f64),
        all: &[T],
        lines: impl Fn(&T) -> Vec<Rounded>,
    ) -> Option<Held> {
        let helps = |next: &Short| {
            next.to_m < short.to_m - ONWARD_M
                || next.by_m < max_left * short.by_m && next.to_m < short.to_m + ONWARD_M
        };
        let lines = all.iter().rev().flat_map(lines);
        lines
            .filter_map(|line| self.held(line))
            .find(|longer| longer.tight <= held.tight && longer.short.as_ref().is_none_or(helps))
    }

    /// Lines with circles at a place of a leg, to both of its sides, where these cross nothing closed.
    fn circles(
        &self,
        whole: &Rounded,
        (leg, at): (usize, EastNorth),
        (circles, radius_m): (u32, f64),
    ) -> Vec<Rounded> {
        let line = &whole.line;
        let along = vector(line[leg + 1].at) - vector(line[leg].at);
        let left = Vector2::new(-along.y, along.x).normalize();
        [1.0, -1.0]
            .into_iter()
            .filter_map(|side| {
                let center = vector(at) + left * side * radius_m;
                let on_circle = |number: u32| {
                    let (sin, cos) = (TAU * f64::from(number) / 24.0).sin_cos();
                    [center.x + radius_m * cos, center.y + radius_m * sin]
                };
                let is_free = (0..24).all(|number| {
                    let (a, b) = (on_circle(number), on_circle(number + 1));
                    !self.closed.holds(a) && self.closed.is_free(a, b)
                });
                is_free.then(|| {
                    let bend = Bend {
                        at,
                        around: (east_north(center), radius_m),
                        circles: side * f64::from(circles),
                    };
                    whole.with((leg, &[bend]), radius_m)
                })
            })
            .collect()
    }

    /// The leg at a distance from the end of a line, and the place on it; none on a circle, or too near to an end of the
    /// route to turn there.
    fn place(&self, line: &[Bend], to_end_m: f64) -> Option<(usize, EastNorth)> {
        let (leg, at) = legs(line).into_iter().find_map(|(leg, left_m)| {
            let (from, to) = (line[leg].at, line[leg + 1].at);
            let share = (left_m - to_end_m) / from.distance_m(to);
            (0.0..1.0)
                .contains(&share)
                .then(|| (leg, from.toward(to, share)))
        })?;
        let (start, goal) = self.context.ends_at();
        let is_near = |end: EastNorth| at.distance_m(end) < NEAR_END * self.radius_m;
        (!is_near(start) && !is_near(goal)).then_some((leg, at))
    }

    /// Pieces of the legs in the part of a line that is too short.
    fn pieces(&self, line: &[Bend], short: &Short) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for (leg, left_m) in legs(line) {
            let (from, to) = (line[leg].at, line[leg + 1].at);
            let length_m = from.distance_m(to);
            let gone_m = |to_end_m: f64| left_m - to_end_m;
            let begin_m = gone_m(short.from_m).max(0.0);
            for to_end_m in [short.to_m, short.to_m + 2.0 * self.radius_m] {
                let end_m = gone_m(to_end_m).min(length_m);
                if end_m > begin_m + MIN_PIECE_M {
                    let at = |at_m: f64| from.toward(to, at_m / length_m);
                    let near_m = NEAR_END * self.radius_m;
                    let inner =
                        |at_m: f64| (at_m > near_m && at_m < length_m - near_m).then(|| at(at_m));
                    pieces.push(Piece {
                        leg,
                        ends: (at(begin_m), at(end_m)),
                        inner: [inner(begin_m), inner(end_m)],
                    });
                }
            }
        }
        pieces
    }

    /// Lines that go aside between the ends of a piece so far that they are longer by some metres, to both of its sides,
    /// where that crosses nothing closed.
    fn aside(&self, whole: &Rounded, piece: Piece, (by_m, radius_m): (f64, f64)) -> Vec<Rounded> {
        let (before, after) = piece.ends;
        let along = (vector(after) - vector(before)).normalize();
        let left = Vector2::new(-along.y, along.x);
        let half_m = 0.5 * before.distance_m(after);
        let aside_m = (0.5 * by_m * (0.5 * by_m + 2.0 * half_m)).sqrt();
        let radius_m = radius_m.min(0.5 * aside_m).max(self.radius_m);
        // A turn that is wider than the piece is beside its middle.
        let off_m = (radius_m + MIN_PIECE_M - half_m).max(0.0);
        let shifts_m = match off_m > 0.0 {
            true => vec![off_m, -off_m],
            false => vec![0.0],
        };
        let tops = shifts_m.into_iter().flat_map(|m| [(m, 1.0), (m, -1.0)]);
        tops.filter_map(|(shift_m, side)| {
            let middle = vector(before.toward(after, 0.5)) + along * shift_m;
            let at = east_north(middle + left * side * aside_m);
            let [a, b, c] = [before, at, after].map(|at| [at.east_m, at.north_m]);
            let is_free =
                !self.closed.holds(b) && self.closed.is_free(a, b) && self.closed.is_free(b, c);
            let center = east_north(middle + left * side * (aside_m - radius_m));
            // It may turn by more than half a circle.
            let top = Bend {
                at,
                around: (center, radius_m),
                circles: -0.5 * side,
            };
            let [begin, end] = piece.inner.map(|at| at.map(Bend::place));
            let bends: Vec<Bend> = [begin, Some(top), end].into_iter().flatten().collect();
            is_free.then(|| whole.with((piece.leg, &bends), self.radius_m))
        })
        .collect()
    }
}

impl Rounded {
    /// The same with more bends on a leg.
    fn with(&self, (leg, bends): (usize, &[Bend]), radius_m: f64) -> Self {
        let at = leg + 1..leg + 1;
        let mut with = self.clone();
        with.line.splice(at.clone(), bends.iter().copied());
        with.tuned.splice(at.clone(), bends.iter().copied());
        with.radii_m.splice(at, bends.iter().map(|_| radius_m));
        with
    }
}

/// A piece of a leg.
#[derive(Clone, Copy)]
struct Piece {
    leg: usize,
    ends: (EastNorth, EastNorth),
    /// Those of its ends that are not those of the leg.
    inner: [Option<EastNorth>; 2],
}

/// The legs of a line in order, and how far it is from the beginning of each to the end, metres, circles included.
fn legs(line: &[Bend]) -> Vec<(usize, f64)> {
    let mut left_m = 0.0;
    let mut legs = Vec::new();
    for (leg, pair) in line.windows(2).enumerate().rev() {
        left_m += pair[0].at.distance_m(pair[1].at);
        legs.push((leg, left_m));
        left_m += pair[0].circles.abs() * TAU * pair[0].around.1;
    }
    legs.reverse();
    legs
}
