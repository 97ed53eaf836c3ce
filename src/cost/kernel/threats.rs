//! What threats do to the pieces of a block.
//!
//! Where pieces are long, many threats are near a block, each to one candidate or two. So
//! here the lanes are not candidates but pieces of one that follow each other: those that
//! meet a threat are side by side.

use fearless_simd::prelude::*;

use super::block::{BLOCK, Block};
use super::boxes::meets;
use super::lanes::{Lanes, MAX_LANES, Position, V, Wide, splat, store};
use crate::cost::hazards::{FORBIDDEN, Threat};
use crate::numeric::geometry::POINT_SQ;

/// How the danger of a threat is measured.
pub(crate) trait Danger: Copy {
    /// Which pieces a threat may do something to, if none of them is but a point.
    fn meets<S: Simd>(self, threat: &Threat, of: &Pieces<S>) -> Lanes<S>;

    /// What one kilometre of each piece costs for a threat; `stays` where some piece may be but
    /// a point.
    fn exposures<S: Simd>(self, simd: S, threat: &Threat, of: &Pieces<S>, stays: bool) -> V<S>;
}

/// Pieces of one candidate that follow each other, one in each lane.
#[derive(Clone, Copy)]
pub(crate) struct Pieces<S: Simd> {
    pub(crate) a: [V<S>; 2],
    pub(crate) b: [V<S>; 2],
}

/// Pieces of a block, and as many more as a vector has that begins with the last of them, so
/// that no bound needs a look.
const ROW: usize = BLOCK + MAX_LANES;

/// What one kilometre of the pieces of a block costs, in every lane.
pub(crate) type Exposures = [Wide; ROW];

/// Most pairs of a threat and a candidate that are looked at together, a bit for each.
const PAIRS: usize = u64::BITS as usize;

/// Most vectors of pieces of [`PAIRS`] pairs.
const FOUND: usize = PAIRS * BLOCK / 2;

/// What is near a block, in memory that is kept.
#[derive(Clone, Debug)]
pub(crate) struct Approaches {
    /// East and north of each candidate where pieces begin or end.
    rows: [[[f64; ROW + 1]; 2]; MAX_LANES],
    /// Pair and first piece of those that meet.
    found: [(u8, u8); FOUND],
}

impl Default for Approaches {
    fn default() -> Self {
        Self {
            rows: [[[0.0; ROW + 1]; 2]; MAX_LANES],
            found: [(0, 0); FOUND],
        }
    }
}

impl Approaches {
    /// What one kilometre of the pieces of a block costs for threats, if that is anything.
    #[inline(always)]
    pub(crate) fn add<S: Simd>(
        &mut self,
        simd: S,
        block: &Block<S>,
        (threats, danger): (&[Threat], impl Danger),
        exposures: &mut Exposures,
    ) -> bool {
        let mut is_near = false;
        let mut laid_out = 0;
        for threats in threats.chunks(PAIRS / V::<S>::LEN) {
            let near = near(block, threats);
            if near == 0 {
                continue;
            }
            if !is_near {
                is_near = true;
                clear(simd, exposures);
            }
            let lanes = lanes_of::<S>(near) & !laid_out;
            self.lay_out::<S>(block.positions(), lanes);
            laid_out |= lanes;
            let count = self.find(simd, block, (threats, danger), near);
            for &(pair, start) in &self.found[..count] {
                let (threat, lane) = parts::<S>(pair, threats);
                let start = usize::from(start) % BLOCK;
                let pieces = self.pieces(simd, lane, start);
                let more = danger.exposures(simd, threat, &pieces, block.stays);
                let of = &mut exposures[start..][..V::<S>::LEN];
                let more = more.as_slice();
                for k in 0..V::<S>::LEN {
                    of[k][lane] += more[k];
                }
            }
        }
        is_near
    }

    /// Puts the places of some candidates in rows, a bit for each.
    #[inline(always)]
    fn lay_out<S: Simd>(&mut self, positions: &[Position<S>], mut lanes: u64) {
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            let row = &mut self.rows[lane];
            for (k, position) in positions.iter().enumerate() {
                (row[0][k], row[1][k]) =
                    (position[0].as_slice()[lane], position[1].as_slice()[lane]);
            }
            lanes &= lanes - 1;
        }
    }

    /// Pieces of one candidate from number `start` on.
    #[inline(always)]
    fn pieces<S: Simd>(&self, simd: S, lane: usize, start: usize) -> Pieces<S> {
        let [east_m, north_m] = &self.rows[lane];
        let read = |row: &[f64; ROW + 1], from: usize| {
            V::<S>::from_slice(simd, &row[from..from + V::<S>::LEN])
        };
        Pieces {
            a: [read(east_m, start), read(north_m, start)],
            b: [read(east_m, start + 1), read(north_m, start + 1)],
        }
    }

    /// Finds which pieces of the pairs that are near meet; how many of [`Self::found`] there are
    /// then.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a bit of 64, a piece of a block"
    )]
    #[inline(always)]
    fn find<S: Simd>(
        &mut self,
        simd: S,
        block: &Block<S>,
        (threats, danger): (&[Threat], impl Danger),
        mut near: u64,
    ) -> usize {
        let always = u64::from(block.stays);
        let mut count = 0;
        while near != 0 {
            let pair = near.trailing_zeros() as u8;
            let (threat, lane) = parts::<S>(pair, threats);
            for start in (0..BLOCK).step_by(V::<S>::LEN) {
                if start >= block.count() {
                    break;
                }
                let pieces = self.pieces(simd, lane, start);
                let meets = danger.meets(threat, &pieces).to_bitmask() | always;
                self.found[count] = (pair, start as u8);
                count += usize::from(meets != 0);
            }
            near &= near - 1;
        }
        count
    }
}

/// Sets the lanes in use to zero.
#[inline(always)]
pub(crate) fn clear<S: Simd>(simd: S, exposures: &mut Exposures) {
    for exposure in &mut exposures[..BLOCK] {
        store::<S>(splat(simd, 0.0), exposure);
    }
}

/// The threats that may reach into the box of each lane: all lanes of the first threat, then
/// those of the next.
#[inline(always)]
fn near<S: Simd>(block: &Block<S>, threats: &[Threat]) -> u64 {
    let mut near = 0;
    let mut at = 0;
    for threat in threats {
        let lanes = meets::<S>(
            &block.bounds.low,
            &block.bounds.high,
            &threat.low,
            &threat.high,
        );
        near |= lanes.to_bitmask() << at;
        at += V::<S>::LEN;
    }
    near
}

/// The lanes of some pairs, a bit for each.
#[inline(always)]
fn lanes_of<S: Simd>(near: u64) -> u64 {
    let all = (1 << V::<S>::LEN) - 1;
    let threats = (0..PAIRS).step_by(V::<S>::LEN);
    threats.fold(0, |lanes, at| lanes | near >> at & all)
}

/// Threat and lane of a pair.
#[inline(always)]
fn parts<S: Simd>(pair: u8, threats: &[Threat]) -> (&Threat, usize) {
    let pair = usize::from(pair);
    (&threats[pair / V::<S>::LEN], pair % V::<S>::LEN)
}

/// The exact length in a disc; see [`Threat::exposure`].
#[derive(Clone, Copy)]
pub(crate) struct Chords;

impl Danger for Chords {
    #[inline(always)]
    fn meets<S: Simd>(self, threat: &Threat, of: &Pieces<S>) -> Lanes<S> {
        let (from, along) = (of.from(threat), of.along());
        let square = product::<S>(&along, &along);
        let outside = product::<S>(&from, &from) - threat.radius_sq;
        let half = product::<S>(&from, &along);
        // Not if the piece begins outside and leads away, or ends outside and leads there.
        let past = half + square;
        let outside_b = outside + (half + past);
        (half * half).simd_gt(square * outside)
            & outside.min(half).simd_lt(0.0)
            & (past.simd_gt(0.0) | outside_b.simd_lt(0.0))
    }

    #[inline(always)]
    fn exposures<S: Simd>(self, simd: S, threat: &Threat, of: &Pieces<S>, stays: bool) -> V<S> {
        let zero = splat(simd, 0.0);
        let (from, along) = (of.from(threat), of.along());
        let from_sq = product::<S>(&from, &from);
        let square = product::<S>(&along, &along);
        let outside = from_sq - threat.radius_sq;
        let half = product::<S>(&from, &along);
        let root = (half * half - square * outside).max(zero).sqrt();
        let per_square = splat(simd, 1.0) / square.max(POINT_SQ);
        let enter = ((-half - root) * per_square).max(0.0);
        let leave = ((-half + root) * per_square).min(1.0);
        let nearest = (-half * per_square).max(0.0).min(1.0);
        let gap = [from[0] + nearest * along[0], from[1] + nearest * along[1]];
        let closest = product::<S>(&gap, &gap).sqrt();
        let through = (leave - enter) * (splat(simd, FORBIDDEN) - closest * threat.per_radius);
        let meets = self.meets(threat, of) & leave.simd_gt(enter);
        let through = meets.select(through, zero);
        if !stays {
            return through;
        }
        let over = splat(simd, FORBIDDEN) - from_sq.sqrt() * threat.per_radius;
        let over = outside.simd_lt(0.0).select(over, zero);
        square.simd_le(POINT_SQ).select(over, through)
    }
}

impl<S: Simd> Pieces<S> {
    /// From the centre of a threat to where they begin.
    #[inline(always)]
    fn from(&self, threat: &Threat) -> [V<S>; 2] {
        [self.a[0] - threat.center[0], self.a[1] - threat.center[1]]
    }

    /// From where they begin to where they end.
    #[inline(always)]
    fn along(&self) -> [V<S>; 2] {
        [self.b[0] - self.a[0], self.b[1] - self.a[1]]
    }
}

/// Scalar products.
#[inline(always)]
fn product<S: Simd>(a: &[V<S>; 2], b: &[V<S>; 2]) -> V<S> {
    a[0] * b[0] + a[1] * b[1]
}
