//! Segments laid along legs, one after the other in time.

use crate::geodesy::{Amsl, EastNorth, LatLon, LocalFrame, PlanPoint};
use crate::numeric::geometry;
use crate::world::{NoData, World};

use super::decode::Unknown;
use super::legs::{Knot, Piece, Shape};
use crate::verify::measure::segment::{Column, Followed, Phase, Segment, stretches};
use crate::verify::measure::surface::Surface;
use crate::verify::measure::terrain_posts::{Apart, apart};

/// A curved or accelerated piece is cut into segments that are never further off than this.
const CHORD_ERROR_M: f64 = 0.02;

/// The surface that an autopilot follows is compared with the ground at places so far apart, metres.
const EVERY_M: f64 = 2.0;

/// `TERRAIN_OFS_MAX`: by more the surface is not moved at home, metres (`AP_Terrain::update_reference_offset`).
const OFFSET_M: f64 = 30.0;

/// Most segments of a mission, so that jumps around long circles cannot take all of the memory: 300 000 take some 130 MB.
const MAX_SEGMENTS: usize = 300_000;

/// The segments so far, and the time at their end.
pub(crate) struct TrajectoryBuilder<'a> {
    pub(crate) frame: &'a LocalFrame,
    surface: Surface<'a>,
    /// Between the posts of the surface that the autopilot follows, metres.
    posts_m: f64,
    /// How far that may be from the ground at home: the autopilot moves all of it by as much.
    at_home: Apart,
    pub(crate) segments: Vec<Segment>,
    pub(crate) t_s: f64,
    /// By how much the vehicle may be late, for the stops so far, seconds.
    pub(crate) late_s: f64,
    /// And early, for the legs so far, seconds.
    pub(crate) early_s: f64,
}

/// A segment, and its altitudes at both ends, metres.
type Laid = (Segment, (f64, f64));

/// Altitude along a leg: a straight line above the sea, or above the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AltitudeLine {
    pub(crate) follows: bool,
    /// At the ends, metres.
    value_m: (f64, f64),
    /// Where the line is above the one or below the other, it is level there, metres.
    top_m: f64,
    bottom_m: f64,
}

impl AltitudeLine {
    /// From one value to another, metres: heights above the ground if it follows that.
    pub(crate) fn between(follows: bool, value_m: (f64, f64)) -> Self {
        Self {
            follows,
            value_m,
            top_m: f64::INFINITY,
            bottom_m: f64::NEG_INFINITY,
        }
    }

    fn value_m(&self, fraction: f64) -> f64 {
        self.value_m.0 + (self.value_m.1 - self.value_m.0) * fraction
    }

    /// The altitudes at its ends, metres.
    pub(crate) fn ends_m(&self) -> (f64, f64) {
        let level = |value_m: f64| value_m.min(self.top_m).max(self.bottom_m);
        (level(self.value_m.0), level(self.value_m.1))
    }

    /// A segment along the line and the altitudes at its ends, metres: two where it is level in part.
    fn in_parts(&self, segment: Segment) -> (Laid, Option<Laid>) {
        let ends_m = self.ends_m();
        let level_m = match self.bottom_m.is_finite() {
            true => self.bottom_m,
            false => self.top_m,
        };
        let u = (level_m - self.value_m.0) / self.change_m();
        if !(0.0 < u && u < 1.0) {
            return ((segment, ends_m), None);
        }
        let (at, t_s) = (segment.at(u), segment.time_s(u));
        let first = Segment {
            to: at,
            to_s: t_s,
            ..segment
        };
        let last = Segment {
            from: at,
            from_s: t_s,
            ..segment
        };
        (
            (first, (ends_m.0, level_m)),
            Some((last, (level_m, ends_m.1))),
        )
    }

    /// From one end to the other, metres.
    pub(crate) fn change_m(&self) -> f64 {
        self.value_m.1 - self.value_m.0
    }

    /// Level, as at the end.
    pub(crate) fn end(&self) -> Self {
        self.part((1.0, 1.0))
    }

    /// Level where it is above a height, metres.
    pub(crate) fn below(&self, top_m: f64) -> Self {
        Self { top_m, ..*self }
    }

    /// The slope that is at the altitude of the end after a part of the leg already.
    pub(crate) fn steeper(&self, fraction: f64) -> Self {
        Self {
            value_m: (self.value_m.0, self.value_m.0 + self.change_m() / fraction),
            ..*self
        }
    }

    /// That slope, and level from there.
    pub(crate) fn hastened(&self, fraction: f64) -> Self {
        let (end_m, slope) = (self.value_m.1, self.steeper(fraction));
        match self.change_m() > 0.0 {
            true => slope.below(end_m),
            false => Self {
                bottom_m: end_m,
                ..slope
            },
        }
    }

    /// The line raised by a height, metres.
    pub(crate) fn raised(&self, by_m: f64) -> Self {
        Self {
            value_m: (self.value_m.0 + by_m, self.value_m.1 + by_m),
            ..*self
        }
    }

    fn part(&self, (from, to): (f64, f64)) -> Self {
        Self {
            value_m: (self.value_m(from), self.value_m(to)),
            ..*self
        }
    }
}

impl<'a> TrajectoryBuilder<'a> {
    pub(crate) fn new(world: &'a World, home: EastNorth, posts_m: f64) -> Self {
        let at_home = apart(&world.terrain, world.frame.from_plan(home), posts_m);
        Self {
            frame: &world.frame,
            posts_m,
            at_home: at_home.within(OFFSET_M),
            surface: Surface::new(&world.terrain),
            segments: Vec::new(),
            t_s: 0.0,
            late_s: 0.0,
            early_s: 0.0,
        }
    }

    /// A motion along a straight line, or a stay, at constant velocity.
    pub(crate) fn straight(
        &mut self,
        (row, phase): (usize, Phase),
        (from, to): (PlanPoint, PlanPoint),
        duration_s: f64,
        column: Option<Column>,
    ) {
        let from_s = self.t_s;
        self.t_s += duration_s;
        self.segments.push(Segment {
            column,
            late_s: self.late_s,
            early_s: self.early_s,
            flown: true,
            ..Segment::unflown((row, phase), (from_s, self.t_s), (from, to))
        });
    }

    /// Lays the segments of a piece, and of the two ends of legs at an arc.
    pub(crate) fn lay_piece(
        &mut self,
        piece: &Piece,
        knots: &[Knot],
        lines: &[AltitudeLine],
    ) -> Result<(), Unknown> {
        let to = &knots[piece.leg + 1];
        let line = self.piece_line(piece, to.row, lines)?;
        let duration_s = piece.duration_s();
        let acceleration_mps2 = piece.acceleration_mps2();
        let needed = duration_s * (acceleration_mps2 / (8.0 * CHORD_ERROR_M)).sqrt();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to a small positive count"
        )]
        let count = needed.ceil().clamp(1.0, 1e5) as u32;
        let step_s = duration_s / f64::from(count);
        let error_m = acceleration_mps2 * step_s * step_s / 8.0;
        let is_arc = matches!(piece.shape, Shape::Arc { .. });
        let from_s = self.t_s;
        for index in 0..count {
            let time = |i: u32| f64::from(i) / f64::from(count);
            let covered = (
                piece.covered(time(index)),
                piece.covered(time(index + 1)).min(1.0),
            );
            let times_s = (
                from_s + duration_s * time(index),
                from_s + duration_s * time(index + 1),
            );
            let ends = (
                here_at(piece.shape.at(covered.0)),
                here_at(piece.shape.at(covered.1)),
            );
            let segment = Segment {
                error_m,
                bow_m: if is_arc { error_m } else { 0.0 },
                slope_from_m: to.slope_from_m,
                wide_m: piece.wide_m,
                // What an arc takes longer it may have lost at its begin.
                late_s: self.late_s + piece.late_s,
                early_s: self.early_s,
                flown: true,
                ..Segment::unflown((to.row, to.phase), times_s, ends)
            };
            self.lay(segment, &line.part(covered))?;
        }
        self.t_s = from_s + duration_s;
        self.late_s += piece.late_s;
        if is_arc {
            self.lay_corner(piece, knots, lines, from_s)?;
        }
        Ok(())
    }

    /// The altitude along a piece. Along an arc it is linear between the ends of the legs, above
    /// the ground if both legs follow the ground.
    fn piece_line(
        &self,
        piece: &Piece,
        row: usize,
        lines: &[AltitudeLine],
    ) -> Result<AltitudeLine, Unknown> {
        if let Shape::Line { .. } = piece.shape {
            return Ok(lines[piece.leg].part(piece.fraction));
        }
        let (here, there) = (&lines[piece.leg], &lines[piece.leg + 1]);
        let follows = here.follows && there.follows;
        let end_m = |line: &AltitudeLine, fraction: f64, at: EastNorth| {
            let value_m = line.value_m(fraction);
            if line.follows && !follows {
                Ok(value_m + self.ground_m(row, self.frame.from_plan(at))?)
            } else {
                Ok(value_m)
            }
        };
        let (leave, join) = piece.fraction;
        let (start, end) = (piece.shape.at(0.0), piece.shape.at(1.0));
        let value_m = (end_m(here, leave, start)?, end_m(there, join, end)?);
        Ok(AltitudeLine::between(follows, value_m))
    }

    /// The ends of the two legs at a fillet, up to the corner itself.
    fn lay_corner(
        &mut self,
        piece: &Piece,
        knots: &[Knot],
        lines: &[AltitudeLine],
        from_s: f64,
    ) -> Result<(), Unknown> {
        let middle_s = 0.5 * (from_s + self.t_s);
        let (corner, next) = (&knots[piece.leg + 1], &knots[piece.leg + 2]);
        let mut end = |knot: &Knot, (from, to), (from_s, to_s), line: AltitudeLine| {
            let ends = (here_at(from), here_at(to));
            let segment = Segment {
                slope_from_m: knot.slope_from_m,
                ..Segment::unflown((knot.row, knot.phase), (from_s, to_s), ends)
            };
            self.lay(segment, &line)
        };
        let (leave, join) = (piece.shape.at(0.0), piece.shape.at(1.0));
        let until_s = from_s + 2.0 * (middle_s - from_s);
        end(
            corner,
            (leave, corner.at),
            (from_s, middle_s),
            lines[piece.leg].part((piece.fraction.0, 1.0)),
        )?;
        end(
            next,
            (corner.at, join),
            (middle_s, until_s),
            lines[piece.leg + 1].part((0.0, piece.fraction.1)),
        )
    }

    /// Lays a whole leg at altitudes that are judged in space alone.
    pub(crate) fn lay_unflown(
        &mut self,
        (from, to): (&Knot, &Knot),
        when_s: (f64, f64),
        line: &AltitudeLine,
    ) -> Result<(), Unknown> {
        let ends = (here_at(from.at), here_at(to.at));
        self.lay(Segment::unflown((to.row, to.phase), when_s, ends), line)
    }

    /// Lays a piece of a leg that may be flown off its line, to be judged in space: from one
    /// place to another, each at the altitude of a fraction of the leg.
    pub(crate) fn lay_aside(
        &mut self,
        segment: Segment,
        fractions: (f64, f64),
        line: &AltitudeLine,
    ) -> Result<(), Unknown> {
        self.lay(segment, &line.part(fractions))
    }

    /// Flies a segment, at altitudes along a line, from the present time to its own end.
    pub(crate) fn curve(&mut self, segment: Segment, line: &AltitudeLine) -> Result<(), Unknown> {
        let to_s = segment.to_s;
        let flown = Segment {
            late_s: self.late_s,
            early_s: self.early_s,
            flown: true,
            ..segment
        };
        self.lay(flown, line)?;
        self.t_s = to_s;
        Ok(())
    }

    /// An error where as much is flown as can be judged.
    pub(crate) fn within_bound(&self, row: usize) -> Result<(), Unknown> {
        if self.segments.len() < MAX_SEGMENTS {
            return Ok(());
        }
        let why = format!(
            "more than {MAX_SEGMENTS} segments are flown, those that turns and jumps repeat included (allowed: {MAX_SEGMENTS}): divide the mission"
        );
        Unknown::err(row, why)
    }

    /// Lays one segment with its altitudes; over terrain that is followed, several.
    fn lay(&mut self, segment: Segment, line: &AltitudeLine) -> Result<(), Unknown> {
        self.within_bound(segment.row)?;
        let raised = |at: EastNorth, amsl_m: f64| PlanPoint {
            at,
            amsl: Amsl(amsl_m),
        };
        if !line.follows {
            let (first, last) = line.in_parts(segment);
            for (part, (from_m, to_m)) in std::iter::once(first).chain(last) {
                self.segments.push(Segment {
                    from: raised(part.from.at, from_m),
                    to: raised(part.to.at, to_m),
                    ..part
                });
            }
            return Ok(());
        }
        let from = (segment.from.at, self.frame.from_plan(segment.from.at));
        for stretch in stretches(self.frame, from, segment.to.at) {
            let patches = self
                .surface
                .under(stretch.from, stretch.to)
                .map_err(|gap| no_data(segment.row, gap))?;
            for patch in patches {
                let parts = split(patch.bulge_m);
                let error_m = patch.bulge_m.abs() / f64::from(parts * parts) + patch.error_m;
                for part in 0..parts {
                    let end = |index: u32| {
                        let v = f64::from(index) / f64::from(parts);
                        let u = stretch.along(patch.w.0 + (patch.w.1 - patch.w.0) * v);
                        let (h0, h1) = patch.height_m;
                        let ground_m = h0 + (h1 - h0) * v + 4.0 * patch.bulge_m * v * (1.0 - v);
                        let agl_m = line.value_m(u);
                        (
                            segment.time_s(u),
                            raised(segment.at(u).at, ground_m + agl_m),
                            agl_m,
                        )
                    };
                    let ((from_s, from, low_m), (to_s, to, high_m)) = (end(part), end(part + 1));
                    self.segments.push(Segment {
                        from_s,
                        to_s,
                        from,
                        to,
                        error_m: segment.error_m + error_m,
                        followed: Some(self.followed((from.at, to.at), (low_m, high_m))),
                        ..segment
                    });
                }
            }
        }
        Ok(())
    }

    /// The heights above ground on a straight way on which a vehicle follows the terrain.
    fn followed(&self, (from, to): (EastNorth, EastNorth), agl_m: (f64, f64)) -> Followed {
        let mut all = Followed {
            agl_m,
            min_m: f64::INFINITY,
            max_m: f64::NEG_INFINITY,
            off_m: 0.0,
        };
        let count = geometry::steps(from.distance_m(to), EVERY_M, (1, u16::MAX));
        for step in 0..=count {
            let u = f64::from(step) / f64::from(count);
            let mix = |a: f64, b: f64| a + (b - a) * u;
            let at = EastNorth {
                east_m: mix(from.east_m, to.east_m),
                north_m: mix(from.north_m, to.north_m),
            };
            let place = self.frame.from_plan(at);
            let apart = apart(self.surface.terrain(), place, self.posts_m).moved(self.at_home);
            let over_m = mix(agl_m.0, agl_m.1);
            all.min_m = all.min_m.min(over_m - apart.below_m);
            all.max_m = all.max_m.max(over_m + apart.above_m);
            all.off_m = all.off_m.max(apart.max_m());
        }
        all
    }

    /// Altitude along the leg between two knots.
    pub(crate) fn altitude_line(&self, from: &Knot, to: &Knot) -> Result<AltitudeLine, Unknown> {
        let Some(agl_m) = to.agl_m else {
            let value_m = (from.amsl_m, to.amsl_m);
            return Ok(AltitudeLine::between(false, value_m));
        };
        let ground_m = self.ground_m(to.row, self.frame.from_plan(from.at))?;
        let value_m = (from.amsl_m - ground_m, agl_m);
        Ok(AltitudeLine::between(true, value_m))
    }

    pub(crate) fn ground_m(&self, row: usize, place: LatLon) -> Result<f64, Unknown> {
        self.surface
            .height_m(place)
            .map_err(|gap| no_data(row, gap))
    }
}

fn here_at(at: EastNorth) -> PlanPoint {
    PlanPoint {
        at,
        amsl: Amsl(f64::NAN),
    }
}

fn no_data(row: usize, gap: NoData) -> Unknown {
    Unknown {
        row,
        why: gap.to_string(),
    }
}

/// In how many parts a parabola is cut so that each is straight to a decimetre.
fn split(bulge_m: f64) -> u32 {
    const BULGE_M: f64 = 0.1;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a small positive count"
    )]
    let parts = (bulge_m.abs() / BULGE_M).sqrt().ceil().clamp(1.0, 1e4) as u32;
    parts
}
