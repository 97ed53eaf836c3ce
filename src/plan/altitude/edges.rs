//! The floor between samples: where a path enters or leaves a zone that it flies over.
//!
//! A path from a sample outside of a zone to one inside is still below its lid at the edge unless
//! the sample inside is higher by what the path climbs from the edge on.

use super::Demand;
use super::floor::{FloorMaker, SampledLine};
use crate::numeric::geometry::Point;

impl FloorMaker<'_> {
    /// Raises the samples beside the edges of zones, so that a path at the steepest slopes is over
    /// the lid from edge to edge.
    pub(super) fn raise_at_edges(&self, line: &SampledLine<'_>, demand: &mut Demand) {
        let at = |k: usize| -> Point { [line.east_m[k], line.north_m[k]] };
        let Demand {
            floor_m,
            ground_m,
            up_m,
            down_m,
            crossings,
            ..
        } = demand;
        for zone in &self.zones {
            for k in 0..floor_m.len() - 1 {
                let piece = (at(k), at(k + 1));
                if zone.closed.is_far_from(piece.0, piece.1) {
                    continue;
                }
                let inside = [piece.0, piece.1].map(|at| zone.closed.contains(at));
                let share = zone.closed.inside_fraction(piece, (0.0, 1.0), crossings);
                if inside == [true, true] || share <= 0.0 {
                    continue;
                }
                let sides = [(k, down_m[k]), (k + 1, up_m[k])].into_iter().zip(inside);
                for ((sample, rise_m), is_in) in sides {
                    // Where neither is inside, both go up to the lid.
                    if !is_in && inside.contains(&true) {
                        continue;
                    }
                    let max_m = (self.layer).ceiling_m(ground_m[sample], self.world.max_amsl.0);
                    let lid_m = zone.lid_m(floor_m[sample], ground_m[sample], max_m);
                    let more_m = if is_in { share * rise_m } else { 0.0 };
                    if let Some(lid_m) = lid_m {
                        floor_m[sample] = floor_m[sample].max((lid_m + more_m).min(max_m));
                    }
                }
            }
        }
    }
}
