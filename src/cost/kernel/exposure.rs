//! Exposure of the pieces of a block to threats, zones and the edge of the area.

use fearless_simd::prelude::*;

use super::block::Block;
use super::boxes::meets;
use super::lanes::{V, load};
use super::scratch::Scratch;
use super::threats::{Danger, clear};
use crate::cost::hazards::Hazards;

/// Threats, zones and area, added to `sum`.
#[inline(always)]
pub(crate) fn add_threats<S: Simd>(
    simd: S,
    block: &Block<S>,
    hazards: &Hazards,
    danger: impl Danger,
    (scratch, mut sum): (&mut Scratch, V<S>),
) -> V<S> {
    let (zones, outside) = near_polygons(block, hazards);
    let threats = (&hazards.threats[..], danger);
    let exposures = &mut scratch.exposures;
    let is_near = (scratch.approaches).add(simd, block, threats, exposures);
    if !is_near {
        if zones | outside == 0 {
            return sum;
        }
        clear(simd, exposures);
    }
    if zones | outside != 0 {
        for (k, exposure) in exposures[..block.count()].iter_mut().enumerate() {
            let mut lanes = zones | outside;
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize;
                let piece = block.piece(k, lane);
                exposure[lane] =
                    hazards.add_polygons(&piece, exposure[lane], &mut scratch.crossings);
                lanes &= lanes - 1;
            }
        }
    }
    for (exposure, step) in exposures.iter().zip(block.steps()) {
        sum += load(simd, exposure) * step.length_km;
    }
    sum
}

/// Which lanes need a look at zones, and which at the edge of the area.
#[inline(always)]
fn near_polygons<S: Simd>(block: &Block<S>, hazards: &Hazards) -> (u64, u64) {
    let (low, high) = (&block.bounds.low, &block.bounds.high);
    let mut zones = 0;
    if !hazards.zones.is_empty() {
        let (all_low, all_high) = block.bounds.of_all_lanes();
        hazards.zone_boxes(
            all_low,
            all_high,
            #[inline(always)]
            |zone_low, zone_high| {
                zones |= meets::<S>(low, high, &zone_low, &zone_high).to_bitmask();
            },
        );
    }
    let bounds = &hazards.bounds;
    let inside = low[0].simd_ge(bounds.low[0])
        & high[0].simd_le(bounds.high[0])
        & low[1].simd_ge(bounds.low[1])
        & high[1].simd_le(bounds.high[1]);
    (zones, (!inside).to_bitmask())
}
