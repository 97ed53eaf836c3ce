//! A way with rests made as long as its climbs and descents take.
//!
//! A copter that rests where it turns needs no space for that: legs to and fro make a way longer wherever there is some
//! width, and the more legs there are, the less width they need.

use super::outline;
use crate::geodesy::EastNorth;
use crate::numeric::as_f64;
use crate::plan::altitude::floor::FloorMaker;
use crate::plan::classes::taut_line::Closed;
use crate::plan::route_context::RouteContext;
use crate::plan::search::fit::Line;
use crate::plan::search::taut::climbs::{Short, floor_of, short_along};

/// Most rounds in which a way is made longer.
const MAX_ROUNDS: usize = 60;
/// Turns on one leg, fewest first.
const TURNS: [usize; 9] = [1, 2, 3, 4, 6, 8, 11, 15, 20];
/// Shares of what is missing that are added: the whole, and less where there is no space for more.
const SHARES: [f64; 3] = [1.0, 0.5, 0.25];
/// Ways are made longer than need be by this share, and by these metres.
const LONGER: f64 = 1.02;
const MORE_M: f64 = 0.5;
/// Legs are at least so long, metres: their altitudes are encoded in quarters of one.
const MIN_LEG_M: f64 = 8.0;
/// Pieces of a leg that leave less of it than this, metres, begin or end where it does.
const SHORT_M: f64 = 15.0;
/// A place must get so much nearer to the end, metres, or what is missing become less than this share of it.
const ONWARD_M: f64 = 2.0;
const HELPS: f64 = 0.9;
/// To which sides turns are.
const SIDES: [Sides; 4] = [
    Sides::Both(1.0),
    Sides::Both(-1.0),
    Sides::One(1.0),
    Sides::One(-1.0),
];

/// Positive to the left.
#[derive(Clone, Copy)]
enum Sides {
    /// To and fro across the leg, first to this side.
    Both(f64),
    /// Aside and back to the leg.
    One(f64),
}

/// Corners of a way along others that is long enough, ends included; none where it is long enough, or where there is no
/// space to make it so.
pub(super) fn long_enough(
    context: &RouteContext<'_>,
    corners: &[EastNorth],
    closed: &Closed,
) -> Option<Vec<EastNorth>> {
    let way = Way {
        context,
        closed,
        floor: floor_of(context),
    };
    let mut line = corners.to_vec();
    let mut short = way.short(&line)??;
    for _ in 0..MAX_ROUNDS {
        let (longer, next) = way.longer(&line, &short)?;
        line = longer;
        match next {
            Some(next) => short = next,
            None => return Some(line),
        }
    }
    None
}

/// What a way is held against.
struct Way<'a> {
    context: &'a RouteContext<'a>,
    closed: &'a Closed,
    floor: FloorMaker<'a>,
}

impl Way<'_> {
    /// Where a line is too short; none where nothing passes.
    fn short(&self, line: &[EastNorth]) -> Option<Option<Short>> {
        let free = outline(line).0;
        short_along(self.context, &self.floor, &free).map(|(short, _)| short)
    }

    /// A line made longer where it is too short, and where it still is.
    fn longer(&self, line: &[EastNorth], short: &Short) -> Option<(Vec<EastNorth>, Option<Short>)> {
        let pieces = pieces(line, short);
        SHARES.iter().find_map(|share| {
            let by_m = share * LONGER * short.by_m + MORE_M;
            let mut tried = TURNS.iter().flat_map(|&turns| {
                (pieces.iter().rev())
                    .flat_map(move |piece| SIDES.map(|sides| (turns, piece, sides)))
            });
            tried.find_map(|(turns, piece, sides)| {
                let zigzag = zigzag(piece.ends, (turns, by_m), sides)?;
                if !self.is_free(&zigzag) {
                    return None;
                }
                let inner = &zigzag[usize::from(piece.of_leg.0)..];
                let inner = &inner[..inner.len() - usize::from(piece.of_leg.1)];
                let mut longer = line.to_vec();
                longer.splice(piece.leg + 1..piece.leg + 1, inner.iter().copied());
                let next = self.short(&longer)?;
                let helps = |next: &Short| {
                    next.to_m < short.to_m - ONWARD_M || next.by_m < HELPS * short.by_m
                };
                next.as_ref().is_none_or(helps).then_some((longer, next))
            })
        })
    }

    /// Whether legs along some corners cross nothing closed.
    fn is_free(&self, corners: &[EastNorth]) -> bool {
        let plane = |at: EastNorth| [at.east_m, at.north_m];
        let inner = corners.get(1..corners.len() - 1).unwrap_or(&[]);
        !inner.iter().any(|&at| self.closed.holds(plane(at)))
            && (corners.windows(2)).all(|leg| self.closed.is_free(plane(leg[0]), plane(leg[1])))
    }
}

/// A piece of a leg.
struct Piece {
    leg: usize,
    ends: (EastNorth, EastNorth),
    /// Which of its ends are those of the leg.
    of_leg: (bool, bool),
}

/// Pieces of the legs in the part of a line that is too short.
fn pieces(line: &[EastNorth], short: &Short) -> Vec<Piece> {
    let whole_m = Line::new(line.to_vec()).length_m();
    let (from_m, to_m) = (whole_m - short.from_m, whole_m - short.to_m);
    let (mut pieces, mut gone_m) = (Vec::new(), 0.0);
    for (leg, ends) in line.windows(2).enumerate() {
        let length_m = ends[0].distance_m(ends[1]);
        let begin_m = match from_m - gone_m {
            near_m if near_m < SHORT_M => 0.0,
            within_m => within_m,
        };
        let end_m = match to_m - gone_m {
            near_m if near_m > length_m - SHORT_M => length_m,
            within_m => within_m,
        };
        gone_m += length_m;
        if end_m - begin_m >= MIN_LEG_M {
            let at = |at_m: f64| ends[0].toward(ends[1], at_m / length_m);
            pieces.push(Piece {
                leg,
                ends: (at(begin_m), at(end_m)),
                of_leg: (begin_m <= 0.0, end_m >= length_m),
            });
        }
    }
    pieces
}

/// The corners of a piece with some turns that make it longer by some metres, its ends included; none where legs would be
/// too short.
fn zigzag(
    (from, to): (EastNorth, EastNorth),
    (turns, by_m): (usize, f64),
    sides: Sides,
) -> Option<Vec<EastNorth>> {
    let length_m = from.distance_m(to);
    let count = as_f64(turns);
    if length_m + by_m < 2.0 * count * MIN_LEG_M {
        return None;
    }
    let (each_m, half_m) = (0.5 * by_m / count, 0.5 * length_m / count);
    let aside_m = (each_m * (each_m + 2.0 * half_m)).sqrt();
    let (east, north) = (
        (to.east_m - from.east_m) / length_m,
        (to.north_m - from.north_m) / length_m,
    );
    let at = |share: f64, left_m: f64| {
        let on = from.toward(to, share);
        EastNorth {
            east_m: on.east_m - left_m * north,
            north_m: on.north_m + left_m * east,
        }
    };
    let mut corners = vec![from];
    for turn in 0..turns {
        let middle = (as_f64(turn) + 0.5) / count;
        let side = match sides {
            Sides::One(side) => side,
            Sides::Both(first) if turn % 2 == 0 => first,
            Sides::Both(first) => -first,
        };
        corners.push(at(middle, side * aside_m));
        if matches!(sides, Sides::One(_)) && turn + 1 < turns {
            corners.push(at((as_f64(turn) + 1.0) / count, 0.0));
        }
    }
    corners.push(to);
    Some(corners)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(east_m: f64, north_m: f64) -> EastNorth {
        EastNorth { east_m, north_m }
    }

    proptest! {
        #[test]
        fn a_zigzag_is_longer_by_what_is_missing(
            east_m in -400.0..400.0_f64, north_m in 20.0..400.0_f64,
            by_m in 1.0..900.0_f64, turns in 1..20_usize, sides in 0..4_usize,
        ) {
            let ends = (at(3.0, -7.0), at(3.0 + east_m, -7.0 + north_m));
            let base_m = ends.0.distance_m(ends.1);
            let corners = zigzag(ends, (turns, by_m), SIDES[sides]);
            prop_assert_eq!(corners.is_some(), base_m + by_m >= 2.0 * MIN_LEG_M * as_f64(turns));
            if let Some(corners) = corners {
                let length_m = Line::new(corners.clone()).length_m();
                prop_assert!((length_m - base_m - by_m).abs() < 1e-6);
                prop_assert!(corners.windows(2).all(|leg| leg[0].distance_m(leg[1]) > MIN_LEG_M - 1e-6));
                prop_assert!(corners[0] == ends.0 && corners[corners.len() - 1] == ends.1);
            }
        }
    }

    #[test]
    fn pieces_are_of_the_part_that_is_too_short_and_of_whole_legs_where_little_is_left() {
        let line = [
            at(0.0, 0.0),
            at(0.0, 100.0),
            at(50.0, 100.0),
            at(50.0, 110.0),
        ];
        // From 10 m after the start to 20 m before the end of the second leg.
        let short = Short {
            from_m: 150.0,
            to_m: 30.0,
            by_m: 5.0,
        };
        let pieces = pieces(&line, &short);
        let found: Vec<_> = pieces
            .iter()
            .map(|of| (of.leg, of.ends, of.of_leg))
            .collect();
        let first = (0, (line[0], line[1]), (true, true));
        let second = (1, (line[1], at(30.0, 100.0)), (true, false));
        assert_eq!(found, [first, second]);
    }
}
